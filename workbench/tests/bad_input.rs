//! Bad input: one clear line on stderr, nothing on stdout, exit code 2, nothing written.

use std::path::Path;
use std::process::{Command, Output};

fn quadrant(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadrant"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs the program and checks the form of its refusal; the message has to contain every given
/// part.
fn refused(name: &str, arguments: &[&str], parts: &[&str]) {
    let output = quadrant(arguments);
    let (out, err) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert_eq!(
        output.status.code(),
        Some(2),
        "{name}: exit code; stderr: {err}"
    );
    assert_eq!(out, "", "{name}: nothing but results on stdout");
    for part in parts {
        assert!(err.contains(part), "{name}: `{part}` is not in: {err}");
    }
    assert!(!err.contains("panicked"), "{name}: {err}");
    let own = err
        .lines()
        .filter(|line| line.starts_with("quadrant:"))
        .count();
    assert!(
        own == 1 && err.lines().count() == 1,
        "{name}: one line, got: {err}"
    );
}

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// A machine file with one replacement, and what the refusal has to say.
#[test]
#[expect(clippy::too_many_lines, reason = "a table of inputs")]
fn malformed_machine_files_name_file_line_and_key() {
    let folder = tempfile::tempdir().unwrap();
    let good = plant_sim::Machine::reference_text();
    let cases: [(&str, &str, &str, &[&str]); 14] = [
        (
            "negative mass",
            "table_mass_kg = 300.0",
            "table_mass_kg = -300.0",
            &["table_mass_kg", "must be", "-300"],
        ),
        (
            "unknown key",
            "backlash_m = 0.0",
            "backlash_mm = 0.0",
            &["unknown field `backlash_mm`"],
        ),
        (
            "missing key",
            "lead_m_per_rev = 0.010\n",
            "",
            &["missing field `lead_m_per_rev`"],
        ),
        (
            "text for a number",
            "coulomb_n = 400.0",
            "coulomb_n = \"400 N\"",
            &["coulomb_n", "expected"],
        ),
        ("not TOML", "[loop]", "[loop", &["m.toml:"]),
        (
            "static below Coulomb",
            "static_n = 520.0",
            "static_n = 20.0",
            &["static_n", "400"],
        ),
        (
            "unknown effect",
            "\"offset\"",
            "\"ofset\"",
            &["unknown effect \"ofset\"", "known:"],
        ),
        (
            "unknown law",
            "law = \"lu-gre\"",
            "law = \"lugre\"",
            &["lugre"],
        ),
        (
            "period of seconds",
            "period_s = 1.0e-3",
            "period_s = 1.0",
            &["period_s"],
        ),
        (
            "bit rate beyond CAN",
            "bit_rate = 1_000_000",
            "bit_rate = 2_000_000",
            &["bit_rate", "2000000"],
        ),
        (
            "axis like nobody",
            "like = \"X\"",
            "like = \"Q\"",
            &["like", "\"Q\""],
        ),
        (
            "unknown sensor",
            "position_sensor = \"load\"",
            "position_sensor = \"table\"",
            &["table"],
        ),
        (
            "stiffness beyond the sub-step",
            "screw_stiffness_n_per_m = 1.2e8",
            "screw_stiffness_n_per_m = 1.2e11",
            &["screw_stiffness_n_per_m"],
        ),
        (
            "not a number",
            "velocity_filter = 0.6",
            "velocity_filter = nan",
            &["velocity_filter", "NaN"],
        ),
    ];
    for (name, replace, by, parts) in cases {
        assert!(good.contains(replace), "{name}");
        let path = file(folder.path(), "m.toml", &good.replacen(replace, by, 1));
        let line = ["m.toml:"];
        let parts: Vec<&str> = parts.iter().chain(&line).copied().collect();
        refused(
            name,
            &[
                "circle",
                "--machine",
                &path,
                "--radius-mm",
                "10",
                "--feed-mm-min",
                "1000",
            ],
            &parts,
        );
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table of inputs")]
fn impossible_options_say_what_was_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = file(
        folder.path(),
        "pulse.toml",
        "[[axis]]\nname = \"X\"\nreversal = { method = \"pulse\", height_m_per_s = 0.001, time_constant_s = -0.1, start_delay_s = 0.0 }\n",
    );
    let garbled = file(
        folder.path(),
        "garbled.toml",
        "[[axis]]\nname = \"X\"\nreversal = { method = \"magic\" }\n",
    );
    let one_axis = plant_sim::Machine::reference_text()
        .split("[[axis]]\nname = \"Y\"")
        .next()
        .unwrap()
        .to_owned();
    let one_axis = file(folder.path(), "one.toml", &one_axis);
    let circle = ["circle", "--radius-mm", "10", "--feed-mm-min", "1000"];
    let with = |more: &[&'static str]| [&circle[..], more].concat();
    let cases: [(&str, Vec<&str>, &[&str]); 17] = [
        (
            "radius zero",
            vec!["circle", "--radius-mm", "0", "--feed-mm-min", "1000"],
            &["--radius-mm", "above zero"],
        ),
        (
            "feed negative",
            vec!["circle", "--radius-mm", "10", "--feed-mm-min=-5"],
            &["--feed-mm-min", "above zero"],
        ),
        (
            "feed not a number",
            vec!["circle", "--radius-mm", "10", "--feed-mm-min", "fast"],
            &["--feed-mm-min"],
        ),
        (
            "radius beyond the travel",
            vec!["circle", "--radius-mm", "400", "--feed-mm-min", "1000"],
            &["250", "400"],
        ),
        (
            "feed beyond the limits",
            vec!["circle", "--radius-mm", "1", "--feed-mm-min", "20000"],
            &["acceleration"],
        ),
        (
            "radius missing",
            vec!["circle", "--feed-mm-min", "1000"],
            &["--radius-mm"],
        ),
        (
            "unknown compensation",
            with(&["--compensation", "magic"]),
            &["magic", "pulse"],
        ),
        (
            "pulse without file",
            with(&["--compensation", "pulse"]),
            &["--compensation-file", "quadrant tune"],
        ),
        (
            "file without method",
            with(&["--compensation-file", "x.toml"]),
            &["--compensation"],
        ),
        (
            "negative time constant",
            [
                &with(&["--compensation", "pulse", "--compensation-file"])[..],
                &[&pulse],
            ]
            .concat(),
            &["time_constant_s"],
        ),
        (
            "unknown method in file",
            [
                &with(&["--compensation", "pulse", "--compensation-file"])[..],
                &[&garbled],
            ]
            .concat(),
            &["garbled.toml:3", "magic"],
        ),
        (
            "no such machine file",
            with(&["--machine", "/nowhere/m.toml"]),
            &["/nowhere/m.toml", "cannot read"],
        ),
        (
            "one axis for a circle",
            [&with(&["--machine"])[..], &[&one_axis]].concat(),
            &["two axes"],
        ),
        ("no such interface", with(&["--can", "nocan9"]), &["nocan9"]),
        (
            "node id beyond CANopen",
            vec![
                "servo",
                "--node",
                "200",
                "--plant-node",
                "0x11",
                "--can",
                "vcan0",
            ],
            &["1 to 127"],
        ),
        (
            "same node twice",
            vec![
                "servo",
                "--node",
                "17",
                "--plant-node",
                "0x11",
                "--can",
                "vcan0",
            ],
            &["two different"],
        ),
        (
            "plant that the machine has not",
            vec!["plant", "--node", "0x1F", "--can", "vcan0"],
            &["0x1f", "0x11 to 0x12"],
        ),
    ];
    for (name, arguments, parts) in cases {
        refused(name, &arguments, parts);
    }
    let shared = plant_sim::Machine::reference_text()
        .replacen("name = \"X\"", "name = \"X\"\ninterface = \"can0\"", 1)
        .replace("like = \"X\"", "like = \"X\"\ninterface = \"can0\"");
    let shared = file(folder.path(), "shared.toml", &shared);
    let clocked = [
        "plant",
        "--machine",
        &shared,
        "--can",
        "vcan0",
        "--pace",
        "clock",
    ];
    refused(
        "two axes on one clock-paced bus",
        &clocked,
        &["91.1 %", "80 %"],
    );
    refused("unknown command", &["dance"], &["dance"]);
    refused(
        "start delay beyond reason",
        &[
            "tune",
            "--method",
            "pulse",
            "--out",
            "x",
            "--start-delay-ms",
            "5000",
        ],
        &["--start-delay-ms"],
    );
}

const DATASET: &str = "name = \"t\"\nsample_period_s = 0.001\n[axis]\nkind = \"linear\"\n[declared]\neffects = [\"inertia\", \"coulomb\"]\n";

/// A record of a moving axis, with one row replaced.
fn record(rows: usize, replace: Option<(usize, &str)>) -> String {
    let mut text = String::from("time_s,position_m,force_n\n");
    for row in 0..rows {
        let t = 0.001 * row as f64;
        let line = format!(
            "{t:.3},{:.6},{:.3}\n",
            0.05 * (3.0 * t).sin(),
            100.0 * (3.0 * t).cos() - 20.0 * (3.0 * t).sin()
        );
        text.push_str(match replace {
            Some((at, by)) if at == row => by,
            _ => &line,
        });
    }
    text
}

#[test]
fn broken_records_name_file_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display().to_string();
    let constant: String = record(4000, None)
        .lines()
        .map(|l| {
            if l.starts_with("time") {
                format!("{l}\n")
            } else {
                format!("{},5\n", l.rsplit_once(',').unwrap().0)
            }
        })
        .collect();
    let still: String = (0..4000).fold("time_s,position_m,force_n\n".to_owned(), |text, row| {
        text + &format!("{},0.1,{}\n", 0.001 * f64::from(row), row % 7)
    });
    let micro: String = record(4000, None).replace("position_m", "position_um");
    let cases: [(&str, String, &str, &[&str]); 12] = [
        (
            "NaN",
            record(4000, Some((1000, "1.000,NaN,3\n"))),
            DATASET,
            &["train.csv:1002", "position_m", "NaN"],
        ),
        (
            "text",
            record(4000, Some((1000, "1.000,0.1,strong\n"))),
            DATASET,
            &["train.csv:1002", "force_n", "strong"],
        ),
        (
            "row too short",
            record(4000, Some((1000, "1.000,0.1\n"))),
            DATASET,
            &["train.csv"],
        ),
        (
            "time goes back",
            record(4000, Some((1000, "0.5,0.1,3\n"))),
            DATASET,
            &["train.csv:1002", "time_s does not increase"],
        ),
        (
            "a gap in time",
            record(4000, Some((3999, "9.0,0.1,3\n"))),
            DATASET,
            &["train.csv:4001", "missing", "split"],
        ),
        ("one row", record(1, None), DATASET, &["1 rows", "at least"]),
        ("empty file", String::new(), DATASET, &["time_s"]),
        (
            "constant effort",
            constant,
            DATASET,
            &["force_n is constant"],
        ),
        ("no motion", still, DATASET, &["hardly moves"]),
        (
            "wrong unit in the header",
            micro,
            DATASET,
            &["no column position_m", "position_um"],
        ),
        (
            "declared: unknown effect",
            record(4000, None),
            "[declared]\neffects = [\"gravity\"]\n",
            &["gravity", "known:"],
        ),
        (
            "dataset.toml is not TOML",
            record(4000, None),
            "[axis\n",
            &["dataset.toml:1"],
        ),
    ];
    for (name, csv, toml, parts) in cases {
        file(folder.path(), "train.csv", &csv);
        file(folder.path(), "dataset.toml", toml);
        refused(name, &["identify", &path], parts);
    }
    refused(
        "no such folder",
        &["identify", "/nowhere/data"],
        &["/nowhere/data", "not a folder"],
    );
    file(folder.path(), "train.csv", &record(4000, None));
    file(folder.path(), "dataset.toml", DATASET);
    let lone = file(
        folder.path(),
        "other.csv",
        &record(4000, None).replace("force_n", "current_a"),
    );
    refused(
        "other effort in the validation record",
        &["identify", &path, "--validate", &lone],
        &["current_a", "force_n"],
    );
    std::fs::remove_file(folder.path().join("dataset.toml")).unwrap();
    refused("no dataset.toml", &["identify", &path], &["dataset.toml"]);
}

#[test]
fn every_command_explains_itself() {
    for command in [
        "commission",
        "identify",
        "circle",
        "tune",
        "plant",
        "servo",
        "machine",
    ] {
        let output = quadrant(&[command, "--help"]);
        assert_eq!(output.status.code(), Some(0), "{command}");
        assert!(
            String::from_utf8_lossy(&output.stdout).contains("Usage: quadrant"),
            "{command}"
        );
    }
}

/// A record of an axis of 100 kg with friction, along two sines, with the controller that made its
/// effort; columns may be scaled.
fn plausible(position: f64, load: f64, reference: f64, effort: f64, time: f64) -> String {
    let mut text = String::from("time_s,reference_m,position_m,load_position_m,force_n\n");
    let path = |t: f64| 0.05 * (3.0 * t).sin() + 0.01 * (11.0 * t).sin();
    for row in 0..6000 {
        let t = 0.001 * f64::from(row);
        let velocity = 0.15 * (3.0 * t).cos() + 0.11 * (11.0 * t).cos();
        let acceleration = -0.45 * (3.0 * t).sin() - 1.21 * (11.0 * t).sin();
        let force = 100.0 * acceleration + 200.0 * velocity + 20.0 * velocity.signum();
        let x = (path(t) / 1.0e-6).round() * 1.0e-6;
        text += &format!(
            "{:.3},{:.9},{:.6},{:.6},{:.4}\n",
            time * t,
            // A velocity controller without position gain: the setpoint is where the axis is plus
            // what makes the force.
            reference * (x + force / 40.0e3),
            position * x,
            load * x,
            effort * force
        );
    }
    text
}

const CONTROLLED: &str = "name = \"t\"\nsample_period_s = 0.001\n[axis]\nkind = \"linear\"\nencoder_resolution_m = 1e-6\n\
    [controller]\nposition_gain_per_s = 40000\nvelocity_gain_n_s_per_m = 1\n[declared]\neffects = [\"inertia\", \"viscous\", \"coulomb\"]\n";

#[test]
#[expect(clippy::too_many_lines, reason = "a table of inputs")]
fn records_that_cannot_be_what_they_say_are_refused_with_what_they_look_like() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display().to_string();
    let uncontrolled = "[axis]\nkind = \"linear\"\n";
    let typo = CONTROLLED.replace("encoder_resolution_m", "encoder_resolutoin_m");
    let columns = format!("{CONTROLLED}[columns]\nforce_n = \"motor_force\"\n");
    let nan = CONTROLLED.replace("[declared]", "force_limit_n = nan\n[declared]");
    let odd = format!("{CONTROLLED}[columns]\nforce_n = {{ name = \"force_n\", factor = 2.0 }}\n");
    let cases: [(&str, String, &str, &[&str]); 13] = [
        (
            "a limit that is no number",
            plausible(1.0, 1.0, 1.0, 1.0, 1.0),
            &nan,
            &["force_limit_n", "NaN"],
        ),
        (
            "position in mm",
            plausible(1.0e3, 1.0e3, 1.0e3, 1.0, 1.0),
            CONTROLLED,
            &["position_m", "millimetres"],
        ),
        (
            "position in km",
            plausible(1.0e-3, 1.0e-3, 1.0e-3, 1.0, 1.0),
            uncontrolled,
            &["hardly moves", "unit of the position"],
        ),
        (
            "load in mm",
            plausible(1.0, 1.0e3, 1.0, 1.0, 1.0),
            CONTROLLED,
            &["load_position_m", "off by a thousand"],
        ),
        (
            "load with swapped sign",
            plausible(1.0, -1.0, 1.0, 1.0, 1.0),
            CONTROLLED,
            &["load_position_m", "sign is swapped"],
        ),
        (
            "load stands still",
            plausible(1.0, 0.0, 1.0, 1.0, 1.0),
            CONTROLLED,
            &["load_position_m", "stands still"],
        ),
        (
            "setpoint in mm",
            plausible(1.0, 1.0, 1.0e3, 1.0, 1.0),
            CONTROLLED,
            &["reference_m", "thousand"],
        ),
        (
            "effort in kN",
            plausible(1.0, 1.0, 1.0, 1.0e-3, 1.0),
            CONTROLLED,
            &["force_n", "0.0010 times", "unit"],
        ),
        (
            "effort with swapped sign",
            plausible(1.0, 1.0, 1.0, -1.0, 1.0),
            CONTROLLED,
            &["force_n", "sign"],
        ),
        (
            "the same without a controller",
            plausible(1.0, 1.0, 1.0, -1.0, 1.0),
            uncontrolled,
            &["force_n", "sign"],
        ),
        (
            "time in ms",
            plausible(1.0, 1.0, 1.0, 1.0, 1.0e3),
            CONTROLLED,
            &["time_s steps by 1 s", "sample_period_s"],
        ),
        (
            "a column that is not there",
            plausible(1.0, 1.0, 1.0, 1.0, 1.0),
            &columns,
            &["no column motor_force"],
        ),
        (
            "an unknown key of a column",
            plausible(1.0, 1.0, 1.0, 1.0, 1.0),
            &odd,
            &["dataset.toml"],
        ),
    ];
    for (name, csv, toml, parts) in cases {
        file(folder.path(), "train.csv", &csv);
        file(folder.path(), "dataset.toml", toml);
        refused(name, &["identify", &path], parts);
    }
    file(
        folder.path(),
        "train.csv",
        &plausible(1.0, 1.0, 1.0, 1.0, 1.0),
    );
    file(folder.path(), "dataset.toml", CONTROLLED);
    assert!(
        quadrant(&["identify", &path]).status.success(),
        "the same record with nothing wrong is taken"
    );
    file(folder.path(), "dataset.toml", &typo);
    let output = quadrant(&["identify", &path]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success()
            && text.contains("dataset.toml:5: key encoder_resolutoin_m is not known"),
        "{text}"
    );
}

#[test]
fn logs_of_the_bus_that_do_not_fit_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display().to_string();
    let dbc =
        "VERSION \"\"\nNS_ :\nBS_:\nBU_: A\nBO_ 401 F: 8 A\n SG_ X : 0|32@1- (1,0) [0|0] \"m\" A\n";
    let toml = |bus: &str, signal: &str| {
        format!(
            "[bus]\n{bus}\n[columns]\nposition_m = \"{signal}\"\nforce_n = \"{signal}\"\n[axis]\nkind = \"linear\"\n"
        )
    };
    let good = "(1.0) can0 191#0000000000000000\n";
    let cases: [(&str, &str, &str, String, &[&str]); 6] = [
        (
            "no DBC",
            good,
            "",
            toml("dbc = \"none.dbc\"", "F.X"),
            &["none.dbc"],
        ),
        (
            "not a DBC",
            good,
            "BO_ what",
            toml("dbc = \"a.dbc\"", "F.X"),
            &["a.dbc", "not a DBC"],
        ),
        (
            "unknown signal",
            good,
            dbc,
            toml("dbc = \"a.dbc\"", "F.Y"),
            &["no signal F.Y", "[columns]"],
        ),
        (
            "no signal at all",
            good,
            dbc,
            toml("dbc = \"a.dbc\"", "F"),
            &["Message.Signal"],
        ),
        (
            "not a log",
            "hello\n",
            dbc,
            toml("dbc = \"a.dbc\"", "F.X"),
            &["train.log:1", "hello", "candump"],
        ),
        (
            "cycles without a period",
            good,
            dbc,
            toml("dbc = \"a.dbc\"\ncycle = \"F\"", "F.X"),
            &["sample_period_s"],
        ),
    ];
    for (name, log, dbc, toml, parts) in cases {
        file(folder.path(), "train.log", log);
        file(folder.path(), "a.dbc", dbc);
        file(folder.path(), "dataset.toml", &toml);
        refused(name, &["identify", &path], parts);
    }
}
