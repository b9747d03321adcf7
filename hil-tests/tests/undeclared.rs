//! Each effect in turn, undeclared, recorded and identified as by `commission` on the in-process
//! bus: named, added, error before and after on the later record.
//!
//! Two axes a machine, one hidden effect each: the axes share nothing but the SYNC.

use hil_tests::golden::{self, Measured, row};
use hil_tests::{Scope, on_all_cores};
use identification::Report;
use plant_sim::Machine;
use workbench::commissioning::identified_axes;
use workbench::session::Stand;

/// An axis: its effect, the keys that differ from the plain axis, and what it declares.
struct Hidden {
    effect: &'static str,
    keys: &'static [(&'static str, &'static str)],
}

const PLAIN: [(&str, &str); 6] = [
    ("STIFFNESS", "1.2e8"),
    ("BACKLASH", "0.0"),
    ("STATIC", "400.0"),
    ("LAW", "law = \"coulomb\""),
    ("SLIDING", ""),
    ("EFFECTS", ""),
];

const AXES: [Hidden; 14] = [
    Hidden {
        effect: "torque_ripple",
        keys: &[(
            "EFFECTS",
            "torque_ripple = { amplitude_n = 40.0, order_per_rev = 6.0, phase_rad = 0.7 }",
        )],
    },
    Hidden {
        effect: "pitch_error",
        keys: &[(
            "EFFECTS",
            "pitch_error = { amplitude_m = 3.0e-6, period_m = 0.010 }",
        )],
    },
    Hidden {
        effect: "stribeck",
        keys: &[("STATIC", "560.0")],
    },
    Hidden {
        effect: "presliding",
        keys: &[(
            "LAW",
            "law = \"lu-gre\"\nbristle_stiffness_n_per_m = 4.0e7\nbristle_damping_n_s_per_m = 3.0e4",
        )],
    },
    Hidden {
        effect: "viscous_asymmetry",
        keys: &[("SLIDING", "viscous_asymmetry = 0.15")],
    },
    Hidden {
        effect: "quadratic_drag",
        keys: &[("SLIDING", "quadratic_drag_n_s2_per_m2 = 2500.0")],
    },
    Hidden {
        effect: "backlash",
        keys: &[("BACKLASH", "20.0e-6")],
    },
    Hidden {
        effect: "compliance",
        keys: &[("STIFFNESS", "6.0e7")],
    },
    Hidden {
        effect: "position_dependent_friction",
        keys: &[("EFFECTS", "position_dependent_friction_per_m = 2.0")],
    },
    Hidden {
        effect: "friction_drift",
        keys: &[(
            "EFFECTS",
            "friction_drift = { gain = 0.4, time_constant_s = 15.0 }",
        )],
    },
    Hidden {
        effect: "torque_saturation",
        keys: &[("EFFECTS", "torque_saturation_per_n = 5.0e-5")],
    },
    Hidden {
        effect: "delay",
        keys: &[("EFFECTS", "delay_s = 0.7e-3")],
    },
    Hidden {
        effect: "offset",
        keys: &[("EFFECTS", "offset_n = 60.0")],
    },
    Hidden {
        effect: "viscous",
        keys: &[],
    },
];

fn axis(name: &str, hidden: &Hidden) -> String {
    let declared: Vec<String> = ["inertia", "viscous", "coulomb", "offset", "compliance"]
        .into_iter()
        .filter(|effect| *effect != hidden.effect)
        .map(|effect| format!("\"{effect}\""))
        .collect();
    let mut text = AXIS
        .replace("NAME", name)
        .replace("DECLARED", &declared.join(", "));
    for (key, value) in hidden.keys.iter().chain(&PLAIN) {
        text = text.replace(key, value);
    }
    text
}

const AXIS: &str = r#"
[[axis]]
name = "NAME"
[axis.mechanics]
lead_m_per_rev = 0.010
motor_inertia_kg = 631.65
table_mass_kg = 300.0
screw_stiffness_n_per_m = STIFFNESS
screw_damping_n_s_per_m = 2.0e4
backlash_m = BACKLASH
[axis.encoders]
motor_counts_per_rev = 1048576
load_resolution_m = 1.0e-8
[axis.actuator]
current_loop_time_constant_s = 5.0e-4
force_limit_n = 9000.0
force_noise_n = 4.5
force_record_noise_n = 15.0
[axis.limits]
velocity_m_per_s = 0.5
acceleration_m_per_s2 = 5.0
travel_m = 0.25
[axis.gains]
position_sensor = "motor"
position_gain_per_s = 40.0
velocity_bandwidth_hz = 30.0
velocity_integral_hz = 7.5
velocity_filter = 0.6
[axis.actual.sliding]
coulomb_n = 400.0
static_n = STATIC
stribeck_velocity_m_per_s = 3.0e-3
viscous_n_s_per_m = 2000.0
SLIDING
[axis.actual.friction]
LAW
[axis.actual.effects]
EFFECTS
[axis.declared]
effects = [DECLARED]
"#;

const HEAD: &str =
    "seed = 5\n[bus]\nformat = \"classic\"\nbit_rate = 1_000_000\n[loop]\nperiod_s = 1.0e-3\n";

/// Records and identifies a machine of two axes; what was found on each, and the rows of the table.
fn commissioned(pair: &[Hidden]) -> (Vec<(String, Vec<String>)>, Vec<Measured>) {
    let out = tempfile::tempdir().unwrap();
    let axes: String = pair
        .iter()
        .zip(["X", "Y"])
        .map(|(hidden, name)| axis(name, hidden))
        .collect();
    let text = format!("name = \"{}\"\n{HEAD}{axes}", pair[0].effect);
    let machine = Machine::parse("machine.toml", &text).unwrap();
    let stand = Stand::in_process(&machine);
    identified_axes::record(&stand, out.path()).unwrap();
    let results = identified_axes::identify(&stand, out.path()).unwrap();
    let each = pair.iter().zip(&results);
    let found = each
        .clone()
        .map(|(hidden, result)| (hidden.effect.to_owned(), names(&result.report)))
        .collect();
    (
        found,
        each.flat_map(|(hidden, result)| rows(hidden, &result.report))
            .collect(),
    )
}

/// Names that a report gives, with `unexplained` where it says so.
fn names(report: &Report) -> Vec<String> {
    let unexplained = (report.verdict != "explained").then(|| "unexplained".to_owned());
    report.found.iter().cloned().chain(unexplained).collect()
}

/// What the held-out record says, before and after.
fn rows(hidden: &Hidden, report: &Report) -> Vec<Measured> {
    let validate = serde_json::to_value(report.validate).unwrap();
    let measured = |(key, what, unit): (&str, &str, &'static str)| {
        row(
            format!("{}, {what}", hidden.effect),
            validate[key].as_f64().unwrap(),
            unit,
        )
    };
    [
        ("force_error_before_percent", "force error before", "%"),
        ("force_error_after_percent", "force error after", "%"),
        ("reversal_error_before", "about reversals before", "N"),
        ("reversal_error_after", "about reversals after", "N"),
        (
            "position_difference_error_um_before",
            "motor - load before",
            "µm",
        ),
        (
            "position_difference_error_um_after",
            "motor - load after",
            "µm",
        ),
    ]
    .map(measured)
    .into()
}

#[test]
fn each_undeclared_effect_is_named_and_added() {
    if Scope::now().leaves_row_to("tests/commission.rs, with the reference machine") {
        return;
    }
    let machines: Vec<&[Hidden]> = AXES.chunks(2).collect();
    let machines = Scope::now().rows("undeclared, machines of two axes", &machines, 1, 1);
    let (found, rows): (Vec<_>, Vec<_>) = on_all_cores(machines, |pair| commissioned(pair))
        .into_iter()
        .unzip();
    let is_wrong =
        |(effect, names): &(String, Vec<String>)| names.len() != 1 || names[0] != *effect;
    let wrong: Vec<_> = found.concat().into_iter().filter(is_wrong).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    let effects: Vec<&str> = machines
        .iter()
        .flat_map(|pair| pair.iter().map(|hidden| hidden.effect))
        .collect();
    golden::check_some("undeclared", &rows.concat(), &effects);
}
