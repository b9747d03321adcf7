//! A rig: everything that makes a record, put together and run.

use crate::control::{Controller, ControllerState, Seen, Sensor};
use crate::draw::Draw;
use crate::drive::{Drive, DriveState, Place};
use crate::mechanics::train::{Train, TrainState};
use crate::motion::{Motion, Setpoint};
use crate::sensing::{Columns, Sensing, Trace};
use crate::table::{Column, Table};
use crate::truth::{Effect, Known};

/// Time before the record in which the loop takes up gravity and wind-up, s.
const RUN_IN_S: f64 = 1.5;

/// Kind of axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Metres.
    Linear,
    /// Radians.
    Rotary,
}

impl Kind {
    /// Unit of positions.
    #[must_use]
    pub const fn position_unit(self) -> &'static str {
        match self {
            Self::Linear => "m",
            Self::Rotary => "rad",
        }
    }
}

/// Which effort a file has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EffortColumn {
    /// `force_n`, of a linear axis.
    Force,
    /// `torque_nm`: of a rotary axis, or of the motor of a linear one, per newton.
    Torque(f64),
    /// `current_a`, per newton or newton metre.
    Current(f64),
}

impl EffortColumn {
    /// Name of the column.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Force => "force_n",
            Self::Torque(_) => "torque_nm",
            Self::Current(_) => "current_a",
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Torque(_) => "N m",
            Self::Current(_) => "A",
        }
    }

    /// Recorded number per effort of the axis.
    #[must_use]
    pub const fn per_effort(self) -> f64 {
        match self {
            Self::Force => 1.0,
            Self::Torque(per) | Self::Current(per) => per,
        }
    }
}

/// What `dataset.toml` says beyond what the rig is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stated {
    /// Travel per revolution of the motor, m.
    pub lead_m_per_rev: Option<f64>,
    /// Lag between recorded and acting effort, s.
    pub effort_lag_s: Option<f64>,
    /// Whether the controller stands in the file; only a cascade on force can.
    pub controller: bool,
    /// Whether the resolution of the encoders stands there.
    pub resolution: bool,
}

/// A rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Kind of axis.
    pub kind: Kind,
    /// Effort of the file.
    pub column: EffortColumn,
    /// Mechanics.
    pub train: Train,
    /// Drive.
    pub drive: Drive,
    /// Controller.
    pub controller: Controller,
    /// Recording.
    pub sensing: Sensing,
    /// Steps of the integration in a period of the controller.
    pub steps_per_tick: usize,
    /// Motion of the training record, and how long it is, s.
    pub training: (Motion, f64),
    /// Motion of the validation record, and how long it is, s.
    pub validation: (Motion, f64),
    /// What `dataset.toml` says.
    pub stated: Stated,
    /// What the model is declared to have when nothing is lacking.
    pub base: Vec<Effect>,
    /// Parameters that the make knows beyond inertia, Coulomb and viscous friction.
    pub known: Vec<Known>,
}

/// Everything that moves in time.
struct Running {
    axis: TrainState,
    drive: DriveState,
    controller: ControllerState,
}

impl Rig {
    /// Step of the integration, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.controller.period_s / self.steps_per_tick as f64
    }

    /// Period of the rows, s.
    #[must_use]
    pub fn row_s(&self) -> f64 {
        self.step_s() * self.sensing.steps_per_row as f64
    }

    /// A parameter that the make knows, in the unit of the recorded effort. A stiffness is that of
    /// the mechanics and a delay any: what they come to in a record is worked out later.
    pub fn know(&mut self, name: &'static str, value: f64, unit: &str) {
        self.known.push(Known {
            name,
            value,
            unit: unit.into(),
        });
    }

    /// The run of a motion.
    #[must_use]
    pub fn run(&self, (motion, duration_s): &(Motion, f64)) -> Trace {
        let mut running = self.start(motion);
        let ticks = |time_s: f64| (time_s / self.controller.period_s).round() as i64;
        let mut trace = Trace {
            step_s: self.step_s(),
            ..Trace::default()
        };
        for tick in -ticks(RUN_IN_S)..ticks(*duration_s) {
            let time_s = tick as f64 * self.controller.period_s;
            if tick <= 0 {
                running.axis.time_s = time_s;
            }
            let wanted = wanted(motion, time_s);
            let seen = self.seen(&running, motion, wanted, time_s);
            let command = self.controller.tick(&mut running.controller, &seen);
            let kept = (tick >= 0).then_some(&mut trace);
            self.hold(&mut running, command, wanted.position, kept);
        }
        trace
    }

    fn start(&self, motion: &Motion) -> Running {
        Running {
            axis: self.train.at_rest(wanted(motion, 0.0).position),
            drive: DriveState::default(),
            controller: ControllerState::default(),
        }
    }

    fn seen(&self, running: &Running, motion: &Motion, wanted: Setpoint, time_s: f64) -> Seen {
        let positions = &running.axis.positions;
        let sensing = &self.sensing;
        let position = match (self.controller.sensor, &sensing.load) {
            (Sensor::Load, Some(scale)) => scale.read(positions[self.train.load()]),
            (Sensor::Load, None) => sensing.motor.read(positions[self.train.load()]),
            (Sensor::Motor, _) => sensing.motor.read(positions[0]),
        };
        Seen {
            wanted,
            position,
            programme: programme(motion, time_s),
            time_s,
        }
    }

    /// A period of the controller with a command.
    fn hold(&self, running: &mut Running, command: f64, reference: f64, trace: Option<&mut Trace>) {
        let step_s = self.step_s();
        let mut trace = trace;
        for _ in 0..self.steps_per_tick {
            let axis = &mut running.axis;
            let place = Place {
                position: axis.positions[0],
                velocity: axis.velocities[0],
                time_s: axis.time_s,
            };
            let before = (axis.positions[0], axis.velocities[0]);
            let load = axis.positions[self.train.load()];
            let delivered = self.drive.step(&mut running.drive, command, place, step_s);
            self.train.step(axis, delivered.effort, step_s);
            if let Some(trace) = trace.as_deref_mut() {
                trace.reference.push(reference);
                trace.motor.push(before.0);
                trace.velocity.push(before.1);
                trace.load.push(load);
                trace.command.push(command);
                trace.current.push(delivered.current);
            }
        }
    }

    /// The record of a motion as a table.
    #[must_use]
    pub fn table(&self, motion: &(Motion, f64), draw: &mut Draw) -> Table {
        let columns = self.sensing.record(&self.run(motion), draw);
        self.named(columns)
    }

    fn named(&self, columns: Columns) -> Table {
        let unit = self.kind.position_unit();
        // A nanometre needs nine digits; the rest is for scales finer than that.
        let position = |name: &str, values: Vec<f64>| column(&format!("{name}_{unit}"), 10, values);
        let per_effort = self.column.per_effort();
        let effort: Vec<f64> = columns.effort.iter().map(|e| e * per_effort).collect();
        let decimals = digits(&effort);
        let mut all = vec![column("time_s", 7, columns.time_s)];
        all.extend(
            columns
                .reference
                .map(|values| position("reference", values)),
        );
        all.push(position("position", columns.position));
        all.extend(columns.load.map(|values| position("load_position", values)));
        let velocity = |values| column(&format!("velocity_{unit}_s"), 6, values);
        all.extend(columns.velocity.map(velocity));
        all.push(column(self.column.name(), decimals, effort));
        Table { columns: all }
    }
}

fn column(name: &str, decimals: usize, values: Vec<f64>) -> Column {
    Column {
        name: name.into(),
        decimals,
        values,
    }
}

/// Digits after the point that keep a millionth of the largest value.
fn digits(values: &[f64]) -> usize {
    let most = values.iter().fold(1.0e-6_f64, |most, v| most.max(v.abs()));
    (6.0 - libm::log10(most).floor()).clamp(0.0, 12.0) as usize
}

fn wanted(motion: &Motion, time_s: f64) -> Setpoint {
    match motion {
        Motion::Path(path) => path.at(time_s),
        Motion::Effort(_) => Setpoint::default(),
    }
}

fn programme(motion: &Motion, time_s: f64) -> f64 {
    match motion {
        Motion::Path(_) => 0.0,
        Motion::Effort(programme) => programme.at(time_s),
    }
}
