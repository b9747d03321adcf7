//! A model whose levels of friction the drives have refined themselves, on circles at several
//! feeds.
//!
//! A drive refines its level at every turn, by its own signals. Here it is only moved, and asked in
//! the end what it made of the level; that goes into the model.

use super::tuning_circles::TuningCircles;
use super::{TUNING_RUN, Tuned};
use crate::compensation::{self, AxisCompensation, Compensation};
use crate::error::Outcome;
use crate::progress;
use crate::session::{Session, Stand};
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::at_share_of_feed;

/// Feeds as shares of that of the circle, and turns at each. The slowest comes last: fast turns
/// leave the level up to a fortieth too low.
const FEEDS: [(f64, u32); 3] = [(4.0, 3), (1.0, 3), (0.25, 2)];

/// A tuned model, refined by the drives, which go on doing so; `None` where it is no model, or a
/// circle broke off.
///
/// # Errors
/// Where a circle cannot be run, or the operator interrupts.
pub fn refined(stand: &Stand<'_>, circle: &Circle, model: &Tuned) -> Outcome<Option<Tuned>> {
    let Some(begin) = compensation::self_tuning(&model.compensation) else {
        return Ok(None);
    };
    let session = stand.connect(TUNING_RUN)?;
    session.perform(&begin, None, |session| {
        let moved = move_along(stand, circle, session);
        stand.interrupt.check()?;
        let turns = match moved {
            Ok(turns) => turns,
            Err(why) => {
                progress::step(&format!("the drives refined nothing: {why}"));
                return Ok(None);
            }
        };
        let levels = session.refined_levels()?;
        let pairs = begin.iter().zip(levels);
        let compensation: Vec<AxisCompensation> =
            pairs.map(|(axis, level)| with_level(axis, level)).collect();
        let mut circles = TuningCircles::on(session, circle);
        let after_um = circles.run(&compensation)?.bursts_um;
        Ok(Some(Tuned {
            compensation,
            before_um: model.before_um,
            after_um,
            circles: turns + circles.count,
        }))
    })
}

/// Circles at all feeds that the machine can do; gives the turns.
fn move_along(stand: &Stand<'_>, circle: &Circle, session: &mut Session<'_>) -> Outcome<u32> {
    let mut all = 0;
    for (share, turns) in FEEDS {
        if let Some(other) = at_share_of_feed(stand.machine, circle, share) {
            session.circle(&Circle { turns, ..other })?;
            all += turns;
        }
    }
    Ok(all)
}

/// A level that is refined to less than this share is kept there: from nothing no turn brings it
/// back.
const SMALLEST: f64 = 0.05;

/// The same with all levels of the model times a factor, as the drive has it: as stiff as before.
fn with_level(axis: &AxisCompensation, factor: f64) -> AxisCompensation {
    let Compensation::Model(model) = &axis.reversal else {
        return axis.clone();
    };
    let model = model.times(factor.max(SMALLEST));
    AxisCompensation {
        reversal: Compensation::Model(Box::new(model)),
        ..axis.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::Model;

    #[test]
    fn levels_are_scaled_and_springs_stay_as_stiff() {
        let model = Model {
            level_n: [10.0; crate::compensation::ELEMENTS],
            self_tuning: 0.25,
            viscous_n_s_per_m: 7.0,
            ..Model::OFF
        };
        let axis = AxisCompensation {
            reversal: Compensation::Model(Box::new(model)),
            backlash_m: 1.0e-6,
        };
        for (factor, level_n) in [(0.5, 50.0), (0.0, 5.0)] {
            let scaled = with_level(&axis, factor);
            let Compensation::Model(own) = &scaled.reversal else {
                panic!("a model");
            };
            assert!((own.level_n() - level_n).abs() < 1.0e-9);
            let stiffness = own.level_n[3] / own.slip_m[3];
            assert!(
                (stiffness - 10.0 / model.slip_m[3]).abs() < 1.0e-3,
                "{stiffness}"
            );
            let band = own.gap_force_n / model.gap_force_n;
            assert!((band - level_n / model.level_n()).abs() < 1.0e-9, "{band}");
            let rest = Model {
                level_n: model.level_n,
                slip_m: model.slip_m,
                gap_force_n: model.gap_force_n,
                ..**own
            };
            assert_eq!(rest, model);
            assert_eq!(scaled.backlash_m, axis.backlash_m);
        }
    }
}
