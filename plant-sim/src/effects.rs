//! What real axes have besides mass, screw and friction: each effect one small struct, all off by
//! default.

use serde::{Deserialize, Serialize};

/// Friction never vanishes altogether: a bristle without friction has no equation.
const SMALLEST_FACTOR: f64 = 1.0e-3;

/// Force periodic in the motor position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueRipple {
    /// Amplitude at the table.
    pub amplitude_n: f64,
    /// Periods per revolution.
    pub order_per_rev: f64,
    /// Phase at position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

/// Load scale off by a function periodic in position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchError {
    /// Amplitude.
    pub amplitude_m: f64,
    /// Period.
    pub period_m: f64,
}

/// Friction that changes with time from the start (warm-up): level (1 + g exp(−t / τ)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionDrift {
    /// Relative surplus at the start.
    pub gain: f64,
    /// Time constant.
    pub time_constant_s: f64,
}

/// All further effects of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Effects {
    /// Constant force on the table, against positive motion.
    pub offset_n: f64,
    /// Torque ripple.
    pub torque_ripple: Option<TorqueRipple>,
    /// Pitch error of the load scale.
    pub pitch_error: Option<PitchError>,
    /// Relative change of friction per metre.
    pub position_dependent_friction_per_m: f64,
    /// Friction drift.
    pub friction_drift: Option<FrictionDrift>,
    /// Delivered force falls behind: u / (1 + k |u|).
    pub torque_saturation_per_n: f64,
    /// The force acts later by this time, besides the transport delay of the bus.
    pub delay_s: f64,
}

impl Effects {
    /// Force on the motor side at a motor position.
    #[must_use]
    pub fn motor_force_n(&self, motor_m: f64, lead_m: f64) -> f64 {
        let Some(ripple) = self.torque_ripple else {
            return 0.0;
        };
        let angle =
            std::f64::consts::TAU * ripple.order_per_rev * motor_m / lead_m + ripple.phase_rad;
        -ripple.amplitude_n * angle.sin()
    }

    /// Factor on the friction level.
    #[must_use]
    pub fn friction_factor(&self, table_m: f64, time_s: f64) -> f64 {
        let drift = self.friction_drift.map_or(0.0, |drift| {
            drift.gain * (-time_s / drift.time_constant_s).exp()
        });
        ((1.0 + self.position_dependent_friction_per_m * table_m) * (1.0 + drift))
            .max(SMALLEST_FACTOR)
    }

    /// Error of the load scale at a table position.
    #[must_use]
    pub fn scale_error_m(&self, table_m: f64) -> f64 {
        let periodic = |pitch: PitchError| {
            pitch.amplitude_m * (std::f64::consts::TAU * table_m / pitch.period_m).sin()
        };
        self.pitch_error.map_or(0.0, periodic)
    }

    /// Force that a commanded force delivers.
    #[must_use]
    pub fn delivered_n(&self, commanded_n: f64) -> f64 {
        commanded_n / (1.0 + self.torque_saturation_per_n * commanded_n.abs())
    }
}
