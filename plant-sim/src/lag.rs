//! A first-order lag over a sub-step, exact for a constant target.

/// What a sub-step covers of the way to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lag {
    /// Share that is covered at its end.
    pub end: f64,
    /// Share that is not covered in the mean of it.
    pub mean_left: f64,
}

impl Lag {
    /// Of a sub-step and a time constant; without one, all at once.
    pub(crate) fn over(dt_s: f64, time_constant_s: f64) -> Self {
        let end = lag_share(dt_s, time_constant_s);
        Self {
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
