//! Resistance to motion that is no polynomial of velocity.
//!
//! - Eddy currents: a rail between magnets drags with most·2r/(1 + r²), r = v/v_c. The force falls
//!   again above the critical velocity v_c (Wouterse, IEE Proceedings B 138, 1991).
//! - Fluids that thin under shear: consistency·|v|ⁿ with n below one (Ostwald and de Waele's law;
//!   Bird, Armstrong and Hassager, Dynamics of Polymeric Liquids, 1987, ch. 4).
//! - A flap in water that opens one way: quadratic·v² in positive motion, nothing in negative
//!   (Newman, Marine Hydrodynamics, 1977, ch. 2, for the plate).
//! - A centrifugal brake: quadratic·(v² − v_c²) above v_c, nothing below it (Shigley's Mechanical
//!   Engineering Design, 2011, ch. 16).
//! - A foil athwart the way: quadratic·v² to one side, whichever way it goes (Newman, Marine
//!   Hydrodynamics, 1977, ch. 5, for the lift).

/// A law of resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resistance {
    /// Eddy currents.
    Eddy {
        /// Largest force, at the critical velocity.
        most: f64,
        /// Critical velocity.
        velocity: f64,
    },
    /// A fluid that thins.
    Thinning {
        /// Force at a velocity of one.
        consistency: f64,
        /// n.
        exponent: f64,
    },
    /// A flap that opens in negative motion: quadratic drag in positive motion, N s²/m² or
    /// N m s²/rad².
    Flap(f64),
    /// A centrifugal brake.
    Centrifugal {
        /// Growth with velocity squared, N s²/m² or N m s²/rad².
        quadratic: f64,
        /// Velocity above which it drags.
        velocity: f64,
    },
    /// A foil that is pushed in negative direction on either way, N s²/m² or N m s²/rad².
    Foil(f64),
}

impl Resistance {
    /// The force against positive motion.
    #[must_use]
    pub fn against(&self, velocity: f64) -> f64 {
        match *self {
            Self::Eddy {
                most,
                velocity: critical,
            } => {
                let r = velocity / critical;
                most * 2.0 * r / (1.0 + r * r)
            }
            Self::Thinning {
                consistency,
                exponent,
            } => (consistency * libm::pow(velocity.abs(), exponent)).copysign(velocity),
            Self::Flap(quadratic) => quadratic * velocity.max(0.0) * velocity.max(0.0),
            Self::Centrifugal {
                quadratic,
                velocity: sets_in,
            } => {
                let pressed = quadratic * (velocity * velocity - sets_in * sets_in);
                pressed.max(0.0).copysign(velocity)
            }
            Self::Foil(quadratic) => quadratic * velocity * velocity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_eddy_brake_drags_most_at_its_critical_velocity_and_less_above_it() {
        let brake = Resistance::Eddy {
            most: 60.0,
            velocity: 0.5,
        };
        assert_eq!(brake.against(0.5), 60.0);
        assert_eq!(brake.against(-0.5), -60.0);
        assert!((brake.against(1.0) - 48.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_fluid_that_thins_drags_half_as_much_at_a_quarter_of_the_velocity() {
        let glue = Resistance::Thinning {
            consistency: 40.0,
            exponent: 0.5,
        };
        assert!((glue.against(1.0) - 40.0).abs() < 1.0e-12);
        assert!((glue.against(-0.25) + 20.0).abs() < 1.0e-12);
    }

    #[test]
    fn a_flap_drags_with_velocity_squared_one_way_only() {
        let flap = Resistance::Flap(40.0);
        assert_eq!([0.5, -0.5].map(|v| flap.against(v)), [10.0, 0.0]);
    }

    #[test]
    fn a_centrifugal_brake_drags_above_its_velocity_only() {
        let brake = Resistance::Centrifugal {
            quadratic: 100.0,
            velocity: 0.5,
        };
        assert_eq!(
            [0.4, 1.0, -1.0].map(|v| brake.against(v)),
            [0.0, 75.0, -75.0]
        );
    }

    #[test]
    fn a_foil_is_pushed_to_one_side_on_either_way() {
        let foil = Resistance::Foil(3.0);
        assert_eq!([-2.0, 0.0, 2.0].map(|v| foil.against(v)), [12.0, 0.0, 12.0]);
    }
}
