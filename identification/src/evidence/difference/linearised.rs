//! A wind-up by the load's motion beside other ways, linearised about its bristle: columns of the
//! wind-up, derivatives by what is searched of it, columns of the others.

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
pub(super) struct Linearised {
    carried: Carried,
    blocks: Blocks,
    /// The other ways.
    pub others: Vec<Way>,
}

impl Linearised {
    /// Place of the coefficients of the other ways: after those of the wind-up, and the changes of
    /// what is searched of its friction.
    pub(super) fn others_from(&self) -> usize {
        self.carried.width() + self.carried.friction.searched().len()
    }

    /// About the wind-up at a place of such ways.
    pub(super) fn of(apart: &Apart<'_>, ways: &[Way], place: usize) -> Option<Self> {
        let fitted = apart.fit(ways);
        let (Way::Carried(carried), own) = fitted.at(place)? else {
            return None;
        };
        let mut others = ways.to_vec();
        others.remove(place);
        let columns = apart.columns(Way::Carried(carried));
        let bent = derivatives(apart, carried, own);
        let design = [columns, bent, apart.design(&others)].concat();
        Some(Self {
            carried,
            blocks: apart.blocks_of(&design, &apart.target),
            others,
        })
    }

    /// The bristle that it is linearised about.
    pub(super) const fn friction(&self) -> LoadFriction {
        self.carried.friction
    }

    /// Coefficients with their half widths: those of the wind-up ([`Carried`]), the changes of
    /// what is searched of its friction as shares of it, those of the others.
    pub(super) fn known(&self) -> Vec<Known> {
        let values = self.blocks.fit().coefficients.into_iter();
        let known = values.zip(self.blocks.half_widths());
        known
            .map(|(value, half_width)| Known::new(value, half_width))
            .collect()
    }

    /// The wind-up after a step of Gauss and Newton; `None` where there is none to take.
    pub(super) fn step(&self) -> Option<Carried> {
        let coefficients = self.blocks.fit().coefficients;
        let changes = coefficients.get(self.carried.width()..self.others_from())?;
        let mut factors = [1.0; LoadFriction::MOST_SEARCHED];
        for (place, change) in self.carried.friction.searched().into_iter().zip(changes) {
            factors[place] = (1.0 + change).clamp(FACTORS.0, FACTORS.1);
        }
        let is_known = factors.iter().all(|factor| factor.is_finite());
        is_known.then(|| self.carried.scaled(factors))
    }
}

/// How motor − load changes with what is searched of the friction, each by its own size.
fn derivatives(apart: &Apart<'_>, carried: Carried, own: &[f64]) -> Vec<Vec<f64>> {
    let at = |parameter: usize, by: f64| {
        let mut factors = [1.0; LoadFriction::MOST_SEARCHED];
        factors[parameter] += by;
        apart.predicted(Way::Carried(carried.scaled(factors)), own)
    };
    let of = |parameter: usize| {
        let pairs = at(parameter, STEP).into_iter().zip(at(parameter, -STEP));
        pairs.map(|(up, down)| (up - down) / (2.0 * STEP)).collect()
    };
    carried.friction.searched().into_iter().map(of).collect()
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
        let moved = Linearised::of(&apart, &away, 1).unwrap().step().unwrap();
        let near = [ways[0], Way::Carried(moved)];
        let left = |ways: &[Way]| apart.blocks(ways).fit().sse;
        assert!(left(&near) - left(&ways) < 0.05 * (left(&away) - left(&ways)));
        let linearised = Linearised::of(&apart, &ways, 1).unwrap();
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
        assert!(Linearised::of(&apart(&axis), &WAYS, 1).is_none());
        assert!(Linearised::of(&apart(&axis), &WAYS, 7).is_none());
    }
}
