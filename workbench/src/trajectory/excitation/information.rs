//! What a second of a sine tells of the parameters of an axis: Fisher's information.
//!
//! Two outputs are measured: the effort, and where there is a load scale motor − load. A row tells
//! of a parameter as the square of its sensitivity, ∂output/∂ln θ over the noise. The axis is not
//! known before it was recorded, so it is a usual one: its friction a share of its largest effort,
//! its fall and its bristle each of several sizes.
//!
//! ```text
//! effort        M a + Fv (1 + α sign v) v + C z (1 + k u + q u²) + E z e^(−(v/vs)²)
//!               + ripple + offset
//! motor − load  (Mₗ a + C z + Fv v) / K
//! z             sign(v) (1 − 2 e^(−s/δ)), s the way since the reversal (Dahl)
//! u             position over the travel
//! ```

use std::f64::consts::TAU;

use nalgebra::{SMatrix, SVector};

use crate::trajectory::windowed_sine::WindowedSine;

/// Inertia, viscous friction, its asymmetry, Coulomb friction, offset, Stribeck excess and
/// velocity, deflection, friction over position (linear, quadratic), ripple (cosine, sine), mass of
/// the load, stiffness.
pub(super) const PARAMETERS: usize = 14;
/// Information of all parameters.
pub(super) type Information = SMatrix<f64, PARAMETERS, PARAMETERS>;
type Row = SVector<f64, PARAMETERS>;

/// Points of a period.
const POINTS: u32 = 400;
/// Sensitivities of a ripple: so many periods a revolution.
const RIPPLE_ORDER: f64 = 3.0;
/// Velocity below which a row of the effort is not fitted, m/s.
const MOVING_M_PER_S: f64 = 1.0e-3;

/// A usual axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct UsualAxis {
    /// Motor and load together, kg.
    pub inertia_kg: f64,
    /// Load alone, kg.
    pub load_kg: f64,
    /// Coulomb friction, N.
    pub coulomb_n: f64,
    /// Viscous friction, N s/m.
    pub viscous_n_s_per_m: f64,
    /// Stribeck velocity, m/s.
    pub fall_m_per_s: f64,
    /// Deflection of the bristle, m.
    pub deflection_m: f64,
    /// Stiffness between motor and load, N/m.
    pub stiffness_n_per_m: f64,
    /// Noise of the effort in a row, N.
    pub effort_noise_n: f64,
    /// Noise of motor − load in a row, m; `None` without a load scale.
    pub scale_noise_m: Option<f64>,
    /// Travel to either side, m.
    pub travel_m: f64,
    /// Lead of the screw, m.
    pub lead_m: f64,
    /// Rows per second.
    pub rate_hz: f64,
}

/// Time about a slow row in which none is fitted, s: the low-pass mixes them.
const EDGE_S: f64 = 0.02;
/// How long a reversal lasts, in deflections.
const REVERSING: f64 = 5.0;
/// Excess at breakaway, and amplitude of a ripple, as shares of the Coulomb friction.
const EXCESS: f64 = 0.3;
const RIPPLE: f64 = 0.05;

/// A point of the motion.
struct Point {
    x: f64,
    v: f64,
    a: f64,
    /// Way since the reversal.
    way: f64,
    /// Whether the effort is fitted there.
    is_moving: bool,
}

impl UsualAxis {
    /// The information of one period of a sine.
    pub(super) fn of_a_period(&self, sine: &WindowedSine) -> Information {
        let rows = sine.period_s() * self.rate_hz / f64::from(POINTS);
        let mut sum = Information::zeros();
        for place in 0..POINTS {
            let point = point(sine, TAU * (f64::from(place) + 0.5) / f64::from(POINTS));
            for row in self.rows(&point).into_iter().flatten() {
                sum += rows * row * row.transpose();
            }
        }
        sum
    }

    /// The sensitivities of both outputs, and of the effort about reversals.
    fn rows(&self, at: &Point) -> [Option<Row>; 3] {
        let is_reversing = at.way < REVERSING * self.deflection_m;
        let difference = |noise| self.of_the_difference(at) / noise;
        [
            at.is_moving
                .then(|| self.of_the_effort(at) / self.effort_noise_n),
            is_reversing.then(|| self.about_reversals(at) / self.effort_noise_n),
            self.scale_noise_m.map(difference),
        ]
    }

    /// Friction by the bristle, in shares of its level.
    fn bristle(&self, at: &Point) -> f64 {
        at.v.signum() * (1.0 - 2.0 * (-at.way / self.deflection_m).exp())
    }

    fn of_the_effort(&self, at: &Point) -> Row {
        let (level, z) = (self.coulomb_n, self.bristle(at));
        let fast = (at.v / self.fall_m_per_s).powi(2);
        let fall = EXCESS * level * z * (-fast).exp();
        let u = at.x / self.travel_m;
        let turn = TAU * RIPPLE_ORDER * at.x / self.lead_m;
        let viscous = self.viscous_n_s_per_m * at.v;
        Row::from([
            self.inertia_kg * at.a,
            viscous,
            viscous.abs(),
            level * z,
            level,
            fall,
            2.0 * fast * fall,
            0.0,
            level * z * u,
            level * z * u * u,
            RIPPLE * level * turn.cos(),
            RIPPLE * level * turn.sin(),
            0.0,
            0.0,
        ])
    }

    /// Only the deflection is fitted there.
    fn about_reversals(&self, at: &Point) -> Row {
        let ways = at.way / self.deflection_m;
        let mut row = Row::zeros();
        row[7] = -2.0 * self.coulomb_n * at.v.signum() * ways * (-ways).exp();
        row
    }

    fn of_the_difference(&self, at: &Point) -> Row {
        let mut row = Row::zeros();
        let parts = [
            (12, self.load_kg * at.a),
            (3, self.coulomb_n * self.bristle(at)),
            (1, self.viscous_n_s_per_m * at.v),
        ];
        for (place, force) in parts {
            row[place] = force / self.stiffness_n_per_m;
            row[13] -= row[place];
        }
        row
    }
}

/// A sine at a phase; it reverses at a quarter and at three quarters.
fn point(sine: &WindowedSine, phase: f64) -> Point {
    let edge = TAU * EDGE_S / sine.period_s();
    let velocity = |phase: f64| sine.velocity_m_per_s * phase.cos();
    let is_fast = |other: f64| velocity(other) * velocity(phase).signum() > MOVING_M_PER_S;
    let is_moving =
        edge < 0.25 * TAU && [phase - edge, phase, phase + edge].into_iter().all(is_fast);
    let since = (phase + 0.25 * TAU).rem_euclid(0.5 * TAU);
    Point {
        x: sine.centre_m + sine.amplitude_m() * phase.sin(),
        v: velocity(phase),
        a: -sine.acceleration_m_per_s2 * phase.sin(),
        way: sine.amplitude_m() * (1.0 - since.cos()),
        is_moving,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: UsualAxis = UsualAxis {
        inertia_kg: 900.0,
        load_kg: 300.0,
        coulomb_n: 400.0,
        viscous_n_s_per_m: 2000.0,
        fall_m_per_s: 2.0e-3,
        deflection_m: 10.0e-6,
        stiffness_n_per_m: 1.0e8,
        effort_noise_n: 20.0,
        scale_noise_m: Some(1.0e-8),
        travel_m: 0.25,
        lead_m: 0.01,
        rate_hz: 1000.0,
    };

    fn sine(velocity_m_per_s: f64, acceleration_m_per_s2: f64) -> WindowedSine {
        WindowedSine {
            centre_m: 0.0,
            velocity_m_per_s,
            acceleration_m_per_s2,
            periods: 1.0,
            direction: 1.0,
        }
    }

    #[test]
    fn the_information_of_the_mass_is_that_of_its_column() {
        // ∫ (M a)² / σ² over a period: half the rows at the peak, but for 40 ms about each
        // reversal, where it is largest.
        let sine = sine(0.2, 2.0);
        let rows = 1000.0 * sine.period_s();
        let peak = (900.0 * 2.0 / 20.0_f64).powi(2);
        let left_out = 2.0 * (40.0 + 2.0) * peak;
        let wanted = 0.5 * rows * peak - left_out;
        let told = AXIS.of_a_period(&sine)[(0, 0)];
        assert!((told / wanted - 1.0).abs() < 0.02, "{told} {wanted}");
    }

    #[test]
    fn slow_motion_tells_of_the_fall_and_fast_motion_does_not() {
        let per_s = |sine: WindowedSine| AXIS.of_a_period(&sine)[(6, 6)] / sine.period_s();
        assert!(per_s(sine(4.0e-3, 0.02)) > 20.0 * per_s(sine(0.3, 3.0)));
    }

    #[test]
    fn without_a_load_scale_nothing_tells_of_the_screw() {
        let axis = UsualAxis {
            scale_noise_m: None,
            ..AXIS
        };
        let told = axis.of_a_period(&sine(0.2, 2.0));
        assert_eq!((told[(12, 12)], told[(13, 13)]), (0.0, 0.0));
    }

    #[test]
    fn the_way_since_a_reversal_begins_at_both_ends_of_the_stroke() {
        let sine = sine(0.1, 1.0);
        let way = |phase: f64| point(&sine, phase * TAU).way / sine.amplitude_m();
        for reversal in [0.25, 0.75] {
            assert!(way(reversal + 1.0e-4) < 1.0e-5);
            assert!((way(reversal + 0.25) - 1.0).abs() < 1.0e-12);
            assert!((way(reversal - 1.0e-4) - 2.0).abs() < 1.0e-5);
        }
    }
}
