//! Records made from the equations alone, with nothing of the simulator in them: what is put in is
//! found, and nothing else.

use std::f64::consts::TAU;
use std::path::Path;

use identification::{Dataset, identify};
use scope::{Scope, on_all_cores};

const PERIOD_S: f64 = 1.0e-3;

struct Made {
    asymmetry: f64,
    stribeck: f64,
    ripple: f64,
    delay_s: f64,
    seed: u32,
}

const NOTHING: Made = Made {
    asymmetry: 0.0,
    stribeck: 0.0,
    ripple: 0.0,
    delay_s: 0.0,
    seed: 1,
};

/// Windowless sum of sines: fast, slow and in between.
fn motion(t: f64, scale: f64) -> (f64, f64, f64) {
    let parts = [
        (0.030, 0.35, 0.0),
        (0.012, 0.9, 1.0),
        (0.0025, 2.3, 2.0),
        (0.05, 0.07, 0.5),
    ];
    parts
        .iter()
        .fold((0.0, 0.0, 0.0), |(x, v, a), (amplitude, hz, phase)| {
            let (w, amplitude) = (TAU * hz * scale, amplitude / scale);
            let (sin, cos) = (w * t + phase).sin_cos();
            (
                x + amplitude * sin,
                v + amplitude * w * cos,
                a - amplitude * w * w * sin,
            )
        })
}

fn noise(state: &mut u32) -> f64 {
    // A linear congruential generator is noise enough here (Numerical Recipes).
    let mut sum = 0.0;
    for _ in 0..12 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        sum += f64::from(*state >> 8) / f64::from(1_u32 << 24);
    }
    sum - 6.0
}

fn write(folder: &Path, name: &str, made: &Made, scale: f64) {
    let mut text = String::from("time_s,position_m,force_n\n");
    let mut state = made.seed;
    for row in 0..30_000 {
        let t = PERIOD_S * f64::from(row);
        let (x, ..) = motion(t, scale);
        // Effort recorded now acts `delay_s` later, so it is the force of that time.
        let (xe, ve, ae) = motion(t + made.delay_s, scale);
        let level = 260.0 + made.stribeck * (-(ve / 0.006).powi(2)).exp();
        let force = 700.0 * ae + 900.0 * ve + made.asymmetry * ve.abs() + level * ve.signum()
            - 25.0
            + made.ripple * (TAU * 600.0 * xe + 0.7).sin()
            + 4.0 * noise(&mut state);
        let counts = (x / 7.6e-8).floor() * 7.6e-8;
        text += &format!("{t:.3},{counts:.10},{force:.2}\n");
    }
    std::fs::write(folder.join(name), text).unwrap();
}

fn found(made: &Made) -> (Vec<String>, String) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "train.csv", made, 1.0);
    write(
        folder.path(),
        "validate.csv",
        &Made {
            seed: made.seed + 77,
            ..*made
        },
        0.83,
    );
    let toml = "sample_period_s = 0.001\n[axis]\nlead_m_per_rev = 0.01\nencoder_resolution_m = 7.6e-8\n[declared]\neffects = [\"inertia\", \"viscous\", \"coulomb\", \"offset\"]\n";
    std::fs::write(folder.path().join("dataset.toml"), toml).unwrap();
    let dataset = Dataset::read(folder.path(), None, None).unwrap();
    let report = identify(&dataset, &mut |_| ()).unwrap().report;
    assert!(
        report.validate.force_error_after_percent
            <= report.validate.force_error_before_percent + 1.0e-9
    );
    (report.found, report.verdict)
}

#[test]
fn nothing_is_found_where_nothing_is_missing() {
    on_all_cores(
        Scope::now().rows("seeds of empty records", &[1, 2, 3, 4], 1, 1),
        |seed| {
            assert_eq!(
                found(&Made {
                    seed: *seed,
                    ..NOTHING
                })
                .0,
                Vec::<String>::new(),
                "seed {seed}"
            );
        },
    );
}

#[test]
fn each_effect_is_found_alone() {
    let effects = [
        (
            "stribeck",
            Made {
                stribeck: 100.0,
                ..NOTHING
            },
        ),
        (
            "delay",
            Made {
                delay_s: 1.2e-3,
                ..NOTHING
            },
        ),
        (
            "viscous_asymmetry",
            Made {
                asymmetry: 120.0,
                ..NOTHING
            },
        ),
        (
            "torque_ripple",
            Made {
                ripple: 15.0,
                ..NOTHING
            },
        ),
    ];
    on_all_cores(
        Scope::now().rows("synthetic effects", &effects, 1, 2),
        |(wanted, made)| {
            let (found, verdict) = found(made);
            assert_eq!(
                (found, verdict.as_str()),
                (vec![(*wanted).to_owned()], "explained")
            );
        },
    );
}
