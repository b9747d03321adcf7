//! Friction on the load over its own displacement: a bristle by Dahl's law, or elements of Maxwell
//! slip, both under a level that falls with the velocity.
//!
//! ```text
//! dz/dx2 = (sign dx2 − z/g)/δ     g = 1 + rise·s     τ·ds/dt = s∞ − s     s∞ = exp(−|v2/vs|^p)
//! z = Σ shareᵢ zᵢ     dzᵢ/dx2 = 1/δᵢ within ±g     Σ shareᵢ/δᵢ = 1/δ
//! ```
//!
//! The lag is τ where the level has fallen, and may be longer at rest: τ·(1 + growth·s∞). With
//! generalised Maxwell slip it goes with the level, growth = rise (Lampaert, Al-Bender, Swevers
//! 2003).
//!
//! Levels may differ by direction: g is then (1 ± a) times as high, and a bristle comes to it
//! within as much longer a way.
//!
//! Units: m or rad, s.

use super::between_rows::Steps;
use crate::model::effects::stribeck::{self, GAUSS};
use crate::simulate::friction::bend_after;

/// Most elements.
const ELEMENTS: usize = 15;

/// Elements that go along a path beside each other.
const LANES: usize = 8;

/// An element with a smaller share of the level is none: a share of a two-thousandth that slips
/// after a twentieth of the others' ways would make a hundredth of the stiffness.
const SMALLEST_SHARE: f64 = 5.0e-3;

/// Travel after which it is no matter how far a bristle was bent at the start, in deflections:
/// less than a hundredth of it is left.
const SETTLED: f64 = 5.0;

/// Springs side by side, each of which slips at its own deflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slip {
    /// Where each slips, in deflections of all, and its share of the level; the shares add up to
    /// one, and those that are not there have none. In single precision, because ways are copied.
    elements: [(f32, f32); ELEMENTS],
}

/// How the force builds up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Law {
    /// One bristle.
    Dahl,
    /// Springs that slip.
    Slip(Slip),
}

/// Friction on the load over its own displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadFriction {
    /// Deflection δ over which its force builds up: Coulomb level over stiffness.
    pub deflection: f64,
    /// How much higher the level is at rest, as a share of the Coulomb level.
    pub rise: f64,
    /// Velocity at which that has fallen to 1/e.
    pub velocity: f64,
    /// Lag τ with which the level follows the velocity, s; zero where it follows at once.
    pub lag_s: f64,
    /// By how much longer it lags at rest, as a share. In single precision as the elements are.
    pub lag_growth: f32,
    /// Exponent p of the fall: 2 with Gauss.
    pub exponent: f64,
    /// Level forward, 1 + a, where that of both directions is one: [`ALIKE`] where it is the same.
    /// In single precision as the elements are.
    pub forward: f32,
    /// How the force builds up.
    pub law: Law,
}

/// Level forward where it is the same either way.
pub(super) const ALIKE: f32 = 1.0;
/// Range of an exponent that is searched.
const EXPONENTS: (f64, f64) = (0.4, 2.5);
/// Largest growth of a lag that is searched: that of a breakaway of five times the Coulomb level.
pub(super) const MOST_GROWTH: f64 = 4.0;
/// Range of a level forward that is searched.
const FORWARD: (f64, f64) = (0.1, 1.9);

/// What is left of the rise along a path.
#[derive(Clone, Copy)]
struct Left {
    friction: LoadFriction,
    part_s: f64,
    /// Parts that are kept of the way to where it goes, by the lag where it has fallen.
    kept: [f64; 2],
    state: f64,
}

impl Left {
    fn along(friction: LoadFriction, path: &Steps) -> Self {
        Self {
            friction,
            part_s: path.part_s,
            kept: kept(path.part_s, friction.lag_s),
            state: 1.0,
        }
    }

    /// Levels amid a part of a row and at its end, in Coulomb levels, where so much of the rise is
    /// left in the end; goes on there.
    fn levels(&mut self, end: f64) -> [f64; 2] {
        let LoadFriction {
            lag_s,
            lag_growth,
            rise,
            ..
        } = self.friction;
        let before = self.state;
        let kept = if lag_growth > 0.0 {
            kept(self.part_s, lag_s * (1.0 + f64::from(lag_growth) * end))
        } else {
            self.kept
        };
        let left = kept.map(|kept| end + kept * (before - end));
        self.state = left[1];
        left.map(|left| 1.0 + rise * left)
    }
}

/// What is kept of a way after half a part of a row and after one; nothing without a lag.
fn kept(part_s: f64, lag_s: f64) -> [f64; 2] {
    let half = (-0.5 * part_s / lag_s).exp();
    [half, half * half]
}

impl LoadFriction {
    /// Most quantities that are searched: deflection, rise, velocity, lag, exponent, level forward,
    /// growth of the lag.
    pub(super) const MOST_SEARCHED: usize = 7;
    /// Place of the lag among them.
    pub(super) const LAG: usize = 3;
    /// Place of the exponent.
    pub(super) const EXPONENT: usize = 4;
    /// Place of the level forward.
    pub(super) const FORWARD: usize = 5;
    /// Place of the growth of the lag.
    pub(super) const LAG_GROWTH: usize = 6;

    /// Places of those that are: the last four where they are not the usual ones.
    pub(super) fn searched(self) -> Vec<usize> {
        let lag = (self.lag_s > 0.0).then_some(Self::LAG);
        let exponent = (self.exponent != GAUSS).then_some(Self::EXPONENT);
        let forward = (self.forward != ALIKE).then_some(Self::FORWARD);
        let growth = (self.lag_growth > 0.0).then_some(Self::LAG_GROWTH);
        let unusual = lag.into_iter().chain(exponent).chain(forward).chain(growth);
        (0..Self::LAG).chain(unusual).collect()
    }

    /// The same with each of them times a factor.
    pub(super) fn scaled(self, factors: [f64; Self::MOST_SEARCHED]) -> Self {
        let [deflection, rise, velocity, lag, exponent, forward, growth] = factors;
        Self {
            deflection: self.deflection * deflection,
            rise: self.rise * rise,
            velocity: self.velocity * velocity,
            lag_s: self.lag_s * lag,
            lag_growth: (f64::from(self.lag_growth) * growth).min(MOST_GROWTH) as f32,
            exponent: (self.exponent * exponent).clamp(EXPONENTS.0, EXPONENTS.1),
            forward: (f64::from(self.forward) * forward).clamp(FORWARD.0, FORWARD.1) as f32,
            law: self.law,
        }
    }

    /// The same with such a lag, the same at all velocities.
    pub(super) fn lagging(self, lag_s: f64) -> Self {
        Self {
            lag_s,
            lag_growth: 0.0,
            ..self
        }
    }

    /// The same with a lag that grows by so much, and is the same halfway down the fall.
    pub(super) fn lag_growing(self, growth: f64) -> Self {
        let growth = growth.min(MOST_GROWTH);
        let halfway = |growth: f64| 1.0 + 0.5 * growth;
        Self {
            lag_s: self.lag_s * halfway(self.lag_growth.into()) / halfway(growth),
            lag_growth: growth as f32,
            ..self
        }
    }

    /// The level of a step's direction, in those of both.
    fn towards(self, step: f64) -> f64 {
        f64::from(ALIKE) + f64::from(self.forward - ALIKE) * step.signum()
    }

    /// Travel after which it is no matter how far all was bent at the start.
    pub(super) fn settles_after(self) -> f64 {
        let last = self.elements().last().map(|(at, _)| 2.0 * at);
        last.unwrap_or(SETTLED * self.deflection) * (1.0 + self.rise)
    }

    /// The same, with elements that slip at such ways and have parts of the force as large as
    /// these; the largest ones where there are too many, `None` where there are none.
    pub(super) fn slipping(self, at: &[f64], parts: &[f64]) -> Option<Self> {
        let all = at.iter().copied().zip(parts.iter().copied());
        let least = SMALLEST_SHARE * parts.iter().sum::<f64>();
        let mut all: Vec<(f64, f64)> = all.filter(|(_, part)| *part > least).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all.truncate(ELEMENTS);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let sum: f64 = all.iter().map(|(_, part)| part).sum();
        let deflection = sum / all.iter().map(|(at, part)| part / at).sum::<f64>();
        let single = |(at, part): &(f64, f64)| ((at / deflection) as f32, (part / sum) as f32);
        let element = |i: usize| all.get(i).map(single);
        let law = Law::Slip(Slip {
            elements: std::array::from_fn(|i| element(i).unwrap_or_default()),
        });
        let slipping = Self {
            deflection,
            law,
            ..self
        };
        (sum > 0.0).then_some(slipping)
    }

    /// The elements: where each slips, and its share.
    pub(crate) fn elements(self) -> Vec<(f64, f64)> {
        let Law::Slip(Slip { elements }) = self.law else {
            return Vec::new();
        };
        let there = elements.into_iter().filter(|(_, share)| *share > 0.0);
        there
            .map(|(at, share)| (f64::from(at) * self.deflection, f64::from(share)))
            .collect()
    }

    /// What is left of the rise in the end, in each part of each row of a path.
    pub(super) fn fall(self, path: &Steps) -> Vec<f64> {
        let left = |velocity: f64| stribeck::left(velocity / self.velocity, self.exponent);
        path.velocities().map(left).collect()
    }

    /// Whether another one falls as this does, lag and rise apart.
    pub(super) fn falls_as(self, other: Self) -> bool {
        self.velocity == other.velocity && self.exponent == other.exponent
    }

    /// The bend along a path with its fall, in Coulomb levels.
    pub(super) fn bend(self, path: &Steps, fall: &[f64]) -> Vec<f64> {
        if self.law == Law::Dahl {
            return self.bristle(path, fall);
        }
        let mut sum = vec![0.0; path.len()];
        let levels = self.levels(path, fall);
        for elements in self.elements().chunks(LANES) {
            let at = elements.iter().map(|(at, _)| *at);
            let bends = self.side_by_side(path, &levels, at);
            for (sum, bends) in sum.iter_mut().zip(bends) {
                let forces = elements.iter().zip(bends);
                *sum += forces.map(|((_, share), bend)| share * bend).sum::<f64>();
            }
        }
        sum
    }

    fn bristle(self, path: &Steps, fall: &[f64]) -> Vec<f64> {
        let (mut bend, mut left) = (0.0_f64, Left::along(self, path));
        path.followed(fall, |step, end| {
            let [level, _] = left.levels(end);
            let level = level * self.towards(step);
            if step != 0.0 {
                bend = level * bend_after(bend / level, step, self.deflection * level);
            }
            bend
        })
    }

    /// Bends of elements that slip after such ways, in Coulomb levels.
    pub(super) fn bends(self, path: &Steps, at: &[f64]) -> Vec<Vec<f64>> {
        let levels = self.levels(path, &self.fall(path));
        let of_some = |at: &[f64]| {
            let bends = self.side_by_side(path, &levels, at.iter().copied());
            let lane = |lane: usize| bends.iter().map(|bends| bends[lane]).collect();
            (0..at.len()).map(lane).collect::<Vec<_>>()
        };
        at.chunks(LANES).flat_map(of_some).collect()
    }

    /// Levels at the end of each part of each row, in Coulomb levels: they are the same for all
    /// elements.
    fn levels(self, path: &Steps, fall: &[f64]) -> Vec<f64> {
        let mut left = Left::along(self, path);
        let levels = fall.iter().map(|end| left.levels(*end)[1]);
        levels.collect()
    }

    /// Bends of at most [`LANES`] elements that slip after such ways under such levels, in Coulomb
    /// levels; zero where there are fewer. Each bend waits for the one before it, so they go along
    /// the path beside each other.
    fn side_by_side(
        self,
        path: &Steps,
        levels: &[f64],
        at: impl Iterator<Item = f64>,
    ) -> Vec<[f64; LANES]> {
        let [up, down] = [1.0, -1.0].map(|step| self.towards(step));
        let (mut bends, mut per_way) = ([0.0; LANES], [0.0; LANES]);
        per_way
            .iter_mut()
            .zip(at)
            .for_each(|(per_way, at)| *per_way = 1.0 / at);
        path.followed(levels, |step, level| {
            if step != 0.0 {
                let (low, high) = (-level * down, level * up);
                for (bend, per_way) in bends.iter_mut().zip(&per_way) {
                    *bend = within(*bend + step * per_way, [low, high]);
                }
            }
            bends
        })
    }
}

/// A value within limits, without a branch.
#[inline]
fn within(value: f64, [low, high]: [f64; 2]) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BRISTLE: LoadFriction = LoadFriction {
        deflection: 10.0,
        rise: 0.0,
        velocity: 1.0,
        lag_s: 0.0,
        lag_growth: 0.0,
        exponent: GAUSS,
        forward: ALIKE,
        law: Law::Dahl,
    };

    fn along(friction: LoadFriction, path: &Steps) -> Vec<f64> {
        friction.bend(path, &friction.fall(path))
    }

    #[test]
    fn elements_have_the_stiffness_of_all_and_shares_of_one() {
        let slipping = BRISTLE
            .slipping(&[2.0, 4.0, 8.0], &[3.0, 0.0, 1.0])
            .unwrap();
        // 0.75/2 + 0.25/8.
        assert!((1.0 / slipping.deflection - 0.40625).abs() < 1.0e-12);
        let twice = slipping
            .scaled([2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
            .elements();
        for (element, wanted) in twice.iter().zip([(4.0, 0.75), (16.0, 0.25)]) {
            assert!((element.0 - wanted.0).abs() < 1.0e-5, "{element:?}");
            assert!((element.1 - wanted.1).abs() < 1.0e-6, "{element:?}");
        }
        assert!((slipping.settles_after() - 16.0).abs() < 1.0e-5);
        assert_eq!(BRISTLE.slipping(&[2.0], &[0.0]), None);
        // The smallest of too many go.
        let parts: Vec<f64> = (1..=ELEMENTS + 1).map(|part| part as f64).collect();
        let many = BRISTLE.slipping(&parts, &parts).unwrap().elements();
        assert_eq!((many.len(), many[0].0.round()), (ELEMENTS, 2.0));
    }

    #[test]
    fn a_level_that_lags_has_fallen_by_63_percent_after_its_lag() {
        let lagging = LoadFriction {
            rise: 0.5,
            lag_s: 20.0,
            ..BRISTLE
        };
        // Much faster than the level falls: the bristle is bent to it all the time.
        let path: Vec<f64> = (0..=40).map(|row| 1.0e3 * f64::from(row)).collect();
        let bend = along(lagging, &Steps::of(&path, &vec![1.0e3; path.len()], 1.0));
        for row in [20, 40] {
            // Amid the last of four parts.
            let wanted = 1.0 + 0.5 * (-(row as f64 - 0.125) / 20.0).exp();
            assert!((bend[row] - wanted).abs() < 1.0e-9, "{}", bend[row]);
        }
    }

    #[test]
    fn elements_slip_one_after_the_other_and_back_over_twice_the_way() {
        let slipping = BRISTLE.slipping(&[2.0, 8.0], &[1.0, 1.0]).unwrap();
        let there: Vec<f64> = (0..=10).map(f64::from).collect();
        let back = there.iter().rev().skip(1).copied();
        let path: Vec<f64> = there.iter().copied().chain(back).collect();
        let bend = along(slipping, &Steps::of(&path, &vec![0.0; path.len()], 1.0));
        let near = |row: usize, wanted: f64| {
            assert!((bend[row] - wanted).abs() < 1.0e-6, "{row}: {}", bend[row]);
        };
        near(1, 0.25 + 0.0625);
        near(2, 0.5 + 0.125);
        near(10, 1.0);
        near(14, -0.5 + 0.25);
        near(20, -0.5 - 0.125);
    }
}
