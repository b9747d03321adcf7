//! The motion of both records of a dataset, or why there is too little of it.

use crate::error::IdentificationError;
use crate::motion::kinematics::Kinematics;
use crate::record::checks::FEWEST_ROWS;
use crate::record::dataset::Dataset;

/// The motion of a dataset's records.
pub(crate) struct Motions {
    /// The training record.
    pub train: Kinematics,
    /// The training record at the cut-off of the delay search.
    pub train_low: Kinematics,
    /// The validation record.
    pub validate: Kinematics,
}

impl Motions {
    /// # Errors
    /// Where the sample period leaves no room for the low-pass, or hardly anything moves.
    pub(crate) fn of(dataset: &Dataset, low_cutoff_hz: f64) -> Result<Self, IdentificationError> {
        let low = Kinematics::with_cutoff(dataset, &dataset.train, low_cutoff_hz);
        let motions = Self {
            train: of_training(dataset)?,
            train_low: low.ok_or_else(|| no_room(dataset))?,
            validate: Kinematics::new(dataset, &dataset.validate)
                .ok_or_else(|| no_room(dataset))?,
        };
        motions.check(&dataset.name)?;
        Ok(motions)
    }

    fn check(&self, name: &str) -> Result<(), IdentificationError> {
        let count = |mask: &[bool]| mask.iter().filter(|inside| **inside).count();
        let fitted = count(&self.train.fitted);
        if fitted < FEWEST_ROWS / 2 {
            return Err(IdentificationError::new(format!(
                "{name}: only {fitted} moving samples are left for the fit; record longer runs, away from the effort's limit"
            )));
        }
        if count(&self.validate.moving) < fewest_judged(self.validate.period_s) {
            return Err(IdentificationError::new(format!(
                "{name}: hardly any moving samples are left in the validation record; record longer runs for it"
            )));
        }
        Ok(())
    }
}

/// Fewest moving samples that a model is judged on: a fifth of a second, which is what two
/// reversals and the filter's ends leave of one second; 200 where that is more.
fn fewest_judged(period_s: f64) -> usize {
    const FEWEST_S: f64 = 0.2;
    const ENOUGH: usize = 200;
    ((FEWEST_S / period_s).round() as usize).min(ENOUGH)
}

/// The motion of the training record alone.
///
/// # Errors
/// Where the sample period leaves no room for the low-pass.
pub(crate) fn of_training(dataset: &Dataset) -> Result<Kinematics, IdentificationError> {
    Kinematics::new(dataset, &dataset.train).ok_or_else(|| no_room(dataset))
}

fn no_room(dataset: &Dataset) -> IdentificationError {
    IdentificationError::new(format!(
        "{}: the sample period leaves no room for the low-pass",
        dataset.name
    ))
}
