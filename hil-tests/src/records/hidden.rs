//! What a seeded axis has and its declared model lacks.
//!
//! Sizes are given as a person would choose them for an axis whose friction is not known yet: as a
//! share of it where the vocabulary has a force.

use std::f64::consts::TAU;

use axis_model::{
    Delay, Effect, EffectName, FrictionDrift, LoadDependentFriction, Payload, PitchError,
    PositionDependentFriction, PositionDependentInertia, TorqueConstantRipple, TorqueRipple,
    TorqueSaturation,
};
use plant_sim::axis::AxisParameters;
use plant_sim::friction::{Law, Sliding};
use plant_sim::mechanics::Motion;

/// What an identification says of what it has no name for.
pub const UNEXPLAINED: &str = "unexplained";

/// Damping of the bristles that presliding gives an axis, N·s/m.
const BRISTLE_DAMPING_N_S_PER_M: f64 = 2.0e4;
/// Damping of a screw that is compliant, N·s/m.
const SCREW_DAMPING_N_S_PER_M: f64 = 2.0e4;
/// Phase of a hidden wave at position zero: none that a fit would start from.
const WAVE_PHASE_RAD: f64 = 0.7;
/// Saturation is stated as the share lost at 1 kN: k of `u / (1 + k |u|)` per share over rest.
const SATURATION_PER_N: f64 = 1.0e-3;

/// One hidden effect, with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are named with their units")]
pub enum Hidden {
    /// Viscous friction that differs by direction, by plus and minus a share.
    ViscousAsymmetry { share: f64 },
    /// Breakaway over Coulomb friction, and the velocity of the fall.
    Stribeck { ratio: f64, velocity_m_per_s: f64 },
    /// Deflection of the bristles, Fc/σ0.
    Presliding { deflection_m: f64 },
    /// Gap between motor and table.
    Backlash { gap_m: f64 },
    /// A screw of this stiffness.
    Compliance { stiffness_n_per_m: f64 },
    /// A force that is periodic in the motor's position.
    TorqueRipple {
        amplitude_n: f64,
        order_per_rev: f64,
    },
    /// A load scale that is off periodically.
    PitchError { amplitude_m: f64, period_m: f64 },
    /// Relative change of friction over position.
    PositionDependentFriction { per_m: f64 },
    /// Relative surplus of friction at the start, and the time constant of its fall.
    FrictionDrift { gain: f64, time_constant_s: f64 },
    /// Drag that grows with the square of velocity.
    QuadraticDrag { n_s2_per_m2: f64 },
    /// Friction per force that the screw transmits.
    LoadDependentFriction { share: f64 },
    /// A part that is taken up at a time, without friction or weight.
    Payload { kg: f64, at_s: f64 },
    /// Amplitude and period of a mass over position.
    PositionDependentInertia { kg: f64, period_m: f64 },
    /// Share by which the torque constant swings, and how often in a revolution.
    TorqueConstantRipple { share: f64, order_per_rev: f64 },
    /// Share of the effort that is lost at 1 kN.
    TorqueSaturation { share: f64 },
    /// Effort that acts late.
    Delay { delay_s: f64 },
    /// A log that says what the effort was some time before. The axis does not know of it.
    LoggedLate { late_s: f64 },
    /// What the vocabulary has no name for.
    Foreign(Foreign),
}

/// A force outside the list of effects. The simulator does not know it: it is added to the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are named with their units")]
pub enum Foreign {
    /// A force over position, −k x.
    Spring { n_per_m: f64 },
    /// A force over time, A sin(2π f t).
    Hum { amplitude_n: f64, hz: f64 },
    /// A drag that grows with the cube of velocity, −c v³.
    CubicDrag { n_s3_per_m3: f64 },
}

impl Hidden {
    /// Its name in the vocabulary, if it has one.
    #[must_use]
    pub const fn name(self) -> Option<EffectName> {
        Some(match self {
            Self::ViscousAsymmetry { .. } => EffectName::ViscousAsymmetry,
            Self::Stribeck { .. } => EffectName::Stribeck,
            Self::Presliding { .. } => EffectName::Presliding,
            Self::Backlash { .. } => EffectName::Backlash,
            Self::Compliance { .. } => EffectName::Compliance,
            Self::TorqueRipple { .. } => EffectName::TorqueRipple,
            Self::PitchError { .. } => EffectName::PitchError,
            Self::PositionDependentFriction { .. } => EffectName::PositionDependentFriction,
            Self::FrictionDrift { .. } => EffectName::FrictionDrift,
            Self::QuadraticDrag { .. } => EffectName::QuadraticDrag,
            Self::LoadDependentFriction { .. } => EffectName::LoadDependentFriction,
            Self::Payload { .. } => EffectName::Payload,
            Self::PositionDependentInertia { .. } => EffectName::PositionDependentInertia,
            Self::TorqueConstantRipple { .. } => EffectName::TorqueConstantRipple,
            Self::LoggedLate { .. } => EffectName::LoggedLate,
            Self::TorqueSaturation { .. } => EffectName::TorqueSaturation,
            Self::Delay { .. } => EffectName::Delay,
            Self::Foreign(_) => return None,
        })
    }

    /// What an identification has to say of it.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.name().map_or(UNEXPLAINED, EffectName::as_str)
    }

    /// Gives an axis the effect, as far as the simulator knows it.
    pub(super) fn hide_in(self, axis: &mut AxisParameters) {
        let (sliding, mechanics) = (&mut axis.sliding, &mut axis.mechanics);
        match self {
            Self::ViscousAsymmetry { share } => sliding.viscous_asymmetry = share,
            Self::Stribeck {
                ratio,
                velocity_m_per_s,
            } => {
                sliding.static_n = ratio * sliding.coulomb_n;
                sliding.stribeck_velocity_m_per_s = velocity_m_per_s;
            }
            Self::Presliding { deflection_m } => axis.law = bristles(sliding, deflection_m),
            Self::Backlash { gap_m } => mechanics.backlash_m = gap_m,
            Self::Compliance { stiffness_n_per_m } => {
                mechanics.screw_stiffness_n_per_m = stiffness_n_per_m;
                mechanics.screw_damping_n_s_per_m = SCREW_DAMPING_N_S_PER_M;
            }
            Self::QuadraticDrag { n_s2_per_m2 } => sliding.quadratic_drag_n_s2_per_m2 = n_s2_per_m2,
            Self::TorqueRipple { .. }
            | Self::PitchError { .. }
            | Self::PositionDependentFriction { .. }
            | Self::FrictionDrift { .. }
            | Self::LoadDependentFriction { .. }
            | Self::Payload { .. }
            | Self::PositionDependentInertia { .. }
            | Self::TorqueConstantRipple { .. }
            | Self::TorqueSaturation { .. }
            | Self::Delay { .. } => {
                let added = self.further().map(|effect| axis.effects.add(effect));
                added.transpose().expect("the simulator has it");
            }
            Self::LoggedLate { .. } | Self::Foreign(_) => {}
        }
    }

    /// What the simulator has in its list of further effects.
    fn further(self) -> Option<Effect> {
        Some(match self {
            Self::TorqueRipple {
                amplitude_n,
                order_per_rev,
            } => Effect::TorqueRipple(TorqueRipple {
                amplitude: amplitude_n,
                order: Some(order_per_rev),
                period: None,
                phase: Some(WAVE_PHASE_RAD),
            }),
            Self::PitchError {
                amplitude_m,
                period_m,
            } => Effect::PitchError(PitchError {
                amplitude: amplitude_m,
                period: period_m,
            }),
            Self::PositionDependentFriction { per_m } => {
                Effect::PositionDependentFriction(PositionDependentFriction {
                    linear: per_m,
                    quadratic: None,
                })
            }
            Self::FrictionDrift {
                gain,
                time_constant_s,
            } => Effect::FrictionDrift(FrictionDrift {
                gain,
                time_constant: time_constant_s,
                viscous_gain: None,
            }),
            Self::LoadDependentFriction { share } => {
                Effect::LoadDependentFriction(LoadDependentFriction {
                    load_dependent_friction: share,
                })
            }
            Self::Payload { kg, at_s } => Effect::Payload(Payload {
                payload: kg,
                time: at_s,
                friction: None,
                weight: None,
            }),
            Self::PositionDependentInertia { kg, period_m } => {
                Effect::PositionDependentInertia(PositionDependentInertia {
                    position_dependent_inertia: kg,
                    period: period_m,
                    phase: Some(WAVE_PHASE_RAD),
                })
            }
            Self::TorqueConstantRipple {
                share,
                order_per_rev,
            } => Effect::TorqueConstantRipple(TorqueConstantRipple {
                torque_constant_ripple: share,
                order: Some(order_per_rev),
                period: None,
                phase: Some(WAVE_PHASE_RAD),
            }),
            Self::TorqueSaturation { share } => Effect::TorqueSaturation(TorqueSaturation {
                torque_saturation: SATURATION_PER_N * share / (1.0 - share),
            }),
            Self::Delay { delay_s } => Effect::Delay(Delay { delay: delay_s }),
            _ => return None,
        })
    }
}

fn bristles(sliding: &Sliding, deflection_m: f64) -> Law {
    Law::LuGre {
        bristle_stiffness_n_per_m: sliding.coulomb_n / deflection_m,
        bristle_damping_n_s_per_m: BRISTLE_DAMPING_N_S_PER_M,
    }
}

impl Foreign {
    /// Its force on the axis, N.
    fn force_n(self, table: Motion, time_s: f64) -> f64 {
        match self {
            Self::Spring { n_per_m } => -n_per_m * table.table_m,
            Self::Hum { amplitude_n, hz } => amplitude_n * (TAU * hz * time_s).sin(),
            Self::CubicDrag { n_s3_per_m3 } => -n_s3_per_m3 * table.table_m_per_s.powi(3),
        }
    }
}

/// By how much the log of the effort is late, s.
pub(super) fn logged_late_s(hidden: &[Hidden]) -> f64 {
    let late = hidden.iter().map(|hidden| match hidden {
        Hidden::LoggedLate { late_s } => *late_s,
        _ => 0.0,
    });
    late.sum()
}

/// Force of what the simulator has no name for, N.
pub(super) fn foreign_n(hidden: &[Hidden], table: Motion, time_s: f64) -> f64 {
    let forces = hidden.iter().map(|hidden| match hidden {
        Hidden::Foreign(foreign) => foreign.force_n(table, time_s),
        _ => 0.0,
    });
    forces.sum()
}
