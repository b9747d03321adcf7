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

/// Parameters with the unit of the table and what makes it from the report's. The truth of each is
/// in the notes of the table.
const PARAMETERS: [(&str, f64, &str); 14] = [
    ("inertia", 1.0, "kg"),
    ("load_inertia", 1.0, "kg"),
    ("coulomb", 1.0, "N"),
    ("viscous", 1.0, "N s/m"),
    ("viscous_asymmetry", 1.0, "N s/m"),
    ("stribeck_excess", 1.0, "N"),
    ("stribeck_velocity", 1.0e3, "mm/s"),
    ("presliding_deflection", 1.0e6, "µm"),
    ("backlash_gap", 1.0e6, "µm"),
    ("compliance_stiffness", 1.0e-6, "N/µm"),
    ("torque_ripple_amplitude", 1.0, "N"),
    ("torque_ripple_period", 1.0e3, "mm"),
    ("pitch_error_amplitude", 1.0e6, "µm"),
    ("pitch_error_period", 1.0e3, "mm"),
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
    let measured = |(name, factor, unit): (&str, f64, &'static str)| {
        let known = result.report.parameters.get(name);
        let known = known.unwrap_or_else(|| panic!("{name} is not known"));
        row(format!("axis {axis}, {name}"), factor * known.value, unit)
    };
    let over_position = row(
        format!("axis {axis}, friction over position"),
        100.0 * change_of_friction_per_m(result),
        "%/m",
    );
    let mut rows = PARAMETERS.map(measured).to_vec();
    rows.push(over_position);
    rows
}

/// As a share of the level at position zero.
fn change_of_friction_per_m(result: &Identification) -> f64 {
    let mut parts = result.effects.iter().flat_map(|effect| effect.parts());
    let linear = parts.find(|(row, _)| row.report_name() == "position_dependent_friction_linear");
    linear.map_or(f64::NAN, |(_, own)| own.value)
}
