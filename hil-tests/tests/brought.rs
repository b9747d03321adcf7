//! Machines that a stranger would bring, through the main job: each ends with a report, and none
//! with a circle that is worse than without.

use hil_tests::golden::{self, Measured, row};
use hil_tests::{Scope, on_all_cores};
use plant_sim::Machine;
use plant_sim::friction::Law;
use plant_sim::machine::{MachineAxis, PositionSensor};
use serde_json::Value;
use workbench::commands::commission::{self, Wanted};
use workbench::interrupt::Interrupt;
use workbench::network::place::Place;

/// A machine, and how its job ends.
struct Brought {
    name: &'static str,
    change: fn(&mut Machine),
    ends: End,
}

/// How the job ends.
#[derive(Clone, Copy)]
enum End {
    /// The loops are not fit; the report says so in these words.
    Unfit(&'static str),
    /// At most this share of the burst is left on the circle of the job; nothing is told of the
    /// loops.
    Left(f64),
    /// The same, and it is told that they oscillate while they creep.
    Creeps(f64),
}

const BROUGHT: [Brought; 12] = [
    Brought {
        name: "desktop stage",
        change: |machine| machine.axes.iter_mut().for_each(desktop),
        ends: End::Left(0.2),
    },
    Brought {
        name: "period of 2 ms",
        change: |machine| machine.period_s = 2.0e-3,
        ends: End::Unfit("the loop oscillates at standstill at 4"),
    },
    Brought {
        name: "coarse encoders",
        change: |machine| with_encoders(machine, 10_000, 1.0e-6),
        ends: End::Left(0.2),
    },
    Brought {
        name: "period of 0.25 ms",
        change: |machine| machine.period_s = 2.5e-4,
        ends: End::Left(0.03),
    },
    Brought {
        name: "period of 0.5 ms",
        change: |machine| machine.period_s = 5.0e-4,
        ends: End::Left(0.03),
    },
    Brought {
        name: "resonance at 31 Hz within the band of the loop",
        change: |machine| {
            for axis in &mut machine.axes {
                axis.actual.mechanics.table_mass_kg = 8000.0;
                axis.actual.mechanics.screw_stiffness_n_per_m = 3.0e8;
            }
        },
        ends: End::Unfit("the loop oscillates"),
    },
    Brought {
        name: "motor of 700 N, too weak for fast circles",
        change: |machine| {
            for axis in &mut machine.axes {
                axis.actual.force_limit_n = 700.0;
                axis.limits.acceleration_m_per_s2 = 0.2;
            }
        },
        ends: End::Left(0.1),
    },
    Brought {
        name: "loop closed by the motor encoder",
        change: |machine| {
            for axis in &mut machine.axes {
                axis.gains.position_sensor = PositionSensor::Motor;
            }
        },
        ends: End::Left(0.03),
    },
    Brought {
        name: "friction that falls faster than the loop damps",
        change: |machine| machine.axes.iter_mut().for_each(creeping),
        ends: End::Creeps(0.2),
    },
    Brought {
        name: "drag with the square of the velocity and no fall",
        change: |machine| {
            for axis in &mut machine.axes {
                let sliding = &mut axis.actual.sliding;
                sliding.static_n = sliding.coulomb_n;
                sliding.quadratic_drag_n_s2_per_m2 = 4000.0;
            }
        },
        ends: End::Left(0.03),
    },
    Brought {
        name: "heavy table behind a gap, which shakes when it moves fast",
        change: |machine| machine.axes.iter_mut().for_each(shaking),
        ends: End::Unfit("the loop oscillates on its records"),
    },
    Brought {
        name: "motor encoder of 4096 counts beside a scale of 50 nm",
        change: |machine| with_encoders(machine, 4096, 5.0e-8),
        ends: End::Left(0.3),
    },
];

fn with_encoders(machine: &mut Machine, motor_counts_per_rev: u32, load_resolution_m: f64) {
    for axis in &mut machine.axes {
        axis.actual.motor_encoder_counts_per_rev = motor_counts_per_rev;
        axis.actual.load_encoder_resolution_m = load_resolution_m;
    }
}

/// 8 kg on the motor's side and a table of 2 kg, lead 2 mm, 4096 counts, 200 N.
fn desktop(axis: &mut MachineAxis) {
    let actual = &mut axis.actual;
    actual.mechanics.motor_inertia_kg = 8.0;
    actual.mechanics.table_mass_kg = 2.0;
    actual.mechanics.screw_stiffness_n_per_m = 2.0e7;
    actual.mechanics.screw_damping_n_s_per_m = 500.0;
    (actual.sliding.coulomb_n, actual.sliding.static_n) = (12.0, 16.0);
    actual.sliding.viscous_n_s_per_m = 60.0;
    actual.law = Law::LuGre {
        bristle_stiffness_n_per_m: 1.2e6,
        bristle_damping_n_s_per_m: 900.0,
    };
    actual.lead_m_per_rev = 0.002;
    actual.motor_encoder_counts_per_rev = 4096;
    actual.force_limit_n = 200.0;
    actual.force_noise_n = 0.1;
    axis.limits.travel_m = 0.1;
}

/// Maxwell slip whose level falls by a third within 1 mm/s, behind the speed by 3 ms.
fn creeping(axis: &mut MachineAxis) {
    let sliding = &mut axis.actual.sliding;
    (sliding.coulomb_n, sliding.static_n) = (400.0, 560.0);
    sliding.stribeck_velocity_m_per_s = 1.0e-3;
    sliding.stribeck_lag_s = 3.0e-3;
    axis.actual.law = Law::MaxwellSlip {
        stiffness_n_per_m: vec![3.0e7, 1.2e7, 6.0e6, 3.0e6],
        share: vec![0.25; 4],
    };
}

/// 1.2 t with 1.5 kN of friction behind a gap of 3 µm within the loop: 50 Hz on its screw.
fn shaking(axis: &mut MachineAxis) {
    let actual = &mut axis.actual;
    actual.mechanics.table_mass_kg = 1200.0;
    actual.mechanics.backlash_m = 3.0e-6;
    (actual.sliding.coulomb_n, actual.sliding.static_n) = (1500.0, 1500.0);
    actual.sliding.viscous_n_s_per_m = 5000.0;
    actual.law = Law::LuGre {
        bristle_stiffness_n_per_m: 7.5e7,
        bristle_damping_n_s_per_m: 1.0e3,
    };
}

fn of_machine(brought: &Brought) -> Vec<Measured> {
    let name = brought.name;
    let folder = tempfile::tempdir().unwrap();
    let mut machine = Machine::reference();
    (brought.change)(&mut machine);
    let out = folder.path();
    let ended = commission::commission(
        &machine,
        Place::InProcess,
        &Wanted::into(out),
        &Interrupt::never(),
    );
    ended.unwrap_or_else(|why| panic!("{name}: {why}"));
    let read = |file: &str| std::fs::read_to_string(out.join(file)).unwrap();
    let summary: Value = serde_json::from_str(&read("summary.json")).unwrap();
    match brought.ends {
        End::Unfit(said) => {
            assert_eq!(summary["verdict"], "unfit", "{name}");
            assert!(read("report.html").contains(said), "{name}");
            let worst = summary["oscillations"].as_array().unwrap().iter();
            let um = worst.map(|own| number(&own["amplitude_um"]));
            vec![row(
                format!("{name}, oscillates by"),
                um.fold(0.0, f64::max),
                "µm",
            )]
        }
        End::Left(share) => {
            assert_eq!(summary["oscillations"], Value::Array(Vec::new()), "{name}");
            circles(name, &summary, share)
        }
        End::Creeps(share) => {
            let told = summary["oscillations"].as_array().unwrap();
            let creeps = |own: &Value| own["creeping_m_per_s"].is_f64();
            assert!(told.len() == 2 && told.iter().all(creeps), "{name}");
            circles(name, &summary, share)
        }
    }
}

fn circles(name: &str, summary: &Value, share: f64) -> Vec<Measured> {
    let burst = |key: &str| number(&summary[key]["peak_max_um"]);
    let (before_um, after_um) = (burst("circle_before"), burst("circle_after"));
    assert!(
        after_um <= share * before_um,
        "{name}: {after_um} µm of {before_um}"
    );
    let mut rows = vec![
        row(format!("{name}, burst before"), before_um, "µm"),
        row(format!("{name}, burst after"), after_um, "µm"),
    ];
    for feed in summary["feeds"].as_array().unwrap() {
        let [mm_min, before_um, after_um] =
            ["feed_mm_min", "burst_before_um", "burst_after_um"].map(|key| number(&feed[key]));
        assert!(
            after_um <= before_um + 0.2,
            "{name}, F {mm_min}: {after_um} µm, {before_um} without"
        );
        rows.push(row(
            format!("{name}, F {mm_min:.0}, burst before"),
            before_um,
            "µm",
        ));
        rows.push(row(
            format!("{name}, F {mm_min:.0}, burst after"),
            after_um,
            "µm",
        ));
    }
    rows
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
fn every_machine_ends_with_a_report_and_none_with_a_worse_circle() {
    let brought = Scope::now().rows("machines that are brought", &BROUGHT, 1, 2);
    let rows = on_all_cores(brought, of_machine);
    let names: Vec<&str> = brought.iter().map(|brought| brought.name).collect();
    golden::check_some("brought", &rows.concat(), &names);
}
