//! Pictures of one identification: what the declared model leaves, and what was found in it.

use identification::{AfterReversal, EffectCurve, Identification};

use super::plots::{self, Curve};
use super::result_tables::position_error_unit;
use crate::error::Outcome;

/// Columns of `points` against each other.
fn dots(name: &str, points: impl Iterator<Item = (f64, f64)>) -> Curve {
    Curve {
        name: name.into(),
        points: points.collect(),
        dots: true,
    }
}

fn line(name: &str, points: impl Iterator<Item = (f64, f64)>) -> Curve {
    Curve {
        name: name.into(),
        points: points.collect(),
        dots: false,
    }
}

/// What the models leave, against velocity and against position.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn residual_pictures(result: &Identification) -> Outcome<Vec<String>> {
    let unit = result.position_unit;
    Ok(vec![
        residual(result, 0, "velocity", &format!("velocity, {unit}/s"))?,
        residual(result, 1, "position", &format!("position, {unit}"))?,
    ])
}

fn residual(result: &Identification, column: usize, name: &str, label: &str) -> Outcome<String> {
    let moving = || result.curves.moving.iter();
    let list = [
        dots("declared", moving().map(|row| (row[column], row[2]))),
        dots("extended", moving().map(|row| (row[column], row[3]))),
    ];
    plots::curves(
        &format!("Residual against {name} (validation)"),
        label,
        result.effort_unit,
        (540, 360),
        &list,
    )
}

/// Recorded and predicted effort over time.
///
/// # Errors
/// Where the plot cannot be drawn.
pub fn time_picture(result: &Identification) -> Outcome<String> {
    let curves = &result.curves;
    let over_time = |name: &str, values: &[f64]| {
        let times = curves.time_s.iter().copied();
        line(name, times.zip(values.iter().copied()))
    };
    let list = [
        over_time("declared", &curves.declared),
        over_time("extended", &curves.extended),
        over_time("recorded", &curves.effort),
    ];
    plots::curves(
        "Effort on the validation record",
        "time, s",
        result.effort_unit,
        (1080, 340),
        &list,
    )
}

/// Each effect that was found in the effort: what the model without it leaves, and the effect.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn effect_pictures(result: &Identification) -> Outcome<Vec<String>> {
    let picture = |curve: &EffectCurve| {
        let points = || curve.points.iter();
        let list = [
            dots(
                "residual without it",
                points().map(|point| (point[0], point[1])),
            ),
            dots("the effect", points().map(|point| (point[0], point[2]))),
        ];
        plots::curves(
            &format!("{}: {} (training)", curve.effect, curve.equation),
            &curve.against,
            result.effort_unit,
            (540, 360),
            &list,
        )
    };
    result.curves.effects.iter().map(picture).collect()
}

/// Friction after a reversal with its interval, where there is presliding.
///
/// # Errors
/// Where the plot cannot be drawn.
pub fn presliding_picture(result: &Identification) -> Outcome<Option<String>> {
    let Some(curve) = &result.report.presliding else {
        return Ok(None);
    };
    let (factor, unit) = small(result.position_unit);
    let over_way = |name: &str, value: fn(&AfterReversal) -> f64| {
        let points = curve.points.iter();
        line(name, points.map(|at| (factor * at.way, value(at))))
    };
    let list = [
        over_way("friction", |at| at.force),
        over_way("low", |at| at.low),
        over_way("high", |at| at.high),
    ];
    let picture = plots::curves(
        &format!("Friction after a reversal ({})", curve.law),
        &format!("way since the reversal, {unit}"),
        result.effort_unit,
        (540, 360),
        &list,
    );
    picture.map(Some)
}

/// A millionth of a position unit.
fn small(unit: &str) -> (f64, &'static str) {
    match unit {
        "m" => (1.0e6, "µm"),
        _ => (1.0e6, "µrad"),
    }
}

/// What the free run leaves over time.
///
/// # Errors
/// Where the plot cannot be drawn.
pub fn free_run_picture(result: &Identification) -> Outcome<String> {
    let points = || result.curves.free_run.iter();
    let list = [
        line("declared", points().map(|point| (point[0], point[1]))),
        line("extended", points().map(|point| (point[0], point[2]))),
    ];
    plots::curves(
        "Free run on the validation record: simulated − recorded",
        "time, s",
        position_error_unit(result),
        (1080, 300),
        &list,
    )
}
