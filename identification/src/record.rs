//! Records in: dataset and CSV or bus log, checked, on one time base.

pub(crate) mod bus_log;
pub(crate) mod dataset;
pub(crate) mod table;
