//! What of a run gets into a file: encoders, the log of the effort, time stamps.

use std::f64::consts::TAU;

use crate::draw::Draw;
use crate::drive::rounded;

/// An error that is periodic in position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Amplitude, m or rad.
    pub amplitude: f64,
    /// Way from one period to the next, m or rad.
    pub period: f64,
    /// Phase at position zero, rad.
    pub phase: f64,
}

/// What becomes of a fraction of a count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// Cut off: a counter.
    Down,
    /// To the nearest: an interpolator.
    Nearest,
}

/// An encoder: position plus errors of its scale, in whole counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoder {
    /// One count, m or rad.
    pub resolution: f64,
    /// What becomes of a fraction.
    pub rounding: Rounding,
    /// Errors of the scale: within a signal period (sub-divisional), over a pitch, over a turn
    /// (eccentricity).
    pub waves: Vec<Wave>,
}

impl Encoder {
    /// An encoder without errors of its scale.
    #[must_use]
    pub fn of(resolution: f64, rounding: Rounding) -> Self {
        Self {
            resolution,
            rounding,
            waves: Vec::new(),
        }
    }

    /// A rotary encoder by its counts per revolution.
    #[must_use]
    pub fn counts(per_revolution: f64) -> Self {
        Self::of(TAU / per_revolution, Rounding::Down)
    }

    /// With an error of its scale.
    #[must_use]
    pub fn with(mut self, wave: Wave) -> Self {
        self.waves.push(wave);
        self
    }

    /// What it shows.
    #[must_use]
    pub fn read(&self, position: f64) -> f64 {
        let off = |w: &Wave| w.amplitude * libm::sin(TAU * position / w.period + w.phase);
        let seen = position + self.waves.iter().map(off).sum::<f64>();
        let counts = seen / self.resolution;
        let whole = match self.rounding {
            Rounding::Down => counts.floor(),
            Rounding::Nearest => counts.round(),
        };
        whole * self.resolution
    }
}

/// Which effort is logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The command of the controller, which holds for a period.
    Command,
    /// The current that the drive measures, at the time of the row.
    Current,
}

/// Noise of the effort, N or N m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// White: deviation.
    pub white: f64,
    /// 1/f: deviation.
    pub pink: f64,
    /// Mains: amplitude at 50 Hz.
    pub mains: f64,
}

/// Spikes in the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outliers {
    /// How many.
    pub count: usize,
    /// Size, N or N m.
    pub size: f64,
}

/// The log of the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffortLog {
    /// Which effort.
    pub source: Source,
    /// Noise.
    pub noise: Noise,
    /// Step of the recorded numbers, N or N m; zero where there is none.
    pub quantum: f64,
    /// How much later than it acted it is recorded, s; negative for earlier.
    pub late_s: f64,
    /// How much faster its clock goes than that of the position, as a share.
    pub clock_share: f64,
    /// Spikes.
    pub outliers: Option<Outliers>,
}

impl EffortLog {
    /// A log with white noise.
    #[must_use]
    pub fn of(source: Source, white: f64) -> Self {
        let noise = Noise {
            white,
            ..Noise::default()
        };
        Self {
            source,
            noise,
            quantum: 0.0,
            late_s: 0.0,
            clock_share: 0.0,
            outliers: None,
        }
    }
}

/// Time stamps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stamps {
    /// Deviation of the time of a row from its place, s; the stamp says the true time.
    pub jitter_s: f64,
    /// Share of rows that are lost.
    pub lost_share: f64,
}

/// A run, step by step; index × step is the time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Step, s.
    pub step_s: f64,
    /// Setpoint.
    pub reference: Vec<f64>,
    /// True position of the motor.
    pub motor: Vec<f64>,
    /// True velocity of the motor.
    pub velocity: Vec<f64>,
    /// True position of the load.
    pub load: Vec<f64>,
    /// Command of the controller.
    pub command: Vec<f64>,
    /// Current of the drive.
    pub current: Vec<f64>,
}

/// What a screw grows by from the start of the record while it warms up: the load is further from
/// zero than the motor says by share · (1 − exp(−t/τ)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// Share in the end.
    pub share: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
}

impl Growth {
    fn factor(&self, time_s: f64) -> f64 {
        1.0 + self.share * (1.0 - libm::exp(-time_s / self.time_constant_s))
    }
}

/// What is recorded, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensing {
    /// Steps of a row.
    pub steps_per_row: usize,
    /// Encoder of the motor.
    pub motor: Encoder,
    /// Scale of the load.
    pub load: Option<Encoder>,
    /// How the load moves away from the motor, where it does.
    pub growth: Option<Growth>,
    /// Whether the setpoint is recorded.
    pub reference: bool,
    /// Resolution of the recorded velocity, where it is.
    pub velocity: Option<f64>,
    /// Log of the effort.
    pub effort: EffortLog,
    /// Time stamps.
    pub stamps: Stamps,
}

/// The columns of a record, in the units of the axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// Time stamps, s.
    pub time_s: Vec<f64>,
    /// Setpoint.
    pub reference: Option<Vec<f64>>,
    /// Motor position.
    pub position: Vec<f64>,
    /// Velocity.
    pub velocity: Option<Vec<f64>>,
    /// Load position.
    pub load: Option<Vec<f64>>,
    /// Effort.
    pub effort: Vec<f64>,
}

impl Sensing {
    /// The record of a run.
    #[must_use]
    pub fn record(&self, trace: &Trace, draw: &mut Draw) -> Columns {
        let rows = self.rows(trace, draw);
        let seen = |values: &[f64], encoder: &Encoder| -> Vec<f64> {
            rows.iter().map(|row| encoder.read(values[*row])).collect()
        };
        let velocity = |resolution: f64| -> Vec<f64> {
            let shown = |row: &usize| rounded(trace.velocity[*row], resolution);
            rows.iter().map(shown).collect()
        };
        Columns {
            time_s: rows.iter().map(|row| *row as f64 * trace.step_s).collect(),
            reference: self
                .reference
                .then(|| rows.iter().map(|row| trace.reference[*row]).collect()),
            position: seen(&trace.motor, &self.motor),
            velocity: self.velocity.map(velocity),
            load: self
                .load
                .as_ref()
                .map(|scale| self.load(trace, scale, &rows)),
            effort: self.effort.logged(trace, &rows, draw),
        }
    }

    fn load(&self, trace: &Trace, scale: &Encoder, rows: &[usize]) -> Vec<f64> {
        let grown = |row: usize| {
            let time_s = row as f64 * trace.step_s;
            self.growth.map_or(1.0, |growth| growth.factor(time_s))
        };
        let shown = |row: &usize| scale.read(grown(*row) * trace.load[*row]);
        rows.iter().map(shown).collect()
    }

    /// Which steps are recorded.
    fn rows(&self, trace: &Trace, draw: &mut Draw) -> Vec<usize> {
        let jitter_steps = self.stamps.jitter_s / trace.step_s;
        // A row keeps its place among its neighbours.
        let most = 0.45 * self.steps_per_row as f64;
        let mut rows = Vec::new();
        for place in (0..trace.motor.len()).step_by(self.steps_per_row) {
            let off = (jitter_steps * draw.normal()).clamp(-most, most);
            let lost = draw.between(0.0, 1.0) < self.stamps.lost_share;
            let step = (place as f64 + off).round().max(0.0) as usize;
            if !lost && step < trace.motor.len() {
                rows.push(step);
            }
        }
        rows
    }
}

impl EffortLog {
    fn logged(&self, trace: &Trace, rows: &[usize], draw: &mut Draw) -> Vec<f64> {
        let source = match self.source {
            Source::Command => &trace.command,
            Source::Current => &trace.current,
        };
        let last = source.len() as f64 - 1.0;
        let of_row = |row: &usize| {
            let at = *row as f64 * (1.0 + self.clock_share) - self.late_s / trace.step_s;
            source[at.round().clamp(0.0, last) as usize]
        };
        let times: Vec<f64> = rows.iter().map(|row| *row as f64 * trace.step_s).collect();
        let noise = self.noise.of(&times, draw);
        let mut effort: Vec<f64> = rows.iter().map(of_row).collect();
        for (value, off) in effort.iter_mut().zip(noise) {
            *value = rounded(*value + off, self.quantum);
        }
        self.spoil(&mut effort, draw);
        effort
    }

    fn spoil(&self, effort: &mut [f64], draw: &mut Draw) {
        let Some(outliers) = self.outliers else {
            return;
        };
        for _ in 0..outliers.count {
            let row = draw.between(0.0, effort.len() as f64) as usize;
            effort[row] += outliers.size * draw.normal().signum();
        }
    }
}

/// Octaves of the 1/f noise: ten, from half the row rate down to a thousandth of it.
const OCTAVES: i32 = 10;

impl Noise {
    fn of(&self, times_s: &[f64], draw: &mut Draw) -> Vec<f64> {
        let mut octaves = [0.0; OCTAVES as usize];
        let mains = |t: &f64| self.mains * libm::sin(TAU * 50.0 * t + 0.3);
        times_s
            .iter()
            .map(|t| self.white * draw.normal() + self.pink * pink(&mut octaves, draw) + mains(t))
            .collect()
    }
}

/// One value of 1/f noise: low-pass noises of equal power, one per octave (van der Ziel's sum).
fn pink(octaves: &mut [f64], draw: &mut Draw) -> f64 {
    let count = octaves.len() as f64;
    for (octave, value) in octaves.iter_mut().enumerate() {
        let kept = 1.0 - libm::exp2(-(octave as f64) - 1.0);
        *value = kept * *value + (1.0 - kept * kept).sqrt() * draw.normal();
    }
    octaves.iter().sum::<f64>() / count.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_cuts_off_and_an_interpolator_rounds() {
        assert_eq!(Encoder::of(0.5, Rounding::Down).read(0.9), 0.5);
        assert_eq!(Encoder::of(0.5, Rounding::Nearest).read(0.9), 1.0);
        assert_eq!(Encoder::of(0.5, Rounding::Down).read(-0.1), -0.5);
    }

    #[test]
    fn the_error_of_a_scale_has_its_amplitude_and_its_period() {
        let wave = Wave {
            amplitude: 3.0e-6,
            period: 0.01,
            phase: 0.0,
        };
        let scale = Encoder::of(1.0e-9, Rounding::Nearest).with(wave);
        assert!((scale.read(0.0025) - 0.002_503).abs() < 1.0e-9);
        assert!((scale.read(0.0125) - 0.012_503).abs() < 1.0e-9);
        assert!((scale.read(0.01) - 0.01).abs() < 1.0e-9);
    }

    #[test]
    fn a_screw_has_grown_by_63_percent_of_its_share_after_the_time_constant() {
        let growth = Growth {
            share: 1.0e-4,
            time_constant_s: 2.0,
        };
        assert_eq!(growth.factor(0.0), 1.0);
        assert!((growth.factor(2.0) - 1.000_063_21).abs() < 1.0e-8);
    }

    /// A ramp of effort, 10 steps of 0.1 ms to a row.
    fn trace() -> Trace {
        let ramp: Vec<f64> = (0..100_000).map(f64::from).collect();
        Trace {
            step_s: 1.0e-4,
            reference: ramp.clone(),
            motor: ramp.clone(),
            velocity: ramp.clone(),
            load: ramp.clone(),
            command: ramp.clone(),
            current: ramp,
        }
    }

    fn sensing(effort: EffortLog, stamps: Stamps) -> Sensing {
        Sensing {
            steps_per_row: 10,
            motor: Encoder::of(1.0, Rounding::Down),
            load: None,
            growth: None,
            reference: false,
            velocity: None,
            effort,
            stamps,
        }
    }

    fn record(effort: EffortLog, stamps: Stamps) -> Columns {
        sensing(effort, stamps).record(&trace(), &mut Draw::of("sensing", 1))
    }

    #[test]
    fn a_late_log_shows_what_was_before() {
        let late = EffortLog {
            late_s: 2.0e-3,
            ..EffortLog::of(Source::Command, 0.0)
        };
        let columns = record(late, Stamps::default());
        assert_eq!(columns.effort[100], columns.position[98]);
    }

    #[test]
    fn clocks_that_drift_part_by_their_share() {
        let drifting = EffortLog {
            clock_share: 1.0e-3,
            ..EffortLog::of(Source::Command, 0.0)
        };
        let columns = record(drifting, Stamps::default());
        assert_eq!(columns.effort[5000] - columns.position[5000], 50.0);
    }

    #[test]
    fn a_jittered_stamp_says_the_true_time_and_lost_rows_are_missing() {
        let stamps = Stamps {
            jitter_s: 2.0e-4,
            lost_share: 0.02,
        };
        let columns = record(EffortLog::of(Source::Command, 0.0), stamps);
        let true_time = |row: usize| columns.position[row] * 1.0e-4;
        assert!((0..9000).all(|row| (columns.time_s[row] - true_time(row)).abs() < 1.0e-9));
        assert!(columns.time_s.windows(2).all(|pair| pair[1] > pair[0]));
        assert!((9700..9900).contains(&columns.time_s.len()));
    }

    #[test]
    fn noise_has_the_deviation_that_it_says_and_pink_noise_is_slow() {
        let times: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1.0e-3).collect();
        let of = |noise: Noise| noise.of(&times, &mut Draw::of("noise", 1));
        let rms = |v: &[f64]| (v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64).sqrt();
        let means = |v: &[f64]| -> Vec<f64> {
            let mean = |c: &[f64]| c.iter().sum::<f64>() / c.len() as f64;
            v.chunks(100).map(mean).collect()
        };
        let white = of(Noise {
            white: 2.0,
            pink: 0.0,
            mains: 0.0,
        });
        let pink = of(Noise {
            white: 0.0,
            pink: 2.0,
            mains: 0.0,
        });
        assert!((rms(&white) - 2.0).abs() < 0.02 && (rms(&pink) - 2.0).abs() < 0.2);
        assert!(rms(&means(&white)) < 0.25 && rms(&means(&pink)) > 0.8);
    }

    #[test]
    fn outliers_are_as_many_as_they_say() {
        let spiky = EffortLog {
            outliers: Some(Outliers {
                count: 8,
                size: 1.0e6,
            }),
            ..EffortLog::of(Source::Command, 0.0)
        };
        let columns = record(spiky, Stamps::default());
        let spikes = columns.effort.iter().filter(|e| e.abs() > 5.0e5).count();
        assert_eq!(spikes, 8);
    }
}
