//! A loop that oscillates faster than the low-pass lets through.
//!
//! What the position has above the low-pass is a wave where two samples tell the next one,
//! `x[k] = a·x[k−1] + b·x[k−2]` (an autoregressive process of second order: Yule, Phil. Trans. A
//! 226, 1927); an encoder's rounding is none. A wave with more acceleration than all slower motion
//! drives the axis: its friction turns over within the wave, and no column of the fit sees that.
//! Nothing that is fitted on such a record holds.
//!
//! Units: m or rad, s.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::evidence::reversal::rms;
use crate::evidence::thresholds::{OSCILLATION, WAVE_LEFT};
use crate::evidence::verdict::Reason;
use crate::motion::bodies::minus;
use crate::motion::derivatives::Derivatives;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// The setpoint asks for a wave where it has more than this part of it.
const ASKED: f64 = 0.5;

/// What moves faster than the low-pass.
#[derive(Clone, Copy, Debug)]
struct Wave {
    /// Frequency, Hz.
    hz: f64,
    /// Rms of the position.
    rms: f64,
    /// Part of its square that two samples do not tell of the next one.
    left: f64,
}

impl Wave {
    /// Of a record with such positions.
    fn of(motion: &Kinematics, position: &[f64]) -> Option<Self> {
        let fast = minus(position, &motion.low_passed(position));
        let inside = |row: &usize| motion.is_inside(*row) && motion.is_inside(row - 2);
        let rows: Vec<usize> = (2..fast.len()).filter(inside).collect();
        let at = |lag: usize| {
            let products = rows.iter().map(|row| fast[*row] * fast[row - lag]);
            products.sum::<f64>() / rows.len().max(1) as f64
        };
        let (whole, one, two) = (at(0), at(1) / at(0), at(2) / at(0));
        // The Yule–Walker equations of two lags.
        let square = 1.0 - one.powi(2);
        let [a, b] = [one * (1.0 - two), two - one.powi(2)].map(|c| c / square);
        let turn = a / (2.0 * (-b).sqrt());
        (whole > 0.0 && turn.abs() < 1.0).then(|| Self {
            hz: turn.acos() / (TAU * motion.period_s),
            rms: whole.sqrt(),
            left: 1.0 - a * one - b * two,
        })
    }

    fn acceleration(self) -> f64 {
        (TAU * self.hz).powi(2) * self.rms
    }
}

/// Acceleration below the cut-off, from plain differences: sharpened ones would let more of a wave
/// beyond it through.
fn slower_acceleration(dataset: &Dataset, motion: &Kinematics, record: &Record) -> Vec<f64> {
    if !dataset.is_sharpened {
        return motion.acceleration_lp.clone();
    }
    let of_piece = |piece: Range<usize>| {
        Derivatives::new(&record.position[piece], motion.period_s, dataset.hold).acceleration
    };
    let pieces = motion.pieces.iter().cloned();
    motion.low_passed(&pieces.flat_map(of_piece).collect::<Vec<f64>>())
}

/// What is said of a record on which a wave drives the axis; `what` is the record.
pub(crate) fn reason(
    dataset: &Dataset,
    what: &str,
    motion: &Kinematics,
    record: &Record,
) -> Option<Reason> {
    let wave = Wave::of(motion, &record.position)?;
    let inside: Vec<bool> = (0..motion.len()).map(|row| motion.is_inside(row)).collect();
    let slower = rms(&slower_acceleration(dataset, motion, record), &inside);
    if wave.left >= WAVE_LEFT || wave.acceleration() <= OSCILLATION * slower {
        return None;
    }
    let asked = record.reference.as_deref();
    let asked = asked.and_then(|reference| Wave::of(motion, reference));
    let (seen, remedy) = if asked.is_some_and(|asked| asked.rms > ASKED * wave.rms) {
        ("the setpoint swings", "move slower")
    } else {
        ("the loop oscillates", "lower its gains")
    };
    Some(Reason::unexplained(format!(
        "{seen} on the {what} record: {:.0} Hz, {:.2} {} rms, with more acceleration than all \
         motion below the {:.0} Hz up to which is fitted; {remedy} and record again",
        wave.hz,
        1.0e6 * wave.rms,
        dataset.kind.millionths(),
        motion.filter.cutoff_hz
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::on;
    use crate::simulate::made::{record, two_sines};

    /// What is said of a motion with something on it, at 1 kHz, and with something on its setpoint.
    fn said_of(more: impl Fn(usize) -> f64, asked: impl Fn(usize) -> f64) -> Option<String> {
        let smooth = two_sines(6000);
        let with = |more: &dyn Fn(usize) -> f64| {
            let rows = smooth.iter().enumerate();
            rows.map(|(row, x)| x + more(row)).collect::<Vec<f64>>()
        };
        let mut made = record(1.0e-3, with(&more));
        made.reference = Some(with(&asked));
        let axis = on(made);
        let reason = reason(&axis.dataset, "training", &axis.motion, &axis.dataset.train)?;
        assert!(reason.counts);
        Some(reason.words)
    }

    fn said(more: impl Fn(usize) -> f64) -> Option<String> {
        said_of(more, |_| 0.0)
    }

    fn wave(hz: f64, amplitude: f64) -> impl Fn(usize) -> f64 {
        move |row| amplitude * (TAU * hz * 1.0e-3 * row as f64).sin()
    }

    #[test]
    fn a_wave_that_drives_the_axis_is_told_with_its_frequency_and_size() {
        let words = said(wave(150.0, 40.0e-6)).unwrap();
        assert!(
            words.contains("loop oscillates on the training record: 150 Hz, 27"),
            "{words}"
        );
        let words = said_of(wave(150.0, 40.0e-6), wave(150.0, 60.0e-6)).unwrap();
        assert!(words.contains("the setpoint swings on"), "{words}");
    }

    #[test]
    fn a_wave_is_told_beside_a_sharpened_motion_too() {
        let smooth = two_sines(6000);
        let wave = wave(112.0, 4.0e-6);
        let path = smooth.iter().enumerate().map(|(row, x)| x + wave(row));
        let mut axis = on(record(1.0e-3, path.collect()));
        let plain = slower_acceleration(&axis.dataset, &axis.motion, &axis.dataset.train);
        assert_eq!(plain, axis.motion.acceleration_lp);
        axis.dataset.is_sharpened = true;
        let motion = Kinematics::new(&axis.dataset, &axis.dataset.train).unwrap();
        assert_ne!(motion.acceleration_lp, plain);
        let still = slower_acceleration(&axis.dataset, &motion, &axis.dataset.train);
        assert_eq!(still, plain);
    }

    #[test]
    fn a_small_wave_a_slow_one_and_rounding_do_not_drive_it() {
        assert_eq!(said(|_| 0.0), None);
        assert_eq!(said(wave(150.0, 0.4e-6)), None);
        assert_eq!(said(wave(30.0, 40.0e-6)), None);
        let (smooth, count) = (two_sines(6000), 20.0e-6);
        let rounded = |row: usize| count * (smooth[row] / count).round() - smooth[row];
        assert_eq!(said(rounded), None);
    }
}
