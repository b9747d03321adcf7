//! The parameters of a simulation, in one table.
//!
//! A row says where a parameter stands in the model ([`Place`]), what it is worth, in what steps it
//! is searched and between what limits. The places are listed once, in [`Simulated::places`]. The
//! vector that a fit moves, the model that it makes of one, and the estimates for people
//! ([`estimates`](crate::simulate::model::estimates)) all follow that list. A fit sees a parameter
//! as a multiple of its scale.

use axis_model::EffectName;

use crate::simulate::model::{Force, Simulated};

/// Step of a numerical derivative, in units of the scale: the position is smooth over it.
const STEP: f64 = 1.0e-3;
/// The same over a gap, where the cost is jagged: contacts come and go with it.
const JAGGED_STEP: f64 = 0.04;
/// What is positive stays above this share of its scale.
const LEAST: f64 = 1.0e-4;
/// A force counts as at least this share of the Coulomb friction, for its scale.
const SMALLEST_FORCE: f64 = 0.05;
/// Micro-damping counts as at least this many masses a second, for its scale.
const SMALLEST_DAMPING_PER_S: f64 = 2.0;
/// Motor and load both have a mass.
const LOAD_SHARES: (f64, f64) = (0.05, 0.95);
/// The load keeps some friction, else it would coast for ever.
const MOTOR_FRICTIONS: (f64, f64) = (0.0, 0.95);
/// An impact takes some energy, else a load would bounce for ever.
const RESTITUTIONS: (f64, f64) = (0.0, 0.98);
const UNLIMITED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Where a parameter stands in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Moved mass.
    Mass,
    /// Coefficient of a force's column.
    Coefficient {
        /// Which force.
        force: usize,
        /// Which of its columns.
        column: usize,
    },
    /// Nonlinear parameter of a force.
    Nonlinear {
        /// Which force.
        force: usize,
    },
    /// k of the actuator.
    Saturation,
    /// Delay beyond the hold.
    Delay,
    /// Deflection of the bristle.
    Deflection,
    /// Micro-damping of the bristle.
    Damping,
    /// Width of the gap.
    GapWidth,
    /// Share of the mass behind the gap.
    LoadShare,
    /// Share of the friction before the gap.
    MotorFriction,
    /// Coefficient of restitution.
    Restitution,
}

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameter {
    /// Where it stands.
    pub place: Place,
    /// What it is worth.
    pub value: f64,
    /// Its size.
    pub scale: f64,
    /// Step of the numerical derivative, in units of the scale.
    pub step: f64,
    /// Whether it stays positive.
    pub positive: bool,
    limits: (f64, f64),
}

impl Parameter {
    /// A parameter without a sign of its own.
    const fn free(place: Place, value: f64, scale: f64) -> Self {
        Self {
            place,
            value,
            scale,
            step: STEP,
            positive: false,
            limits: UNLIMITED,
        }
    }

    const fn positive(place: Place, value: f64, scale: f64) -> Self {
        Self {
            positive: true,
            ..Self::free(place, value, scale)
        }
    }

    const fn jagged(place: Place, value: f64, scale: f64, limits: (f64, f64)) -> Self {
        Self {
            step: JAGGED_STEP,
            limits,
            ..Self::positive(place, value, scale)
        }
    }

    /// Whether the cost over it is jagged.
    #[must_use]
    pub(crate) fn is_jagged(&self) -> bool {
        self.step >= JAGGED_STEP
    }

    /// It as a multiple of its scale.
    #[must_use]
    pub(crate) fn scaled(&self) -> f64 {
        self.value / self.scale
    }

    /// The parameter at another multiple of its scale.
    #[must_use]
    pub(crate) fn at(&self, scaled: f64) -> Self {
        let multiple = if self.positive {
            scaled.abs().max(LEAST)
        } else {
            scaled
        };
        Self {
            value: self.scale * multiple,
            ..*self
        }
    }
}

impl Simulated {
    /// The table.
    #[must_use]
    pub(crate) fn parameters(&self) -> Vec<Parameter> {
        let mut copy = self.clone();
        let places = self.places().into_iter();
        places
            .filter_map(|place| Some(self.parameter(place, *copy.slot(place)?)))
            .collect()
    }

    /// What an inverse model knows least of an axis that reverses: its mass, the forces that are
    /// the same everywhere, and what makes a reversal.
    #[must_use]
    pub(crate) fn core_parameters(&self) -> Vec<Parameter> {
        let is_core = |parameter: &Parameter| match parameter.place {
            Place::Coefficient { force, .. } => {
                let Force { part, own } = &self.forces[force];
                part.effect.steady(own).is_some()
            }
            Place::Nonlinear { .. } | Place::Saturation | Place::Delay => false,
            _ => true,
        };
        self.parameters().into_iter().filter(is_core).collect()
    }

    /// The model with other values of its parameters, within their limits.
    #[must_use]
    pub(crate) fn with(&self, parameters: &[Parameter]) -> Self {
        let mut copy = self.clone();
        for parameter in parameters {
            let (low, high) = parameter.limits;
            if let Some(slot) = copy.slot(parameter.place) {
                *slot = parameter.value.clamp(low, high);
            }
        }
        copy
    }

    /// Where the parameters stand, in the order of the table.
    fn places(&self) -> Vec<Place> {
        let mut places = vec![Place::Mass];
        for (force, Force { part, own }) in self.forces.iter().enumerate() {
            places.extend((0..own.len()).map(|column| Place::Coefficient { force, column }));
            places.extend(part.effect.is_tuned().then_some(Place::Nonlinear { force }));
        }
        places.extend((!self.saturation.is_ideal()).then_some(Place::Saturation));
        places.extend((self.delay_s != 0.0).then_some(Place::Delay));
        if self.mechanics.shape.bristle.is_some() {
            places.extend([Place::Deflection, Place::Damping]);
        }
        if self.mechanics.shape.gap.is_some() {
            places.extend([Place::GapWidth, Place::LoadShare]);
            places.extend([Place::MotorFriction, Place::Restitution]);
        }
        places
    }

    /// What stands at a place, where the model has that.
    fn slot(&mut self, place: Place) -> Option<&mut f64> {
        let (bristle, gap) = {
            let shape = &mut self.mechanics.shape;
            (shape.bristle.as_mut(), shape.gap.as_mut())
        };
        match place {
            Place::Mass => Some(&mut self.mechanics.mass),
            Place::Coefficient { force, column } => self.forces.get_mut(force)?.own.get_mut(column),
            Place::Nonlinear { force } => Some(&mut self.forces.get_mut(force)?.part.parameter),
            Place::Saturation => Some(&mut self.saturation.per_effort),
            Place::Delay => Some(&mut self.delay_s),
            Place::Deflection => Some(&mut bristle?.deflection),
            Place::Damping => Some(&mut bristle?.damping),
            Place::GapWidth => Some(&mut gap?.width),
            Place::LoadShare => Some(&mut gap?.load_share),
            Place::MotorFriction => Some(&mut gap?.motor_friction),
            Place::Restitution => Some(&mut gap?.restitution),
        }
    }

    fn parameter(&self, place: Place, value: f64) -> Parameter {
        let mass = self.mechanics.mass;
        match place {
            Place::Mass
            | Place::Nonlinear { .. }
            | Place::Saturation
            | Place::Delay
            | Place::Deflection => Parameter::positive(place, value, value.abs()),
            Place::Coefficient { force, .. } => Parameter {
                positive: self.forces[force].part.is(EffectName::Coulomb),
                ..Parameter::free(place, value, self.force_scale(value))
            },
            Place::Damping => {
                Parameter::positive(place, value, value.max(SMALLEST_DAMPING_PER_S * mass))
            }
            Place::GapWidth => Parameter::jagged(place, value, value, UNLIMITED),
            Place::LoadShare => Parameter::jagged(place, value, 1.0, LOAD_SHARES),
            Place::MotorFriction => Parameter::jagged(place, value, 1.0, MOTOR_FRICTIONS),
            Place::Restitution => Parameter::jagged(place, value, 1.0, RESTITUTIONS),
        }
    }

    fn force_scale(&self, coefficient: f64) -> f64 {
        let mut forces = self.forces.iter();
        let coulomb = forces.find(|force| force.part.is(EffectName::Coulomb));
        let level = coulomb.map_or(self.mechanics.mass, |force| force.own[0].abs());
        coefficient
            .abs()
            .max(SMALLEST_FORCE * level.max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::axis::{Gap, Shape};
    use crate::simulate::friction::Bristle;
    use crate::simulate::made;

    /// 90 kg, 25 N of friction, 0.5 N of offset, ripple, saturation, delay, a bristle and a gap.
    fn everything() -> Simulated {
        use EffectName::{Coulomb, Delay, Inertia, Offset, TorqueRipple, TorqueSaturation};
        let fitted = made::fitted(&[
            (Inertia, 0.0, &[90.0]),
            (Coulomb, 0.0, &[25.0]),
            (Offset, 0.0, &[-0.5]),
            (TorqueRipple, 100.0, &[3.0, -4.0]),
            (Delay, 2.0e-3, &[]),
            (TorqueSaturation, 1.0e-3, &[]),
        ]);
        let shape = Shape {
            bristle: Some(Bristle {
                deflection: 2.0e-5,
                damping: 70.0,
            }),
            gap: Some(Gap {
                width: 3.0e-5,
                load_share: 0.4,
                motor_friction: 0.3,
                restitution: 0.5,
            }),
        };
        let dataset = made::dataset(made::record(1.0e-3, made::two_sines(400)), None);
        Simulated::new(&dataset, 1.0e-3, &fitted, shape).unwrap()
    }

    const VALUES: [f64; 14] = [
        90.0, 25.0, -0.5, 3.0, -4.0, 100.0, 1.0e-3, 2.0e-3, 2.0e-5, 70.0, 3.0e-5, 0.4, 0.3, 0.5,
    ];

    #[test]
    fn the_table_lists_every_parameter_once_in_its_order() {
        let values: Vec<f64> = everything()
            .parameters()
            .iter()
            .map(|row| row.value)
            .collect();
        assert_eq!(values, VALUES);
        let fitted = made::fitted(&[(EffectName::Inertia, 0.0, &[90.0])]);
        let dataset = made::dataset(made::record(1.0e-3, made::two_sines(400)), None);
        let plain = Simulated::new(&dataset, 1.0e-3, &fitted, Shape::default()).unwrap();
        assert_eq!(plain.parameters().len(), 1);
    }

    #[test]
    fn scales_are_sizes_but_for_small_forces_small_damping_and_shares() {
        let scales: Vec<f64> = everything()
            .parameters()
            .iter()
            .map(|row| row.scale)
            .collect();
        let wanted = [
            90.0, 25.0, 1.25, 3.0, 4.0, 100.0, 1.0e-3, 2.0e-3, 2.0e-5, 180.0, 3.0e-5, 1.0, 1.0, 1.0,
        ];
        assert_eq!(scales, wanted);
    }

    #[test]
    fn forces_but_for_coulomb_have_a_sign_and_what_a_gap_is_made_of_is_jagged() {
        let table = everything().parameters();
        let free: Vec<usize> = (0..14).filter(|row| !table[*row].positive).collect();
        let jagged: Vec<usize> = (0..14).filter(|row| table[*row].is_jagged()).collect();
        assert_eq!((free, jagged), (vec![2, 3, 4], vec![10, 11, 12, 13]));
        assert_eq!((table[0].step, table[10].step), (1.0e-3, 0.04));
    }

    #[test]
    fn known_least_are_the_mass_what_is_the_same_everywhere_and_the_shape() {
        let everything = everything();
        let core = everything.core_parameters();
        let known = |place: &Place| match place {
            Place::Coefficient { force, .. } => {
                everything.forces[*force].part.is(EffectName::TorqueRipple)
            }
            Place::Nonlinear { .. } | Place::Saturation | Place::Delay => true,
            _ => false,
        };
        let all = everything.parameters();
        let wanted = all.iter().filter(|parameter| !known(&parameter.place));
        assert!(wanted.eq(&core));
        assert!(core.len() < all.len());
    }

    #[test]
    fn a_model_with_the_values_of_a_table_gives_that_table() {
        let model = everything();
        let moved: Vec<Parameter> = model
            .parameters()
            .iter()
            .map(|row| row.at(1.01 * row.scaled()))
            .collect();
        let values = model.with(&moved).parameters();
        for (row, before) in values.iter().zip(VALUES) {
            assert!((row.value / before - 1.01).abs() < 1.0e-12, "{row:?}");
        }
    }

    #[test]
    fn a_positive_parameter_stays_positive_and_a_free_one_goes_where_it_likes() {
        let table = everything().parameters();
        for (scaled, mass, offset) in [(-2.0, 180.0, -2.5), (1.0e-5, 9.0e-3, 1.25e-5)] {
            assert!((table[0].at(scaled).value - mass).abs() < 1.0e-12);
            assert!((table[2].at(scaled).value - offset).abs() < 1.0e-12);
        }
        assert_eq!(table[2].scaled(), -0.4);
    }

    #[test]
    fn shares_and_restitution_keep_their_limits() {
        let model = everything();
        let moved = |scaled: f64| {
            let table = model.parameters();
            let moved: Vec<Parameter> = table.iter().map(|row| row.at(scaled)).collect();
            model.with(&moved).mechanics.shape.gap.unwrap()
        };
        let (least, most) = (moved(1.0e-9), moved(7.0));
        assert_eq!((least.load_share, most.load_share), (0.05, 0.95));
        assert_eq!((least.motor_friction, most.motor_friction), (1.0e-4, 0.95));
        assert_eq!((least.restitution, most.restitution), (1.0e-4, 0.98));
        assert!((most.width - 2.1e-4).abs() < 1.0e-15);
    }
}
