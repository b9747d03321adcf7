//! A drive whose torque falls behind: of a commanded effort u it delivers `u / (1 + k |u|)`.
//!
//! No column. The inverse, `q / (1 − k |q|)`, is put on the prediction, never on the recorded
//! effort: noise in a regressor would look like an effect. The fit is linearised about an earlier
//! one ([`crate::fit::bench`]).

use axis_model::EffectName;

use super::{Effect, Fitted, Kinematics, Named, Naming, Setting, Stage};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// u / (1 + k |u|).
pub(crate) struct TorqueSaturation;

/// Shares of the largest effort that are tried as lost.
const LOSSES: [f64; 8] = [0.004, 0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.4];
/// Bounds of k times the largest effort: a tenth of the smallest loss that is tried, and what a
/// drive that still does its work can lose.
const BOUNDS: (f64, f64) = (0.1 * LOSSES[0], 0.6);
/// The largest k·|q| that is followed; beyond it the inverse runs away.
const LARGEST_LOSS: f64 = 0.8;

/// The law of an actuator whose delivered effort falls behind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Saturation {
    /// k of `u / (1 + k |u|)`, one over the unit of the effort; zero: an ideal actuator.
    pub per_effort: f64,
}

impl Saturation {
    /// Whether the delivered effort is the commanded one.
    #[must_use]
    pub(crate) fn is_ideal(self) -> bool {
        self.per_effort == 0.0
    }

    /// Commanded effort for a wanted one.
    #[must_use]
    pub(crate) fn commanded(self, wanted: f64) -> f64 {
        wanted / (1.0 - (self.per_effort * wanted.abs()).min(LARGEST_LOSS))
    }

    /// Delivered effort for a commanded one.
    #[inline]
    #[must_use]
    pub(crate) fn delivered(self, commanded: f64) -> f64 {
        commanded / (1.0 + self.per_effort * commanded.abs())
    }

    /// What the low-pass makes of what is lost of an effort, beyond what is lost of the low-passed
    /// effort: `delivered(LP u) = LP(delivered u) + this`. A drive loses most at the peaks, and a
    /// low-pass takes them off: a fit that does not know of them finds too small a loss.
    #[must_use]
    pub(crate) fn lost_at_peaks(self, motion: &Kinematics) -> Vec<f64> {
        let of_low_passed = motion.effort_lp.iter().map(|u| self.delivered(*u));
        let pairs = of_low_passed.zip(self.delivered_lp(motion));
        pairs
            .map(|(of_low_passed, low_passed)| of_low_passed - low_passed)
            .collect()
    }

    /// Low-passed delivered effort for a commanded one.
    #[must_use]
    pub(crate) fn delivered_lp(self, motion: &Kinematics) -> Vec<f64> {
        if self.is_ideal() {
            return motion.effort_lp.clone();
        }
        let delivered: Vec<f64> = motion.effort.iter().map(|u| self.delivered(*u)).collect();
        motion.low_passed(&delivered)
    }

    /// Commanded over wanted effort, for small changes.
    #[must_use]
    pub(crate) fn slope(self, wanted: f64) -> f64 {
        1.0 / (1.0 - (self.per_effort * wanted.abs()).min(LARGEST_LOSS)).powi(2)
    }
}

fn largest_effort(motion: &Kinematics) -> f64 {
    let pairs = motion.effort_lp.iter().zip(&motion.fitted);
    let fitted = pairs.filter(|(_, fitted)| **fitted);
    fitted.fold(f64::MIN_POSITIVE, |most, (effort, _)| {
        most.max(effort.abs())
    })
}

impl Effect for TorqueSaturation {
    fn called(&self) -> Called {
        EffectName::TorqueSaturation.into()
    }

    fn equation(&self) -> &'static str {
        "delivered = u / (1 + k |u|)"
    }

    fn columns(&self, _: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn width(&self, _: f64) -> usize {
        0
    }

    fn stage(&self) -> Stage {
        Stage::Actuator
    }

    fn is_judged_slow_too(&self) -> bool {
        true
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn grid(&self, motion: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        let largest = largest_effort(motion);
        LOSSES.iter().map(|loss| loss / largest).collect()
    }

    fn first_step(&self, _: &Kinematics, k: f64) -> f64 {
        0.3 * k
    }

    fn later_step(&self, motion: &Kinematics, k: f64) -> f64 {
        self.first_step(motion, k)
    }

    fn derivative_step(&self, k: f64) -> f64 {
        1.0e-3 * k
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        let largest = largest_effort(motion);
        (BOUNDS.0 / largest, BOUNDS.1 / largest)
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        fitted.parameter > 0.0
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = format!("1/{}", naming.dataset.effort.unit());
        vec![naming.nonlinear("torque_saturation", naming.parameter, unit)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Saturation = Saturation { per_effort: 0.01 };

    #[test]
    fn commanded_and_delivered_effort_undo_each_other_on_both_sides_of_zero() {
        for wanted in [-40.0, -1.0, 0.0, 25.0, 70.0] {
            let back = LAW.delivered(LAW.commanded(wanted));
            assert!((back - wanted).abs() < 1.0e-9, "{wanted} {back}");
        }
        // 50 N of 100 N are left at k = 1 %.
        assert!((LAW.delivered(100.0) - 50.0).abs() < 1.0e-12);
        assert!((LAW.commanded(-50.0) + 100.0).abs() < 1.0e-12);
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_commanded_effort() {
        for wanted in [-60.0, 0.0, 30.0] {
            let step = 1.0e-4;
            let change = LAW.commanded(wanted + step) - LAW.commanded(wanted - step);
            assert!((LAW.slope(wanted) - change / (2.0 * step)).abs() < 1.0e-4);
        }
    }

    #[test]
    fn beyond_four_fifths_the_inverse_does_not_run_away() {
        assert!((LAW.commanded(200.0) - 1000.0).abs() < 1.0e-9);
        assert!((LAW.slope(200.0) - 25.0).abs() < 1.0e-9);
        assert!(!LAW.is_ideal() && Saturation::default().is_ideal());
    }

    #[test]
    fn losses_of_the_largest_moving_effort_are_tried_and_bounded() {
        let mut axis = crate::fit::made::axis(|_, _| 0.0);
        axis.motion.effort_lp.fill(-20.0);
        let unseen = axis
            .motion
            .fitted
            .iter()
            .position(|fitted| !fitted)
            .unwrap();
        axis.motion.effort_lp[unseen] = 500.0;
        let setting = Setting {
            dataset: &axis.dataset,
            residual: &[],
        };
        let grid = TorqueSaturation.grid(&axis.motion, &setting);
        assert!((grid[0] - 2.0e-4).abs() < 1.0e-12 && (grid[7] - 0.02).abs() < 1.0e-12);
        let (low, high) = TorqueSaturation.bounds(&axis.motion);
        assert!((low - 2.0e-5).abs() < 1.0e-12 && (high - 0.03).abs() < 1.0e-12);
    }
}
