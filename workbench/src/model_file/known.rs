//! What is known of an axis besides its identification: from its machine file, or from what a
//! dataset says and shows.

use std::f64::consts::TAU;

use identification::{AxisKind, Dataset, Effort, EffortHold};
use plant_sim::machine::{Gains, Limits, MachineAxis, PositionSensor};

/// Lead that is taken where the record does not know it, m.
const LEAD_M: f64 = 0.010;

/// What is known of an axis besides its identification.
#[derive(Clone, Debug)]
pub struct Known {
    /// Travel per revolution, m.
    pub lead_m: f64,
    /// Motor encoder.
    pub counts_per_rev: f64,
    /// Load scale, m.
    pub load_resolution_m: f64,
    /// Current loop, s.
    pub lag_s: f64,
    /// Limit of the force, N.
    pub force_limit_n: f64,
    /// Mass that the gains are for, kg: stands where the identification does not know it.
    pub inertia_kg: f64,
    /// Limits of the motion.
    pub limits: Limits,
    /// Gains of the drive.
    pub gains: Gains,
    /// Sample period, s.
    pub period_s: f64,
    /// Delay that the record sees because the effort is held while its rows say it acts at once, s.
    pub hold_s: f64,
    /// Where the encoder that closes the loop stands when that of the motor is zero, m.
    pub origin_m: f64,
}

impl Known {
    /// From a machine file.
    #[must_use]
    pub fn of_machine(axis: &MachineAxis, period_s: f64) -> Self {
        let actual = &axis.actual;
        Self {
            lead_m: actual.lead_m_per_rev,
            counts_per_rev: f64::from(actual.motor_encoder_counts_per_rev),
            load_resolution_m: actual.load_encoder_resolution_m,
            lag_s: actual.current_loop_time_constant_s,
            force_limit_n: actual.force_limit_n,
            inertia_kg: actual.mechanics.motor_inertia_kg + actual.mechanics.table_mass_kg,
            limits: axis.limits,
            gains: axis.gains,
            period_s,
            hold_s: 0.0,
            origin_m: match axis.gains.position_sensor {
                PositionSensor::Motor => 0.0,
                PositionSensor::Load => relation_m(axis),
            },
        }
    }

    /// From a dataset; `None` where the axis is not one that the simulator has (rotary, or effort
    /// that is no force).
    #[must_use]
    pub fn of_dataset(dataset: &Dataset, mass_kg: f64) -> Option<Self> {
        if dataset.kind != AxisKind::Linear || dataset.effort != Effort::Force {
            return None;
        }
        let shown = Shown::by(dataset);
        let controller = dataset.controller.clone().unwrap_or_default();
        let lead_m = dataset.lead_m_per_rev.unwrap_or(LEAD_M);
        let bandwidth = controller
            .velocity_gain_n_s_per_m
            .map_or(25.0, |gain| gain / (mass_kg * TAU));
        Some(Self {
            lead_m,
            counts_per_rev: (lead_m / dataset.resolution).round().clamp(100.0, 1.0e8),
            load_resolution_m: dataset.load_resolution.clamp(1.0e-10, 1.0e-4),
            lag_s: dataset.effort_lag_s,
            force_limit_n: dataset.effort_limit.unwrap_or(3.0 * shown.force_n),
            inertia_kg: mass_kg,
            limits: shown.limits(mass_kg),
            gains: Gains {
                position_sensor: match controller.position_sensor.as_deref() {
                    Some("load") => PositionSensor::Load,
                    _ => PositionSensor::Motor,
                },
                position_gain_per_s: controller
                    .position_gain_per_s
                    .unwrap_or(40.0)
                    .clamp(1.0, 1000.0),
                velocity_bandwidth_hz: bandwidth.clamp(0.1, 1000.0),
                velocity_integral_hz: controller
                    .integral_per_s
                    .map_or(5.0, |rate| rate / TAU)
                    .clamp(0.0, 500.0),
                velocity_filter: controller.velocity_filter.unwrap_or(0.7).clamp(0.01, 1.0),
                torque_low_pass_hz: None,
                torque_notch_hz: None,
            },
            period_s: dataset.train.period_s,
            hold_s: if dataset.hold == EffortHold::Instant {
                0.5 * dataset.train.period_s
            } else {
                0.0
            },
            origin_m: 0.0,
        })
    }
}

/// The most that the record shows of an axis.
struct Shown {
    velocity_m_per_s: f64,
    force_n: f64,
    position_m: f64,
}

impl Shown {
    fn by(dataset: &Dataset) -> Self {
        let record = &dataset.train;
        let over_ten = record.position.windows(11);
        let way = most(over_ten.map(|rows| rows[10] - rows[0]));
        Self {
            velocity_m_per_s: way / (10.0 * record.period_s),
            force_n: most(record.effort.iter().copied()),
            position_m: most(record.position.iter().copied()),
        }
    }

    /// A fifth more than what was seen, within what is usual of machines.
    fn limits(&self, mass_kg: f64) -> Limits {
        Limits {
            velocity_m_per_s: (1.2 * self.velocity_m_per_s).clamp(0.1, 5.0),
            acceleration_m_per_s2: (self.force_n / mass_kg).clamp(0.5, 200.0),
            travel_m: (1.2 * self.position_m).clamp(0.12, 10.0),
        }
    }
}

fn most(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| most.max(value.abs()))
}

/// Where the load scale stands when the motor encoder is zero, m; what a user reads off both at
/// power-up.
#[must_use]
pub fn relation_m(axis: &MachineAxis) -> f64 {
    axis.actual.mounting.motor_zero_m - axis.actual.mounting.load_zero_m
}
