//! The difference of motor and load position: backlash, compliance and pitch error, where there is
//! a load scale.
//!
//! Candidates: a gap, wind-up by the transmitted force, and a function periodic in position.
//! Judged on held-out blocks like the force, but accepted only where the amplitude is beyond the
//! encoders' counts.
//!
//! Wind-up is judged by the recorded effort. What motor − load keeps in the end is told by what the
//! load's own motion asks for, where that leaves less ([`carried`]), and so are masses, screw and
//! friction then ([`by_the_load`]).
//!
//! A gap between rigid flanks is judged by the motion: the load coasts, or waits, while the motor
//! crosses it ([`crate::simulate::load`]). A gap beside wind-up is judged by the motor's balance of
//! forces ([`flanks`]), because motor − load alone shows a spring that is too soft as well.

mod beside;
mod between_rows;
mod by_the_load;
mod carried;
mod columns;
mod drag;
mod edges;
mod elsewhere;
mod fall;
mod flanks;
mod intervals;
mod known;
mod left;
mod linearised;
mod load;
mod motor_elements;
mod motor_friction;
mod motor_side;
mod refined;
mod rounding;
mod rubbing;
mod search;
mod slipping;
mod smallest;
mod spring;

use std::cell::OnceCell;
use std::f64::consts::TAU;

use axis_model::EffectName;

pub(crate) use self::by_the_load::ByTheLoad;
pub(crate) use self::columns::Path;
use self::columns::{Apart, FittedWays, Way};
pub(crate) use self::elsewhere::elsewhere;
use self::flanks::{Balance, Judged};
pub(crate) use self::known::Known;
use self::left::Left;
pub(crate) use self::load::More;
#[cfg(test)]
pub(crate) use self::motor_friction::MotorSide;
use self::search::{FEWEST_PERIODS, best_gap, best_order, best_pitch};
use self::smallest::Smallest;
use crate::evidence::selection::{self, Candidate, Output, Scored};
use crate::evidence::thresholds::{
    DIFFERENCE_RMS_COUNTS, DIFFERENCE_SHARE, DIFFERENCE_SHARE_OF_ALL, DIFFERENCE_T, EFFORT_PERCENT,
    FEWEST_COUNTS, FORCE_LARGE, GAP_FACTOR, IMPACTS, STIFFNESS_AGREES,
};
use crate::evidence::verdict::Reason;
use crate::fit::blocks::{Fit, Gain};
use crate::fit::plain::Plain;
use crate::model::effects::wave;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::scale_error::ScaleError;
use crate::record::units::AxisKind;

/// Least travel, in turns, over which a period of a turn is told from wind-up and a constant.
const FEWEST_TURNS: f64 = 0.75;

/// The effects that stand between motor and load, in the order in which they are tried.
const EFFECTS: [EffectName; 3] = [
    EffectName::Compliance,
    EffectName::Backlash,
    EffectName::PitchError,
];

/// What the difference says.
#[derive(Clone, Debug, Default)]
pub(crate) struct Difference {
    /// Accepted effects, in the order in which they were found.
    pub found: Vec<EffectName>,
    /// All candidates.
    pub scored: Vec<Scored>,
    /// Rms that the declared model leaves, µm (or µrad).
    pub before_um: f64,
    /// Rms that the extended model leaves.
    pub after_um: f64,
    /// Width of the gap, if one was found.
    pub gap: Option<Known>,
    /// Stiffness, if compliance was found or declared: effort per length.
    pub stiffness: Option<Known>,
    /// Coulomb friction of the motor's own side, before a spring without a gap.
    pub motor_coulomb: Option<Known>,
    /// Amplitude and wave number of each pitch error that was found or declared.
    pub pitch: Vec<(Known, Known)>,
    /// What the load's own motion tells, where it explains the wind-up better than the effort.
    pub by_the_load: Option<ByTheLoad>,
    /// The largest structure that no accepted effect explains, beyond the counts.
    left: Option<Left>,
    declared: FittedWays,
    extended: FittedWays,
}

/// What a gap by the motion leaves of motor − load over what one by the force does, or no gap where
/// the force speaks for none: as sums of squares, below which the motion judges. Chosen: half the
/// rms.
const MUCH_LESS: f64 = 0.25;

/// A wave is another one from so many periods more or less within the travel on: nearer, both look
/// alike over most of it.
const ANOTHER_WAVE: f64 = 1.0;

/// Most waves of a pitch error.
const MOST_PITCH_ERRORS: usize = 4;

/// A stiffness by the recorded effort is good to this share of itself at best: on made machines
/// both records of which agree, with and without a gap, it came out up to 2.8 % beside the truth
/// (2026-11-25).
const METHOD_OF_STIFFNESS: f64 = 0.02;

/// Counts, rms, of which no other law of the load's friction is asked: what the rounding of two
/// scales leaves at most is √(2/12) of one, and a bristle that is right leaves a third.
const ENOUGH_COUNTS: f64 = 0.5;

/// What was found is idle where it takes no more than this of the squares that the load's own
/// motion leaves. Chosen: a tenth of what an effect has to take to be found; nuts that rub, whose
/// friction passed for a gap by the effort, left 2·10⁻⁶ and 10⁻³ to it.
const IDLE: f64 = 0.01;

/// Rounds in which a pitch error and what the flanks do beside it settle.
const PITCH_ROUNDS: usize = 3;

/// Judges the difference of a training record; `None` where there is no load scale.
#[must_use]
pub(crate) fn difference(
    dataset: &Dataset,
    motion: &Kinematics,
    path: Path<'_>,
) -> Option<Difference> {
    let apart = Apart::on(motion, path)?;
    let mut difference = judged(dataset, apart.seen(apart.raw));
    // The force of wound-up flanks goes with motor − load, and a pitch error is none of it.
    for _ in 1..PITCH_ROUNDS {
        if !difference.has_pitch_beside_flanks() {
            break;
        }
        let ways = intervals::with_wave_numbers(&apart, difference.extended.ways());
        let raw = apart.cleared(&apart.where_known(&ways).fit(&ways));
        difference = judged(dataset, apart.seen(&raw));
    }
    Some(difference)
}

fn judged(dataset: &Dataset, apart: Apart<'_>) -> Difference {
    let mut output = MotorLoad::of(dataset, apart);
    let names = EFFECTS.into_iter().filter(|name| dataset.declares(*name));
    let declared = output.ways_of(&names.collect::<Vec<_>>());
    output.before = output.apart.cross_validate(&declared).held_out.iter().sum();
    let selection = selection::select(&output, declared.clone(), &mut |_| ());
    let fit = |ways: &Vec<Way>| output.apart.where_known(ways).fit(ways);
    let extended = output.without_idle_waves(selection.model, &declared);
    let fits = [&declared, &extended].map(fit);
    Difference::of(fits, selection.scored)
}

/// What motor − load keeps of a judged difference. Another law of the load's friction than a
/// bristle stands where it leaves less of another record, too, by what it was on this one.
pub(crate) fn settled_on_both(
    difference: Difference,
    dataset: &Dataset,
    [(motion, path), (elsewhere, there)]: [(&Kinematics, Path<'_>); 2],
) -> Difference {
    let settled_with =
        |laws: Laws, difference: Difference| settled(difference, dataset, (motion, path), laws);
    let any = settled_with(Laws::All, difference.clone());
    if any.laws() == Laws::Bristle {
        return any;
    }
    let bristle = settled_with(Laws::Bristle, difference);
    let left = |difference: &Difference| difference.on(elsewhere, there).map(|(_, after)| after);
    if left(&any) < left(&bristle) {
        any
    } else {
        bristle
    }
}

/// What the friction of a load may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Laws {
    /// A bristle.
    Bristle,
    /// Another fall of its level, elements that slip, what goes with direction and position.
    All,
}

/// What motor − load keeps of a judged difference. The wind-up is that by the load's own motion
/// where that leaves less.
fn settled(
    mut difference: Difference,
    dataset: &Dataset,
    (motion, path): (&Kinematics, Path<'_>),
    laws: Laws,
) -> Difference {
    let Some(apart) = Apart::on(motion, path) else {
        return difference;
    };
    let raw = apart.cleared(&difference.extended);
    let apart = apart.seen(&raw);
    let unit = dataset.moving_velocity;
    let count = dataset.resolution.max(dataset.load_resolution);
    let refitted = |fitted: &FittedWays, laws: Laws| {
        let enough = match laws {
            Laws::Bristle => f64::INFINITY,
            Laws::All => ENOUGH_COUNTS * count,
        };
        by_the_loads_motion(&apart, fitted, unit, enough)
    };
    let is_same = difference.declared.ways() == difference.extended.ways();
    difference.extended = refitted(&difference.extended, laws);
    difference.declared = if is_same {
        difference.extended.clone()
    } else {
        // What is declared lacks more than the shape of its friction.
        refitted(&difference.declared, Laws::Bristle)
    };
    difference.take_back(&apart);
    let ways = difference.extended.ways();
    let carried = ways.iter().position(|way| matches!(way, Way::Carried(_)));
    let smallest = Smallest {
        count: dataset.load_resolution,
        motor_count: dataset.resolution,
        velocity: unit,
    };
    let spring = spring::on_moving_rows(&apart, &ways);
    let told = carried.and_then(|place| by_the_load::told(&apart, &ways, place, smallest, spring));
    let told = told.filter(|told| difference.agrees_with(told));
    difference.know(&apart);
    difference.motor_coulomb = spring.map(|spring| spring.motor_coulomb);
    if let Some(told) = &told {
        difference.stiffness = Some(told.stiffness);
        difference.motor_coulomb = told.motor_side.map(|own| own.coulomb);
        difference.gap = told.gap.or(difference.gap);
    } else {
        difference.doubt_stiffness(spring.map(|spring| spring.stiffness));
        let stiffness = difference.stiffness;
        difference.stiffness = stiffness.map(|known| known.within_share(METHOD_OF_STIFFNESS));
    }
    difference.by_the_load = told;
    difference.before_um = apart.rms_um(&difference.declared);
    difference.after_um = apart.rms_um(&difference.extended);
    let apart = apart.where_known(&difference.extended.ways());
    let residual = apart.residual(&difference.extended);
    let wound = difference.extended.of(EffectName::Compliance);
    let wound = wound.map(|(way, own)| apart.predicted(way, own));
    difference.left = left::left(&apart, &residual, wound, count);
    difference
}

/// Fitted ways with the wind-up by the load's own motion, where that is better.
fn by_the_loads_motion(
    apart: &Apart<'_>,
    fitted: &FittedWays,
    unit: f64,
    enough: f64,
) -> FittedWays {
    let carried = carried::instead(apart, &fitted.ways(), unit, enough);
    let ways = carried.unwrap_or_else(|| fitted.ways());
    let ways = intervals::with_wave_numbers(apart, ways);
    apart.where_known(&ways).fit(&ways)
}

/// Motor − load as an output that judges.
struct MotorLoad<'a> {
    apart: Apart<'a>,
    /// Count of the coarser encoder.
    count: f64,
    /// Held-out sum of squares that the declared ways leave.
    before: f64,
    /// What the motor's balance says of a gap between springy flanks, once it was asked.
    springy: OnceCell<Option<Judged>>,
    /// Moved mass as the plain model sees it: a motor's own mass is less.
    inertia: f64,
    /// Whether positions are angles of a turn.
    is_rotary: bool,
    /// Wave numbers of the orders per revolution that have too few periods for a search.
    orders: Vec<f64>,
}

impl Output for MotorLoad<'_> {
    type Model = Vec<Way>;

    fn candidates(&self, ways: &Vec<Way>, round: usize) -> Vec<Candidate<Vec<Way>>> {
        let base = self.apart.where_known(ways).cross_validate(ways);
        let is_open = |name: &EffectName| count_of(ways, *name) < most_of(*name);
        let open = EFFECTS.into_iter().filter(is_open);
        let judged = open.filter_map(|name| self.judged(ways, &base, name, round));
        judged.collect()
    }

    fn accepts(&self, candidate: &Candidate<Vec<Way>>) -> bool {
        let Scored { gain, physical, .. } = &candidate.scored;
        let is_relevant = self.shows_in_force(&candidate.model)
            || gain.removed >= DIFFERENCE_SHARE_OF_ALL * self.before;
        let is_by_force = matches!(candidate.model.last(), Some(Way::Flanks(_)));
        let is_certain = if is_by_force {
            is_certain_by_force(gain)
        } else {
            gain.t >= DIFFERENCE_T
        };
        *physical
            && gain.share >= DIFFERENCE_SHARE
            && is_certain
            && is_relevant
            && self.is_beyond_counts(gain)
    }

    /// Friction of the motor's own side may show only beside what came in. A wave number goes
    /// beyond its grid, so that no second wave is what is left of the first.
    fn refined(&self, mut ways: Vec<Way>) -> Vec<Way> {
        if has(&ways, EffectName::PitchError) {
            ways = intervals::with_wave_numbers(&self.apart, ways);
        }
        let is_wind_up = |way: &Way| matches!(way, Way::WindUp { .. } | Way::HalfOf { .. });
        let Some(place) = ways.iter().position(is_wind_up) else {
            return ways;
        };
        let mut refined = ways;
        refined.remove(place);
        let wind_up = self.best_wind_up(&refined);
        refined.insert(place, wind_up);
        refined
    }

    fn most(&self) -> usize {
        EFFECTS.into_iter().map(most_of).sum()
    }
}

impl<'a> MotorLoad<'a> {
    fn of(dataset: &Dataset, apart: Apart<'a>) -> Self {
        let motion = apart.motion;
        Self {
            inertia: Plain::moved_mass(motion),
            apart,
            count: dataset.resolution.max(dataset.load_resolution),
            before: 0.0,
            springy: OnceCell::new(),
            is_rotary: dataset.kind == AxisKind::Rotary,
            orders: wave::of_orders(
                motion,
                dataset,
                wave::FEWEST_PERIODS_OF_AN_ORDER..FEWEST_PERIODS,
            ),
        }
    }

    /// The ways that effects are, each where it leaves least beside the others.
    fn ways_of(&self, names: &[EffectName]) -> Vec<Way> {
        let names = names.iter().copied();
        let mut ways = vec![Way::Constant];
        for name in names.clone() {
            let way = self.best(name, &ways);
            ways.extend(way);
        }
        // What came first did not know what came after it.
        if ways.len() > 2 {
            ways = names.fold(ways, |ways, name| self.anew(name, ways));
        }
        self.refined(ways)
    }

    /// Ways with the one of an effect looked for once more, beside all others.
    fn anew(&self, name: EffectName, mut ways: Vec<Way>) -> Vec<Way> {
        if let Some(place) = ways.iter().position(|way| way.called() == name) {
            let before = ways.remove(place);
            let way = self.best(name, &ways).unwrap_or(before);
            ways.insert(place, way);
        }
        ways
    }

    /// The way of an effect that leaves least beside others.
    fn best(&self, name: EffectName, ways: &[Way]) -> Option<Way> {
        match name {
            EffectName::Compliance => Some(self.best_wind_up(ways)),
            EffectName::Backlash => Some(self.best_gap(ways)),
            EffectName::PitchError => self.best_pitch(ways),
            _ => None,
        }
    }

    /// Wind-up beside other ways: with friction of the motor's own side where that helps and can
    /// be. Where the motor comes out with a mass that it cannot have, it gets half of the axis',
    /// unless that explains less.
    fn best_wind_up(&self, ways: &[Way]) -> Way {
        let [plain, rubbed] = [false, true].map(|motor_friction| Way::WindUp { motor_friction });
        let with = |way: Way| [ways, &[way]].concat();
        let can_be = |apart: &Apart<'_>, way: Way| {
            let fitted = apart.fit(&with(way));
            let last = fitted.last();
            last.is_some_and(|(way, own)| self.is_physical(way, own))
        };
        let helps = |apart: &Apart<'_>, [from, to]: [Way; 2]| {
            let [before, after] = [from, to].map(|way| apart.cross_validate(&with(way)));
            is_clear(&Gain::of(&before, &after))
        };
        let apart = &self.apart;
        if can_be(apart, rubbed) && helps(apart, [plain, rubbed]) {
            return rubbed;
        }
        let half = Way::HalfOf {
            motor_mass: 0.5 * self.inertia,
        };
        let moving = &apart.where_known(&[half]);
        if !can_be(apart, plain) && can_be(moving, half) && !helps(moving, [half, rubbed]) {
            half
        } else {
            plain
        }
    }

    /// A gap beside other ways: where the flanks wind up, and the force shows them, by the force,
    /// unless the motion shows it much better. Where the force of wound-up flanks goes as closely
    /// with the motion as the motor's own, what it shows is any width.
    fn best_gap(&self, ways: &[Way]) -> Way {
        let by_motion = || best_gap(&self.apart, ways, self.count);
        let springy = self.springy().filter(|_| has(ways, EffectName::Compliance));
        let Some(judged) = springy else {
            return by_motion();
        };
        let left = |more: &[Way]| self.apart.blocks(&[ways, more].concat()).fit().sse;
        let [by_force, by_motion] = [Way::Flanks(judged.flanks), by_motion()];
        // What lies between flanks is taken from motor − load itself: it leaves little however wide
        // they are, unless the force has shown them.
        let rival = if is_enough(&judged.gain) {
            left(&[by_force])
        } else {
            left(&[])
        };
        if left(&[by_motion]) < MUCH_LESS * rival {
            by_motion
        } else {
            by_force
        }
    }

    /// A pitch error beside other ways: of the strongest period within the travel, of an integer
    /// order per revolution with fewer periods, or of an angle encoder that sits off its centre
    /// (one period a turn) or between two heads (two).
    fn best_pitch(&self, ways: &[Way]) -> Option<Way> {
        let apart = &self.apart;
        let scanned = best_pitch(apart, &apart.fit(ways));
        let (low, high) = apart.motion.span();
        let turns: &[f64] = if self.is_rotary && high - low >= FEWEST_TURNS * TAU {
            &[1.0, 2.0]
        } else {
            &[]
        };
        let of_turns = turns.iter().map(|periods| Way::Pitch {
            per_length: periods / TAU,
        });
        let left = |way: &Way| apart.blocks(&[ways, &[*way]].concat()).fit().sse;
        let known = ways.iter().filter_map(Way::wave_number);
        let known: Vec<f64> = known.collect();
        let is_another = |k: &f64| {
            let periods = |known: &f64| (known - k).abs() * (high - low);
            known.iter().map(periods).all(|apart| apart >= ANOTHER_WAVE)
        };
        let orders: Vec<f64> = self.orders.iter().copied().filter(is_another).collect();
        let of_orders = best_order(apart, ways, &orders);
        let all = scanned.into_iter().chain(of_turns).chain(of_orders);
        let others = all.filter(|way| way.wave_number().is_none_or(|k| is_another(&k)));
        others.min_by(|a, b| left(a).total_cmp(&left(b)))
    }

    /// The same without waves that those after them made superfluous; as many stay as are declared.
    fn without_idle_waves(&self, mut ways: Vec<Way>, declared: &[Way]) -> Vec<Way> {
        let waves = |ways: &[Way]| count_of(ways, EffectName::PitchError);
        while waves(&ways) > waves(declared) {
            let places = (0..ways.len()).filter(|place| ways[*place].wave_number().is_some());
            let gains = places.map(|place| (place, self.worth(&ways, place)));
            let least = gains.min_by(|a, b| a.1.removed.total_cmp(&b.1.removed));
            match least {
                Some((place, gain)) if !self.is_worth_it(&gain) => ways.remove(place),
                _ => break,
            };
        }
        ways
    }

    /// What the way at a place removes on held-out blocks.
    fn worth(&self, ways: &[Way], place: usize) -> Gain {
        let mut without = ways.to_vec();
        without.remove(place);
        let apart = self.apart.where_known(ways);
        Gain::of(&apart.cross_validate(&without), &apart.cross_validate(ways))
    }

    /// Whether a gain is relevant, certain, and more than the counts.
    fn is_worth_it(&self, gain: &Gain) -> bool {
        is_clear(gain) && self.is_beyond_counts(gain)
    }

    fn is_beyond_counts(&self, gain: &Gain) -> bool {
        let rows = self.apart.mask.iter().filter(|inside| **inside).count() as f64;
        let removed_rms = (gain.removed.max(0.0) / rows.max(1.0)).sqrt();
        removed_rms >= DIFFERENCE_RMS_COUNTS * self.count
    }

    /// What the motor's balance says of a gap, where it shows the flanks.
    fn springy(&self) -> Option<&Judged> {
        let judge = || flanks::judged(&self.apart, self.count);
        let judged = self.springy.get_or_init(judge).as_ref();
        judged.filter(|judged| judged.sees_flanks)
    }

    /// An effect beside others, with what it is worth.
    fn judged(
        &self,
        ways: &[Way],
        base: &Fit,
        name: EffectName,
        round: usize,
    ) -> Option<Candidate<Vec<Way>>> {
        if name == EffectName::Compliance && has(ways, EffectName::Backlash) {
            let springy = self.beside_gap(ways);
            let wind_up = self.best_wind_up(&springy);
            let model = [&springy[..], &[wind_up]].concat();
            // Without any gap it must be better than the gap that it replaces.
            let beside: &[Way] = if has(&springy, EffectName::Backlash) {
                &springy
            } else {
                ways
            };
            let base = self.apart.cross_validate(beside);
            return Some(self.scored(model, &base, round));
        }
        let model = [ways, &[self.best(name, ways)?]].concat();
        if matches!(model.last(), Some(Way::HalfOf { .. })) {
            let base = self.apart.where_known(&model).cross_validate(ways);
            return Some(self.scored(model, &base, round));
        }
        let candidate = self.scored(model, base, round);
        if name == EffectName::Backlash && !candidate.scored.physical {
            return Some(self.without_motor_friction(ways, base, candidate));
        }
        Some(candidate)
    }

    /// Another candidate for a gap, instead of one that cannot be: beside a motor that rubs
    /// nowhere. Its friction holds the load back at each reversal too.
    fn without_motor_friction(
        &self,
        ways: &[Way],
        base: &Fit,
        candidate: Candidate<Vec<Way>>,
    ) -> Candidate<Vec<Way>> {
        let plain = |way: &Way| match way {
            Way::WindUp { .. } => Way::WindUp {
                motor_friction: false,
            },
            other => *other,
        };
        let plain: Vec<Way> = ways.iter().map(plain).collect();
        if plain == ways {
            return candidate;
        }
        let model = [&plain[..], &[self.best_gap(&plain)]].concat();
        self.scored(model, base, candidate.scored.round)
    }

    /// Whether the way that came in last belongs to a springy gap that matters to the effort: how
    /// much it is of motor − load is not the question then.
    fn shows_in_force(&self, ways: &[Way]) -> bool {
        let is_springy = ways.iter().any(|way| matches!(way, Way::Flanks(_)));
        let is_of_it = !matches!(ways.last(), Some(Way::Pitch { .. }));
        let judged = self.springy().filter(|_| is_springy && is_of_it);
        judged.is_some_and(|judged| judged.gain.percent >= EFFORT_PERCENT)
    }

    /// The ways beside which wind-up is judged where a gap was found without it: what looked like a
    /// gap between rigid flanks is one between springy flanks, or none.
    fn beside_gap(&self, ways: &[Way]) -> Vec<Way> {
        let Some(judged) = self.springy() else {
            return ways.to_vec();
        };
        let springy = is_enough(&judged.gain).then_some(Way::Flanks(judged.flanks));
        let rigid = |way: &&Way| way.called() != EffectName::Backlash;
        let others = ways.iter().filter(rigid).copied();
        others.chain(springy).collect()
    }

    /// A model with its last way, beside what fits without that.
    fn scored(&self, model: Vec<Way>, base: &Fit, round: usize) -> Candidate<Vec<Way>> {
        let fitted = self.apart.where_known(&model).fit(&model);
        let (way, own) = fitted.last().unwrap_or((Way::Constant, &[]));
        let scored = Scored {
            effect: way.called(),
            parameter: parameter(way, own),
            gain: self.gain(way, base, &model),
            physical: self.is_physical(way, own),
            accepted: false,
            round,
        };
        Candidate { scored, model }
    }

    /// What a way removes on held-out blocks.
    fn gain(&self, way: Way, base: &Fit, model: &[Way]) -> Gain {
        let apart = self.apart.where_known(model);
        let gain = Gain::of(base, &apart.cross_validate(model));
        match (way, self.springy()) {
            // The force decides; how much it is in counts motor − load knows.
            (Way::Flanks(_), Some(judged)) => Gain {
                removed: gain.removed,
                ..judged.gain
            },
            _ => gain,
        }
    }

    /// Whether the encoders can show what a spring of this softness winds up by.
    fn is_visible(&self, softness: f64) -> bool {
        let efforts = self.apart.path.transmitted.iter();
        let largest = efforts.fold(0.0_f64, |most, effort| most.max(effort.abs()));
        softness > 0.0 && softness * largest >= FEWEST_COUNTS * self.count
    }

    /// Whether coefficients can be those of a way, and the encoders can show it.
    fn is_physical(&self, way: Way, own: &[f64]) -> bool {
        let least = FEWEST_COUNTS * self.count;
        match way {
            Way::Constant | Way::Carried(_) => false,
            Way::Play(behind) => GAP_FACTOR.contains(&own[0]) && behind.gap >= least,
            // The force has judged its width: beside wind-up the factor of its lag is no test.
            Way::Flanks(flanks) => flanks.gap() >= least,
            Way::Pitch { .. } => own[0].hypot(own[1]) >= least,
            Way::HalfOf { .. } => self.is_visible(own[0]) && own[1] <= 0.0,
            Way::WindUp { .. } => {
                let motor_mass = -own[1] / own[0];
                let is_visible = self.is_visible(own[0]);
                // Friction of the motor holds the load back; what pushes it on is a gap.
                let is_friction = own.get(2).is_none_or(|step| *step <= 0.0);
                is_visible && motor_mass > 0.0 && motor_mass < self.inertia && is_friction
            }
        }
    }
}

/// How often ways have an effect.
fn count_of(ways: &[Way], name: EffectName) -> usize {
    ways.iter().filter(|way| way.called() == name).count()
}

/// How often ways may have an effect: a scale is off by the turns of its screw, by those of a wheel
/// before it, and by harmonics of both.
const fn most_of(name: EffectName) -> usize {
    match name {
        EffectName::PitchError => MOST_PITCH_ERRORS,
        _ => 1,
    }
}

/// Whether ways have an effect.
fn has(ways: &[Way], name: EffectName) -> bool {
    ways.iter().any(|way| way.called() == name)
}

/// Whether a gain is relevant to motor − load and more than chance.
fn is_clear(gain: &Gain) -> bool {
    gain.share >= DIFFERENCE_SHARE && gain.t >= DIFFERENCE_T
}

/// Whether the force speaks for a gap between springy flanks.
fn is_enough(gain: &Gain) -> bool {
    gain.share >= DIFFERENCE_SHARE && is_certain_by_force(gain) && gain.percent >= EFFORT_PERCENT
}

/// Whether a gain that the force shows is certain. Where a loop rings in a few seconds of a record
/// the gain sits there, and its t is small however large it is.
fn is_certain_by_force(gain: &Gain) -> bool {
    let (share, t) = FORCE_LARGE;
    gain.t >= DIFFERENCE_T || (gain.share >= share && gain.t >= t)
}

/// The quantity for people: width, stiffness, wave number.
fn parameter(way: Way, own: &[f64]) -> f64 {
    match way {
        Way::Constant | Way::Carried(_) => 0.0,
        Way::WindUp { .. } | Way::HalfOf { .. } => 1.0 / own[0],
        Way::Play(behind) => behind.gap,
        Way::Flanks(flanks) => flanks.gap(),
        Way::Pitch { per_length } => per_length,
    }
}

/// Stiffness of a spring, by the force where that shows a gap beside it: there it is not blurred by
/// the noise of the effort.
fn stiffness(gap: Option<(Way, &[f64])>, wind_up: Way, own: &[f64]) -> f64 {
    match gap {
        Some((Way::Flanks(flanks), _)) => flanks.stiffness,
        _ => parameter(wind_up, own),
    }
}

/// Each name once, in the order of the first.
fn once(names: impl Iterator<Item = EffectName>) -> Vec<EffectName> {
    let mut each = Vec::new();
    for name in names {
        if !each.contains(&name) {
            each.push(name);
        }
    }
    each
}

impl Difference {
    /// What the load's scale is off by: the pitch errors that were found or declared.
    pub(crate) fn scale_errors(&self) -> Vec<ScaleError> {
        self.extended.scale_errors()
    }

    fn of([declared, extended]: [FittedWays; 2], scored: Vec<Scored>) -> Self {
        let is_declared = |name: &EffectName| declared.of(*name).is_some();
        let gap = extended.of(EffectName::Backlash);
        let wind_up = extended.of(EffectName::Compliance);
        Self {
            found: once(extended.names().filter(|name| !is_declared(name))),
            scored,
            before_um: 0.0,
            after_um: 0.0,
            gap: gap.map(|(way, own)| Known::new(parameter(way, own), 0.0)),
            stiffness: wind_up
                .filter(|(_, own)| own[0] > 0.0)
                .map(|(way, own)| Known::new(stiffness(gap, way, own), 0.0)),
            motor_coulomb: None,
            pitch: Vec::new(),
            by_the_load: None,
            left: None,
            declared,
            extended,
        }
    }

    /// Whether the load moves otherwise than the motor.
    #[must_use]
    pub(crate) const fn moves_apart(&self) -> bool {
        self.gap.is_some() || self.stiffness.is_some()
    }

    /// Whether there is a pitch error beside what goes with motor − load itself.
    fn has_pitch_beside_flanks(&self) -> bool {
        let ways = self.extended.ways();
        let is_wound = has(&ways, EffectName::Compliance) || has(&ways, EffectName::Backlash);
        is_wound && has(&ways, EffectName::PitchError)
    }

    /// How well the sizes of what was fitted are known. Those of springy flanks are known by the
    /// motor's balance, as they were found.
    fn know(&mut self, apart: &Apart<'_>) {
        let half_widths = intervals::half_widths(apart, &self.extended);
        for (place, half_widths) in half_widths.iter().enumerate() {
            let Some((way, own)) = self.extended.at(place) else {
                continue;
            };
            let searched = half_widths.searched.unwrap_or(0.0);
            match way {
                Way::Play(behind) => self.know_rigid(apart, behind.gap, searched),
                Way::Flanks(flanks) => {
                    let (gap, stiffness) = Balance::of(apart).known(flanks);
                    self.gap = Some(gap);
                    self.stiffness = self.stiffness.map(|_| stiffness);
                }
                Way::Pitch { per_length } => {
                    let size = own[0].hypot(own[1]);
                    let off = (own[0] * half_widths.own[0]).hypot(own[1] * half_widths.own[1]);
                    let amplitude = Known::new(size, off / size.max(f64::MIN_POSITIVE));
                    self.pitch
                        .push((amplitude, Known::new(per_length, searched)));
                }
                Way::Constant | Way::WindUp { .. } | Way::HalfOf { .. } | Way::Carried(_) => {}
            }
        }
    }

    /// How well a gap that the motion tells is known. A spring beside it is not known by the force:
    /// what the load's friction winds up by may as well be a part of the gap.
    fn know_rigid(&mut self, apart: &Apart<'_>, gap: f64, half_width: f64) {
        self.stiffness = self
            .stiffness
            .map(|known| Known::new(known.value, known.value));
        let coulomb = Plain::fit(apart.motion).coulomb.max(0.0);
        let wound = self
            .stiffness
            .map_or(0.0, |known| 2.0 * coulomb / known.value);
        self.gap = Some(Known::new(gap, half_width.hypot(wound)));
    }

    /// The stiffness of a spring without a gap: by the rows in which the motor moves, where they
    /// contradict that of all rows, else as well known as they tell it. Where they do not tell it,
    /// it may be anything up to twice what it was taken for.
    fn doubt_stiffness(&mut self, on_moving_rows: Option<Known>) {
        let ways = self.extended.ways();
        let Some(stiffness) = self.stiffness.filter(|_| !has(&ways, EffectName::Backlash)) else {
            return;
        };
        let of_all = stiffness.value;
        let known = on_moving_rows.map(|seen| {
            let apart = (seen.value - of_all).abs();
            if apart > seen.half_width {
                seen
            } else {
                Known::new(of_all, seen.half_width + apart)
            }
        });
        self.stiffness = known.or(Some(Known::new(of_all, of_all)));
    }

    /// Whether the stiffness may be anything from zero up.
    #[must_use]
    pub(crate) fn hardly_knows_the_stiffness(&self) -> bool {
        let is_vague = |stiffness: Known| stiffness.half_width >= stiffness.value;
        self.stiffness.is_some_and(is_vague)
    }

    /// What no accepted effect explains, with the unit of millionths of a position; impacts between
    /// rigid flanks are excused.
    #[must_use]
    pub(crate) fn reason(&self, unit: &str) -> Option<Reason> {
        let Left { over, rms } = self.left.filter(|_| !self.is_impacts())?;
        Some(Reason::unexplained(format!(
            "motor − load that goes with {over} ({:.2} {unit} rms) otherwise than by a gap, a \
             stiffness or a pitch error",
            1.0e6 * rms
        )))
    }

    /// Whether the load's motion tells the stiffness that the effort told. Where a loop bounces
    /// between its flanks it does not, and neither is right.
    fn agrees_with(&self, told: &ByTheLoad) -> bool {
        // With friction of the motor's side or without, as the effort's way had it.
        let stiffness = self.stiffness.map_or(f64::NAN, |known| known.value);
        let mut told = [told.unrubbed, told.stiffness].into_iter();
        told.any(|told| (told.value / stiffness - 1.0).abs() <= STIFFNESS_AGREES)
    }

    /// Takes back what was found where what is declared leaves as little without it. It was found
    /// beside wind-up by the effort; the load's motion may know the wind-up better.
    fn take_back(&mut self, apart: &Apart<'_>) {
        if self.declared.ways() == self.extended.ways() {
            return;
        }
        let [without, with] =
            [&self.declared, &self.extended].map(|ways| apart.rms_um(ways).powi(2));
        if (1.0 - IDLE) * without <= with {
            let scored = std::mem::take(&mut self.scored);
            let declared = self.declared.clone();
            *self = Self::of([declared.clone(), declared], scored);
        }
    }

    /// What the friction of the load is, where its own motion tells it.
    fn laws(&self) -> Laws {
        let ways = self.extended.ways();
        let is_bristle = |way: &Way| match way {
            Way::Carried(carried) => carried.rubs_as_a_bristle(),
            _ => true,
        };
        if ways.iter().all(is_bristle) {
            Laws::Bristle
        } else {
            Laws::All
        }
    }

    /// Whether what is left may be impacts between rigid flanks.
    fn is_impacts(&self) -> bool {
        match self.extended.of(EffectName::Backlash) {
            Some((Way::Play(behind), _)) => self.after_um <= 1.0e6 * IMPACTS * behind.gap,
            _ => false,
        }
    }

    /// Rms on another record: declared, extended; µm.
    #[must_use]
    pub(crate) fn on(&self, motion: &Kinematics, path: Path<'_>) -> Option<(f64, f64)> {
        let apart = Apart::on(motion, path)?;
        let raw = apart.cleared(&self.extended);
        let apart = apart.seen(&raw);
        Some((apart.rms_um(&self.declared), apart.rms_um(&self.extended)))
    }
}

#[cfg(test)]
mod tests {
    use super::carried::tests::{FRICTION, rubbed};
    use super::edges::Flanks;
    use super::*;
    use crate::fit::made::{Axis, on, usual};
    use crate::record::units::EffortHold;
    use crate::simulate::load::Behind;
    use crate::simulate::made::{record, two_sines};
    use std::f64::consts::TAU;

    impl Difference {
        /// Motor and load that keep a structure.
        pub(crate) fn with_structure() -> Self {
            Self {
                left: Some(Left {
                    over: "the position",
                    rms: 50.0e-6,
                }),
                ..Self::default()
            }
        }
    }

    const COUNT: f64 = 1.0e-7;

    fn values((amplitude, per_length): (Known, Known)) -> (f64, f64) {
        (amplitude.value, per_length.value)
    }

    /// The one pitch error.
    fn only(difference: &Difference) -> (f64, f64) {
        assert_eq!(difference.pitch.len(), 1);
        values(difference.pitch[0])
    }

    /// A motor with a load that is late by what is told of row, position and effort.
    fn axis(lag: impl Fn(&[f64], usize) -> f64) -> Axis {
        let position = two_sines(6000);
        let mut made = record(1.0e-3, position.clone());
        let noise = |row: usize| 0.3 * COUNT * (1.7 * (row * row % 1013) as f64).sin();
        let load = (0..6000).map(|row| position[row] - lag(&position, row) - 5.0e-6 + noise(row));
        made.load = Some(load.collect());
        let mut axis = on(made);
        (axis.dataset.resolution, axis.dataset.load_resolution) = (COUNT, 0.5 * COUNT);
        axis.put(usual);
        axis
    }

    fn judged(axis: &Axis) -> Difference {
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        let difference = difference(&axis.dataset, &axis.motion, path).unwrap();
        settled(difference, &axis.dataset, (&axis.motion, path), Laws::All)
    }

    #[test]
    fn what_leaves_hardly_less_than_what_is_declared_is_taken_back() {
        let axis = carried::tests::axis(|_| 0.0);
        let apart = carried::tests::apart(&axis);
        let found = |ways: [&[Way]; 2]| {
            let mut difference = Difference::of(ways.map(|ways| apart.fit(ways)), Vec::new());
            difference.take_back(&apart);
            difference.found
        };
        let spring = &carried::tests::WAYS[..];
        let wave = [Way::Constant, Way::Pitch { per_length: 100.0 }];
        assert_eq!(found([spring, &wave]), []);
        assert_eq!(found([&wave, spring]), [EffectName::Compliance]);
        // A wave beside the spring takes what chance has of it.
        let idle = [spring, &[Way::Pitch { per_length: 100.0 }]].concat();
        assert_eq!(found([spring, &idle]), []);
    }

    #[test]
    fn another_law_stands_where_it_leaves_less_of_another_record_too() {
        let at = [4.0e-6, 20.0e-6, 60.0e-6];
        let elements = FRICTION.slipping(&at, &[0.3, 0.4, 0.3]).unwrap();
        let [mut slips, bends] = [elements, FRICTION].map(|law| rubbed(law, 0.0, |_| 0.0));
        (slips.dataset.resolution, slips.dataset.load_resolution) = (1.0e-9, 1.0e-9);
        let own = (&slips.motion, carried::tests::apart(&slips).path);
        let found = difference(&slips.dataset, own.0, own.1).unwrap();
        let laws = |other: &Axis| {
            let both = [own, (&other.motion, carried::tests::apart(other).path)];
            settled_on_both(found.clone(), &slips.dataset, both).laws()
        };
        assert_eq!((laws(&slips), laws(&bends)), (Laws::All, Laws::Bristle));
    }

    #[test]
    fn a_large_share_of_the_force_is_certain_with_a_small_t() {
        let certain = |share: f64, t: f64| {
            is_certain_by_force(&Gain {
                removed: 1.0,
                percent: 1.0,
                share,
                t,
            })
        };
        assert!(certain(0.1, 2.0) && certain(0.3, 1.0));
        assert!(!certain(0.29, 1.9) && !certain(0.9, 0.9));
    }

    #[test]
    fn without_a_load_scale_there_is_no_difference() {
        let mut axis = axis(|_, _| 0.0);
        axis.motion.difference = None;
        let path = Path {
            position: &[],
            transmitted: &[],
            hold: EffortHold::Instant,
        };
        assert!(difference(&axis.dataset, &axis.motion, path).is_none());
    }

    #[test]
    fn an_order_of_few_periods_is_a_pitch_error_and_a_smooth_error_over_the_travel_is_none() {
        let position = two_sines(6000);
        let ends = position.iter().fold((0.0_f64, 0.0_f64), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
        let travel = ends.1 - ends.0;
        let lead = travel / 2.3;
        let found = |error: &dyn Fn(f64) -> f64| {
            let mut axis = axis(|x, row| 1.0e-6 * error(x[row]));
            axis.dataset.lead_m_per_rev = Some(lead);
            let difference = judged(&axis);
            (difference.found.clone(), difference.pitch)
        };
        let (names, pitch) = found(&|x| 3.0 * (TAU * x / lead + 0.4).cos());
        assert_eq!(names, [EffectName::PitchError]);
        let (amplitude, per_length) = values(pitch[0]);
        assert!((amplitude / 3.0e-6 - 1.0).abs() < 0.05, "{amplitude}");
        assert!((per_length * lead - 1.0).abs() < 1.0e-9, "{per_length}");
        let u = |x: f64| 2.0 * x / travel;
        for smooth in [
            &(|x| 4.0 * u(x)) as &dyn Fn(f64) -> f64,
            &|x| 9.0 * u(x).powi(2) - 4.0 * u(x),
            &|x| 20.0 * u(x).powi(4) - 5.0 * u(x).powi(3),
        ] {
            assert!(!found(smooth).0.contains(&EffectName::PitchError));
        }
    }

    #[test]
    fn of_two_scales_with_other_zeros_nothing_is_found() {
        let difference = judged(&axis(|_, _| 0.0));
        assert!(difference.found.is_empty() && !difference.moves_apart());
        assert_eq!(
            (difference.gap, difference.stiffness, difference.pitch),
            (None, None, Vec::new())
        );
        assert!(difference.after_um < 0.03, "{}", difference.after_um);
    }

    #[test]
    fn a_pitch_error_is_found_with_amplitude_and_period() {
        let axis = axis(|x, row| 2.0e-6 * (TAU * 500.0 * x[row] + 0.4).cos());
        let difference = judged(&axis);
        assert_eq!(difference.found, [EffectName::PitchError]);
        let (amplitude, per_length) = only(&difference);
        assert!((amplitude / 2.0e-6 - 1.0).abs() < 0.05, "{amplitude}");
        assert!((per_length / 500.0 - 1.0).abs() < 0.01, "{per_length}");
        // 2 µm of amplitude are 1.4 µm rms.
        assert!(
            (difference.before_um / 1.41 - 1.0).abs() < 0.1,
            "{}",
            difference.before_um
        );
        assert!(difference.after_um < 0.3 && !difference.moves_apart());
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        let (before, after) = difference.on(&axis.motion, path).unwrap();
        assert_eq!((before, after), (difference.before_um, difference.after_um));
    }

    #[test]
    fn every_wave_of_a_pitch_error_is_found_and_no_further_one() {
        // 500, 725 and 230 waves a metre.
        let waves = [(2.0e-6, 500.0), (1.1e-6, 725.0), (0.6e-6, 230.0)];
        for count in 1..=waves.len() {
            let wave = |x: f64| {
                let each = waves[..count].iter();
                each.map(|(size, k)| size * (TAU * k * x + 0.4).cos()).sum()
            };
            let difference = judged(&axis(|x, row| wave(x[row])));
            assert_eq!(difference.found, [EffectName::PitchError], "{count}");
            let found: Vec<(f64, f64)> = difference.pitch.iter().copied().map(values).collect();
            assert_eq!(found.len(), count, "{found:?}");
            for ((amplitude, per_length), (size, k)) in found.iter().zip(waves) {
                assert!((amplitude / size - 1.0).abs() < 0.05, "{found:?}");
                assert!((per_length / k - 1.0).abs() < 1.0e-3, "{found:?}");
            }
            assert!(difference.after_um < 0.1, "{}", difference.after_um);
        }
    }

    #[test]
    fn a_gap_is_found_with_its_width() {
        // 40 % of 90 kg behind the gap, with all of the friction: 25 N and 200 N s/m.
        let behind = Behind {
            gap: 20.0e-6,
            coulomb: 25.0 / 36.0,
            viscous: 200.0 / 36.0,
            restitution: 0.3,
        };
        let lag = behind.follow(&two_sines(6000), 1.0e-3);
        let difference = judged(&axis(|_, row| lag[row]));
        assert_eq!(difference.found.first(), Some(&EffectName::Backlash));
        let Known {
            value: gap,
            half_width,
        } = difference.gap.unwrap();
        assert!(
            (gap - 20.0e-6).abs() < half_width && half_width < 0.5e-6,
            "{gap} {half_width}"
        );
        assert!((gap / 20.0e-6 - 1.0).abs() < 0.02, "{gap}");
        assert!(difference.moves_apart() && difference.stiffness.is_none());
    }

    #[test]
    fn a_gap_beside_a_declared_spring_and_a_pitch_error_is_found_by_the_motion() {
        let behind = Behind {
            gap: 20.0e-6,
            coulomb: 25.0 / 36.0,
            viscous: 200.0 / 36.0,
            restitution: 0.0,
        };
        let lag = behind.follow(&two_sines(6000), 1.0e-3);
        let pitch = |x: f64| 6.0e-6 * (TAU * 500.0 * x + 0.4).cos();
        let mut axis = axis(|x, row| lag[row] + pitch(x[row]));
        for declared in [
            vec![EffectName::Compliance],
            vec![
                EffectName::Compliance,
                EffectName::Backlash,
                EffectName::PitchError,
            ],
        ] {
            let usual = axis.dataset.declared.clone();
            axis.dataset.declared.extend(declared.iter().copied());
            let difference = judged(&axis);
            axis.dataset.declared = usual;
            let has = |name| declared.contains(&name) || difference.found.contains(&name);
            assert!(has(EffectName::Backlash) && has(EffectName::PitchError));
            let gap = difference.gap.unwrap();
            assert!((gap.value / 20.0e-6 - 1.0).abs() < 0.1, "{gap:?}");
            assert!((gap.value - 20.0e-6).abs() < gap.half_width, "{gap:?}");
            let (amplitude, _) = only(&difference);
            assert!((amplitude / 6.0e-6 - 1.0).abs() < 0.03, "{amplitude}");
            assert!(difference.after_um < 1.0, "{}", difference.after_um);
        }
    }

    #[test]
    fn a_spring_is_found_with_its_stiffness() {
        let mut wound = axis(|_, _| 0.0);
        // 60 kg of 90 kg are behind 5 N/µm.
        let motor = wound.motion.low_passed(&wound.motion.acceleration);
        let force: Vec<f64> = wound
            .motion
            .effort_lp
            .iter()
            .zip(motor)
            .map(|(f, a)| f - 30.0 * a)
            .collect();
        let difference = wound.motion.difference.as_mut().unwrap();
        difference
            .iter_mut()
            .zip(force)
            .for_each(|(x, force)| *x += force / 5.0e6);
        let difference = judged(&wound);
        assert_eq!(difference.found, [EffectName::Compliance]);
        let Known {
            value: stiffness,
            half_width,
        } = difference.stiffness.unwrap();
        assert!((stiffness / 5.0e6 - 1.0).abs() < 0.02, "{stiffness}");
        assert!((stiffness - 5.0e6).abs() < half_width, "{half_width}");
        assert!(!difference.hardly_knows_the_stiffness(), "{half_width}");
        assert!(difference.moves_apart() && difference.gap.is_none());
    }

    #[test]
    fn impacts_between_rigid_flanks_are_excused_up_to_a_tenth_of_the_gap() {
        let behind = Behind {
            gap: 50.0e-6,
            ..Behind::default()
        };
        let left = |after_um: f64, way: Way| Difference {
            extended: FittedWays::made(vec![(way, vec![1.0])]),
            after_um,
            ..Difference::with_structure()
        };
        let is_told = |after_um, way| left(after_um, way).reason("µm").is_some();
        assert!(!is_told(5.0, Way::Play(behind)) && is_told(5.1, Way::Play(behind)));
        assert!(is_told(0.1, Way::Constant));
    }

    #[test]
    fn what_is_declared_is_fitted_and_not_found() {
        let mut axis = axis(|x, row| 2.0e-6 * (TAU * 500.0 * x[row]).cos());
        axis.dataset.declared.push(EffectName::PitchError);
        let difference = judged(&axis);
        assert!(difference.found.is_empty());
        assert!(difference.before_um < 0.3 && difference.pitch.len() == 1);
    }

    fn output(axis: &Axis, count: f64) -> MotorLoad<'_> {
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        MotorLoad {
            apart: Apart::on(&axis.motion, path).unwrap(),
            count,
            before: 100.0,
            springy: OnceCell::new(),
            is_rotary: false,
            orders: Vec::new(),
            inertia: 90.0,
        }
    }

    #[test]
    fn coefficients_beyond_the_counts_and_of_the_right_sign_are_physical() {
        let axis = axis(|_, _| 0.0);
        let output = output(&axis, 1.0e-6);
        let largest = axis
            .motion
            .effort_lp
            .iter()
            .fold(0.0_f64, |most, f| most.max(f.abs()));
        let play = |gap: f64| {
            Way::Play(Behind {
                gap,
                ..Behind::default()
            })
        };
        let pitch = Way::Pitch { per_length: 500.0 };
        let softest = 2.0e-6 / largest;
        let [plain, rubbed] = [false, true].map(|motor_friction| Way::WindUp { motor_friction });
        let half = Way::HalfOf { motor_mass: 45.0 };
        let flanks = |high: f64| {
            Way::Flanks(Flanks {
                high,
                ..Flanks::default()
            })
        };
        for (way, own, wanted) in [
            (play(2.0e-6), &[0.8][..], true),
            (play(2.0e-6), &[1.2], true),
            (play(2.0e-6), &[0.79], false),
            (play(2.0e-6), &[1.21], false),
            (play(1.9e-6), &[1.0], false),
            (flanks(2.1e-6), &[1.0], true),
            (flanks(2.1e-6), &[1.21], true),
            (flanks(1.9e-6), &[1.0], false),
            (pitch, &[1.2e-6, -1.61e-6], true),
            (pitch, &[1.2e-6, 1.59e-6], false),
            (plain, &[1.01 * softest, -30.0 * softest], true),
            (plain, &[0.99 * softest, -30.0 * softest], false),
            (plain, &[1.01 * softest, 30.0 * softest], false),
            (plain, &[1.01 * softest, -92.0 * softest], false),
            (plain, &[-1.01 * softest, 30.0 * softest], false),
            (
                rubbed,
                &[1.01 * softest, -30.0 * softest, -1.0e-6, 0.0],
                true,
            ),
            (
                rubbed,
                &[1.01 * softest, -30.0 * softest, 1.0e-6, 0.0],
                false,
            ),
            (half, &[1.01 * softest, -1.0e-6, 0.0], true),
            (half, &[0.99 * softest, -1.0e-6, 0.0], false),
            (half, &[1.01 * softest, 1.0e-6, 0.0], false),
            (Way::Constant, &[1.0], false),
        ] {
            assert_eq!(output.is_physical(way, own), wanted, "{way:?} {own:?}");
        }
    }

    #[test]
    fn a_gain_is_accepted_at_its_limits_and_not_below_any_of_them() {
        let axis = axis(|_, _| 0.0);
        let mut output = output(&axis, 1.0);
        // Four samples: 4 removed are an rms of one count.
        output.apart.mask.fill(false);
        output.apart.mask[..4].fill(true);
        let accepts = |removed: f64, share: f64, t: f64, physical: bool| {
            output.accepts(&Candidate {
                scored: Scored {
                    effect: EffectName::Backlash.into(),
                    parameter: 0.0,
                    gain: Gain {
                        removed,
                        share,
                        percent: 1.0,
                        t,
                    },
                    physical,
                    accepted: false,
                    round: 0,
                },
                model: Vec::new(),
            })
        };
        assert!(accepts(4.0, 0.10, 2.0, true));
        assert!(!accepts(4.0, 0.10, 2.0, false));
        assert!(!accepts(3.9, 0.10, 2.0, true));
        assert!(!accepts(4.0, 0.09, 2.0, true));
        assert!(!accepts(4.0, 0.10, 1.9, true));
        let of_all = |before: f64| {
            MotorLoad {
                before,
                ..self::output(&axis, 1.0e-9)
            }
            .accepts(&Candidate {
                scored: Scored {
                    effect: EffectName::Backlash.into(),
                    parameter: 0.0,
                    gain: Gain {
                        removed: 1.0,
                        share: 0.5,
                        percent: 1.0,
                        t: 9.0,
                    },
                    physical: true,
                    accepted: false,
                    round: 0,
                },
                model: Vec::new(),
            })
        };
        assert!(of_all(99.0) && !of_all(101.0));
        assert_eq!(output.most(), 6);
    }

    #[test]
    fn the_quantity_for_people_is_width_stiffness_or_wave_number() {
        let gap = Behind {
            gap: 3.0e-6,
            ..Behind::default()
        };
        assert_eq!(parameter(Way::Play(gap), &[0.9]), 3.0e-6);
        let spring = Way::WindUp {
            motor_friction: false,
        };
        assert_eq!(parameter(spring, &[2.0e-7, 0.0]), 5.0e6);
        assert_eq!(parameter(Way::Pitch { per_length: 7.0 }, &[1.0, 2.0]), 7.0);
    }
}
