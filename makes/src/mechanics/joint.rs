//! A joint between two bodies: shaft, screw, belt, gear or coupling.
//!
//! It carries F = k·δ + c·δ' with δ = x₁ − x₂, less what has slipped; inside a gap it carries
//! nothing, and a contact only pushes. A belt's stiffness depends on where the carriage stands:
//! the two strands of lengths l and L − l are springs side by side, k = EA·(1/l + 1/(L − l))
//! (Hace, Jezernik and Sabanovic, IEEE Trans. Ind. Electron. 54, 2007). A strain-wave gear stiffens
//! as it winds up (Tuttle and Seering, IEEE Trans. Robot. Autom. 12, 1996). A coupling that slips
//! carries its limit at most, and the rest of δ stays behind (Prandtl's elastoplastic element). A
//! wheel that rolls creeps: it loses F·|v|/C of way per time (Kalker, Three-Dimensional Elastic
//! Bodies in Rolling Contact, 1990, linear theory).

/// Stiffness, N/m or N m/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// The same everywhere.
    Constant(f64),
    /// k·(1 + (δ/knee)²): teeth of a flexible spline that come into mesh one after the other.
    Hardening {
        /// k, at no deflection.
        stiffness: f64,
        /// Deflection at which the secant is twice as stiff.
        knee: f64,
    },
    /// A belt.
    Belt {
        /// Modulus times cross-section EA, N.
        strain_stiffness_n: f64,
        /// Length between the pulleys, m.
        length_m: f64,
        /// Strand on one side at position zero, m.
        strand_m: f64,
    },
}

impl Stiffness {
    /// Where the load stands.
    #[must_use]
    pub fn at(&self, position: f64) -> f64 {
        match *self {
            Self::Constant(stiffness) | Self::Hardening { stiffness, .. } => stiffness,
            Self::Belt {
                strain_stiffness_n,
                length_m,
                strand_m,
            } => {
                let strand = strand_m + position;
                strain_stiffness_n * (1.0 / strand + 1.0 / (length_m - strand))
            }
        }
    }

    /// Of the secant to a deflection.
    fn secant(&self, position: f64, deflection: f64) -> f64 {
        let hardening = match *self {
            Self::Hardening { knee, .. } => (deflection / knee) * (deflection / knee),
            Self::Constant(_) | Self::Belt { .. } => 0.0,
        };
        self.at(position) * (1.0 + hardening)
    }
}

/// A joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Stiffness.
    pub stiffness: Stiffness,
    /// Damping, N s/m or N m s/rad.
    pub damping: f64,
    /// Gap, whole width, m or rad.
    pub gap: f64,
    /// Effort at which it slips, where it does.
    pub slips_at: Option<f64>,
    /// Way that is lost per way rolled and effort, 1/C; zero where nothing rolls.
    pub creep: f64,
    /// Whether it is a freewheel, which drives the second body in positive direction only.
    pub one_way: bool,
}

/// What a joint does in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// Effort on the second body, and with the other sign on the first.
    pub effort: f64,
    /// What has slipped so far, m or rad.
    pub slipped: f64,
}

impl Joint {
    /// A joint without gap that does not slip.
    #[must_use]
    pub fn stiff(stiffness: f64, damping: f64) -> Self {
        Self {
            stiffness: Stiffness::Constant(stiffness),
            damping,
            gap: 0.0,
            slips_at: None,
            creep: 0.0,
            one_way: false,
        }
    }

    /// What it carries: deflection and its rate, where the load stands, what has slipped.
    #[must_use]
    pub fn carry(&self, deflection: f64, rate: f64, at: f64, slipped: f64) -> Transmission {
        let pressed = dead_zone(deflection - slipped, 0.5 * self.gap);
        let stiffness = self.stiffness.secant(at, pressed);
        let spring = stiffness * pressed;
        match self.slips_at {
            Some(limit) if spring.abs() > limit => Transmission {
                effort: limit.copysign(spring),
                slipped: slipped + (spring - limit.copysign(spring)) / stiffness,
            },
            _ => Transmission {
                effort: self.damped(spring, rate),
                slipped,
            },
        }
    }

    /// What a rolling contact slips over a way under an effort.
    #[must_use]
    pub fn creeps(&self, effort: f64, way: f64) -> f64 {
        self.creep * effort * way.abs()
    }

    fn damped(&self, spring: f64, rate: f64) -> f64 {
        let effort = spring + self.damping * rate;
        if self.one_way {
            effort.max(0.0)
        } else if self.gap == 0.0 {
            effort
        } else if spring == 0.0 || effort * spring < 0.0 {
            0.0
        } else {
            effort
        }
    }
}

fn dead_zone(deflection: f64, half: f64) -> f64 {
    deflection - deflection.clamp(-half, half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_carried_within_the_gap_and_a_contact_only_pushes() {
        let gear = Joint {
            gap: 2.0e-3,
            ..Joint::stiff(1.0e6, 1.0e3)
        };
        assert_eq!(gear.carry(0.9e-3, 1.0, 0.0, 0.0).effort, 0.0);
        assert_eq!(gear.carry(1.1e-3, -1.0, 0.0, 0.0).effort, 0.0);
        assert!((gear.carry(-2.0e-3, 0.0, 0.0, 0.0).effort + 1000.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_belt_is_softest_in_the_middle() {
        let belt = Stiffness::Belt {
            strain_stiffness_n: 1.0e5,
            length_m: 2.0,
            strand_m: 1.0,
        };
        assert!((belt.at(0.0) - 2.0e5).abs() < 1.0e-6);
        assert!((belt.at(0.5) - belt.at(-0.5)).abs() < 1.0e-6 && belt.at(0.5) > belt.at(0.0));
    }

    #[test]
    fn a_gear_that_hardens_has_twice_its_stiffness_at_the_knee() {
        let stiffness = Stiffness::Hardening {
            stiffness: 1.0e4,
            knee: 2.0e-3,
        };
        let gear = Joint {
            stiffness,
            ..Joint::stiff(0.0, 0.0)
        };
        let carried = |deflection| gear.carry(deflection, 0.0, 0.0, 0.0).effort;
        assert!((carried(2.0e-3) - 40.0).abs() < 1.0e-9);
        assert!((carried(-4.0e-3) + 200.0).abs() < 1.0e-9);
        assert!((carried(1.0e-5) - 0.1).abs() < 1.0e-5);
    }

    #[test]
    fn a_wheel_loses_way_by_effort_and_way_in_either_direction() {
        let wheel = Joint {
            creep: 1.0e-5,
            ..Joint::stiff(1.0e7, 0.0)
        };
        assert!((wheel.creeps(200.0, 0.5) - 1.0e-3).abs() < 1.0e-12);
        assert!((wheel.creeps(200.0, -0.5) - 1.0e-3).abs() < 1.0e-12);
        assert!((wheel.creeps(-200.0, 0.5) + 1.0e-3).abs() < 1.0e-12);
    }

    #[test]
    fn a_coupling_carries_its_limit_and_remembers_what_slipped() {
        let coupling = Joint {
            slips_at: Some(100.0),
            ..Joint::stiff(1.0e4, 0.0)
        };
        let slipping = coupling.carry(0.03, 0.0, 0.0, 0.0);
        assert!((slipping.effort - 100.0).abs() < 1e-9 && (slipping.slipped - 0.02).abs() < 1e-12);
        let back = coupling.carry(0.02, 0.0, 0.0, slipping.slipped);
        assert!(back.effort.abs() < 1.0e-9);
    }
}
