//! What commissioning leaves for people and machines: `summary.json`, `circle.svg`, `report.html`.

use std::path::Path;

use identification::{Identification, Report};
use serde::Serialize;

use super::feeds::{AtFeed, Feeds, less_percent};
use super::fitness::Oscillation;
use super::program::program;
use super::steep_fall::SteepFall;
use super::trials::{TrialSummary, Trials};
use crate::circle_test::{CircleReport, CircleRun, Whole};
use crate::error::Outcome;
use crate::output_files::{json, write};
use crate::presentation::certificate::Judged;
use crate::presentation::plots::standalone;
use crate::session::Stand;
use crate::trajectory::Circle;

/// `summary.json`.
#[derive(Serialize)]
struct SummaryFile<'a> {
    machine: &'a str,
    oscillations: &'a [Oscillation],
    #[serde(skip_serializing_if = "<[SteepFall]>::is_empty")]
    steep_falls: &'a [SteepFall],
    axes: Vec<AxisSummary<'a>>,
    circle_before: &'a CircleReport,
    circle_after: &'a CircleReport,
    burst_reduction_percent: f64,
    method: &'static str,
    tried: Vec<TrialSummary>,
    feeds: &'a [AtFeed],
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    broke_off: &'a [String],
    tuning_circles: u32,
    bus_load_percent: f64,
    date: &'a str,
    program: String,
    simulation: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    passes: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<String>,
}

#[derive(Serialize)]
struct AxisSummary<'a> {
    name: &'a str,
    #[serde(flatten)]
    report: &'a Report,
}

/// A machine that was commissioned.
pub struct Commissioned<'a> {
    /// The machine.
    pub stand: &'a Stand<'a>,
    /// The circle that it was commissioned on.
    pub circle: &'a Circle,
    /// What the loops do by themselves, too little to end the job.
    pub oscillations: &'a [Oscillation],
    /// Axes whose friction falls faster than their loops hold against.
    pub steep_falls: Vec<SteepFall>,
    /// What each axis lacks.
    pub results: &'a [Identification],
    /// The circle without compensation.
    pub before: &'a CircleRun,
    /// Circles at several feeds.
    pub feeds: Feeds,
    /// What was tried, and what was taken.
    pub trials: &'a Trials,
    /// The circle with it.
    pub after: &'a CircleRun,
    /// What circular deviation G may be, µm.
    pub tolerance_um: Option<f64>,
    /// When it was, UTC.
    pub date: String,
    /// Whether a simulator stands in for the machine.
    pub is_simulation: bool,
}

/// How much smaller the largest burst has become, percent.
#[must_use]
pub fn burst_reduction_percent(before: &CircleReport, after: &CircleReport) -> f64 {
    less_percent(before.figures.peak_max_um, after.figures.peak_max_um)
}

impl Commissioned<'_> {
    /// Writes everything into a folder.
    ///
    /// # Errors
    /// Where a file cannot be written, or the machine does not run the reversals.
    pub fn write(&self, out: &Path) -> Outcome<()> {
        write(&out.join("summary.json"), &json(&self.summary())?)?;
        let circle = self.circle_picture();
        write(&out.join("circle.svg"), &standalone(&circle))?;
        write(&out.join("report.html"), &self.page(&circle)?)
    }

    /// The verdict in a sentence, where there is a tolerance: why there is none, where too much of
    /// the circle was lost.
    #[must_use]
    pub fn verdict(&self) -> Option<String> {
        self.tolerance_um?;
        let Whole {
            points: [there, wanted],
            largest_hole_deg,
        } = self.after.report.whole;
        let not_judged = || {
            format!(
                "NOT JUDGED: {there} of {wanted} points of the circle came over the bus, the largest hole is {largest_hole_deg:.1}°"
            )
        };
        let judged = self.judged();
        Some(judged.map_or_else(not_judged, |judged| judged.sentence()))
    }

    /// Circular deviation against the tolerance, where there is one and the circle is whole.
    #[must_use]
    pub fn judged(&self) -> Option<Judged> {
        let is_whole = self.after.report.is_whole;
        self.tolerance_um
            .filter(|_| is_whole)
            .map(|tolerance_um| Judged {
                tolerance_um,
                is_um: self.after.report.roundness.circular_deviation_g_both_um,
                is_simulated: self.is_simulation,
            })
    }

    fn summary(&self) -> SummaryFile<'_> {
        let machine = self.stand.machine;
        let axes = machine.axes.iter().zip(self.results);
        SummaryFile {
            machine: &machine.name,
            oscillations: self.oscillations,
            steep_falls: &self.steep_falls,
            axes: axes
                .map(|(axis, result)| AxisSummary {
                    name: &axis.name,
                    report: &result.report,
                })
                .collect(),
            circle_before: &self.before.report,
            circle_after: &self.after.report,
            burst_reduction_percent: self.reduction_percent(),
            method: self.trials.method,
            tried: self.trials.summaries(),
            feeds: &self.feeds.run,
            broke_off: &self.feeds.broke_off,
            tuning_circles: self.trials.circles(),
            bus_load_percent: f64::from(machine.bus_load_per_mille()) / 10.0,
            date: &self.date,
            program: program(),
            simulation: self.is_simulation,
            tolerance_um: self.tolerance_um,
            passes: self.judged().map(|judged| judged.passes()),
            verdict: self.verdict(),
        }
    }

    pub(super) fn reduction_percent(&self) -> f64 {
        burst_reduction_percent(&self.before.report, &self.after.report)
    }
}
