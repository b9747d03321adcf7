//! Paths of one axis for scenarios: from rest, with a stated jerk, as functions of the cycle.
//!
//! A [`Profile`] is a list of phases of constant jerk, integrated exactly: within a phase x, v and
//! a are polynomials of the time.

/// A phase of constant jerk: duration in s, jerk in m/s³. A jump of acceleration is a phase of no
/// duration whose jerk is the jump in m/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// So long, with this jerk.
    Jerk(f64, f64),
    /// The acceleration jumps by so much.
    Jump(f64),
}

/// A path of phases, from rest at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Begin of each phase, s, what the axis does there (m, m/s, m/s²), and the jerk from there on.
    phases: Vec<(f64, [f64; 3], f64)>,
}

impl Profile {
    /// The path of these phases; after the last one the velocity stays as it is.
    #[must_use]
    pub fn new(phases: &[Phase]) -> Self {
        let (mut time_s, mut at, mut all) = (0.0, [0.0; 3], Vec::new());
        for phase in phases {
            match *phase {
                Phase::Jump(jump) => at[2] += jump,
                Phase::Jerk(duration_s, jerk) => {
                    all.push((time_s, at, jerk));
                    (time_s, at) = (time_s + duration_s, integrated(at, jerk, duration_s));
                }
            }
        }
        all.push((time_s, [at[0], at[1], 0.0], 0.0));
        Self { phases: all }
    }

    /// Position at a time, m.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let phase = self
            .phases
            .iter()
            .rev()
            .find(|(begin, ..)| *begin <= time_s);
        phase.map_or(0.0, |(begin, at, jerk)| {
            integrated(*at, *jerk, time_s - begin)[0]
        })
    }
}

fn integrated([x, v, a]: [f64; 3], jerk: f64, t: f64) -> [f64; 3] {
    [
        x + t * (v + t * (a / 2.0 + t * jerk / 6.0)),
        v + t * (a + t * jerk / 2.0),
        a + t * jerk,
    ]
}

/// A sine from rest: its phase gets up to speed within `ramp_s` as a smoothstep does.
#[must_use]
pub fn sine(amplitude_m: f64, period_s: f64, ramp_s: f64, time_s: f64) -> f64 {
    amplitude_m * (std::f64::consts::TAU / period_s * smooth_time(time_s, ramp_s)).sin()
}

/// A cosine minus where it begins, `lead_s` before its reversal: the reversal at full speed without
/// the quarter turn before it.
#[must_use]
pub fn reversal(amplitude_m: f64, period_s: f64, lead_s: f64, ramp_s: f64, time_s: f64) -> f64 {
    let omega = std::f64::consts::TAU / period_s;
    let phase = |time_s: f64| amplitude_m * (omega * (time_s - lead_s)).cos();
    phase(smooth_time(time_s, ramp_s)) - phase(0.0)
}

/// ∫ of the smoothstep `10 u³ − 15 u⁴ + 6 u⁵` over the ramp, then the time less half the ramp.
fn smooth_time(time_s: f64, ramp_s: f64) -> f64 {
    let u = (time_s / ramp_s).clamp(0.0, 1.0);
    ramp_s * u.powi(4) * (2.5 - 3.0 * u + u * u) + (time_s - ramp_s).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_is_the_integral_of_its_phases() {
        let path = Profile::new(&[
            Phase::Jerk(0.1, 50.0),
            Phase::Jerk(0.1, -50.0),
            Phase::Jump(-5.0),
            Phase::Jerk(0.1, 0.0),
        ]);
        // 0.5 m/s after 0.2 s on 50 mm, then braked at 5 m/s² for 0.1 s, then 0 m/s.
        for (time_s, at) in [(0.2, 0.05), (0.3, 0.075), (0.5, 0.075)] {
            assert!(
                (path.at(time_s) - at).abs() < 1.0e-12,
                "{time_s}: {}",
                path.at(time_s)
            );
        }
    }

    #[test]
    fn a_sine_and_a_reversal_begin_at_rest_and_reach_their_speed() {
        let speed =
            |path: &dyn Fn(f64) -> f64, t: f64| (path(t + 1.0e-4) - path(t - 1.0e-4)) / 2.0e-4;
        let sine = |t| sine(0.02, 1.2, 0.4, t);
        assert!(
            speed(&sine, 1.0e-3) < 1.0e-5
                && (speed(&sine, 0.2 + 1.2) - 0.02 * 5.236).abs() < 1.0e-4
        );
        let reversal = |t| reversal(0.1, 18.85, 1.0, 0.5, t);
        assert!(
            speed(&reversal, 1.25).abs() < 1.0e-6,
            "reversal at the lead and half the ramp"
        );
    }
}
