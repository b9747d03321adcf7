//! `report.html`: the certificate first, then the chain from the residual over the effect to the
//! micrometre, then axis by axis what that rests on.

use axis_model::EffectName;
use identification::{Identification, figures};
use maud::html;

use super::feeds::{self, less_percent};
use super::program::program;
use super::result::Commissioned;
use super::reversal_curves::{ReversalRun, six_curves};
use super::reversal_run::reversal_rows;
use super::trials::{DECLARED, EXTENDED, SELF_TUNED, not_taken};
use crate::error::Outcome;
use crate::presentation::certificate::Certificate;
use crate::presentation::circle_pictures::{Shown, circles};
use crate::presentation::circle_tables::{cause_table, circle_table};
use crate::presentation::compensation_words;
use crate::presentation::page::Page;
use crate::presentation::plots::Ink;
use crate::presentation::result_chapters::add_identification;
use crate::presentation::result_tables::{TextTable, head, sentence};
use crate::session::AT_TABLE;

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
        .map(|(name, ink, run)| Shown {
            name,
            ink,
            clockwise: ink,
            run,
        });
        circles(
            &title,
            [&axes[0].name, &axes[1].name],
            &list,
            self.tolerance_um,
        )
    }

    /// The report; `circle` is the picture of the circle before and after.
    pub(super) fn page(&self, circle: &str) -> Outcome<String> {
        let machine = self.stand.machine;
        let mut page = Page::untitled(&format!("Machine {}: circular test", machine.name));
        self.add_certificate(&mut page, circle);
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

    fn add_certificate(&self, page: &mut Page, circle: &str) {
        let (before, after) = (&self.before.report, &self.after.report);
        let sentence = self.headline();
        page.foot(&self.foot());
        let certificate = Certificate {
            machine: &self.stand.machine.name,
            is_simulation: self.is_simulation,
            verdict: self.verdict().map(|verdict| {
                let passes = self.judged().is_some_and(|judged| judged.passes());
                (verdict, passes)
            }),
            sentence: &sentence,
            facts: &self.facts(),
            circle,
            figures: &circle_table(before, after),
            causes: &cause_table(&before.causes, &after.causes),
            feeds: &feeds::table(&self.feeds),
            downloaded: &self.downloaded(),
            notes: &self.notes(),
        };
        page.add(&certificate.markup());
    }

    fn headline(&self) -> String {
        let [before, after] = [self.before, self.after].map(|run| run.report.spike_um());
        if self.trials.method == "none" {
            return format!(
                "Largest reversal spike of the circle: {before:.2}\u{a0}µm; nothing that was tried makes it smaller without making another circle worse, so nothing is compensated."
            );
        }
        format!(
            "Largest reversal spike of the circle: {before:.2}\u{a0}µm before, {after:.2}\u{a0}µm with {}, {:.1}\u{a0}% less.",
            in_words(self.trials.method),
            less_percent(before, after)
        )
    }

    /// What stands on every printed page.
    fn foot(&self) -> String {
        let simulation = if self.is_simulation {
            "SIMULATION, "
        } else {
            ""
        };
        format!(
            "{simulation}machine {}, {}, {}",
            self.stand.machine.name,
            self.date,
            program()
        )
    }

    /// Date, program and test block.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let report = &self.after.report;
        let names = self.stand.axis_names();
        let period_s = self.stand.machine.period_s;
        let missed = [self.before, self.after].map(|run| run.report.missed_cycles);
        vec![
            ("date of test", self.date.clone()),
            ("axes", names.join(", ")),
            ("plane", names[..2].concat()),
            ("radius", format!("{}\u{a0}mm", report.radius_mm)),
            ("feed F", format!("{:.0}\u{a0}mm/min", report.feed_mm_min)),
            ("turns", "3 counter-clockwise, 1 clockwise".into()),
            ("sampled every", format!("{}\u{a0}ms", 1.0e3 * period_s)),
            (
                "missed cycles before, after",
                format!("{}, {}", missed[0], missed[1]),
            ),
            ("compensation", self.trials.method.to_owned()),
            ("connected by", self.stand.place.in_words()),
            ("program", program()),
        ]
    }

    /// Parameters and a column for each axis.
    fn downloaded(&self) -> TextTable {
        let mut rows = vec![head(["parameter"])];
        rows[0].extend(self.stand.axis_names());
        let of_axes: Vec<_> = self
            .trials
            .taken
            .iter()
            .map(compensation_words::values)
            .collect();
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in of_axes.iter().flatten() {
            if !names.contains(name) {
                names.push(name);
            }
        }
        rows.extend(names.iter().map(|name| {
            let of = |values: &Vec<(&str, String)>| {
                let own = values.iter().find(|(own, _)| own == name);
                own.map_or_else(|| "–".to_owned(), |(_, value)| value.clone())
            };
            let mut row = vec![(*name).to_owned()];
            row.extend(of_axes.iter().map(of));
            row
        }));
        if names.is_empty() {
            rows.push(vec!["nothing".into()]);
        }
        rows
    }

    /// By what the figures were measured, and how they are defined.
    fn notes(&self) -> Vec<String> {
        let seen = if self.before.report.deviation_of == AT_TABLE {
            "Measured by the simulation's true table position; no measurement uncertainty is stated or taken into account."
        } else {
            "Measured by the load scales of the axes, which do not see their own errors nor what is between them and the tool; no measurement uncertainty is stated or taken into account."
        };
        let mut notes = vec![
            seen.to_owned(),
            "G, H, Fmax and Fmin by ISO 230-4:2022: G about the least-squares centre, which the standard lets stand for the minimum zone (never smaller); H from means over 0.5°.".to_owned(),
        ];
        let hidden = [self.before, self.after].iter().any(|run| {
            let causes = run.report.causes.iter();
            causes
                .filter(|own| own.cause == "servo mismatch")
                .any(|own| own.um.is_none())
        });
        notes.push(if hidden {
            "A reversal spike is the largest deviation from the median within 15° of a reversal (more with a gap), of either direction, mean of its turns. On so small or fast a circle the spikes take up so much of it that nothing else \
             can be told apart from them: what else there is, is in them.".to_owned()
        } else {
            "A reversal spike is the largest deviation within 15° of a reversal (more with a gap) beside all other causes, of either direction, mean of its turns. The µm of every other cause are the circular \
             deviation that it alone would make, by least squares over both directions outside the spikes. What is not friction or backlash is not corrected by this program.".to_owned()
        });
        notes.extend(self.oscillations.iter().map(|own| own.sentence() + "."));
        notes.extend(self.steep_falls.iter().map(|own| own.sentence() + "."));
        notes
    }

    /// Which friction model was needed: residual, effect, micrometres.
    fn add_chain(&self, page: &mut Page) {
        page.heading("Which model of friction was needed, and what it is worth");
        page.paragraph(
            "The declared model is what was known of the axes beforehand; the extended one has what their records show beside it.",
        );
        for (axis, result) in self.stand.machine.axes.iter().zip(self.results) {
            page.paragraph(&format!(
                "Axis {}. {}.",
                axis.name,
                sentence(&result.report)
            ));
        }
        page.add(&html! { ul.notes { @for (name, words) in self.found_words() { li { b { (name) } ": " (words) } } } });
        page.table(&self.force_table());
        if let Some(worth) = self.worth() {
            page.key(&worth);
        }
        page.paragraph(
            "What was tried on the circle, by its largest burst (from the median of the whole circle, so squareness and scaling are in it). The one that leaves least, and makes no circle at another feed worse, is in the drives and in compensation.toml; the model by all that is known is kept where it leaves at most 2 % more, since errors of pitch hide what is left of friction, and one that the drives refine where it leaves another 0.2 µm more, since it follows slow change.",
        );
        page.table(&self.trials_table());
        for (method, harm) in &self.trials.harmful {
            page.paragraph(&not_taken(in_words(method), harm));
        }
        page.pictures(&[feeds::picture(&self.feeds), self.circle_after_picture()]);
        for sentence in &self.feeds.broke_off {
            page.paragraph(sentence);
        }
    }

    /// The effects that were found, with what they are.
    fn found_words(&self) -> Vec<(&'static str, &'static str)> {
        let found = self.found();
        let names = found
            .iter()
            .filter_map(|name| name.parse::<EffectName>().ok());
        names.map(|name| (name.as_str(), name.words())).collect()
    }

    /// Effects that were found on any axis.
    fn found(&self) -> Vec<&str> {
        let mut found: Vec<&str> = Vec::new();
        for name in self.results.iter().flat_map(|result| &result.report.found) {
            if !found.contains(&name.as_str()) {
                found.push(name);
            }
        }
        found
    }

    /// The circle after at a scale of its own.
    fn circle_after_picture(&self) -> String {
        let axes = &self.stand.machine.axes;
        let shown = Shown {
            name: "after",
            ink: Ink::After,
            clockwise: Ink::Other(3),
            run: self.after,
        };
        circles(
            "The circle after, at its own scale",
            [&axes[0].name, &axes[1].name],
            &[shown],
            None,
        )
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
        let (declared, extended) = (left(DECLARED)?, left(EXTENDED)?);
        let found = self.found();
        Some(format!(
            "With the declared model in the drives a burst of {declared:.2}\u{a0}µm is left on the circle, with {} added {extended:.2}\u{a0}µm: what was found is worth {:.2}\u{a0}µm.",
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
        let (report, axis) = (&self.before.report, &self.stand.machine.axes[0].name);
        page.heading(&format!(
            "A reversal of axis {axis} in time, R {} mm, F {:.0} mm/min, at 180°",
            report.radius_mm, report.feed_mm_min
        ));
        page.paragraph(
            "Before and after: setpoint, table, disturbance (friction and other forces that the motor has to overcome), drive force, speed of the motor, error.",
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
        EXTENDED => "the model of friction",
        SELF_TUNED => "the model of friction, refined by the drives",
        other => other,
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
