//! Records in: dataset and CSV or bus log, checked, on one time base.
//!
//! ```text
//! dataset.toml ─▶ form (and its slips of the pen)
//! train.csv    ─▶ table ──▶┐
//! train.log    ─▶ bus_log ─▶┴ reading ─▶ checks ─▶ outliers ─▶ time_base ─▶ samples
//! samples ─▶ dataset ─▶ excerpt (of a long record)
//! ```

pub(crate) mod bus_log;
pub(crate) mod checks;
pub(crate) mod dataset;
pub(crate) mod excerpt;
pub(crate) mod extent;
pub(crate) mod form;
pub(crate) mod outliers;
pub(crate) mod reading;
pub(crate) mod rounding;
pub(crate) mod samples;
pub(crate) mod scale_error;
pub(crate) mod source;
pub(crate) mod table;
pub(crate) mod time_base;
pub(crate) mod units;
