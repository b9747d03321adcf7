//! Maxwell slip: springs side by side, each of which slips at its own deflection.
//!
//! Dahl's bristle has one shape. A contact that gives way asperity by asperity has another: the
//! force since a reversal is any curve that bends one way, and that is what elements with shares
//! that are not negative can be. Where they slip is a grid, so their shares are a convex fit
//! (Lampaert, Swevers and Al-Bender, IEEE TAC 47, 2002; the grid as in Rizos and Fassois, Control
//! Engineering Practice 12, 2004).

use axis_model::EffectName;

use super::Observed;
use crate::evidence::difference::Known;
use crate::fit::blocks::{Blocks, half_width_without_folds};
use crate::fit::fitted::Fitted;
use crate::model::effects::geometric;
use crate::model::effects::stribeck::Stribeck;
use crate::motion::kinematics::Kinematics;

/// Number of deflections of the grid.
const GRID: u32 = 20;
/// The grid about the deflection of Dahl's bristle, as shares of it.
const FROM: f64 = 0.05;
const TO: f64 = 10.0;
/// Nearer to the first place of the grid than this many times it nothing else stands.
const NEXT: f64 = 1.01;

/// An element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// The way after which it slips, from rest.
    pub deflection: f64,
    /// Its share of the sliding level.
    pub share: f64,
}

/// How the level of friction falls as velocity grows: `g = 1 + rise·exp(−|v/vs|^p)`, in Coulomb
/// levels, with the lag that it may have. It is the force at which an element slips; below, only
/// the way tells its force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fall {
    rise: f64,
    velocity: f64,
    law: Option<Stribeck>,
}

impl Fall {
    /// By so much at rest, in Coulomb levels, of such a law.
    pub(crate) const fn by(rise: f64, velocity: f64, law: Stribeck) -> Self {
        Self {
            rise,
            velocity,
            law: Some(law),
        }
    }

    /// The level at rest, in Coulomb levels.
    pub(crate) const fn at_rest(self) -> f64 {
        1.0 + self.rise
    }

    /// Of a model as it was fitted; without a Stribeck fall the level is the same at all
    /// velocities.
    pub(crate) fn of(fitted: &Fitted) -> Self {
        let first = |name| fitted.of(name).and_then(<[f64]>::first).copied();
        let coulomb = first(EffectName::Coulomb).filter(|level| *level > 0.0);
        let mut terms = fitted.terms();
        let fall = terms.find_map(|term| Some((term.part, term.part.effect.fall()?)));
        let excess = first(EffectName::Stribeck);
        let (Some(coulomb), Some(excess), Some((part, law))) = (coulomb, excess, fall) else {
            return Self::default();
        };
        Self {
            rise: (excess / coulomb).max(0.0),
            velocity: part.parameter,
            law: Some(law),
        }
    }

    /// At the rows of a motion.
    fn levels(&self, motion: &Kinematics) -> Vec<f64> {
        let Some(law) = self.law.filter(|_| self.rise > 0.0) else {
            return vec![1.0; motion.len()];
        };
        let left = law.along(motion, self.velocity).into_iter();
        left.map(|left| 1.0 + self.rise * left).collect()
    }
}

/// Elements side by side; their shares add up to one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elements {
    /// From the first one that slips to the last.
    in_turn: Vec<Element>,
    /// What they are without each fold of the record.
    without_folds: Vec<Vec<Element>>,
    /// The level at which they slip.
    fall: Fall,
    /// Which share of their stiffness is at the first place of the grid: those slip there or
    /// anywhere before.
    open: f64,
}

impl Elements {
    /// The elements that leave the least of an observed friction whose level falls, on a grid about
    /// a deflection and not below the smallest that shows; `None` where none of them explains
    /// anything.
    pub(crate) fn best(
        observed: &Observed<'_>,
        fall: Fall,
        about: f64,
        smallest: f64,
    ) -> Option<Self> {
        let from = (FROM * about).max(smallest);
        let grid = geometric(from, (TO * about).max(2.0 * from), GRID);
        let blocks = blocks(observed, fall, &grid);
        let folds = blocks.non_negative_beside_without_folds(0);
        let without_folds = folds.iter().map(|shares| of_shares(&grid, shares));
        let in_turn = of_shares(&grid, &blocks.non_negative_beside(0))?;
        let first = in_turn.iter().filter(|own| own.deflection < NEXT * from);
        let first: f64 = first.map(|own| own.share / own.deflection).sum();
        Some(Self {
            open: first * deflection(&in_turn),
            in_turn,
            without_folds: without_folds.collect::<Option<Vec<_>>>()?,
            fall,
        })
    }

    /// Elements that slip at ways and have shares, found elsewhere, with what the parts of a grid
    /// are without each fold. Their level falls as it was found there.
    pub(crate) fn of(grid: &[f64], folds: &[Vec<f64>], own: &[(f64, f64)]) -> Option<Self> {
        let (ways, shares): (Vec<f64>, Vec<f64>) = own.iter().copied().unzip();
        let without_folds = folds.iter().map(|shares| of_shares(grid, shares));
        Some(Self {
            in_turn: of_shares(&ways, &shares)?,
            without_folds: without_folds.collect::<Option<Vec<_>>>()?,
            fall: Fall::default(),
            open: 0.0,
        })
    }

    /// The same under such a level.
    pub(crate) fn under(self, fall: Fall) -> Self {
        Self { fall, ..self }
    }

    /// The same beside others, whose shares are those of all.
    pub(crate) fn beside(mut self, others: &[Element]) -> Self {
        let left = 1.0 - others.iter().map(|other| other.share).sum::<f64>();
        let all = std::iter::once(&mut self.in_turn).chain(&mut self.without_folds);
        for elements in all {
            for element in elements.iter_mut() {
                element.share *= left;
            }
            elements.extend(others);
            elements.sort_by(|a, b| a.deflection.total_cmp(&b.deflection));
        }
        self
    }

    /// From the first one that slips to the last.
    pub(crate) fn elements(&self) -> &[Element] {
        &self.in_turn
    }

    /// What they do not explain.
    pub(crate) fn error(&self, observed: &Observed<'_>) -> Vec<f64> {
        observed.without(&self.state(observed.motion))
    }

    /// Level over stiffness at standstill.
    pub(crate) fn deflection(&self) -> f64 {
        deflection(&self.in_turn)
    }

    /// The same with its interval, in which is what slips before the first place of the grid.
    pub(crate) fn known_deflection(&self) -> Known {
        let known = self.known(deflection);
        let open = self.open * known.value;
        Known::new(known.value, known.half_width.max(open))
    }

    /// Force over the level after a way from rest, with its interval.
    pub(crate) fn known_force(&self, way: f64) -> Known {
        self.known(|elements| {
            let forces = elements
                .iter()
                .map(|e| e.share * (way / e.deflection).min(1.0));
            forces.sum()
        })
    }

    /// What follows from the elements, with its interval by the jackknife over folds.
    fn known(&self, of: impl Fn(&[Element]) -> f64) -> Known {
        let without_folds: Vec<f64> = self.without_folds.iter().map(|own| of(own)).collect();
        Known::new(of(&self.in_turn), half_width_without_folds(&without_folds))
    }

    /// The same elements, each of which slips at a multiple of its deflection.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let scaled = |elements: &Vec<Element>| -> Vec<Element> {
            let scaled = |element: &Element| Element {
                deflection: factor * element.deflection,
                ..*element
            };
            elements.iter().map(scaled).collect()
        };
        Self {
            in_turn: scaled(&self.in_turn),
            without_folds: self.without_folds.iter().map(scaled).collect(),
            fall: self.fall,
            open: self.open,
        }
    }

    /// Sum of the elements' forces over the level, −1…1.
    pub(crate) fn state(&self, motion: &Kinematics) -> Vec<f64> {
        self.along(&motion.friction_position, &self.fall.levels(motion))
    }

    fn along(&self, position: &[f64], levels: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; position.len()];
        for element in &self.in_turn {
            let own = stop(position, levels, element.deflection);
            sum.iter_mut()
                .zip(own)
                .for_each(|(sum, own)| *sum += element.share * own);
        }
        sum
    }
}

/// A grid about elements that slip at ways and have shares: each, and by so many times before and
/// after it.
pub(crate) fn grid_about(elements: &[(f64, f64)], ratio: f64) -> Vec<f64> {
    let near = |(at, _): &(f64, f64)| [at / ratio, *at, at * ratio];
    let mut grid: Vec<f64> = elements.iter().flat_map(near).collect();
    grid.sort_by(f64::total_cmp);
    let nearer = ratio.sqrt();
    grid.dedup_by(|next, before| *next < nearer * *before);
    grid
}

fn deflection(elements: &[Element]) -> f64 {
    let stiffness = elements.iter().map(|e| e.share / e.deflection);
    1.0 / stiffness.sum::<f64>()
}

/// Force of one element over its level, −1…1, along a position: a spring that slips. Its deflection
/// is that at the Coulomb level.
fn stop(position: &[f64], levels: &[f64], deflection: f64) -> Vec<f64> {
    let mut force = 0.0_f64;
    let mut before = position.first().copied().unwrap_or(0.0);
    let after = |(x, level): (&f64, &f64)| {
        force = (force + (x - before) / deflection).clamp(-level, *level);
        before = *x;
        force / level
    };
    position.iter().zip(levels).map(after).collect()
}

/// Every element of a grid at the observed level, and the friction, where it is known.
fn blocks(observed: &Observed<'_>, fall: Fall, grid: &[f64]) -> Blocks {
    let motion = observed.motion;
    let levels = fall.levels(motion);
    let column = |deflection: &f64| {
        let state = stop(&motion.friction_position, &levels, *deflection);
        let force = observed.level.iter().zip(state);
        force.map(|(level, state)| level * state).collect()
    };
    let columns: Vec<Vec<f64>> = grid.iter().map(column).collect();
    let columns = motion.all_low_passed(&columns);
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let both = motion.fitted.iter().zip(&motion.slow);
    let mask: Vec<bool> = both.map(|(fitted, slow)| *fitted || *slow).collect();
    Blocks::new(&columns, &observed.friction, &mask, motion.period_s)
}

/// Elements with a share.
fn of_shares(grid: &[f64], shares: &[f64]) -> Option<Vec<Element>> {
    let sum: f64 = shares.iter().sum();
    let pairs = grid.iter().zip(shares).filter(|(_, share)| **share > 0.0);
    let elements = pairs.map(|(deflection, share)| Element {
        deflection: *deflection,
        share: share / sum,
    });
    (sum > 0.0).then(|| elements.collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::fit::made;

    /// Elements that slip at shares of a deflection.
    pub(crate) fn elements(deflection: f64, parts: &[(f64, f64)]) -> Elements {
        let element = |(at, share): &(f64, f64)| Element {
            deflection: at * deflection,
            share: *share,
        };
        let elements: Vec<Element> = parts.iter().map(element).collect();
        Elements {
            without_folds: vec![elements.clone(); 10],
            in_turn: elements,
            fall: Fall::default(),
            open: 0.0,
        }
    }

    #[test]
    fn what_slips_before_the_first_place_of_the_grid_leaves_the_deflection_open() {
        let axis = made::axis(made::usual);
        let motion = &axis.motion;
        let of_both = |first: f64| {
            let two = elements(1.0e-3, &[(first, 0.3), (1.0, 0.7)]);
            let state = two.state(motion);
            let observed = Observed {
                motion,
                level: vec![10.0; motion.len()],
                friction: motion.low_passed(&state.iter().map(|z| 10.0 * z).collect::<Vec<_>>()),
                resolution: 1.0e-6,
            };
            Elements::best(&observed, Fall::default(), 1.0e-3, 1.0e-4).unwrap()
        };
        // The grid begins at a tenth of the larger way: one slips behind that, the other before it.
        let [behind, before] = [0.3, 0.02].map(|first| of_both(first).known_deflection());
        assert!(behind.half_width < 0.1 * behind.value, "{behind:?}");
        assert!(before.half_width > 0.5 * before.value, "{before:?}");
    }

    #[test]
    fn a_loop_of_elements_closes_and_its_branches_are_twice_the_virgin_curve() {
        let four = elements(1.0, &[(0.25, 0.25), (0.5, 0.25), (0.75, 0.25), (1.0, 0.25)]);
        let after = |way: &[f64]| *four.along(way, &vec![1.0; way.len()]).last().unwrap();
        for part in [0.1, 0.3, 0.6, 0.9] {
            let virgin = after(&[0.0, part]);
            let back = after(&[0.0, 3.0, 3.0 - 2.0 * part]);
            assert!((1.0 - back - 2.0 * virgin).abs() < 1.0e-12, "{part}");
            let closed = after(&[0.0, part, 0.5 * part, part]);
            assert!((closed - virgin).abs() < 1.0e-12, "{part}");
        }
    }

    #[test]
    fn the_deflection_is_level_over_stiffness_and_goes_with_the_scale() {
        let two = elements(2.0, &[(0.5, 0.5), (1.0, 0.5)]);
        // Half a level over one, and half a level over two.
        assert!((two.deflection() - 1.0 / 0.75).abs() < 1.0e-12);
        assert!((two.scaled(3.0).deflection() - 4.0).abs() < 1.0e-12);
        assert!((two.known_force(1.5).value - 0.875).abs() < 1.0e-12);
    }

    #[test]
    fn one_more_element_takes_its_share_of_all() {
        let two = elements(2.0, &[(0.5, 0.5), (1.0, 0.5)]);
        let three = two.beside(&[Element {
            deflection: 1.5,
            share: 0.2,
        }]);
        let own = three.elements().iter();
        let own: Vec<(f64, f64)> = own.map(|own| (own.deflection, own.share)).collect();
        assert_eq!(own, [(1.0, 0.4), (1.5, 0.2), (2.0, 0.4)]);
        assert!(three.known_deflection().half_width < 1.0e-12);
    }

    #[test]
    fn below_its_level_the_way_alone_tells_the_force_of_an_element() {
        let one = elements(1.0, &[(1.0, 1.0)]);
        // Half bent at a level of 1.3; then the level falls, and the force stays what it was.
        let state = one.along(&[0.0, 0.5, 0.5, 3.0, 3.0], &[1.3, 1.3, 1.0, 1.0, 1.3]);
        let wanted = [0.0, 0.5 / 1.3, 0.5, 1.0, 1.0 / 1.3];
        for (state, wanted) in state.iter().zip(wanted) {
            assert!((state - wanted).abs() < 1.0e-12, "{state} {wanted}");
        }
    }

    #[test]
    fn the_level_falls_with_the_velocity_as_the_model_says() {
        let coulomb = made::model(&[EffectName::Coulomb]);
        let model = coulomb.with(made::found(EffectName::Stribeck, 2.0e-3));
        let fitted = Fitted::new(model, &[200.0, 60.0]);
        let fall = Fall::of(&fitted);
        let mut axis = made::axis(made::usual);
        axis.motion.velocity_lp[..3].copy_from_slice(&[0.0, -2.0e-3, 0.1]);
        let levels = fall.levels(&axis.motion);
        let wanted = [1.3, 1.0 + 0.3 / std::f64::consts::E, 1.0];
        for (level, wanted) in levels.iter().zip(wanted) {
            assert!((level - wanted).abs() < 1.0e-12, "{level} {wanted}");
        }
    }

    #[test]
    fn shares_add_up_to_one_and_nothing_is_no_element() {
        let found = of_shares(&[1.0, 2.0, 3.0], &[0.6, 0.0, 0.2]).unwrap();
        let shares: Vec<(f64, f64)> = found.iter().map(|e| (e.deflection, e.share)).collect();
        assert_eq!(shares.len(), 2);
        assert!((shares[0].1 - 0.75).abs() < 1.0e-12 && shares[1].0 == 3.0);
        assert!(of_shares(&[1.0, 2.0], &[0.0, 0.0]).is_none());
    }
}
