//! Whatever the bus says, in whatever order: what the drive commands stays within the axis' limits,
//! and torque has a reason.
//!
//! The real servo is closed with the real plant node, and with a point mass that answers SYNC.
//! Random masters send control words, NMT commands, parameters and commits (limits lowered in
//! motion, another compensation in motion), setpoints that jump, SYNCs that stay away or come with
//! another counter; the ports lose, double, delay and corrupt. A witness inside the servo's port
//! sees every frame that the servo sees and looks at it after each event.
//!
//! | asserted in every cycle | bound |
//! |---|---|
//! | change of the commanded velocity | acceleration limit |
//! | commanded velocity | velocity limit; above one lowered in motion it falls, with a fault |
//! | commanded position | position limits; beyond by v² / 2 a at most since a set became active |
//! | torque frame | torque limit; zero without a reference |
//! | offset of the backlash unit | half the gap; beyond a gap lowered in motion it shrinks |
//! | operation enabled | the stage's last word was that it is enabled |

use bus::{FaultPlan, InProcessBus, Shared};
use controller::reference::Reference;
use hil_tests::rig::one_axis;
use plant_sim::PlantNode;
use protocol::cob::AxisIds;
use protocol::message::{Decoded, Feedback, NmtCommand, NmtState, PlantStatus, Setpoint, decode};
use protocol::sdo::{Expedited, Request};
use protocol::states::{BrakeState, Command, ControlWord, DriveState, StatusWord};
use protocol::weight::{LoadIncrements24, MotorIncrements, SetpointFine, TorqueMicroNm};
use protocol::{CanFrame, Fault, Message, Station, SyncCounter};
use scope::Scope;
use servo::Servo;
use servo::drive::Drive;
use servo::objects::{COMMIT, COMMIT_KEY, Parameter, TABLE};
use workbench::compensation::AxisCompensation;

const PERIOD_US: u64 = 1000;
/// A commanded velocity may pass its limit by one bit of a position (39 pm a cycle), its change by
/// twelve (`controller::reference`), in 2⁻¹² of 10 nm.
const VELOCITY_BIT: i64 = 16;
const ACCELERATION_BITS: i64 = 12 * 16;

/// splitmix64: one number after the other from a seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.roll() % end
    }

    /// True once in so many rolls.
    fn once_in(&mut self, rolls: u64) -> bool {
        self.below(rolls) == 0
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.below(1 << 30) as f64) / (1_u64 << 30) as f64
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }
}

/// The servo, and what it did before the present event.
struct Witness {
    servo: Servo,
    stage_says_enabled: bool,
    before: Option<Reference>,
    steps_before: u64,
    limits: Option<Limits>,
    /// Velocity and acceleration limit of the cycle before.
    limits_before: (i64, i64),
    /// Position and velocity from which the present limits have to be kept, bits.
    begun: (i64, i64),
    /// No cycle has come since the present limits became active.
    is_first: bool,
    offset_before: i64,
    fault_before: Option<Fault>,
    seen: Seen,
}

/// How much of everything a run saw: a property that is never tested holds always.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    cycles: u64,
    enabled: u64,
    moving: u64,
    bridged: u64,
    overruns: u64,
    sets: u64,
    offsets: u64,
    /// Cycles with a friction model.
    modelled: u64,
    /// Of them those with a refined level.
    refined: u64,
    faults: [u32; 32],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Limits {
    velocity: i64,
    acceleration: i64,
    low: i64,
    high: i64,
    torque: i64,
    half_gap: i64,
}

impl Limits {
    fn of(servo: &Servo) -> Option<Self> {
        let config = &servo.settings()?.config;
        let reference = &config.reference;
        Some(Self {
            velocity: i64::from(reference.velocity_limit.0.to_bits()),
            acceleration: i64::from(reference.acceleration_limit.0.to_bits()),
            low: reference.position_min.0.to_bits(),
            high: reference.position_max.0.to_bits(),
            torque: i64::from(config.cascade.torque_limit.micro_nm()),
            half_gap: i64::from(
                config
                    .compensation
                    .map_or(0, |own| own.backlash.half_gap.0.to_bits()),
            ),
        })
    }
}

impl Witness {
    fn new(servo: Servo) -> Self {
        Self {
            servo,
            stage_says_enabled: false,
            before: None,
            steps_before: 0,
            limits: None,
            limits_before: (0, 0),
            begun: (0, 0),
            is_first: false,
            offset_before: 0,
            fault_before: None,
            seen: Seen::default(),
        }
    }

    fn steps(&self) -> u64 {
        let counts = self.servo.counts();
        u64::from(counts.computed) + u64::from(counts.bridged) + u64::from(counts.refused)
    }

    fn hear(&mut self, frame: &CanFrame) {
        match decode(self.servo.ids(), frame) {
            Ok(Decoded::Message(Message::PlantStatus(PlantStatus { status, fault, .. }))) => {
                self.stage_says_enabled =
                    status.state() == Some(DriveState::OperationEnabled) && fault.is_none();
            }
            Ok(Decoded::Message(Message::PlantHeartbeat(NmtState::Initialising))) => {
                self.stage_says_enabled = false;
            }
            _ => {}
        }
    }

    fn pass_on(&mut self, frames: &[CanFrame], send: &mut dyn FnMut(CanFrame)) {
        self.look(frames);
        for frame in frames {
            send(*frame);
        }
    }

    fn look(&mut self, frames: &[CanFrame]) {
        let limits = Limits::of(&self.servo).expect("there is always an active set");
        let (steps, fault) = (self.steps(), self.servo.drive().fault());
        if steps < self.steps_before {
            // The node was reset.
            self.before = None;
        }
        if self.limits != Some(limits) {
            self.limits = Some(limits);
            self.seen.sets += 1;
            self.begin_anew();
        }
        // A cycle that was closed in this event may have had a reference that a fault later in the
        // event took away.
        let was_energised = fault != self.fault_before || steps != self.steps_before + 1;
        for frame in frames {
            self.look_at_frame(frame, &limits, was_energised);
        }
        if steps > self.steps_before {
            self.look_at_cycles(steps - self.steps_before, &limits, fault);
        }
        if fault != self.fault_before
            && let Some(fault) = fault
        {
            self.seen.faults[usize::from(fault.code())] += 1;
        }
        (self.steps_before, self.fault_before) = (steps, fault);
    }

    fn begin_anew(&mut self) {
        if let Some(reference) = &self.before {
            self.begun = begun(reference);
            self.is_first = true;
        }
    }

    fn look_at_frame(&mut self, frame: &CanFrame, limits: &Limits, was_energised: bool) {
        let Ok(Decoded::Message(Message::Torque(torque))) = decode(self.servo.ids(), frame) else {
            return;
        };
        let magnitude = i64::from(torque.torque.0).abs();
        assert!(
            magnitude <= limits.torque,
            "torque {magnitude} above its limit {}",
            limits.torque
        );
        let has_reference = was_energised || self.servo.reference().is_some();
        assert!(
            magnitude == 0 || has_reference,
            "torque {magnitude} without a reference"
        );
        let enables = torque.control.command() == Some(Command::EnableOperation);
        assert!(
            !enables || was_energised || self.servo.drive().is_energised(),
            "the stage is enabled without a reason"
        );
    }

    fn look_at_cycles(&mut self, cycles: u64, limits: &Limits, fault: Option<Fault>) {
        let drive = *self.servo.drive();
        self.seen.cycles += cycles;
        self.seen.bridged += u64::from(self.servo.bridged() != (0, 0));
        let settings = self.servo.settings();
        let has_model = settings.is_some_and(|settings| settings.config.friction().is_some());
        self.seen.modelled += u64::from(has_model);
        self.seen.refined += u64::from(self.servo.refined_level_millionths() != 1_000_000);
        if drive == Drive::OperationEnabled {
            assert!(
                self.stage_says_enabled,
                "operation enabled without a stage that confirmed"
            );
            self.seen.enabled += cycles;
        }
        self.look_at_offset(limits);
        let reference = self.servo.reference();
        let rebased = fault == Some(Fault::FollowingError) && self.fault_before != fault;
        if let (Some(before), Some(now)) = (self.before, reference) {
            self.look_at_reference(cycles, limits, &before, &now);
        } else if let Some(now) = reference {
            self.begun = begun(&now);
        }
        // After a following error the track begins where the axis is.
        self.before = reference.filter(|_| !rebased);
    }

    fn look_at_reference(
        &mut self,
        cycles: u64,
        limits: &Limits,
        before: &Reference,
        now: &Reference,
    ) {
        let [was, is] = [before, now].map(|reference| i64::from(reference.velocity.0.to_bits()));
        let context = || {
            format!(
                "{:?}, {cycles} cycles, {limits:?}\n{before:?}\n{now:?}",
                self.servo.drive()
            )
        };
        let change = (is - was).abs();
        // x(k + 1) was commanded in cycle k: a set that becomes active between them is too late for
        // it.
        let (velocity, acceleration) = (limits.velocity, limits.acceleration);
        let (velocity_before, acceleration_before) = self.limits_before;
        let allowed = i64::try_from(cycles).unwrap()
            * (acceleration.max(acceleration_before) + ACCELERATION_BITS);
        assert!(
            change <= allowed,
            "velocity changed by {change}, {allowed} allowed: {}",
            context()
        );
        let is_fast = is.abs() > velocity.max(velocity_before) + VELOCITY_BIT;
        assert!(
            !is_fast || is.abs() <= was.abs(),
            "velocity {is} above its limit and not falling: {}",
            context()
        );
        assert!(
            !is_fast || self.servo.drive().fault().is_some(),
            "no fault with velocity {is}: {}",
            context()
        );
        // x(k) was commanded before the limits became active. Where it was extrapolated and turned
        // round, only this cycle shows with which velocity (`Reference::next_velocity`).
        if core::mem::take(&mut self.is_first) {
            self.begun.1 = self.begun.1.max(is.abs());
        }
        self.look_at_position(limits, now, &context());
        self.limits_before = (velocity, acceleration);
        self.seen.moving += u64::from(is != 0);
        self.seen.overruns += u64::from(is_fast || now.overrun);
    }

    /// Ways in bits of a position, 2⁻⁸ of 10 nm; velocities have four more.
    fn look_at_position(&self, limits: &Limits, now: &Reference, context: &str) {
        let at = now.position.0.to_bits();
        let (from, speed) = (self.begun.0, self.begun.1.abs() / 16);
        let acceleration = (limits.acceleration / 16).max(1);
        let braking = speed * speed / (2 * acceleration) + 2 * speed + 2;
        for (beyond, begun) in [
            (at - limits.high, from - limits.high),
            (limits.low - at, limits.low - from),
        ] {
            assert!(
                beyond <= begun.max(0) + braking,
                "{beyond} beyond the travel, {braking} allowed: {context}"
            );
            let outwards = beyond > begun.max(0) + 2 * speed + 2;
            assert!(
                !outwards || self.servo.drive().fault().is_some(),
                "no fault {beyond} beyond the travel: {context}"
            );
        }
    }

    fn look_at_offset(&mut self, limits: &Limits) {
        let offset = i64::from(self.servo.backlash_offset().0.to_bits()).abs();
        let allowed = limits.half_gap.max(self.offset_before);
        assert!(
            offset <= allowed,
            "offset {offset}, half the gap {}",
            limits.half_gap
        );
        self.offset_before = offset;
        self.seen.offsets += u64::from(offset > 0);
    }
}

/// Position and the faster of the two velocities that are commanded already.
fn begun(reference: &Reference) -> (i64, i64) {
    let [now, next] = [reference.velocity, reference.next_velocity]
        .map(|velocity| i64::from(velocity.0.to_bits()));
    (reference.position.0.to_bits(), now.abs().max(next.abs()))
}

impl Station for Witness {
    fn ids(&self) -> AxisIds {
        self.servo.ids()
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        self.servo.boot().iter().for_each(|frame| send(*frame));
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let mut frames = Vec::new();
        self.hear(frame);
        self.servo
            .take(frame, now_us, &mut |frame| frames.push(frame));
        self.pass_on(&frames, send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let mut frames = Vec::new();
        self.servo.time(now_us, &mut |frame| frames.push(frame));
        self.pass_on(&frames, send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        Station::wake_at_us(&self.servo)
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.servo.sync_due_us()
    }
}

/// A point mass without friction that answers SYNC, and a stage that now and then refuses or drops
/// out.
struct PointMass {
    ids: AxisIds,
    dice: Dice,
    position_m: f64,
    velocity_m_per_s: f64,
    force_n: f64,
    next_n: f64,
    state: DriveState,
    cycle: u64,
}

impl PointMass {
    const MASS_KG: f64 = 931.65;
    const LEAD_M: f64 = 0.010;

    fn new(ids: AxisIds, seed: u64) -> Self {
        let (position_m, velocity_m_per_s, force_n, next_n) = (0.0, 0.0, 0.0, 0.0);
        let state = DriveState::SwitchOnDisabled;
        Self {
            ids,
            dice: Dice(seed),
            position_m,
            velocity_m_per_s,
            force_n,
            next_n,
            state,
            cycle: 0,
        }
    }

    fn step(&mut self) {
        let period_s = 1.0e-3;
        self.velocity_m_per_s += self.force_n / Self::MASS_KG * period_s;
        self.position_m += self.velocity_m_per_s * period_s;
        if self.state != DriveState::OperationEnabled {
            self.velocity_m_per_s *= 0.9;
        }
        self.force_n = self.next_n;
    }

    fn status(&self) -> Message {
        let status = StatusWord::of(self.state).with(StatusWord::VOLTAGE_ENABLED);
        let torque = TorqueMicroNm(0);
        Message::PlantStatus(PlantStatus {
            status,
            brake: BrakeState::NotFitted,
            fault: None,
            torque,
        })
    }

    fn on_sync(&mut self, counter: SyncCounter, send: &mut dyn FnMut(CanFrame)) {
        self.step();
        self.cycle += 1;
        let motor = (self.position_m / Self::LEAD_M * 1_048_576.0).round() as i64;
        let load = LoadIncrements24::from_counts((self.position_m * 1.0e8).round() as i64);
        let feedback = Feedback {
            motor: MotorIncrements(motor as i32),
            load,
            counter,
        };
        send(Message::Feedback(feedback).encode(self.ids));
        if self.dice.once_in(3000) && self.state == DriveState::OperationEnabled {
            (self.state, self.force_n, self.next_n) = (DriveState::SwitchOnDisabled, 0.0, 0.0);
            send(self.status().encode(self.ids));
        }
        if self.cycle.is_multiple_of(10) {
            send(self.status().encode(self.ids));
        }
        if self.cycle.is_multiple_of(100) {
            send(Message::PlantHeartbeat(NmtState::Operational).encode(self.ids));
        }
    }

    fn on_torque(&mut self, torque: protocol::message::Torque, send: &mut dyn FnMut(CanFrame)) {
        let before = self.state;
        self.state = match torque.control.command() {
            Some(Command::EnableOperation)
                if before == DriveState::OperationEnabled || !self.dice.once_in(4) =>
            {
                DriveState::OperationEnabled
            }
            Some(Command::SwitchOn | Command::EnableOperation) => DriveState::SwitchedOn,
            Some(Command::Shutdown) => DriveState::ReadyToSwitchOn,
            _ => DriveState::SwitchOnDisabled,
        };
        let acts = self.state == DriveState::OperationEnabled;
        self.next_n = if acts {
            f64::from(torque.torque.0) * 1.0e-6 * std::f64::consts::TAU / Self::LEAD_M
        } else {
            0.0
        };
        if self.state != before {
            send(self.status().encode(self.ids));
        }
    }
}

impl Station for PointMass {
    fn ids(&self) -> AxisIds {
        self.ids
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        send(Message::PlantHeartbeat(NmtState::Initialising).encode(self.ids));
    }

    fn take(&mut self, frame: &CanFrame, _now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        match decode(self.ids, frame) {
            Ok(Decoded::Message(Message::Sync(counter))) => self.on_sync(counter, send),
            Ok(Decoded::Message(Message::Torque(torque))) => self.on_torque(torque, send),
            _ => {}
        }
    }

    fn time(&mut self, _now_us: u64, _send: &mut dyn FnMut(CanFrame)) {}

    fn wake_at_us(&self) -> Option<u64> {
        None
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }
}

/// A master that does what it likes.
struct Chaos {
    bus: InProcessBus,
    ids: AxisIds,
    dice: Dice,
    counter: SyncCounter,
    control: ControlWord,
    /// Where the master thinks the axis is.
    seen_m: f64,
    setpoint_m: f64,
    velocity_m_per_s: f64,
    wanted_m_per_s: f64,
    seed: u64,
    tick: u64,
}

/// Ticks after which the master brings the axis up again, and in which it is decent about it.
const ROUND: u64 = 600;
const WAY_UP: [ControlWord; 6] = [
    ControlWord::DISABLE_VOLTAGE,
    ControlWord::FAULT_RESET,
    ControlWord::DISABLE_VOLTAGE,
    ControlWord::SHUTDOWN,
    ControlWord::SWITCH_ON,
    ControlWord::ENABLE_OPERATION,
];
const EVERY_WORD: [u16; 12] = [
    0x00, 0x02, 0x06, 0x07, 0x0F, 0x0F, 0x0F, 0x80, 0x8F, 0x010F, 0x0107, 0xFFFF,
];

impl Chaos {
    fn new(bus: InProcessBus, ids: AxisIds, seed: u64) -> Self {
        Self {
            bus,
            ids,
            dice: Dice(seed),
            counter: SyncCounter::FIRST,
            control: ControlWord::DISABLE_VOLTAGE,
            seen_m: 0.0,
            setpoint_m: 0.0,
            velocity_m_per_s: 0.0,
            wanted_m_per_s: 0.0,
            seed,
            tick: 0,
        }
    }

    fn send(&mut self, message: Message) {
        self.bus.send(message.encode(self.ids));
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            let phase = self.tick % ROUND;
            match phase {
                0 => self.bring_up(),
                1..=60 => self.way_up(phase),
                _ => self.misbehave(),
            }
            self.cycle(phase);
            self.tick += 1;
        }
    }

    fn bring_up(&mut self) {
        self.inject(FaultPlan::default());
        self.send(Message::Nmt(NmtCommand::StartRemoteNode, None));
        let machine = one_axis();
        let set = workbench::drive_parameters::parameters(
            &machine.axes[0],
            1.0e-3,
            &AxisCompensation::default(),
        )
        .unwrap();
        for (entry, value) in set {
            self.write(entry.parameter, value);
        }
        self.commit();
    }

    fn way_up(&mut self, phase: u64) {
        self.control = WAY_UP[usize::try_from(phase / 8).unwrap().min(5)];
        (self.setpoint_m, self.velocity_m_per_s, self.wanted_m_per_s) = (self.seen_m, 0.0, 0.0);
        if phase == 60 {
            let seed = self.dice.roll();
            let share = self.dice.of(&[0, 0, 5, 20, 100]);
            self.inject(FaultPlan {
                seed,
                lost_per_mille: share,
                doubled_per_mille: share,
                late_per_mille: share,
                corrupted_per_mille: share,
                ..FaultPlan::default()
            });
        }
    }

    fn inject(&mut self, plan: FaultPlan) {
        self.bus.inject(0, 0x11, plan);
        self.bus.inject(
            1,
            0x01,
            FaultPlan {
                seed: plan.seed ^ self.seed,
                ..plan
            },
        );
    }

    fn misbehave(&mut self) {
        if self.dice.once_in(400) {
            self.control = ControlWord(self.dice.of(&EVERY_WORD));
        }
        if self.dice.once_in(80) {
            self.wanted_m_per_s = self.dice.within(-0.6, 0.6);
        }
        if self.dice.once_in(2000) {
            self.velocity_m_per_s = self.wanted_m_per_s;
        }
        if self.dice.once_in(2000) {
            self.setpoint_m += self.dice.within(-0.02, 0.02);
        }
        if self.dice.once_in(150) {
            self.change_parameters();
        }
        if self.dice.once_in(1500) {
            let command = self.dice.of(&[
                NmtCommand::StartRemoteNode,
                NmtCommand::StopRemoteNode,
                NmtCommand::EnterPreOperational,
                NmtCommand::ResetNode,
                NmtCommand::ResetCommunication,
            ]);
            let node = self
                .dice
                .of(&[None, Some(self.ids.servo), Some(self.ids.plant)]);
            self.send(Message::Nmt(command, node));
        }
        if self.dice.once_in(2000) {
            self.counter =
                SyncCounter::new(1 + u8::try_from(self.dice.below(240)).unwrap()).unwrap();
        }
    }

    fn write(&mut self, parameter: Parameter, value: i32) {
        let entry = TABLE
            .iter()
            .find(|entry| entry.parameter == parameter)
            .unwrap();
        self.send(Message::SdoRequest(Request::Download(
            entry.address,
            Expedited::i32(value),
        )));
    }

    fn commit(&mut self) {
        self.send(Message::SdoRequest(Request::Download(
            COMMIT,
            Expedited::u32(COMMIT_KEY),
        )));
    }

    fn change_parameters(&mut self) {
        match self.dice.below(14) {
            10.. => self.change_compensation(),
            0 => self.write_within(Parameter::VelocityLimit, 20_000.0, 500_000.0),
            1 | 2 => {
                let limit = self.dice.within(1.0e6, 8.0e6) as i32;
                for parameter in [
                    Parameter::AccelerationLimit,
                    Parameter::QuickStopDeceleration,
                    Parameter::SlowDownDeceleration,
                ] {
                    self.write(parameter, limit);
                }
            }
            3 => {
                let (low, high) = (
                    self.dice.within(-25.0e6, -1.0e5),
                    self.dice.within(1.0e5, 25.0e6),
                );
                self.write(Parameter::PositionMin, low as i32);
                self.write(Parameter::PositionMax, high as i32);
            }
            4 => self.write_within(Parameter::TorqueLimit, 1.0e6, 14.0e6),
            5 => self.write_within(Parameter::BacklashGap, 0.0, 1.0e6),
            6 => self.write_within(Parameter::SetpointFilter, 0.0, 4.9),
            7 => self.write_within(Parameter::RampJerk, 0.0, 2.0e6),
            8 => {
                self.write_within(Parameter::QuickStopOption, 0.0, 6.9);
                self.write_within(Parameter::ShutdownOption, 0.0, 1.9);
                self.write_within(Parameter::FaultReactionOption, 0.0, 2.9);
                self.write_within(Parameter::AbortConnectionOption, 1.0, 3.9);
            }
            _ => {
                let cycles = self.dice.of(&[0, 1, 2, 4]);
                self.write(Parameter::SetpointPeriod, cycles);
                self.write_within(Parameter::SetpointMissesAllowed, 0.0, 20.9);
                self.write_within(Parameter::RefusalsAllowed, 0.0, 20.9);
            }
        }
        self.commit();
    }

    /// Another method, or another size of one, in whatever motion.
    fn change_compensation(&mut self) {
        match self.dice.below(6) {
            5 => self.change_schedule(),
            0 => {
                self.write_within(Parameter::PulseHeight, -5.0e7, 5.0e7);
                self.write_within(Parameter::PulseTime, 0.0, 2.0e8);
                self.write_within(Parameter::PulseStartDelay, 0.0, 5.0e4);
                self.write_within(Parameter::PulseShortestWay, 0.0, 1.0e6);
            }
            1 => self.write_within(Parameter::CoulombTorque, -2.0e6, 2.0e6),
            2 => {
                for level in Parameter::FRICTION_LEVELS {
                    self.write(level, 0);
                }
            }
            _ => self.change_model(),
        }
    }

    /// Pulses over the acceleration, at some of its points.
    fn change_schedule(&mut self) {
        self.write_within(Parameter::AdaptiveFirst, 1.0, 1.0e6);
        for _ in 0..3 {
            let place = self.dice.below(9) as usize;
            let height = self.dice.of(&[
                Parameter::ADAPTIVE_FORWARD[place],
                Parameter::ADAPTIVE_BACKWARD[place],
            ]);
            let most = self.dice.of(&[0.0, 5.0e7]);
            self.write_within(height, -most, most);
            self.write_within(Parameter::ADAPTIVE_TIME[place], 0.0, 2.0e8);
            self.write_within(Parameter::ADAPTIVE_DELAY[place], 0.0, 5.0e4);
        }
    }

    fn change_model(&mut self) {
        for _ in 0..3 {
            let element = self.dice.below(10) as usize;
            self.write_within(Parameter::FRICTION_LEVELS[element], 0.0, 1.0e6);
            self.write_within(Parameter::FRICTION_WAYS[element], 1.0e3, 1.0e6);
        }
        let place = self.dice.below(17) as usize;
        self.write_within(Parameter::LEVEL_FACTORS[place], 0.0, 3.9e6);
        for (parameter, low, high) in [
            (Parameter::LevelSpan, 0.0, 1.0e5),
            (Parameter::LevelLagWay, 0.0, 1.0e6),
            (Parameter::LevelLagTime, 0.0, 2.0e4),
            (Parameter::ViscousTorque, 0.0, 1.0e7),
            (Parameter::FrictionAhead, 0.0, 5.0e3),
            (Parameter::WindupAhead, -5.0e3, 5.0e3),
            (Parameter::FrictionDamping, 0.0, 5.0e3),
            (Parameter::Windup, 0.0, 1.0e6),
            (Parameter::MotorInertia, 0.0, 1.0e7),
            (Parameter::LevelSlope, -7.0e6, 7.0e6),
            (Parameter::LevelBend, -4.0e7, 4.0e7),
            (Parameter::LevelTuning, 0.0, 1.0e6),
            (Parameter::LevelSettling, 0.0, 2.0e4),
            (Parameter::LevelSettlingWay, 0.0, 2.0e5),
            (Parameter::ViscousAsymmetry, -1.0e7, 1.0e7),
            (Parameter::LevelAsymmetry, -5.0e5, 5.0e5),
            (Parameter::WayAsymmetry, -9.0e5, 9.0e5),
            (Parameter::FRICTION_ON_MOTOR[0], 0.0, 1.0e6),
            (Parameter::GapWidth, 0.0, 5.0e5),
            (Parameter::GapTorque, 1.0e4, 5.0e5),
            (Parameter::GapVelocity, 0.0, 1.0e4),
            (Parameter::TableInertia, 0.0, 1.0e7),
            (Parameter::TableTorque, -5.0e5, 5.0e5),
            (Parameter::RippleTorque1, 0.0, 5.0e5),
            (Parameter::RipplePeriod1, 1.0e4, 2.0e9),
            (Parameter::RipplePhase1, -1.0e6, 1.0e6),
        ] {
            if self.dice.once_in(3) {
                self.write_within(parameter, low, high);
            }
        }
    }

    fn write_within(&mut self, parameter: Parameter, low: f64, high: f64) {
        let value = self.dice.within(low, high) as i32;
        self.write(parameter, value);
    }

    fn cycle(&mut self, phase: u64) {
        self.bus.pass(PERIOD_US);
        let start_us = self.bus.now_us();
        let decent = phase <= 60;
        if decent || !self.dice.once_in(300) {
            self.send(Message::Sync(self.counter));
        }
        // Mostly what an axis of 5 m/s² can follow, and back before the end of travel, if none of
        // that was lowered.
        if self.setpoint_m.abs() > 0.20 {
            self.wanted_m_per_s = -0.3 * self.setpoint_m.signum();
        }
        let change = (self.wanted_m_per_s - self.velocity_m_per_s).clamp(-4.0e-3, 4.0e-3);
        self.velocity_m_per_s += change;
        self.setpoint_m += self.velocity_m_per_s * 1.0e-3;
        if decent || !self.dice.once_in(300) {
            let position = SetpointFine::saturating((self.setpoint_m * 2.56e10).round() as i64);
            let counter = self.counter.next();
            self.send(Message::Setpoint(Setpoint {
                control: self.control,
                counter,
                position,
            }));
        }
        while let Some(frame) = self.bus.receive_until(start_us + PERIOD_US - 50) {
            if let Ok(Decoded::Message(Message::Feedback(feedback))) = decode(self.ids, &frame) {
                self.seen_m = f64::from(feedback.motor.0) * PointMass::LEAD_M / 1_048_576.0;
            }
        }
        self.counter = self.counter.next();
    }
}

fn run(seed: u64, ticks: u64, plant: Box<dyn Station>) -> Seen {
    let ids = AxisIds::of_axis(0).unwrap();
    let witness = Shared::new(Witness::new(Servo::new(ids)));
    let mut bus = InProcessBus::new();
    bus.add(plant);
    bus.add(Box::new(witness.clone()));
    Chaos::new(bus, ids, seed).run(ticks);
    let seen = witness.borrow().seen;
    println!("seed {seed}: {seen:?}");
    seen
}

fn expect_all(seen: &Seen, ticks: u64) {
    assert!(seen.cycles > ticks / 2, "{seen:?}");
    assert!(
        seen.enabled > ticks / 10 && seen.moving > ticks / 10,
        "hardly ever enabled or moving: {seen:?}"
    );
    assert!(seen.sets > ticks / 2000 && seen.bridged > 0, "{seen:?}");
    assert!(seen.modelled > ticks / 10, "{seen:?}");
    assert!(seen.refined > 0 || ticks < RARE, "{seen:?}");
    // A gap that is compensated, and a limit that is lowered while the axis is beyond it, are rare.
    let overrun = seen.offsets > 0
        && seen.overruns > 0
        && seen.faults[usize::from(Fault::LimitOverrun.code())] > 0;
    assert!(
        overrun || ticks < RARE,
        "no limit was lowered in motion: {seen:?}"
    );
}

/// Ticks in which everything happens at least once.
const RARE: u64 = 400_000;

/// Seed and ticks of each run.
fn runs() -> Vec<(u64, u64)> {
    let ticks = Scope::now().pick(10_000, 400_000, 1_000_000);
    let seeds = Scope::now().rows("seeds", &[1, 2, 3, 4, 5], 1, 1);
    seeds.iter().map(|seed| (*seed, ticks)).collect()
}

#[test]
fn whatever_the_bus_says_the_servo_with_the_plant_stays_within_its_limits() {
    for (seed, ticks) in runs() {
        let ids = AxisIds::of_axis(0).unwrap();
        let axis = one_axis().axes.remove(0).actual;
        expect_all(
            &run(
                seed,
                ticks,
                Box::new(PlantNode::new(ids, axis, 1.0e-3, seed)),
            ),
            ticks,
        );
    }
}

#[test]
fn whatever_the_bus_says_the_servo_with_a_point_mass_stays_within_its_limits() {
    for (seed, ticks) in runs() {
        let plant = PointMass::new(AxisIds::of_axis(0).unwrap(), seed);
        expect_all(&run(seed, ticks, Box::new(plant)), ticks);
    }
}
