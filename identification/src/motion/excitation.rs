//! What a record cannot identify, and what to record next.

use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::units::AxisKind;

/// Warnings about a training record, one sentence each.
#[must_use]
pub(crate) fn warnings(dataset: &Dataset, motion: &Kinematics) -> Vec<String> {
    let mut list = dataset.notes.clone();
    let moving = |test: &dyn Fn(f64) -> bool| {
        motion
            .velocity_lp
            .iter()
            .zip(&motion.moving)
            .filter(|(v, moving)| **moving && test(**v))
            .count()
    };
    let all = moving(&|_| true).max(1);
    let (forwards, backwards) = (moving(&|v| v > 0.0), moving(&|v| v < 0.0));
    if forwards.min(backwards) * 20 < all {
        list.push(
            "the record moves in one direction only: friction cannot be told from an offset, nor asymmetry be seen; record runs in both directions"
                .into(),
        );
    }
    let slow_limit = 10.0 * dataset.moving_velocity;
    if moving(&|v| v.abs() < slow_limit) * 50 < all {
        let unit = match dataset.kind {
            AxisKind::Linear => "10 mm/s",
            AxisKind::Rotary => "1 rad/s",
        };
        list.push(format!("there is hardly any motion below {unit}: a Stribeck fall cannot be seen; record slow runs"));
    }
    if reversals(motion) < 4 {
        list.push(
            "there are fewer than four reversals: presliding and backlash cannot be judged; record reversals".into(),
        );
    }
    list
}

/// Number of reversals.
#[must_use]
pub(crate) fn reversals(motion: &Kinematics) -> usize {
    let signs: Vec<f64> = motion
        .velocity_lp
        .iter()
        .zip(&motion.moving)
        .filter(|(_, moving)| **moving)
        .map(|(v, _)| v.signum())
        .collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}
