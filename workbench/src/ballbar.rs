//! What a ballbar shows of a reference circle: reversal bursts, and the figures of ISO 230-4.
//!
//! Deviation is that of the table's true position; where no instrument sees it (over a cable), that
//! of the load scale. All figures in µm.
//!
//! - burst at a reversal: largest |radial deviation − median| within ±max(15°, 1.5·√(2·gap/R)) of
//!   it, mean of the turns;
//! - circular deviation G: smallest separation of two circles about the least-squares centre that
//!   enclose the path of all turns;
//! - radial deviations Fmax and Fmin: from the nominal radius about the nominal centre;
//! - circular hysteresis H: largest difference of the radii of a clockwise and a counter-clockwise
//!   path;
//! - step of an axis: width between the two directions of table − motor at equal motor position;
//! - ellipse: second harmonic of the deviation outside the bursts, from different gains of the
//!   axes.

mod burst;
mod causes;
mod ellipse;
mod median;
mod point;
mod reversals;
mod roundness;
mod step;

use serde::Serialize;

use burst::Deviating;
pub use burst::larger;
use ellipse::ellipse_um;
use step::step_um;

pub use causes::{BothDirections, Cause, Causes, CircleAxis, causes};
pub use median::median;
pub use point::{Point, radial_um};
pub use reversals::{REVERSALS, apart, window_rad};
pub use roundness::{circular_deviation_um, hysteresis_um, zone_m};

/// Figures of one circle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircleFigures {
    /// Burst at each reversal, in the order of [`REVERSALS`].
    pub peak_um: [f64; 4],
    /// Largest of them.
    pub peak_max_um: f64,
    /// Circular deviation G.
    pub circular_deviation_g_um: f64,
    /// Circular hysteresis H; `None` where only one direction was run.
    pub circular_hysteresis_h_um: Option<f64>,
    /// Largest radial deviation.
    pub radial_deviation_fmax_um: f64,
    /// Smallest radial deviation.
    pub radial_deviation_fmin_um: f64,
    /// Step of X and Y.
    pub step_um: [f64; 2],
    /// Amplitude of the ellipse.
    pub ellipse_um: f64,
    /// Median radial deviation.
    pub median_um: f64,
}

/// Radial deviations of a path from their median, µm.
#[must_use]
pub fn about_median_um(points: &[Point], radius_m: f64) -> Vec<f64> {
    let deviations = points.iter().map(|point| radial_um(point, radius_m));
    let deviations: Vec<f64> = deviations.collect();
    let median_um = median(&deviations);
    deviations.into_iter().map(|own| own - median_um).collect()
}

/// Figures of the turns that count.
///
/// `backlash_m` widens the window about the reversals. An empty path gives zeros, and `NaN` for its
/// roundness.
#[must_use]
pub fn figures(points: &[Point], radius_m: f64, backlash_m: f64, from_rad: f64) -> CircleFigures {
    let deviation: Vec<f64> = points
        .iter()
        .map(|point| radial_um(point, radius_m))
        .collect();
    let path = Deviating {
        points,
        deviation_um: &deviation,
        median_um: median(&deviation),
        window_rad: window_rad(radius_m, backlash_m),
        from_rad,
    };
    let peak_um = REVERSALS.map(|(at, ..)| path.burst_um(at));
    CircleFigures {
        peak_um,
        peak_max_um: peak_um.into_iter().fold(0.0, larger),
        circular_deviation_g_um: circular_deviation_um(points),
        circular_hysteresis_h_um: None,
        radial_deviation_fmax_um: deviation.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        radial_deviation_fmin_um: deviation.iter().copied().fold(f64::INFINITY, f64::min),
        step_um: [0, 1].map(|axis| step_um(points, axis, radius_m)),
        ellipse_um: ellipse_um(points, &deviation, path.window_rad),
        median_um: path.median_um,
    }
}

impl CircleFigures {
    /// Largest burst of each axis, µm.
    #[must_use]
    pub fn axis_bursts_um(&self) -> [f64; 2] {
        let of = |axis: usize| {
            let own = REVERSALS
                .iter()
                .zip(self.peak_um)
                .filter(|((_, of, _), _)| *of == axis);
            own.map(|(_, peak)| peak).fold(0.0, f64::max)
        };
        [of(0), of(1)]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::reversals::apart;
    use super::*;
    use crate::trajectory::MEASURE_FROM_RAD;

    fn path(shape: impl Fn(f64) -> f64) -> Vec<Point> {
        (0..60_000)
            .map(|i| {
                let angle = MEASURE_FROM_RAD + 6.0 * std::f64::consts::PI * f64::from(i) / 60_000.0;
                let radius = 0.1 + shape(angle) * 1.0e-6;
                let at = [radius * angle.sin(), -radius * angle.cos()];
                Point {
                    angle_rad: angle,
                    table_m: at,
                    motor_m: at,
                    reference_m: at,
                }
            })
            .collect()
    }

    #[test]
    fn a_perfect_circle_has_no_deviation() {
        let figures = figures(&path(|_| 0.0), 0.1, 0.0, MEASURE_FROM_RAD);
        assert!(figures.peak_max_um < 1.0e-6 && figures.circular_deviation_g_um < 1.0e-6);
    }

    #[test]
    fn a_burst_is_found_at_its_reversal_and_nowhere_else() {
        let bump = |angle: f64| 12.0 * (-(apart(angle, FRAC_PI_2 + 0.05) / 0.02).powi(2)).exp();
        let figures = figures(&path(bump), 0.1, 0.0, MEASURE_FROM_RAD);
        assert!(
            (figures.peak_um[0] - 12.0).abs() < 0.01,
            "{:?}",
            figures.peak_um
        );
        assert!(figures.peak_um[1..].iter().all(|peak| *peak < 0.01));
        assert!(
            (figures.circular_deviation_g_um - 12.0).abs() < 0.5
                && (figures.radial_deviation_fmax_um - 12.0).abs() < 0.01
        );
    }

    #[test]
    fn an_ellipse_is_told_apart_from_bursts() {
        let figures = figures(
            &path(|angle| 3.0 * (2.0 * angle).cos()),
            0.1,
            0.0,
            MEASURE_FROM_RAD,
        );
        assert!(
            (figures.ellipse_um - 3.0).abs() < 0.01,
            "{}",
            figures.ellipse_um
        );
    }

    #[test]
    fn a_path_that_one_direction_widens_has_that_hysteresis() {
        let widened = path(|_| 2.5);
        let h_um = hysteresis_um(&path(|_| 0.0), &widened, 0.1);
        assert!((h_um - 2.5).abs() < 0.01, "{h_um}");
    }

    #[test]
    fn the_bursts_of_an_axis_are_those_of_its_own_reversals() {
        let bump = |at: f64, um: f64| {
            move |angle: f64| um * (-(apart(angle, at + 0.05) / 0.02).powi(2)).exp()
        };
        let (x, y) = (bump(FRAC_PI_2, 12.0), bump(2.0 * FRAC_PI_2, 7.0));
        let figures = figures(
            &path(|angle| x(angle) + y(angle)),
            0.1,
            0.0,
            MEASURE_FROM_RAD,
        );
        let [x_um, y_um] = figures.axis_bursts_um();
        assert!(
            (x_um - 12.0).abs() < 0.01 && (y_um - 7.0).abs() < 0.01,
            "{x_um} {y_um}"
        );
    }
}
