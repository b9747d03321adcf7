//! Wind-up as the load's own motion asks for it ([`load`](super::load)).
//!
//! The recorded effort is noisy, and noise of the effort over the stiffness is wind-up that never
//! was: 20 N over 120 N/µm are 17 counts of 10 nm. What the spring transmits moves the load, and
//! the load's motion was measured.
//!
//! Free coefficients could take a gap for friction. The effort tells: what the spring transmits is
//! in it as K·w, so the wind-up must explain the effort as well as its own parts do when each is
//! free. A gap of 0.2 µm that went into the friction would be 24 N that no effort shows.
//!
//! Units: m or rad, s, unit of the effort.

use super::columns::{Apart, Way};
use super::drag;
use super::flanks::Balance;
use super::is_clear;
use super::load::{Carried, LoadMotion, More};
use super::refined::{between_refined_flanks, stepped};
use super::rubbing::{ALIKE, Law, LoadFriction};
use super::slipping::by_another_law;
use crate::fit::blocks::{Blocks, Gain};
use crate::fit::search::descend;
use crate::fit::side_by_side::side_by_side;
use crate::model::effects::geometric;
use crate::model::effects::stribeck::GAUSS;

/// Deflections that are tried, in moving-velocity units times a second: 0.3 to 300 µm on a linear
/// axis.
const DEFLECTIONS: (f64, f64, u32) = (3.0e-4, 0.3, 16);
/// Velocities of the falling level that are tried, in moving velocities.
const VELOCITIES: [f64; 3] = [0.5, 2.0, 8.0];
/// How far the level rises at rest, to start from.
const RISE: f64 = 0.3;
/// Rounds of descents over the three, each with half the steps of the one before.
const ROUNDS: i32 = 2;

/// Of what a wind-up leaves of the effort at least this part is left where its parts are free. Of
/// machines with gaps of 100 µm whose flanks strike it is 0.84 and more, without strikes 0.99.
/// Where a gap went into the friction it is 0.27 and less: what is swallowed unseen is less than
/// the noise of the effort over the stiffness.
const TIED_PART: f64 = 0.5;
/// Deflections of the motor's own friction that are tried for it, in those of the load's.
const MOTOR_DEFLECTIONS: [f64; 5] = [0.35, 0.7, 1.0, 1.4, 2.5];

/// The best wind-up beside other ways; `unit` is the moving velocity.
fn best(apart: &Apart<'_>, others: &[Way], unit: f64) -> Carried {
    let is_flanks = |way: &Way| match way {
        Way::Flanks(flanks) => Some(*flanks),
        _ => None,
    };
    let flanks = others.iter().find_map(is_flanks);
    let load = LoadMotion::of(apart.motion, apart.path.position, apart.raw, flanks, 0.0);
    let design = apart.design(others).into_iter().chain(load.plain());
    let rows = apart.rows_of(&design.collect::<Vec<_>>());
    let left = |friction: LoadFriction| {
        let rubbed = load.rubbed(apart.motion, friction);
        Blocks::with(&rows, &rubbed).fit().sse
    };
    let friction = descended(start(unit, &left), unit, &left);
    Carried {
        friction,
        flanks,
        strike: unit * apart.motion.period_s,
        smallest_turn: 0.0,
        more: More::default(),
    }
}

/// The best of a grid.
fn start(unit: f64, left: &(dyn Fn(LoadFriction) -> f64 + Sync)) -> LoadFriction {
    let (from, to, count) = DEFLECTIONS;
    let deflections = geometric(from * unit, to * unit, count);
    let at = |deflection: f64| {
        VELOCITIES.map(|velocity| LoadFriction {
            deflection,
            rise: RISE,
            velocity: velocity * unit,
            lag_s: 0.0,
            lag_growth: 0.0,
            exponent: GAUSS,
            forward: ALIKE,
            law: Law::Dahl,
        })
    };
    let tried: Vec<LoadFriction> = deflections.into_iter().flat_map(at).collect();
    let errors = side_by_side(&tried, |friction| left(*friction));
    let pairs = tried.iter().zip(errors);
    let best = pairs.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(at(unit)[0], |(friction, _)| *friction)
}

/// One parameter after the other, again and again.
fn descended(
    mut best: LoadFriction,
    unit: f64,
    left: &(dyn Fn(LoadFriction) -> f64 + Sync),
) -> LoadFriction {
    for round in 0..ROUNDS {
        let step = 0.5_f64.powi(round);
        let (from, to, _) = DEFLECTIONS;
        best.deflection = descend(
            best.deflection,
            0.2 * step * best.deflection,
            (from * unit, to * unit),
            &|deflection| left(LoadFriction { deflection, ..best }),
        );
        best.rise = descend(best.rise, 0.15 * step, (0.0, 4.0), &|rise| {
            left(LoadFriction { rise, ..best })
        });
        best.velocity = descend(
            best.velocity,
            0.3 * step * best.velocity,
            (0.02 * unit, 100.0 * unit),
            &|velocity| left(LoadFriction { velocity, ..best }),
        );
    }
    best
}

/// The same ways with wind-up by the load's motion in the place of that by the effort, where that
/// leaves less, can be, and is in the effort as well. Its friction is a bristle unless that leaves
/// more than so much, rms, and another law less.
pub(super) fn instead(apart: &Apart<'_>, ways: &[Way], unit: f64, enough: f64) -> Option<Vec<Way>> {
    let place = ways
        .iter()
        .position(|way| matches!(way, Way::WindUp { .. } | Way::HalfOf { .. }))?;
    let mut changed = ways.to_vec();
    changed.remove(place);
    let carried = best(apart, &changed, unit);
    changed.insert(place, Way::Carried(carried));
    let apart = &apart.where_known(&changed);
    let changed = between_refined_flanks(apart, changed);
    let changed = stepped(apart, changed, place);
    let changed = if apart.rms_um(&apart.fit(&changed)) > 1.0e6 * enough {
        by_another_law(apart, changed, place)
    } else {
        changed
    };
    let changed = drag::for_a_wide_fall(apart, changed, place);
    let gain = Gain::of(&apart.cross_validate(ways), &apart.cross_validate(&changed));
    (is_clear(&gain) && is_in_effort(apart, &changed, place)).then_some(changed)
}

/// Whether the effort has a wind-up in it: as well as each of its parts were it free.
fn is_in_effort(apart: &Apart<'_>, ways: &[Way], place: usize) -> bool {
    let fitted = apart.fit(ways);
    let Some((way @ Way::Carried(carried), own)) = fitted.at(place) else {
        return false;
    };
    if own[Carried::MASS] <= 0.0 || own[Carried::FRICTION] <= 0.0 {
        return false;
    }
    let balance = Balance::of(apart);
    let free = balance.left_by_all(&apart.columns(way));
    let motor = LoadMotion::of_motor(apart.motion, apart.path.position, 0.0);
    // Without the rate of a bend, which takes what comes with the direction and is in no effort.
    let bends = MOTOR_DEFLECTIONS.map(|deflection| {
        let mut columns = carried.on_motor(apart.motion, &motor, deflection);
        columns.pop();
        columns
    });
    let tied = balance.left_by(&apart.predicted(way, own), &bends);
    free >= TIED_PART * tied
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::evidence::difference::between_rows::Steps;
    use crate::evidence::difference::columns::Path;
    use crate::fit::made::{Axis, on};
    use crate::motion::derivatives::Derivatives;
    use crate::record::units::EffortHold;
    use crate::simulate::made::{record, two_sines};

    pub(in crate::evidence::difference) const FRICTION: LoadFriction = LoadFriction {
        deflection: 20.0e-6,
        rise: 0.4,
        velocity: 4.0e-3,
        lag_s: 0.0,
        lag_growth: 0.0,
        exponent: GAUSS,
        forward: ALIKE,
        law: Law::Dahl,
    };
    /// The same without a fall.
    pub(in crate::evidence::difference) const LEVEL: LoadFriction = LoadFriction {
        rise: 0.0,
        ..FRICTION
    };
    pub(in crate::evidence::difference) const UNIT: f64 = 1.0e-3;
    pub(in crate::evidence::difference) const STIFFNESS: f64 = 5.0e6;

    /// 60 kg with 25 N and 200 N s/m behind 5 N/µm and 30 kg, 4 N of noise in the effort; `more` is
    /// what motor − load has beside the wind-up, by the bend.
    pub(in crate::evidence::difference) fn axis(more: impl Fn(f64) -> f64) -> Axis {
        rubbed(FRICTION, 0.0, more)
    }

    /// The same with such a friction of the load, and so much more viscous friction forward than
    /// backward.
    pub(in crate::evidence::difference) fn rubbed(
        friction: LoadFriction,
        by_direction: f64,
        more: impl Fn(f64) -> f64,
    ) -> Axis {
        rubbed_on_both(friction, [by_direction, 0.0], (0.0, friction), more)
    }

    /// The same with so much Coulomb friction of the motor's own side, which follows another law;
    /// viscous friction of load and motor differ by direction.
    pub(in crate::evidence::difference) fn rubbed_on_both(
        friction: LoadFriction,
        by_direction: [f64; 2],
        motor: (f64, LoadFriction),
        more: impl Fn(f64) -> f64,
    ) -> Axis {
        let [of_load, of_motor] = by_direction;
        let viscous = |v: f64| 200.0 * v + 0.5 * of_load * v.abs();
        made(friction, &viscous, (motor, 0.5 * of_motor), more)
    }

    /// The same with a drag of the load, N s²/m².
    pub(in crate::evidence::difference) fn dragged(friction: LoadFriction, drag: f64) -> Axis {
        let of_velocity = |v: f64| 200.0 * v + drag * v * v.abs();
        made(friction, &of_velocity, ((0.0, friction), 0.0), |_| 0.0)
    }

    /// A load with such a friction over its velocity and such a one over displacement; the motor's
    /// own Coulomb friction, and what comes with the size of its velocity.
    fn made(
        friction: LoadFriction,
        of_velocity: &dyn Fn(f64) -> f64,
        ((motor_coulomb, motor), of_size): ((f64, LoadFriction), f64),
        more: impl Fn(f64) -> f64,
    ) -> Axis {
        let load = two_sines(6000);
        let of = |x: &[f64]| Derivatives::new(x, 1.0e-3, EffortHold::Instant);
        let moved = of(&load);
        let steps = Steps::of(&load, &moved.velocity, 1.0e-3);
        let bend = friction.bend(&steps, &friction.fall(&steps));
        let force = |row: usize| {
            let rubs = of_velocity(moved.velocity[row]) + 25.0 * bend[row];
            60.0 * moved.acceleration[row] + rubs
        };
        let force: Vec<f64> = (0..6000).map(force).collect();
        let wound = force.iter().map(|force| force / STIFFNESS);
        let apart = wound.zip(&bend).map(|(wound, bend)| wound + more(*bend));
        let at: Vec<f64> = load.iter().zip(apart).map(|(x, apart)| x + apart).collect();
        let pushed = of(&at);
        let steps = Steps::of(&at, &pushed.velocity, 1.0e-3);
        let own = motor.bend(&steps, &motor.fall(&steps));
        let noise = |row: usize| 4.0 * (1.7 * (row * row % 1013) as f64).sin();
        let effort = force.iter().enumerate().map(|(row, force)| {
            let own = motor_coulomb * own[row] + of_size * pushed.velocity[row].abs();
            force + 30.0 * pushed.acceleration[row] + own + noise(row)
        });
        let effort = effort.collect();
        let mut made = record(1.0e-3, at);
        made.effort = effort;
        made.load = Some(load);
        on(made)
    }

    /// A wind-up with such a friction, without flanks and nothing else.
    pub(in crate::evidence::difference) fn rubbing_alone(friction: LoadFriction) -> Carried {
        Carried {
            friction,
            flanks: None,
            strike: UNIT * 1.0e-3,
            smallest_turn: 0.0,
            more: More::default(),
        }
    }

    pub(in crate::evidence::difference) fn apart(axis: &Axis) -> Apart<'_> {
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        Apart::on(&axis.motion, path).unwrap()
    }

    pub(in crate::evidence::difference) const WAYS: [Way; 2] = [
        Way::Constant,
        Way::WindUp {
            motor_friction: false,
        },
    ];

    #[test]
    fn the_loads_motion_knows_the_wind_up_better_than_a_noisy_effort() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let ways = instead(&apart, &WAYS, UNIT, 0.0).unwrap();
        let left_um = [&WAYS[..], &ways].map(|ways| apart.rms_um(&apart.fit(ways)));
        assert!(left_um[0] > 0.2, "{left_um:?}");
        assert!(left_um[1] < 0.02, "{left_um:?}");
        let fitted = apart.fit(&ways);
        let Some((Way::Carried(carried), own)) = fitted.at(1) else {
            panic!("{ways:?}");
        };
        let LoadFriction {
            deflection,
            rise,
            velocity,
            ..
        } = carried.friction;
        assert!((deflection / 20.0e-6 - 1.0).abs() < 0.02, "{carried:?}");
        assert!((rise / 0.4 - 1.0).abs() < 0.15, "{carried:?}");
        assert!((velocity / 4.0e-3 - 1.0).abs() < 0.15, "{carried:?}");
        let [mass, coulomb] = [own[Carried::MASS], own[Carried::FRICTION]].map(|x| x * STIFFNESS);
        assert!((mass / 60.0 - 1.0).abs() < 0.01, "{mass}");
        assert!((coulomb / 25.0 - 1.0).abs() < 0.01, "{coulomb}");
    }

    #[test]
    fn what_comes_with_the_direction_and_is_in_no_effort_is_no_wind_up() {
        let loose = axis(|bend| 5.0e-6 * bend);
        assert_eq!(instead(&apart(&loose), &WAYS, UNIT, 0.0), None);
    }

    #[test]
    fn without_wind_up_there_is_nothing_to_carry() {
        let axis = axis(|_| 0.0);
        assert_eq!(instead(&apart(&axis), &WAYS[..1], UNIT, 0.0), None);
    }
}
