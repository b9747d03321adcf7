//! What compensation does where nothing is to be gained: jogs, a setpoint that flips, a stop in the
//! middle of a reversal, noise of the setpoint.

use super::*;

use workbench::compensation::{Adaptive, Compensation, Pulse};

/// The largest error at the table and the largest change of the force within a cycle, from a time
/// on, of the first axis along a path that begins at rest in its middle.
fn harm(
    machine: &Machine,
    compensation: &[AxisCompensation],
    duration_s: f64,
    from_s: f64,
    path_m: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let mut session = Session::open(machine, &Place::InProcess, compensation, 0).unwrap();
    session.go_to(&[path_m(0.0), 0.0]).unwrap();
    let (mut error_um, mut force_n, mut before) = (0.0_f64, 0.0_f64, None);
    session
        .follow(
            duration_s,
            |time_s| vec![path_m(time_s), 0.0],
            |time_s, axes| {
                let truth = axes[0].truth.unwrap();
                if time_s >= from_s {
                    error_um = error_um.max(1.0e6 * (axes[0].reference_m - truth.table_m).abs());
                    let change: f64 = before.map_or(0.0, |before: f64| axes[0].force_n - before);
                    force_n = force_n.max(change.abs());
                }
                before = Some(axes[0].force_n);
            },
        )
        .unwrap();
    [error_um, force_n]
}

/// On 10 mm at 10 mm/s, a rest, and what comes then.
fn after_a_way(then_m: impl Fn(f64) -> f64) -> impl Fn(f64) -> f64 {
    const ON_S: f64 = 1.0;
    const REST_S: f64 = 2.0;
    move |time_s| {
        let share = (time_s / ON_S).clamp(0.0, 1.0);
        let on_m = 0.01 * (share - (std::f64::consts::TAU * share).sin() / std::f64::consts::TAU);
        on_m + then_m(time_s - ON_S - REST_S)
    }
}

/// A smooth step of a size within 50 ms.
fn step_m(size_m: f64, time_s: f64) -> f64 {
    let share = (time_s / 0.05).clamp(0.0, 1.0);
    size_m * share * share * (3.0 - 2.0 * share)
}

/// The smallest setpoint: 10 nm / 256.
const FINE_M: f64 = 1.0e-8 / 256.0;

type Path = Box<dyn Fn(f64) -> f64 + Sync>;

/// Name, path, and where the largest error is looked for.
fn harmless_paths() -> Vec<(&'static str, Path, f64)> {
    let flip = |time_s: f64| {
        let flips = (time_s / 0.1).max(0.0) as u32;
        if time_s > 0.0 && flips.is_multiple_of(2) {
            -FINE_M
        } else {
            0.0
        }
    };
    vec![
        (
            "jog back by 0.04 nm after a dwell",
            Box::new(after_a_way(
                |time_s| if time_s > 0.0 { -FINE_M } else { 0.0 },
            )),
            3.0,
        ),
        (
            "jog back by 1 µm after a dwell",
            Box::new(after_a_way(|time_s| step_m(-1.0e-6, time_s))),
            3.0,
        ),
        (
            "standstill, setpoint flips one count every 100 cycles",
            Box::new(after_a_way(flip)),
            3.0,
        ),
        (
            "back by 5 µm and on again, within presliding",
            Box::new(after_a_way(|time_s| {
                step_m(-5.0e-6, time_s) + step_m(5.0e-6, time_s - 0.1)
            })),
            3.0,
        ),
        (
            "stop 2 ms after the reversal of R 100 F 500",
            Box::new(|time_s| {
                let since_s = (time_s - 1.5).min(0.002);
                -0.5 * REVERSAL_M_PER_S2 * since_s * since_s
            }),
            1.4,
        ),
        (
            "reversal of R 100 F 500, 5 nm of noise in the setpoint",
            Box::new(|time_s| {
                let since_s = time_s - 1.5;
                5.0e-9 * noise(time_s) - 0.5 * REVERSAL_M_PER_S2 * since_s * since_s
            }),
            1.4,
        ),
    ]
}

/// Another number from −1 to 1 in each cycle.
fn noise(time_s: f64) -> f64 {
    let cycle = (1.0e3 * time_s).round();
    2.0 * (1.0e4 * (12.9898 * cycle).sin()).rem_euclid(1.0) - 1.0
}

/// A pulse that comes once leaves so much more than none: its own height for a few cycles.
const PULSE_UM: f64 = 13.0;

/// Pulses over the acceleration as `quadrant tune` has them.
const ADAPTIVE: Adaptive = Adaptive {
    acceleration_m_per_s2: 2.8e-5,
    forward_m_per_s: [
        1.0e-4, 2.9e-4, 8.4e-4, 1.09e-3, 1.72e-3, 2.1e-3, 2.9e-3, 4.12e-3, 4.45e-3,
    ],
    backward_m_per_s: [
        1.0e-4, 2.9e-4, 8.4e-4, 1.09e-3, 1.72e-3, 2.1e-3, 2.9e-3, 4.12e-3, 4.45e-3,
    ],
    time_constant_s: [1.63, 0.55, 0.171, 0.144, 0.086, 0.070, 0.046, 0.026, 0.022],
    start_delay_s: [0.0, 0.048, 0.064, 0.001, 0.0, 0.0, 0.001, 0.002, 0.0],
};

/// What the methods are tuned to at R 100 F 2000: the pulses as `quadrant tune` has them, Coulomb
/// friction as it is.
pub(super) fn methods() -> Vec<(&'static str, Vec<AxisCompensation>)> {
    let of = |reversal: Compensation| {
        let mut axes = Stand::in_process(&Machine::reference()).uncompensated();
        for axis in &mut axes {
            axis.reversal = reversal.clone();
        }
        axes
    };
    let pulse = Pulse {
        height_m_per_s: 1.75e-3,
        time_constant_s: 0.088,
        start_delay_s: 0.0,
    };
    vec![
        ("none", of(Compensation::None)),
        ("coulomb", of(Compensation::Coulomb { force_n: 400.0 })),
        ("pulse", of(Compensation::Pulse(pulse))),
        ("model", model().to_vec()),
        ("adaptive", of(Compensation::Adaptive(Box::new(ADAPTIVE)))),
    ]
}

#[test]
fn model_and_adaptive_are_nowhere_worse_than_none_and_the_pulse_comes_once_where_nothing_is_gained()
{
    let machine = Machine::reference();
    let (paths, methods) = (harmless_paths(), methods());
    let rows = on_all_cores(&paths, |(name, path, from_s)| {
        let mut rows: Vec<Measured> = Vec::new();
        for (method, compensation) in &methods {
            let [error_um, step_n] = harm(&machine, compensation, 4.5, *from_s, path);
            rows.push(row(format!("{name}, {method}"), error_um, "µm"));
            let step = format!("{name}, {method}: largest step of the force");
            rows.push(row(step, step_n, "N"));
        }
        let [none_um, pulse_um, model_um, adaptive_um] =
            [0, 4, 6, 8].map(|place| rows[place].value);
        for harmless_um in [model_um, adaptive_um] {
            assert!(
                harmless_um <= none_um + 0.2,
                "{name}: {harmless_um} µm, {none_um} without"
            );
        }
        assert!(pulse_um <= none_um + PULSE_UM, "{name}: {pulse_um} µm");
        rows
    });
    golden::check("friction-model-harm", &rows.concat());
}

/// The largest error within half a second of rest after disable and enable, µm: the screw relaxes
/// in between, and the setpoint begins where the axis is then.
fn after_enable_um(compensation: &[AxisCompensation], place_m: f64) -> f64 {
    let machine = Machine::reference();
    let mut session = Session::open(&machine, &Place::InProcess, compensation, 0).unwrap();
    session.go_to(&[place_m, 0.0]).unwrap();
    session.master_mut().disable().unwrap();
    session.master_mut().enable().unwrap();
    let rest_m = session.master().axis(0).reference_m;
    let mut error_um = 0.0_f64;
    let hold = |_: f64| vec![rest_m, 0.0];
    session
        .follow(0.5, hold, |_, axes| {
            let off_m = axes[0].reference_m - axes[0].truth.unwrap().table_m;
            error_um = error_um.max(1.0e6 * off_m.abs());
        })
        .unwrap();
    error_um
}

#[test]
fn enabling_is_no_reversal() {
    let methods = methods();
    let [none, pulse] = [0, 2].map(|place| &methods[place].1);
    for place_m in [0.01, -0.01, 0.0123, -0.0077] {
        let [without_um, with_um] = [none, pulse].map(|own| after_enable_um(own, place_m));
        assert!(
            with_um <= without_um + 0.2,
            "{place_m} m: {with_um} µm, {without_um} without"
        );
    }
}
