//! What commissioning leaves for people and machines: `summary.json`, `circle.svg`, `report.html`.

use std::path::Path;

use identification::{Identification, Report, figures};
use serde::Serialize;

use super::feeds::{AtFeed, Feeds, less_percent};
use super::fitness::Oscillation;
use super::reversal_curves::six_curves;
use super::reversal_run::reversal_rows;
use super::trials::{SELF_TUNED, TrialSummary, Trials};
use crate::ballbar::Point;
use crate::circle_test::{CircleReport, CircleRun};
use crate::compensation::AxisCompensation;
use crate::error::Outcome;
use crate::output_files::{json, write};
use crate::presentation::page::Page;
use crate::presentation::plots::{self, Trace};
use crate::presentation::result_chapters::add_identification;
use crate::presentation::result_tables::{TextTable, head, sentence};
use crate::session::Stand;
use crate::trajectory::Circle;

/// `summary.json`.
#[derive(Serialize)]
struct SummaryFile<'a> {
    machine: &'a str,
    oscillations: &'a [Oscillation],
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
        write(&out.join("circle.svg"), &plots::standalone(&self.polar()?))?;
        write(&out.join("report.html"), &self.page()?)
    }

    fn summary(&self) -> SummaryFile<'_> {
        let machine = self.stand.machine;
        let axes = machine.axes.iter().zip(self.results);
        SummaryFile {
            machine: &machine.name,
            oscillations: self.oscillations,
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
        }
    }

    fn reduction_percent(&self) -> f64 {
        burst_reduction_percent(&self.before.report, &self.after.report)
    }

    fn polar(&self) -> Outcome<String> {
        let report = &self.before.report;
        let title = format!(
            "Circle R {} mm, F {:.0} mm/min",
            report.radius_mm, report.feed_mm_min
        );
        let radius_m = 1.0e-3 * report.radius_mm;
        let traces = [("before", self.before), ("after", self.after)].map(|(name, run)| Trace {
            name: name.into(),
            points: one_turn(run),
            radius_m,
        });
        plots::polar(&title, &traces)
    }

    fn page(&self) -> Outcome<String> {
        let machine = self.stand.machine;
        let mut page = Page::new(&format!("Commissioning of machine {}", machine.name));
        self.add_overview(&mut page)?;
        for (axis, result) in machine.axes.iter().zip(self.results) {
            let title = format!("Axis {}: what the model lacks", axis.name);
            add_identification(&mut page, &title, result)?;
        }
        self.add_reversal(&mut page)?;
        Ok(page.finish())
    }

    fn add_overview(&self, page: &mut Page) -> Outcome<()> {
        let first = self.results.first();
        page.key(&format!(
            "{}. Largest burst on the circle: {:.2} µm before, {:.2} µm with {}, {:.1} % less.",
            first.map_or_else(String::new, |result| sentence(&result.report)),
            self.before.report.figures.peak_max_um,
            self.after.report.figures.peak_max_um,
            in_words(self.trials.method),
            self.reduction_percent()
        ));
        for oscillation in self.oscillations {
            page.paragraph(&oscillation.sentence());
        }
        page.table(&self.feeds_table());
        for sentence in &self.feeds.broke_off {
            page.paragraph(sentence);
        }
        page.paragraph("What was tried on the circle; the one that leaves least is in the drive and in compensation.toml.");
        page.table(&self.trials_table());
        page.table(&self.overview_table());
        page.pictures(&[self.polar()?]);
        Ok(())
    }

    fn feeds_table(&self) -> TextTable {
        let of_feed = |at: &AtFeed| {
            let mut cells = vec![format!("{:.0}", at.feed_mm_min)];
            cells.extend(
                [
                    at.burst_before_um,
                    at.burst_after_um,
                    at.reduction_percent(),
                    at.circular_deviation_g_before_um,
                    at.circular_deviation_g_after_um,
                ]
                .map(figures::error),
            );
            cells
        };
        let mut rows = vec![head([
            "feed, mm/min",
            "burst before, µm",
            "burst after, µm",
            "less, %",
            "G before, µm",
            "G after, µm",
        ])];
        rows.extend(self.feeds.run.iter().map(of_feed));
        rows
    }

    fn trials_table(&self) -> TextTable {
        let mut rows = vec![head([
            "tried",
            "burst before, µm",
            "burst after, µm",
            "circles",
        ])];
        rows.extend(self.trials.summaries().iter().map(|trial| {
            vec![
                in_words(trial.method).to_owned(),
                figures::error(trial.burst_before_um),
                figures::error(trial.burst_after_um),
                trial.circles.to_string(),
            ]
        }));
        rows
    }

    fn overview_table(&self) -> TextTable {
        let mut rows = vec![head(["", "before", "after", "unit"])];
        let axes = self.stand.machine.axes.iter();
        for (axis, result) in axes.zip(self.results) {
            rows.extend(force_rows(&axis.name, result));
        }
        rows.extend(circle_rows(&self.before.report, &self.after.report));
        rows
    }

    /// The six curves of the paper's Fig. 8(a), about one reversal of the first axis on a sine.
    fn add_reversal(&self, page: &mut Page) -> Outcome<()> {
        page.heading("One reversal in time");
        page.paragraph(
            "The six curves of the paper's Fig. 8(a) about a reversal of the first axis, before and after: setpoint, table, disturbance \
             (friction and other forces that the motor has to overcome), drive force, speed of the motor, error.",
        );
        self.add_curves(page, "before", &self.stand.uncompensated())?;
        self.add_curves(page, "after", &self.trials.taken)
    }

    fn add_curves(
        &self,
        page: &mut Page,
        name: &str,
        compensation: &[AxisCompensation],
    ) -> Outcome<()> {
        let rows = reversal_rows(self.stand, compensation, self.circle)?;
        page.pictures(&six_curves(self.stand.machine, name, &rows)?);
        Ok(())
    }
}

fn in_words(method: &str) -> &str {
    match method {
        "pulse" => "the tuned pulse",
        "model" => "the model of friction",
        SELF_TUNED => "the model of friction, refined by the drives",
        _ => "no compensation, since none helps",
    }
}

fn force_rows(axis: &str, result: &Identification) -> [Vec<String>; 2] {
    let errors = &result.report.validate;
    [
        row(
            &format!("force error of the model, axis {axis}, validation record"),
            [
                errors.force_error_before_percent,
                errors.force_error_after_percent,
            ],
            "%",
        ),
        row(
            &format!("force not explained about reversals, axis {axis}, validation record"),
            [errors.reversal_error_before, errors.reversal_error_after],
            result.effort_unit,
        ),
    ]
}

/// The figures of the circle; hysteresis where both directions were run.
fn circle_rows(before: &CircleReport, after: &CircleReport) -> TextTable {
    let both = [&before.figures, &after.figures];
    let mut rows = vec![
        row("largest burst", both.map(|circle| circle.peak_max_um), "µm"),
        row(
            "circular deviation G",
            both.map(|circle| circle.circular_deviation_g_um),
            "µm",
        ),
    ];
    if let [Some(before), Some(after)] = both.map(|circle| circle.circular_hysteresis_h_um) {
        rows.push(row("circular hysteresis H", [before, after], "µm"));
    }
    rows.push(row(
        "radial deviation Fmax",
        both.map(|circle| circle.radial_deviation_fmax_um),
        "µm",
    ));
    rows.push(row(
        "radial deviation Fmin",
        both.map(|circle| circle.radial_deviation_fmin_um),
        "µm",
    ));
    rows
}

fn row(name: &str, [before, after]: [f64; 2], unit: &str) -> Vec<String> {
    vec![
        name.to_owned(),
        figures::error(before),
        figures::error(after),
        unit.to_owned(),
    ]
}

/// The first of the three turns that count.
fn one_turn(run: &CircleRun) -> &[Point] {
    &run.points[..run.points.len() / 3]
}
