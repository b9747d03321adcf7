//! The steps of commissioning that are more than a call: what `quadrant commission` is made of.
//!
//! ```text
//! fitness           whether the loops are stable at all
//! identified_axes   records of all axes on disk, and what each axis lacks
//! trials            what is tried against the burst, and what is taken
//! feeds             circles at other feeds, without and with it
//! steep_fall        friction that falls faster than the loops hold against
//! reversal_run      the cycles about one reversal of the first axis
//! reversal_curves   the six curves of the paper's Fig. 8(a) of them
//! unfit             the report of a machine whose loops oscillate
//! program           which program, and when
//! result            summary.json, circle.svg, report.html
//! result_page       the report: certificate, chain, axes
//! run_folder        an earlier run, read back
//! ```

pub mod feeds;
pub mod fitness;
pub mod identified_axes;
pub mod program;
pub mod result;
pub mod result_page;
pub mod reversal_curves;
pub mod reversal_run;
pub mod run_folder;
pub mod steep_fall;
pub mod trials;
pub mod unfit;
