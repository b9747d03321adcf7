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
