//! Axes made for tests: a motion along two sines, and the effort that a law of it gives.

use axis_model::EffectName;

use crate::fit::bench::Bench;
use crate::model::effects::find;
use crate::model::inverse::{Model, Part};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::units::EffortHold;
use crate::simulate::made;

/// An axis with the motion of its training record.
pub(crate) struct Axis {
    /// The axis.
    pub dataset: Dataset,
    /// Its motion.
    pub motion: Kinematics,
}

/// An axis on a record, at rest in its effort.
pub(crate) fn on(record: Record) -> Axis {
    let mut dataset = made::dataset(record, None);
    dataset.hold = EffortHold::Instant;
    dataset.declared = vec![
        EffectName::Inertia,
        EffectName::Viscous,
        EffectName::Coulomb,
        EffectName::Offset,
    ];
    let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
    Axis { dataset, motion }
}

/// An axis of 6 s whose effort follows from its motion, row by row, but for a little noise.
pub(crate) fn axis(law: impl Fn(&Kinematics, usize) -> f64) -> Axis {
    let mut axis = on(made::record(1.0e-3, made::two_sines(6000)));
    axis.put(law);
    axis
}

/// 90 kg, 200 N s/m, 25 N and −4 N.
pub(crate) const USUAL: [f64; 4] = [90.0, 200.0, 25.0, -4.0];

/// The force of a usual axis.
pub(crate) fn usual(motion: &Kinematics, row: usize) -> f64 {
    let [mass, viscous, coulomb, offset] = USUAL;
    let friction = viscous * motion.velocity[row] + coulomb * motion.direction[row];
    mass * motion.acceleration[row] + friction + offset
}

impl Axis {
    /// Puts the effort of a law into the record; 0.02 N of it are noise.
    pub(crate) fn put(&mut self, law: impl Fn(&Kinematics, usize) -> f64) {
        let motion = &mut self.motion;
        let noise = |row: usize| 0.02 * (0.37 * (row * row % 1009) as f64).sin();
        let effort: Vec<f64> = (0..motion.len())
            .map(|row| law(motion, row) + noise(row))
            .collect();
        motion.effort_lp = motion.low_passed(&effort);
        motion.effort.clone_from(&effort);
        self.dataset.train.effort = effort;
    }

    /// Its bench.
    pub(crate) fn bench(&self) -> Bench<'_> {
        Bench::new(&self.dataset, &self.motion)
    }
}

/// A part that was found.
pub(crate) fn found(name: EffectName, parameter: f64) -> Part {
    Part::found(find(name).unwrap(), parameter)
}

/// A model of declared parts.
pub(crate) fn model(names: &[EffectName]) -> Model {
    let part = |name: &EffectName| Part::declared(find(*name).unwrap(), 0.0);
    Model {
        parts: names.iter().map(part).collect(),
    }
}
