//! What is periodic in position with a period that is not known: `a cos(2π k x) + b sin(2π k x)`
//! times a weight, and half its slope times another:
//!
//! ```text
//! w · wave(x) + ½ r · dwave/dx          ripple of a force: w = 1;  of an inertia: w = a, r = v²
//! ```
//!
//! The wave number k is scanned by the projection of the residual on both columns, which takes one
//! pass over the samples for each k. The least squares of the whole model decide between the best.

use std::f64::consts::PI;
use std::ops::Range;

use super::turning::{RENEWED, Turning, wave};
use super::{Kinematics, Named, Naming, Setting};
use crate::record::dataset::Dataset;

/// The low-pass leaves nothing of faster waves, Hz.
const FASTEST_HZ: f64 = 70.0;
/// The fastest wave that is scanned, at the median velocity, Hz: below that by some margin.
const FASTEST_SCANNED_HZ: f64 = 60.0;
/// The shortest period that is scanned, at the velocity below which nothing moves, s.
const SHORTEST_S: f64 = 0.25;
/// Most wave numbers that are scanned.
const MOST_SCANNED: f64 = 20_000.0;
/// Every so many samples are scanned.
const STRIDE: usize = 4;
/// The scan takes so many steps of k for a period more or less within the travel.
const STEPS_PER_PERIOD: f64 = 4.0;
/// Highest order per revolution that is tried: a tooth or a slot every two degrees.
pub(crate) const HIGHEST_ORDER: u32 = 180;
/// An integer order shows from so many periods within the travel on. Below one the wave is a line
/// and a parabola, and up to here there is no second time that a period could come back for.
pub(crate) const FEWEST_PERIODS_OF_AN_ORDER: f64 = 1.3;
/// A wave that is declared needs no second period to be known: from here on it is no parabola.
pub(crate) const FEWEST_PERIODS_DECLARED: f64 = 0.4;
/// So many of the strongest wave numbers are fitted.
const FITTED: usize = 3;

/// What a wave is multiplied by at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weight {
    /// w, of the wave itself.
    pub wave: f64,
    /// r, of half its slope.
    pub half_slope: f64,
}

impl Weight {
    /// A plain wave.
    pub(crate) const PLAIN: Self = Self {
        wave: 1.0,
        half_slope: 0.0,
    };

    /// Values of both columns at a position.
    #[inline]
    #[must_use]
    pub(crate) fn at(self, k: f64, x: f64) -> [f64; 2] {
        self.on(wave(k, x), k)
    }

    /// The same from cosine and sine there.
    #[inline]
    fn on(self, [cos, sin]: [f64; 2], k: f64) -> [f64; 2] {
        let slope = PI * k * self.half_slope;
        [self.wave * cos - slope * sin, self.wave * sin + slope * cos]
    }
}

/// Both columns over a record, by the weight of each row.
pub(crate) fn columns(
    motion: &Kinematics,
    k: f64,
    weight: impl Fn(usize) -> Weight,
) -> Vec<Vec<f64>> {
    let rows = motion.position_lp.iter().enumerate();
    let values: Vec<[f64; 2]> = rows.map(|(row, x)| weight(row).at(k, *x)).collect();
    [0, 1]
        .map(|place| values.iter().map(|both| both[place]).collect())
        .into()
}

/// `a cos(2π k x) + b sin(2π k x)`.
#[inline]
#[must_use]
pub(crate) fn value(own: &[f64], k: f64, x: f64) -> f64 {
    let [cos, sin] = Weight::PLAIN.at(k, x);
    own[0] * cos + own[1] * sin
}

/// Half the slope of that over position.
#[must_use]
pub(crate) fn half_slope(own: &[f64], k: f64, x: f64) -> f64 {
    let weight = Weight {
        wave: 0.0,
        half_slope: 1.0,
    };
    let [cos, sin] = weight.at(k, x);
    own[0] * cos + own[1] * sin
}

/// √(a² + b²).
#[must_use]
pub(crate) fn amplitude(own: &[f64]) -> f64 {
    own.iter().fold(0.0, |sum, own| own.hypot(sum))
}

/// Way between the ends of the travel.
fn travel(motion: &Kinematics) -> f64 {
    let (low, high) = motion.span();
    high - low
}

/// The wave number of so many periods within the travel.
#[must_use]
pub(crate) fn of_periods(motion: &Kinematics, periods: f64) -> f64 {
    periods / travel(motion)
}

/// How often a wave number has its period within the travel.
#[must_use]
pub(crate) fn periods(motion: &Kinematics, k: f64) -> f64 {
    k * travel(motion)
}

/// Wave numbers of the integer orders per revolution with so many periods within the travel; none
/// where the revolution is not known.
#[must_use]
pub(crate) fn of_orders(motion: &Kinematics, dataset: &Dataset, shown: Range<f64>) -> Vec<f64> {
    let Some(revolution) = dataset.revolution() else {
        return Vec::new();
    };
    let wave_numbers = (1..=HIGHEST_ORDER).map(|order| f64::from(order) / revolution);
    wave_numbers
        .filter(|k| shown.contains(&periods(motion, *k)))
        .collect()
}

/// Wave numbers about those with the strongest projection of the residual, of so many periods
/// within the travel.
pub(crate) fn strongest(
    motion: &Kinematics,
    setting: &Setting<'_>,
    shown: Range<f64>,
    weight: impl Fn(usize) -> Weight,
) -> Vec<f64> {
    let step = of_periods(motion, 1.0 / STEPS_PER_PERIOD);
    let mut samples = samples(motion, setting, step, weight);
    let [from, most] = [shown.start, shown.end].map(|periods| of_periods(motion, periods));
    let Some(to) = shortest(&samples, setting).map(|to| to.min(most)) else {
        return Vec::new();
    };
    let count = ((to - from) / step).clamp(0.0, MOST_SCANNED) as usize;
    let mut scored: Vec<(f64, f64)> = (0..count)
        .map(|i| {
            let k = from + step * i as f64;
            if i % RENEWED == 0 {
                for sample in &mut samples {
                    sample.wave.renew(k);
                }
            }
            (projection(&mut samples, k), k)
        })
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = apart(scored.iter().map(|(_, k)| *k), STEPS_PER_PERIOD * step);
    best.iter()
        .flat_map(|k| (-3..=3).map(move |i| k + 0.25 * step * f64::from(i)))
        .collect()
}

/// A sample of the scan.
struct Sample {
    wave: Turning,
    speed: f64,
    weight: Weight,
    residual: f64,
}

fn samples(
    motion: &Kinematics,
    setting: &Setting<'_>,
    step: f64,
    weight: impl Fn(usize) -> Weight,
) -> Vec<Sample> {
    let rows = (0..motion.len()).step_by(STRIDE);
    let moving = rows.filter(|row| motion.moving[*row]);
    let sample = |row: usize| Sample {
        wave: Turning::new(motion.position_lp[row], step),
        speed: motion.velocity_lp[row].abs(),
        weight: weight(row),
        residual: setting.residual.get(row).copied().unwrap_or(0.0),
    };
    moving.map(sample).collect()
}

/// The largest wave number that the velocities of a record can show.
fn shortest(samples: &[Sample], setting: &Setting<'_>) -> Option<f64> {
    let mut speeds: Vec<f64> = samples.iter().map(|sample| sample.speed).collect();
    speeds.sort_by(f64::total_cmp);
    let median = speeds.get(speeds.len() / 2)?;
    let slowest = setting.dataset.moving_velocity * SHORTEST_S;
    Some((FASTEST_SCANNED_HZ / median).min(1.0 / slowest))
}

/// The first of a list, each so far from those before.
fn apart(list: impl Iterator<Item = f64>, distance: f64) -> Vec<f64> {
    let mut best: Vec<f64> = Vec::new();
    for k in list {
        if best.iter().all(|known| (known - k).abs() > distance) {
            best.push(k);
        }
        if best.len() == FITTED {
            break;
        }
    }
    best
}

/// Sum of squares that both columns of a wave number take out of the residual; the samples go on to
/// the next wave number.
fn projection(samples: &mut [Sample], k: f64) -> f64 {
    let (mut cc, mut ss, mut cs, mut ce, mut se) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for sample in samples {
        let wave = sample.wave.at;
        sample.wave.turn();
        if sample.speed * k >= FASTEST_HZ {
            continue;
        }
        let ([cos, sin], e) = (sample.weight.on(wave, k), sample.residual);
        cc += cos * cos;
        ss += sin * sin;
        cs += cos * sin;
        ce += cos * e;
        se += sin * e;
    }
    let determinant = cc * ss - cs * cs;
    if determinant <= 1.0e-3 * cc * ss {
        0.0
    } else {
        (ce * ce * ss - 2.0 * ce * se * cs + se * se * cc) / determinant
    }
}

/// What a wave is called in a report.
pub(crate) struct Names<'a> {
    /// Its amplitude.
    pub amplitude: &'a str,
    /// Begin of the names of period, order and phase.
    pub rest: &'a str,
}

/// Amplitude, period, order per revolution (where a revolution is known) and phase.
pub(crate) fn named(naming: &Naming<'_>, names: &Names<'_>, unit: String) -> Vec<Named> {
    let (a, b) = (
        naming.coefficient("", 0, String::new()),
        naming.coefficient("", 1, String::new()),
    );
    let half = |named: &Named| named.half_width.unwrap_or(0.0);
    let (size, half_width) = (a.value.hypot(b.value), half(&a).hypot(half(&b)));
    let name = |what: &str| format!("{}_{what}", names.rest);
    let amplitude = Named {
        name: names.amplitude.into(),
        value: size,
        half_width: Some(half_width),
        unit,
    };
    let k = naming.parameter;
    let revolution = naming.dataset.revolution();
    let order = revolution.map(|way| naming.nonlinear(&name("order"), k * way, "per rev".into()));
    let period = naming.nonlinear(&name("period"), 1.0 / k, naming.length().into());
    // a cos θ + b sin θ = A sin(θ + φ).
    let phase = Named {
        name: name("phase"),
        value: a.value.atan2(b.value),
        half_width: Some(half_width / size.max(f64::MIN_POSITIVE)),
        unit: "rad".into(),
    };
    let all = [Some(amplitude), Some(period), order, Some(phase)];
    all.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, usual};
    use crate::record::units::AxisKind;
    use std::f64::consts::TAU;

    #[test]
    fn a_value_and_half_its_slope_are_those_of_the_wave() {
        let (own, k, x) = ([3.0, -2.0], 40.0, 0.013);
        let exact = |x: f64| 3.0 * (TAU * k * x).cos() - 2.0 * (TAU * k * x).sin();
        assert!((value(&own, k, x) - exact(x)).abs() < 1.0e-12);
        let step = 1.0e-7;
        let slope = (exact(x + step) - exact(x - step)) / (2.0 * step);
        assert!((half_slope(&own, k, x) - 0.5 * slope).abs() < 1.0e-4);
        assert!((amplitude(&own) - 13.0_f64.sqrt()).abs() < 1.0e-12);
    }

    #[test]
    fn of_a_list_the_first_three_are_taken_that_are_apart() {
        let list = [5.0, 5.5, 9.0, 4.0, 2.0, 20.0];
        assert_eq!(apart(list.into_iter(), 1.0), [5.0, 9.0, 2.0]);
        assert_eq!(apart([1.0, 1.2].into_iter(), 1.0), [1.0]);
    }

    #[test]
    fn integer_orders_are_candidates_from_1_3_periods_to_where_the_search_begins() {
        let mut axis = axis(usual);
        let shown = FEWEST_PERIODS_OF_AN_ORDER..8.0;
        let orders = |axis: &Axis| -> Vec<f64> {
            let list = of_orders(&axis.motion, &axis.dataset, shown.clone()).into_iter();
            list.map(|k| k * axis.dataset.revolution().unwrap())
                .collect()
        };
        assert!(of_orders(&axis.motion, &axis.dataset, shown.clone()).is_empty());
        for (turns, wanted) in [
            (0.65, (2, 12)),
            (1.29, (2, 6)),
            (1.31, (1, 6)),
            (3.99, (1, 2)),
            (9.0, (1, 0)),
        ] {
            axis.dataset.lead_m_per_rev = Some(travel(&axis.motion) / turns);
            let wanted: Vec<f64> = (wanted.0..=wanted.1).map(f64::from).collect();
            let orders = orders(&axis);
            assert_eq!(orders.len(), wanted.len(), "{turns}: {orders:?}");
            let pairs = orders.iter().zip(&wanted);
            assert!(
                pairs
                    .into_iter()
                    .all(|(order, wanted)| (order - wanted).abs() < 1.0e-9)
            );
        }
        // An axis that turns has a revolution of its own; its 0.05 rad show orders from 180 on.
        axis.dataset.kind = AxisKind::Rotary;
        let least = FEWEST_PERIODS_OF_AN_ORDER * TAU / travel(&axis.motion);
        let first = orders(&axis).first().copied();
        assert_eq!(first, (least <= 180.0).then(|| least.ceil()));
    }
}
