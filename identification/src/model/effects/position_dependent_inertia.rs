//! Inertia that is a function of position, as of a crank or of an arm that folds:
//! m(x) = M + A cos(2π k x) + B sin(2π k x).
//!
//! The kinetic energy is T = ½ m(x) v², and Lagrange's equation gives
//!
//! ```text
//! force = d/dt ∂T/∂v − ∂T/∂x = m(x) a + ½ m'(x) v²
//! ```
//!
//! so that one function makes two forces: with the acceleration and, where the inertia changes
//! under way, with the velocity squared in either direction. Both columns hold both.
//!
//! The wave is what a crank or a second link makes of the angle. A slow change over the travel, as
//! of a reel or a boom, is less than a period of it: from a quarter of one on, sine and cosine make
//! any parabola. Source: Wittenburg, Dynamics of Multibody Systems (2008).

use axis_model::EffectName;

use super::wave::{self, Names, Weight};
use super::{Action, Against, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// m(x) a + ½ m'(x) v², without the mean of m.
pub(crate) struct PositionDependentInertia;

/// m(x) a + m'(x) v²: what an encoder that is off periodically makes of a constant inertia.
///
/// Where it shows x and the motor is at x + e(x), the acceleration is a (1 + e') + e'' v². With
/// m = M e' that is twice the force by velocity of an inertia that changes.
pub(crate) struct EncoderError;

/// Periods within the travel that are tried in any case: the projection of a residual does not see
/// slow waves, because most of them is in the inertia's own column.
const SLOW: [f64; 10] = [0.25, 0.35, 0.5, 0.7, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0];
/// Faster ones are scanned from here on.
const SCANNED_FROM: f64 = 3.0;
/// Less of a period is a straight line, and its amplitude anything.
const FEWEST_PERIODS: f64 = 0.2;

/// Weights of the wave and of half its slope.
fn weight(motion: &Kinematics, acceleration: &[f64], row: usize) -> Weight {
    Weight {
        wave: acceleration[row],
        half_slope: motion.velocity_lp[row].powi(2),
    }
}

impl Effect for PositionDependentInertia {
    fn called(&self) -> Called {
        EffectName::PositionDependentInertia.into()
    }

    fn equation(&self) -> &'static str {
        "m a + m' v^2 / 2, m = a cos(2 pi k x) + b sin(2 pi k x)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, k: f64) -> Vec<Vec<f64>> {
        wave::columns(motion, k, |row| weight(motion, &motion.acceleration, row))
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_nearest_outsider(&self) -> bool {
        true
    }

    fn look_alikes(&self) -> &'static [&'static dyn Effect] {
        &[&EncoderError]
    }

    fn against(&self) -> Against {
        Against::Position
    }

    fn action(&self, at: &Instant, k: f64, own: &[f64]) -> Action {
        Action {
            mass: wave::value(own, k, at.position),
            force: wave::half_slope(own, k, at.position) * at.velocity.powi(2),
            level: 0.0,
        }
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        let (_, half) = dataset.travel();
        0.5 / half
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let acceleration = motion.low_passed(&motion.acceleration);
        let by_row = |row: usize| weight(motion, &acceleration, row);
        let slow = SLOW.map(|periods| wave::of_periods(motion, periods));
        let fast = wave::strongest(motion, setting, SCANNED_FROM..f64::INFINITY, by_row);
        slow.into_iter().chain(fast).collect()
    }

    fn first_step(&self, motion: &Kinematics, _: f64) -> f64 {
        wave::of_periods(motion, 0.05)
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        (wave::of_periods(motion, FEWEST_PERIODS), f64::MAX)
    }

    /// Inertia is above zero everywhere, so that its wave is below its mean.
    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        fitted.inertia > 0.0 && wave::amplitude(fitted.own) < fitted.inertia
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let name = EffectName::PositionDependentInertia.as_str();
        let names = Names {
            amplitude: name,
            rest: name,
        };
        let unit = naming.effort_unit(&format!(" s2/{}", naming.length()));
        wave::named(naming, &names, unit)
    }
}

impl Effect for EncoderError {
    fn called(&self) -> Called {
        Called::Structure("error of the motor's encoder")
    }

    fn equation(&self) -> &'static str {
        "m a + m' v^2, m = a cos(2 pi k x) + b sin(2 pi k x)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, k: f64) -> Vec<Vec<f64>> {
        wave::columns(motion, k, |row| Weight {
            wave: motion.acceleration[row],
            half_slope: 2.0 * motion.velocity_lp[row].powi(2),
        })
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, found, model, usual};
    use EffectName::{Coulomb, Inertia, Offset, Viscous};

    /// Periods per metre.
    const K: f64 = 12.0;
    const OWN: [f64; 2] = [20.0, -35.0];

    #[test]
    fn the_wave_of_an_inertia_comes_back_and_less_of_it_without_the_force_by_velocity() {
        let left = |with_slope: f64| {
            let axis = axis(|motion, row| {
                let x = motion.position_lp[row];
                let slope = with_slope * wave::half_slope(&OWN, K, x);
                usual(motion, row)
                    + wave::value(&OWN, K, x) * motion.acceleration[row]
                    + slope * motion.velocity_lp[row].powi(2)
            });
            let part = found(EffectName::PositionDependentInertia, K);
            let model = model(&[Inertia, Viscous, Coulomb, Offset]).with(part);
            let bench = axis.bench();
            let fitted = bench.fit(&model);
            let own = fitted
                .of(EffectName::PositionDependentInertia)
                .unwrap()
                .to_vec();
            (own, bench.force_error_percent(&fitted))
        };
        let (own, error) = left(1.0);
        for (own, wanted) in own.iter().zip(OWN) {
            assert!((own / wanted - 1.0).abs() < 0.01, "{own} {wanted}");
        }
        assert!(error < 0.3, "{error}");
        assert!(left(0.0).1 > 3.0 * error);
    }

    #[test]
    fn an_inertia_is_above_zero_everywhere() {
        let physical = |own: [f64; 2]| {
            PositionDependentInertia.is_physical(&Fitted {
                parameter: K,
                own: &own,
                inertia: 50.0,
                coulomb: 25.0,
                viscous: 200.0,
            })
        };
        assert!(physical([30.0, -39.0]) && !physical([30.0, -41.0]));
    }
}
