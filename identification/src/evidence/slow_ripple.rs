//! Torque ripple of an axis that passes its reversals fast.
//!
//! At speed, ripple of a high order lies above the low-pass; it shows only about the reversals,
//! which the margins about slow samples leave out. Where an axis never dwells there is no stiction
//! to protect the fit from, and those samples are judged on their own: the declared model and one
//! integer order per revolution after the other, on held-out blocks, with the thresholds of the
//! selection.

use crate::evidence::inverse_dynamics::Compared;
use crate::evidence::selection::{self, Candidate, Output, Scored, Selection, is_enough};
use crate::evidence::thresholds::{
    AMPLITUDE_HALF_WIDTHS, DWELL_ROWS, FEWEST_SLOW_REVERSALS, FEWEST_SLOW_ROWS,
    LARGEST_DISAGREEMENT, SLOW_SHARE,
};
use crate::fit::bench::Bench;
use crate::fit::blocks::Gain;
use crate::fit::fitted::{Estimate, Fitted};
use crate::fit::side_by_side::side_by_side;
use crate::model::effects::torque_ripple::TorqueRipple;
use crate::model::effects::wave::HIGHEST_ORDER;
use crate::model::inverse::{Model, Part};
use crate::motion::excitation::reversals;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// Torque ripple of an axis that is never slow for long.
#[derive(Clone, Debug)]
pub(crate) struct RippleAtReversals {
    /// Samples up to this velocity were used, in position units per second.
    pub fastest: f64,
    /// Low-pass of this judgement, Hz.
    pub cutoff_hz: f64,
    /// Orders, largest contribution first.
    pub orders: Vec<OrderAtReversals>,
    /// Force error over these samples, training record, percent: the declared model fitted to
    /// them, and with the ripple.
    pub train_percent: Compared<f64>,
    /// The same on the validation record.
    pub validate_percent: Compared<f64>,
}

/// One order of ripple.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrderAtReversals {
    /// Periods per revolution.
    pub per_rev: u32,
    /// Amplitude, in the unit of the effort.
    pub amplitude: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
    /// What it removed of the held-out error when it was added.
    pub gain: Gain,
}

/// Low-pass of this judgement, Hz.
const CUTOFF_HZ: f64 = 30.0;

/// Ripple about reversals; `None` where the axis dwells, the revolution is not known, or nothing
/// was found.
#[must_use]
pub(crate) fn slow_ripple(
    dataset: &Dataset,
    moving: &Kinematics,
    declared: &Model,
) -> Option<RippleAtReversals> {
    let revolution = dataset.revolution()?;
    let limit = dataset.moving_velocity;
    if dwells(&moving.velocity_lp, limit, reversals(moving)) {
        return None;
    }
    let fastest = SLOW_SHARE * median_speed(moving);
    let slow = |record: &Record| slow_motion(dataset, record, fastest);
    let (train, validate) = (slow(&dataset.train)?, slow(&dataset.validate)?);
    if is_short(&train) {
        return None;
    }
    let bench = Bench::new(dataset, &train);
    let output = SlowEffort {
        halves: halves(&train),
        bench: &bench,
        revolution,
    };
    let selection = selection::select(&output, declared.clone(), &mut |_| ());
    let models = Compared {
        declared: bench.fit(declared),
        extended: bench.fit(&selection.model),
    };
    let orders = output.orders(&models.extended, &selection);
    let percent = |motion: &Kinematics| {
        models.each(|fitted| Bench::new(dataset, motion).force_error_percent(fitted))
    };
    (!orders.is_empty()).then(|| RippleAtReversals {
        fastest,
        cutoff_hz: CUTOFF_HZ,
        orders,
        train_percent: percent(&train),
        validate_percent: percent(&validate),
    })
}

/// Whether an axis is slow for long, or turns too seldom to say.
fn dwells(velocity: &[f64], limit: f64, reversals: usize) -> bool {
    let slow = velocity.iter().filter(|v| v.abs() <= limit).count();
    reversals < FEWEST_SLOW_REVERSALS || slow as f64 >= DWELL_ROWS * reversals as f64
}

/// Whether a motion has too few slow samples to say.
fn is_short(slow: &Kinematics) -> bool {
    slow.fitted.iter().filter(|slow| **slow).count() < FEWEST_SLOW_ROWS
}

/// The effort of slow samples: one integer order per revolution after the other.
struct SlowEffort<'a> {
    bench: &'a Bench<'a>,
    halves: [Kinematics; 2],
    /// Way of one revolution.
    revolution: f64,
}

impl Output for SlowEffort<'_> {
    type Model = Model;

    fn candidates(&self, model: &Model, round: usize) -> Vec<Candidate<Model>> {
        let (base, fixed) = (self.bench.cross_validate(model), self.bench.gathered(model));
        let parts = (1..=HIGHEST_ORDER).map(|order| self.part(order));
        let is_open = |part: &Part| !model.parts.iter().any(|known| known.is_same(part));
        let open: Vec<Part> = parts.filter(is_open).collect();
        let judged = |part: &Part| {
            let blocks = self.bench.beside_once(&fixed, part);
            let scored = Scored {
                effect: part.called(),
                parameter: part.parameter,
                gain: Gain::of(&base, &blocks.cross_validate()),
                physical: true,
                accepted: false,
                round,
            };
            Candidate {
                scored,
                model: model.with(part.clone()),
            }
        };
        side_by_side(&open, judged)
    }

    /// Only what both halves of the record agree about.
    fn accepts(&self, candidate: &Candidate<Model>) -> bool {
        is_enough(&candidate.scored.gain) && self.halves_agree(&candidate.model)
    }
}

impl SlowEffort<'_> {
    fn part(&self, order: u32) -> Part {
        Part::found(&TorqueRipple, f64::from(order) / self.revolution)
    }

    /// Whether both halves see the last order of a model with about the same amplitude and phase.
    fn halves_agree(&self, model: &Model) -> bool {
        let [one, other] = self.halves.each_ref().map(|motion| {
            let fitted = Bench::new(self.bench.dataset, motion).fit(model);
            let last = fitted.terms().next_back();
            last.map_or([0.0; 2], |term| [term.own[0], term.own[1]])
        });
        agree(one, other)
    }

    /// The orders that were found and are larger than their intervals, in the order in which they
    /// were found.
    fn orders(&self, fitted: &Fitted, selection: &Selection) -> Vec<OrderAtReversals> {
        let estimates = self.bench.estimates_of_coefficients(fitted);
        let accepted = selection.scored.iter().filter(|scored| scored.accepted);
        let order = |scored: &Scored| {
            let is_its = |one: &&Estimate| {
                one.part.called() == scored.effect && one.part.parameter == scored.parameter
            };
            let (own, half): (Vec<f64>, Vec<f64>) =
                estimates.iter().find(is_its)?.own.iter().copied().unzip();
            Some(OrderAtReversals {
                per_rev: (scored.parameter * self.revolution).round() as u32,
                amplitude: own[0].hypot(own[1]),
                half_width: half[0].hypot(half[1]),
                gain: scored.gain,
            })
        };
        let orders = accepted.filter_map(order);
        orders.filter(OrderAtReversals::is_large).collect()
    }
}

impl OrderAtReversals {
    /// Whether the amplitude is larger than its interval makes of nothing.
    fn is_large(&self) -> bool {
        self.amplitude >= AMPLITUDE_HALF_WIDTHS * self.half_width
    }
}

/// Whether two amplitudes (cosine and sine) are about the same.
fn agree(one: [f64; 2], other: [f64; 2]) -> bool {
    let apart = f64::hypot(one[0] - other[0], one[1] - other[1]);
    let mean = 0.5 * f64::hypot(one[0] + other[0], one[1] + other[1]);
    apart <= LARGEST_DISAGREEMENT * mean
}

fn median_speed(motion: &Kinematics) -> f64 {
    let moving = motion
        .velocity_lp
        .iter()
        .zip(&motion.moving)
        .filter(|(_, moving)| **moving);
    let mut speeds: Vec<f64> = moving.map(|(v, _)| v.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get(speeds.len() / 2).copied().unwrap_or(0.0)
}

/// The motion with its slow samples in place of the moving ones.
fn slow_motion(dataset: &Dataset, record: &Record, fastest: f64) -> Option<Kinematics> {
    let motion = Kinematics::with_cutoff(dataset, record, CUTOFF_HZ)?;
    let rows = motion.len();
    let slow = |row: usize| motion.is_inside(row) && motion.velocity_lp[row].abs() <= fastest;
    let mask: Vec<bool> = (0..rows)
        .map(|row| slow(row) && !record.interpolated[row])
        .collect();
    Some(Kinematics {
        moving: mask.clone(),
        fitted: mask,
        ..motion
    })
}

/// The two halves of the samples, each on its own.
fn halves(motion: &Kinematics) -> [Kinematics; 2] {
    let count = motion.fitted.iter().filter(|slow| **slow).count();
    let mut seen = 0;
    let first: Vec<bool> = motion
        .fitted
        .iter()
        .map(|slow| {
            seen += usize::from(*slow);
            *slow && 2 * seen <= count
        })
        .collect();
    let second = motion
        .fitted
        .iter()
        .zip(&first)
        .map(|(slow, first)| *slow && !first)
        .collect();
    [first, second].map(|fitted| Kinematics {
        fitted,
        ..motion.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, model, on, usual};
    use crate::simulate::made::record;
    use axis_model::EffectName::{Coulomb, Inertia, Offset, Viscous};
    use std::f64::consts::TAU;

    #[test]
    fn halves_agree_within_six_tenths_of_their_mean() {
        // Mean 1: 0.6 apart, along and across.
        assert!(agree([1.299, 0.0], [0.701, 0.0]) && !agree([1.301, 0.0], [0.699, 0.0]));
        assert!(agree([0.0, 1.299], [0.0, 0.701]) && !agree([0.0, 1.301], [0.0, 0.699]));
        assert!(agree([1.0, 0.299], [1.0, -0.299]) && !agree([1.0, 0.301], [1.0, -0.301]));
        assert!(!agree([1.0, 0.0], [-1.0, 0.0]));
    }

    #[test]
    fn an_axis_dwells_with_a_slow_row_per_reversal_or_with_few_reversals() {
        let velocity = |slow: usize| {
            let mut velocity = vec![0.5; 1000];
            velocity[..slow].fill(-0.09);
            velocity
        };
        assert!(!dwells(&velocity(19), 0.1, 20));
        assert!(dwells(&velocity(20), 0.1, 20));
        assert!(dwells(&velocity(0), 0.1, 19));
        assert!(!dwells(&velocity(20), 0.08, 20));
    }

    #[test]
    fn each_half_has_half_of_the_samples_and_none_of_the_others() {
        let mut axis = axis(usual);
        axis.motion.fitted.fill(false);
        axis.motion.fitted[100..201].fill(true);
        let [first, second] = halves(&axis.motion);
        let rows = |motion: &Kinematics| -> Vec<usize> {
            (0..motion.len())
                .filter(|row| motion.fitted[*row])
                .collect()
        };
        assert_eq!(rows(&first), (100..150).collect::<Vec<usize>>());
        assert_eq!(rows(&second), (150..201).collect::<Vec<usize>>());
    }

    #[test]
    fn the_median_speed_is_one_of_moving_samples_in_both_directions() {
        let mut axis = axis(usual);
        let motion = &mut axis.motion;
        motion.moving.fill(false);
        motion.moving[..5].fill(true);
        motion.velocity_lp[..5].copy_from_slice(&[-0.5, 0.1, 0.2, -0.4, 0.3]);
        assert_eq!(median_speed(motion), 0.3);
    }

    #[test]
    fn slow_samples_stand_in_for_the_moving_ones_but_for_holes_and_ends() {
        let mut axis = axis(usual);
        axis.dataset.train.interpolated[2000..2500].fill(true);
        let record = &axis.dataset.train;
        let velocity = |motion: &Kinematics, row: usize| motion.velocity_lp[row].abs();
        let all = slow_motion(&axis.dataset, record, f64::INFINITY).unwrap();
        // The limit itself is slow: it is the velocity of a row.
        let limit = velocity(&all, 3000);
        let slow = slow_motion(&axis.dataset, record, limit).unwrap();
        assert_eq!(slow.moving, slow.fitted);
        assert!(slow.fitted[3000]);
        for row in 0..slow.len() {
            let recorded = (200..5800).contains(&row) && !(2000..2500).contains(&row);
            assert_eq!(all.fitted[row], recorded, "row {row}");
            let wanted = recorded && velocity(&slow, row) <= limit;
            assert_eq!(slow.fitted[row], wanted, "row {row}");
        }
    }

    #[test]
    fn fifteen_hundred_slow_samples_are_needed() {
        let mut motion = axis(usual).motion;
        let mut short = |rows: usize| {
            motion.fitted.fill(false);
            motion.fitted[..rows].fill(true);
            is_short(&motion)
        };
        assert!(short(0) && short(1499) && !short(1500) && !short(3000));
    }

    #[test]
    fn an_amplitude_is_large_from_one_and_a_half_half_widths_on() {
        let is_large = |amplitude| {
            let order = OrderAtReversals {
                per_rev: 5,
                amplitude,
                half_width: 2.0,
                gain: Gain {
                    removed: 1.0,
                    share: 1.0,
                    percent: 1.0,
                    t: 1.0,
                },
            };
            order.is_large()
        };
        assert!(is_large(3.0) && is_large(4.0) && !is_large(2.99));
    }

    /// Whether an order of 4 N is accepted whose sign is another one in the second half.
    fn is_accepted(second: f64) -> [bool; 2] {
        let wave = |motion: &Kinematics, row: usize| {
            let sign = if row < 3000 { 1.0 } else { second };
            4.0 * sign * (TAU * 500.0 * motion.position_lp[row]).cos()
        };
        let axis = axis(|motion, row| usual(motion, row) + wave(motion, row));
        let bench = axis.bench();
        let output = SlowEffort {
            halves: halves(&axis.motion),
            bench: &bench,
            revolution: 0.01,
        };
        let model = model(&[Inertia, Viscous, Coulomb, Offset]).with(output.part(5));
        let accepts = |share: f64| {
            output.accepts(&Candidate {
                scored: Scored {
                    effect: model.parts[4].called(),
                    parameter: model.parts[4].parameter,
                    gain: Gain {
                        removed: 1.0,
                        share,
                        percent: 1.0,
                        t: 9.0,
                    },
                    physical: true,
                    accepted: false,
                    round: 0,
                },
                model: model.clone(),
            })
        };
        [0.5, 0.01].map(accepts)
    }

    #[test]
    fn an_order_is_accepted_where_it_gains_enough_and_both_halves_agree_about_it() {
        assert_eq!(is_accepted(1.0), [true, false]);
        assert_eq!(is_accepted(-1.0), [false, false]);
    }

    /// 10 mm to and fro at 4 Hz for 14 s: at 6 m/s² the axis passes its reversals within 0.3 ms. A
    /// slower swing brings them to other places.
    fn swinging() -> Axis {
        let sine = |row: u32, hz: f64| (TAU * hz * 1.0e-3 * f64::from(row)).sin();
        let path = |row: u32| 0.01 * sine(row, 4.0) + 0.006 * sine(row, 0.31);
        let mut axis = on(record(1.0e-3, (0..14_000).map(path).collect()));
        axis.dataset.lead_m_per_rev = Some(0.01);
        axis
    }

    fn ripple(axis: &mut Axis, amplitude: f64, order: f64) -> Option<RippleAtReversals> {
        axis.put(|motion, row| {
            let angle = TAU * order / 0.01 * motion.position_lp[row];
            usual(motion, row) + amplitude * angle.cos()
        });
        axis.dataset.validate = axis.dataset.train.clone();
        slow_ripple(
            &axis.dataset,
            &axis.motion,
            &model(&[Inertia, Viscous, Coulomb, Offset]),
        )
    }

    #[test]
    fn an_order_that_shows_about_reversals_is_found_with_its_amplitude() {
        let mut axis = swinging();
        let found = ripple(&mut axis, 4.0, 5.0).expect("ripple");
        assert_eq!(found.fastest, 0.25 * median_speed(&axis.motion));
        assert_eq!(found.cutoff_hz, 30.0);
        let orders: Vec<u32> = found.orders.iter().map(|order| order.per_rev).collect();
        assert!(orders.contains(&5), "{orders:?}");
        let order = found
            .orders
            .iter()
            .find(|order| order.per_rev == 5)
            .unwrap();
        assert!((order.amplitude - 4.0).abs() < 1.0, "{order:?}");
        assert!(found.train_percent.extended < 0.5 * found.train_percent.declared);
        assert!(found.validate_percent.extended < 0.5 * found.validate_percent.declared);
    }

    #[test]
    fn without_ripple_or_without_a_lead_there_is_nothing() {
        assert!(ripple(&mut swinging(), 0.0, 5.0).is_none());
        let mut axis = swinging();
        axis.dataset.lead_m_per_rev = None;
        assert!(ripple(&mut axis, 4.0, 5.0).is_none());
    }
}
