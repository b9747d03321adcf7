//! The main job, end to end on the in-process bus, and its run beside a later one.

#[path = "commission/compared.rs"]
mod compared;

use std::path::Path;

use hil_tests::Scope;
use hil_tests::golden::{self, row};
use hil_tests::pictures;
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use workbench::cli::{Commission, MachineArguments};
use workbench::commands::commission::{self, Wanted};
use workbench::interrupt::Interrupt;
use workbench::network::place::Place;

#[test]
fn commissioning_names_what_the_reference_machine_lacks_and_compensates_it() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("cold");
    let machine = MachineArguments::default();
    commission::run(
        &Commission {
            machine,
            out: out.clone(),
            tolerance_um: None,
            log: false,
            real_axes: false,
        },
        &Interrupt::never(),
    )
    .unwrap();

    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut rows = Vec::new();
    for axis in summary["axes"].as_array().unwrap() {
        let name = axis["name"].as_str().unwrap();
        let mut found: Vec<&str> = axis["found"]
            .as_array()
            .unwrap()
            .iter()
            .map(|name| name.as_str().unwrap())
            .collect();
        found.sort_unstable();
        assert_eq!(found, ["presliding", "stribeck"], "axis {name}");
        assert_eq!(axis["verdict"], "explained", "axis {name}");
        let validate = |key: &str| axis["validate"][key].as_f64().unwrap();
        rows.push(row(
            format!("axis {name}, force error before"),
            validate("force_error_before_percent"),
            "%",
        ));
        rows.push(row(
            format!("axis {name}, force error after"),
            validate("force_error_after_percent"),
            "%",
        ));
        rows.push(row(
            format!("axis {name}, about reversals before"),
            validate("reversal_error_before"),
            "N",
        ));
        rows.push(row(
            format!("axis {name}, about reversals after"),
            validate("reversal_error_after"),
            "N",
        ));
        assert!(validate("force_error_after_percent") < validate("force_error_before_percent"));
        let parameter = |key: &str| axis["parameters"][key]["value"].as_f64().unwrap();
        rows.push(row(
            format!("axis {name}, Coulomb friction"),
            parameter("coulomb"),
            "N",
        ));
        rows.push(row(
            format!("axis {name}, Stribeck velocity"),
            1.0e3 * parameter("stribeck_velocity"),
            "mm/s",
        ));
    }
    let burst = |key: &str| summary[key]["peak_max_um"].as_f64().unwrap();
    let reduction = summary["burst_reduction_percent"].as_f64().unwrap();
    assert!(reduction >= 97.0, "{reduction} %");
    assert_eq!(summary["method"], "model + self-tuning");
    let tried = summary["tried"].as_array().unwrap();
    for (place, method, name) in [
        (0, "pulse", "largest burst with the tuned pulse"),
        (
            1,
            "model, declared",
            "largest burst with the declared model",
        ),
    ] {
        let own = &tried[place];
        assert_eq!(own["method"], method);
        rows.push(row(name, own["burst_after_um"].as_f64().unwrap(), "µm"));
    }
    for feed in summary["feeds"].as_array().unwrap() {
        let name = format!(
            "F {:.0}, burst after",
            feed["feed_mm_min"].as_f64().unwrap()
        );
        rows.push(row(name, feed["burst_after_um"].as_f64().unwrap(), "µm"));
    }
    rows.push(row("largest burst before", burst("circle_before"), "µm"));
    rows.push(row("largest burst after", burst("circle_after"), "µm"));
    golden::check("commission", &rows);
    check_files(&out);
    check_certificate(&out, &summary);
    let circle = std::fs::read_to_string(out.join("circle.svg")).unwrap();
    pictures::check("circle.svg", &circle);
    check_drawn_path(&out, &circle);
    compared::assert_a_warm_machine_differs_by_its_friction(&out);
}

/// The drawn circles are the recorded ones within 0.05 µm: every point of a record has a place of
/// its path as near as that, by the scale that the outermost ring says.
fn check_drawn_path(out: &Path, svg: &str) {
    let number = |text: &str| -> f64 { text.split('"').next().unwrap().parse().unwrap() };
    let rings: Vec<f64> = svg
        .split("<circle class=\"")
        .skip(1)
        .map(|ring| number(ring.split(" r=\"").nth(1).unwrap()))
        .collect();
    let (outermost, nominal) = (rings[rings.len() - 1], rings[rings.len() / 2]);
    let labels = svg
        .split('>')
        .filter_map(|text| text.strip_prefix('+')?.strip_suffix(" µm</text"));
    let largest_um = labels
        .map(|um| um.parse::<f64>().unwrap())
        .fold(0.0, f64::max);
    assert!(largest_um > 0.0);
    let drawn = Drawn {
        middle: ["cx", "cy"].map(|key| number(svg.split(&format!("{key}=\"")).nth(1).unwrap())),
        nominal,
        um_per_px: largest_um / (outermost - nominal),
    };
    for run in ["before", "after"] {
        let csv = std::fs::read_to_string(out.join(format!("circle-{run}.csv"))).unwrap();
        for (direction, class) in [("ccw", "solid"), ("cw", "back")] {
            let mark = format!("class=\"curve {run} {class}\" d=\"");
            // The first one is the line in the legend.
            let places =
                pictures::places(svg.split(&mark).nth(2).unwrap().split('"').next().unwrap());
            let worst_um = drawn.worst_um(&csv, &format!("{direction},"), &places);
            assert!(worst_um < 0.05, "{run} {direction}: {worst_um} µm");
        }
    }
}

/// How a polar plot draws deviations.
struct Drawn {
    middle: [f64; 2],
    nominal: f64,
    um_per_px: f64,
}

impl Drawn {
    /// How far the points of a record are from a path, at most.
    fn worst_um(&self, csv: &str, direction: &str, places: &[(f64, f64)]) -> f64 {
        let (mut worst_um, mut next) = (0.0_f64, 0);
        for line in csv.lines().filter_map(|line| line.strip_prefix(direction)) {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let [_, x, y, table_x, table_y] = cells[..] else {
                panic!("{line}");
            };
            let deviation_um = 1.0e6 * (table_x.hypot(table_y) - 0.1);
            let radius = self.nominal + deviation_um / self.um_per_px;
            let (sin, cos) = y.atan2(x).sin_cos();
            let at = (self.middle[0] + radius * cos, self.middle[1] - radius * sin);
            // The path passes the record in its order.
            let near = next..(next + 40).min(places.len() - 1);
            let off = near.map(|place| {
                (
                    place,
                    pictures::off_px(places[place], places[place + 1], at),
                )
            });
            let (place, off) = off.min_by(|one, other| one.1.total_cmp(&other.1)).unwrap();
            next = place;
            worst_um = worst_um.max(off * self.um_per_px);
        }
        worst_um
    }
}

/// The certificate says what `summary.json` says, to a hundredth of a micrometre.
fn check_certificate(out: &Path, summary: &serde_json::Value) {
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    let (certificate, _) = report.split_once("</section>").unwrap();
    let rows = [
        ("G, both directions", "circular_deviation_g_both_um"),
        ("G, counter-clockwise", "circular_deviation_g_um"),
        ("G, clockwise", "circular_deviation_g_clockwise_um"),
        ("H", "circular_hysteresis_h_um"),
        ("Fmax, counter-clockwise", "radial_deviation_fmax_um"),
        ("Fmin, counter-clockwise", "radial_deviation_fmin_um"),
    ];
    for (name, key) in rows {
        let cell = |run: &str| {
            let value = summary[run][key].as_f64().unwrap();
            format!("<td>{value:.2}</td>").replace('-', "−")
        };
        let row = format!(
            "<td>{name}</td>{}{}",
            cell("circle_before"),
            cell("circle_after")
        );
        assert!(certificate.contains(&row), "{row}");
    }
    let causes = summary["circle_before"]["causes"].as_array().unwrap();
    for cause in causes {
        let name = cause["cause"].as_str().unwrap();
        let um = cause["um"].as_f64().unwrap();
        let row = format!("<td>{name}</td><td>{um:.2}</td>");
        let is_told = certificate.contains(&row);
        assert!(is_told || um < 0.05 && certificate.contains(name), "{row}");
    }
    for (place, text) in ["+X (0°)", "+Y (90°)", "−X (180°)", "−Y (270°)"]
        .iter()
        .enumerate()
    {
        let um = |run: &str| summary[run]["spikes_um"][place].as_f64().unwrap();
        let label = format!(
            "{:.2} → {:.2} µm</text>",
            um("circle_before"),
            um("circle_after")
        );
        assert!(
            certificate.contains(text) && certificate.contains(&label),
            "{label}"
        );
    }
    for key in ["date", "program"] {
        assert!(
            certificate.contains(summary[key].as_str().unwrap()),
            "{key}"
        );
    }
    assert!(
        !certificate.contains("PASS") && !certificate.contains("FAIL"),
        "no tolerance was given"
    );
}

fn check_files(out: &Path) {
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    for part in [
        "<svg",
        "presliding",
        "Residual against velocity",
        "Residual against position",
        "(6) error before",
        "from ring to ring",
        "SIMULATION",
        "Causes, ranked by what they cost",
        "Downloaded to the drives",
        "tested by",
        "3 counter-clockwise, 1 clockwise",
        "Friction after a reversal",
        // Of the circle: degrees, signs of the axes, numbers of the rings, directions, bursts.
        ">+X (0°)</text>",
        ">−Y (270°)</text>",
        ">30°</text>",
        ">−20 µm</text>",
        ">after clockwise</text>",
        "Largest reversal spike of the circle: ",
    ] {
        assert!(report.contains(part), "{part} is not in the report");
    }
    let (_, effort) = report
        .split_once("<title>Effort on the validation record</title>")
        .unwrap();
    let at = |class: &str| {
        effort
            .find(&format!("class=\"curve {class}\" d=\"M66"))
            .unwrap()
    };
    assert!(
        at("recorded") < at("before") && at("before") < at("after"),
        "the record is lowest"
    );
    let (_, stribeck) = report.split_once("<title>stribeck: ").unwrap();
    let (stribeck, _) = stribeck.split_once("</svg>").unwrap();
    assert!(
        stribeck.contains(">velocity, mm/s</text>")
            && stribeck.contains(">10</text>")
            && !stribeck.contains(">20</text>")
    );
    assert!(
        !report.contains("http://")
            || report.matches("http://").count() == report.matches("http://www.w3.org").count(),
        "self-contained"
    );
    for file in ["model.toml", "compensation.toml"] {
        let text = std::fs::read_to_string(out.join(file)).unwrap();
        text.parse::<toml::Table>()
            .unwrap_or_else(|error| panic!("{file}: {error}"));
    }
    for file in [
        "records.candump.log",
        "circle-before.csv",
        "circle-after.csv",
        "records-X/train.csv",
        "records-Y/validate.csv",
        "records-X/dataset.toml",
    ] {
        assert!(
            std::fs::metadata(out.join(file)).unwrap().len() > 100,
            "{file}"
        );
    }
}

/// A machine that nothing should be tuned on, and what the report says of it.
struct Hopeless {
    name: &'static str,
    change: fn(&mut MachineAxis),
    key: &'static str,
    value: &'static str,
    said: &'static str,
}

const HOPELESS: [Hopeless; 2] = [
    Hopeless {
        name: "three times the gains",
        change: |axis| {
            axis.gains.velocity_bandwidth_hz *= 3.0;
            axis.gains.position_gain_per_s *= 3.0;
        },
        key: "verdict",
        value: "unfit",
        said: "the loop oscillates at standstill at 6",
    },
    Hopeless {
        name: "no friction to speak of",
        change: |axis| (axis.actual.sliding.coulomb_n, axis.actual.sliding.static_n) = (0.1, 0.1),
        key: "method",
        value: "none",
        said: "nothing that was tried makes it smaller",
    },
];

#[test]
fn a_machine_that_oscillates_or_has_nothing_to_compensate_gets_a_report_and_no_compensation() {
    for hopeless in Scope::now().rows("hopeless machines", &HOPELESS, 1, 2) {
        let folder = tempfile::tempdir().unwrap();
        let mut machine = Machine::reference();
        machine.axes.iter_mut().for_each(hopeless.change);
        commission::commission(
            &machine,
            Place::InProcess,
            &Wanted::into(folder.path()),
            &Interrupt::never(),
        )
        .unwrap();
        let read = |file: &str| std::fs::read_to_string(folder.path().join(file)).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
        assert_eq!(summary[hopeless.key], hopeless.value, "{}", hopeless.name);
        assert!(
            read("report.html").contains(hopeless.said),
            "{}",
            hopeless.name
        );
    }
}
