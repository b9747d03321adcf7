//! What a record lacks: findings on every measured output.

pub(crate) mod all_rows;
pub(crate) mod at_reversals;
pub(crate) mod difference;
pub(crate) mod effort;
pub(crate) mod findings;
pub(crate) mod free_run;
pub(crate) mod inverse_dynamics;
pub(crate) mod plausibility;
pub(crate) mod residual;
pub(crate) mod reversal;
pub(crate) mod reversal_stage;
pub(crate) mod selection;
pub(crate) mod slow_ripple;
pub(crate) mod thresholds;
pub(crate) mod verdict;
