//! Stick, bristle or gap: which of them lets the simulated axis run like the recorded one.
//!
//! On a circle all three give the same burst. In a free run they do not: the whole history between
//! reversals counts (how far a bristle springs back at rest, where the load was left in its gap),
//! not the peak. Each shape is fitted to every second block of the training record and judged on
//! the others; a shape is accepted where it leaves clearly less than rigid friction *and* than its
//! rival.

pub(crate) mod decision;

use crate::evidence::free_run::decision::{Accepted, Left, Scene, Tried};
use crate::evidence::thresholds::FEWEST_COUNTS;
use crate::fit::fitted::Fitted;
use crate::fit::side_by_side::side_by_side;
use crate::model::effects::geometric;
use crate::progress::Step;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::simulate::axis::{Gap, Shape};
use crate::simulate::drive::Drive;
use crate::simulate::fit::{fit, half_widths};
use crate::simulate::friction::Bristle;
use crate::simulate::model::Simulated;
use crate::simulate::model::estimates::Estimates;
use crate::simulate::run::{position_rms, simulate};

/// Length of the blocks that are fitted and judged in turn, s.
const BLOCK_S: f64 = 2.0;
/// A short record is cut into so many.
const FEWEST_BLOCKS: usize = 6;
/// What rounding to whole counts leaves: one count over √12.
const ROUNDING: f64 = 0.288_675;
/// Bristle deflections that are tried, in moving-velocity units times a second.
const DEFLECTIONS: (f64, f64, u32) = (1.0e-3, 6.0e-2, 7);
/// Micro-damping of a bristle to start from, over the moved mass.
const DAMPING_PER_S: f64 = 30.0;
/// Gaps that are tried, in the same units.
const GAPS: (f64, f64, u32) = (2.0e-3, 0.12, 14);
/// Coefficients of restitution that are tried.
const RESTITUTIONS: [f64; 2] = [0.1, 0.7];
/// Shares of the friction on the motor side that are tried.
const MOTOR_SHARES: [f64; 2] = [0.2, 0.7];
/// So many of the best gaps are fitted.
const STARTS: usize = 3;

/// What a shape leaves.
#[derive(Clone)]
pub(crate) struct Judged {
    /// The fitted simulation.
    pub model: Simulated,
    /// Rms of the motor position on blocks that were not fitted.
    pub held_out: f64,
    /// Rms on the whole training record.
    pub all: f64,
    /// Mean square on each block that was not fitted.
    blocks: Vec<f64>,
}

/// What the free run says about reversals.
#[derive(Clone)]
pub(crate) struct Reversals {
    /// Who drove the simulation.
    pub drive: Drive,
    /// Rigid friction.
    pub rigid: Judged,
    /// A bristle.
    pub bristle: Judged,
    /// A gap, where one was looked for.
    pub gap: Option<Judged>,
    /// A bristle and a gap, where one of them was accepted.
    pub both: Option<Judged>,
    /// What was accepted.
    pub accepted: Accepted,
}

/// What a free run says in short.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Summary {
    /// Whether the controller of the record drove the simulation; else it followed the record.
    pub controller_known: bool,
    /// What it accepts.
    pub accepted: Accepted,
    /// Whether a gap leaves less than a bristle on blocks that were not fitted.
    pub gap_leaves_less: bool,
}

struct Judge<'a> {
    drive: Drive,
    record: &'a Record,
    block_rows: usize,
}

impl<'a> Judge<'a> {
    /// The judge of a training record, driven by its controller where that is known.
    fn of(dataset: &'a Dataset) -> Self {
        let record = &dataset.train;
        let block_rows = ((BLOCK_S / record.period_s) as usize)
            .min(record.len() / FEWEST_BLOCKS)
            .max(1);
        Self {
            drive: Drive::of(dataset),
            record,
            block_rows,
        }
    }

    fn is_fitted(&self, row: usize) -> bool {
        (row / self.block_rows).is_multiple_of(2)
    }

    fn fitted(&self, start: &Simulated) -> Judged {
        let model = fit(start, &self.drive, self.record, &|row| self.is_fitted(row));
        let run = simulate(&model, &self.drive, self.record);
        let held_out = position_rms(&run, self.record, &|row| !self.is_fitted(row));
        let all = position_rms(&run, self.record, &|_| true);
        let judged = (1..self.record.len() / self.block_rows).step_by(2);
        let on_block = |block: usize| {
            position_rms(&run, self.record, &|row| row / self.block_rows == block).powi(2)
        };
        Judged {
            model,
            held_out,
            all,
            blocks: judged.map(on_block).collect(),
        }
    }

    /// The best fit from the best of several starts.
    fn best(&self, starts: &[Simulated], count: usize) -> Option<Judged> {
        let error = |model: &Simulated| {
            position_rms(
                &simulate(model, &self.drive, self.record),
                self.record,
                &|row| self.is_fitted(row),
            )
        };
        let errors = side_by_side(starts, error);
        let mut ranked: Vec<(f64, &Simulated)> = errors.into_iter().zip(starts).collect();
        // What could not be simulated is no number, of either sign: it comes last.
        ranked.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let best = ranked.into_iter().take(count);
        let fitted = best.map(|(_, start)| self.fitted(start));
        fitted.min_by(|a, b| a.all.total_cmp(&b.all))
    }
}

/// Judges the reversals of a training record with an inverse model to start from; `None` where that
/// has no mass or friction.
#[must_use]
pub(crate) fn reversals(
    dataset: &Dataset,
    fitted: &Fitted,
    progress: &mut dyn FnMut(&Step),
) -> Option<Reversals> {
    let judge = Judge::of(dataset);
    let unit = dataset.kind.moving_velocity();
    let start = |shape: Shape| Simulated::new(dataset, judge.record.period_s, fitted, shape);
    progress(&Step::Rigid);
    let rigid = judge.fitted(&start(Shape::default())?);
    progress(&Step::Bristle);
    let bristle = judge.best(&bristles(unit, rigid.model.mechanics.mass, start), 1)?;
    let mut scene = Scene {
        rigid: rigid.left(),
        bristle: Tried {
            left: bristle.left(),
            size: bristle.deflection(),
        },
        gap: None,
        smallest: FEWEST_COUNTS * dataset.resolution,
    };
    progress(&Step::Gap);
    let gap = scene
        .is_worth_a_gap(ROUNDING * dataset.resolution)
        .then(|| judge.best(&gaps(unit, start), STARTS))
        .flatten();
    scene.gap = gap.as_ref().map(|gap| Tried {
        left: gap.left(),
        size: gap.width(),
    });
    let mut accepted = scene.decide();
    progress(&Step::BristleAndGap);
    let both = judge.both(accepted, &bristle, gap.as_ref(), unit, &start);
    if let Some(both) = &both {
        let size = both.width().min(both.deflection());
        let left = both.left();
        accepted = scene.with_both(accepted, Tried { left, size });
    }
    Some(Reversals {
        drive: judge.drive,
        rigid,
        bristle,
        gap,
        both,
        accepted,
    })
}

/// Bristles to start from, over a range of deflections.
fn bristles(unit: f64, mass: f64, start: impl Fn(Shape) -> Option<Simulated>) -> Vec<Simulated> {
    let damping = DAMPING_PER_S * mass;
    let deflections = geometric(DEFLECTIONS.0 * unit, DEFLECTIONS.1 * unit, DEFLECTIONS.2);
    let shapes = deflections.into_iter().map(|deflection| Shape {
        bristle: Some(Bristle {
            deflection,
            damping,
        }),
        gap: None,
    });
    shapes.filter_map(start).collect()
}

/// Gaps to start from, over a range of widths and of kinds of impact.
fn gaps(unit: f64, start: impl Fn(Shape) -> Option<Simulated>) -> Vec<Simulated> {
    let widths = geometric(GAPS.0 * unit, GAPS.1 * unit, GAPS.2);
    let kinds = RESTITUTIONS
        .into_iter()
        .flat_map(|restitution| MOTOR_SHARES.map(|share| (restitution, share)));
    let kinds: Vec<(f64, f64)> = kinds.collect();
    let shapes = widths.into_iter().flat_map(|width| {
        kinds.iter().map(move |&(restitution, motor_friction)| Gap {
            width,
            load_share: 0.45,
            motor_friction,
            restitution,
        })
    });
    let shapes = shapes.map(|gap| Shape {
        bristle: None,
        gap: Some(gap),
    });
    shapes.filter_map(start).collect()
}

impl Judge<'_> {
    /// A bristle behind a gap, from what was accepted of them.
    fn both(
        &self,
        accepted: Accepted,
        bristle: &Judged,
        gap: Option<&Judged>,
        unit: f64,
        start: &impl Fn(Shape) -> Option<Simulated>,
    ) -> Option<Judged> {
        let gap = gap.filter(|_| accepted.presliding || accepted.backlash || accepted.undecided)?;
        let bristle = bristle.model.mechanics.shape.bristle?;
        let of = |width: f64, share: f64| {
            let gap = Gap {
                width,
                load_share: 0.45,
                motor_friction: 0.2,
                restitution: 0.5,
            };
            start(Shape {
                bristle: Some(Bristle {
                    deflection: share * bristle.deflection,
                    ..bristle
                }),
                gap: Some(gap),
            })
        };
        let widths = geometric(GAPS.0 * unit, GAPS.1 * unit, 8)
            .into_iter()
            .chain([gap.width()]);
        let starts = widths.flat_map(|width| [0.4, 1.0].map(|share| (width, share)));
        let starts = starts.filter_map(|(width, share)| of(width, share));
        self.best(&starts.collect::<Vec<_>>(), 1)
    }
}

impl Judged {
    /// Deflection of its bristle; zero where it has none.
    fn deflection(&self) -> f64 {
        let bristle = self.model.mechanics.shape.bristle;
        bristle.map_or(0.0, |bristle| bristle.deflection)
    }

    /// Width of its gap; zero where it has none.
    fn width(&self) -> f64 {
        self.model.mechanics.shape.gap.map_or(0.0, |gap| gap.width)
    }

    /// What the decision needs of it.
    fn left(&self) -> Left {
        Left {
            held_out: self.held_out,
            all: self.all,
        }
    }
}

impl Reversals {
    /// What it says in short.
    #[must_use]
    pub(crate) fn summary(&self) -> Summary {
        let less = |gap: &Judged| gap.held_out < self.bristle.held_out;
        Summary {
            controller_known: matches!(self.drive, Drive::Known(_)),
            accepted: self.accepted,
            gap_leaves_less: self.gap.as_ref().is_some_and(less),
        }
    }

    /// Deflection of the bristle that was accepted.
    #[must_use]
    pub(crate) fn deflection(&self) -> Option<f64> {
        self.accepted.presliding.then(|| self.best().deflection())
    }

    /// Takes over what was decided with the inverse model's word beside the free run's.
    pub(crate) fn settle(&mut self, presliding: bool, backlash: bool) {
        let undecided = self.accepted.undecided && !presliding && !backlash;
        self.accepted = Accepted {
            presliding,
            backlash,
            undecided,
        };
    }

    /// Mean over standard error of the gain per block that a shape brings over rigid friction.
    #[must_use]
    pub(crate) fn t(&self, judged: &Judged) -> f64 {
        let gains: Vec<f64> = self
            .rigid
            .blocks
            .iter()
            .zip(&judged.blocks)
            .map(|(before, after)| before - after)
            .collect();
        crate::fit::blocks::t_of(&gains)
    }

    /// Parameters of the simulation that was accepted, fitted to the positions, with intervals.
    #[must_use]
    pub(crate) fn estimates(&self, dataset: &Dataset) -> Estimates {
        let model = &self.best().model;
        model.estimates(dataset, &half_widths(model, &self.drive, &dataset.train))
    }

    /// The simulation that was accepted.
    #[must_use]
    pub(crate) fn best(&self) -> &Judged {
        match (self.accepted.presliding, self.accepted.backlash) {
            (true, true) => self.both.as_ref().unwrap_or(&self.bristle),
            (true, false) => &self.bristle,
            (false, true) => self.gap.as_ref().unwrap_or(&self.rigid),
            (false, false) => &self.rigid,
        }
    }
}
