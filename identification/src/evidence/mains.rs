//! Mains in the effort: what an amplifier's sensor picks up, and no force of the axis.
//!
//! A wave over time at the frequency of the mains goes with no motion. It is found as a structure
//! without a name, so that nothing absorbs it. Where it is small it is told and does not count, as
//! noise does not.

use crate::evidence::selection::Scored;
use crate::evidence::thresholds::{MAINS_HZ, MAINS_OFF_HZ, MAINS_PERCENT};
use crate::evidence::verdict::Reason;
use crate::model::effects::Effect;
use crate::model::effects::hum::Hum;
use crate::model::inverse::Part;

/// What is told of a part that is mains, where it is as small as noise.
pub(crate) fn reason(part: &Part, scored: &[Scored]) -> Option<Reason> {
    let called = Hum.called();
    let is_mains = |hz: f64| {
        let mut mains = MAINS_HZ.into_iter();
        mains.any(|mains| (hz - mains).abs() < MAINS_OFF_HZ)
    };
    if part.called() != called || !is_mains(part.parameter) {
        return None;
    }
    let mut accepted = scored.iter().filter(|one| one.accepted);
    let found = accepted.find(|one| one.effect == called && is_mains(one.parameter))?;
    let percent = found.gain.percent;
    (percent < MAINS_PERCENT).then(|| {
        Reason::told(format!(
            "mains in the effort ({:.1} Hz, {percent:.1} % of it): check the screens of its cable",
            part.parameter
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::blocks::Gain;
    use crate::fit::made::found;
    use axis_model::EffectName;

    fn told(hz: f64, percent: f64) -> Option<bool> {
        let gain = Gain {
            removed: 1.0,
            share: 0.9,
            percent,
            t: 9.0,
        };
        let scored = Scored {
            effect: Hum.called(),
            parameter: hz,
            gain,
            physical: true,
            accepted: true,
            round: 0,
        };
        let reason = reason(&Part::found(&Hum, hz), &[scored]);
        reason.map(|reason| reason.counts)
    }

    #[test]
    fn mains_are_told_where_they_are_small_and_at_their_frequency() {
        assert_eq!(told(49.98, 0.7), Some(false));
        assert_eq!(told(60.01, 1.9), Some(false));
        assert_eq!(told(50.0, 2.1), None);
        assert_eq!(told(49.0, 0.7), None);
        assert_eq!(reason(&found(EffectName::TorqueRipple, 50.0), &[]), None);
    }
}
