//! What rounding of the positions does to a stiffness by the effort.
//!
//! The effort is fitted with motor − load as it was measured, and what encoders round is in it. A
//! fit takes it for motion: where it is a part ρ of what is left of the wind-up beside the other
//! columns, the spring comes out softer by that part, and what else goes with the wind-up gets the
//! rest. A bend of the motor's own friction leaves hardly any of it: of a table of 20 kg before a
//! motor of 1 µm a count, wound up by 1.5 µm, a fifth of the square is rounding, and the motor had
//! 2.9 ± 1.2 N of friction that it has not.

use super::columns::Apart;
use super::smallest::Smallest;
use crate::evidence::force_noise::white;
use crate::fit::blocks::Blocks;
use crate::fit::rows::Rows;

/// Where rounding is more than this part of what is there, it is all of it.
const ALL: f64 = 0.99;

/// Mean square of an error that is anything up to half a step to either side, in steps squared.
const UNIFORM: f64 = 1.0 / 12.0;

/// Sum of squares of what rounding puts into motor − load, low-passed, at the rows that are judged.
/// An axis that crosses fewer counts than the low-pass lets through keeps all of it; else it is as
/// good as white.
pub(super) fn in_the_difference(apart: &Apart<'_>, smallest: Smallest) -> f64 {
    let motion = apart.motion;
    let passes = white(&motion.filter);
    let of_count = |count: f64| {
        let slowest = count * motion.filter.cutoff_hz;
        let judged = motion.velocity_lp.iter().zip(&apart.mask);
        let parts = judged.filter(|(_, mask)| **mask).map(|(velocity, _)| {
            if velocity.abs() < slowest {
                1.0
            } else {
                passes
            }
        });
        UNIFORM * count.powi(2) * parts.sum::<f64>()
    };
    of_count(smallest.count) + of_count(smallest.motor_count)
}

/// By which share a stiffness is too small that is fitted to such a wind-up beside other columns,
/// where rounding has such a sum of squares in it.
pub(super) fn softens(rounding: f64, wound: &[f64], others: &Rows) -> f64 {
    let left = Blocks::toward(others, wound).fit().sse;
    let rounding = rounding.min(ALL * left);
    if rounding > 0.0 {
        rounding / (left - rounding)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::carried::tests::{apart, axis};
    use super::*;
    use crate::fit::made::on;
    use crate::motion::dot::dot;

    const COUNT_M: f64 = 2.0e-6;
    const ROWS: usize = 6000;

    #[test]
    fn what_a_motor_encoder_rounds_is_as_much_as_is_said() {
        let exact = axis(|_| 0.0);
        let mut record = exact.dataset.train.clone();
        for position in &mut record.position {
            *position = COUNT_M * (*position / COUNT_M).round();
        }
        let rounded = on(record);
        let (exact, rounded) = (apart(&exact), apart(&rounded));
        let pairs = rounded.raw.iter().zip(exact.raw);
        let error: Vec<f64> = pairs.map(|(rounded, exact)| rounded - exact).collect();
        let error = rounded.motion.low_passed(&error).into_iter();
        let judged = error.zip(&rounded.mask).filter(|(_, mask)| **mask);
        let is: f64 = judged.map(|(error, _)| error * error).sum();
        let smallest = |motor_count: f64| Smallest {
            count: 0.0,
            motor_count,
            velocity: 0.0,
        };
        let said = in_the_difference(&rounded, smallest(COUNT_M));
        assert!((0.7..1.5).contains(&(said / is)), "{said} for {is}");
        assert_eq!(in_the_difference(&rounded, smallest(0.0)), 0.0);
    }

    #[test]
    fn a_stiffness_is_softer_by_the_part_of_the_wind_up_that_is_rounded() {
        let wave = |turns: f64| {
            let at = move |row: usize| (std::f64::consts::TAU * turns * row as f64 / 6000.0).sin();
            (0..ROWS).map(at).collect::<Vec<f64>>()
        };
        let (wound, rounding) = (wave(7.0), wave(61.0));
        let rounding: Vec<f64> = rounding.iter().map(|error| 0.5 * error).collect();
        let measured: Vec<f64> = wound.iter().zip(&rounding).map(|(w, e)| w + e).collect();
        let (ones, all) = (vec![1.0; ROWS], vec![true; ROWS]);
        let rows = |columns: &[&[f64]]| Rows::new(columns, &wound, &all, 1.0e-3);
        let fit = Blocks::with(&rows(&[&ones, &measured]), &[]).fit();
        let softer = softens(dot(&rounding, &rounding), &measured, &rows(&[&ones]));
        // A fifth of the square is rounding; rows near the ends of a block are left out of a fit.
        assert!((0.25..0.28).contains(&softer), "{softer}");
        assert!((fit.coefficients[1] * (1.0 + softer) - 1.0).abs() < 0.03);
        assert_eq!(softens(0.0, &measured, &rows(&[&ones])), 0.0);
    }
}
