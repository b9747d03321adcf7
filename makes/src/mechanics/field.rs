//! Forces of place and time, and drag: what acts on a body beside joints and friction.
//!
//! Drag is c·v + q·v·|v| + d·v³ against motion, c by direction, and c may fall while oil warms up;
//! what is no polynomial is in [`resistance`](super::resistance). All of it may grow with position.
//! A field is a force along positive motion, a function of position and time.

use std::f64::consts::{PI, TAU};

use crate::mechanics::resistance::Resistance;

/// Oil that warms up from the start of the record: 1 + surplus · exp(−t/τ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmOil {
    /// Surplus at the start.
    pub surplus: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
}

impl WarmOil {
    fn factor(&self, time_s: f64) -> f64 {
        1.0 + self.surplus * libm::exp(-time_s / self.time_constant_s)
    }
}

/// Drag of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drag {
    /// Which body.
    pub body: usize,
    /// Viscous friction in positive motion, N s/m or N m s/rad.
    pub forward: f64,
    /// In negative motion.
    pub backward: f64,
    /// Quadratic, N s²/m² or N m s²/rad².
    pub quadratic: f64,
    /// Cubic, N s³/m³ or N m s³/rad³.
    pub cubic: f64,
    /// What changes its viscous friction with time.
    pub oil: Option<WarmOil>,
    /// What it has beside the polynomial.
    pub resistance: Option<Resistance>,
    /// Growth of all of it with position, as a share per m or rad: a dashpot whose groove narrows.
    pub taper: f64,
}

impl Drag {
    /// Viscous drag, the same in both directions.
    #[must_use]
    pub fn viscous(body: usize, viscous: f64) -> Self {
        Self {
            body,
            forward: viscous,
            backward: viscous,
            ..Self::default()
        }
    }

    /// The force against positive motion.
    #[must_use]
    pub fn against(&self, velocity: f64, time_s: f64) -> f64 {
        let linear = if velocity >= 0.0 {
            self.forward
        } else {
            self.backward
        };
        let per_velocity = self.quadratic * velocity.abs() + self.cubic * velocity * velocity;
        let oil = self.oil.map_or(1.0, |oil| oil.factor(time_s));
        let other = self.resistance.map_or(0.0, |law| law.against(velocity));
        (linear * oil + per_velocity) * velocity + other
    }

    /// The factor of its taper at a position.
    #[must_use]
    pub fn narrowed(&self, position: f64) -> f64 {
        (1.0 + self.taper * position).max(0.0)
    }
}

/// A force along positive motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Field {
    /// Gravity, counterweight, preload: constant.
    Constant(f64),
    /// amplitude · sin(waves · x + phase): cogging, a screw's runout.
    Cogging {
        /// Amplitude.
        amplitude: f64,
        /// Wave number, rad per unit.
        waves: f64,
        /// Phase at position zero, rad.
        phase: f64,
    },
    /// amplitude · sin(waves · x · (1 + stretch · x) + phase): a worm whose pitch changes on its
    /// way.
    Scroll {
        /// Amplitude.
        amplitude: f64,
        /// Wave number at position zero, rad per unit.
        waves: f64,
        /// Half of what it grows by, as a share per unit.
        stretch: f64,
        /// Phase at position zero, rad.
        phase: f64,
    },
    /// −stiffness · (x − rest).
    Spring {
        /// Stiffness.
        stiffness: f64,
        /// Where it is slack.
        rest: f64,
    },
    /// −stiffness · x · (1 + (x/knee)²): a stack of disc springs that flattens one spring after the
    /// other, to either side of its middle.
    DiscSprings {
        /// Stiffness in the middle.
        stiffness: f64,
        /// Where the secant is twice as stiff.
        knee: f64,
    },
    /// A buffer that is touched beyond a position: pushes back only (Hunt and Crossley's contact
    /// without hysteresis, exponent one).
    Stop {
        /// Where it begins; on the side of its sign.
        at: f64,
        /// Stiffness.
        stiffness: f64,
    },
    /// Air that is closed in and pushes outward: force · (column/(column + x))^exponent.
    AirSpring {
        /// Force at position zero.
        force: f64,
        /// Height of the air at position zero.
        column: f64,
        /// 1 where it changes slowly and stays as warm as it is, 1.4 where it is fast.
        exponent: f64,
    },
    /// A latch that pulls into its middle: −depth · s·exp(½(1 − s²)), s = (x − at)/width; the
    /// largest force is the depth.
    Latch {
        /// Middle.
        at: f64,
        /// Distance of the largest force.
        width: f64,
        /// Largest force.
        depth: f64,
    },
    /// A force over time that comes from elsewhere: amplitude · sin(2π f t).
    Hum {
        /// Amplitude.
        amplitude: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// A force that is there from a time on.
    Step {
        /// Force.
        force: f64,
        /// From when, s.
        at_s: f64,
    },
    /// A force that grows evenly from the start of the record.
    Ramp(f64),
    /// Blows that come from elsewhere at one rate: half a sine of force each.
    Blows {
        /// Largest force.
        force: f64,
        /// Length of a blow, s.
        lasts_s: f64,
        /// From one to the next, s.
        period_s: f64,
    },
}

impl Field {
    /// The force at a position and a time.
    #[must_use]
    pub fn at(&self, position: f64, time_s: f64) -> f64 {
        match *self {
            Self::Constant(force) => force,
            Self::Cogging {
                amplitude,
                waves,
                phase,
            } => amplitude * libm::sin(waves * position + phase),
            Self::Scroll {
                amplitude,
                waves,
                stretch,
                phase,
            } => {
                let angle = waves * position * (1.0 + stretch * position) + phase;
                amplitude * libm::sin(angle)
            }
            Self::Spring { stiffness, rest } => -stiffness * (position - rest),
            Self::DiscSprings { stiffness, knee } => {
                let ratio = position / knee;
                -stiffness * position * (1.0 + ratio * ratio)
            }
            Self::Stop { at, stiffness } => {
                let beyond = (position - at) * at.signum();
                -stiffness * beyond.max(0.0) * at.signum()
            }
            Self::AirSpring {
                force,
                column,
                exponent,
            } => force * libm::pow(column / (column + position), exponent),
            Self::Latch { at, width, depth } => {
                let s = (position - at) / width;
                -depth * s * libm::exp(0.5 * (1.0 - s * s))
            }
            Self::Hum {
                amplitude,
                frequency_hz,
            } => amplitude * libm::sin(TAU * frequency_hz * time_s),
            Self::Step { force, at_s } => {
                if time_s >= at_s {
                    force
                } else {
                    0.0
                }
            }
            Self::Ramp(per_s) => per_s * time_s.max(0.0),
            Self::Blows {
                force,
                lasts_s,
                period_s,
            } => {
                let into = time_s.rem_euclid(period_s) / lasts_s;
                force * libm::sin(PI * into.min(1.0))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drag_is_odd_where_it_is_the_same_in_both_directions() {
        let drag = Drag {
            quadratic: 3.0,
            cubic: 5.0,
            ..Drag::viscous(0, 2.0)
        };
        assert_eq!(drag.against(1.0, 0.0), 10.0);
        assert_eq!(drag.against(-1.0, 0.0), -10.0);
    }

    #[test]
    fn warm_oil_has_lost_63_percent_of_its_surplus_after_its_time_constant() {
        let drag = Drag {
            oil: Some(WarmOil {
                surplus: 0.5,
                time_constant_s: 8.0,
            }),
            ..Drag::viscous(0, 2.0)
        };
        assert_eq!(drag.against(1.0, 0.0), 3.0);
        assert!((drag.against(1.0, 8.0) - 2.368).abs() < 1.0e-3);
    }

    #[test]
    fn a_groove_that_narrows_drags_more_the_farther_it_goes() {
        let drag = Drag {
            taper: 2.0,
            ..Drag::viscous(0, 5.0)
        };
        assert_eq!([-0.6, 0.0, 0.25].map(|x| drag.narrowed(x)), [0.0, 1.0, 1.5]);
        assert_eq!(Drag::viscous(0, 5.0).narrowed(-7.0), 1.0);
    }

    #[test]
    fn the_waves_of_a_scroll_get_closer() {
        let worm = Field::Scroll {
            amplitude: 3.0,
            waves: TAU,
            stretch: 0.5,
            phase: 0.0,
        };
        // One wave ends at √3 − 1, the second at √5 − 1.
        for end in [0.0, 3.0_f64.sqrt() - 1.0, 5.0_f64.sqrt() - 1.0] {
            assert!(worm.at(end, 0.0).abs() < 1.0e-9 && worm.at(end + 0.01, 0.0) > 0.1);
        }
    }

    #[test]
    fn a_stack_of_disc_springs_is_twice_as_stiff_at_its_knee() {
        let stack = Field::DiscSprings {
            stiffness: 500.0,
            knee: 0.04,
        };
        assert!((stack.at(0.04, 0.0) + 40.0).abs() < 1.0e-9);
        assert!((stack.at(-0.04, 0.0) - 40.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_stop_pushes_back_on_its_side_only() {
        let stop = Field::Stop {
            at: -0.2,
            stiffness: 1000.0,
        };
        assert_eq!(stop.at(-0.1, 0.0), 0.0);
        assert!((stop.at(-0.21, 0.0) - 10.0).abs() < 1.0e-9);
        assert_eq!(stop.at(0.5, 0.0), 0.0);
    }

    #[test]
    fn pressure_times_volume_to_its_exponent_stays() {
        let air = Field::AirSpring {
            force: 500.0,
            column: 0.3,
            exponent: 1.4,
        };
        assert_eq!(air.at(0.0, 0.0), 500.0);
        for x in [-0.1, 0.05, 0.1] {
            let kept = air.at(x, 0.0) * libm::pow(0.3 + x, 1.4);
            assert!((kept / (500.0 * libm::pow(0.3, 1.4)) - 1.0).abs() < 1.0e-12);
        }
        assert!(air.at(-0.1, 0.0) > 700.0);
    }

    #[test]
    fn a_blow_is_over_before_the_next_one_and_a_ramp_begins_with_the_record() {
        let blows = Field::Blows {
            force: 80.0,
            lasts_s: 0.1,
            period_s: 0.5,
        };
        assert!((blows.at(0.0, 1.05) - 80.0).abs() < 1.0e-9);
        assert!(blows.at(0.0, 1.2).abs() < 1.0e-9);
        let [early, late] = [-1.0, 4.0].map(|t| Field::Ramp(2.5).at(0.0, t));
        assert_eq!([early, late], [0.0, 10.0]);
    }

    #[test]
    fn the_depth_of_a_latch_is_its_largest_force() {
        let latch = Field::Latch {
            at: 0.1,
            width: 0.01,
            depth: 20.0,
        };
        assert!((latch.at(0.11, 0.0) + 20.0).abs() < 1.0e-9);
        assert!((latch.at(0.09, 0.0) - 20.0).abs() < 1.0e-9);
        assert_eq!(latch.at(0.1, 0.0), 0.0);
    }
}
