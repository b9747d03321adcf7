//! A first-order lag over a sub-step, exact for a constant target.

/// What a sub-step covers of the way to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lag {
    dt_s: f64,
    /// Share that is covered at its end.
    pub end: f64,
    /// Share that is not covered in the mean of it.
    pub mean_left: f64,
}

impl Default for Lag {
    /// Of no sub-step yet.
    fn default() -> Self {
        Self {
            dt_s: f64::NAN,
            end: 0.0,
            mean_left: 0.0,
        }
    }
}

impl Lag {
    /// Of a sub-step, which may be as long as the last one was, and of the time constant that an
    /// axis has.
    pub(crate) fn kept_over(self, dt_s: f64, time_constant_s: f64) -> Self {
        if self.dt_s == dt_s {
            self
        } else {
            Self::over(dt_s, time_constant_s)
        }
    }

    /// Of a sub-step and a time constant; without one, all at once.
    fn over(dt_s: f64, time_constant_s: f64) -> Self {
        let end = lag_share(dt_s, time_constant_s);
        Self {
            dt_s,
            end,
            mean_left: mean_share(end),
        }
    }
}

/// Share of the way to its target that it covers in `dt`.
pub(crate) fn lag_share(dt_s: f64, time_constant_s: f64) -> f64 {
    if time_constant_s > 0.0 {
        -(-dt_s / time_constant_s).exp_m1()
    } else {
        1.0
    }
}

/// Mean of a decay from 1 over a sub-step in which it falls by `lag`: `lag / −ln(1 − lag)`, zero
/// where it falls at once.
fn mean_share(lag: f64) -> f64 {
    if lag >= 1.0 {
        0.0
    } else {
        lag / -(-lag).ln_1p()
    }
}
