//! A gap before the bristle, in the effort about reversals.
//!
//! From the motor alone a bristle behind a gap passes for a softer bristle: both give a friction
//! that turns over late. What they do on the way differs. After a reversal a bristle's friction
//! rises with the distance, steepest at the start, by Masing's rule, and the whole mass goes with
//! the motor. Across a gap the motor feels neither friction nor mass of the load:
//!
//! ```text
//! F − M a − … = L z + M₂ (a₂ − a)
//! ```
//!
//! L is the level of friction, z the bend of a bristle on the load and a₂ the load's acceleration,
//! both along its path behind the gap
//! ([`on_bristle`](crate::simulate::load::on_bristle)). Momentum is kept, so impacts need no force
//! of their own. The rival is a bristle without a gap that winds a spring up, `L z + w z̈`. Both
//! are linear in what is fitted but for width, deflection and share.
//!
//! No friction law of the distance makes a mass go missing. So M₂ must come out as a part of the
//! mass. A gap that is not wider than the deflection is none: it is within the bend.

use super::bristle::state;
use super::{Observed, deflections};
use crate::evidence::thresholds::{DIFFERENCE_T, FEWEST_COUNTS, RIVAL_RATIO, SUSPICION_RATIO};
use crate::fit::blocks::{Blocks, Gain};
use crate::fit::search::descend;
use crate::fit::side_by_side::side_by_side;
use crate::model::effects::geometric;
use crate::motion::derivatives::Derivatives;
use crate::motion::kinematics::Kinematics;
use crate::record::units::EffortHold;
use crate::simulate::load::Behind;
use crate::simulate::load::on_bristle::{Followed, OnBristle};

/// Widest gap that is tried, in moving-velocity units times a second: 0.3 mm on a linear axis.
const WIDEST: f64 = 0.3;
/// Widths that are tried.
const WIDTHS: u32 = 16;
/// Deflections behind a gap that are tried: every third of those of a bristle alone.
const EVERY: usize = 3;
/// Shares of the mass behind the gap that are tried: they say how soon a load comes to rest.
const SHARES: [f64; 2] = [0.3, 0.7];
/// Bounds of that share.
const SHARE: (f64, f64) = (0.02, 0.98);
/// First steps of the descents, as shares of width and deflection, and of the mass.
const STEPS: [f64; 3] = [0.2, 0.3, 0.1];
/// Rounds of descents.
const ROUNDS: usize = 2;
/// Where the load's mass stands among the columns.
const LOAD_MASS: usize = 1;

/// A gap with what speaks for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SeenGap {
    /// Its width.
    pub width: f64,
    /// Deflection of the bristle behind it.
    pub deflection: f64,
    /// Rms of the effort about reversals that a bristle without a gap leaves.
    pub bristle: f64,
    /// Rms that the gap leaves.
    pub left: f64,
    /// What the gap removes beyond that bristle, on held-out blocks.
    pub share: f64,
    /// Mean over standard error of that per block.
    pub t: f64,
    /// Whether it can be a gap: a part of the mass is behind it, and it is wider than the bend.
    pub can_be: bool,
    /// Whether the same gap leaves less of another record too.
    pub repeats: bool,
}

impl SeenGap {
    /// Whether it leaves as little beside a bristle as a shape that wins against its rival.
    pub(crate) fn is_clear(&self) -> bool {
        self.removes(RIVAL_RATIO)
    }

    /// Whether a bristle alone is in doubt.
    pub(crate) fn is_suspicious(&self) -> bool {
        self.removes(SUSPICION_RATIO) && !self.is_clear()
    }

    /// What a bristle alone in doubt looks like, and what to record; `length` is the unit of a
    /// millionth.
    pub(crate) fn words(&self, length: &str) -> String {
        format!(
            "friction and mass that come back late after a reversal: a gap of about {:.0} {length} \
             may be there beside the presliding: record the load's position too",
            1.0e6 * self.width
        )
    }

    /// Whether it leaves at most a ratio of the rms that a bristle leaves.
    fn removes(&self, ratio: f64) -> bool {
        let removes = self.share >= 1.0 - ratio * ratio && self.t >= DIFFERENCE_T;
        removes && self.can_be && self.repeats
    }
}

/// The masses and the friction of a fitted model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plant {
    /// Moved mass.
    pub mass: f64,
    /// Coulomb friction.
    pub coulomb: f64,
}

/// What is searched of a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Trial {
    width: f64,
    deflection: f64,
    /// Share of the mass behind it.
    share: f64,
}

/// The best gap before a bristle about the reversals of a record; another one is asked whether it
/// shows the same.
pub(crate) fn best(
    [observed, other]: [&Observed<'_>; 2],
    plant: Plant,
    unit: f64,
    count: f64,
) -> Option<SeenGap> {
    let [here, there] = [observed, other].map(|observed| Balance { observed, plant });
    let all = deflections(unit);
    let alone = least(&all, |deflection| here.without(*deflection))?;
    let trial = here.best(unit, count, &all)?;
    let (base, full) = (here.without(alone), here.with(trial));
    let gain = Gain::of(&base.cross_validate(), &full.cross_validate());
    let rows = observed.motion.slow.iter().filter(|slow| **slow).count();
    let rms = |blocks: &Blocks| (blocks.fit().sse / rows.max(1) as f64).sqrt();
    let sse = |blocks: Blocks| blocks.fit().sse;
    let repeats = sse(there.with(trial)) < SUSPICION_RATIO.powi(2) * sse(there.without(alone));
    Some(SeenGap {
        width: trial.width,
        deflection: trial.deflection,
        bristle: rms(&base),
        left: rms(&full),
        share: gain.share,
        t: gain.t,
        can_be: plant.has_part(&full) && trial.width > trial.deflection,
        repeats,
    })
}

impl Plant {
    /// Whether the mass behind the gap is a part of the mass, with its whole interval above zero.
    fn has_part(&self, with_gap: &Blocks) -> bool {
        let (fit, half_widths) = (with_gap.fit(), with_gap.half_widths());
        let load = fit.coefficients[LOAD_MASS];
        fit.coefficients[0] > 0.0 && load > half_widths[LOAD_MASS] && load < self.mass
    }
}

/// The value whose columns leave least.
fn least<T: Copy + Sync>(values: &[T], blocks: impl Fn(&T) -> Blocks + Sync) -> Option<T> {
    let left = side_by_side(values, |value| blocks(value).fit().sse);
    let pairs = values.iter().zip(left);
    pairs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|pair| *pair.0)
}

/// The motor's balance of forces about the reversals of a record.
struct Balance<'a> {
    observed: &'a Observed<'a>,
    plant: Plant,
}

impl Balance<'_> {
    fn motion(&self) -> &Kinematics {
        self.observed.motion
    }

    fn blocks(&self, columns: &[Vec<f64>; 2]) -> Blocks {
        let motion = self.motion();
        let columns = columns.each_ref().map(Vec::as_slice);
        Blocks::new(
            &columns,
            &self.observed.friction,
            &motion.slow,
            motion.period_s,
        )
    }

    /// Friction of a bristle with such bends.
    fn friction(&self, bend: &[f64]) -> Vec<f64> {
        let pairs = self.observed.level.iter().zip(bend);
        let force: Vec<f64> = pairs.map(|(level, bend)| level * bend).collect();
        self.motion().low_passed(&force)
    }

    /// Load − motor acceleration of a load that lags.
    fn apart(&self, lag: &[f64]) -> Vec<f64> {
        let behind: Vec<f64> = lag.iter().map(|lag| -lag).collect();
        let period_s = self.motion().period_s;
        let derivatives = Derivatives::new(&behind, period_s, EffortHold::Instant);
        self.motion().low_passed(&derivatives.acceleration)
    }

    /// A bristle without a gap, that winds a spring up.
    fn without(&self, deflection: f64) -> Blocks {
        let bend = state(&self.motion().friction_position, deflection);
        self.blocks(&[self.friction(&bend), self.apart(&bend)])
    }

    fn with(&self, trial: Trial) -> Blocks {
        let Followed { lag, bend } = self.followed(trial);
        self.blocks(&[self.friction(&bend), self.apart(&lag)])
    }

    /// The load's path in every piece. The position is the low-passed one: a motor that trembles
    /// by a count does not let its load go.
    fn followed(&self, trial: Trial) -> Followed {
        let load = OnBristle {
            behind: Behind {
                gap: trial.width,
                coulomb: self.plant.coulomb / (trial.share * self.plant.mass),
                ..Behind::default()
            },
            deflection: trial.deflection,
        };
        let motion = self.motion();
        let mut followed = Followed::default();
        for piece in &motion.pieces {
            let part = load.follow(&motion.position_lp[piece.clone()], motion.period_s);
            followed.lag.extend(part.lag);
            followed.bend.extend(part.bend);
        }
        followed
    }

    fn best(&self, unit: f64, count: f64, deflections: &[f64]) -> Option<Trial> {
        let narrowest = FEWEST_COUNTS * count;
        let trials = trials(narrowest, unit, deflections);
        let mut best = least(&trials, |trial| self.with(*trial))?;
        for _ in 0..ROUNDS {
            best = self.improved(best, narrowest);
        }
        Some(best)
    }

    /// One parameter after the other.
    fn improved(&self, mut best: Trial, narrowest: f64) -> Trial {
        let left = |trial: Trial| self.with(trial).fit().sse;
        let [of_width, of_deflection, of_share] = STEPS;
        let beyond = (narrowest, f64::MAX);
        best.width = descend(best.width, of_width * best.width, beyond, &|width| {
            left(Trial { width, ..best })
        });
        let step = of_deflection * best.deflection;
        best.deflection = descend(best.deflection, step, beyond, &|deflection| {
            left(Trial { deflection, ..best })
        });
        best.share = descend(best.share, of_share, SHARE, &|share| {
            left(Trial { share, ..best })
        });
        best
    }
}

/// Gaps to start from.
fn trials(narrowest: f64, unit: f64, deflections: &[f64]) -> Vec<Trial> {
    let widths = geometric(narrowest, (WIDEST * unit).max(2.0 * narrowest), WIDTHS);
    let deflections = deflections.iter().step_by(EVERY);
    let with = |width: f64| {
        let pairs = deflections.clone().flat_map(|d| SHARES.map(|s| (*d, s)));
        pairs.map(move |(deflection, share)| Trial {
            width,
            deflection,
            share,
        })
    };
    widths.into_iter().flat_map(with).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::bench::Bench;
    use crate::fit::fitted::Fitted;
    use crate::fit::made::{Axis, model, on};
    use crate::simulate::made;
    use axis_model::EffectName::{Coulomb, Inertia};

    /// 60 of 90 kg on the motor, 300 N of friction on the rest.
    const MASSES: [f64; 2] = [60.0, 30.0];
    const FRICTION: f64 = 300.0;

    /// An axis whose motor feels a force at each row beside that of its own and the load's mass.
    fn axis(force: impl Fn(usize) -> f64) -> Axis {
        let mut axis = on(made::record(1.0e-3, made::two_sines(6000)));
        axis.dataset.resolution = 1.0e-8;
        axis.put(|motion, row| (MASSES[0] + MASSES[1]) * motion.acceleration[row] + force(row));
        axis
    }

    /// A load that stands while the motor crosses a gap, and whose friction comes in over a way
    /// from where it is pushed on: no mass, no friction before.
    fn behind_a_gap(gap: f64, way: f64) -> Axis {
        let motor = made::two_sines(6000);
        let (mut load, mut pushed) = (vec![motor[0]], vec![0.0_f64]);
        for x in &motor[1..] {
            let (at, since) = (load[load.len() - 1], pushed[pushed.len() - 1]);
            let next = at.max(x - 0.5 * gap).min(x + 0.5 * gap);
            let goes_on = (next - at) * since >= 0.0;
            pushed.push(if goes_on {
                since + next - at
            } else {
                next - at
            });
            load.push(next);
        }
        let second = |x: &[f64], row: usize| (x[row + 1] - 2.0 * x[row] + x[row - 1]) / 1.0e-6;
        axis(|row| {
            if row == 0 || row + 1 == motor.len() {
                return 0.0;
            }
            let apart = second(&load, row) - second(&motor, row);
            let friction = if load[row] == load[row - 1] {
                0.0
            } else {
                FRICTION * pushed[row].signum() * (1.0 - (-pushed[row].abs() / way).exp())
            };
            MASSES[1] * apart + friction
        })
    }

    fn seen(axis: &Axis) -> SeenGap {
        let bench = axis.bench();
        let fitted = Fitted::new(model(&[Inertia, Coulomb]), &[90.0, FRICTION]);
        let observed = Observed::new(&bench, &fitted).unwrap();
        let plant = Plant {
            mass: 90.0,
            coulomb: FRICTION,
        };
        best([&observed, &observed], plant, 1.0e-3, 1.0e-8).unwrap()
    }

    #[test]
    fn a_gap_before_a_bristle_is_clear_and_as_wide_as_it_is() {
        let way = 5.0e-6;
        for gap in [20.0e-6, 60.0e-6] {
            let seen = seen(&behind_a_gap(gap, way));
            assert!(seen.is_clear(), "{seen:?}");
            // The bristle here does not spring back: its way is told from the gap by less.
            assert!((seen.width - gap).abs() < way, "{seen:?}");
            assert!(seen.left < 0.75 * seen.bristle, "{seen:?}");
        }
    }

    #[test]
    fn a_bristle_alone_has_no_gap_whatever_its_law() {
        let motor = made::two_sines(6000);
        let elements = [5.0e-6, 40.0e-6, 100.0e-6].map(|way| state(&motor, way));
        for of in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.4, 0.3, 0.3]] {
            let bend = |row: usize| (0..3).map(|i| of[i] * elements[i][row]).sum::<f64>();
            let seen = seen(&axis(|row| FRICTION * bend(row)));
            assert!(
                !seen.is_clear() && !seen.is_suspicious(),
                "{of:?}: {seen:?}"
            );
        }
    }

    #[test]
    fn a_gap_is_clear_in_doubt_or_none_by_what_it_leaves_of_a_bristle() {
        let clear = SeenGap {
            width: 50.0e-6,
            deflection: 5.0e-6,
            bristle: 4.0,
            left: 2.0,
            share: 0.4376,
            t: 2.0,
            can_be: true,
            repeats: true,
        };
        let doubt = SeenGap {
            share: 0.4374,
            ..clear
        };
        let least = SeenGap {
            share: 0.2774,
            ..clear
        };
        let of = |gap: &SeenGap| [gap.is_clear(), gap.is_suspicious()];
        assert_eq!(of(&clear), [true, false]);
        assert_eq!(of(&doubt), [false, true]);
        assert_eq!(of(&least), [false, false]);
        for none in [
            SeenGap { t: 1.9, ..clear },
            SeenGap {
                can_be: false,
                ..clear
            },
            SeenGap {
                repeats: false,
                ..clear
            },
        ] {
            assert_eq!(of(&none), [false, false], "{none:?}");
        }
        let words = doubt.words("µm");
        assert!(
            words.contains("about 50 µm") && words.contains("record the load"),
            "{words}"
        );
    }

    #[test]
    fn what_is_behind_a_gap_is_a_part_of_the_mass() {
        let axis = behind_a_gap(100.0e-6, 5.0e-6);
        let bench: Bench<'_> = axis.bench();
        let fitted = Fitted::new(model(&[Inertia, Coulomb]), &[90.0, FRICTION]);
        let observed = Observed::new(&bench, &fitted).unwrap();
        let with = |mass: f64| {
            let plant = Plant {
                mass,
                coulomb: FRICTION,
            };
            let balance = Balance {
                observed: &observed,
                plant,
            };
            let trial = Trial {
                width: 100.0e-6,
                deflection: 5.0e-6,
                share: 30.0 / mass,
            };
            plant.has_part(&balance.with(trial))
        };
        assert!(with(90.0) && !with(20.0));
    }
}
