//! A parameter set: one raw number for each row of the object table, in physical steps.

use crate::objects::{DEFAULTS, PARAMETERS, Parameter};

/// One value per row of the object table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterSet([i32; PARAMETERS]);

impl Default for ParameterSet {
    fn default() -> Self {
        let mut set = [0; PARAMETERS];
        set.iter_mut()
            .zip(DEFAULTS)
            .for_each(|(place, default)| *place = *default);
        Self(set)
    }
}

impl ParameterSet {
    /// Raw value of a parameter.
    #[must_use]
    #[expect(
        clippy::as_conversions,
        reason = "repr(usize): the discriminant is the place"
    )]
    pub fn get(&self, parameter: Parameter) -> i32 {
        self.0.get(parameter as usize).copied().unwrap_or(0)
    }

    /// Sets a raw value; the range was checked by the caller.
    #[expect(
        clippy::as_conversions,
        reason = "repr(usize): the discriminant is the place"
    )]
    pub fn set(&mut self, parameter: Parameter, value: i32) {
        if let Some(place) = self.0.get_mut(parameter as usize) {
            *place = value;
        }
    }

    /// Whether two sets read the encoders alike and run at the same cycle time: only such a set may
    /// become active in motion.
    #[must_use]
    pub fn measures_like(&self, other: &Self) -> bool {
        ONLY_WITHOUT_TORQUE
            .iter()
            .all(|parameter| self.get(*parameter) == other.get(*parameter))
    }
}

/// What the closed loop stands on: a change of these is a step of the measured position, or of all
/// machine units at once.
pub const ONLY_WITHOUT_TORQUE: [Parameter; 7] = [
    Parameter::CyclePeriod,
    Parameter::PositionSource,
    Parameter::Feed,
    Parameter::FeedRevolutions,
    Parameter::EncoderIncrements,
    Parameter::EncoderRevolutions,
    Parameter::RelationOffset,
];

macro_rules! set_errors {
    ($($name:ident = $code:literal, $text:literal;)*) => {
        /// Why a set as a whole is not valid, though each value is within its range; with the
        /// parameter to look at first.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum SetError {
            $(#[doc = $text] $name(Parameter),)*
        }

        impl SetError {
            /// All reasons: code and text.
            pub const REASONS: &'static [(u8, &'static str)] = &[$(($code, $text),)*];

            /// The parameter to look at first.
            #[must_use]
            pub const fn parameter(self) -> Parameter {
                match self {
                    $(Self::$name(parameter) => parameter,)*
                }
            }

            /// The reason in object 2F02h:2.
            #[must_use]
            pub const fn code(self) -> u8 {
                match self {
                    $(Self::$name(_) => $code,)*
                }
            }

            /// The reason, for people.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$name(_) => $text,)*
                }
            }
        }
    };
}

set_errors! {
    TooLarge = 1, "too large for the drive's machine units at this cycle time";
    TooSmall = 2, "too small for the drive's machine units at this cycle time: it would count as zero";
    WithoutInertia = 3, "a velocity bandwidth needs an inertia";
    WithoutLimit = 4, "torque or backlash compensation needs the axis' velocity and acceleration limits";
    BeyondTorqueLimit = 5, "beyond the torque limit";
    PositionLimitsCrossed = 6, "the lower position limit is not below the upper one";
    FilterHeadroom = 7, "the torque filter's coefficients leave no headroom";
    FilterUnstable = 8, "the torque filter is not stable";
    FilterPeriod = 9, "the torque filter is made for another cycle time than the set";
    SetpointPeriod = 10, "the setpoint period is not 1 to 20 cycles";
    TimeoutTooShort = 11, "the timeout is shorter than two periods of what it watches";
    BeyondAcceleration = 12, "a ramp brakes harder than the axis' acceleration limit";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_has_a_code_of_its_own() {
        let mut codes: Vec<u8> = SetError::REASONS.iter().map(|(code, _)| *code).collect();
        codes.dedup();
        assert_eq!(codes, (1..=12).collect::<Vec<u8>>());
    }
}
