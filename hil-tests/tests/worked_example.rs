//! The worked example of `docs/identification.md`: one seeded record from the residual of its
//! declared model to the effect that it lacks, as figures and as pictures.
//!
//! `cargo test -p hil-tests --test worked_example`; with `QUADRANT_BLESS=1` the pictures in
//! `docs/identification/` are made anew. They are kept beside the golden table
//! `hil-tests/golden/worked-example.md`, so whoever changes one sees both.

use std::fmt::Write as _;
use std::path::Path;

use hil_tests::golden::{self, row};
use hil_tests::records::{self, plans::plans};
use identification::{Dataset, Identification, Report, identify};
use workbench::presentation::plots::{self, Curve, Ink, Plot};

/// The record: Stribeck friction of 1.6 times the sliding friction at breakaway, which falls over
/// 6 mm/s. Nobody tells the identification.
const SEED: u64 = 1023;
/// Velocities that the pictures show, m/s: five times the Stribeck velocity.
const SHOWN_M_PER_S: f64 = 0.03;
/// Part of the free run that its picture shows, s.
const FREE_RUN_SHOWN_S: f64 = 6.0;

fn identified() -> Identification {
    let folder = tempfile::tempdir().unwrap();
    let plan = plans().into_iter().find(|plan| plan.seed == SEED).unwrap();
    records::write(folder.path(), &plan).unwrap();
    let dataset = Dataset::read(folder.path(), None, None).unwrap();
    identify(&dataset, &mut |_| ()).unwrap()
}

#[test]
fn the_worked_example_goes_from_a_residual_to_its_effect() {
    let result = identified();
    let report = &result.report;
    assert_eq!(report.found, ["stribeck"]);
    assert_eq!(report.verdict, "explained");
    golden::check("worked-example", &figures(report));
    keep("residual-before.svg", &residual(&result, &["declared"]));
    keep("candidates.svg", &bars(report));
    keep("effect.svg", &effect(&result));
    keep(
        "residual-after.svg",
        &residual(&result, &["declared", "extended"]),
    );
    keep("free-run.svg", &free_run(&result));
}

fn figures(report: &Report) -> Vec<golden::Measured> {
    let of = |name: &str| &report.parameters.known[name];
    let half_width = |name: &str| 0.5 * (of(name).high - of(name).low);
    let [best, second] = [&report.candidates[0], &report.candidates[1]];
    let free_run = report.free_run.as_ref().unwrap().validate;
    let validate = &report.validate;
    vec![
        row(
            "force error, declared",
            validate.force_error_before_percent,
            "%",
        ),
        row(
            "force error, extended",
            validate.force_error_after_percent,
            "%",
        ),
        row(
            format!("{}: share removed", best.effect),
            100.0 * best.share,
            "%",
        ),
        row(
            format!("{}: t over blocks", best.effect),
            best.evidence,
            "1",
        ),
        row("next candidate: share removed", 100.0 * second.share, "%"),
        row("next candidate: t over blocks", second.evidence, "1"),
        row(
            "structure before",
            100.0 * report.residual.share_before,
            "%",
        ),
        row("structure after", 100.0 * report.residual.share_after, "%"),
        row("Coulomb friction", of("coulomb").value, "N"),
        row("Stribeck excess", of("stribeck_excess").value, "N"),
        row(
            "Stribeck excess, half width",
            half_width("stribeck_excess"),
            "N",
        ),
        row(
            "Stribeck velocity",
            1.0e3 * of("stribeck_velocity").value,
            "mm/s",
        ),
        row(
            "Stribeck velocity, half width",
            1.0e3 * half_width("stribeck_velocity"),
            "mm/s",
        ),
        row(
            "free run, declared",
            free_run.position_error_um_before,
            "µm",
        ),
        row("free run, extended", free_run.position_error_um_after, "µm"),
    ]
}

fn keep(name: &str, svg: &str) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/identification");
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::create_dir_all(&docs).unwrap();
        std::fs::write(docs.join(name), plots::standalone(svg)).unwrap();
    }
    assert!(
        docs.join(name).exists(),
        "docs/identification/{name} is not there"
    );
}

/// The residual of moving samples of the validation record against velocity.
fn residual(result: &Identification, models: &[&str]) -> String {
    let of = |(index, name): (usize, &&str)| {
        let slow = result.curves.moving.iter();
        let slow = slow.filter(|row| row[0].abs() < SHOWN_M_PER_S);
        Curve::cloud(
            &format!("residual of the {name} model"),
            Ink::Other(index),
            slow.map(|row| (1.0e3 * row[0], row[2 + index])),
        )
    };
    let list: Vec<Curve> = models.iter().enumerate().map(of).collect();
    let title = match models {
        [one] => format!("What the {one} model leaves (validation)"),
        _ => format!(
            "What the {} models leave (validation)",
            models.join(" and the ")
        ),
    };
    curves(&title, "velocity, mm/s", "effort, N", &list)
}

/// What the model without the effect leaves of the training record, and the effect.
fn effect(result: &Identification) -> String {
    let found = &result.curves.effects[0];
    let cloud = |which: usize, name: &str, ink: Ink| {
        let slow = found.points.iter();
        let slow = slow.filter(|point| point[0].abs() < SHOWN_M_PER_S);
        Curve::cloud(
            name,
            ink,
            slow.map(|point| (1.0e3 * point[0], point[which])),
        )
    };
    let list = [
        cloud(1, "extended model without it", Ink::Before),
        cloud(2, found.effect, Ink::After),
    ];
    let title = format!("{}: {} (training)", found.effect, found.equation);
    curves(&title, "velocity, mm/s", "effort, N", &list)
}

fn free_run(result: &Identification) -> String {
    let line = |which: usize, name: &str, ink: Ink| {
        let shown = result.curves.free_run.iter();
        let shown = shown.take_while(|point| point[0] < FREE_RUN_SHOWN_S);
        Curve::line(name, ink, shown.map(|point| (point[0], point[which])))
    };
    let list = [
        line(1, "declared", Ink::Before),
        line(2, "extended", Ink::After),
    ];
    curves(
        "Free run: simulated − recorded position (validation)",
        "time, s",
        "position error, µm",
        &list,
    )
}

fn curves(title: &str, x: &str, y: &str, list: &[Curve]) -> String {
    let plot = Plot::new(title, x, y, (640.0, 380.0));
    plots::curves(&plot, list)
}

/// The ranking as bars: the share of the held-out error that each candidate removes.
fn bars(report: &Report) -> String {
    const LEFT: f64 = 215.0;
    const WIDTH: f64 = 370.0;
    const LINE: f64 = 20.0;
    let shown: Vec<_> = report.candidates.iter().filter(|c| c.share > 0.0).collect();
    let height = LINE * (shown.len() as f64 + 2.5);
    let mut svg = format!(
        "<svg viewBox=\"0 0 640 {height}\" width=\"100%\" style=\"max-width:640px\" \
         font-family=\"sans-serif\" font-size=\"13\" xmlns=\"http://www.w3.org/2000/svg\">\n\
         <rect width=\"640\" height=\"{height}\" fill=\"#fff\"/>\n\
         <text x=\"320\" y=\"18\" text-anchor=\"middle\" font-size=\"16\">\
         Share of the held-out error that each candidate alone removes</text>\n"
    );
    for (index, candidate) in shown.iter().enumerate() {
        let y = LINE * (index as f64 + 2.0);
        let color = if candidate.accepted {
            "#1e8c46"
        } else {
            "#c8c8c8"
        };
        let _ = writeln!(
            svg,
            "<text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"end\">{}</text>\
             <rect x=\"{LEFT:.0}\" y=\"{y:.0}\" width=\"{:.1}\" height=\"14\" fill=\"{color}\"/>\
             <text x=\"{:.1}\" y=\"{:.0}\">{:.1} %</text>",
            LEFT - 8.0,
            y + 11.0,
            candidate.effect,
            WIDTH * candidate.share,
            LEFT + WIDTH * candidate.share + 6.0,
            y + 11.0,
            100.0 * candidate.share
        );
    }
    svg + "</svg>\n"
}
