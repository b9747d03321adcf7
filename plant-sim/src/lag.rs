//! A first-order lag over a sub-step, exact for a constant target.

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
pub(crate) fn mean_share(lag: f64) -> f64 {
    if lag >= 1.0 {
        0.0
    } else {
        lag / -(-lag).ln_1p()
    }
}
