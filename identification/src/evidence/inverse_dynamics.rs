//! The inverse dynamics of one structure, fitted: what the declared and the extended model become.
//!
//! A structure is a list of terms with a delay and an actuator ([`Model`]), and a choice of what
//! stands where friction has its sign: the sign of the velocity, or Dahl's bristle of some
//! deflection. The bristle changes the columns, not the list of terms. So a fitted structure sees
//! every record through [`InverseDynamics::motion`].

use crate::evidence::actuator::Pair;
use crate::evidence::reversal::{self, bristle};
use crate::evidence::selection;
use crate::fit::bench::{Bench, Model};
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
    /// Terms, delay and actuator.
    pub model: Model,
    /// Coefficients of the terms' columns.
    pub coefficients: Vec<f64>,
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
            let coefficients = pair.bench.fit(&model).coefficients;
            return Self {
                model,
                coefficients,
                deflection,
            };
        };
        let dataset = pair.bench.dataset;
        let [motion, slow] =
            [pair.bench, pair.low].map(|bench| bristle::motion(bench.motion, width));
        let (bench, low) = (Bench::new(dataset, &motion), Bench::new(dataset, &slow));
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        selection::refine(pair, &mut model);
        let coefficients = bench.fit(&model).coefficients;
        Self {
            model,
            coefficients,
            deflection,
        }
    }

    /// The same structure with the coefficients of another record.
    pub(crate) fn refitted(&self, dataset: &Dataset, motion: &Kinematics) -> Self {
        let seen = self.motion(motion);
        Self {
            model: self.model.clone(),
            coefficients: Bench::new(dataset, &seen).fit(&self.model).coefficients,
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
        Bench::new(dataset, &seen).force_error_percent(&self.model, &self.coefficients)
    }

    /// What it leaves of a record.
    pub(crate) fn on(&self, dataset: &Dataset, motion: &Kinematics) -> Judgement {
        let (model, coefficients) = (&self.model, &self.coefficients);
        let plain = Bench::new(dataset, motion);
        let reversal_rms = reversal::error_rms(&plain, model, coefficients, self.deflection);
        let seen = self.motion(motion);
        let bench = Bench::new(dataset, &seen);
        Judgement {
            force_percent: bench.force_error_percent(model, coefficients),
            reversal_rms: reversal_rms.unwrap_or(0.0),
            residual: bench.residual(model, coefficients),
            prediction: bench.predict(model, coefficients),
        }
    }
}
