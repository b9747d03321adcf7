//! A loop that oscillates faster than the low-pass lets through.
//!
//! What the position has above the low-pass is a wave where two samples tell the next one,
//! `x[k] = a·x[k−1] + b·x[k−2]` (an autoregressive process of second order: Yule, Phil. Trans. A
//! 226, 1927); an encoder's rounding is none. A wave with more acceleration than all slower motion
//! drives the axis: its friction turns over within the wave, and no column of the fit sees that.
//! Nothing that is fitted on such a record holds.
//!
//! A loop at the edge of its stability rings in parts of a record only, where a wave has far more
//! acceleration than the whole of slower motion and two samples tell nearly all of the next: the
//! rings that impacts leave in a screw die away and are told less well.
//!
//! Units: m or rad, s.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::evidence::reversal::rms;
use crate::evidence::thresholds::{OSCILLATION, STRETCH_LEFT, STRETCH_OSCILLATION, WAVE_LEFT};
use crate::evidence::verdict::Reason;
use crate::motion::bodies::minus;
use crate::motion::derivatives::Derivatives;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// The setpoint asks for a wave where it has more than this part of it.
const ASKED: f64 = 0.5;

/// How long a loop rings that is told by its stretches, s.
const STRETCH_S: f64 = 0.5;

/// A stretch of fewer rows tells no wave.
const FEWEST_ROWS: usize = 50;

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
    /// Of these rows of what is faster than the low-pass; `None` where it is no wave.
    fn of(fast: &[f64], rows: Range<usize>, motion: &Kinematics) -> Option<Self> {
        let inside = |row: &usize| motion.is_inside(*row) && motion.is_inside(row - 2);
        let rows: Vec<usize> = rows.filter(|row| *row >= 2).filter(inside).collect();
        let at = |one: usize, other: usize| {
            let products = rows.iter().map(|row| fast[row - one] * fast[row - other]);
            products.sum::<f64>() / rows.len().max(1) as f64
        };
        let whole = at(0, 0);
        let (lags, next) = ([at(1, 1), at(1, 2), at(2, 2)], [at(0, 1), at(0, 2)]);
        let square = lags[0] * lags[2] - lags[1].powi(2);
        let a = (next[0] * lags[2] - next[1] * lags[1]) / square;
        let b = (next[1] * lags[0] - next[0] * lags[1]) / square;
        let turn = a / (2.0 * (-b).sqrt());
        (whole > 0.0 && turn.abs() < 1.0).then(|| Self {
            hz: turn.acos() / (TAU * motion.period_s),
            rms: whole.sqrt(),
            left: 1.0 - (a * next[0] + b * next[1]) / whole,
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

/// A record, and what of it is faster than the low-pass.
struct Seen<'a> {
    motion: &'a Kinematics,
    record: &'a Record,
    fast: Vec<f64>,
    /// Acceleration below the cut-off.
    slower: Vec<f64>,
}

/// Rows in which a wave drives the axis.
struct Ringing {
    rows: Range<usize>,
    wave: Wave,
    /// Its acceleration over that of all slower motion of the record.
    over: f64,
}

impl<'a> Seen<'a> {
    fn new(dataset: &Dataset, motion: &'a Kinematics, record: &'a Record) -> Self {
        Self {
            motion,
            record,
            fast: minus(&record.position, &motion.low_passed(&record.position)),
            slower: slower_acceleration(dataset, motion, record),
        }
    }

    fn slower_rms(&self, rows: &Range<usize>) -> f64 {
        let inside = |row| rows.contains(&row) && self.motion.is_inside(row);
        let inside: Vec<bool> = (0..self.motion.len()).map(inside).collect();
        rms(&self.slower, &inside)
    }

    /// A wave of the whole record that has more acceleration than its slower motion.
    fn throughout(&self, slower: f64) -> Option<Ringing> {
        let rows = 0..self.fast.len();
        let wave = Wave::of(&self.fast, rows.clone(), self.motion)?;
        let over = wave.acceleration() / slower;
        (wave.left < WAVE_LEFT && over > OSCILLATION).then_some(Ringing { rows, wave, over })
    }

    /// The stretch in which a wave has the most, where that is far more than the record's slower
    /// motion has and more than that of the stretch.
    fn in_a_stretch(&self, slower: f64) -> Option<Ringing> {
        let length = (STRETCH_S / self.motion.period_s) as usize;
        let ringing = |first: usize| {
            let rows = first..first + length;
            let wave = Wave::of(&self.fast, rows.clone(), self.motion)?;
            let over = wave.acceleration() / slower;
            let is_driven = wave.left < STRETCH_LEFT
                && over > STRETCH_OSCILLATION
                && wave.acceleration() > self.slower_rms(&rows);
            is_driven.then_some(Ringing { rows, wave, over })
        };
        if length < FEWEST_ROWS {
            return None;
        }
        let last = self.fast.len().saturating_sub(length);
        let stretches = (0..=last).step_by(length / 2).filter_map(ringing);
        stretches.max_by(|a, b| a.over.total_cmp(&b.over))
    }

    fn ringing(&self) -> Option<Ringing> {
        let slower = self.slower_rms(&(0..self.fast.len()));
        self.throughout(slower)
            .or_else(|| self.in_a_stretch(slower))
    }

    /// The setpoint has the wave too.
    fn is_asked(&self, ringing: &Ringing) -> bool {
        let asked = self.record.reference.as_deref().and_then(|reference| {
            let fast = minus(reference, &self.motion.low_passed(reference));
            Wave::of(&fast, ringing.rows.clone(), self.motion)
        });
        asked.is_some_and(|asked| asked.rms > ASKED * ringing.wave.rms)
    }

    /// When, where that is not throughout.
    fn when(&self, ringing: &Ringing) -> String {
        if ringing.rows.len() == self.fast.len() {
            return String::new();
        }
        let [from, to] = [ringing.rows.start, ringing.rows.end - 1];
        let [from, to] = [from, to].map(|row| self.motion.time_s[row]);
        format!(" from {from:.1} to {to:.1} s")
    }
}

/// A wave that drives the axis on a record.
#[derive(Clone, Debug)]
pub(crate) struct Oscillation {
    /// Frequency, Hz.
    pub hz: f64,
    /// Rms of the position.
    pub rms: f64,
    /// The setpoint has it too: it is no loop's.
    pub is_asked: bool,
    words: String,
}

impl Oscillation {
    /// What is said of it.
    pub(crate) fn reason(&self) -> Reason {
        Reason::unexplained(self.words.clone())
    }
}

/// Whether a wave drives the axis on a record; `what` is the record.
pub(crate) fn seen(
    dataset: &Dataset,
    what: &str,
    motion: &Kinematics,
    record: &Record,
) -> Option<Oscillation> {
    let record = Seen::new(dataset, motion, record);
    let ringing = record.ringing()?;
    let is_asked = record.is_asked(&ringing);
    let (seen, remedy) = if is_asked {
        ("the setpoint swings", "move slower")
    } else {
        ("the loop oscillates", "lower its gains")
    };
    let Wave { hz, rms, .. } = ringing.wave;
    let words = format!(
        "{seen} on the {what} record{}: {hz:.0} Hz, {:.2} {} rms, with {:.1} times the acceleration \
         of all motion below the {:.0} Hz up to which is fitted; {remedy} and record again",
        record.when(&ringing),
        1.0e6 * rms,
        dataset.kind.millionths(),
        ringing.over,
        motion.filter.cutoff_hz
    );
    Some(Oscillation {
        hz,
        rms,
        is_asked,
        words,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::on;
    use crate::simulate::made::{record, two_sines};

    /// What is said of a motion with something on it, at 1 kHz, and with something on its setpoint.
    fn said_of(more: impl Fn(usize) -> f64, asked: impl Fn(usize) -> f64) -> Option<String> {
        let smooth = two_sines(20_000);
        let with = |more: &dyn Fn(usize) -> f64| {
            let rows = smooth.iter().enumerate();
            rows.map(|(row, x)| x + more(row)).collect::<Vec<f64>>()
        };
        let mut made = record(1.0e-3, with(&more));
        made.reference = Some(with(&asked));
        let axis = on(made);
        let seen = seen(&axis.dataset, "training", &axis.motion, &axis.dataset.train)?;
        let reason = seen.reason();
        assert!(reason.counts);
        assert_eq!(seen.is_asked, reason.words.contains("the setpoint swings"));
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
    fn a_wave_of_a_second_is_told_with_its_time() {
        let ring = |size: f64| {
            let wave = wave(150.0, size);
            move |row: usize| {
                if (2000..3000).contains(&row) {
                    wave(row)
                } else {
                    0.0
                }
            }
        };
        let words = said(ring(2.5e-6)).unwrap();
        assert!(
            words.contains("loop oscillates on the training record from 2."),
            "{words}"
        );
        assert_eq!(said(ring(1.2e-6)), None);
    }

    #[test]
    fn a_ring_that_dies_away_after_each_impact_is_no_oscillation() {
        let dying = |row: usize| {
            let since = (row % 250) as f64 * 1.0e-3;
            40.0e-6 * (-since / 0.03).exp() * (TAU * 120.0 * since).sin()
        };
        assert_eq!(
            said(|row| dying(row) * f64::from(u8::from(row > 4000))),
            None
        );
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
        let (smooth, count) = (two_sines(20_000), 20.0e-6);
        let rounded = |row: usize| count * (smooth[row] / count).round() - smooth[row];
        assert_eq!(said(rounded), None);
    }
}
