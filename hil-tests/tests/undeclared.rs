//! Each effect in turn, undeclared, through `commission` on the in-process bus: named, added, error before and after on the later record.
//!
//! Two axes a machine, one hidden effect each: the axes share nothing but the SYNC.

use hil_tests::golden::{self, Measured, row};
use workbench::cli::{Commission, MachineArguments};
use workbench::commission;
use workbench::interrupt::Interrupt;

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
    Hidden { effect: "stribeck", keys: &[("STATIC", "560.0")] },
    Hidden {
        effect: "presliding",
        keys: &[("LAW", "law = \"lu-gre\"\nbristle_stiffness_n_per_m = 4.0e7\nbristle_damping_n_s_per_m = 3.0e4")],
    },
    Hidden { effect: "viscous_asymmetry", keys: &[("SLIDING", "viscous_asymmetry = 0.15")] },
    Hidden { effect: "quadratic_drag", keys: &[("SLIDING", "quadratic_drag_n_s2_per_m2 = 2500.0")] },
    Hidden { effect: "backlash", keys: &[("BACKLASH", "20.0e-6")] },
    Hidden { effect: "compliance", keys: &[("STIFFNESS", "6.0e7")] },
    Hidden {
        effect: "torque_ripple",
        keys: &[("EFFECTS", "torque_ripple = { amplitude_n = 40.0, order_per_rev = 6.0, phase_rad = 0.7 }")],
    },
    Hidden { effect: "pitch_error", keys: &[("EFFECTS", "pitch_error = { amplitude_m = 3.0e-6, period_m = 0.010 }")] },
    Hidden { effect: "position_dependent_friction", keys: &[("EFFECTS", "position_dependent_friction_per_m = 2.0")] },
    Hidden {
        effect: "friction_drift",
        keys: &[("EFFECTS", "friction_drift = { gain = 0.4, time_constant_s = 15.0 }")],
    },
    Hidden { effect: "torque_saturation", keys: &[("EFFECTS", "torque_saturation_per_n = 5.0e-5")] },
    Hidden { effect: "delay", keys: &[("EFFECTS", "delay_s = 0.7e-3")] },
    Hidden { effect: "offset", keys: &[("EFFECTS", "offset_n = 60.0")] },
    Hidden { effect: "viscous", keys: &[] },
];

fn axis(name: &str, hidden: &Hidden) -> String {
    let declared: Vec<String> = ["inertia", "viscous", "coulomb", "offset", "compliance"]
        .into_iter()
        .filter(|effect| *effect != hidden.effect)
        .map(|effect| format!("\"{effect}\""))
        .collect();
    let mut text = AXIS.replace("NAME", name).replace("DECLARED", &declared.join(", "));
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

const HEAD: &str = "seed = 5\n[bus]\nformat = \"classic\"\nbit_rate = 1_000_000\n[loop]\nperiod_s = 1.0e-3\n";

/// Commissions a machine of two axes; what was found on each, and the rows of the table.
fn commissioned(pair: &[Hidden]) -> (Vec<(String, Vec<String>)>, Vec<Measured>) {
    let folder = tempfile::tempdir().unwrap();
    let axes: String = pair.iter().zip(["X", "Y"]).map(|(hidden, name)| axis(name, hidden)).collect();
    let file = folder.path().join("machine.toml");
    std::fs::write(&file, format!("name = \"{}\"\n{HEAD}{axes}", pair[0].effect)).unwrap();
    let out = folder.path().join("out");
    let machine = MachineArguments { machine: Some(file), can: None };
    commission::command(&Commission { machine, out: out.clone() }, &Interrupt::never()).unwrap();
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut rows = Vec::new();
    let mut found = Vec::new();
    for (hidden, axis) in pair.iter().zip(summary["axes"].as_array().unwrap()) {
        let names = axis["found"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned());
        let mut names: Vec<String> = names.collect();
        names.extend((axis["verdict"] != "explained").then(|| "unexplained".to_owned()));
        found.push((hidden.effect.to_owned(), names));
        let validate = &axis["validate"];
        for (key, what, unit) in [
            ("force_error_before_percent", "force error before", "%"),
            ("force_error_after_percent", "force error after", "%"),
            ("reversal_error_before", "about reversals before", "N"),
            ("reversal_error_after", "about reversals after", "N"),
            ("position_difference_error_um_before", "motor - load before", "µm"),
            ("position_difference_error_um_after", "motor - load after", "µm"),
        ] {
            rows.push(row(format!("{}, {what}", hidden.effect), validate[key].as_f64().unwrap(), unit));
        }
    }
    (found, rows)
}

#[test]
fn each_undeclared_effect_is_named_and_added() {
    let machines: Vec<&[Hidden]> = AXES.chunks(2).collect();
    let (front, back) = machines.split_at(machines.len() / 2);
    let all = |machines: &[&[Hidden]]| machines.iter().map(|pair| commissioned(pair)).collect::<Vec<_>>();
    let results = std::thread::scope(|scope| {
        let front = scope.spawn(|| all(front));
        let back = all(back);
        [front.join().unwrap(), back].concat()
    });
    let mut wrong = Vec::new();
    let mut table = Vec::new();
    for (found, rows) in results {
        wrong.extend(found.into_iter().filter(|(effect, names)| names.len() != 1 || names[0] != *effect));
        table.extend(rows);
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    golden::check("undeclared", &table);
}
