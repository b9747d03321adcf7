//! Stick, bristle or gap: which of them lets the simulated axis run like the recorded one.
//!
//! On a circle all three give the same burst. In a free run they do not: the whole history between
//! reversals counts (how far a bristle springs back at rest, where the load was left in its gap),
//! not the peak. Each shape is fitted to every second block of the training record and judged on
//! the others; a shape is accepted where it leaves clearly less than rigid friction *and* than its
//! rival.
//!
//! A shape must win by its shape, not by more starts. So before one is accepted the others start
//! once more, from the masses and forces that its fit ended at: rigid friction from the gap's with
//! the gap at zero, and so on. A simulation that runs away (an error beyond the travel, or no
//! number) is no evidence for anything: its rms is nothing to compare with.

pub(crate) mod decision;
mod excerpt;

use axis_model::{Effect, Estimate};

use crate::evidence::free_run::decision::{Accepted, Left, Scene, Tried};
use crate::evidence::free_run::excerpt::Excerpt;
use crate::evidence::thresholds::{FEWEST_COUNTS, RIVAL_RATIO, SHAPE_RATIO, VISIBLE_ROUNDINGS};
use crate::fit::fitted::Fitted;
use crate::fit::side_by_side::side_by_side;
use crate::model::effects::geometric;
use crate::progress::Step;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::simulate::axis::{Gap, Shape};
use crate::simulate::controller::known::Controller;
use crate::simulate::drive::Drive;
use crate::simulate::fit::{fit, half_widths};
use crate::simulate::friction::Bristle;
use crate::simulate::model::Simulated;
use crate::simulate::run::{Run, error_along, position_rms, simulate, strays};

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
/// Share of the moved mass beyond a gap to start from: motors are matched to their loads.
const LOAD_SHARE: f64 = 0.45;
/// So many of the best gaps are fitted.
const STARTS: usize = 3;
/// The fit to all rows takes no more than this share off a shape beyond what it takes off its
/// rivals: a shape that would have to lose more to count is judged as it is.
const TAKEN_OFF: f64 = 0.5;
/// What a shape without a rival has to come down to.
const ANYTHING: f64 = f64::INFINITY;
/// Another start is fitted to the whole record where it leaves this share on the excerpt.
const WORTH_A_FIT: f64 = 0.97;

/// What a shape leaves.
#[derive(Clone)]
pub(crate) struct Judged {
    /// The fitted simulation.
    pub model: Simulated,
    /// Rms of the motor position on blocks that were not fitted.
    pub held_out: f64,
    /// Rms on the whole training record.
    pub all: f64,
    /// Whether the simulation left the travel of the axis: both rms say nothing then.
    pub ran_away: bool,
    /// What the start of its fit left on the excerpt: near, but for what only the fit moves.
    near: f64,
    /// Mean square on each block that was not fitted.
    blocks: Vec<f64>,
}

/// What the free run says about reversals.
#[derive(Clone)]
pub(crate) struct Reversals {
    /// What is known of the controller.
    pub controller: Controller,
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
    /// What the free run alone accepted, before other witnesses were heard.
    pub alone: Accepted,
    /// Whether rigid friction leaves more than the rounding of the encoder.
    pub something_left: bool,
}

/// What a free run says in short.
#[expect(
    clippy::struct_excessive_bools,
    reason = "independent answers of one witness"
)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Summary {
    /// Whether the controller of the record drove the simulation; else it followed the record.
    pub controller_known: bool,
    /// What it accepts.
    pub accepted: Accepted,
    /// Whether a gap leaves less than a bristle on blocks that were not fitted.
    pub gap_leaves_less: bool,
    /// Whether a bristle leaves clearly less than rigid friction there.
    pub bristle_helps: bool,
    /// Whether rigid friction leaves more than the rounding of the encoder.
    pub something_left: bool,
}

/// Where a fit begins.
struct Start {
    model: Simulated,
    /// What it leaves on the excerpt.
    near: f64,
}

struct Judge<'a> {
    drive: Drive,
    record: &'a Record,
    block_rows: usize,
    /// From end to end of the travel.
    travel: f64,
    /// Some of the blocks that are fitted, on which a fit comes near before it sees all of them.
    excerpt: Excerpt,
}

impl<'a> Judge<'a> {
    /// The judge of a training record, driven by its controller where that is known.
    fn of(dataset: &'a Dataset, controller: Controller) -> Self {
        let record = &dataset.train;
        let block_rows = ((BLOCK_S / record.period_s) as usize)
            .min(record.len() / FEWEST_BLOCKS)
            .max(1);
        Self {
            drive: Drive::of(controller),
            record,
            block_rows,
            travel: 2.0 * dataset.travel().1,
            excerpt: Excerpt::of(record, block_rows),
        }
    }

    fn is_fitted(&self, row: usize) -> bool {
        (row / self.block_rows).is_multiple_of(2)
    }

    /// The fit from one start, or from what comes near on the excerpt where that is nearer.
    fn fitted(&self, start: &Simulated) -> Judged {
        let error = |model: &Simulated| {
            error_along(model, &self.drive, self.record, &|row| self.is_fitted(row))
        };
        let near = self.excerpt.near(start, &self.drive);
        let is_nearer = error(&near) <= error(start);
        self.fitted_from(&self.start(if is_nearer { near } else { start.clone() }))
    }

    /// A start with what it leaves on the excerpt.
    fn start(&self, model: Simulated) -> Start {
        let near = self.excerpt.error(&model, &self.drive);
        Start { model, near }
    }

    /// The fit to all of the record.
    fn fitted_from(&self, start: &Start) -> Judged {
        let is_fitted = |row| self.is_fitted(row);
        let model = fit(&start.model, &self.drive, self.record, &is_fitted);
        self.judged(model, start.near)
    }

    /// What a model leaves, whose start left so much on the excerpt.
    fn judged(&self, model: Simulated, near: f64) -> Judged {
        let run = simulate(&model, &self.drive, self.record);
        self.judged_by(model, near, &run)
    }

    /// The same from its run along the record.
    fn judged_by(&self, model: Simulated, near: f64, run: &Run) -> Judged {
        let held_out = position_rms(run, self.record, &|row| !self.is_fitted(row));
        let all = position_rms(run, self.record, &|_| true);
        let judged = (1..self.record.len() / self.block_rows).step_by(2);
        let on_block = |block: usize| {
            position_rms(run, self.record, &|row| row / self.block_rows == block).powi(2)
        };
        Judged {
            model,
            held_out,
            all,
            ran_away: strays(run, self.record, self.travel),
            near,
            blocks: judged.map(on_block).collect(),
        }
    }

    /// The best fit from the best of several starts, as the excerpt tells them; only judged where
    /// it cannot come down to what counts, by what its rivals left there before they were fitted.
    fn best(&self, starts: &[Simulated], count: usize, counts: f64) -> Option<Judged> {
        let error = |model: &Simulated| self.excerpt.error(model, &self.drive);
        let best = nearest(side_by_side(starts, error), starts, count);
        let near = best
            .into_iter()
            .map(|start| self.excerpt.near(start, &self.drive));
        let near: Vec<Start> = near.map(|model| self.start(model)).collect();
        let errors = near.iter().map(|start| start.near).collect();
        let start = *nearest(errors, &near, 1).first()?;
        Some(if (1.0 - TAKEN_OFF) * start.near > counts {
            self.judged(start.model.clone(), start.near)
        } else {
            self.fitted_from(start)
        })
    }

    /// A shape, started once more from the masses and forces of other fits, as far as the excerpt
    /// tells that this leaves less; the best is kept.
    fn restarted(&self, judged: Judged, others: &[&Judged]) -> Judged {
        let shape = judged.model.mechanics.shape;
        let worth = WORTH_A_FIT * self.excerpt.error(&judged.model, &self.drive);
        let near = others.iter().map(|other| {
            let mut start = other.model.clone();
            start.mechanics.shape = shape;
            self.start(self.excerpt.near(&start, &self.drive))
        });
        let nearer = near.filter(|start| start.near <= worth);
        let fitted = nearer.map(|start| self.fitted_from(&start));
        fitted.fold(judged, Judged::better)
    }
}

/// So many items with the least errors, the least first.
fn nearest<T>(errors: Vec<f64>, items: &[T], count: usize) -> Vec<&T> {
    let mut ranked: Vec<(f64, &T)> = errors.into_iter().zip(items).collect();
    // What could not be simulated is no number, of either sign: it comes last.
    ranked.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let least = ranked.into_iter().take(count);
    least.map(|(_, item)| item).collect()
}

/// Judges the reversals of a training record with an inverse model to start from; `None` where that
/// has no mass or friction.
#[must_use]
pub(crate) fn reversals(
    dataset: &Dataset,
    fitted: &Fitted,
    progress: &mut dyn FnMut(&Step),
) -> Option<Reversals> {
    let controller = Controller::of(dataset);
    let judge = Judge::of(dataset, controller);
    let unit = dataset.moving_velocity;
    let start = |shape: Shape| Simulated::new(dataset, judge.record.period_s, fitted, shape);
    let mut shapes = judge.shapes(dataset, &start, progress)?;
    let mut accepted = shapes.scene(dataset.resolution).decide();
    if accepted != Accepted::default() {
        shapes = shapes.restarted(&judge);
        accepted = shapes.scene(dataset.resolution).decide();
    }
    progress(&Step::BristleAndGap);
    let Shapes {
        rigid,
        bristle,
        gap,
    } = &shapes;
    let both = judge.both(accepted, bristle, gap.as_ref(), unit, &start);
    if let Some(both) = &both {
        let size = both.smaller_size();
        let scene = shapes.scene(dataset.resolution);
        accepted = scene.with_both(accepted, both.tried(rigid, size));
    }
    let something_left = rigid.all > VISIBLE_ROUNDINGS * rounding(dataset.resolution);
    let reversals = Reversals {
        controller,
        drive: judge.drive,
        rigid: shapes.rigid,
        bristle: shapes.bristle,
        gap: shapes.gap,
        both,
        accepted,
        alone: accepted,
        something_left,
    };
    Some(reversals.asked_on(&dataset.validate, &judge, &start(Shape::default())?))
}

/// What was tried at reversals beside each other.
struct Shapes {
    rigid: Judged,
    bristle: Judged,
    gap: Option<Judged>,
}

impl Judge<'_> {
    /// Each shape from its own starts; a gap only where it is worth a look.
    fn shapes(
        &self,
        dataset: &Dataset,
        start: &impl Fn(Shape) -> Option<Simulated>,
        progress: &mut dyn FnMut(&Step),
    ) -> Option<Shapes> {
        let unit = dataset.moving_velocity;
        progress(&Step::Rigid);
        let rigid = self.fitted(&start(Shape::default())?);
        progress(&Step::Bristle);
        let starts = bristles(unit, rigid.model.mechanics.mass, start);
        let bristle = self.best(&starts, 1, ANYTHING)?;
        let mut shapes = Shapes {
            rigid,
            bristle,
            gap: None,
        };
        progress(&Step::Gap);
        let scene = shapes.scene(dataset.resolution);
        if scene.is_worth_a_gap(rounding(dataset.resolution)) {
            // Beside a bristle that is seen it counts where it makes that doubtful.
            let counts = if scene.is_bristle() {
                shapes.bristle.near / RIVAL_RATIO
            } else {
                SHAPE_RATIO * shapes.rigid.near
            };
            shapes.gap = self.best(&gaps(unit, start), STARTS, counts);
        }
        Some(shapes)
    }
}

impl Shapes {
    /// Each beside the others, on an encoder of a resolution.
    fn scene(&self, resolution: f64) -> Scene {
        Scene {
            rigid: self.rigid.left(),
            bristle: self.bristle.tried(&self.rigid, self.bristle.deflection()),
            gap: self
                .gap
                .as_ref()
                .map(|gap| gap.tried(&self.rigid, gap.width())),
            smallest: FEWEST_COUNTS * resolution,
        }
    }

    /// Each shape started once more from what the others ended at.
    fn restarted(self, judge: &Judge<'_>) -> Self {
        let Self {
            rigid,
            bristle,
            gap,
        } = self;
        let from_gap: Vec<&Judged> = gap.iter().collect();
        let from_both: Vec<&Judged> = from_gap.iter().copied().chain([&bristle]).collect();
        let rigid = judge.restarted(rigid, &from_both);
        let again = judge.restarted(bristle.clone(), &from_gap);
        let gap = gap.map(|gap| judge.restarted(gap, &[&bristle]));
        Self {
            rigid,
            bristle: again,
            gap,
        }
    }
}

/// Rms of what rounding to counts of a resolution leaves.
fn rounding(resolution: f64) -> f64 {
    ROUNDING * resolution
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
            load_share: LOAD_SHARE,
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
        let alone = bristle.model.mechanics.shape.bristle?;
        let shapes = bristles_behind_gaps(alone, gap.width(), unit).into_iter();
        let starts: Vec<Simulated> = shapes.filter_map(start).collect();
        let counts = SHAPE_RATIO * bristle.near.min(gap.near);
        self.best(&starts, 1, counts)
    }
}

/// Bristles behind gaps to start from, about those that were found alone.
fn bristles_behind_gaps(bristle: Bristle, width: f64, unit: f64) -> Vec<Shape> {
    let widths = geometric(GAPS.0 * unit, GAPS.1 * unit, 8).into_iter();
    let pairs = widths
        .chain([width])
        .flat_map(|width| [0.4, 1.0].map(|share| (width, share)));
    let shape = |(width, share): (f64, f64)| Shape {
        bristle: Some(Bristle {
            deflection: share * bristle.deflection,
            ..bristle
        }),
        gap: Some(Gap {
            width,
            load_share: LOAD_SHARE,
            motor_friction: 0.2,
            restitution: 0.5,
        }),
    };
    pairs.map(shape).collect()
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

    /// The smaller one of the two.
    fn smaller_size(&self) -> f64 {
        self.width().min(self.deflection())
    }

    /// What the decision needs of a shape of some size, beside rigid friction.
    fn tried(&self, rigid: &Self, size: f64) -> Tried {
        Tried {
            left: self.left(),
            size,
            t: self.t(rigid),
        }
    }

    /// Mean over standard error of the gain per block over rigid friction.
    pub(crate) fn t(&self, rigid: &Self) -> f64 {
        let pairs = rigid.blocks.iter().zip(&self.blocks);
        let gains: Vec<f64> = pairs.map(|(before, after)| before - after).collect();
        crate::fit::blocks::t_of(&gains)
    }

    /// What it leaves on blocks that were not fitted; no number where it ran away.
    pub(crate) fn told(&self) -> f64 {
        self.left().held_out
    }

    /// What it leaves; no number where it ran away.
    fn left(&self) -> Left {
        let told = |rms: f64| if self.ran_away { f64::NAN } else { rms };
        Left {
            held_out: told(self.held_out),
            all: told(self.all),
        }
    }

    /// The one that leaves less of the whole record; one that ran away leaves most.
    fn better(self, other: Self) -> Self {
        let left = |judged: &Self| (judged.ran_away, judged.all.abs());
        let ((away, one), (other_away, two)) = (left(&self), left(&other));
        let keeps = away.cmp(&other_away).then(one.total_cmp(&two)).is_le();
        if keeps { self } else { other }
    }
}

impl Reversals {
    /// What is accepted after a look at another record. Rigid friction has the best of its fits
    /// there: the one to the fitted blocks, and one to the whole record from a start.
    fn asked_on(mut self, other: &Record, judge: &Judge<'_>, rigid: &Simulated) -> Self {
        if self.accepted.backlash {
            let left = |model: &Simulated| {
                let run = simulate(model, &self.drive, other);
                let all = position_rms(&run, other, &|_| true);
                if strays(&run, other, judge.travel) {
                    f64::INFINITY
                } else {
                    all
                }
            };
            let whole = fit(rigid, &self.drive, judge.record, &|_| true);
            let rigid = left(&self.rigid.model).min(left(&whole));
            let shape = left(&self.best().model);
            self.accepted = self.accepted.after_another_record(shape, rigid);
            self.alone = self.accepted;
        }
        self
    }

    /// What it says in short.
    #[must_use]
    pub(crate) fn summary(&self) -> Summary {
        let less = |gap: &Judged| gap.left().held_out < self.bristle.left().held_out;
        Summary {
            controller_known: matches!(self.drive, Drive::Known(_)),
            accepted: self.accepted,
            gap_leaves_less: self.gap.as_ref().is_some_and(less),
            bristle_helps: self.bristle.told() <= SHAPE_RATIO * self.rigid.told(),
            something_left: self.something_left,
        }
    }

    /// Whether it can be a witness: rigid friction did not run away, so that there is something to
    /// compare with, and the controller of the dataset is not refuted by its own record.
    #[must_use]
    pub(crate) const fn is_evidence(&self) -> bool {
        !self.rigid.ran_away && !matches!(self.controller, Controller::Refuted(_))
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

    /// Bristle and gap of the simulation that was accepted, with intervals.
    #[must_use]
    pub(crate) fn estimates(&self, dataset: &Dataset) -> Vec<Effect<Estimate>> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::controller::law::{Form, Law};
    use crate::simulate::made;
    use axis_model::EffectName::{Coulomb, Inertia};

    /// A resting axis of so many rows.
    fn dataset(period_s: f64, rows: usize) -> Dataset {
        made::dataset(made::record(period_s, vec![0.0; rows]), None)
    }

    /// 90 kg and 25 N with a shape at its reversals.
    fn model(shape: Shape) -> Simulated {
        let parts: &[(_, _, &[f64])] = &[(Inertia, 0.0, &[90.0]), (Coulomb, 0.0, &[25.0])];
        let fitted = made::fitted(parts);
        Simulated::new(&dataset(1.0e-3, 10), 1.0e-3, &fitted, shape).unwrap()
    }

    const fn shape(deflection: f64, width: f64) -> Shape {
        Shape {
            bristle: Some(Bristle {
                deflection,
                damping: 7.0,
            }),
            gap: Some(Gap {
                width,
                load_share: 0.5,
                motor_friction: 0.5,
                restitution: 0.5,
            }),
        }
    }

    fn judged(shape: Shape, held_out: f64) -> Judged {
        Judged {
            model: model(shape),
            held_out,
            all: 2.0 * held_out,
            ran_away: false,
            near: 3.0 * held_out,
            blocks: Vec::new(),
        }
    }

    /// Rigid friction leaves 9, a bristle 5, a gap 4 and both 3.
    fn reversals() -> Reversals {
        let bristle = Shape {
            gap: None,
            ..shape(3.0e-6, 0.0)
        };
        let gap = Shape {
            bristle: None,
            ..shape(0.0, 8.0e-6)
        };
        Reversals {
            controller: Controller::NotDescribed,
            drive: Drive::Followed,
            rigid: judged(Shape::default(), 9.0),
            bristle: judged(bristle, 5.0),
            gap: Some(judged(gap, 4.0)),
            both: Some(judged(shape(2.0e-6, 6.0e-6), 3.0)),
            accepted: Accepted::default(),
            alone: Accepted::default(),
            something_left: true,
        }
    }

    fn accept(reversals: &mut Reversals, presliding: bool, backlash: bool) {
        reversals.accepted = Accepted {
            presliding,
            backlash,
            undecided: false,
        };
    }

    #[test]
    fn a_block_is_two_seconds_or_a_sixth_of_a_short_record() {
        for (period_s, rows, block_rows) in [
            (1.0e-3, 24_000, 2000),
            (0.5e-3, 48_000, 4000),
            (1.0e-3, 6000, 1000),
            (1.0e-3, 5, 1),
        ] {
            let dataset = dataset(period_s, rows);
            assert_eq!(
                Judge::of(&dataset, Controller::NotDescribed).block_rows,
                block_rows,
                "{rows} rows"
            );
        }
    }

    #[test]
    fn every_second_block_is_fitted_and_the_others_are_judged() {
        let dataset = dataset(1.0e-3, 2500);
        let judge = Judge {
            drive: Drive::Followed,
            record: &dataset.train,
            block_rows: 400,
            travel: 1.0,
            excerpt: Excerpt::of(&dataset.train, 400),
        };
        let fitted = [0, 399, 400, 799, 800, 2400].map(|row| judge.is_fitted(row));
        assert_eq!(fitted, [true, true, false, false, true, true]);
        // Each block is off by a number of its own, the rest of 100 rows by nothing. The first 300
        // rows settle.
        let off = [6.0, 1.0, 2.0, 3.0, 4.0, 5.0, 0.0];
        let run = Run {
            motor: (0..2500).map(|row| off[row / 400]).collect(),
        };
        let left = judge.judged_by(model(Shape::default()), 0.0, &run);
        let near = |value: f64, wanted: f64| assert!((value - wanted).abs() < 1.0e-12, "{value}");
        near(left.held_out, (35.0_f64 / 3.0).sqrt());
        near(left.all, ((3600.0 + 400.0 * 55.0) / 2200.0_f64).sqrt());
        assert_eq!(left.blocks.len(), 3);
        for (block, wanted) in left.blocks.iter().zip([1.0, 9.0, 25.0]) {
            near(*block, wanted);
        }
    }

    #[test]
    fn the_nearest_starts_come_first_and_what_is_no_number_last() {
        let errors = || vec![3.0, f64::NAN, -f64::NAN, 1.0, 2.0];
        let items = ["three", "nan", "minus nan", "one", "two"];
        assert_eq!(nearest(errors(), &items, 2), [&"one", &"two"]);
        let all = nearest(errors(), &items, 9);
        assert_eq!(all[..3], [&"one", &"two", &"three"]);
        assert_eq!(all.len(), 5);
    }

    #[test]
    fn bristles_are_tried_from_one_to_sixty_micrometres_on_a_linear_axis() {
        let tried = bristles(1.0e-3, 90.0, |shape| Some(model(shape)));
        let shapes: Vec<Shape> = tried.iter().map(|one| one.mechanics.shape).collect();
        let of = |place: usize| shapes[place].bristle.unwrap();
        assert!((of(0).deflection / 1.0e-6 - 1.0).abs() < 1.0e-9);
        assert!((of(6).deflection / 60.0e-6 - 1.0).abs() < 1.0e-9);
        // Thirty times the mass a second.
        assert!(
            shapes
                .iter()
                .all(|one| one.bristle.unwrap().damping == 2700.0)
        );
        assert!(shapes.len() == 7 && shapes.iter().all(|one| one.gap.is_none()));
    }

    #[test]
    fn gaps_are_tried_from_2_to_120_micrometres_with_every_kind_of_impact() {
        let tried = gaps(1.0e-3, |shape| Some(model(shape)));
        let gap = |one: &Simulated| one.mechanics.shape.gap.unwrap();
        let gaps: Vec<Gap> = tried.iter().map(gap).collect();
        assert_eq!(gaps.len(), 56);
        assert!((gaps[0].width / 2.0e-6 - 1.0).abs() < 1.0e-9);
        assert!((gaps[55].width / 120.0e-6 - 1.0).abs() < 1.0e-9);
        let kinds = gaps[..4]
            .iter()
            .map(|gap| (gap.restitution, gap.motor_friction));
        let kinds: Vec<(f64, f64)> = kinds.collect();
        assert_eq!(kinds, [(0.1, 0.2), (0.1, 0.7), (0.7, 0.2), (0.7, 0.7)]);
        assert!(gaps[3].width == gaps[0].width && gaps[4].width > gaps[3].width);
        assert!(
            tried
                .iter()
                .all(|one| one.mechanics.shape.bristle.is_none())
        );
    }

    #[test]
    fn a_bristle_behind_a_gap_is_tried_about_the_bristle_and_the_gap_alone() {
        let bristle = Bristle {
            deflection: 5.0e-6,
            damping: 7.0,
        };
        let shapes = bristles_behind_gaps(bristle, 33.0e-6, 1.0e-3);
        let sizes: Vec<(f64, f64)> = shapes
            .iter()
            .map(|shape| (shape.gap.unwrap().width, shape.bristle.unwrap().deflection))
            .collect();
        assert_eq!(sizes.len(), 18);
        assert_eq!(sizes[16..], [(33.0e-6, 0.4 * 5.0e-6), (33.0e-6, 5.0e-6)]);
        assert!((sizes[0].0 / 2.0e-6 - 1.0).abs() < 1.0e-9);
        assert!((sizes[15].0 / 120.0e-6 - 1.0).abs() < 1.0e-9);
        assert!(
            shapes
                .iter()
                .all(|shape| shape.bristle.unwrap().damping == 7.0)
        );
    }

    #[test]
    fn a_bristle_behind_a_gap_is_tried_only_where_something_acts_and_a_gap_was_tried() {
        let dataset = dataset(1.0e-3, 10);
        let judge = Judge::of(&dataset, Controller::NotDescribed);
        let asked = std::cell::Cell::new(0);
        let start = |_: Shape| {
            asked.set(asked.get() + 1);
            None
        };
        let found = reversals();
        let starts = |accepted: [bool; 3], gap: Option<&Judged>| {
            let [presliding, backlash, undecided] = accepted;
            let accepted = Accepted {
                presliding,
                backlash,
                undecided,
            };
            asked.set(0);
            let both = judge.both(accepted, &found.bristle, gap, 1.0e-3, &start);
            assert!(both.is_none(), "nothing can be simulated");
            asked.get()
        };
        let gap = found.gap.as_ref();
        assert_eq!(starts([false; 3], gap), 0);
        assert_eq!(starts([true, false, false], None), 0);
        for one in 0..3 {
            assert_eq!(starts([0, 1, 2].map(|place| place == one), gap), 18);
        }
    }

    #[test]
    fn a_shape_is_visible_from_two_counts_on_and_rounding_leaves_a_count_over_root_twelve() {
        let found = reversals();
        let shapes = Shapes {
            rigid: found.rigid,
            bristle: found.bristle,
            gap: None,
        };
        let scene = shapes.scene(1.5e-6);
        assert_eq!(scene.smallest, 3.0e-6);
        assert_eq!((scene.rigid.held_out, scene.rigid.all), (9.0, 18.0));
        let Tried { left, size, .. } = scene.bristle;
        assert_eq!((left.held_out, left.all, size), (5.0, 10.0, 3.0e-6));
        assert!(scene.gap.is_none());
        assert!((rounding(4.0) - 4.0 / 12.0_f64.sqrt()).abs() < 1.0e-5);
    }

    #[test]
    fn what_ran_away_is_no_evidence_for_or_against_anything() {
        let away = |judged: Judged| Judged {
            ran_away: true,
            ..judged
        };
        let decided = |change: fn(&mut Shapes, &dyn Fn(Judged) -> Judged)| {
            let found = reversals();
            let mut shapes = Shapes {
                rigid: found.rigid,
                bristle: found.bristle,
                gap: found.gap,
            };
            change(&mut shapes, &away);
            let scene = shapes.scene(1.0e-6);
            let Accepted {
                presliding,
                backlash,
                undecided,
            } = scene.decide();
            (presliding, backlash, undecided)
        };
        let tie = (false, false, true);
        assert_eq!(decided(|_, _| ()), tie, "4 and 5 are a tie");
        let rigid = decided(|shapes, away| shapes.rigid = away(shapes.rigid.clone()));
        assert_eq!(rigid, (false, false, false), "nothing to compare with");
        let bristle = decided(|shapes, away| shapes.bristle = away(shapes.bristle.clone()));
        assert_eq!(bristle, tie, "a gap without a rival has not won");
        let gap = decided(|shapes, away| shapes.gap = shapes.gap.take().map(away));
        assert_eq!(gap, tie, "nor has a bristle");
    }

    #[test]
    fn the_better_fit_leaves_less_and_one_that_ran_away_is_never_better() {
        let fit = |left: f64, ran_away| Judged {
            ran_away,
            ..judged(Shape::default(), left)
        };
        let kept = |one: Judged, two: Judged| one.better(two).held_out;
        assert_eq!(kept(fit(2.0, false), fit(1.0, false)), 1.0);
        assert_eq!(kept(fit(1.0, false), fit(2.0, false)), 1.0);
        assert_eq!(kept(fit(1.0, true), fit(2.0, false)), 2.0);
        assert_eq!(kept(fit(2.0, false), fit(-f64::NAN, true)), 2.0);
        assert_eq!(kept(fit(1.0e70, true), fit(1.0e42, true)), 1.0e42);
    }

    #[test]
    fn a_free_run_is_a_witness_unless_rigid_friction_ran_away_or_the_controller_is_refuted() {
        let mut found = reversals();
        for controller in [Controller::NotDescribed, Controller::Hidden(0.2)] {
            found.controller = controller;
            assert!(found.is_evidence(), "{controller:?}");
        }
        found.controller = Controller::Refuted(0.2);
        assert!(!found.is_evidence());
        found.controller = Controller::NotDescribed;
        found.rigid.ran_away = true;
        assert!(!found.is_evidence());
    }

    /// A record that rigid friction made, in closed loop along two sines.
    fn simulated() -> (Dataset, Law, Simulated) {
        let law = Law {
            form: Form::Voltage { gain: 14_000.0 },
            position_gain: 40.0,
            limit: None,
            on_load: false,
            velocity_of_load: false,
            misfit: 0.0,
        };
        let path = made::two_sines(4000);
        let record = Record {
            reference: Some(path.clone()),
            ..made::record(1.0e-3, path)
        };
        let (mut dataset, truth) = (made::dataset(record, None), model(Shape::default()));
        dataset.train.position = simulate(&truth, &Drive::Known(law), &dataset.train).motor;
        (dataset, law, truth)
    }

    /// A shape that was left in the wrong valley gets out of it from where another one ended.
    #[test]
    fn rigid_friction_starts_once_more_where_a_gap_ended_with_the_gap_at_zero() {
        let (dataset, law, truth) = simulated();
        let judge = Judge::of(&dataset, Controller::Known(law));
        let of = |model: Simulated| judge.judged(model, 0.0);
        let mut heavy = truth.clone();
        heavy.mechanics.mass *= 20.0;
        let lost = of(heavy);
        let mut ended = truth;
        ended.mechanics.shape.gap = shape(0.0, 8.0e-6).gap;
        let gap = of(ended);
        let (before, again) = (lost.all, judge.restarted(lost, &[&gap]));
        assert!(again.all < 0.01 * before, "{before} {}", again.all);
        assert_eq!(again.model.mechanics.shape, Shape::default());
    }

    #[test]
    fn a_gap_that_cannot_come_down_to_what_its_rival_leaves_is_judged_and_not_fitted() {
        let (dataset, law, truth) = simulated();
        let judge = Judge::of(&dataset, Controller::Known(law));
        let mut start = truth;
        start.mechanics.shape.gap = shape(0.0, 80.0e-6).gap;
        start.mechanics.mass *= 1.5;
        let near = judge.excerpt.near(&start, &judge.drive);
        let best = |counts: f64| {
            let best = judge.best(std::slice::from_ref(&start), 1, counts);
            best.unwrap()
        };
        let left = judge.excerpt.error(&near, &judge.drive);
        let judged = best(0.49 * left);
        assert_eq!(
            (judged.model.mechanics, judged.near),
            (near.mechanics, left)
        );
        assert_ne!(best(0.51 * left).model.mechanics, near.mechanics);
        assert_ne!(best(f64::NAN).model.mechanics, near.mechanics);
    }

    #[test]
    fn a_shape_has_the_sizes_of_its_bristle_and_its_gap() {
        let sizes = |shape: Shape| {
            let judged = judged(shape, 1.0);
            (judged.deflection(), judged.width(), judged.smaller_size())
        };
        assert_eq!(sizes(shape(2.0e-6, 6.0e-6)), (2.0e-6, 6.0e-6, 2.0e-6));
        assert_eq!(sizes(shape(7.0e-6, 6.0e-6)), (7.0e-6, 6.0e-6, 6.0e-6));
        assert_eq!(sizes(Shape::default()), (0.0, 0.0, 0.0));
    }

    #[test]
    fn the_best_is_what_was_accepted_as_far_as_it_was_tried() {
        let mut found = reversals();
        let mut best = |presliding, backlash| {
            accept(&mut found, presliding, backlash);
            (found.best().held_out, found.deflection())
        };
        assert_eq!(best(false, false), (9.0, None));
        assert_eq!(best(true, false), (5.0, Some(3.0e-6)));
        assert_eq!(best(false, true), (4.0, None));
        assert_eq!(best(true, true), (3.0, Some(2.0e-6)));
        (found.gap, found.both) = (None, None);
        accept(&mut found, false, true);
        assert_eq!(found.best().held_out, 9.0);
        accept(&mut found, true, true);
        assert_eq!(found.best().held_out, 5.0);
    }

    #[test]
    fn in_short_a_gap_leaves_less_than_a_bristle_or_not_and_the_controller_is_known_or_not() {
        let mut found = reversals();
        found.accepted.undecided = true;
        let summary = found.summary();
        assert!(summary.gap_leaves_less && !summary.controller_known);
        assert!(summary.accepted.undecided);
        let gap = found.gap.as_mut().unwrap();
        gap.held_out = 5.0;
        found.drive = Drive::Known(Law {
            form: Form::Voltage { gain: 10.0 },
            position_gain: 4.0,
            limit: None,
            on_load: false,
            velocity_of_load: false,
            misfit: 0.0,
        });
        let summary = found.summary();
        assert!(!summary.gap_leaves_less && summary.controller_known);
        found.gap = None;
        assert!(!found.summary().gap_leaves_less);
    }

    #[test]
    fn a_doubt_stays_only_where_nothing_was_decided() {
        for (doubt, presliding, backlash, left) in [
            (true, false, false, true),
            (true, true, false, false),
            (true, false, true, false),
            (false, false, false, false),
        ] {
            let mut found = reversals();
            found.accepted.undecided = doubt;
            found.settle(presliding, backlash);
            let wanted = Accepted {
                presliding,
                backlash,
                undecided: left,
            };
            assert_eq!(found.accepted, wanted);
        }
    }

    #[test]
    fn t_is_the_mean_gain_over_rigid_friction_by_its_standard_error() {
        let mut found = reversals();
        found.rigid.blocks = vec![5.0, 6.0, 7.0];
        found.bristle.blocks = vec![4.0, 4.0, 4.0];
        // Gains 1, 2, 3: mean 2, standard error 1/√3.
        let t = found.bristle.t(&found.rigid);
        assert!((t - 12.0_f64.sqrt()).abs() < 1.0e-12, "{t}");
    }
}
