//! The drive's model of friction, from what was identified of an axis.
//!
//! ```text
//! presliding ─▶ elements     stribeck ─▶ factors, lag     compliance, masses ─▶ wind-up
//! position_dependent_friction ─▶ levels along the travel
//! ```
//!
//! Presliding comes as springs that slip, of both sides of the screw ([`Springs`]): those that were
//! identified as they are, or those of a bristle (Dahl), or those of a bristle at the table and
//! such as were identified at the motor.

use std::f64::consts::TAU;

use axis_model::{
    Backlash, Compliance, Coulomb, Effect, Estimate, Inertia, PositionDependentFriction,
    Presliding, Stribeck, TorqueRipple, Viscous,
};
use identification::{Identification, PreslidingCurve, SlipElement};

use super::crossing::Crossing;
use super::springs::{Spring, Springs, of_bristle};
use crate::compensation::{
    BENDS_PER_M2, GAPS_M, LEVELS, LONGEST_SLIP_M, Model, PERIODS_M, RIPPLES, Ripple,
    SHORTEST_SLIP_M, SLOPES_PER_M, WAY_ASYMMETRIES,
};
use crate::model_file::{Known, MotorSide};

/// Friction that no reversal shows to give way slips within this, m.
pub const RIGID_M: f64 = 1.0e-6;
/// The factors end where the Stribeck fall has come down to this share of itself.
const END_OF_FALL: f64 = 2.0e-3;

/// Friction that is said to differ by direction by more than this is a weight beside it: a record
/// without a load scale calls all of an offset so where the fall differs by direction.
const MOST_ASYMMETRY: f64 = 0.5;

/// What a ripple may be out of step with at the end of the travel, turns: with a sixth of one, what
/// takes it away is as far from it as it is from nothing.
const MOST_OPEN_TURNS: f64 = 1.0 / 6.0;

/// What was identified of an axis, one effect by one.
struct Found<'a> {
    coulomb_n: f64,
    /// What takes the same force either way.
    offset_n: f64,
    viscous: f64,
    inertia: Option<&'a Inertia<Estimate>>,
    stribeck: Option<&'a Stribeck<Estimate>>,
    presliding: Option<&'a Presliding<Estimate>>,
    compliance: Option<&'a Compliance<Estimate>>,
    gap: Option<&'a Backlash<Estimate>>,
    over_position: Option<&'a PositionDependentFriction<Estimate>>,
    viscous_asymmetry: f64,
    coulomb_asymmetry: f64,
    ripples: Vec<&'a TorqueRipple<Estimate>>,
}

impl<'a> Found<'a> {
    fn of(effects: &'a [Effect<Estimate>]) -> Self {
        let mut found = Self {
            coulomb_n: 0.0,
            offset_n: 0.0,
            viscous: 0.0,
            inertia: None,
            stribeck: None,
            presliding: None,
            compliance: None,
            gap: None,
            over_position: None,
            viscous_asymmetry: 0.0,
            coulomb_asymmetry: 0.0,
            ripples: Vec::new(),
        };
        for effect in effects {
            match effect {
                Effect::Coulomb(Coulomb { coulomb }) => found.coulomb_n = coulomb.value.max(0.0),
                Effect::Offset(own) => found.offset_n = own.offset.value,
                Effect::Viscous(Viscous { viscous }) => found.viscous = viscous.value.max(0.0),
                Effect::Inertia(own) => found.inertia = Some(own),
                Effect::Stribeck(own) => found.stribeck = Some(own),
                Effect::Presliding(own) => found.presliding = Some(own),
                Effect::Compliance(own) => found.compliance = Some(own),
                Effect::Backlash(own) => found.gap = Some(own),
                Effect::PositionDependentFriction(own) => found.over_position = Some(own),
                Effect::ViscousAsymmetry(own) => {
                    found.viscous_asymmetry = own.viscous_asymmetry.value;
                }
                Effect::CoulombAsymmetry(own) => {
                    let own = own.coulomb_asymmetry.value;
                    found.coulomb_asymmetry = if own.abs() > MOST_ASYMMETRY { 0.0 } else { own };
                }
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

    /// Damping of a bristle over its stiffness: so far its force is ahead of its bend.
    fn bristle_lead_s(&self, bristle_m: f64) -> f64 {
        let damping = self.presliding.and_then(|own| own.damping.as_ref());
        let damping = damping.map_or(0.0, |own| own.value.max(0.0));
        damping * bristle_m / self.coulomb_n
    }

    /// Those of bristles; where there are none, of friction that gives way at once.
    fn springs(&self, motor: Option<MotorSide>) -> Springs {
        let bristle_m = self.bristle_m();
        let springs = Springs::of_sides(self.coulomb_n, motor, |level_n, deflection| {
            let rigid = || {
                vec![Spring {
                    level_n,
                    way_m: RIGID_M,
                }]
            };
            bristle_m.map_or_else(rigid, |own_m| of_bristle(level_n, deflection * own_m))
        });
        Springs {
            bristle_share: bristle_m.map_or(0.0, |_| 1.0),
            ..springs
        }
    }

    /// Springs of elements that were identified, on both sides or beside a bristle of the table;
    /// `None` where there are none. Where those of the motor's side are not known, they are those
    /// of the table, stretched.
    fn slipping(&self, curve: &PreslidingCurve, motor: Option<MotorSide>) -> Option<Springs> {
        let springs = |elements: &[SlipElement], level_n: f64, deflection: f64| -> Vec<Spring> {
            let spring = |own: &SlipElement| Spring {
                level_n: own.share * level_n,
                way_m: deflection * own.deflection,
            };
            elements.iter().map(spring).collect()
        };
        let of_motor = motor.filter(|_| !curve.motor_elements.is_empty());
        let mut both = if curve.elements.is_empty() {
            let share = of_motor?.share;
            Springs {
                bristle_share: 1.0 - share,
                ..self.springs(motor)
            }
        } else {
            let stretched = |level_n, deflection| springs(&curve.elements, level_n, deflection);
            Springs::of_sides(self.coulomb_n, motor, stretched)
        };
        if let Some(motor) = of_motor {
            both.motor = springs(&curve.motor_elements, motor.share * self.coulomb_n, 1.0);
        }
        Some(both)
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
    let found = Found::of(&result.effects);
    let motor = MotorSide::of(&result.report.parameters);
    let curve = result.report.presliding.as_ref();
    let curve = curve.filter(|_| found.presliding.is_some());
    let slipping = curve.and_then(|curve| found.slipping(curve, motor));
    of_effects(known, &result.effects, slipping, motor)
}

/// The model of what is known of an axis: with springs that slip where a side has such, else with a
/// bristle on the table and one of the motor's side.
#[must_use]
pub fn of_effects(
    known: &Known,
    effects: &[Effect<Estimate>],
    slipping: Option<Springs>,
    motor: Option<MotorSide>,
) -> Option<Model> {
    let found = Found::of(effects);
    if found.coulomb_n <= 0.0 {
        return None;
    }
    let (factor, span_m_per_s) = found.factors();
    let mut model = Model {
        factor,
        span_m_per_s,
        viscous_n_s_per_m: found.viscous,
        viscous_asymmetry_n_s_per_m: found.viscous * found.viscous_asymmetry,
        level_asymmetry_n: found.coulomb_n * found.coulomb_asymmetry,
        lag_s: found.stribeck.map_or(0.0, lag_s),
        ahead_s: known.lag_s,
        ..Model::OFF
    };
    let springs = slipping.unwrap_or_else(|| found.springs(motor));
    let share = springs.bristle_share;
    let bristle_m = found.bristle_m().filter(|_| share > 0.0);
    let lead_s = bristle_m.map_or(0.0, |bristle_m| found.bristle_lead_s(bristle_m));
    model.damping_s = share * lead_s;
    if let Some(bristle_m) = bristle_m {
        give_bristle(&mut model, &found, bristle_m, share);
    }
    give_screw(&mut model, &found, known, lead_s);
    give_elements(&mut model, springs);
    give_places(&mut model, &found, known);
    give_gap(&mut model, &found, known);
    Some(model)
}

fn give_elements(model: &mut Model, springs: Springs) {
    let elements = springs.elements(model.stiffness_n_per_m);
    for (place, own) in elements.into_iter().enumerate() {
        model.level_n[place] = own.level_n;
        model.slip_m[place] = own.slip_m.clamp(SHORTEST_SLIP_M, LONGEST_SLIP_M);
        // Rounding may leave a motor's spring a little less than nothing.
        model.motor_share[place] = (own.motor_n / own.level_n).clamp(0.0, 1.0);
    }
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

/// A ripple as the drive has it; `None` without a phase, without a period that it can hold, or
/// where the period is not known well enough to stay in step along the travel.
fn ripple(own: &TorqueRipple<Estimate>, known: &Known) -> Option<Ripple> {
    let phase_rad = own.phase.as_ref()?.value;
    let half_width = |own: &Estimate| 0.5 * (own.high - own.low);
    let by_period = |own: &Estimate| (own.value, half_width(own) / own.value.powi(2));
    let by_order = |own: &Estimate| (known.lead_m / own.value, half_width(own) / known.lead_m);
    let period = own.period.as_ref().map(by_period);
    let (period_m, open_per_m) = period.or_else(|| own.order.as_ref().map(by_order))?;
    let open_turns = known.limits.travel_m * open_per_m;
    if !PERIODS_M.contains(&period_m) || open_turns > MOST_OPEN_TURNS {
        return None;
    }
    let turns = phase_rad / TAU - known.origin_m / period_m;
    Some(Ripple {
        amplitude_n: own.amplitude.value,
        period_m,
        phase_turns: turns - turns.floor(),
    })
}

/// The drive has one lag for all velocities: that of half the fall.
fn lag_s(stribeck: &Stribeck<Estimate>) -> f64 {
    let value = |own: &Option<Estimate>| own.as_ref().map_or(0.0, |own| own.value.max(0.0));
    value(&stribeck.lag) * (1.0 + 0.5 * value(&stribeck.lag_growth))
}

/// A bristle comes to another level within its deflection. The way within which it comes to that is
/// as different by direction as that. The drive has one way for all of its friction: beside springs
/// that slip, which come to another level at once, a share of it.
fn give_bristle(model: &mut Model, found: &Found<'_>, bristle_m: f64, share: f64) {
    let (least, most) = WAY_ASYMMETRIES.into_inner();
    model.way_asymmetry = share * found.coulomb_asymmetry.clamp(least, most);
    model.lag_m = share * bristle_m * (1.0 + found.rise());
}

/// The screw that friction winds up, where it was identified; that of the table is ahead of its
/// bend by so much.
fn give_screw(model: &mut Model, found: &Found<'_>, known: &Known, lead_s: f64) {
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
    model.windup_ahead_s = lead_s - damping / stiffness;
    model.table_mass_kg = load.value;
}

/// The gap behind the motor. A constant force shifts where it is crossed, and friction of the table
/// that differs by direction is one beside another that does not, at crossings by its level at
/// rest. A force that friction never comes up to holds the table on one flank. Without a screw the
/// drive does not cross any.
fn give_gap(model: &mut Model, found: &Found<'_>, known: &Known) {
    let by_direction_n = found.coulomb_asymmetry * model.table_n();
    let sliding = Model {
        gap_m: found.gap.map_or(0.0, |own| own.gap.value),
        table_force_n: found.offset_n + by_direction_n,
        ..*model
    };
    let is_behind = model.table_mass_kg > 0.0 && GAPS_M.contains(&sliding.gap_m);
    if !is_behind || sliding.table_force_n.abs() >= model.table_n() {
        return;
    }
    let crossing = Crossing::of(&sliding, known.limits.acceleration_m_per_s2);
    let [at_rest, ..] = model.factor;
    *model = Model {
        gap_force_n: crossing.force_n,
        gap_velocity_m_per_s: crossing.velocity_m_per_s,
        table_force_n: found.offset_n + at_rest * by_direction_n,
        ..sliding
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::ELEMENTS;

    fn about(value: f64) -> Estimate {
        Estimate::about(value, 0.0, "")
    }

    #[test]
    fn a_lag_that_goes_with_the_level_is_that_of_half_the_fall() {
        let fall = |lag: Option<f64>, growth: Option<f64>| Stribeck {
            excess: about(100.0),
            velocity: about(1.0e-3),
            exponent: None,
            lag: lag.map(about),
            lag_growth: growth.map(about),
        };
        assert!((lag_s(&fall(Some(6.0e-3), Some(0.5))) - 7.5e-3).abs() < 1.0e-12);
        assert_eq!(lag_s(&fall(Some(6.0e-3), None)), 6.0e-3);
        assert_eq!(lag_s(&fall(None, None)), 0.0);
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

    #[test]
    fn a_ripple_that_may_be_out_of_step_within_the_travel_is_left_out() {
        let machine = plant_sim::Machine::reference();
        let known = Known::of_machine(&machine.axes[0], machine.period_s);
        let ripple_of = |order: Option<f64>, period: Option<f64>| {
            let own = TorqueRipple {
                amplitude: about(30.0),
                order: order.map(|half_width| Estimate::about(5.0, half_width, "")),
                period: period.map(|half_width| Estimate::about(2.0e-3, half_width, "m")),
                phase: Some(about(1.0)),
            };
            ripple(&own, &known)
        };
        // A sixth of a turn at the end of the travel, as periods per revolution and as a way.
        let most = known.lead_m / known.limits.travel_m / 6.0;
        let way_m = most * 2.0e-3_f64.powi(2) / known.lead_m;
        let told = ripple_of(Some(0.9 * most), None).unwrap();
        assert!((told.period_m - known.lead_m / 5.0).abs() < 1.0e-12);
        assert_eq!(ripple_of(Some(1.1 * most), None), None);
        assert_eq!(
            ripple_of(None, Some(0.9 * way_m)).map(|own| own.period_m),
            Some(2.0e-3)
        );
        assert_eq!(ripple_of(None, Some(1.1 * way_m)), None);
    }

    #[test]
    fn a_bristle_of_the_table_stands_beside_springs_of_the_motor() {
        let effects = [
            Effect::Coulomb(Coulomb {
                coulomb: about(400.0),
            }),
            Effect::CoulombAsymmetry(axis_model::CoulombAsymmetry {
                coulomb_asymmetry: about(0.1),
            }),
            Effect::Presliding(Presliding {
                deflection: about(1.0e-5),
                damping: Some(about(3.0e4)),
            }),
            Effect::Inertia(Inertia {
                inertia: about(930.0),
                load: Some(about(300.0)),
            }),
            Effect::Compliance(Compliance {
                stiffness: about(1.2e8),
                damping: None,
            }),
        ];
        let curve = |motor_elements: Vec<SlipElement>| PreslidingCurve {
            law: "dahl",
            elements: Vec::new(),
            motor_elements,
            points: Vec::new(),
        };
        let of_motor = SlipElement {
            deflection: 3.0e-6,
            share: 1.0,
        };
        let motor = MotorSide {
            coulomb_n: 100.0,
            share: 0.25,
            deflection: 0.5,
        };
        let found = Found::of(&effects);
        let both = found.slipping(&curve(vec![of_motor]), Some(motor)).unwrap();
        assert_eq!((both.table.len(), both.bristle_share), (100, 0.75));
        assert_eq!(
            both.motor,
            [Spring {
                level_n: 100.0,
                way_m: 3.0e-6,
            }]
        );
        assert_eq!(found.slipping(&curve(Vec::new()), Some(motor)), None);
        let machine = plant_sim::Machine::reference();
        let known = Known::of_machine(&machine.axes[0], machine.period_s);
        let model =
            |springs: Option<Springs>| of_effects(&known, &effects, springs, Some(motor)).unwrap();
        let [beside, alone] = [Some(both), None].map(model);
        for of in [
            |model: &Model| model.lag_m,
            |model: &Model| model.damping_s,
            |model: &Model| model.way_asymmetry,
        ] {
            assert!((of(&beside) / of(&alone) - 0.75).abs() < 1.0e-12);
        }
        // What winds the screw up is ahead as the bristle is.
        for model in [&beside, &alone] {
            assert!((model.windup_ahead_s - 3.0e4 * 1.0e-5 / 400.0).abs() < 1.0e-12);
        }
    }

    /// What was identified of a reference axis with friction that differs by direction, a weight
    /// and a gap.
    fn behind_a_gap(asymmetry: f64, weight_n: f64) -> Model {
        let effects = [
            Effect::Inertia(Inertia {
                inertia: about(930.0),
                load: Some(about(300.0)),
            }),
            Effect::Coulomb(Coulomb {
                coulomb: about(400.0),
            }),
            Effect::CoulombAsymmetry(axis_model::CoulombAsymmetry {
                coulomb_asymmetry: about(asymmetry),
            }),
            Effect::Offset(axis_model::Offset {
                offset: about(weight_n),
            }),
            Effect::Stribeck(Stribeck {
                excess: about(120.0),
                velocity: about(1.5e-3),
                exponent: None,
                lag: None,
                lag_growth: None,
            }),
            Effect::Presliding(Presliding {
                deflection: about(1.0e-5),
                damping: None,
            }),
            Effect::Compliance(Compliance {
                stiffness: about(1.2e8),
                damping: None,
            }),
            Effect::Backlash(Backlash {
                gap: about(6.0e-6),
                motor_friction: None,
                restitution: None,
                load_share: None,
            }),
        ];
        let machine = plant_sim::Machine::reference();
        let known = Known::of_machine(&machine.axes[0], machine.period_s);
        of_effects(&known, &effects, None, None).unwrap()
    }

    #[test]
    fn a_gap_is_crossed_where_weight_and_friction_by_direction_shift_it_and_not_beyond_friction() {
        let model = behind_a_gap(0.1, 50.0);
        assert!((model.table_force_n - (50.0 + 1.3 * 40.0)).abs() < 1.0e-9);
        assert_eq!(model.gap_m, 6.0e-6);
        assert!(model.gap_velocity_m_per_s > 0.0);
        // Friction comes up to 400 N that way and to 360 N the other way.
        assert_eq!(behind_a_gap(0.1, 310.0).gap_m, 6.0e-6);
        assert_eq!(behind_a_gap(0.1, 365.0).gap_m, 0.0);
        assert_eq!(behind_a_gap(-0.1, 365.0).gap_m, 6.0e-6);
    }
}
