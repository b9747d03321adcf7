//! The tables of a machine file as they are written, each quantity with its range.
//!
//! The unit of a quantity is in its name. A range says what the simulator, the drive and the bus
//! can take at all; what has to go together with another quantity is checked by
//! [`super::together`].

use axis_model::EffectTable;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::brake::BrakeParameters;
use crate::friction::{Law, Sliding};
use crate::ranges::{Quantity, Ranged, ranged};
use crate::stops::StopsForm;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileForm {
    pub name: String,
    #[serde(default)]
    pub seed: u64,
    pub bus: Spanned<Bus>,
    #[serde(rename = "loop")]
    pub timing: Spanned<Timing>,
    pub axis: Vec<Spanned<AxisForm>>,
}

/// Longest control cycle of a machine file, s.
pub(super) const LONGEST_PERIOD_S: f64 = 0.02;

ranged! {
    /// `[loop]`.
    #[derive(Clone, Copy, Debug)]
    pub struct Timing {
        /// Control cycle, s.
        pub period_s: f64 [1.0e-4 => LONGEST_PERIOD_S],
    }
}

/// Frame format and bit rates of the machine's buses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "format", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Bus {
    /// Classic CAN.
    Classic {
        /// Bit rate, bit/s.
        bit_rate: u32,
    },
    /// CAN FD with bit rate switching.
    Fd {
        /// Arbitration bit rate, bit/s.
        nominal_rate: u32,
        /// Data bit rate, bit/s.
        data_rate: u32,
    },
}

/// Bit rates of classic CAN and of the arbitration of CAN FD, bit/s.
const ARBITRATION: (f64, f64) = (1.0e4, 1.0e6);
/// Data bit rates of CAN FD, bit/s.
const DATA: (f64, f64) = (1.0e4, 8.0e6);

impl Ranged for Bus {
    fn quantities(&self) -> Vec<Quantity> {
        match *self {
            Self::Classic { bit_rate } => {
                vec![Quantity::new("bit_rate", bit_rate.into(), ARBITRATION)]
            }
            Self::Fd {
                nominal_rate,
                data_rate,
            } => vec![
                Quantity::new("nominal_rate", nominal_rate.into(), ARBITRATION),
                Quantity::new("data_rate", data_rate.into(), DATA),
            ],
        }
    }
}

/// One `[[axis]]`. With `like`, each table that is not given comes from that axis.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AxisForm {
    pub name: String,
    pub like: Option<String>,
    pub interface: Option<String>,
    pub mechanics: Option<Spanned<MechanicsForm>>,
    pub encoders: Option<Spanned<EncodersForm>>,
    pub actuator: Option<Spanned<ActuatorForm>>,
    pub brake: Option<Spanned<BrakeParameters>>,
    pub stops: Option<Spanned<StopsForm>>,
    pub limits: Option<Spanned<Limits>>,
    pub gains: Option<Spanned<Gains>>,
    pub actual: Option<Spanned<ActualForm>>,
    /// Not taken from another axis: each stands askew in its own way.
    pub geometry: Option<Spanned<Geometry>>,
    pub declared: Option<Spanned<DeclaredForm>>,
    /// What an identification said, for people: with intervals and units. The simulator reads
    /// `actual`.
    #[serde(rename = "identified")]
    pub _identified: Option<toml::Table>,
}

impl AxisForm {
    /// The axis with the tables of a model where it gives none.
    pub(super) fn like(self, model: &Self) -> Self {
        Self {
            mechanics: self.mechanics.or_else(|| model.mechanics.clone()),
            encoders: self.encoders.or_else(|| model.encoders.clone()),
            actuator: self.actuator.or_else(|| model.actuator.clone()),
            brake: self.brake.or_else(|| model.brake.clone()),
            stops: self.stops.or_else(|| model.stops.clone()),
            limits: self.limits.or_else(|| model.limits.clone()),
            gains: self.gains.or_else(|| model.gains.clone()),
            actual: self.actual.or_else(|| model.actual.clone()),
            declared: self.declared.or_else(|| model.declared.clone()),
            ..self
        }
    }
}

ranged! {
    /// `[axis.mechanics]`.
    #[derive(Clone, Copy, Debug)]
    pub struct MechanicsForm {
        /// Travel per motor revolution.
        pub lead_m_per_rev: f64 [1.0e-4 => 1.0],
        /// Motor, coupling and screw, seen at the table.
        pub motor_inertia_kg: f64 [1.0e-3 => 1.0e6],
        /// Table.
        pub table_mass_kg: f64 [1.0e-3 => 1.0e6],
        /// Screw stiffness.
        pub screw_stiffness_n_per_m: f64 [1.0e4 => 1.0e12],
        /// Screw damping.
        pub screw_damping_n_s_per_m: f64 [0.0 => 1.0e7],
        /// Width of the gap between screw and table.
        pub backlash_m: f64 [0.0 => 0.01],
        /// Force of gravity on the table, towards positive position.
        #[serde(default)]
        pub gravity_n: f64 [-1.0e6 => 1.0e6],
        /// Where the table stands at power-up.
        #[serde(default)]
        pub start_m: f64 [-10.0 => 10.0],
    }
}

ranged! {
    /// `[axis.geometry]`: how the way of an axis differs from what its scale says. An instrument at
    /// the table sees it, no encoder does.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct Geometry {
        /// Angle of the axis out of its nominal direction, towards the positive direction of the
        /// other axis of the plane.
        #[serde(default)]
        pub squareness_rad: f64 [-0.01 => 0.01],
        /// The way is longer than its scale says by so many millionths.
        #[serde(default)]
        pub scale_ppm: f64 [-1.0e4 => 1.0e4],
    }
}

ranged! {
    /// `[axis.encoders]`.
    #[derive(Clone, Copy, Debug)]
    pub struct EncodersForm {
        /// Motor encoder.
        pub motor_counts_per_rev: u32 [100.0 => 1.0e8],
        /// Load scale.
        pub load_resolution_m: f64 [1.0e-10 => 1.0e-4],
        /// Motor position where its encoder reads zero.
        #[serde(default)]
        pub motor_zero_m: f64 [-100.0 => 100.0],
        /// Table position where the scale reads zero.
        #[serde(default)]
        pub load_zero_m: f64 [-100.0 => 100.0],
    }
}

ranged! {
    /// `[axis.actuator]`.
    #[derive(Clone, Copy, Debug)]
    pub struct ActuatorForm {
        /// Current loop, first order.
        pub current_loop_time_constant_s: f64 [0.0 => 0.01],
        /// Limit of the force.
        pub force_limit_n: f64 [1.0e-3 => 1.0e6],
        /// Noise of the force that acts.
        pub force_noise_n: f64 [0.0 => 1.0e6],
        /// Noise of the recorded effort.
        pub force_record_noise_n: f64 [0.0 => 1.0e6],
    }
}

ranged! {
    /// Limits of an axis.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Limits {
        /// Velocity, m/s.
        pub velocity_m_per_s: f64 [1.0e-4 => 5.0],
        /// Acceleration, m/s².
        pub acceleration_m_per_s2: f64 [1.0e-3 => 200.0],
        /// Travel to either side of zero, m.
        pub travel_m: f64 [1.0e-3 => 10.0],
    }
}

/// Which encoder closes the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PositionSensor {
    /// Motor encoder: mechanics outside the loop.
    Motor,
    /// Load scale: mechanics inside the loop.
    Load,
}

ranged! {
    /// Gains of the drive in SI units.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Gains {
        /// Which encoder closes the position loop.
        pub position_sensor: PositionSensor,
        /// Kv.
        pub position_gain_per_s: f64 [0.0 => 1000.0],
        /// Bandwidth of the velocity loop: proportional gain = inertia · 2π · this.
        pub velocity_bandwidth_hz: f64 [0.1 => 1000.0],
        /// Corner of the integral part.
        pub velocity_integral_hz: f64 [0.0 => 500.0],
        /// Share of the new difference quotient in the velocity filter, 0…1.
        pub velocity_filter: f64 [0.01 => 1.0],
        /// Low-pass on the torque, if any; the drive says what it can hold.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub torque_low_pass_hz: Option<f64>,
        /// Notch on the torque, if any; the drive says what it can hold.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub torque_notch_hz: Option<f64>,
    }
}

/// What an axis really has: friction in tables of its own or as effects of the vocabulary.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ActualForm {
    pub sliding: Option<Spanned<Sliding>>,
    pub friction: Option<Spanned<Law>>,
    pub motor_side: Option<MotorSideForm>,
    pub effects: Option<Spanned<EffectTable>>,
}

/// Friction of what turns with the motor, in tables like those of the table.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MotorSideForm {
    pub sliding: Spanned<Sliding>,
    pub friction: Option<Spanned<Law>>,
}

/// What the axis' model says, as words: an unknown one is told with its line.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DeclaredForm {
    pub effects: Vec<String>,
}
