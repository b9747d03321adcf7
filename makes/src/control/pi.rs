//! Cascades whose velocity loop is a PI controller in a form that drives have.
//!
//! All act on the lag l = kp·(r − x) + v_ref − v. They differ in what happens at the limit of the
//! effort and in what the gain depends on:
//!
//! | form | effort |
//! |---|---|
//! | velocity form | u += kv·(Δl + ki·T·l), then limited: it cannot wind up |
//! | back calculation | u = kv·l + s, limited to û; s += T·ki·(kv·l + û − u) |
//! | scheduled | u = k·l + s, s += T·ki·k·l, k = kv·(1 + extra/(1 + (v_ref/knee)²)) |
//!
//! Source: Åström and Hägglund, PID Controllers: Theory, Design, and Tuning, 1995, ch. 3 (windup,
//! velocity algorithm) and ch. 6 (gain scheduling). The time of tracking is that of the integral.

/// What sets a form apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Increments of the effort, up to a limit, N or N m.
    VelocityForm(f64),
    /// An integral that is led back at a limit, N or N m.
    BackCalculation(f64),
    /// A gain that is larger at rest.
    Scheduled {
        /// By how much, as a share.
        extra: f64,
        /// Velocity at which half of it is left.
        knee: f64,
    },
}

/// A cascade of P on position and PI on velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pi {
    /// kp, 1/s.
    pub position_per_s: f64,
    /// kv, effort per velocity.
    pub velocity: f64,
    /// ki, 1/s.
    pub integral_per_s: f64,
    /// Form.
    pub shape: Shape,
}

/// State of a PI controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PiState {
    lag: f64,
    /// The last effort of the velocity form, the integral of the others.
    effort: f64,
}

/// What it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Setpoint less position.
    pub position: f64,
    /// Setpoint less velocity.
    pub velocity: f64,
    /// Velocity of the setpoint.
    pub wanted_velocity: f64,
}

impl Pi {
    /// By its bandwidths, Hz: gains are those of a rigid inertia.
    #[must_use]
    pub fn of(inertia: f64, position_hz: f64, velocity_hz: f64, shape: Shape) -> Self {
        let rad = std::f64::consts::TAU;
        Self {
            position_per_s: rad * position_hz,
            velocity: rad * velocity_hz * inertia,
            // A fifth of the bandwidth: 11 degrees of phase.
            integral_per_s: rad * velocity_hz / 5.0,
            shape,
        }
    }

    /// The effort for the next period.
    pub fn effort(&self, state: &mut PiState, seen: &Lag, period_s: f64) -> f64 {
        let lag = self.position_per_s * seen.position + seen.velocity;
        let before = std::mem::replace(&mut state.lag, lag);
        let (kv, share) = (self.velocity, self.integral_per_s * period_s);
        match self.shape {
            Shape::VelocityForm(limit) => {
                let next = state.effort + kv * (lag - before + share * lag);
                state.effort = next.clamp(-limit, limit);
                state.effort
            }
            Shape::BackCalculation(limit) => {
                let wish = kv * lag + state.effort;
                let given = wish.clamp(-limit, limit);
                state.effort += share * (kv * lag + given - wish);
                given
            }
            Shape::Scheduled { extra, knee } => {
                let ratio = seen.wanted_velocity / knee;
                let gain = kv * (1.0 + extra / (1.0 + ratio * ratio));
                let effort = gain * lag + state.effort;
                state.effort += share * gain * lag;
                effort
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 1.0e-3;

    fn pi(shape: Shape) -> Pi {
        Pi {
            position_per_s: 20.0,
            velocity: 50.0,
            integral_per_s: 30.0,
            shape,
        }
    }

    fn off(position: f64, wanted_velocity: f64) -> Lag {
        Lag {
            position,
            velocity: 0.0,
            wanted_velocity,
        }
    }

    /// Effort after some periods with a position error.
    fn after(pi: &Pi, state: &mut PiState, position: f64, periods: usize) -> f64 {
        let each = (0..periods).map(|_| pi.effort(state, &off(position, 0.0), PERIOD_S));
        each.last().unwrap()
    }

    #[test]
    fn below_the_limit_increments_add_up_to_the_integral() {
        let mut states = [PiState::default(), PiState::default()];
        let forms = [Shape::VelocityForm(1.0e9), Shape::BackCalculation(1.0e9)];
        let [stepped, summed] = [0, 1].map(|n| after(&pi(forms[n]), &mut states[n], 0.01, 100));
        // 50·(0.2 + 30·0.2·0.1 s) = 40; the velocity form counts the present lag, 0.3 more.
        assert!((summed - 39.7).abs() < 1.0e-9, "{summed}");
        assert!((stepped - 40.0).abs() < 1.0e-9, "{stepped}");
    }

    #[test]
    fn neither_form_winds_up_at_its_limit() {
        for shape in [Shape::VelocityForm(15.0), Shape::BackCalculation(15.0)] {
            let (pi, mut state) = (pi(shape), PiState::default());
            assert_eq!(after(&pi, &mut state, 0.01, 5000), 15.0);
            // Five seconds at the limit: a plain integral would stand at 1500 N.
            let back = after(&pi, &mut state, -0.01, 20);
            assert!((-15.0..-0.5).contains(&back), "{shape:?} {back}");
        }
    }

    #[test]
    fn a_scheduled_gain_has_half_of_its_extra_at_the_knee() {
        let shape = Shape::Scheduled {
            extra: 2.0,
            knee: 0.1,
        };
        let effort = |v| pi(shape).effort(&mut PiState::default(), &off(0.01, v), PERIOD_S);
        let plain = 50.0 * 20.0 * 0.01;
        assert!((effort(0.0) / plain - 3.0).abs() < 1.0e-12);
        assert!((effort(0.1) / plain - 2.0).abs() < 1.0e-12);
        assert!((effort(-0.1) / plain - 2.0).abs() < 1.0e-12);
    }
}
