//! Pictures of one identification: what the declared model leaves, and what was found in it, each
//! at the scale where it happens.

use identification::{AfterReversal, EffectCurve, Identification};

use super::plots::{Curve, Ink, Plot, curves};
use super::result_tables::position_error_unit;

/// Size of a picture that has another beside it, and of one that has not, px.
const HALF_PX: (f64, f64) = (540.0, 340.0);
const WHOLE_PX: (f64, f64) = (1080.0, 330.0);

/// What the models leave, against velocity and against position.
#[must_use]
pub fn residual_pictures(result: &Identification) -> Vec<String> {
    let unit = result.position_unit;
    vec![
        residual(result, 0, "velocity", &format!("velocity, {unit}/s")),
        residual(result, 1, "position", &format!("position, {unit}")),
    ]
}

fn residual(result: &Identification, column: usize, name: &str, label: &str) -> String {
    let of = |row: usize| {
        let moving = result.curves.moving.iter();
        moving.map(move |at| (at[column], at[row]))
    };
    let list = [
        Curve::cloud("declared model", Ink::Before, of(2)),
        Curve::cloud("extended model", Ink::After, of(3)),
    ];
    let title = format!("Residual against {name}, validation record");
    curves(
        &Plot::new(&title, label, result.effort_unit, HALF_PX),
        &list,
    )
}

/// Recorded and predicted effort over time.
#[must_use]
pub fn time_picture(result: &Identification) -> String {
    let of = &result.curves;
    let over_time = |name: &str, ink: Ink, values: &[f64]| {
        let times = of.time_s.iter().copied();
        Curve::line(name, ink, times.zip(values.iter().copied()))
    };
    // The record lowest and wide, so that it hides no model.
    let list = [
        over_time("recorded", Ink::Recorded, &of.effort),
        over_time("declared model", Ink::Before, &of.declared),
        over_time("extended model", Ink::After, &of.extended),
    ];
    let title = "Effort on the validation record";
    curves(
        &Plot::new(title, "time, s", result.effort_unit, WHOLE_PX),
        &list,
    )
}

/// Each effect that was found in the effort: what the model without it leaves, and the effect.
#[must_use]
pub fn effect_pictures(result: &Identification) -> Vec<String> {
    let pictures = result.curves.effects.iter();
    pictures
        .map(|curve| effect_picture(result, curve))
        .collect()
}

fn effect_picture(result: &Identification, curve: &EffectCurve) -> String {
    let knee = result.report.parameters.get("stribeck_velocity");
    let knee = knee.filter(|_| curve.effect == "stribeck" && result.position_unit == "m");
    // A knee of millimetres a second is nothing beside the fastest move.
    let factor = knee.map_or(1.0, |_| 1.0e3);
    let of = |column: usize| {
        let points = curve.points.iter();
        points.map(move |at| (factor * at[0], at[column]))
    };
    let list = [
        Curve::cloud("residual without it", Ink::Before, of(1)),
        Curve::cloud("the effect", Ink::After, of(2)),
    ];
    let title = format!("{}: {} (training)", curve.effect, curve.equation);
    let (x, reach) = knee.map_or((curve.against.clone(), None), |knee| {
        let reach = KNEES * factor * knee.value.abs();
        ("velocity, mm/s".to_owned(), Some((-reach, reach)))
    });
    let plot = Plot {
        x_range: reach,
        ..Plot::new(&title, &x, result.effort_unit, HALF_PX)
    };
    curves(&plot, &list)
}

/// Velocities of the knee of Stribeck's curve that are shown.
const KNEES: f64 = 10.0;

/// Friction after a reversal with its interval, where there is presliding.
#[must_use]
pub fn presliding_picture(result: &Identification) -> Option<String> {
    let curve = result.report.presliding.as_ref()?;
    let unit = position_error_unit(result);
    let way = |at: &AfterReversal| 1.0e6 * at.way;
    let points = || curve.points.iter();
    let list = [
        Curve::band(
            "95 % interval",
            Ink::After,
            points().map(|at| [way(at), at.low, at.high]),
        ),
        Curve::line(
            "friction",
            Ink::After,
            points().map(|at| (way(at), at.force)),
        ),
    ];
    let title = format!("Friction after a reversal ({})", curve.law);
    let label = format!("way since the reversal, {unit}");
    Some(curves(
        &Plot::new(&title, &label, result.effort_unit, HALF_PX),
        &list,
    ))
}

/// What the free run leaves over time.
#[must_use]
pub fn free_run_picture(result: &Identification) -> String {
    let of = |column: usize| {
        let points = result.curves.free_run.iter();
        points.map(move |at| (at[0], at[column]))
    };
    let list = [
        Curve::line("declared model", Ink::Before, of(1)),
        Curve::line("extended model", Ink::After, of(2)),
    ];
    let title = "Free run on the validation record: simulated − recorded";
    curves(
        &Plot::new(title, "time, s", position_error_unit(result), WHOLE_PX),
        &list,
    )
}
