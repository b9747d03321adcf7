//! A machine that lacks seven effects at once, as `commission` records and identifies it: all of
//! them named and none beside them, and what each parameter comes out as.

use hil_tests::Scope;
use hil_tests::golden::{self, Measured, row};
use identification::Identification;
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use workbench::commissioning::identified_axes;
use workbench::session::Stand;

const MACHINE: &str = include_str!("../machines/seven-effects.toml");

/// What it lacks, in the order of the alphabet.
const LACKS: [&str; 7] = [
    "backlash",
    "pitch_error",
    "position_dependent_friction",
    "presliding",
    "stribeck",
    "torque_ripple",
    "viscous_asymmetry",
];

/// What a parameter may be off by, as a share of the truth.
const MOST_OFF: f64 = 0.05;
/// What a period may be off by.
const MOST_OFF_OF_A_PERIOD: f64 = 1.0e-3;

/// Parameters with the truth in the unit of the table, what makes that from the report's, and the
/// unit.
const PARAMETERS: [(&str, f64, f64, &str); 14] = [
    ("inertia", 931.65, 1.0, "kg"),
    ("load_inertia", 300.0, 1.0, "kg"),
    ("coulomb", 400.0, 1.0, "N"),
    ("viscous", 2000.0, 1.0, "N s/m"),
    ("viscous_asymmetry", 300.0, 1.0, "N s/m"),
    ("stribeck_excess", 120.0, 1.0, "N"),
    ("stribeck_velocity", 1.5, 1.0e3, "mm/s"),
    ("presliding_deflection", 4.348, 1.0e6, "µm"),
    ("backlash_gap", 10.0, 1.0e6, "µm"),
    ("compliance_stiffness", 120.0, 1.0e-6, "N/µm"),
    ("torque_ripple_amplitude", 20.0, 1.0, "N"),
    ("torque_ripple_period", 2.0, 1.0e3, "mm"),
    ("pitch_error_amplitude", 2.0, 1.0e6, "µm"),
    ("pitch_error_period", 10.0, 1.0e3, "mm"),
];

#[test]
fn seven_effects_at_once_are_all_named_and_none_beside_them() {
    let mut machine = Machine::parse("seven-effects.toml", MACHINE).unwrap();
    if !Scope::now().is_complete() {
        machine.axes.truncate(1);
    }
    let out = tempfile::tempdir().unwrap();
    let stand = Stand::in_process(&machine);
    identified_axes::record(&stand, out.path()).unwrap();
    let results = identified_axes::identify(&stand, out.path()).unwrap();
    for (axis, result) in machine.axes.iter().zip(&results) {
        let report = &result.report;
        let mut names: Vec<&str> = report.found.iter().map(String::as_str).collect();
        names.sort_unstable();
        assert_eq!(names, LACKS, "axis {}", axis.name);
        assert_eq!(report.verdict, "explained", "axis {}", axis.name);
    }
    let rows = results.iter().zip(&machine.axes);
    let rows = rows.flat_map(|(result, axis)| rows_of(&axis.name, result));
    let ran: Vec<String> = machine.axes.iter().map(scenario).collect();
    golden::check_some("many-effects", &rows.collect::<Vec<_>>(), &ran);
}

fn scenario(axis: &MachineAxis) -> String {
    format!("axis {}", axis.name)
}

fn rows_of(axis: &str, result: &Identification) -> Vec<Measured> {
    let measured = |(name, truth, factor, unit): (&str, f64, f64, &'static str)| {
        let known = result.report.parameters.get(name);
        let known = known.unwrap_or_else(|| panic!("{name} is not known"));
        let value = factor * known.value;
        let most = if name.ends_with("_period") {
            MOST_OFF_OF_A_PERIOD
        } else {
            MOST_OFF
        };
        assert_near(&format!("axis {axis}, {name}"), value, truth, most);
        row(format!("axis {axis}, {name}"), value, unit)
    };
    let change = 100.0 * change_of_friction_per_m(result);
    let over_position = format!("axis {axis}, friction over position");
    assert_near(&over_position, change, 48.0, MOST_OFF);
    let over_position = row(over_position, change, "%/m");
    let mut rows = PARAMETERS.map(measured).to_vec();
    rows.push(over_position);
    rows
}

fn assert_near(what: &str, value: f64, truth: f64, most: f64) {
    let off = (value / truth - 1.0).abs();
    assert!(off <= most, "{what}: {value} for {truth}");
}

/// As a share of the level at position zero.
fn change_of_friction_per_m(result: &Identification) -> f64 {
    let mut parts = result.effects.iter().flat_map(|effect| effect.parts());
    let linear = parts.find(|(row, _)| row.report_name() == "position_dependent_friction_linear");
    linear.map_or(f64::NAN, |(_, own)| own.value)
}
