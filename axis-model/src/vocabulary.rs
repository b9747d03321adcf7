//! The table of effects.
//!
//! Adding one is adding its block here: name, words, where it acts, parameters with dimension and
//! the range that a machine file may state. Everything else of this crate follows from it.
//!
//! Friction is counted positive against motion; x is position, v velocity, u commanded effort. An
//! effect that changes friction says so in shares of it, so that it keeps its meaning when the
//! level changes.

mod parameter;

use std::fmt;
use std::str::FromStr;

use crate::define::vocabulary;
use crate::dimension::Dimension;

pub use parameter::{Parameter, ParameterError};

/// Where an effect acts, and so where a record shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the effort while the axis moves.
    MovingEffort,
    /// About reversals of the direction.
    Reversals,
    /// Between motor and load position.
    MotorLoad,
}

vocabulary! {
    /// effort that accelerates the moved mass, M a
    inertia: Inertia, MovingEffort, {
        /// mass of motor and load together
        inertia: INERTIA, 1.0e-3 => 2.0e6,
    } optional {
        /// mass of the load alone
        load: INERTIA, 1.0e-3 => 1.0e6,
    }

    /// friction that grows with velocity, Fv v
    viscous: Viscous, MovingEffort, {
        /// friction per velocity
        viscous: DAMPING, 0.0 => 1.0e7,
    } optional {}

    /// friction of constant size against motion, Fc sign(v), which holds at standstill
    coulomb: Coulomb, MovingEffort, {
        /// level while it slides
        coulomb: EFFORT, 0.0 => 1.0e6,
    } optional {}

    /// constant force against positive motion
    offset: Offset, MovingEffort, {
        /// the force
        offset: EFFORT, -1.0e6 => 1.0e6,
    } optional {}

    /// other Coulomb friction by direction, Fc (1 + a sign(v)): the same force as an offset
    coulomb_asymmetry: CoulombAsymmetry, MovingEffort, {
        /// half the difference of the directions, as a share of the level
        coulomb_asymmetry: RATIO, -0.9 => 0.9,
    } optional {}

    /// other viscous friction by direction, Fv (1 + a sign(v))
    viscous_asymmetry: ViscousAsymmetry, MovingEffort, {
        /// half the difference of the directions, as a share of the viscous friction
        viscous_asymmetry: RATIO, -0.9 => 0.9,
    } optional {}

    /// friction that falls from breakaway to sliding as velocity grows
    stribeck: Stribeck, MovingEffort, {
        /// friction at breakaway beyond the sliding level
        excess: EFFORT, 0.0 => 1.0e6,
        /// velocity at which 1/e of the excess is left
        velocity: VELOCITY, 1.0e-6 => 1.0,
    } optional {
        /// exponent of the fall exp(-|v/velocity|^exponent); 2 where it is not known
        exponent: RATIO, 0.5 => 2.0,
        /// time in which 63 % of a change of the fall has come; none where it is not known
        lag: TIME, 0.0 => 0.1,
        /// by how much longer it lags at rest, as a share: excess over the sliding level with
        /// generalised Maxwell slip; none where it is not known
        lag_growth: RATIO, 0.0 => 4.0,
    }

    /// hysteretic displacement before the contact slips
    presliding: Presliding, Reversals, {
        /// level of friction over its stiffness at standstill
        deflection: POSITION, 1.0e-12 => 1.0e-2,
    } optional {
        /// damping of the bristles
        damping: DAMPING, 0.0 => 1.0e7,
    }

    /// gap between motor and load
    backlash: Backlash, Reversals, {
        /// width of the gap
        gap: POSITION, 0.0 => 1.0e-2,
    } optional {
        /// load behind the gap, as a share of the moved mass
        load_share: RATIO, 0.0 => 1.0,
        /// friction before the gap, as a share of the friction
        motor_friction: RATIO, 0.0 => 1.0,
        /// velocity after an impact, as a share of that before it
        restitution: RATIO, 0.0 => 1.0,
    }

    /// load that lags the motor by the transmitted force over a stiffness
    compliance: Compliance, MotorLoad, {
        /// stiffness between motor and load
        stiffness: STIFFNESS, 1.0e4 => 1.0e12,
    } optional {
        /// damping between motor and load
        damping: DAMPING, 0.0 => 1.0e7,
    }

    /// force that is periodic in the motor position
    torque_ripple: TorqueRipple, MovingEffort, {
        /// amplitude
        amplitude: EFFORT, 0.0 => 1.0e6,
    } optional {
        /// periods per revolution of the motor
        order: PER_REVOLUTION, 1.0e-3 => 1.0e4,
        /// way from one period to the next
        period: POSITION, 1.0e-6 => 1.0e3,
        /// phase at position zero
        phase: ANGLE, -1.0e3 => 1.0e3,
    }

    /// measured load position that is off by a function periodic in position
    pitch_error: PitchError, MotorLoad, {
        /// amplitude
        amplitude: POSITION, 0.0 => 1.0e-3,
        /// way from one period to the next
        period: POSITION, 1.0e-5 => 10.0,
    } optional {}

    /// friction that is a smooth function of position, Fc (1 + k x)
    position_dependent_friction: PositionDependentFriction, MovingEffort, {
        /// change per position, as a share of the level at position zero
        linear: PER_POSITION, -100.0 => 100.0,
    } optional {
        /// change per position squared, as a share of the level at position zero
        quadratic: PER_POSITION_SQUARED, -1.0e4 => 1.0e4,
    }

    /// friction that changes with time from the start of a record, as an axis warms up
    friction_drift: FrictionDrift, MovingEffort, {
        /// surplus of the level at the start, as a share of the warm level
        gain: RATIO, -0.9 => 10.0,
        /// time in which the surplus falls to 1/e
        time_constant: TIME, 1.0e-3 => 1.0e6,
    } optional {
        /// surplus of the viscous friction at the start, as a share of the warm one
        viscous_gain: RATIO, -0.9 => 10.0,
    }

    /// friction that grows with velocity squared, q v² against motion
    quadratic_drag: QuadraticDrag, MovingEffort, {
        /// friction per velocity squared
        quadratic_drag: DRAG, 0.0 => 1.0e7,
    } optional {}

    /// friction that grows with the magnitude of the transmitted force, mu abs(F) against motion
    load_dependent_friction: LoadDependentFriction, MovingEffort, {
        /// friction per transmitted force, mu
        load_dependent_friction: RATIO, 0.0 => 0.9,
    } optional {}

    /// inertia that changes at a time, with the friction and the weight that come with it
    payload: Payload, MovingEffort, {
        /// inertia that is there from then on, at the load; below zero where one is put down
        payload: INERTIA, -1.0e6 => 1.0e6,
        /// time since the start of the record
        time: TIME, 0.0 => 1.0e6,
    } optional {
        /// level of friction that comes with it
        friction: EFFORT, -1.0e6 => 1.0e6,
        /// constant force against positive motion that comes with it
        weight: EFFORT, -1.0e6 => 1.0e6,
    }

    /// inertia that is a periodic function of position, as of a crank or an arm
    position_dependent_inertia: PositionDependentInertia, MovingEffort, {
        /// amplitude about the mean, at the load
        position_dependent_inertia: INERTIA, 0.0 => 1.0e6,
        /// way from one period to the next
        period: POSITION, 1.0e-6 => 1.0e3,
    } optional {
        /// phase at position zero, of a sine
        phase: ANGLE, -1.0e3 => 1.0e3,
    }

    /// delivered effort that ripples with position, u (1 + c sin(2 pi x / period + phase))
    torque_constant_ripple: TorqueConstantRipple, MovingEffort, {
        /// c
        torque_constant_ripple: RATIO, 0.0 => 0.5,
    } optional {
        /// periods per revolution of the motor
        order: PER_REVOLUTION, 1.0e-3 => 1.0e4,
        /// way from one period to the next
        period: POSITION, 1.0e-6 => 1.0e3,
        /// phase at position zero
        phase: ANGLE, -1.0e3 => 1.0e3,
    }

    /// delivered effort that falls behind the commanded one as it grows, u / (1 + k abs(u))
    torque_saturation: TorqueSaturation, MovingEffort, {
        /// k
        torque_saturation: PER_EFFORT, 0.0 => 1.0,
    } optional {}

    /// effort that acts later than the record says
    delay: Delay, MovingEffort, {
        /// the time
        delay: TIME, 0.0 => 1.0e-3,
    } optional {}

    /// effort that acted earlier than the record says: the log is late, not the axis
    logged_late: LoggedLate, MovingEffort, {
        /// the time
        logged_late: TIME, 0.0 => 0.1,
    } optional {}
}

impl fmt::Display for EffectName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// A word that names no effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownEffect(pub String);

impl fmt::Display for UnknownEffect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known: Vec<&str> = EffectName::ALL.iter().map(|name| name.as_str()).collect();
        write!(
            f,
            "unknown effect \"{}\"; known: {}",
            self.0,
            known.join(", ")
        )
    }
}

impl std::error::Error for UnknownEffect {}

impl FromStr for EffectName {
    type Err = UnknownEffect;

    fn from_str(word: &str) -> Result<Self, UnknownEffect> {
        let known = Self::ALL.iter().find(|name| name.as_str() == word);
        known.copied().ok_or_else(|| UnknownEffect(word.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_name_has_words_and_parses_back() {
        for name in EffectName::ALL {
            assert_eq!(name.to_string().parse(), Ok(*name));
            assert!(name.words().len() > 20, "{name}");
            assert!(!name.parameters().is_empty(), "{name}");
            for parameter in name.parameters() {
                assert!(!parameter.words.trim().is_empty(), "{}", parameter.key());
                assert!(parameter.min < parameter.max, "{}", parameter.key());
            }
        }
    }

    #[test]
    fn a_name_that_is_none_is_refused_with_those_that_are() {
        let error = "ofset".parse::<EffectName>().unwrap_err().to_string();
        assert!(error.starts_with("unknown effect \"ofset\"; known: inertia, viscous, coulomb"));
    }

    #[test]
    fn no_two_parameters_share_a_name_in_a_report() {
        let all = EffectName::ALL.iter().flat_map(|name| name.parameters());
        let names: Vec<String> = all.map(Parameter::report_name).collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
        assert!(names.contains(&"coulomb".into()));
        assert!(names.contains(&"torque_ripple_amplitude".into()));
    }
}
