//! The drive's model of friction, from what was identified of an axis.
//!
//! ```text
//! presliding ─▶ elements     stribeck ─▶ factors, lag     compliance, masses ─▶ wind-up
//! position_dependent_friction ─▶ levels along the travel
//! ```
//!
//! Elements have ways from rest: after a reversal a spring goes twice as far until it slips the
//! other way (Masing). Elements that were identified are taken as they are. A bristle (Dahl) comes
//! off its level within its deflection δ after a reversal, so from rest its curve is
//! `V(x) = F (1 − exp(−2 x / δ))`, and is cut into elements: those that slip between a and b carry
//! `[V − x V']` from a to b and have the stiffness `V'(a) − V'(b)`.

use std::f64::consts::TAU;

use axis_model::{
    Compliance, Coulomb, Effect, Estimate, Inertia, PositionDependentFriction, Presliding,
    Stribeck, TorqueRipple, Viscous,
};
use identification::Identification;

use crate::compensation::{
    BENDS_PER_M2, ELEMENTS, LEVELS, Model, PERIODS_M, RIPPLES, Ripple, SLOPES_PER_M,
};
use crate::model_file::{Known, MotorSide};

/// Friction that no reversal shows to give way slips within this, m.
const RIGID_M: f64 = 1.0e-6;
/// The factors end where the Stribeck fall has come down to this share of itself.
const END_OF_FALL: f64 = 2.0e-3;

/// What was identified of an axis, one effect by one.
struct Found<'a> {
    coulomb_n: f64,
    viscous: f64,
    inertia: Option<&'a Inertia<Estimate>>,
    stribeck: Option<&'a Stribeck<Estimate>>,
    presliding: Option<&'a Presliding<Estimate>>,
    compliance: Option<&'a Compliance<Estimate>>,
    over_position: Option<&'a PositionDependentFriction<Estimate>>,
    asymmetry: f64,
    ripples: Vec<&'a TorqueRipple<Estimate>>,
}

impl<'a> Found<'a> {
    fn of(effects: &'a [Effect<Estimate>]) -> Self {
        let mut found = Self {
            coulomb_n: 0.0,
            viscous: 0.0,
            inertia: None,
            stribeck: None,
            presliding: None,
            compliance: None,
            over_position: None,
            asymmetry: 0.0,
            ripples: Vec::new(),
        };
        for effect in effects {
            match effect {
                Effect::Coulomb(Coulomb { coulomb }) => found.coulomb_n = coulomb.value.max(0.0),
                Effect::Viscous(Viscous { viscous }) => found.viscous = viscous.value.max(0.0),
                Effect::Inertia(own) => found.inertia = Some(own),
                Effect::Stribeck(own) => found.stribeck = Some(own),
                Effect::Presliding(own) => found.presliding = Some(own),
                Effect::Compliance(own) => found.compliance = Some(own),
                Effect::PositionDependentFriction(own) => found.over_position = Some(own),
                Effect::ViscousAsymmetry(own) => found.asymmetry = own.viscous_asymmetry.value,
                Effect::TorqueRipple(own) => found.ripples.push(own),
                _ => {}
            }
        }
        found
    }

    /// Excess of the level at standstill over that of fast motion, a share of it.
    fn rise(&self) -> f64 {
        let excess = self.stribeck.map_or(0.0, |own| own.excess.value.max(0.0));
        excess / self.coulomb_n
    }

    fn bristle_m(&self) -> Option<f64> {
        let own = self.presliding?;
        Some(own.deflection.value.max(RIGID_M))
    }

    fn factors(&self) -> ([f64; LEVELS], f64) {
        let Some(own) = self.stribeck else {
            return ([1.0; LEVELS], 0.0);
        };
        let exponent = own.exponent.as_ref().map_or(2.0, |own| own.value);
        let end = (-END_OF_FALL.ln()).powf(1.0 / exponent);
        let mut factors = [1.0; LEVELS];
        for (place, factor) in factors.iter_mut().enumerate() {
            let speed = end * place as f64 / (LEVELS - 1) as f64;
            *factor += self.rise() * (-speed.powf(exponent)).exp();
        }
        (factors, end * own.velocity.value)
    }
}

/// The model of an axis; `None` where no friction was identified.
#[must_use]
pub fn of_axis(known: &Known, result: &Identification) -> Option<Model> {
    let curve = result.report.presliding.as_ref();
    let elements = curve.map_or(&[][..], |curve| &curve.elements);
    let slipping: Vec<(f64, f64)> = elements
        .iter()
        .map(|own| (own.share, own.deflection))
        .collect();
    let model = of_effects(known, &result.effects, &slipping)?;
    Some(match MotorSide::of(&result.report.parameters) {
        Some(motor) => beside_motor(&model, motor),
        None => model,
    })
}

/// The model of an axis of whose friction all was taken for the table's: each element is one of the
/// table and one of the motor's side.
#[must_use]
pub fn beside_motor(model: &Model, motor: MotorSide) -> Model {
    let table_share = 1.0 - motor.share;
    let pairs = model.level_n.into_iter().zip(model.slip_m);
    let both = pairs.flat_map(|(level_n, slip_m)| {
        let of_motor = (motor.share * level_n, motor.deflection * slip_m);
        [(table_share * level_n, slip_m), of_motor]
    });
    Model {
        table_share,
        ..with_elements(model, few(both.collect()))
    }
}

fn with_elements(model: &Model, elements: Vec<(f64, f64)>) -> Model {
    let mut model = Model {
        level_n: Model::OFF.level_n,
        slip_m: Model::OFF.slip_m,
        ..*model
    };
    for (place, (level_n, slip_m)) in elements.into_iter().enumerate().take(ELEMENTS) {
        (model.level_n[place], model.slip_m[place]) = (level_n, slip_m);
    }
    model
}

/// The model of what is known of an axis, with the elements of its presliding: shares of the level
/// and ways from rest, m; none of a bristle. All friction is the table's.
#[must_use]
pub fn of_effects(
    known: &Known,
    effects: &[Effect<Estimate>],
    elements: &[(f64, f64)],
) -> Option<Model> {
    let found = Found::of(effects);
    if found.coulomb_n <= 0.0 {
        return None;
    }
    let slips = !elements.is_empty();
    let elements = match found.bristle_m() {
        Some(_) if slips => {
            let own = elements.iter();
            few(own
                .map(|(share, way_m)| (share * found.coulomb_n, *way_m))
                .collect())
        }
        Some(bristle_m) => of_bristle(found.coulomb_n, bristle_m),
        None => vec![(found.coulomb_n, RIGID_M)],
    };
    let (factor, span_m_per_s) = found.factors();
    let mut model = Model {
        factor,
        span_m_per_s,
        viscous_n_s_per_m: found.viscous,
        ahead_s: known.lag_s,
        ..Model::OFF
    };
    model = with_elements(&model, elements);
    model.lag_s = found.stribeck.map_or(0.0, lag_s);
    if let (false, Some(bristle_m)) = (slips, found.bristle_m()) {
        give_bristle(&mut model, &found, bristle_m);
    }
    give_screw(&mut model, &found, known);
    model.viscous_asymmetry_n_s_per_m = found.viscous * found.asymmetry;
    give_places(&mut model, &found, known);
    Some(model)
}

/// What goes with the position: levels along the travel and ripple. Records have the position of
/// the motor, the drive goes by that of its loop.
fn give_places(model: &mut Model, found: &Found<'_>, known: &Known) {
    if let Some(own) = found.over_position {
        give_slope(model, own, known.origin_m);
    }
    let mut ripples: Vec<Ripple> = found
        .ripples
        .iter()
        .filter_map(|own| ripple(own, known))
        .collect();
    ripples.sort_by(|one, other| other.amplitude_n.total_cmp(&one.amplitude_n));
    for (place, own) in ripples.into_iter().enumerate().take(RIPPLES) {
        model.ripple[place] = own;
    }
}

/// Levels along the travel, as far as the drive can hold them: friction at position zero of the
/// motor is not that at position zero of the loop.
fn give_slope(model: &mut Model, own: &PositionDependentFriction<Estimate>, origin_m: f64) {
    let slope = own.linear.value;
    let bend = own.quadratic.as_ref().map_or(0.0, |bend| bend.value);
    let there = 1.0 - slope * origin_m + bend * origin_m * origin_m;
    let (slope, bend) = ((slope - 2.0 * bend * origin_m) / there, bend / there);
    if there > 0.0 && SLOPES_PER_M.contains(&slope) && BENDS_PER_M2.contains(&bend) {
        *model = Model {
            slope_per_m: slope,
            bend_per_m2: bend,
            ..model.times(there)
        };
    }
}

/// A ripple as the drive has it; `None` without a phase, or without a period that it can hold.
fn ripple(own: &TorqueRipple<Estimate>, known: &Known) -> Option<Ripple> {
    let phase_rad = own.phase.as_ref()?.value;
    let of_order = || Some(known.lead_m / own.order.as_ref()?.value);
    let period_m = own.period.as_ref().map(|period| period.value);
    let period_m = period_m.or_else(of_order)?;
    if !PERIODS_M.contains(&period_m) {
        return None;
    }
    let turns = phase_rad / TAU - known.origin_m / period_m;
    Some(Ripple {
        amplitude_n: own.amplitude.value,
        period_m,
        phase_turns: turns - turns.floor(),
    })
}

fn lag_s(stribeck: &Stribeck<Estimate>) -> f64 {
    stribeck.lag.as_ref().map_or(0.0, |lag| lag.value.max(0.0))
}

/// A bristle comes to another level within its deflection, and has a damping.
fn give_bristle(model: &mut Model, found: &Found<'_>, bristle_m: f64) {
    model.lag_m = bristle_m * (1.0 + found.rise());
    let damping = found.presliding.and_then(|own| own.damping.as_ref());
    let damping = damping.map_or(0.0, |own| own.value.max(0.0));
    model.damping_s = damping * bristle_m / found.coulomb_n;
}

/// The screw that friction winds up, where it was identified.
fn give_screw(model: &mut Model, found: &Found<'_>, known: &Known) {
    let all_kg = found
        .inertia
        .map_or(known.inertia_kg, |own| own.inertia.value);
    let load = found.inertia.and_then(|own| own.load.as_ref());
    let (Some(screw), Some(load)) = (found.compliance, load) else {
        return;
    };
    let stiffness = screw.stiffness.value;
    let damping = screw.damping.as_ref().map_or(0.0, |own| own.value.max(0.0));
    model.stiffness_n_per_m = stiffness;
    model.motor_inertia_kg = (all_kg - load.value).max(0.0);
    model.windup_ahead_s = model.damping_s - damping / stiffness;
}

/// A bristle as elements, cut where `V'` has come down to (1 − i / n)² of its begin: the tail is as
/// long as the begin is steep.
fn of_bristle(level_n: f64, deflection_m: f64) -> Vec<(f64, f64)> {
    let scale_m = 0.5 * deflection_m;
    // With e = exp(−x / scale), V' is e level / scale and V − x V' is level (1 − e (1 − ln e)).
    let carried = |e: f64| 1.0 - if e > 0.0 { e * (1.0 - e.ln()) } else { 0.0 };
    let cut = |place: usize| (1.0 - place as f64 / ELEMENTS as f64).powi(2);
    let element = |place: usize| {
        let (from, to) = (cut(place), cut(place + 1));
        let level = carried(to) - carried(from);
        (level_n * level, scale_m * level / (from - to))
    };
    (0..ELEMENTS).map(element).collect()
}

/// As many elements as the drive has, at most: the two nearest become one, as stiff and as strong.
fn few(elements: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut elements: Vec<(f64, f64)> = elements
        .into_iter()
        .filter(|(level, _)| *level > 0.0)
        .collect();
    elements.sort_by(|one, other| one.1.total_cmp(&other.1));
    while elements.len() > ELEMENTS {
        let ratio = |place: &usize| elements[place + 1].1 / elements[*place].1;
        let nearest = (0..elements.len() - 1).min_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        let place = nearest.unwrap_or(0);
        let (one, other) = (elements[place], elements.remove(place + 1));
        let level = one.0 + other.0;
        elements[place] = (level, level / (one.0 / one.1 + other.0 / other.1));
    }
    elements
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(elements: &[(f64, f64)], way_m: f64) -> f64 {
        let of = |(level, slip): &(f64, f64)| level * (way_m / slip).min(1.0);
        elements.iter().map(of).sum()
    }

    #[test]
    fn elements_of_a_bristle_follow_its_curve_to_a_hundredth_of_the_level() {
        let elements = of_bristle(400.0, 1.0e-5);
        assert!(
            (force(&elements, 1.0) - 400.0).abs() < 1.0e-9,
            "the whole level"
        );
        for place in 0..400 {
            let way_m = 1.0e-7 * f64::from(place);
            let curve = 400.0 * (1.0 - (-2.0 * way_m / 1.0e-5).exp());
            let off = force(&elements, way_m) - curve;
            assert!(off.abs() < 4.0, "{off} N at {way_m} m");
        }
    }

    #[test]
    fn more_elements_than_the_drive_has_become_fewer_with_the_same_level_and_stiffness() {
        let many: Vec<(f64, f64)> = (1..=14)
            .map(|place| (10.0 * f64::from(place % 4), 1.0e-6 * f64::from(place)))
            .collect();
        let fewer = few(many.clone());
        assert_eq!(fewer.len(), ELEMENTS);
        let stiffness = |elements: &[(f64, f64)]| force(elements, 1.0e-9);
        assert!((force(&fewer, 1.0) - force(&many, 1.0)).abs() < 1.0e-9);
        assert!((stiffness(&fewer) / stiffness(&many) - 1.0).abs() < 1.0e-9);
    }

    #[test]
    fn friction_of_the_motors_side_is_beside_the_tables_and_winds_nothing_up() {
        let model = with_elements(&Model::OFF, of_bristle(400.0, 1.0e-5));
        let motor = MotorSide {
            coulomb_n: 100.0,
            share: 0.25,
            deflection: 0.4,
        };
        let both = beside_motor(&model, motor);
        assert_eq!(both.table_share, 0.75);
        assert!((both.level_n() - 400.0).abs() < 1.0e-9);
        let elements: Vec<_> = both.level_n.into_iter().zip(both.slip_m).collect();
        for place in 0..40 {
            let way_m = 1.0e-6 * f64::from(place);
            let bristle = |level_n: f64, deflection_m: f64| {
                level_n * (1.0 - (-2.0 * way_m / deflection_m).exp())
            };
            let wanted = bristle(300.0, 1.0e-5) + bristle(100.0, 4.0e-6);
            let off = force(&elements, way_m) - wanted;
            assert!(off.abs() < 8.0, "{off} N at {way_m} m");
        }
    }

    fn about(value: f64) -> Estimate {
        Estimate::about(value, 0.0, "")
    }

    #[test]
    fn levels_along_the_travel_are_the_same_function_from_another_zero() {
        let own = PositionDependentFriction {
            linear: about(-0.8),
            quadratic: Some(about(2.5)),
        };
        let begin = Model {
            level_n: [40.0; ELEMENTS],
            ..Model::OFF
        };
        let mut model = begin;
        give_slope(&mut model, &own, 0.1);
        for motor_m in [-0.2, 0.0, 0.15] {
            let level_n = 400.0 * (1.0 - 0.8 * motor_m + 2.5 * motor_m * motor_m);
            let loop_m = motor_m + 0.1;
            let along = model.slope_per_m * loop_m + model.bend_per_m2 * loop_m * loop_m;
            assert!((model.level_n() * (1.0 + along) - level_n).abs() < 1.0e-9);
        }
        let stiffness = |model: &Model| model.level_n[0] / model.slip_m[0];
        assert!((stiffness(&model) / stiffness(&begin) - 1.0).abs() < 1.0e-9);
        // What the drive cannot hold is left out.
        let mut steep = begin;
        let own = PositionDependentFriction {
            linear: about(-0.8),
            quadratic: Some(about(3000.0)),
        };
        give_slope(&mut steep, &own, 0.0);
        assert_eq!(steep, begin);
    }
}
