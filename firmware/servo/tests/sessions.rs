//! Bench sessions with the drive node alone: frames and time in, frames out, each session a claim
//! about what the node does.
//!
//! The bench is a master (SYNC, setpoints), a stage (status with its state and brake, as the
//! control word asks) and an axis that moves exactly as the commanded reference does. One motor
//! increment is 10 nm, so encoder counts and positions are the same numbers. Any frame can be left
//! out.

use controller::reference::Reference;
use protocol::cob::AxisIds;
use protocol::message::{
    Decoded, EmergencyMessage, Feedback, NmtCommand, NmtState, PlantStatus, Setpoint, Status,
    Torque, decode,
};
use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};
use protocol::states::{BrakeState, Command, ControlWord, DriveState, StatusWord};
use protocol::weight::{LoadIncrements24, MotorIncrements, SetpointFine, TorqueMicroNm};
use protocol::{CanFrame, Fault, Message, SyncCounter};
use servo::Servo;
use servo::commit::Commit;
use servo::objects::{COMMIT, COMMIT_KEY, DECLARED_PERIOD, Parameter, TABLE};

const PERIOD_US: u64 = 1000;
/// A cycle closes here without its frames, µs after it began.
const DEADLINE_US: u64 = 600;
/// The plant's feedback comes here where the plant missed SYNC, µs after that was due.
const OWN_TIMER_US: u64 = 300;

/// Frames of a cycle that come.
#[derive(Clone, Copy)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each frame comes or does not"
)]
struct Comes {
    sync: bool,
    feedback: bool,
    setpoint: bool,
    /// Of the plant, every 80 cycles.
    heartbeat: bool,
}

const ALL: Comes = Comes {
    sync: true,
    feedback: true,
    setpoint: true,
    heartbeat: true,
};

struct Bench {
    servo: Servo,
    ids: AxisIds,
    now_us: u64,
    period_us: u64,
    counter: SyncCounter,
    comes: Comes,
    control: ControlWord,
    /// Counts of 10 nm.
    setpoint: i64,
    velocity: i64,
    position: i64,
    stage: DriveState,
    stage_refuses: bool,
    brake: BrakeState,
    /// Cycles that the brake takes; none is fitted where this is zero.
    brake_cycles: u32,
    brake_left: u32,
    sent: Vec<(u64, Message)>,
}

impl Bench {
    /// A node in NMT operational with an axis of 5 m/s², 0.5 m/s and 9 kN at 10 mm of lead.
    fn new(changes: &[(Parameter, i32)]) -> Self {
        let ids = AxisIds::of_axis(0).unwrap();
        let mut bench = Self {
            servo: Servo::new(ids),
            ids,
            now_us: 0,
            period_us: PERIOD_US,
            counter: SyncCounter::FIRST,
            comes: ALL,
            control: ControlWord::DISABLE_VOLTAGE,
            setpoint: 0,
            velocity: 0,
            position: 0,
            stage: DriveState::SwitchOnDisabled,
            stage_refuses: false,
            brake: BrakeState::NotFitted,
            brake_cycles: 0,
            brake_left: 0,
            sent: Vec::new(),
        };
        bench.set(&AXIS);
        bench.set(changes);
        bench.nmt(NmtCommand::StartRemoteNode);
        bench
    }

    fn with_brake(changes: &[(Parameter, i32)], cycles: u32) -> Self {
        let mut bench = Self::new(changes);
        (bench.brake, bench.brake_cycles) = (BrakeState::Closed, cycles);
        bench
    }

    /// Up to operation enabled.
    fn enabled(changes: &[(Parameter, i32)]) -> Self {
        let mut bench = Self::new(changes);
        bench.way_up();
        assert_eq!(bench.state(), DriveState::OperationEnabled);
        bench
    }

    fn way_up(&mut self) {
        for control in [
            ControlWord::SHUTDOWN,
            ControlWord::SWITCH_ON,
            ControlWord::ENABLE_OPERATION,
        ] {
            self.control = control;
            self.cycles(3);
        }
    }

    /// At 0.1 m/s, which takes 40 ms at 2.5 m/s².
    fn moving() -> Self {
        let mut bench = Self::enabled(&[]);
        for velocity in (0..=10_000).step_by(250) {
            bench.velocity = velocity;
            bench.cycle();
        }
        bench.cycles(20);
        assert_eq!(bench.state(), DriveState::OperationEnabled);
        bench
    }

    fn state(&self) -> DriveState {
        self.servo.drive().state()
    }

    fn reference(&self) -> Reference {
        self.servo.reference().unwrap()
    }

    /// Commanded velocity, counts per cycle.
    fn speed(&self) -> f64 {
        self.servo
            .reference()
            .map_or(0.0, |reference| reference.velocity.0.to_num())
    }

    fn set(&mut self, values: &[(Parameter, i32)]) {
        for (parameter, value) in values {
            assert!(
                matches!(self.write(*parameter, *value), Response::Downloaded(_)),
                "{parameter:?} {value}"
            );
        }
        assert!(matches!(self.commit(), Response::Downloaded(_)));
    }

    fn write(&mut self, parameter: Parameter, value: i32) -> Response {
        let entry = TABLE
            .iter()
            .find(|entry| entry.parameter == parameter)
            .unwrap();
        self.download(entry.address, Expedited::i32(value))
    }

    fn commit(&mut self) -> Response {
        self.download(COMMIT, Expedited::u32(COMMIT_KEY))
    }

    /// A commit that somebody else converts: what is to be converted.
    fn commit_beside(&mut self) -> Commit {
        let commit = Request::Download(COMMIT, Expedited::u32(COMMIT_KEY));
        let commit = Message::SdoRequest(commit).encode(self.ids);
        let frames = self.servo.hear(&commit, self.now_us);
        assert!(frames.is_empty(), "the answer comes later");
        let mut handed_out = Commit::default();
        assert!(self.servo.begin_commit(&mut handed_out));
        assert!(!self.servo.begin_commit(&mut Commit::default()), "once");
        handed_out
    }

    /// What the node says to a set that was converted.
    fn converted(&mut self, commit: &Commit) -> Option<Response> {
        let mut commit = commit.clone();
        commit.convert();
        let frames = self.servo.end_commit(&commit).to_vec();
        self.keep(frames);
        match self.sent.pop() {
            Some((_, Message::SdoResponse(response))) => Some(response),
            Some(other) => {
                self.sent.push(other);
                None
            }
            None => None,
        }
    }

    fn download(&mut self, address: Address, data: Expedited) -> Response {
        self.give(Message::SdoRequest(Request::Download(address, data)));
        match self.sent.pop() {
            Some((_, Message::SdoResponse(response))) => response,
            other => panic!("no response: {other:?}"),
        }
    }

    fn nmt(&mut self, command: NmtCommand) {
        self.give(Message::Nmt(command, None));
    }

    /// A frame for the node; what it answers is kept.
    fn give(&mut self, message: Message) {
        let frames = self
            .servo
            .on_frame(&message.encode(self.ids), self.now_us)
            .to_vec();
        self.keep(frames);
    }

    fn keep(&mut self, frames: Vec<CanFrame>) {
        for frame in frames {
            let Ok(Decoded::Message(message)) = decode(self.ids, &frame) else {
                panic!("{frame:?}")
            };
            self.sent.push((self.now_us, message));
            if let Message::Torque(torque) = message {
                self.on_torque(torque);
            }
        }
    }

    /// Time passes until then; the node does what is due.
    fn pass_until(&mut self, until_us: u64) {
        while let Some(due) = self.servo.wake_at_us().filter(|due| *due <= until_us) {
            self.now_us = due.max(self.now_us);
            let frames = self.servo.on_time(self.now_us).to_vec();
            self.keep(frames);
        }
        self.now_us = until_us;
    }

    fn sync(&mut self) {
        self.give(Message::Sync(self.counter));
    }

    fn give_setpoint(&mut self) {
        let position = SetpointFine::saturating(self.setpoint * 256);
        self.give(Message::Setpoint(Setpoint {
            control: self.control,
            counter: self.counter.next(),
            position,
        }));
    }

    fn feedback(&self) -> Message {
        let (motor, load) = (
            i32::try_from(self.position).unwrap(),
            LoadIncrements24::from_counts(self.position),
        );
        Message::Feedback(Feedback {
            motor: MotorIncrements(motor),
            load,
            counter: self.counter,
        })
    }

    /// One cycle; a plant that misses SYNC sends its feedback by its own timer.
    fn cycle(&mut self) {
        let begin_us = self.now_us;
        self.setpoint += self.velocity;
        let Comes {
            sync,
            feedback,
            setpoint,
            heartbeat,
        } = self.comes;
        if sync {
            self.sync();
        }
        if setpoint {
            self.give_setpoint();
        }
        if feedback && !sync {
            self.pass_until(begin_us + OWN_TIMER_US);
        }
        if feedback {
            self.give(self.feedback());
        }
        if heartbeat && self.counter.get().is_multiple_of(80) {
            self.give(Message::PlantHeartbeat(NmtState::Operational));
        }
        self.move_brake();
        self.pass_until(begin_us + self.period_us);
        self.counter = self.counter.next();
        if let Some(reference) = self.servo.reference() {
            self.position = reference.position.after(reference.next_velocity).0.to_num();
        }
    }

    fn cycles(&mut self, cycles: u32) {
        (0..cycles).for_each(|_| self.cycle());
    }

    fn on_torque(&mut self, torque: Torque) {
        let before = (self.stage, self.brake);
        self.stage = match torque.control.command() {
            Some(Command::EnableOperation) if !self.stage_refuses => DriveState::OperationEnabled,
            Some(Command::SwitchOn | Command::EnableOperation) => DriveState::SwitchedOn,
            Some(Command::Shutdown) => DriveState::ReadyToSwitchOn,
            _ => DriveState::SwitchOnDisabled,
        };
        let releases = torque.control.has(ControlWord::RELEASE_BRAKE);
        if self.brake_cycles > 0 && releases != self.is_released() {
            (self.brake, self.brake_left) = (BrakeState::Moving, self.brake_cycles);
            self.brake_opens(releases);
        }
        if before != (self.stage, self.brake) {
            self.report();
        }
    }

    fn is_released(&self) -> bool {
        self.brake == BrakeState::Open
            || self.brake == BrakeState::Moving && self.brake_left & OPENS != 0
    }

    fn brake_opens(&mut self, opens: bool) {
        self.brake_left |= if opens { OPENS } else { 0 };
    }

    fn move_brake(&mut self) {
        if self.brake != BrakeState::Moving {
            return;
        }
        self.brake_left -= 1;
        if self.brake_left & !OPENS == 0 {
            self.brake = if self.brake_left & OPENS != 0 {
                BrakeState::Open
            } else {
                BrakeState::Closed
            };
            self.report();
        }
    }

    fn report(&mut self) {
        let status = StatusWord::of(self.stage).with(StatusWord::VOLTAGE_ENABLED);
        let status = PlantStatus {
            status,
            brake: self.brake,
            fault: None,
            torque: TorqueMicroNm(0),
        };
        self.give(Message::PlantStatus(status));
    }

    /// What was sent since the last look.
    fn take_sent(&mut self) -> Vec<(u64, Message)> {
        std::mem::take(&mut self.sent)
    }

    fn torques(&mut self) -> Vec<(u64, Torque)> {
        let torque = |(at, message)| match message {
            Message::Torque(torque) => Some((at, torque)),
            _ => None,
        };
        self.take_sent().into_iter().filter_map(torque).collect()
    }

    fn statuses(&mut self) -> Vec<(u64, Status)> {
        let status = |(at, message)| match message {
            Message::Status(status) => Some((at, status)),
            _ => None,
        };
        self.take_sent().into_iter().filter_map(status).collect()
    }

    fn emergencies(&mut self) -> Vec<Option<Fault>> {
        let emergency = |(_, message)| match message {
            Message::ServoEmergency(EmergencyMessage {
                vendor_specific: [code, ..],
                ..
            }) => Some(Fault::from_code(code)),
            _ => None,
        };
        self.take_sent().into_iter().filter_map(emergency).collect()
    }
}

/// The bit of [`Bench::brake_left`] that says that the brake is opening.
const OPENS: u32 = 1 << 31;

/// 931.65 kg at a lead of 10 mm, as the reference machine; the loop is closed on the motor.
const AXIS: [(Parameter, i32); 10] = [
    (Parameter::PositionSource, 0),
    (Parameter::PositionGain, 400_000),
    (Parameter::Inertia, 14_827_700),
    (Parameter::VelocityBandwidth, 300_000),
    (Parameter::IntegralCorner, 75_000),
    (Parameter::TorqueLimit, 14_323_945),
    (Parameter::VelocityLimit, 500_000),
    (Parameter::AccelerationLimit, 5_000_000),
    (Parameter::PresetTorque, 1_000_000),
    (Parameter::SyncTimeout, 0),
];

#[test]
fn operation_is_enabled_only_after_the_stage_has_confirmed() {
    let mut bench = Bench::new(&[]);
    bench.stage_refuses = true;
    bench.way_up();
    assert_ne!(bench.state(), DriveState::OperationEnabled);
    let mut bench = Bench::new(&[]);
    bench.way_up();
    assert_eq!(bench.state(), DriveState::OperationEnabled);
    let torques = bench.torques();
    let enables = |torque: &Torque| torque.control.command() == Some(Command::EnableOperation);
    let asked = torques
        .iter()
        .position(|(_, torque)| enables(torque))
        .unwrap();
    let told = torques
        .iter()
        .position(|(_, torque)| torque.control.has(ControlWord::RELEASE_BRAKE))
        .unwrap();
    assert_eq!(
        told,
        asked + 1,
        "the status comes within the cycle in which the stage was asked"
    );
}

#[test]
fn ready_to_switch_on_and_enable_operation_go_both_steps() {
    let mut bench = Bench::new(&[]);
    bench.control = ControlWord::SHUTDOWN;
    bench.cycles(3);
    assert_eq!(bench.state(), DriveState::ReadyToSwitchOn);
    bench.control = ControlWord::ENABLE_OPERATION;
    bench.cycles(3);
    assert_eq!(bench.state(), DriveState::OperationEnabled);
}

#[test]
fn a_stage_that_refuses_is_a_fault_within_three_cycles() {
    let mut bench = Bench::new(&[]);
    bench.stage_refuses = true;
    for control in [ControlWord::SHUTDOWN, ControlWord::SWITCH_ON] {
        bench.control = control;
        bench.cycles(3);
    }
    bench.control = ControlWord::ENABLE_OPERATION;
    bench.take_sent();
    bench.cycles(3);
    assert_eq!(
        bench.servo.drive().fault(),
        None,
        "its patience is three cycles"
    );
    bench.cycles(1);
    assert_eq!(bench.emergencies(), [Some(Fault::StageRefused)]);
    assert_eq!(bench.servo.torque().to_micro_nm_lossy(), 0);
}

#[test]
fn a_stage_that_drops_out_is_a_fault_at_once() {
    let mut bench = Bench::enabled(&[]);
    bench.stage = DriveState::SwitchOnDisabled;
    bench.report();
    assert_eq!(bench.servo.drive().fault(), Some(Fault::StageLost));
    bench.take_sent();
    bench.cycle();
    let [(_, torque)] = bench.torques()[..] else {
        panic!("one torque a cycle")
    };
    assert_eq!(
        (torque.torque.0, torque.control),
        (0, ControlWord::DISABLE_VOLTAGE)
    );
}

#[test]
fn the_brake_opens_under_torque_and_torque_stays_until_it_bites() {
    let brake = [
        (Parameter::BrakeOpening, 30_000),
        (Parameter::BrakeClosing, 40_000),
    ];
    let mut bench = Bench::with_brake(&brake, 30);
    bench.way_up();
    assert_eq!(
        bench.state(),
        DriveState::SwitchedOn,
        "the brake is on its way"
    );
    assert!(
        bench.servo.torque().to_micro_nm_lossy() > 900_000,
        "the preset holds the axis meanwhile"
    );
    bench.cycles(40);
    assert_eq!(
        (bench.state(), bench.brake),
        (DriveState::OperationEnabled, BrakeState::Open)
    );
    bench.control = ControlWord::SWITCH_ON;
    bench.take_sent();
    bench.cycles(20);
    assert_eq!(
        (bench.stage, bench.brake),
        (DriveState::OperationEnabled, BrakeState::Moving)
    );
    assert!(
        bench
            .torques()
            .iter()
            .all(|(_, torque)| torque.torque.0 > 900_000)
    );
    bench.cycles(20);
    assert_eq!(
        (bench.state(), bench.brake),
        (DriveState::SwitchedOn, BrakeState::Closed)
    );
    assert_eq!(bench.servo.torque().to_micro_nm_lossy(), 0);
}

#[test]
fn without_sync_the_torque_is_there_at_the_deadline_of_the_sync_that_was_due() {
    let mut bench = Bench::enabled(&[]);
    bench.comes = Comes {
        sync: false,
        feedback: false,
        setpoint: false,
        ..ALL
    };
    bench.take_sent();
    let due_us = bench.now_us;
    bench.cycle();
    let [(at_us, torque)] = bench.torques()[..] else {
        panic!("one torque a cycle")
    };
    assert_eq!(
        (at_us, torque.control.command()),
        (due_us + DEADLINE_US, Some(Command::EnableOperation))
    );
    bench.comes = ALL;
    bench.cycles(10);
    assert_eq!(
        (bench.state(), bench.servo.bridged()),
        (DriveState::OperationEnabled, (0, 0))
    );
}

#[test]
fn without_feedback_the_torque_comes_at_six_tenths_of_the_period() {
    let mut bench = Bench::enabled(&[]);
    bench.comes.feedback = false;
    bench.take_sent();
    let begin_us = bench.now_us;
    bench.cycle();
    let [(at_us, torque)] = bench.torques()[..] else {
        panic!("one torque a cycle")
    };
    assert_eq!(
        (at_us, torque.counter.next()),
        (begin_us + DEADLINE_US, bench.counter)
    );
    let counts = bench.servo.counts();
    assert_eq!((counts.bridged, counts.by_deadline), (1, 1));
}

#[test]
fn a_feedback_of_the_next_cycle_begins_it_where_sync_is_lost() {
    let mut bench = Bench::enabled(&[]);
    bench.comes = Comes {
        sync: false,
        setpoint: false,
        ..ALL
    };
    bench.take_sent();
    let due_us = bench.now_us;
    bench.pass_until(due_us + OWN_TIMER_US - 50);
    bench.give(bench.feedback());
    assert!(bench.torques().is_empty(), "the setpoint is not in yet");
    bench.give_setpoint();
    let [(at_us, torque)] = bench.torques()[..] else {
        panic!("one torque a cycle")
    };
    assert_eq!(
        (at_us, torque.counter),
        (due_us + OWN_TIMER_US - 50, bench.counter)
    );
    let begun_us = bench.now_us;
    bench.sync();
    assert_eq!(
        protocol::Station::sync_due_us(&bench.servo),
        Some(begun_us + PERIOD_US),
        "a late SYNC sets the phase"
    );
}

#[test]
fn late_doubled_and_stale_frames_change_nothing_and_are_counted() {
    let mut bench = Bench::enabled(&[]);
    let before = bench.servo.counts();
    let old = bench.feedback();
    bench.cycle();
    bench.take_sent();
    bench.sync();
    bench.give(old);
    bench.give_setpoint();
    bench.give_setpoint();
    bench.give(bench.feedback());
    bench.give(bench.feedback());
    assert_eq!(bench.torques().len(), 1, "one torque a cycle");
    let counts = bench.servo.counts();
    assert_eq!(
        (counts.stale - before.stale, counts.doubled - before.doubled),
        (1, 2),
        "{counts:?}"
    );
    assert_eq!(
        (counts.bridged, counts.refused),
        (before.bridged, before.refused)
    );
}

#[test]
fn heartbeats_come_in_every_nmt_state_by_time() {
    let mut bench = Bench::new(&[]);
    for (command, state) in [
        (NmtCommand::EnterPreOperational, NmtState::PreOperational),
        (NmtCommand::StopRemoteNode, NmtState::Stopped),
        (NmtCommand::StartRemoteNode, NmtState::Operational),
    ] {
        bench.nmt(command);
        bench.take_sent();
        bench.pass_until(bench.now_us + 1_000_000);
        let beats = bench.take_sent();
        let is_beat = |(_, message): &&(u64, Message)| *message == Message::ServoHeartbeat(state);
        assert_eq!(beats.iter().filter(is_beat).count(), 10, "{state:?}");
    }
    bench.cycles(1000);
    let beats = bench.take_sent().into_iter();
    let beats =
        beats.filter(|(_, message)| *message == Message::ServoHeartbeat(NmtState::Operational));
    assert_eq!(beats.count(), 10);
}

#[test]
fn an_nmt_stop_while_moving_ramps_down_first() {
    let mut bench = Bench::moving();
    bench.nmt(NmtCommand::StopRemoteNode);
    assert_eq!(bench.state(), DriveState::QuickStopActive);
    bench.cycles(10);
    assert!(
        (5_000.0..6_000.0).contains(&bench.speed()),
        "5 m/s² take 500 counts a cycle off: {}",
        bench.speed()
    );
    bench.cycles(15);
    assert_eq!(
        (bench.state(), bench.servo.reference()),
        (DriveState::SwitchOnDisabled, None)
    );
    bench.take_sent();
    bench.cycles(200);
    let after = bench.take_sent();
    assert!(
        after
            .iter()
            .all(|(_, message)| *message == Message::ServoHeartbeat(NmtState::Stopped)),
        "{after:?}"
    );
}

#[test]
fn an_nmt_reset_while_moving_ramps_down_and_then_boots() {
    let mut bench = Bench::moving();
    bench.take_sent();
    bench.nmt(NmtCommand::ResetNode);
    bench.cycles(40);
    let sent = bench.take_sent();
    let boot = sent
        .iter()
        .position(|(_, message)| *message == Message::ServoHeartbeat(NmtState::Initialising));
    let torques = sent[..boot.unwrap()]
        .iter()
        .filter(|(_, message)| matches!(message, Message::Torque(_)))
        .count();
    assert!((20..=25).contains(&torques), "{torques} cycles of ramp");
    assert_eq!(
        bench
            .servo
            .settings()
            .unwrap()
            .config
            .cascade
            .torque_limit
            .micro_nm(),
        0
    );
}

#[test]
fn the_status_comes_at_once_on_a_change_and_else_every_tenth_cycle() {
    let mut bench = Bench::enabled(&[]);
    bench.cycles(20);
    bench.take_sent();
    bench.cycles(20);
    let times: Vec<u64> = bench.statuses().iter().map(|(at, _)| *at).collect();
    assert_eq!(times.len(), 2);
    assert_eq!(times[1] - times[0], 10 * PERIOD_US);
    bench.control = ControlWord::DISABLE_VOLTAGE;
    bench.cycle();
    let [(_, status)] = bench.statuses()[..] else {
        panic!("a status in the cycle of the change")
    };
    assert_eq!(status.status.state(), Some(DriveState::SwitchOnDisabled));
}

#[test]
fn bits_4_9_10_and_12_say_supply_remote_standing_and_following() {
    let mut bench = Bench::moving();
    let word = |bench: &mut Bench| {
        bench.take_sent();
        bench.cycles(10);
        bench.statuses().last().unwrap().1.status
    };
    let has = |word: StatusWord, bits: u16| word.0 & bits == bits;
    let following = word(&mut bench);
    assert!(has(
        following,
        StatusWord::VOLTAGE_ENABLED | StatusWord::REMOTE | StatusWord::FOLLOWS_SETPOINT
    ));
    assert!(!has(following, StatusWord::TARGET_REACHED));
    bench.control = ControlWord::ENABLE_OPERATION.with(ControlWord::HALT);
    let halting = word(&mut bench);
    assert!(
        !has(halting, StatusWord::FOLLOWS_SETPOINT) && !has(halting, StatusWord::TARGET_REACHED)
    );
    bench.cycles(20);
    assert!(
        has(word(&mut bench), StatusWord::TARGET_REACHED),
        "halted and standing"
    );
    bench.nmt(NmtCommand::StopRemoteNode);
    bench.take_sent();
    bench.cycle();
    let [(_, status)] = bench.statuses()[..] else {
        panic!("a status at once")
    };
    assert!(
        !has(status.status, StatusWord::REMOTE),
        "control words do not count any more"
    );
}

#[test]
fn a_refusal_is_said_once_and_again_on_the_next_command() {
    let mut bench = Bench::new(&[]);
    bench.setpoint = 190_000;
    bench.way_up();
    bench.cycles(50);
    assert_eq!(bench.emergencies(), [Some(Fault::ReferenceTooFar)]);
    assert_eq!(
        (bench.state(), bench.servo.drive().fault()),
        (DriveState::SwitchedOn, None)
    );
    bench.control = ControlWord::SWITCH_ON;
    bench.cycles(2);
    bench.control = ControlWord::ENABLE_OPERATION;
    bench.cycles(10);
    assert_eq!(bench.emergencies(), [Some(Fault::ReferenceTooFar)]);
}

#[test]
fn only_the_rising_edge_of_a_fault_reset_resets() {
    let mut bench = Bench::enabled(&[]);
    bench.control = ControlWord(ControlWord::ENABLE_OPERATION.0 | ControlWord::FAULT_RESET.0);
    bench.cycles(3);
    bench.comes.feedback = false;
    bench.cycles(5);
    bench.comes.feedback = true;
    bench.cycles(20);
    assert_eq!(
        bench.servo.drive().fault(),
        Some(Fault::FeedbackMissing),
        "the bit stood before the fault"
    );
    bench.control = ControlWord::DISABLE_VOLTAGE;
    bench.cycles(3);
    assert_eq!(bench.state(), DriveState::Fault);
    bench.control = ControlWord::FAULT_RESET;
    bench.cycles(1);
    assert_eq!(bench.state(), DriveState::SwitchOnDisabled);
}

#[test]
fn a_set_that_is_committed_while_moving_acts_as_a_whole_in_the_next_cycle() {
    let mut bench = Bench::moving();
    bench.write(Parameter::VelocityLimit, 50_000);
    bench.cycles(5);
    assert_eq!(bench.speed(), 10_000.0, "written, not committed");
    assert!(matches!(bench.commit(), Response::Downloaded(_)));
    bench.cycles(3);
    assert_eq!(
        bench.servo.drive().fault(),
        Some(Fault::LimitOverrun),
        "faster than the new limit"
    );
    let before = bench.speed();
    bench.cycle();
    assert_eq!(
        before - bench.speed(),
        500.0,
        "and down with the acceleration of the axis"
    );
}

#[test]
fn while_a_set_is_converted_cycles_go_on_with_the_one_before() {
    let mut bench = Bench::moving();
    bench.write(Parameter::VelocityLimit, 50_000);
    let commit = bench.commit_beside();
    bench.take_sent();
    bench.cycles(20);
    let torques = bench.take_sent();
    let torques = torques
        .iter()
        .filter(|(_, message)| matches!(message, Message::Torque(_)));
    assert_eq!(torques.count(), 20);
    assert_eq!(bench.state(), DriveState::OperationEnabled);
    let refused = bench.write(Parameter::VelocityLimit, 60_000);
    assert!(matches!(refused, Response::Aborted(_, code) if code == AbortCode::DeviceState as u32));
    assert_eq!(bench.converted(&commit), Some(Response::Downloaded(COMMIT)));
    assert_eq!(
        bench.servo.drive().fault(),
        None,
        "not before the next cycle"
    );
    bench.cycles(3);
    assert_eq!(bench.servo.drive().fault(), Some(Fault::LimitOverrun));
    let answer = bench.converted(&commit);
    assert_eq!(answer, None, "nobody asked for it a second time");
}

#[test]
fn a_node_that_was_reset_is_as_a_new_one() {
    let mut bench = Bench::moving();
    bench.download(DECLARED_PERIOD, Expedited::u32(1000));
    bench.write(Parameter::VelocityLimit, 60_000);
    let _never_converted = bench.commit_beside();
    bench.control = ControlWord::DISABLE_VOLTAGE;
    bench.cycles(3);
    bench.nmt(NmtCommand::ResetNode);
    let without_number = |servo: &Servo| {
        let mut servo = servo.clone();
        let _ = servo.boot();
        let text = format!("{servo:?}");
        let (before, after) = text.split_once("Commits { number: ").unwrap();
        let (_number, after) = after.split_once(',').unwrap();
        format!("{before}{after}")
    };
    assert_eq!(
        without_number(&bench.servo),
        without_number(&Servo::new(bench.ids))
    );
}

#[test]
fn what_was_converted_for_a_node_that_is_reset_meanwhile_is_not_taken() {
    let mut bench = Bench::new(&[]);
    bench.write(Parameter::PulseStartDelay, 7000);
    let before = bench.commit_beside();
    bench.nmt(NmtCommand::ResetNode);
    bench.set(&AXIS);
    let set = bench.servo.settings().cloned();
    assert_eq!(bench.converted(&before), None);
    let after = bench.commit_beside();
    assert_eq!(bench.converted(&before), None, "it is not the one awaited");
    assert_eq!(bench.servo.settings(), set.as_ref());
    assert_eq!(bench.converted(&after), Some(Response::Downloaded(COMMIT)));
}

#[test]
fn other_encoders_are_refused_where_torque_came_while_they_were_converted() {
    let mut bench = Bench::new(&[]);
    bench.write(Parameter::EncoderIncrements, 500_000);
    let commit = bench.commit_beside();
    bench.way_up();
    assert_eq!(bench.state(), DriveState::OperationEnabled);
    let refused = Response::Aborted(COMMIT, AbortCode::DeviceState as u32);
    assert_eq!(bench.converted(&commit), Some(refused));
    bench.cycles(5);
    assert_eq!(bench.state(), DriveState::OperationEnabled);
}

#[test]
fn encoders_and_cycle_time_are_not_changed_while_there_is_torque() {
    let mut bench = Bench::enabled(&[]);
    bench.write(Parameter::EncoderIncrements, 500_000);
    let refused = Response::Aborted(COMMIT, AbortCode::DeviceState as u32);
    assert_eq!(bench.commit(), refused);
    bench.control = ControlWord::DISABLE_VOLTAGE;
    bench.cycles(2);
    assert!(matches!(bench.commit(), Response::Downloaded(_)));
}

#[test]
fn the_period_is_measured_and_another_one_is_refused() {
    let mut bench = Bench::new(&[]);
    bench.period_us = 2 * PERIOD_US;
    bench.cycles(5);
    bench.way_up();
    assert_eq!(bench.emergencies(), [Some(Fault::CycleTimeMismatch)]);
    let mut bench = Bench::new(&[]);
    bench.download(DECLARED_PERIOD, Expedited::u32(2000));
    bench.way_up();
    assert_eq!(bench.emergencies(), [Some(Fault::CycleTimeMismatch)]);
}

#[test]
fn a_row_of_lost_setpoints_is_ridden_out_and_a_longer_one_ramps_down() {
    let mut bench = Bench::moving();
    bench.comes.setpoint = false;
    bench.cycles(3);
    assert_eq!(
        (bench.state(), bench.speed()),
        (DriveState::OperationEnabled, 10_000.0)
    );
    bench.cycles(1);
    assert_eq!(bench.servo.drive().fault(), Some(Fault::SetpointMissing));
    assert_eq!(bench.state(), DriveState::FaultReactionActive);
    bench.cycles(30);
    assert_eq!(
        (bench.state(), bench.servo.torque().to_micro_nm_lossy()),
        (DriveState::Fault, 0)
    );
}

#[test]
fn halt_stops_and_its_end_goes_on_from_where_the_axis_stands() {
    let mut bench = Bench::moving();
    bench.control = ControlWord::ENABLE_OPERATION.with(ControlWord::HALT);
    bench.velocity = 0;
    bench.cycles(40);
    assert!(bench.reference().standing);
    assert_eq!(bench.state(), DriveState::OperationEnabled);
    bench.control = ControlWord::ENABLE_OPERATION;
    bench.cycles(200);
    let target: f64 = bench.reference().position.0.to_num();
    assert_eq!(
        (bench.state(), target),
        (DriveState::OperationEnabled, bench.setpoint as f64)
    );
}

#[test]
fn a_silent_heartbeat_of_the_plant_ramps_down_after_four_and_a_half() {
    let mut bench = Bench::enabled(&[]);
    bench.cycles(500);
    assert_eq!(bench.state(), DriveState::OperationEnabled);
    bench.comes.heartbeat = false;
    bench.take_sent();
    bench.cycles(360);
    assert_eq!(bench.state(), DriveState::OperationEnabled);
    bench.cycles(100);
    assert_eq!(bench.emergencies(), [Some(Fault::HeartbeatLost)]);
}

#[test]
fn a_sync_that_is_gone_is_a_fault_also_where_setpoints_and_feedback_still_show_the_cycles() {
    let mut bench = Bench::moving();
    bench.comes.sync = false;
    bench.take_sent();
    bench.cycles(5);
    assert_eq!(
        (bench.state(), bench.speed()),
        (DriveState::OperationEnabled, 10_000.0)
    );
    bench.cycles(2);
    assert_eq!(bench.emergencies(), [Some(Fault::SyncMissing)]);
    bench.cycles(25);
    assert_eq!(
        (bench.state(), bench.servo.torque().to_micro_nm_lossy()),
        (DriveState::Fault, 0)
    );
}

#[test]
fn an_emergency_of_the_plant_stops_the_axis_and_a_drop_out_keeps_its_name() {
    for (of_the_plant, fault) in [
        (Fault::TorqueMissing, Fault::PeerFault),
        (Fault::StageLost, Fault::StageLost),
    ] {
        let mut bench = Bench::enabled(&[]);
        let detail = [of_the_plant.code(), 1, 0, 0, 0];
        let register = protocol::message::ErrorRegister(protocol::message::ErrorRegister::GENERIC);
        let emergency = EmergencyMessage::new(of_the_plant.emergency_code(), register, detail);
        bench.give(Message::PlantEmergency(emergency));
        assert_eq!(bench.servo.drive(), &servo::drive::Drive::Faulted(fault));
    }
}

#[test]
fn the_brake_is_told_to_open_when_the_preset_acts_two_cycles_after_the_stage_confirmed() {
    let mut bench = Bench::with_brake(&[(Parameter::BrakeOpening, 30_000)], 30);
    bench.way_up();
    bench.cycles(5);
    let torques = bench.torques();
    let place = |control: u16| {
        torques
            .iter()
            .position(|(_, torque)| torque.control.has(control))
            .unwrap()
    };
    let (enabled, released) = (
        place(ControlWord::ENABLE_OPERATION.0),
        place(ControlWord::RELEASE_BRAKE),
    );
    // One cycle until the status is there, two until the torque acts.
    assert_eq!(released - enabled, 3);
}

#[test]
fn an_axis_that_moves_is_taken_over_as_it_moves_and_ramps_from_there() {
    let mut bench = Bench::new(&[
        (Parameter::EnableWindow, 100_000),
        (Parameter::PresetTorque, 0),
    ]);
    let coast = |bench: &mut Bench, cycles: u32| {
        for _ in 0..cycles {
            bench.position += if bench.servo.reference().is_none() {
                5_000
            } else {
                0
            };
            bench.setpoint = bench.position;
            bench.cycle();
        }
    };
    for control in [ControlWord::SHUTDOWN, ControlWord::SWITCH_ON] {
        bench.control = control;
        coast(&mut bench, 5);
    }
    bench.control = ControlWord::ENABLE_OPERATION;
    coast(&mut bench, 1);
    assert_eq!(bench.speed(), 5_000.0);
    let torque = bench.servo.torque().to_micro_nm_lossy();
    assert!(
        torque.abs() < 9_000_000,
        "5 m/s\u{b2} of 931.65 kg at 10 mm of lead are 7.4 N m: {torque}"
    );
    let before = bench.speed();
    coast(&mut bench, 1);
    assert!((before - bench.speed()).abs() <= 500.0);
    coast(&mut bench, 100);
    assert_eq!(
        (bench.state(), bench.servo.drive().fault()),
        (DriveState::OperationEnabled, None)
    );
}

/// SYNC comes before the deadline of a cycle whose frames do not come: that cycle closes because
/// the next one begins. A command of NMT that waited for its end leaves no cycle open behind it.
#[test]
fn a_node_that_leaves_with_an_early_sync_goes_on_beating() {
    let leaving = [
        (NmtCommand::StopRemoteNode, NmtState::Stopped),
        (NmtCommand::EnterPreOperational, NmtState::PreOperational),
        (NmtCommand::ResetNode, NmtState::PreOperational),
    ];
    for (command, state) in leaving {
        let mut bench = Bench::enabled(&[]);
        bench.nmt(command);
        let is_left = |bench: &Bench| bench.servo.reference().is_none();
        for _ in 0..5000 {
            bench.now_us += DEADLINE_US - 100;
            bench.give(Message::Sync(bench.counter));
            bench.counter = bench.counter.next();
            if is_left(&bench) {
                break;
            }
        }
        assert!(is_left(&bench), "{command:?}: still under torque");
        for _ in 0..20 {
            let due = bench.servo.wake_at_us().unwrap();
            bench.now_us = due;
            let frames = bench.servo.on_time(due).to_vec();
            bench.keep(frames);
            let next = bench.servo.wake_at_us().unwrap();
            assert!(next > due, "{command:?}: due again and again");
        }
        let mut said = bench.sent.iter().rev();
        let beat = said.find_map(|(_, message)| match message {
            Message::ServoHeartbeat(state) => Some(*state),
            _ => None,
        });
        assert_eq!(beat, Some(state), "{command:?}");
    }
}
