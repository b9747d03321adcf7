//! Start values of the pulse, from the burst of the uncompensated circle: `T_comp` from its width
//! in time, and the product Δn·T_comp (the way that the pulse adds) from the area under it.

use plant_sim::Machine;

use super::TOLERANCE_UM;
use super::valley::SENSIBLE_S;
use crate::ballbar::{self, Point, REVERSALS, apart};
use crate::compensation::Pulse;

/// Way that the pulse adds, over the area under the burst: found on the reference machine, and only
/// a start value.
const WAY_OVER_AREA: f64 = 1.25;
/// A burst that is not ten times the tolerance of the search is noise, µm.
pub const LEAST_PEAK_UM: f64 = 10.0 * TOLERANCE_UM;

/// The pulse to begin with on one axis; `None` where it shows no burst.
pub(super) fn start(
    points: &[Point],
    axis: usize,
    radius_m: f64,
    machine: &Machine,
) -> Option<Pulse> {
    let burst = BurstSize::of_axis(points, axis, radius_m)?;
    let time_constant_s = machine.period_s * burst.samples_at_half_height as f64;
    let area_m_s = 1.0e-6 * burst.sum_um * machine.period_s;
    let way_m = WAY_OVER_AREA * machine.axes.get(axis)?.gains.position_gain_per_s * area_m_s;
    // Pulses about it have to be some that can be tried.
    let time_constant_s = time_constant_s.clamp(2.0 * SENSIBLE_S.start, 0.5 * SENSIBLE_S.end);
    Some(Pulse {
        height_m_per_s: way_m / time_constant_s,
        time_constant_s,
        start_delay_s: 0.0,
    })
}

/// A burst by its size: samples are a cycle apart.
struct BurstSize {
    /// Samples above half of the largest deviation.
    samples_at_half_height: usize,
    /// Sum of all deviations.
    sum_um: f64,
}

impl BurstSize {
    /// The radial deviation from its median about the first reversal of an axis.
    fn of_axis(points: &[Point], axis: usize, radius_m: f64) -> Option<Self> {
        let (at, ..) = REVERSALS.into_iter().find(|(_, of, _)| *of == axis)?;
        let window = ballbar::window_rad(radius_m, 0.0);
        let all = ballbar::about_median_um(points, radius_m);
        let here = points.iter().zip(&all);
        let burst: Vec<f64> = here
            .filter(|(point, _)| apart(point.angle_rad, at) <= window)
            .map(|(_, deviation)| deviation.abs())
            .collect();
        let peak = burst.iter().copied().fold(0.0, f64::max);
        let wide = burst.iter().filter(|size| **size > 0.5 * peak).count();
        (wide > 0 && peak >= LEAST_PEAK_UM).then(|| Self {
            samples_at_half_height: wide,
            sum_um: burst.iter().sum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 0.1;

    /// A turn in 2000 samples, with a rectangle of `um` over `samples` after the reversal of X.
    fn turn(um: f64, samples: u32) -> Vec<Point> {
        let point = |i: u32| {
            let angle_rad = std::f64::consts::TAU * f64::from(i) / 2000.0;
            let bump = if (501..501 + samples).contains(&i) {
                um
            } else {
                0.0
            };
            let radius_m = RADIUS_M + 1.0e-6 * bump;
            let at = [radius_m * angle_rad.sin(), -radius_m * angle_rad.cos()];
            Point {
                angle_rad,
                table_m: at,
                motor_m: at,
                reference_m: at,
            }
        };
        (0..2000).map(point).collect()
    }

    #[test]
    fn the_pulse_begins_as_long_as_the_burst_and_with_its_area() {
        let machine = Machine::reference();
        let start = start(&turn(8.0, 20), 0, RADIUS_M, &machine).unwrap();
        assert!((start.time_constant_s - 20.0 * machine.period_s).abs() < 1.0e-12);
        let expected = WAY_OVER_AREA * machine.axes[0].gains.position_gain_per_s * 8.0e-6;
        assert!((start.height_m_per_s / expected - 1.0).abs() < 1.0e-6);
    }

    #[test]
    fn an_axis_without_a_burst_has_no_start() {
        let machine = Machine::reference();
        assert_eq!(start(&turn(8.0, 20), 1, RADIUS_M, &machine), None);
        assert_eq!(
            start(&turn(0.9 * LEAST_PEAK_UM, 20), 0, RADIUS_M, &machine),
            None
        );
    }
}
