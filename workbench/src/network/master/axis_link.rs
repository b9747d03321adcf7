//! What the workbench knows of one axis: what it sent last, and what its servo and plant said.
//!
//! Feedback k and torque k fill the row of cycle k. Status and EMCY tell state and fault: a status
//! comes on change of state and every tenth cycle, an EMCY at once.

use plant_sim::Machine;
use plant_sim::machine::PositionSensor;
use plant_sim::node::Truth;
use protocol::cob::AxisIds;
use protocol::message::{EmergencyMessage, Feedback};
use protocol::states::DriveState;
use protocol::weight::{LoadIncrements24, SetpointFine};
use protocol::{Fault, Message, SyncCounter};

use crate::drive_parameters::{COUNT_M, FINE_PER_COUNT};
use crate::error::{Failure, Outcome};
use crate::model_file;
use crate::network::link::{Link, axis_ids};

/// Cycles without a torque frame after which a servo counts as silent: as many as the nodes bridge
/// (`TORQUE_MISSES_ALLOWED` of the plant).
pub const SILENT_CYCLES: u32 = 3;

/// An axis stands where its motor is slower than this: on a ramp of 5 m/s² that is 0.4 ms and 0.4
/// µm before its end.
const STANDS_M_PER_S: f64 = 2.0e-3;
/// A motor that stands may still tell two neighbouring encoder counts in turn.
const STANDS_COUNTS: f64 = 1.5;

/// What an axis did in one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisCycle {
    /// Setpoint of the cycle, m.
    pub reference_m: f64,
    /// Motor encoder, as a position at the table, m.
    pub motor_m: f64,
    /// Load scale, m.
    pub load_m: f64,
    /// Force that is active from this cycle to the next: the torque command of the cycle before, at
    /// the table, N.
    pub force_n: f64,
    /// Whether the feedback of the cycle came and the torque that acts in it was seen: else
    /// positions or force are those of an earlier one.
    pub is_measured: bool,
    /// What an instrument at the machine saw.
    pub truth: Option<Truth>,
}

impl AxisCycle {
    /// Whether it is known where the table was in this cycle.
    #[must_use]
    pub const fn shows_table(&self) -> bool {
        self.is_measured || self.truth.is_some()
    }

    /// Where the table was: by the instrument, or by the load scale.
    #[must_use]
    pub fn table_m(&self) -> f64 {
        self.truth.map_or(self.load_m, |truth| truth.table_m)
    }
}

/// One axis, seen from the workbench.
pub(super) struct AxisLink {
    pub(super) ids: AxisIds,
    pub(super) bus: usize,
    pub(super) name: String,
    /// Setpoint of the coming cycle.
    pub(super) next: SetpointFine,
    /// The cycle that has just ended.
    pub(super) now: AxisCycle,
    /// State by the last status; `None` before the first one, or since [`Self::forget_state`].
    pub(super) state: Option<DriveState>,
    /// Last fault by status or EMCY.
    pub(super) fault: Option<Fault>,
    /// Last EMCY code that no fault of the table explains.
    emergency: Option<u16>,
    sensor: PositionSensor,
    way_m: f64,
    newton_per_micro_nm: f64,
    load: Option<(LoadIncrements24, i64)>,
    /// The scale where the motor encoder is zero, counts of 10 nm.
    relation_counts: i64,
    torque_n: f64,
    torque_seen: bool,
    feedback_seen: bool,
    force_known: bool,
    silent_cycles: u32,
    motor_before_m: f64,
    stands_m: f64,
    standing_cycles: u32,
}

impl AxisLink {
    /// The axes of a machine, on the buses of a link.
    pub(super) fn of_machine(machine: &Machine, link: &impl Link) -> Outcome<Vec<Self>> {
        (0..machine.axes.len())
            .map(|index| Self::of_axis(machine, index, link.bus_of(index)))
            .collect()
    }

    fn of_axis(machine: &Machine, index: usize, bus: usize) -> Outcome<Self> {
        let axis = &machine.axes[index];
        let way_m =
            axis.actual.lead_m_per_rev / f64::from(axis.actual.motor_encoder_counts_per_rev);
        Ok(Self {
            ids: axis_ids(index)?,
            bus,
            name: axis.name.clone(),
            next: SetpointFine::default(),
            now: AxisCycle::default(),
            state: None,
            fault: None,
            emergency: None,
            sensor: axis.gains.position_sensor,
            way_m,
            newton_per_micro_nm: axis.actual.newton_per_micro_nm(),
            load: None,
            relation_counts: (model_file::relation_m(axis) / COUNT_M).round() as i64,
            torque_n: 0.0,
            torque_seen: false,
            feedback_seen: false,
            force_known: false,
            silent_cycles: 0,
            motor_before_m: 0.0,
            stands_m: (STANDS_M_PER_S * machine.period_s).max(STANDS_COUNTS * way_m),
            standing_cycles: 0,
        })
    }

    /// A cycle begins, so many later than the one before: the setpoint that was sent early is due
    /// now, and so is the torque of the cycle before.
    pub(super) fn begin(&mut self, next_m: f64, skipped: u32) {
        self.force_known = self.torque_seen && skipped == 0;
        self.feedback_seen = false;
        // What the drive made of setpoints that it did not get is not known: about the next one.
        self.now.reference_m = if skipped == 0 {
            fine_m(self.next)
        } else {
            next_m
        };
        self.now.force_n = self.torque_n;
        self.next = fine(next_m);
        self.torque_seen = false;
        self.motor_before_m = self.now.motor_m;
    }

    /// A cycle ends, with what an instrument saw of it.
    pub(super) fn end(&mut self, truth: Option<Truth>) {
        self.now.truth = truth;
        self.now.is_measured = self.feedback_seen && self.force_known;
        self.silent_cycles = if self.torque_seen {
            0
        } else {
            self.silent_cycles.saturating_add(1)
        };
        let stands = (self.now.motor_m - self.motor_before_m).abs() <= self.stands_m;
        self.standing_cycles = if stands {
            self.standing_cycles.saturating_add(1)
        } else {
            0
        };
    }

    /// Takes what came on the bus in cycle `counter`.
    pub(super) fn take(&mut self, message: Message, counter: SyncCounter) {
        match message {
            Message::Feedback(feedback) if feedback.counter == counter => {
                self.take_feedback(feedback);
            }
            Message::Torque(torque) if torque.counter == counter => {
                self.torque_n = f64::from(torque.torque.0) * self.newton_per_micro_nm;
                self.torque_seen = true;
            }
            Message::Status(status) => {
                self.state = status.status.state();
                self.fault = status.fault.or(self.fault);
            }
            Message::ServoEmergency(emergency) | Message::PlantEmergency(emergency) => {
                self.take_emergency(emergency);
            }
            _ => {}
        }
    }

    fn take_feedback(&mut self, feedback: Feedback) {
        self.feedback_seen = true;
        self.now.motor_m = f64::from(feedback.motor.0) * self.way_m;
        let counts = self.unwrap(feedback.load);
        self.load = Some((feedback.load, counts));
        self.now.load_m = counts as f64 * COUNT_M;
    }

    /// The code 0 is the EMCY of a fault that was reset (CiA 301 table 26); it takes nothing back
    /// here: what began a stop has to stay known.
    fn take_emergency(&mut self, emergency: EmergencyMessage) {
        self.fault = Fault::from_code(emergency.vendor_specific[0]).or(self.fault);
        if self.fault.is_none() && emergency.error_code != 0 {
            self.emergency = Some(emergency.error_code);
        }
    }

    /// The load scale tells its low 24 bits; the first reading is taken to stand nearest to where
    /// the motor and the relation of both encoders expect it, as the drive does (2103h).
    fn unwrap(&self, load: LoadIncrements24) -> i64 {
        let (raw, counts) = self.load.unwrap_or_else(|| {
            let counts = (self.now.motor_m / COUNT_M).round() as i64 + self.relation_counts;
            (LoadIncrements24::from_counts(counts), counts)
        });
        counts + i64::from(raw.step_to(load))
    }

    /// Where the axis stands, by the encoder that closes its loop.
    pub(super) fn position_m(&self) -> f64 {
        match self.sensor {
            PositionSensor::Motor => self.now.motor_m,
            PositionSensor::Load => self.now.load_m,
        }
    }

    /// The setpoint that was sent last, m.
    pub(super) fn last_setpoint_m(&self) -> f64 {
        fine_m(self.next)
    }

    /// Whether the torque of this cycle has come.
    pub(super) const fn has_answered(&self) -> bool {
        self.torque_seen
    }

    /// Whether the servo has been silent for so long that nobody waits for it any more.
    pub(super) const fn is_silent(&self) -> bool {
        self.silent_cycles >= SILENT_CYCLES
    }

    /// Whether the motor has stood for that many cycles.
    pub(super) const fn has_stood_for(&self, cycles: u32) -> bool {
        self.standing_cycles >= cycles
    }

    /// The state counts as unknown until the next status.
    pub(super) const fn forget_state(&mut self) {
        self.state = None;
    }

    /// Faults of the past are over.
    pub(super) const fn forget_faults(&mut self) {
        self.fault = None;
        self.emergency = None;
    }

    /// Whether the axis reported a fault or an EMCY.
    pub(super) const fn has_reported(&self) -> bool {
        self.fault.is_some() || self.emergency.is_some()
    }

    /// What is wrong with an axis that should be in operation; `None` where nothing is.
    pub(super) fn trouble(&self) -> Option<Failure> {
        let (name, node) = (&self.name, self.ids.servo.get());
        if self.is_silent() {
            return Some(Failure::new(format!(
                "axis {name}: the servo (node {node}) sent no torque for {} cycles; is it still running and on this interface?",
                self.silent_cycles
            )));
        }
        let is_well = self.state == Some(DriveState::OperationEnabled) && !self.has_reported();
        (!is_well).then(|| {
            Failure::new(format!(
                "axis {name}: the drive is not enabled ({})",
                self.account()
            ))
        })
    }

    /// State and fault, in words.
    pub(super) fn account(&self) -> String {
        let state = self
            .state
            .map_or_else(|| "no status seen".to_owned(), |state| format!("{state:?}"));
        let why = match (self.fault, self.emergency) {
            (Some(fault), _) => format!("{fault:?}: {}", fault.text()),
            (None, Some(code)) => format!("EMCY {code:04X}h"),
            (None, None) => "no fault reported".to_owned(),
        };
        format!("{state}; {why}")
    }
}

/// Setpoint counts of a position.
#[must_use]
pub fn fine(position_m: f64) -> SetpointFine {
    SetpointFine::saturating((position_m / COUNT_M * FINE_PER_COUNT).round() as i64)
}

fn fine_m(setpoint: SetpointFine) -> f64 {
    setpoint.counts() as f64 * COUNT_M / FINE_PER_COUNT
}
