//! The plant as a CAN node, sans-I/O: a CiA 402 torque drive with encoders and a brake.
//!
//! SYNC k: integrate one period with the torque that is due; torque k − 1 becomes active; read the
//! encoders, send feedback k. Torque k comes in during the cycle and becomes active with SYNC k +
//! 1; that is the one cycle of transport delay of the loop.
//!
//! A frame comes or does not:
//!
//! - SYNC k + 1 does not come: the node's own timer begins the cycle ([`bus_time`]), or a torque
//!   frame with counter k + 1, which shows that it is on. The axis moves on and feedback k + 1 is
//!   sent.
//! - Torque k does not come: the last one is held, for [`TORQUE_MISSES_ALLOWED`] cycles in a row
//!   ([`torque`]); then torque zero, brake, and a fault: `TorqueMissing`, or `SyncMissing` where
//!   SYNC is gone as well. While SYNC alone is gone, torque goes on to act as long as the servo
//!   sends it: it is ramping down.
//! - Nobody commands torque, SYNC is gone and the axis stands: the timer stops until the next SYNC.
//!
//! The states of the power stage are in [`stage`]. What a control word changes (torque zero, brake)
//! counts from the begin of the cycle in which it came.
//!
//! NMT stop, pre-operational and reset wait until torque no longer acts. A reset is the node's, not
//! the machine's: an axis that moves goes on moving, its encoders counting and its noise going on,
//! and so does one whose reset had to wait. Only an axis that stands without torque when the reset
//! comes starts over from its start position, with its noise from the beginning, so that a run that
//! begins with a reset is the same run every time.

use protocol::cob::{AxisIds, FrameKind, HEARD_BY_PLANT};
use protocol::counter::SYNC_OVERFLOW;
use protocol::message::{self, Feedback, NmtCommand, NmtState, PlantStatus};
use protocol::states::{BrakeState, StatusWord};
use protocol::table::PLANT_STATUS_EVERY_CYCLES;
use protocol::weight::{LoadIncrements24, MotorIncrements, TorqueMicroNm};
use protocol::{CanFrame, Fault, Message, Station, SyncCounter, SyncEvent, SyncTracker};

use crate::axis::{Axis, AxisParameters};
use crate::mechanics::Motion;

pub mod bus_time;
mod frames;
pub mod stage;
pub mod torque;

pub use stage::TorqueDrive;
pub use torque::{Counters, TORQUE_MISSES_ALLOWED};

use bus_time::BusTime;
use stage::PowerStage;
use torque::TorqueInput;

/// An axis slower than this counts as standing, m/s: where a record counts a sample as moving, and
/// a way of 1 µm for the reference axis to come to rest.
const STANDING_M_PER_S: f64 = 1.0e-3;
/// … for this long, so that a table which rings on its screw is not caught at its turning point: a
/// period of 50 Hz, below the resonance of any screw drive.
const STANDING_S: f64 = 0.020;

/// Where a node puts its frames.
type Send<'a> = &'a mut dyn FnMut(CanFrame);

/// Motion of one cycle as it truly was, for instruments that look at the machine from outside (a
/// ballbar).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Position of the table, m.
    pub table_m: f64,
    /// Velocity of the table, m/s.
    pub table_m_per_s: f64,
    /// Position of the motor at the table, m.
    pub motor_m: f64,
    /// Velocity of the motor, m/s.
    pub motor_m_per_s: f64,
    /// Force that the motor delivers, N.
    pub force_n: f64,
    /// Force that is commanded to act, N.
    pub commanded_n: f64,
    /// Where the brake stands.
    pub brake: BrakeState,
}

/// What a plant status tells apart from the torque; a change of it is sent at once.
type Reported = (StatusWord, BrakeState, Option<Fault>);

/// The plant node of one axis.
#[derive(Debug)]
pub struct PlantNode {
    ids: AxisIds,
    axis: Axis,
    period_s: f64,
    newton_per_micro_nm: f64,
    nmt: NmtState,
    /// An NMT command that waits until torque no longer acts.
    deferred: Option<NmtCommand>,
    sync: SyncTracker,
    time: BusTime,
    stage: PowerStage,
    torque: TorqueInput,
    reported: Option<Reported>,
    /// How long the axis has been slow enough to count as standing.
    slow_s: f64,
    /// Cycles begun since NMT start.
    cycle: u32,
}

impl PlantNode {
    /// A plant at rest.
    #[must_use]
    pub fn new(ids: AxisIds, parameters: AxisParameters, period_s: f64, seed: u64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0.1 to 20 ms"
        )]
        let period_us = (period_s * 1.0e6).round() as u64;
        Self {
            ids,
            newton_per_micro_nm: parameters.newton_per_micro_nm(),
            axis: Axis::new(parameters, seed),
            period_s,
            nmt: NmtState::PreOperational,
            deferred: None,
            sync: SyncTracker::default(),
            time: BusTime::new(period_us, 0),
            stage: PowerStage::default(),
            torque: TorqueInput::default(),
            reported: None,
            slow_s: STANDING_S,
            cycle: 0,
        }
    }

    /// The same plant with another SYNC timeout; 0 means five periods.
    #[must_use]
    pub fn with_sync_timeout_us(mut self, timeout_us: u64) -> Self {
        self.time.set_timeout_us(timeout_us);
        self
    }

    /// What the axis truly does.
    #[must_use]
    pub fn truth(&self) -> Truth {
        let motion = self.axis.motion();
        Truth {
            table_m: motion.table_m,
            table_m_per_s: motion.table_m_per_s,
            motor_m: motion.motor_m,
            motor_m_per_s: motion.motor_m_per_s,
            force_n: self.axis.force_n(),
            commanded_n: self.torque.due_n(),
            brake: self.axis.brake(),
        }
    }

    /// The axis itself; a clone of it shows what it would do if it were let alone from here on.
    #[must_use]
    pub const fn axis(&self) -> &Axis {
        &self.axis
    }

    /// Puts the axis somewhere, in motion or not; for tests.
    pub fn place(&mut self, motion: Motion) {
        self.axis.place(motion);
    }

    /// State of the power stage.
    #[must_use]
    pub const fn drive(&self) -> TorqueDrive {
        self.stage.drive()
    }

    /// State of the node.
    #[must_use]
    pub const fn nmt(&self) -> NmtState {
        self.nmt
    }

    /// Latched fault of the plant.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.stage.fault()
    }

    /// Torque commands in a row that the present force had to do without.
    #[must_use]
    pub const fn bridged(&self) -> u16 {
        self.torque.bridged_in_a_row()
    }

    /// What became of each cycle since the start of the node.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.torque.counters
    }

    /// Force command that is active at present, N.
    #[must_use]
    pub const fn commanded_n(&self) -> f64 {
        self.torque.due_n()
    }

    /// For tests: the power stage does (not) go to `OperationEnabled` from now on.
    pub fn refuse_enable(&mut self, refuses: bool) {
        self.stage.refuse_enable(refuses);
    }

    /// For tests: the power stage loses its supply. Torque is gone at once; the fault is reported
    /// with the next cycle.
    pub fn drop_out(&mut self) {
        self.stage.supply(false);
        self.torque.zero();
        self.axis.command_brake(false);
    }

    /// For tests: the supply is back; the fault stays until it is reset.
    pub fn restore_supply(&mut self) {
        self.stage.supply(true);
    }

    const fn is_operational(&self) -> bool {
        matches!(self.nmt, NmtState::Operational)
    }

    /// Whether the machine moves on by itself: speed, or a brake on its way.
    fn moves(&self) -> bool {
        self.slow_s < STANDING_S || self.is_fast() || self.axis.brake() == BrakeState::Moving
    }

    fn is_fast(&self) -> bool {
        let Motion {
            motor_m_per_s,
            table_m_per_s,
            ..
        } = *self.axis.motion();
        motor_m_per_s.abs().max(table_m_per_s.abs()) > STANDING_M_PER_S
    }

    /// The machine goes on for one period.
    fn advance(&mut self) {
        self.axis.advance(self.torque.due_n(), self.period_s);
        self.slow_s = if self.is_fast() {
            0.0
        } else {
            self.slow_s + self.period_s
        };
    }
}

impl Station for PlantNode {
    fn ids(&self) -> AxisIds {
        self.ids
    }

    fn boot(&mut self, send: Send<'_>) {
        send(Message::PlantHeartbeat(NmtState::Initialising).encode(self.ids));
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: Send<'_>) {
        while let Some(due) = self.timer_us().filter(|due| *due < now_us) {
            self.begin_by_timer(due, send);
        }
        let heard = message::kind_of(self.ids, frame).filter(|kind| HEARD_BY_PLANT.contains(kind));
        match heard.map(|kind| message::decode_as(kind, frame)) {
            Some(Ok(message)) => self.on_message(message, now_us, send),
            Some(Err(error)) if error.kind == FrameKind::Torque => self.torque.refuse(),
            // A SYNC that cannot be read is one that did not come; the timer knows when it was due.
            Some(Err(_)) | None => {}
        }
        self.beat(now_us, send);
    }

    fn time(&mut self, now_us: u64, send: Send<'_>) {
        match self.timer_us() {
            Some(due) if due <= now_us => self.begin_by_timer(now_us, send),
            Some(_) | None => self.beat(now_us, send),
        }
    }

    fn wake_at_us(&self) -> Option<u64> {
        let heartbeat = self.time.heartbeat_due_us();
        Some(
            self.timer_us()
                .map_or(heartbeat, |timer| timer.min(heartbeat)),
        )
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.time.sync_due_us()
    }
}

/// Cycles and time.
impl PlantNode {
    /// When the own timer begins a cycle: in NMT operational always, else only as long as the
    /// machine moves.
    fn timer_us(&self) -> Option<u64> {
        if self.is_operational() || self.moves() {
            self.time.timer_us()
        } else {
            None
        }
    }

    fn begin_by_timer(&mut self, now_us: u64, send: Send<'_>) {
        self.begin_without_sync(now_us, send);
        if self.time.sync_is_gone() && !self.stage.is_enabled() && !self.moves() {
            self.time.stop();
            self.sync = SyncTracker::default();
        }
    }

    fn begin_without_sync(&mut self, now_us: u64, send: Send<'_>) {
        self.time.begin_without_sync();
        let counter = self.sync.begin_without_sync();
        self.torque.counters.by_deadline += u32::from(self.is_operational());
        self.begin(counter, 1, now_us, send);
    }

    fn on_sync(&mut self, counter: SyncCounter, now_us: u64, send: Send<'_>) {
        let before = self.sync.now();
        self.time.note_sync(now_us);
        match self.sync.take(counter) {
            SyncEvent::Begin(counter) | SyncEvent::BeginStale(counter) => {
                self.begin_by_sync(before, counter, now_us, send);
            }
            SyncEvent::Confirmed => self.time.confirm(now_us),
            SyncEvent::Doubled | SyncEvent::Late => {}
        }
    }

    fn begin_by_sync(
        &mut self,
        before: Option<SyncCounter>,
        counter: SyncCounter,
        now_us: u64,
        send: Send<'_>,
    ) {
        self.time.begin(now_us);
        if before.is_none() {
            self.torque.forget();
            self.time.beat_now(now_us);
        }
        // A counter that goes back (a restarted SYNC producer) is one cycle, not 240 minus a few.
        let cycles = match before.map(|before| counter.cycles_since(before)) {
            None => u8::from(self.moves()),
            Some(ahead) if ahead > SYNC_OVERFLOW / 2 => 1,
            Some(ahead) => ahead,
        };
        self.begin(Some(counter), cycles, now_us, send);
    }

    /// A cycle begins: the cycles before it are over, encoders are read and reported.
    fn begin(
        &mut self,
        counter: Option<SyncCounter>,
        cycles_over: u8,
        now_us: u64,
        send: Send<'_>,
    ) {
        for _ in 0..cycles_over {
            self.integrate(send);
        }
        let Some(counter) = counter.filter(|_| self.is_operational()) else {
            return;
        };
        send(Message::Feedback(self.feedback(counter)).encode(self.ids));
        if self
            .cycle
            .is_multiple_of(u32::from(PLANT_STATUS_EVERY_CYCLES))
        {
            self.reported = None;
        }
        self.cycle = self.cycle.wrapping_add(1);
        self.settle(now_us, send);
    }

    /// One period of the machine; the torque of the cycle that ends becomes active.
    fn integrate(&mut self, send: Send<'_>) {
        if !self.is_operational() {
            if self.moves() {
                self.advance();
            }
            return;
        }
        self.advance();
        if self.torque.close(self.stage.is_enabled()) {
            let gone = self.time.sync_is_gone();
            self.latch(
                if gone {
                    Fault::SyncMissing
                } else {
                    Fault::TorqueMissing
                },
                send,
            );
        }
        self.notice_dropout(send);
    }

    fn beat(&mut self, now_us: u64, send: Send<'_>) {
        if self.time.heartbeat_due_us() <= now_us {
            self.time.beaten(now_us);
            send(Message::PlantHeartbeat(self.nmt).encode(self.ids));
        }
    }
}

/// What the node says of itself.
impl PlantNode {
    fn feedback(&self, counter: SyncCounter) -> Feedback {
        let reading = self.axis.read();
        Feedback {
            motor: MotorIncrements(low_32_bits(reading.motor_increments)),
            load: LoadIncrements24::from_counts(reading.load_10_nm),
            counter,
        }
    }

    /// Sends the plant status where it says something new.
    fn report(&mut self, send: Send<'_>) {
        let now = (
            self.stage.status_word(self.is_operational()),
            self.axis.brake(),
            self.stage.fault(),
        );
        if !self.is_operational() || self.reported == Some(now) {
            return;
        }
        self.reported = Some(now);
        let (status, brake, fault) = now;
        #[expect(clippy::cast_possible_truncation, reason = "saturates at ±2147 N·m")]
        let torque = TorqueMicroNm((self.axis.force_n() / self.newton_per_micro_nm).round() as i32);
        send(
            Message::PlantStatus(PlantStatus {
                status,
                brake,
                fault,
                torque,
            })
            .encode(self.ids),
        );
    }
}

/// An encoder counts on past the 32 bits of the frame: the receiver unwraps.
const fn low_32_bits(increments: i64) -> i32 {
    let [a, b, c, d, ..] = increments.to_le_bytes();
    i32::from_le_bytes([a, b, c, d])
}
