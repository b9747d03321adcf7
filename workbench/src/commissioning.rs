//! The steps of commissioning that are more than a call: what `quadrant commission` is made of.
//!
//! ```text
//! identified_axes   records of all axes on disk, and what each axis lacks
//! reversal_run      the cycles about one reversal of the first axis
//! reversal_curves   the six curves of the paper's Fig. 8(a) of them
//! result            summary.json, circle.svg, report.html
//! ```

pub mod identified_axes;
pub mod result;
pub mod reversal_curves;
pub mod reversal_run;
