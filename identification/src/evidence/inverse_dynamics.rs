//! The inverse dynamics of one structure, fitted: what the declared and the extended model become.
//!
//! A structure is a list of parts ([`Model`]), and a choice of what stands where friction has its
//! sign: the sign of the velocity, or Dahl's bristle of some deflection. The bristle changes the
//! columns, not the list of parts. So a fitted structure sees every record through
//! [`InverseDynamics::motion`].

use crate::evidence::reversal::{self, bristle};
use crate::fit::bench::Bench;
use crate::fit::fitted::Fitted;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::Model;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// One quantity of the declared model beside that of the extended model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Compared<T> {
    /// With the effects that the axis is said to have.
    pub declared: T,
    /// With the effects that were found besides.
    pub extended: T,
}

impl<T> Compared<T> {
    /// The same question to both.
    pub(crate) fn each<'a, U>(&'a self, question: impl Fn(&'a T) -> U) -> Compared<U> {
        Compared {
            declared: question(&self.declared),
            extended: question(&self.extended),
        }
    }
}

/// A structure with its coefficients.
pub(crate) struct InverseDynamics {
    /// The parts with their coefficients.
    pub fitted: Fitted,
    /// Deflection of the bristle, where there is one in place of the sign.
    pub deflection: Option<f64>,
}

/// What a structure leaves of one record.
pub(crate) struct Judgement {
    /// Force error over moving samples, percent of the effort.
    pub force_percent: f64,
    /// Rms of the effort about reversals that is not explained; zero where there are none.
    pub reversal_rms: f64,
    /// Effort − prediction, low-passed.
    pub residual: Vec<f64>,
    /// Predicted effort, not low-passed.
    pub prediction: Vec<f64>,
}

impl InverseDynamics {
    /// A model fitted to moving samples; its sign columns follow the bristle, where there is one.
    /// Nonlinear parameters are refined once more then: they were found with the sign.
    pub(crate) fn fitted(pair: Pair<'_>, mut model: Model, deflection: Option<f64>) -> Self {
        let Some(width) = deflection else {
            let fitted = pair.bench.fit(&model);
            return Self { fitted, deflection };
        };
        let dataset = pair.bench.dataset;
        let [motion, slow] =
            [pair.bench, pair.low].map(|bench| bristle::motion(bench.motion, width));
        let (bench, low) = (Bench::new(dataset, &motion), Bench::new(dataset, &slow));
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        tuning::refine(pair, &mut model);
        let fitted = bench.fit(&model);
        Self { fitted, deflection }
    }

    /// The same structure with the coefficients of another record.
    pub(crate) fn refitted(&self, dataset: &Dataset, motion: &Kinematics) -> Self {
        let seen = self.motion(motion);
        Self {
            fitted: Bench::new(dataset, &seen).fit(self.fitted.model()),
            deflection: self.deflection,
        }
    }

    /// The motion as this structure sees it.
    pub(crate) fn motion(&self, motion: &Kinematics) -> Kinematics {
        self.deflection.map_or_else(
            || motion.clone(),
            |deflection| bristle::motion(motion, deflection),
        )
    }

    /// Force error over the moving samples of a record, percent.
    pub(crate) fn force_error_percent(&self, dataset: &Dataset, motion: &Kinematics) -> f64 {
        let seen = self.motion(motion);
        Bench::new(dataset, &seen).force_error_percent(&self.fitted)
    }

    /// What it leaves of a record.
    pub(crate) fn on(&self, dataset: &Dataset, motion: &Kinematics) -> Judgement {
        let plain = Bench::new(dataset, motion);
        let reversal_rms = reversal::error_rms(&plain, &self.fitted, self.deflection);
        let seen = self.motion(motion);
        let bench = Bench::new(dataset, &seen);
        Judgement {
            force_percent: bench.force_error_percent(&self.fitted),
            reversal_rms: reversal_rms.unwrap_or(0.0),
            residual: bench.residual(&self.fitted),
            prediction: bench.predict(&self.fitted),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use axis_model::EffectName::{Coulomb, Inertia, Viscous};

    use super::*;
    use crate::record::samples::Record;
    use crate::simulate::made;

    pub(crate) const DEFLECTION_M: f64 = 2.0e-4;

    /// 700 kg, 900 N·s/m and 300 N of friction, whose direction is the sign or a bristle.
    pub(crate) fn record(deflection: Option<f64>) -> Record {
        let bare = made::record(1.0e-3, made::two_sines(3000));
        let motion = Kinematics::new(&declared(bare.clone()), &bare).unwrap();
        let seen = deflection.map(|width| bristle::motion(&motion, width));
        let direction = seen.map_or_else(|| motion.direction.clone(), |seen| seen.direction);
        let effort = |row: usize| {
            700.0 * motion.acceleration[row] + 900.0 * motion.velocity[row] + 300.0 * direction[row]
        };
        Record {
            effort: (0..bare.len()).map(effort).collect(),
            ..bare
        }
    }

    pub(crate) fn declared(record: Record) -> Dataset {
        Dataset {
            declared: vec![Inertia, Viscous, Coulomb],
            ..made::dataset(record, None)
        }
    }

    fn fitted(dataset: &Dataset, motion: &Kinematics, deflection: Option<f64>) -> InverseDynamics {
        let bench = Bench::new(dataset, motion);
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        InverseDynamics::fitted(pair, Model::declared(dataset), deflection)
    }

    fn assert_near(value: f64, wanted: f64, share: f64) {
        assert!(
            (value / wanted - 1.0).abs() < share,
            "{value}, wanted {wanted}"
        );
    }

    #[test]
    fn each_friction_is_explained_by_its_own_structure_and_not_by_the_other() {
        for of_the_record in [None, Some(DEFLECTION_M)] {
            let dataset = declared(record(of_the_record));
            let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
            for of_the_model in [None, Some(DEFLECTION_M)] {
                let model = fitted(&dataset, &motion, of_the_model);
                let left = model.on(&dataset, &motion);
                let is_right = of_the_record == of_the_model;
                let case = format!("{of_the_record:?} {of_the_model:?}");
                assert_eq!(
                    left.force_percent < 1.0e-6,
                    is_right,
                    "{case}: {}",
                    left.force_percent
                );
                // Below 0.01 N of 300 N about reversals, or some newtons.
                let (rms, right) = (left.reversal_rms, is_right);
                assert!(if right { rms < 0.01 } else { rms > 3.0 }, "{case}: {rms}");
                let again = model.force_error_percent(&dataset, &motion);
                assert_eq!(again, left.force_percent, "{case}");
                if is_right {
                    assert_near(model.fitted.of(Coulomb).unwrap()[0], 300.0, 1.0e-6);
                }
            }
        }
    }

    #[test]
    fn without_coulomb_friction_nothing_is_left_about_reversals() {
        let dataset = declared(record(None));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let model = InverseDynamics {
            fitted: Bench::new(&dataset, &motion).fit(&crate::fit::made::model(&[Inertia])),
            deflection: None,
        };
        assert_eq!(model.on(&dataset, &motion).reversal_rms, 0.0);
    }

    #[test]
    fn a_structure_takes_the_coefficients_of_another_record_and_keeps_its_bristle() {
        let dataset = declared(record(Some(DEFLECTION_M)));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let model = fitted(&dataset, &motion, Some(DEFLECTION_M));
        let mut stronger = dataset.train.clone();
        stronger.effort.iter_mut().for_each(|effort| *effort *= 2.0);
        let motion = Kinematics::new(&dataset, &stronger).unwrap();
        assert_near(model.force_error_percent(&dataset, &motion), 50.0, 1.0e-6);
        let refitted = model.refitted(&dataset, &motion);
        assert_eq!(refitted.deflection, Some(DEFLECTION_M));
        assert_near(refitted.fitted.of(Inertia).unwrap()[0], 1400.0, 1.0e-6);
        assert!(refitted.force_error_percent(&dataset, &motion) < 1.0e-6);
    }

    #[test]
    fn residual_and_prediction_are_in_the_unit_of_the_effort_and_add_up() {
        let dataset = declared(record(None));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let model = fitted(&dataset, &motion, None);
        let mut pushed = dataset.train.clone();
        pushed.effort.iter_mut().for_each(|effort| *effort += 7.0);
        let motion = Kinematics::new(&dataset, &pushed).unwrap();
        let left = model.on(&dataset, &motion);
        let middle = motion.len() / 2;
        assert_near(left.residual[middle], 7.0, 1.0e-6);
        assert_near(motion.effort[middle] - left.prediction[middle], 7.0, 1.0e-6);
    }
}
