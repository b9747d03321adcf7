//! Gap and screw on another record: each is looked for anew there, by the ways that the first one
//! gave.
//!
//! Two records of one axis are off by different parts of what the ways lack: the force of flanks
//! that meet, friction of the motor, a third body. The jackknife over the blocks of one record does
//! not see that.

use axis_model::EffectName;

use super::columns::{Apart, Path};
use super::{Difference, Known, MotorLoad, settled};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Another record knows a size about as well as the first one where its interval is at most so many
/// times as wide.
const MOST_WIDER: f64 = 2.0;

/// Motor − load of another record by the ways of the first one; pitch errors stay as they are.
/// `None` where the load moves with the motor.
#[must_use]
pub(crate) fn elsewhere(
    first: &Difference,
    dataset: &Dataset,
    motion: &Kinematics,
    path: Path<'_>,
) -> Option<Difference> {
    if !first.moves_apart() {
        return None;
    }
    let apart = Apart::on(motion, path)?;
    let raw = apart.cleared(&first.extended);
    let pitch = EffectName::PitchError;
    let names = first.extended.names().filter(|name| *name != pitch);
    let mut ways = MotorLoad::of(dataset, apart.seen(&raw)).ways_of(&names.collect::<Vec<_>>());
    let all = first.extended.ways().into_iter();
    ways.extend(all.filter(|way| way.called() == pitch));
    let fitted = apart.where_known(&ways).fit(&ways);
    let again = Difference::of([fitted.clone(), fitted], Vec::new());
    Some(settled(again, dataset, (motion, path), first.laws()))
}

impl Difference {
    /// The same, its intervals with half of what another record says otherwise in them.
    #[must_use]
    pub(crate) fn beside(mut self, other: &Self) -> Self {
        let both = |own: Option<Known>, other: Option<Known>| {
            let pair = own.zip(other);
            pair.map_or(own, |(own, other)| Some(widened(own, other)))
        };
        self.gap = both(self.gap, other.gap);
        self.stiffness = both(self.stiffness, other.stiffness);
        self.motor_coulomb = both(self.motor_coulomb, other.motor_coulomb);
        let told = self.by_the_load.as_mut().zip(other.by_the_load.as_ref());
        if let Some((own, other)) = told {
            own.stiffness = widened(own.stiffness, other.stiffness);
            own.damping = widened(own.damping, other.damping);
            own.mass = widened(own.mass, other.mass);
            own.gap = both(own.gap, other.gap);
            own.deflection = widened(own.deflection, other.deflection);
        }
        self
    }
}

/// A value with half of what another record says otherwise in its interval, where that knows it
/// about as well or contradicts it.
fn widened(own: Known, other: Known) -> Known {
    let apart = (other.value - own.value).abs();
    let counts = other.half_width <= MOST_WIDER * own.half_width || apart > other.half_width;
    if counts {
        let half_width = own.half_width.hypot(0.5 * apart);
        Known { half_width, ..own }
    } else {
        own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_what_another_record_says_otherwise_is_in_an_interval() {
        let own = Known::new(10.0, 0.3);
        let width = |value: f64, half_width: f64| widened(own, Known::new(value, half_width));
        assert!((width(10.8, 0.3).half_width - 0.5).abs() < 1.0e-12);
        assert_eq!(width(10.8, 0.3).value, 10.0);
        // It knows less, and does not contradict.
        assert_eq!(width(10.8, 1.0), own);
        // It knows less, and contradicts.
        assert!((width(14.0, 1.0).half_width - 0.3_f64.hypot(2.0)).abs() < 1.0e-12);
    }
}
