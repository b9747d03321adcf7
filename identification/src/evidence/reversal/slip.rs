//! Maxwell slip: springs side by side, each of which slips at its own deflection.
//!
//! Dahl's bristle has one shape. A contact that gives way asperity by asperity has another: the
//! force since a reversal is any curve that bends one way, and that is what elements with shares
//! that are not negative can be. Where they slip is a grid, so their shares are a convex fit
//! (Lampaert, Swevers and Al-Bender, IEEE TAC 47, 2002; the grid as in Rizos and Fassois, Control
//! Engineering Practice 12, 2004).

use super::Observed;
use crate::evidence::difference::Known;
use crate::fit::blocks::{Blocks, half_width_without_folds};
use crate::model::effects::geometric;

/// Number of deflections of the grid.
const GRID: u32 = 20;
/// The grid about the deflection of Dahl's bristle, as shares of it.
const FROM: f64 = 0.05;
const TO: f64 = 10.0;

/// An element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// The way after which it slips, from rest.
    pub deflection: f64,
    /// Its share of the sliding level.
    pub share: f64,
}

/// Elements side by side; their shares add up to one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elements {
    /// From the first one that slips to the last.
    elements: Vec<Element>,
    /// What they are without each fold of the record.
    without_folds: Vec<Vec<Element>>,
}

impl Elements {
    /// The elements that leave the least of an observed friction, on a grid about a deflection and
    /// not below the smallest that shows; `None` where none of them explains anything.
    pub(crate) fn best(observed: &Observed<'_>, about: f64, smallest: f64) -> Option<Self> {
        let from = (FROM * about).max(smallest);
        let grid = geometric(from, (TO * about).max(2.0 * from), GRID);
        let blocks = blocks(observed, &grid);
        let folds = blocks.non_negative_without_folds();
        let without_folds = folds.iter().map(|shares| of_shares(&grid, shares));
        Some(Self {
            elements: of_shares(&grid, &blocks.non_negative())?,
            without_folds: without_folds.collect::<Option<Vec<_>>>()?,
        })
    }

    /// From the first one that slips to the last.
    pub(crate) fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// What they do not explain.
    pub(crate) fn error(&self, observed: &Observed<'_>) -> Vec<f64> {
        observed.without(&self.state(&observed.motion.friction_position))
    }

    /// Level over stiffness at standstill.
    pub(crate) fn deflection(&self) -> f64 {
        deflection(&self.elements)
    }

    /// The same with its interval.
    pub(crate) fn known_deflection(&self) -> Known {
        self.known(deflection)
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
        Known::new(of(&self.elements), half_width_without_folds(&without_folds))
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
            elements: scaled(&self.elements),
            without_folds: self.without_folds.iter().map(scaled).collect(),
        }
    }

    /// Sum of the elements' forces along a position, −1…1.
    pub(crate) fn state(&self, position: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; position.len()];
        for element in &self.elements {
            let own = stop(position, element.deflection);
            sum.iter_mut()
                .zip(own)
                .for_each(|(sum, own)| *sum += element.share * own);
        }
        sum
    }
}

fn deflection(elements: &[Element]) -> f64 {
    let stiffness = elements.iter().map(|e| e.share / e.deflection);
    1.0 / stiffness.sum::<f64>()
}

/// Force of one element over its level, −1…1, along a position: a spring that slips.
fn stop(position: &[f64], deflection: f64) -> Vec<f64> {
    let mut force = 0.0_f64;
    let mut before = position.first().copied().unwrap_or(0.0);
    let after = |x: &f64| {
        force = (force + (x - before) / deflection).clamp(-1.0, 1.0);
        before = *x;
        force
    };
    position.iter().map(after).collect()
}

/// Every element of a grid at the observed level, and the friction, where it is known.
fn blocks(observed: &Observed<'_>, grid: &[f64]) -> Blocks {
    let motion = observed.motion;
    let column = |deflection: &f64| {
        let state = stop(&motion.friction_position, *deflection);
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

    /// Elements that slip at shares of a deflection.
    pub(crate) fn elements(deflection: f64, parts: &[(f64, f64)]) -> Elements {
        let element = |(at, share): &(f64, f64)| Element {
            deflection: at * deflection,
            share: *share,
        };
        let elements: Vec<Element> = parts.iter().map(element).collect();
        Elements {
            without_folds: vec![elements.clone(); 10],
            elements,
        }
    }

    #[test]
    fn a_loop_of_elements_closes_and_its_branches_are_twice_the_virgin_curve() {
        let four = elements(1.0, &[(0.25, 0.25), (0.5, 0.25), (0.75, 0.25), (1.0, 0.25)]);
        let after = |way: &[f64]| *four.state(way).last().unwrap();
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
    fn shares_add_up_to_one_and_nothing_is_no_element() {
        let found = of_shares(&[1.0, 2.0, 3.0], &[0.6, 0.0, 0.2]).unwrap();
        let shares: Vec<(f64, f64)> = found.iter().map(|e| (e.deflection, e.share)).collect();
        assert_eq!(shares.len(), 2);
        assert!((shares[0].1 - 0.75).abs() < 1.0e-12 && shares[1].0 == 3.0);
        assert!(of_shares(&[1.0, 2.0], &[0.0, 0.0]).is_none());
    }
}
