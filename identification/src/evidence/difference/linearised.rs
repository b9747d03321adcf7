//! A wind-up by the load's motion beside other ways, linearised about its bristle: columns of the
//! wind-up, derivatives by what is searched of it, columns of the others.

use super::beside::{Beside, Rubbed};
use super::columns::{Apart, Way};
use super::known::Known;
use super::load::Carried;
use super::rubbing::LoadFriction;
use crate::fit::blocks::Blocks;

/// Part of a parameter by which its columns are differentiated.
const STEP: f64 = 0.01;
/// Range of the factor that a step puts on a parameter.
const FACTORS: (f64, f64) = (0.5, 2.0);

/// The linearised fit.
pub(super) struct Linearised<'a> {
    beside: &'a Beside<'a>,
    carried: Carried,
    blocks: Blocks,
}

impl<'a> Linearised<'a> {
    /// Place of the coefficients of the other ways: after those of the wind-up, and the changes of
    /// what is searched of its friction.
    pub(super) fn others_from(&self) -> usize {
        self.carried.width() + self.carried.friction.searched().len()
    }

    /// About a friction.
    pub(super) fn about(beside: &'a Beside<'_>, rubbed: &Rubbed) -> Self {
        let bent = beside.derivatives(rubbed, STEP);
        Self {
            blocks: beside.and(rubbed, &bent),
            carried: rubbed.carried,
            beside,
        }
    }

    /// The bristle that it is linearised about.
    pub(super) const fn friction(&self) -> LoadFriction {
        self.carried.friction
    }

    /// The other ways.
    pub(super) fn others(&self) -> &[Way] {
        self.beside.others()
    }

    /// Coefficients with their half widths: those of the wind-up ([`Carried`]), the changes of
    /// what is searched of its friction as shares of it, those of the others.
    pub(super) fn known(&self) -> Vec<Known> {
        let values = self.beside.in_order(self.blocks.fit().coefficients);
        let half_widths = self.beside.in_order(self.blocks.half_widths());
        let known = values.into_iter().zip(half_widths);
        known
            .map(|(value, half_width)| Known::new(value, half_width))
            .collect()
    }

    /// The wind-up after a step of Gauss and Newton; `None` where there is none to take.
    pub(super) fn step(&self) -> Option<Carried> {
        let coefficients = self.beside.in_order(self.blocks.fit().coefficients);
        let changes = coefficients.get(self.carried.width()..self.others_from())?;
        let mut factors = [1.0; LoadFriction::MOST_SEARCHED];
        for (place, change) in self.carried.friction.searched().into_iter().zip(changes) {
            factors[place] = (1.0 + change).clamp(FACTORS.0, FACTORS.1);
        }
        let is_known = factors.iter().all(|factor| factor.is_finite());
        is_known.then(|| self.carried.scaled(factors))
    }
}

/// The wind-up at a place of such ways after a step of Gauss and Newton; `None` where there is none
/// to take.
pub(super) fn step(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Carried> {
    let beside = Beside::of(apart, ways, place)?;
    Linearised::about(&beside, &beside.as_it_was()).step()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::carried::instead;
    use crate::evidence::difference::carried::tests::{UNIT, WAYS, apart, axis};

    #[test]
    fn a_step_goes_to_where_nothing_is_to_be_stepped() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let apart = apart.where_known(&ways);
        let Way::Carried(found) = ways[1] else {
            panic!("{ways:?}");
        };
        let away = [
            ways[0],
            Way::Carried(found.scaled([1.05, 0.9, 1.1, 1.0, 1.0, 1.0, 1.0])),
        ];
        let moved = step(&apart, &away, 1).unwrap();
        let near = [ways[0], Way::Carried(moved)];
        let left = |ways: &[Way]| apart.blocks(ways).fit().sse;
        assert!(left(&near) - left(&ways) < 0.05 * (left(&away) - left(&ways)));
        let beside = Beside::of(&apart, &ways, 1).unwrap();
        let linearised = Linearised::about(&beside, &beside.as_it_was());
        let (known, others) = (linearised.known(), linearised.others_from());
        assert_eq!(known.len(), others + 1);
        for change in &known[others - 3..others] {
            assert!(change.value.abs() < 0.01, "{change:?}");
            assert!(change.half_width > 0.0, "{change:?}");
        }
    }

    #[test]
    fn only_a_wind_up_by_the_load_is_linearised() {
        let axis = axis(|_| 0.0);
        assert!(step(&apart(&axis), &WAYS, 1).is_none());
        assert!(step(&apart(&axis), &WAYS, 7).is_none());
    }
}
