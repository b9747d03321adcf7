//! What a circle deviates by, cause by cause, as ballbar users know them.
//!
//! Outside the windows about the reversals the radial deviation of a path is a sum; φ is the place
//! on the circle, s the direction (+1 counter-clockwise), ω·R the feed:
//!
//! | cause | in the radial deviation | told from others by |
//! |---|---|---|
//! | centre, radius | cos φ, sin φ, 1 | no error of the axes but for a common scale |
//! | scaling mismatch | ½·(kx − ky)·R·cos 2φ | the same in both directions |
//! | squareness α | ½·α·R·sin 2φ | the same in both directions |
//! | servo mismatch τx − τy | ½·s·ω·R·(τx − τy)·sin 2φ | turns over with the direction |
//! | backlash of X, lost motion | ½·b·s·sgn(sin φ)·cos φ | a step at its reversals |
//! | cyclic error of X | A·cos(2π·x/lead + ψ)·cos φ | its period |
//!
//! They are fitted at once by least squares to both directions. Reversal spikes are the bursts that
//! they leave inside the windows. A burst that takes longer to settle than the loop has until the
//! next reversal hides them all.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::burst::{Deviating, larger};
use super::median::median;
use super::reversals::{REVERSALS, apart};
use super::{Point, radial_um};
use crate::trajectory::MEASURE_FROM_RAD;

/// An axis of the circle.
#[derive(Clone, Debug, PartialEq)]
pub struct CircleAxis {
    /// Its name.
    pub name: String,
    /// Period of its cyclic error: the lead of its screw, m.
    pub lead_m: f64,
}

/// A circle in both directions.
#[derive(Clone, Debug)]
pub struct BothDirections<'a> {
    /// Turns that count.
    pub counter_clockwise: &'a [Point],
    /// The same the other way round.
    pub clockwise: &'a [Point],
    /// Nominal radius, m.
    pub radius_m: f64,
    /// Feed, m/s.
    pub feed_m_per_s: f64,
    /// The axes.
    pub axes: [CircleAxis; 2],
    /// Half width of the window about a reversal in which its burst is looked for, rad.
    pub window_rad: f64,
    /// What is left of a burst after this time is nothing, s.
    pub settling_s: f64,
    /// Whether an instrument at the table sees the circle; scales do not see their own errors.
    pub is_at_table: bool,
}

/// A cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cause {
    /// Its name, with that of its axis.
    pub cause: String,
    /// The circular deviation that it alone would make, µm; none where it was not measured.
    pub um: Option<f64>,
    /// Its share of all of them, percent.
    pub share_percent: Option<f64>,
    /// The same in the unit in which it is mended.
    pub value: Option<f64>,
    /// That unit.
    pub unit: &'static str,
}

/// What a circle deviates by.
#[derive(Clone, Debug, PartialEq)]
pub struct Causes {
    /// The largest first; those that were not measured last.
    pub list: Vec<Cause>,
    /// Largest spike of both directions at 0°, 90°, 180° and 270° of the circle, µm.
    pub spikes_um: [f64; 4],
}

/// The causes of a circle.
#[must_use]
pub fn causes(seen: &BothDirections<'_>) -> Causes {
    let smooth = smooth(seen);
    let spikes_um = spikes_um(seen, smooth.as_ref());
    let mut list = spikes(seen, &spikes_um).to_vec();
    list.extend(smooth.map_or_else(|| not_measured(seen), |smooth| smooth.causes()));
    let sum_um: f64 = list.iter().filter_map(|own| own.um).sum();
    for own in &mut list {
        own.share_percent = own
            .um
            .filter(|_| sum_um > 0.0)
            .map(|um| 100.0 * um / sum_um);
    }
    let size = |own: &Cause| own.um.unwrap_or(-1.0);
    list.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Causes { list, spikes_um }
}

/// Bursts in what the smooth causes leave, the largest of both directions.
fn spikes_um(seen: &BothDirections<'_>, smooth: Option<&Sized<'_>>) -> [f64; 4] {
    let of = |points: &[Point], sense: f64| {
        let left = |point: &Point| {
            let (explained, step) = smooth.map_or((0.0, 0.0), |smooth| smooth.at(point, sense));
            let off_um = radial_um(point, seen.radius_m) - explained;
            // On its way across a gap the table is somewhere between the two sides of the step.
            (off_um.abs() - step).max(0.0).copysign(off_um)
        };
        let left_um: Vec<f64> = points.iter().map(left).collect();
        let path = Deviating {
            points,
            median_um: if smooth.is_some() {
                0.0
            } else {
                median(&left_um)
            },
            deviation_um: &left_um,
            window_rad: seen.window_rad,
            from_rad: MEASURE_FROM_RAD,
        };
        REVERSALS.map(|(at, ..)| path.burst_um(at))
    };
    let forth = of(seen.counter_clockwise, 1.0);
    // Clockwise X is at its near end first.
    let [left, top, right, bottom] = of(seen.clockwise, -1.0);
    let back = [right, top, left, bottom];
    [0, 1, 2, 3].map(|place| larger(forth[place], back[place]))
}

fn spikes(seen: &BothDirections<'_>, spikes_um: &[f64; 4]) -> [Cause; 2] {
    [0, 1].map(|axis| {
        let um = larger(spikes_um[axis], spikes_um[axis + 2]);
        let name = format!("reversal spike {}", seen.axes[axis].name);
        cause(name, Some(um), Some(um), "µm")
    })
}

/// A column of the sum.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Term {
    Radius,
    CentreX,
    CentreY,
    Scaling,
    Squareness,
    Servo,
    Backlash(usize),
    /// Of the wave, in both directions.
    CyclicCos(usize),
    CyclicSin(usize),
    /// What goes with the speed: a loop follows its scale a little late.
    LateCos(usize),
    LateSin(usize),
}

/// Fewer periods of a cyclic error than this on the diameter look like something else.
const LEAST_PERIODS: f64 = 1.3;

fn terms(seen: &BothDirections<'_>) -> Vec<Term> {
    use Term::{
        Backlash, CentreX, CentreY, CyclicCos, CyclicSin, LateCos, LateSin, Radius, Scaling, Servo,
        Squareness,
    };
    let mut terms = vec![Radius, CentreX, CentreY, Scaling, Squareness, Servo];
    terms.extend([Backlash(0), Backlash(1)]);
    for axis in [0, 1] {
        if 2.0 * seen.radius_m >= LEAST_PERIODS * seen.axes[axis].lead_m {
            terms.extend([
                CyclicCos(axis),
                CyclicSin(axis),
                LateCos(axis),
                LateSin(axis),
            ]);
        }
    }
    terms
}

/// A place on the circle, and the direction in which it is passed.
struct Place {
    angle: f64,
    sense: f64,
    /// Of the radius, along each axis.
    along: [f64; 2],
    /// Of the feed, along each axis.
    speed: [f64; 2],
}

impl Place {
    fn of(point: &Point, sense: f64) -> Self {
        let angle = point.reference_m[1].atan2(point.reference_m[0]);
        let (sin, cos) = angle.sin_cos();
        Self {
            angle,
            sense,
            along: [cos, sin],
            speed: [-sense * sin, sense * cos],
        }
    }
}

impl Term {
    /// At a place, for a coefficient of 1 µm.
    fn at(self, seen: &BothDirections<'_>, place: &Place) -> f64 {
        let Place {
            angle,
            sense,
            along,
            speed,
        } = *place;
        let [cos, sin] = along;
        let wave = |axis: usize| TAU * seen.radius_m * along[axis] / seen.axes[axis].lead_m;
        match self {
            Self::Radius => 1.0,
            Self::CentreX => cos,
            Self::CentreY => sin,
            Self::Scaling => (2.0 * angle).cos(),
            Self::Squareness => (2.0 * angle).sin(),
            Self::Servo => sense * (2.0 * angle).sin(),
            // The table hangs behind: −½·sgn(v) along the axis.
            Self::Backlash(0) => 0.5 * sense * sin.signum() * cos,
            Self::Backlash(_) => -0.5 * sense * cos.signum() * sin,
            Self::CyclicCos(axis) => wave(axis).cos() * along[axis],
            Self::CyclicSin(axis) => wave(axis).sin() * along[axis],
            Self::LateCos(axis) => speed[axis] * wave(axis).cos() * along[axis],
            Self::LateSin(axis) => speed[axis] * wave(axis).sin() * along[axis],
        }
    }
}

/// About so many points of each direction are fitted.
const FITTED: usize = 6000;

/// Wider windows leave too little of a circle to tell causes apart, rad: 25°.
const WIDEST_RAD: f64 = FRAC_PI_2 / 3.6;

/// What the circle does outside the bursts; none where they take up too much of it.
fn smooth<'a>(seen: &'a BothDirections<'a>) -> Option<Sized<'a>> {
    if quiet_from_rad(seen) > WIDEST_RAD {
        return None;
    }
    let terms = terms(seen);
    let coefficients = fitted(seen, &terms)?;
    Some(Sized {
        seen,
        terms,
        coefficients,
    })
}

/// Half width of what a burst takes up, rad: the window, or the way until it has settled.
fn quiet_from_rad(seen: &BothDirections<'_>) -> f64 {
    seen.window_rad
        .max(seen.settling_s * seen.feed_m_per_s / seen.radius_m)
}

/// All smooth causes where none could be told.
fn not_measured(seen: &BothDirections<'_>) -> Vec<Cause> {
    let terms = Vec::new();
    let nothing = Sized {
        seen,
        terms,
        coefficients: Vec::new(),
    };
    nothing.causes()
}

/// Terms with their coefficients.
struct Sized<'a> {
    seen: &'a BothDirections<'a>,
    terms: Vec<Term>,
    coefficients: Vec<f64>,
}

impl Sized<'_> {
    fn causes(&self) -> Vec<Cause> {
        let mut list = self.of_both_axes();
        list.extend([0, 1].into_iter().flat_map(|axis| self.of_axis(axis)));
        list
    }

    /// Radial deviation at a point, µm, without what steps at reversals, and that.
    fn at(&self, point: &Point, sense: f64) -> (f64, f64) {
        let (mut smooth, mut steps) = (0.0, 0.0);
        let place = Place::of(point, sense);
        for (term, um) in self.terms.iter().zip(&self.coefficients) {
            let own = um * term.at(self.seen, &place);
            match term {
                Term::Backlash(_) => steps += own.abs(),
                _ => smooth += own,
            }
        }
        (smooth, steps)
    }

    /// Coefficient of a term, µm.
    fn of(&self, term: Term) -> Option<f64> {
        let place = self.terms.iter().position(|own| *own == term)?;
        Some(self.coefficients[place])
    }

    /// The same where it takes an instrument at the table to see it.
    fn at_table(&self, term: Term) -> Option<f64> {
        self.of(term).filter(|_| self.seen.is_at_table)
    }

    fn of_both_axes(&self) -> Vec<Cause> {
        let [x, y] = &self.seen.axes;
        let per_radius = 2.0 / self.seen.radius_m;
        let per_feed = 2.0e-3 / self.seen.feed_m_per_s;
        [
            (
                format!("scaling, {} against {}", x.name, y.name),
                self.at_table(Term::Scaling),
                per_radius,
                "ppm",
            ),
            (
                "squareness".to_owned(),
                self.at_table(Term::Squareness),
                per_radius,
                "µm/m",
            ),
            (
                "servo mismatch".to_owned(),
                self.of(Term::Servo),
                per_feed,
                "ms",
            ),
        ]
        .map(|(name, um, per_um, unit)| {
            cause(
                name,
                um.map(|um| 2.0 * um.abs()),
                um.map(|um| per_um * um),
                unit,
            )
        })
        .into()
    }

    fn of_axis(&self, axis: usize) -> [Cause; 2] {
        let name = &self.seen.axes[axis].name;
        let gap = self.of(Term::Backlash(axis));
        let wave = [
            Term::CyclicCos(axis),
            Term::CyclicSin(axis),
            Term::LateCos(axis),
            Term::LateSin(axis),
        ];
        let squares = wave.map(|term| self.at_table(term).map(|um| um * um));
        let wave = squares.into_iter().sum::<Option<f64>>().map(f64::sqrt);
        [
            cause(format!("backlash {name}"), gap.map(f64::abs), gap, "µm"),
            cause(
                format!("cyclic error {name}"),
                wave.map(|um| 2.0 * um),
                wave,
                "µm",
            ),
        ]
    }
}

fn cause(cause: String, um: Option<f64>, value: Option<f64>, unit: &'static str) -> Cause {
    Cause {
        cause,
        um,
        share_percent: None,
        value,
        unit,
    }
}

/// Coefficients of the terms, µm; none where the points do not tell them apart.
fn fitted(seen: &BothDirections<'_>, terms: &[Term]) -> Option<Vec<f64>> {
    let count = terms.len();
    let mut normal = DMatrix::<f64>::zeros(count, count);
    let mut right = DVector::<f64>::zeros(count);
    for (points, sense) in [(seen.counter_clockwise, 1.0), (seen.clockwise, -1.0)] {
        let stride = (points.len() / FITTED).max(1);
        let quiet = points
            .iter()
            .step_by(stride)
            .filter(|point| is_quiet(seen, point));
        let quiet: Vec<&Point> = quiet.collect();
        // Both directions count the same, however many turns were run.
        let weight = 1.0 / quiet.len().max(1) as f64;
        for point in quiet {
            let place = Place::of(point, sense);
            let row = terms.iter().map(|term| term.at(seen, &place));
            let row = DVector::from_iterator(count, row);
            right += &row * (weight * radial_um(point, seen.radius_m));
            normal += &row * row.transpose() * weight;
        }
    }
    let solved = normal.cholesky()?.solve(&right);
    solved
        .iter()
        .all(|own| own.is_finite())
        .then(|| solved.as_slice().to_vec())
}

/// Outside the windows about the reversals.
fn is_quiet(seen: &BothDirections<'_>, point: &Point) -> bool {
    let angle = point.reference_m[1].atan2(point.reference_m[0]);
    (0..4_u8).all(|quarter| apart(angle, FRAC_PI_2 * f64::from(quarter)) > quiet_from_rad(seen))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Circle;

    const RADIUS_M: f64 = 0.1;
    const FEED_M_PER_S: f64 = 2.0 / 60.0;

    /// What the axes of a machine do wrong, by the setpoint and the direction of travel, m.
    type Wrong = fn([f64; 2], [f64; 2]) -> [f64; 2];

    fn path(sense: f64, wrong: Wrong) -> Vec<Point> {
        let at = |i: u32| {
            let angle = sense * TAU * f64::from(i) / 20_000.0;
            let (sin, cos) = angle.sin_cos();
            let reference_m = [RADIUS_M * cos, RADIUS_M * sin];
            let velocity = [-sense * FEED_M_PER_S * sin, sense * FEED_M_PER_S * cos];
            let error = wrong(reference_m, velocity);
            Point {
                angle_rad: angle.abs(),
                table_m: [0, 1].map(|axis| reference_m[axis] + error[axis]),
                motor_m: reference_m,
                reference_m,
            }
        };
        (0..20_000).map(at).collect()
    }

    fn both<'a>(
        counter_clockwise: &'a [Point],
        clockwise: &'a [Point],
        is_at_table: bool,
    ) -> BothDirections<'a> {
        BothDirections {
            counter_clockwise,
            clockwise,
            radius_m: RADIUS_M,
            feed_m_per_s: FEED_M_PER_S,
            axes: ["X", "Y"].map(|name| CircleAxis {
                name: name.into(),
                lead_m: 0.01,
            }),
            window_rad: 15.0_f64.to_radians(),
            settling_s: 0.0,
            is_at_table,
        }
    }

    fn found(wrong: Wrong, is_at_table: bool) -> Vec<Cause> {
        let [forth, back] = [1.0, -1.0].map(|sense| path(sense, wrong));
        causes(&both(&forth, &back, is_at_table)).list
    }

    /// Each cause alone comes back in its own unit, and nothing else beside it.
    #[test]
    fn each_cause_comes_back_alone() {
        let cases: [(&str, f64, Wrong); 6] = [
            ("scaling, X against Y", 30.0, |at, _| [30.0e-6 * at[0], 0.0]),
            ("squareness", 40.0, |at, _| [40.0e-6 * at[1], 0.0]),
            ("servo mismatch", 0.2, |_, v| [-0.2e-3 * v[0], 0.0]),
            ("backlash X", 8.0, |_, v| [-4.0e-6 * v[0].signum(), 0.0]),
            ("backlash Y", 6.0, |_, v| [0.0, -3.0e-6 * v[1].signum()]),
            ("cyclic error Y", 2.0, |at, _| {
                [0.0, 2.0e-6 * (TAU * at[1] / 0.01 + 0.7).sin()]
            }),
        ];
        for (name, wanted, wrong) in cases {
            let list = found(wrong, true);
            assert_eq!(list[0].cause, name, "{list:?}");
            let value = list[0].value.unwrap();
            assert!((value / wanted - 1.0).abs() < 0.02, "{name}: {value}");
            assert!(list[0].share_percent.unwrap() > 97.0, "{list:?}");
        }
    }

    #[test]
    fn all_at_once_are_told_apart() {
        let list = found(
            |at, v| {
                [
                    30.0e-6 * at[0] + 40.0e-6 * at[1] - 0.2e-3 * v[0] - 4.0e-6 * v[0].signum(),
                    2.0e-6 * (TAU * at[1] / 0.01).sin(),
                ]
            },
            true,
        );
        for (name, wanted) in [
            ("scaling, X against Y", 30.0),
            ("squareness", 40.0),
            ("servo mismatch", 0.2),
            ("backlash X", 8.0),
            ("cyclic error Y", 2.0),
        ] {
            let own = list.iter().find(|own| own.cause == name).unwrap();
            let value = own.value.unwrap();
            assert!((value / wanted - 1.0).abs() < 0.03, "{name}: {value}");
        }
    }

    /// A circle as a machine runs it, with a bump of 5 µm just beyond a place on it.
    fn run(is_counter_clockwise: bool, place_rad: Option<f64>) -> Vec<Point> {
        let circle = Circle {
            radius_m: RADIUS_M,
            feed_m_per_s: FEED_M_PER_S,
            turns: 1,
            counter_clockwise: is_counter_clockwise,
        };
        let at = |i: u32| {
            let time_s = 1.0e-3 * f64::from(i);
            let reference_m = circle.at(time_s);
            let angle = reference_m[1].atan2(reference_m[0]);
            let near = place_rad.is_some_and(|place| apart(angle, place) < 0.02);
            let stretched = 1.0 + if near { 5.0e-6 / RADIUS_M } else { 0.0 };
            Point {
                angle_rad: circle.angle_rad(time_s),
                table_m: reference_m.map(|own| own * stretched),
                motor_m: reference_m,
                reference_m,
            }
        };
        let cycles = (1.0e3 * circle.duration_s()) as u32;
        let measured = MEASURE_FROM_RAD..circle.measure_to_rad();
        let points = (0..cycles).map(at);
        points
            .filter(|point| measured.contains(&point.angle_rad))
            .collect()
    }

    #[test]
    fn a_spike_stands_at_its_place_in_either_direction() {
        for place in 0..4_u8 {
            let angle = FRAC_PI_2 * f64::from(place);
            for clockwise in [false, true] {
                let bump = |is_there: bool| is_there.then_some(angle);
                let (forth, back) = (run(true, bump(!clockwise)), run(false, bump(clockwise)));
                let seen = both(&forth, &back, true);
                let spikes_um = causes(&seen).spikes_um;
                for (other, um) in spikes_um.into_iter().enumerate() {
                    let wanted_um = if other == usize::from(place) {
                        5.0
                    } else {
                        0.0
                    };
                    assert!(
                        (um - wanted_um).abs() < 0.01,
                        "{place} {clockwise}: {spikes_um:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_a_scale_cannot_see_was_not_measured() {
        let list = found(|at, _| [40.0e-6 * at[1], 0.0], false);
        let blind = list.iter().filter(|own| own.um.is_none());
        let blind: Vec<&str> = blind.map(|own| own.cause.as_str()).collect();
        for name in [
            "scaling, X against Y",
            "squareness",
            "cyclic error X",
            "cyclic error Y",
        ] {
            assert!(blind.contains(&name), "{blind:?}");
        }
        assert!(!blind.contains(&"servo mismatch"));
    }
}
