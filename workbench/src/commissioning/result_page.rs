//! `report.html`: the certificate first, then the chain from the residual over the effect to the
//! micrometre, then axis by axis what that rests on.

use identification::{Identification, figures};
use maud::html;

use super::feeds;
use super::program::program;
use super::result::Commissioned;
use super::reversal_curves::{ReversalRun, six_curves};
use super::reversal_run::reversal_rows;
use super::trials::{DECLARED, SELF_TUNED};
use crate::error::Outcome;
use crate::presentation::certificate::Certificate;
use crate::presentation::circle_pictures::{Shown, circles};
use crate::presentation::circle_tables::{cause_table, circle_table};
use crate::presentation::compensation_words;
use crate::presentation::page::Page;
use crate::presentation::plots::Ink;
use crate::presentation::result_chapters::add_identification;
use crate::presentation::result_tables::{TextTable, head, sentence};

impl Commissioned<'_> {
    /// The circle before and after, in both directions.
    pub(super) fn circle_picture(&self) -> String {
        let report = &self.before.report;
        let title = format!(
            "Circle R {} mm, F {:.0} mm/min",
            report.radius_mm, report.feed_mm_min
        );
        let axes = &self.stand.machine.axes;
        let list = [
            ("before", Ink::Before, self.before),
            ("after", Ink::After, self.after),
        ]
        .map(|(name, ink, run)| Shown { name, ink, run });
        circles(
            &title,
            [&axes[0].name, &axes[1].name],
            &list,
            self.tolerance_um,
        )
    }

    pub(super) fn page(&self) -> Outcome<String> {
        let machine = self.stand.machine;
        let mut page = Page::untitled(&format!("Machine {}: circular test", machine.name));
        self.add_certificate(&mut page);
        self.add_chain(&mut page);
        for (axis, result) in machine.axes.iter().zip(self.results) {
            let title = format!("Axis {}: what the model lacks", axis.name);
            add_identification(&mut page, &title, result);
        }
        self.add_reversal(&mut page)?;
        page.heading("Files");
        self.add_files(&mut page);
        Ok(page.finish())
    }

    fn add_certificate(&self, page: &mut Page) {
        let (before, after) = (&self.before.report, &self.after.report);
        let sentence = format!(
            "Largest burst on the circle: {:.2} µm before, {:.2} µm with {}, {:.1} % less.",
            before.figures.peak_max_um,
            after.figures.peak_max_um,
            in_words(self.trials.method),
            self.reduction_percent()
        );
        let certificate = Certificate {
            machine: &self.stand.machine.name,
            is_simulation: self.is_simulation(),
            judged: self.judged(),
            sentence: &sentence,
            facts: &self.facts(),
            circle: &self.circle_picture(),
            figures: &circle_table(before, after),
            causes: &cause_table(&before.causes, &after.causes),
            feeds: &feeds::table(&self.feeds),
            downloaded: &self.downloaded(),
            notes: &self.notes(),
        };
        page.add(&certificate.markup());
    }

    /// Date, program and test block.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let report = &self.after.report;
        let names = self.stand.axis_names();
        let period_s = self.stand.machine.period_s;
        vec![
            ("date", self.date.clone()),
            ("program", program()),
            ("axes", names.join(", ")),
            ("interface", self.stand.place.in_words()),
            ("plane", names[..2].concat()),
            ("radius", format!("{} mm", report.radius_mm)),
            ("feed", format!("{:.0} mm/min", report.feed_mm_min)),
            ("turns", "3 counter-clockwise, 1 clockwise".into()),
            ("sampled every", format!("{} ms", 1.0e3 * period_s)),
            ("compensation", in_words(self.trials.method).to_owned()),
            ("missed cycles", report.missed_cycles.to_string()),
            ("bus load", format!("{:.1} %", report.bus_load_percent)),
        ]
    }

    fn downloaded(&self) -> TextTable {
        let mut rows = vec![head(["axis", "what its drive has got"])];
        let axes = self.stand.axis_names().into_iter();
        rows.extend(axes.zip(&self.trials.taken).map(|(name, own)| {
            let gap = match own.backlash_m {
                gap_m if gap_m > 0.0 => format!("; backlash {:.2} µm", 1.0e6 * gap_m),
                _ => String::new(),
            };
            vec![name, compensation_words::in_words(&own.reversal) + &gap]
        }));
        rows
    }

    /// By what the figures were measured, and how they are defined.
    fn notes(&self) -> String {
        let seen = if self.is_simulation() {
            "Measured by the simulation's true table position"
        } else {
            "Measured by the load scales of the axes, which do not see their own errors nor what is between them and the tool"
        };
        let unfit: Vec<String> = self
            .oscillations
            .iter()
            .map(|own| own.sentence() + ". ")
            .collect();
        format!(
            "{seen}. G, H and F by ISO 230-4:2022; G about the least-squares centre, which the standard lets stand for the minimum zone. A burst is the \
             largest deviation from the median within 15° of a reversal, mean of three turns. A cause's µm are the circular deviation that it alone would make, by \
             least squares over both directions outside the bursts. {}Compensation values: compensation.toml.",
            unfit.concat()
        )
    }

    /// From the residual over the effect to the micrometre.
    fn add_chain(&self, page: &mut Page) {
        page.heading("From the residual to the micrometre");
        for (axis, result) in self.stand.machine.axes.iter().zip(self.results) {
            page.paragraph(&format!(
                "Axis {}. {}.",
                axis.name,
                sentence(&result.report)
            ));
        }
        page.table(&self.force_table());
        if let Some(worth) = self.worth() {
            page.key(&worth);
        }
        page.paragraph("What was tried on the circle; the one that leaves least is in the drive and in compensation.toml.");
        page.table(&self.trials_table());
        page.pictures(&[feeds::picture(&self.feeds)]);
        for sentence in &self.feeds.broke_off {
            page.paragraph(sentence);
        }
    }

    /// What the effects that were found are worth on the circle.
    fn worth(&self) -> Option<String> {
        let left = |method: &str| {
            let tried = self.trials.summaries();
            tried
                .into_iter()
                .find(|own| own.method == method)
                .map(|own| own.burst_after_um)
        };
        let (declared, extended) = (left(DECLARED)?, left("model")?);
        let mut found: Vec<&str> = Vec::new();
        for name in self.results.iter().flat_map(|result| &result.report.found) {
            if !found.contains(&name.as_str()) {
                found.push(name);
            }
        }
        Some(format!(
            "Fed forward, the declared model leaves a burst of {declared:.2} µm, the model with {} {extended:.2} µm: what was found is worth {:.2} µm on this circle.",
            found.join(", "),
            declared - extended
        ))
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

    fn force_table(&self) -> TextTable {
        let mut rows = vec![head(["validation record", "declared", "extended", "unit"])];
        let axes = self.stand.machine.axes.iter();
        for (axis, result) in axes.zip(self.results) {
            rows.extend(force_rows(&axis.name, result));
        }
        rows
    }

    /// What lies beside the report, to click on.
    fn add_files(&self, page: &mut Page) {
        let records = self.stand.machine.axes.iter().map(|axis| {
            let name = format!("records-{}/train.csv", axis.name);
            (
                name,
                "a dataset for quadrant identify, with validate.csv beside it",
            )
        });
        let files = FILES.map(|(name, what)| (name.to_owned(), what));
        page.add(&html! {
            ul { @for (name, what) in files.into_iter().chain(records) { li { a href=(name) { (name) } ": " (what) } } }
        });
    }

    /// The six curves of the paper's Fig. 8(a), about one reversal of the first axis on a sine.
    fn add_reversal(&self, page: &mut Page) -> Outcome<()> {
        page.heading("One reversal in time");
        page.paragraph(
            "The six curves of the paper's Fig. 8(a) about a reversal of the first axis, before and after: setpoint, table, disturbance \
             (friction and other forces that the motor has to overcome), drive force, speed of the motor, error.",
        );
        let before = reversal_rows(self.stand, &self.stand.uncompensated(), self.circle)?;
        let after = reversal_rows(self.stand, &self.trials.taken, self.circle)?;
        let runs = [
            ("before", [Ink::Before, Ink::Other(2)], &before),
            ("after", [Ink::After, Ink::Other(3)], &after),
        ]
        .map(|(name, inks, rows)| ReversalRun { name, inks, rows });
        page.pictures(&six_curves(self.stand.machine, &runs));
        Ok(())
    }
}

/// What lies beside the report.
const FILES: [(&str, &str); 8] = [
    ("summary.json", "every figure"),
    (
        "circle-before.csv",
        "the circle before, one turn in each direction",
    ),
    ("circle-after.csv", "the circle after"),
    ("circle.svg", "their picture"),
    (
        "compensation.toml",
        "what the drives have got: quadrant circle --compensation-file takes it",
    ),
    ("model.toml", "the identified machine"),
    ("records.candump.log", "every frame of the records"),
    ("quadrant.dbc", "what is in the frames"),
];

fn in_words(method: &str) -> &str {
    match method {
        "pulse" => "the tuned pulse",
        DECLARED => "the declared model of friction",
        "model" => "the model of friction",
        SELF_TUNED => "the model of friction, refined by the drives",
        _ => "no compensation, since none helps",
    }
}

fn force_rows(axis: &str, result: &Identification) -> [Vec<String>; 2] {
    let errors = &result.report.validate;
    [
        row(
            &format!("force error, axis {axis}"),
            [
                errors.force_error_before_percent,
                errors.force_error_after_percent,
            ],
            "%",
        ),
        row(
            &format!("force not explained about reversals, axis {axis}"),
            [errors.reversal_error_before, errors.reversal_error_after],
            result.effort_unit,
        ),
    ]
}

fn row(name: &str, [before, after]: [f64; 2], unit: &str) -> Vec<String> {
    vec![
        name.to_owned(),
        figures::error(before),
        figures::error(after),
        unit.to_owned(),
    ]
}
