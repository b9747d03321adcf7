//! What a record lacks: a judge for each measured output, and what follows from all of them.
//!
//! | output | judge | effects |
//! |---|---|---|
//! | effort of moving samples | [`effort`] | columns, delay, saturation |
//! | effort about reversals | [`reversal`] | presliding |
//! | the same, of an axis that never dwells | [`slow_ripple`] | torque ripple |
//! | free-run position | [`free_run`] | presliding, backlash |
//! | motor − load | [`difference`] | backlash, compliance, pitch error |
//!
//! [`velocity`] comes first: whether positions or the drive's velocity say how a record moves, and
//! [`fast_motion`], whether differences of the positions are sharpened.
//! [`selection`] is the one forward selection that judges share, [`thresholds`] has every limit.
//! [`reversal_stage`] asks the witnesses of a reversal and [`at_reversals`] decides. [`findings`]
//! puts together what was found, [`signs`] says what of it is impossible, and [`verdict`] says
//! whether something is left.

pub(crate) mod all_rows;
pub(crate) mod amount;
pub(crate) mod another_day;
pub(crate) mod at_reversals;
pub(crate) mod causes;
pub(crate) mod counted_mass;
pub(crate) mod difference;
pub(crate) mod effort;
pub(crate) mod fast_motion;
pub(crate) mod features;
pub(crate) mod few_periods;
pub(crate) mod findings;
pub(crate) mod force_noise;
pub(crate) mod forms;
pub(crate) mod free_run;
pub(crate) mod inverse_dynamics;
pub(crate) mod law_of_the_load;
pub(crate) mod look_alikes;
pub(crate) mod mains;
pub(crate) mod oscillation;
pub(crate) mod plausibility;
pub(crate) mod rank;
pub(crate) mod residual;
pub(crate) mod reversal;
pub(crate) mod reversal_stage;
pub(crate) mod selection;
pub(crate) mod signs;
pub(crate) mod slow_ripple;
pub(crate) mod thresholds;
pub(crate) mod velocity;
pub(crate) mod verdict;
pub(crate) mod veto;
pub(crate) mod which_wave;
