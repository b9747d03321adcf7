//! What happens about reversals, in the inverse model: stick or bristle.
//!
//! Moving samples hardly show presliding. Judged here is the friction that is observed about
//! reversals, effort − everything but the sign columns, against two models of the same level G(v):
//! [`stick`], rigid Coulomb friction that holds whatever there is at standstill, and [`bristle`],
//! Dahl's hysteresis, without that freedom. A gap between rigid friction and the motor cannot be
//! judged this way (its impacts are not in the low-passed effort): see
//! [`crate::evidence::free_run`]. One before a bristle can ([`mod@gap`]).

pub(crate) mod bristle;
pub(crate) mod gap;
pub(crate) mod slip;
pub(crate) mod stick;

use axis_model::EffectName;

use self::bristle::{Bristle, deflections};
use self::gap::{Plant, SeenGap};
use self::slip::{Elements, Fall};
use crate::evidence::thresholds::{
    AS_MUCH_RATIO, BRISTLE_RATIO, BRISTLE_T, FEWEST_COUNTS, FEWEST_REVERSAL_ROWS, SLIP_RATIO,
    SUSPICION_RATIO, VETO_RATIO,
};
use crate::fit::bench::Bench;
use crate::fit::fitted::{Fitted, Term};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Friction about reversals, as observed, with the level of the model.
pub(crate) struct Observed<'a> {
    /// The motion.
    pub motion: &'a Kinematics,
    /// Level G(v) of the sign columns.
    pub level: Vec<f64>,
    /// Effort − all other columns, low-passed.
    pub friction: Vec<f64>,
    /// Resolution of the encoder where friction acts.
    pub resolution: f64,
}

/// What the samples about reversals say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Presliding {
    /// Rms error with rigid Coulomb friction.
    pub rigid: f64,
    /// Rms error with Dahl's bristle.
    pub dahl: f64,
    /// Best deflection δ.
    pub deflection: f64,
    /// Mean over standard error of the gain per reversal.
    pub t: f64,
    /// Whether presliding is accepted.
    pub accepted: bool,
    /// What the same bristle leaves of another record, over what rigid friction leaves there;
    /// `None` where that has no reversals.
    pub elsewhere: Option<f64>,
}

/// Judges presliding for a model, on its record and on another one; `None` where the model has no
/// Coulomb friction or the record no reversals.
#[must_use]
pub(crate) fn presliding(
    bench: &Bench<'_>,
    other: &Bench<'_>,
    fitted: &Fitted,
) -> Option<Presliding> {
    let motion = bench.motion;
    if !has_reversals(motion) {
        return None;
    }
    let observed = Observed::new(bench, fitted)?;
    let rigid = stick::error(&observed);
    let (deflection, bristle) = bristle::best(&observed, bench.dataset.moving_velocity);
    let t = block_t(&motion.slow, &rigid, &bristle);
    let seen = Presliding {
        rigid: rms(&rigid, &motion.slow),
        dahl: rms(&bristle, &motion.slow),
        deflection,
        t,
        accepted: false,
        elsewhere: ratio(other, &other.fit(fitted.model()), deflection),
    };
    Some(Presliding {
        accepted: seen.is_clear(resolution(bench.dataset)),
        ..seen
    })
}

/// Maxwell slip that leaves no more about the reversals of two records than Dahl's bristle.
pub(crate) struct Slipping {
    /// What slips.
    pub elements: Elements,
    /// Whether it leaves clearly less of both.
    pub is_clear: bool,
}

/// Maxwell slip in place of Dahl's bristle, for a model as it is fitted to each of two records.
/// `None` where it leaves more about the reversals of one of them.
#[must_use]
pub(crate) fn slip(records: [(&Bench<'_>, &Fitted); 2], about: f64) -> Option<Slipping> {
    let [own, other] = records.map(|(bench, fitted)| Observed::new(bench, fitted));
    let (own, other) = (own?, other?);
    let bench = records[0].0;
    let (deflection, _) = bristle::best(&own, bench.dataset.moving_velocity);
    let fall = Fall::of(records[0].1);
    let elements = Elements::best(&own, fall, about, resolution(bench.dataset))?;
    let left = |observed: &Observed<'_>, bristle: &Bristle| {
        rms(&bristle.error(observed), &observed.motion.slow)
    };
    let [dahl, slip] = [Bristle::Dahl(deflection), Bristle::Slip(elements.clone())];
    let of_dahls = |observed: &Observed<'_>| {
        has_reversals(observed.motion).then(|| left(observed, &slip) / left(observed, &dahl))
    };
    let ratios = [of_dahls(&own), of_dahls(&other)];
    let are_at_most = |most: f64| ratios.iter().flatten().all(|ratio| *ratio <= most);
    are_at_most(AS_MUCH_RATIO).then(|| Slipping {
        elements,
        is_clear: are_at_most(SLIP_RATIO),
    })
}

/// A gap before the bristle of a model whose bristle was accepted; `None` where the model has no
/// mass or friction.
#[must_use]
pub(crate) fn gap(bench: &Bench<'_>, other: &Bench<'_>, fitted: &Fitted) -> Option<SeenGap> {
    let first = |name: EffectName| fitted.of(name).and_then(<[f64]>::first).copied();
    let plant = Plant {
        mass: first(EffectName::Inertia).filter(|mass| *mass > 0.0)?,
        coulomb: first(EffectName::Coulomb)?,
    };
    let observed = Observed::new(bench, fitted)?;
    let elsewhere = Observed::new(other, &other.fit(fitted.model()))?;
    let (unit, count) = (bench.dataset.moving_velocity, bench.dataset.resolution);
    gap::best([&observed, &elsewhere], plant, unit, count)
}

/// What a bristle leaves of a record, over what rigid friction leaves.
fn ratio(bench: &Bench<'_>, fitted: &Fitted, deflection: f64) -> Option<f64> {
    if !has_reversals(bench.motion) {
        return None;
    }
    let left = |bristle| error_rms(bench, fitted, bristle);
    Some(left(Some(&Bristle::Dahl(deflection)))? / left(None)?.max(f64::MIN_POSITIVE))
}

/// Whether a motion has enough samples about reversals to be judged there.
fn has_reversals(motion: &Kinematics) -> bool {
    motion.slow.iter().filter(|slow| **slow).count() >= FEWEST_REVERSAL_ROWS
}

impl Presliding {
    /// Whether a bristle leaves clearly less, at enough reversals, is not below the smallest
    /// deflection that shows, and another record does not contradict it.
    fn is_clear(&self, smallest: f64) -> bool {
        self.dahl <= BRISTLE_RATIO * self.rigid
            && self.t >= BRISTLE_T
            && self.deflection >= smallest
            && self.elsewhere.is_none_or(|ratio| ratio <= VETO_RATIO)
    }

    /// Whether the same bristle leaves less of another record too.
    fn repeats(&self) -> bool {
        self.elsewhere.is_some_and(|ratio| ratio < SUSPICION_RATIO)
    }

    /// Whether a bristle leaves less, at enough reversals of both records, but not so much less
    /// that it is one.
    pub(crate) fn is_suspicious(&self) -> bool {
        !self.accepted
            && self.repeats()
            && self.t >= BRISTLE_T
            && self.dahl < SUSPICION_RATIO * self.rigid
    }
}

/// Rms of the effort about reversals that a model does not explain: with a bristle, else
/// with rigid stick.
#[must_use]
pub(crate) fn error_rms(
    bench: &Bench<'_>,
    fitted: &Fitted,
    bristle: Option<&Bristle>,
) -> Option<f64> {
    let observed = Observed::new(bench, fitted)?;
    let error = match bristle {
        Some(bristle) => bristle.error(&observed),
        None => stick::error(&observed),
    };
    Some(rms(&error, &bench.motion.slow))
}

/// Smallest δ that a dataset can show.
#[must_use]
pub(crate) fn resolution(dataset: &Dataset) -> f64 {
    FEWEST_COUNTS * encoder_resolution(dataset)
}

/// Resolution of the encoder where friction acts: the load scale if there is one.
fn encoder_resolution(dataset: &Dataset) -> f64 {
    if dataset.train.load.is_some() {
        dataset.load_resolution
    } else {
        dataset.resolution
    }
}

impl<'a> Observed<'a> {
    fn new(bench: &Bench<'a>, fitted: &Fitted) -> Option<Self> {
        fitted.of(EffectName::Coulomb)?;
        let motion = bench.motion;
        let mut level = vec![0.0; motion.len()];
        let mut others = vec![0.0; motion.len()];
        for Term { part, own } in fitted.terms() {
            let columns = bench.raw(part);
            for (place, (column, coefficient)) in columns.iter().zip(own).enumerate() {
                if part.effect.is_level(place) {
                    let signed = column.iter().zip(&motion.direction);
                    level
                        .iter_mut()
                        .zip(signed)
                        .for_each(|(level, (c, d))| *level += coefficient * c * d);
                } else {
                    let column = motion.low_passed(column);
                    others
                        .iter_mut()
                        .zip(column)
                        .for_each(|(others, c)| *others += coefficient * c);
                }
            }
        }
        let friction = motion
            .effort_lp
            .iter()
            .zip(others)
            .map(|(effort, others)| effort - others)
            .collect();
        let resolution = encoder_resolution(bench.dataset);
        Some(Self {
            motion,
            level,
            friction,
            resolution,
        })
    }
}

impl Observed<'_> {
    /// What is left of the friction beside the level times a state.
    fn without(&self, state: &[f64]) -> Vec<f64> {
        let force = self.level.iter().zip(state);
        let force: Vec<f64> = force.map(|(level, state)| level * state).collect();
        let force = self.motion.low_passed(&force);
        let seen = self.friction.iter().zip(force);
        seen.map(|(seen, force)| seen - force).collect()
    }
}

/// Rms over a mask.
#[must_use]
pub(crate) fn rms(error: &[f64], mask: &[bool]) -> f64 {
    let inside = error.iter().zip(mask).filter(|(_, inside)| **inside);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (e, _)| {
        (sum + e * e, count + 1.0)
    });
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Mean over standard error of the gain, one value per contiguous run of a mask.
fn block_t(mask: &[bool], before: &[f64], after: &[f64]) -> f64 {
    let mut gains: Vec<f64> = Vec::new();
    let mut inside = false;
    for ((slow, b), a) in mask.iter().zip(before).zip(after) {
        if *slow && !inside {
            gains.push(0.0);
        }
        inside = *slow;
        if let (true, Some(gain)) = (*slow, gains.last_mut()) {
            *gain += b * b - a * a;
        }
    }
    crate::fit::blocks::t_of(&gains)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::inverse_dynamics::tests::{DEFLECTION_M, declared, record};
    use crate::fit::made::{self, USUAL, axis, usual};
    use crate::model::inverse::Part;
    use EffectName::{Inertia, Offset, Viscous};

    fn fitted(coefficients: &[f64]) -> Fitted {
        let names = [Inertia, Viscous, EffectName::Coulomb, Offset];
        Fitted::new(made::model(&names[..coefficients.len()]), coefficients)
    }

    #[test]
    fn the_level_is_that_of_coulomb_friction_and_all_other_forces_are_taken_off() {
        let axis = axis(usual);
        let bench = axis.bench();
        let observed = Observed::new(&bench, &fitted(&USUAL)).unwrap();
        assert!(observed.level.iter().all(|level| *level == 25.0));
        let motion = &axis.motion;
        let friction: Vec<f64> = motion.direction.iter().map(|d| 25.0 * d).collect();
        let friction = motion.low_passed(&friction);
        for row in (0..motion.len()).filter(|row| motion.is_inside(*row)) {
            let apart = observed.friction[row] - friction[row];
            assert!(apart.abs() < 0.05, "row {row}: {apart}");
        }
        assert!(Observed::new(&bench, &fitted(&USUAL[..2])).is_none());
    }

    #[test]
    fn a_bristle_is_seen_with_its_deflection_and_rigid_friction_is_none() {
        let fitted = fitted(&[700.0, 900.0, 300.0]);
        let dataset = declared(record(Some(DEFLECTION_M)));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let seen = presliding(&bench, &bench, &fitted).unwrap();
        assert!(seen.repeats());
        assert!(seen.accepted && seen.t > BRISTLE_T, "{seen:?}");
        assert!(
            (seen.deflection / DEFLECTION_M - 1.0).abs() < 0.01,
            "{seen:?}"
        );
        assert!(
            seen.rigid > 20.0 && seen.dahl < 0.05 * seen.rigid,
            "{seen:?}"
        );
        let dahl = |deflection| error_rms(&bench, &fitted, Some(&Bristle::Dahl(deflection)));
        let rigid = error_rms(&bench, &fitted, None);
        assert_eq!(rigid, Some(seen.rigid));
        assert_eq!(dahl(seen.deflection), Some(seen.dahl));
        assert!(dahl(DEFLECTION_M).unwrap() < 1.0e-6 * seen.rigid);
        let dataset = declared(record(None));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let rigid = Bench::new(&dataset, &motion);
        let seen = presliding(&rigid, &rigid, &fitted).unwrap();
        assert!(!seen.accepted && seen.rigid < seen.dahl, "{seen:?}");
        let contradicted = presliding(&bench, &rigid, &fitted).unwrap();
        assert!(
            !contradicted.repeats() && !contradicted.accepted,
            "{contradicted:?}"
        );
    }

    #[test]
    fn friction_that_drifts_bends_before_it_slips_too() {
        // As much again as the 300 N at first, and a force and a viscous friction that fade as it.
        let mut dataset = declared(record(Some(DEFLECTION_M)));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let seen = Bristle::Dahl(DEFLECTION_M).motion(&motion);
        for (row, effort) in dataset.train.effort.iter_mut().enumerate() {
            let (v, direction) = (motion.velocity_lp[row], seen.direction[row]);
            let fall = (-motion.time_s[row] / 2.0).exp();
            *effort += fall * (300.0 * direction + 90.0 * v + 30.0);
        }
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let drifting = made::found(EffectName::FrictionDrift, 2.0);
        let drifting = Part {
            effect: drifting.effect.by_direction().unwrap(),
            ..drifting
        };
        let model = made::model(&[Inertia, Viscous, EffectName::Coulomb]).with(drifting);
        let fitted = Fitted::new(model, &[700.0, 900.0, 300.0, 300.0, 90.0, 30.0]);
        let seen = presliding(&bench, &bench, &fitted).unwrap();
        assert!(
            (seen.deflection / DEFLECTION_M - 1.0).abs() < 0.01,
            "{seen:?}"
        );
        assert!(seen.dahl < 0.01 * seen.rigid, "{seen:?}");
    }

    #[test]
    fn two_hundred_samples_about_reversals_are_needed() {
        let mut axis = axis(usual);
        let mut speaks = |rows: usize| {
            axis.motion.slow.fill(false);
            axis.motion.slow[1000..1000 + rows].fill(true);
            presliding(&axis.bench(), &axis.bench(), &fitted(&USUAL)).is_some()
        };
        assert!(!speaks(0) && !speaks(199) && speaks(200) && speaks(300));
    }

    const ACCEPTED: Presliding = Presliding {
        rigid: 2.0,
        dahl: 1.0,
        deflection: 1.0e-5,
        t: 9.0,
        accepted: true,
        elsewhere: Some(0.5),
    };

    #[test]
    fn what_both_records_show_at_enough_reversals_is_suspicious_where_it_is_no_bristle() {
        let suspicious = |dahl, t, repeats, accepted| {
            let seen = Presliding {
                dahl,
                t,
                accepted,
                elsewhere: Some(if repeats { 0.84 } else { 0.85 }),
                ..ACCEPTED
            };
            seen.is_suspicious()
        };
        assert!(suspicious(1.69, 1.2, true, false));
        assert!(!suspicious(1.7, 9.0, true, false) && !suspicious(0.1, 1.19, true, false));
        assert!(!suspicious(0.1, 9.0, false, false) && !suspicious(0.1, 9.0, true, true));
    }

    #[test]
    fn a_bristle_is_clear_at_its_limits_and_not_beyond_any_of_them() {
        let clear = |dahl, t, deflection| {
            let seen = Presliding {
                rigid: 2.0,
                dahl,
                deflection,
                t,
                ..ACCEPTED
            };
            seen.is_clear(3.0e-6)
        };
        assert!(clear(1.4, 1.2, 3.0e-6));
        assert!(!clear(1.41, 9.0, 9.0e-6));
        assert!(!clear(0.1, 1.19, 9.0e-6));
        assert!(!clear(0.1, 9.0, 2.9e-6));
        let there = |elsewhere| {
            Presliding {
                elsewhere,
                ..ACCEPTED
            }
            .is_clear(3.0e-6)
        };
        assert!(there(None) && there(Some(1.05)) && !there(Some(1.06)));
    }

    #[test]
    fn the_smallest_deflection_is_two_counts_where_friction_acts() {
        let mut dataset = axis(usual).dataset;
        (dataset.resolution, dataset.load_resolution) = (1.0e-6, 3.0e-6);
        assert_eq!(resolution(&dataset), 2.0e-6);
        dataset.train.load = Some(dataset.train.position.clone());
        assert_eq!(resolution(&dataset), 6.0e-6);
    }

    #[test]
    fn rms_is_over_the_mask_and_zero_where_that_is_empty() {
        let error = [3.0, 100.0, -4.0];
        assert_eq!(rms(&error, &[true, false, true]), 12.5_f64.sqrt());
        assert_eq!(rms(&error, &[false; 3]), 0.0);
    }

    #[test]
    fn t_has_one_gain_a_reversal() {
        let mask = [true, true, false, true, false, true];
        let before = [2.0, 1.0, 9.0, 3.0, 9.0, 7.0];
        let after = [1.0, 1.0, 0.0, 1.0, 0.0, 6.0];
        // 3 + 0, 8 and 13: mean 8, standard error 5/√3.
        let t = block_t(&mask, &before, &after);
        assert!((t - 1.6 * 3.0_f64.sqrt()).abs() < 1.0e-12, "{t}");
    }
}
