//! Friction that is not what the model says: what drives make of it that refine their levels at
//! turns, and that nobody tells them.

use super::*;

use axis_model::FrictionDrift;
use workbench::{circle_test, compensation};

/// Turns on which the drives refine themselves.
const TURNS: u32 = 5;

/// Friction of the axis, of what the model was made for; and of what is left of the burst the most,
/// with the model as it is and refined, both as shares of the burst without it.
const FRICTION: [(f64, f64, f64); 4] = [
    (1.0, 0.06, 0.06),
    (0.7, 0.55, 0.05),
    (0.5, 1.10, 0.05),
    (1.3, 0.35, 0.05),
];

/// R mm, F mm/min.
const CIRCLES: [(f64, f64); 4] = [
    (100.0, 2000.0),
    (100.0, 500.0),
    (100.0, 8000.0),
    (10.0, 1000.0),
];

/// No friction at all: the refined model is at most so much worse than none, µm. Two draws of noise
/// are as far apart.
const NOTHING_UM: f64 = 0.3;

/// The reference machine with so much of its friction that slides.
fn with_friction(share: f64) -> Machine {
    let mut machine = Machine::reference();
    for axis in &mut machine.axes {
        let sliding = &mut axis.actual.sliding;
        sliding.coulomb_n *= share;
        sliding.static_n *= share;
    }
    machine
}

/// A machine whose slides have nothing but oil.
fn without_friction() -> Machine {
    let mut machine = with_friction(1.0e-5);
    for axis in &mut machine.axes {
        axis.actual.sliding.viscous_n_s_per_m = 100.0;
    }
    machine
}

fn self_tuning() -> Vec<AxisCompensation> {
    compensation::self_tuning(model()).unwrap()
}

/// The largest burst without compensation, with the model, and refined, µm; and the first axis'
/// refined level.
fn bursts(machine: &Machine, circle: &Circle) -> ([f64; 3], f64) {
    let stand = Stand::in_process(machine);
    let of = |turns: u32, compensation: &[AxisCompensation]| {
        let run = circle_test::run_after(&stand, circle, turns, compensation, None);
        run.unwrap().report
    };
    let refined = of(TURNS, &self_tuning());
    let [none, with] = [of(0, &stand.uncompensated()), of(0, model())];
    let bursts_um = [&none, &with, &refined].map(|report| report.figures.peak_max_um);
    (bursts_um, refined.refined_levels.unwrap()[0])
}

#[test]
fn five_circles_make_the_model_fit_an_axis_with_another_friction() {
    let all: Vec<_> = FRICTION
        .iter()
        .flat_map(|friction| CIRCLES.iter().map(move |circle| (*friction, *circle)))
        .collect();
    let cells = Scope::now().rows("friction-model-self-tuning", &all, 1, 5);
    let name = |((share, ..), (radius, feed)): &((f64, f64, f64), (f64, f64))| {
        let percent = 100.0 * share;
        format!("{percent:.0} % of the friction, R {radius} F {feed}")
    };
    let rows = on_all_cores(cells, |cell| {
        let ((share, with_most, refined_most), (radius, feed)) = *cell;
        let (bursts_um, level) = bursts(&with_friction(share), &circle(radius, feed));
        let [none_um, with_um, refined_um] = bursts_um;
        let name = name(cell);
        assert!(with_um <= with_most * none_um, "{name}: {bursts_um:?} µm");
        assert!(
            refined_um <= refined_most * none_um,
            "{name}: {bursts_um:?} µm"
        );
        vec![
            row(format!("{name}, none"), none_um, "µm"),
            row(format!("{name}, model"), with_um, "µm"),
            row(format!("{name}, model, refined"), refined_um, "µm"),
            row(format!("{name}, refined level"), level, ""),
        ]
    });
    let names: Vec<String> = cells.iter().map(name).collect();
    golden::check_some("friction-model-self-tuning", &rows.concat(), &names);
}

#[test]
fn a_model_of_friction_that_is_not_there_is_gone_after_five_circles() {
    let machine = without_friction();
    let ([none_um, with_um, refined_um], level) = bursts(&machine, &circle(100.0, 2000.0));
    assert!(with_um > 30.0, "{with_um} µm before");
    assert!(
        refined_um <= none_um + NOTHING_UM,
        "{refined_um} µm of {none_um}"
    );
    assert!(level < 0.01, "{level}");
}

/// Warm-up takes 30 % of the friction off, with a time constant of two minutes; eight minutes of
/// circles.
#[test]
fn friction_that_falls_as_the_axis_warms_up_is_followed_untold() {
    let mut machine = with_friction(0.7);
    for axis in &mut machine.axes {
        let cold = FrictionDrift {
            gain: 0.3 / 0.7,
            time_constant: 120.0,
            viscous_gain: None,
        };
        axis.actual.effects.add(cold).unwrap();
    }
    let circle = circle(100.0, 2000.0);
    let burst_um = |compensation: &[AxisCompensation]| {
        let mut session = Session::open(&machine, &Place::InProcess, compensation, 0).unwrap();
        let turns = 24;
        session.circle(&Circle { turns, ..circle }).unwrap();
        let points = session.circle(&circle).unwrap();
        ballbar::figures(&points, circle.radius_m, 0.0, MEASURE_FROM_RAD).peak_max_um
    };
    let [told_once_um, refined_um] = [model(), &self_tuning()].map(burst_um);
    assert!(told_once_um > 10.0, "{told_once_um} µm");
    assert!(
        refined_um < 0.05 * told_once_um,
        "{refined_um} µm of {told_once_um}"
    );
}
