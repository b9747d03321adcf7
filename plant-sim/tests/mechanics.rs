//! The mechanics against something independent: closed forms, and a high-accuracy integration of
//! the same equations.

use std::f64::consts::TAU;

use ode_solvers::dop_shared::OutputType;
use ode_solvers::dop853::Dop853;
use ode_solvers::{SVector, System};
use plant_sim::axis::SUB_STEP_S;
use plant_sim::friction::{Body, Friction, Law, Sides, Sliding};
use plant_sim::mechanics::{Drive, Mechanics, Motion};
use plant_sim::{Axis, AxisParameters, Machine, MotorSide};

fn mechanics() -> Mechanics {
    Machine::reference().axes[0].actual.mechanics
}

fn table(sliding: Sliding, law: Law) -> Sides {
    Friction::new(sliding, law).into()
}

fn push(
    m: &Mechanics,
    friction: &mut Sides,
    motion: &mut Motion,
    force: impl Fn(f64) -> f64,
    seconds: f64,
    dt_s: f64,
) {
    let steps = (seconds / dt_s).round() as usize;
    for step in 0..steps {
        let drive = Drive {
            motor_n: force((step as f64 + 0.5) * dt_s),
            table_n: 0.0,
            friction_factor: 1.0,
            friction_level_n: 0.0,
            added_mass_kg: 0.0,
            brake_n: 0.0,
        };
        m.advance(motion, friction, drive, dt_s);
    }
}

#[test]
fn a_free_mass_accelerates_as_newton_says() {
    let (m, mut motion) = (mechanics(), Motion::default());
    let mut friction = table(Sliding::dry(0.0), Law::Coulomb);
    push(&m, &mut friction, &mut motion, |_| 500.0, 0.2, SUB_STEP_S);
    let mass = m.motor_inertia_kg + m.table_mass_kg;
    let center = (m.motor_inertia_kg * motion.motor_m + m.table_mass_kg * motion.table_m) / mass;
    let wanted = 0.5 * 500.0 / mass * 0.2 * 0.2;
    assert!((center / wanted - 1.0).abs() < 1.0e-9, "{center} {wanted}");
}

#[test]
fn the_two_masses_ring_at_their_resonance() {
    let m = Mechanics {
        screw_damping_n_s_per_m: 0.0,
        ..mechanics()
    };
    let mut motion = Motion {
        motor_m: 1.0e-5,
        ..Motion::default()
    };
    let mut friction = table(Sliding::dry(0.0), Law::Coulomb);
    let (m1, m2) = (m.motor_inertia_kg, m.table_mass_kg);
    let hz = (m.screw_stiffness_n_per_m * (m1 + m2) / (m1 * m2)).sqrt() / TAU;
    let dt = SUB_STEP_S / 4.0;
    let (mut crossings, mut before) = (Vec::new(), 1.0e-5);
    for step in 0..40_000 {
        push(&m, &mut friction, &mut motion, |_| 0.0, dt, dt);
        let wind_up = motion.motor_m - motion.table_m;
        if before > 0.0 && wind_up <= 0.0 {
            crossings.push((f64::from(step) + before / (before - wind_up)) * dt);
        }
        before = wind_up;
    }
    let measured = (crossings.len() - 1) as f64 / (crossings[crossings.len() - 1] - crossings[0]);
    assert!(
        (measured / hz - 1.0).abs() < 5.0e-4,
        "{measured} Hz, {hz} Hz"
    );
}

#[test]
fn a_dry_table_sticks_until_the_screw_pulls_harder_than_breakaway() {
    let m = mechanics();
    let sliding = Sliding {
        static_n: 520.0,
        ..Sliding::dry(400.0)
    };
    let (mut friction, mut motion) = (table(sliding, Law::Coulomb), Motion::default());
    // A slow ramp of the motor force; the table is exactly still before breakaway.
    let mut at_n = 0.0;
    while motion.table_m_per_s == 0.0 && at_n < 1000.0 {
        push(
            &m,
            &mut friction,
            &mut motion,
            |_| at_n,
            SUB_STEP_S,
            SUB_STEP_S,
        );
        at_n += 200.0 * SUB_STEP_S;
        assert!(motion.table_m_per_s != 0.0 || motion.table_m == 0.0);
    }
    assert!((at_n / 520.0 - 1.0).abs() < 0.01, "broke away at {at_n} N");
}

#[test]
fn sliding_comes_to_rest_within_the_way_that_friction_allows_and_stays() {
    let m = mechanics();
    let mut friction = table(Sliding::dry(400.0), Law::Coulomb);
    let v = 0.1;
    let mut motion = Motion {
        motor_m_per_s: v,
        table_m_per_s: v,
        ..Motion::default()
    };
    push(&m, &mut friction, &mut motion, |_| 0.0, 2.0, SUB_STEP_S);
    let mass = m.motor_inertia_kg + m.table_mass_kg;
    let way = 0.5 * mass * v * v / 400.0;
    assert!(
        (motion.table_m / way - 1.0).abs() < 0.01,
        "{} of {way}",
        motion.table_m
    );
    let rest = motion.table_m;
    push(&m, &mut friction, &mut motion, |_| 0.0, 0.5, SUB_STEP_S);
    assert_eq!(motion.table_m, rest, "it does not creep");
}

#[test]
fn a_motor_that_rubs_slides_as_if_its_friction_were_the_tables_but_winds_nothing_up() {
    let m = mechanics();
    let wind_up = |at_table_n: f64, at_motor_n: f64| {
        let mut friction = Sides {
            table: Friction::new(Sliding::dry(at_table_n), Law::Coulomb),
            motor: Some(Friction::new(Sliding::dry(at_motor_n), Law::Coulomb)),
        };
        let mut motion = Motion::default();
        push(&m, &mut friction, &mut motion, |_| 1000.0, 0.5, SUB_STEP_S);
        let mass = m.motor_inertia_kg + m.table_mass_kg;
        let wanted = (1000.0 - at_table_n - at_motor_n) / mass * 0.5;
        assert!((motion.table_m_per_s / wanted - 1.0).abs() < 0.01);
        let transmitted_n = at_table_n + m.table_mass_kg * wanted / 0.5;
        let wound_m = motion.motor_m - motion.table_m;
        assert!((wound_m / (transmitted_n / m.screw_stiffness_n_per_m) - 1.0).abs() < 0.02);
    };
    wind_up(400.0, 0.0);
    wind_up(250.0, 150.0);
    wind_up(0.0, 400.0);
}

#[test]
fn a_motor_that_rubs_holds_itself_up_to_its_breakaway() {
    let m = mechanics();
    let sliding = Sliding {
        static_n: 300.0,
        ..Sliding::dry(200.0)
    };
    let moved_m = |force_n: f64| {
        let mut friction = Sides {
            table: Friction::new(Sliding::dry(0.0), Law::Coulomb),
            motor: Some(Friction::new(sliding, Law::Coulomb)),
        };
        let mut motion = Motion::default();
        push(&m, &mut friction, &mut motion, |_| force_n, 0.5, SUB_STEP_S);
        motion.motor_m
    };
    assert_eq!(moved_m(299.0), 0.0);
    assert!(moved_m(301.0) > 1.0e-3);
}

#[test]
fn the_motor_crosses_the_gap_in_the_time_of_its_free_flight() {
    let m = Mechanics {
        backlash_m: 1.0e-4,
        ..mechanics()
    };
    let mut friction = table(Sliding::dry(400.0), Law::Coulomb);
    // At the back end of the gap.
    let mut motion = Motion {
        motor_m: -0.5e-4,
        ..Motion::default()
    };
    let mut seconds = 0.0;
    while motion.table_m_per_s == 0.0 && seconds < 1.0 {
        push(
            &m,
            &mut friction,
            &mut motion,
            |_| 300.0,
            SUB_STEP_S,
            SUB_STEP_S,
        );
        seconds += SUB_STEP_S;
    }
    // Free flight over the gap, then the few µm until the screw pulls 400 N.
    let flight = (2.0 * 1.0e-4 * m.motor_inertia_kg / 300.0).sqrt();
    let speed = 300.0 / m.motor_inertia_kg * flight;
    let contact = 400.0 / m.screw_stiffness_n_per_m / speed;
    assert!(
        (seconds - flight - contact).abs() < 2.0e-4,
        "{seconds} s, {flight} + {contact} s"
    );
}

#[test]
fn maxwell_slip_remembers_its_reversal_points() {
    let stiffness = [2.0e7, 1.0e7, 5.0e6];
    let law = Law::MaxwellSlip {
        stiffness_n_per_m: stiffness.to_vec(),
        share: vec![0.4, 0.35, 0.25],
    };
    let mut friction = Friction::new(Sliding::dry(400.0), law);
    // A very heavy table goes where it is told.
    let go = |friction: &mut Friction, velocity: f64, way: f64| {
        let dt_s = 1.0e-5;
        for _ in 0..(way / velocity.abs() / dt_s).round() as usize {
            friction.advance(Body {
                velocity,
                free_velocity: velocity,
                mass_kg: 1.0e12,
                dt_s,
                factor: 1.0,
                level_n: 0.0,
            });
        }
        friction
            .state()
            .deflection_m()
            .iter()
            .zip(stiffness)
            .map(|(z, k)| z * k)
            .sum::<f64>()
    };
    let slipping = go(&mut friction, 1.0e-3, 1.0e-4);
    assert!((slipping - 400.0).abs() < 1.0);
    let turned = go(&mut friction, -1.0e-3, 6.0e-6);
    // A small loop and back to the turning point: the old branch goes on as if nothing had been.
    go(&mut friction, 1.0e-3, 3.0e-6);
    let back = go(&mut friction, -1.0e-3, 3.0e-6);
    assert!((back - turned).abs() < 0.5, "{turned} N, {back} N");
}

#[test]
fn steady_sliding_with_bristles_costs_exactly_the_sliding_level() {
    for n in [16.0, 32.0, 64.0] {
        let law = Machine::reference().axes[0].actual.law.clone();
        let mut friction = Friction::new(Sliding::dry(400.0), law);
        let dt_s = 1.0e-3 / n;
        let mut next = 0.1;
        // Held at 0.1 m/s: what friction takes off in a sub-step is its force.
        for _ in 0..2000 {
            next = friction.advance(Body {
                velocity: 0.1,
                free_velocity: 0.1,
                mass_kg: 1.0e9,
                dt_s,
                factor: 1.0,
                level_n: 0.0,
            });
        }
        let force = (0.1 - next) / dt_s * 1.0e9;
        assert!((force - 400.0).abs() < 0.01, "1/{n} ms: {force} N");
    }
}

type Vector = SVector<f64, 6>;

/// A LuGre bristle, as an equation.
#[derive(Clone, Copy)]
struct Bristle {
    sliding: Sliding,
    stiffness: f64,
    damping: f64,
}

impl Bristle {
    fn of(sliding: Sliding, law: &Law) -> Self {
        let &Law::LuGre {
            bristle_stiffness_n_per_m,
            bristle_damping_n_s_per_m,
        } = law
        else {
            panic!("LuGre expected")
        };
        Self {
            sliding,
            stiffness: bristle_stiffness_n_per_m,
            damping: bristle_damping_n_s_per_m,
        }
    }

    /// Friction and rate of the deflection.
    fn at(&self, v: f64, z: f64) -> [f64; 2] {
        let own = &self.sliding;
        let fall = (-(v / own.stribeck_velocity_m_per_s).powi(2)).exp();
        let level = own.coulomb_n + (own.static_n - own.coulomb_n) * fall;
        let dz = v - self.stiffness * v.abs() / level * z;
        let friction = self.stiffness * z + self.damping * dz + own.viscous_n_s_per_m * v;
        [friction, dz]
    }
}

/// LuGre axis without a gap, as equations; written for the comparison and for nothing else.
struct Equations {
    mechanics: Mechanics,
    table: Bristle,
    motor: Option<Bristle>,
}

fn force(t: f64) -> f64 {
    700.0 * (TAU * 3.0 * t).sin() + 150.0 * (TAU * 11.0 * t).cos()
}

impl System<f64, Vector> for Equations {
    fn system(&self, t: f64, y: &Vector, dy: &mut Vector) {
        let [x1, v1, x2, v2, z, z1] = [y[0], y[1], y[2], y[3], y[4], y[5]];
        let m = &self.mechanics;
        let screw = m.screw_stiffness_n_per_m * (x1 - x2) + m.screw_damping_n_s_per_m * (v1 - v2);
        let [friction, dz] = self.table.at(v2, z);
        let [rubs, dz1] = self.motor.map_or([0.0; 2], |motor| motor.at(v1, z1));
        dy[0] = v1;
        dy[1] = (force(t) - screw - rubs) / m.motor_inertia_kg;
        dy[2] = v2;
        dy[3] = (screw - friction) / m.table_mass_kg;
        dy[4] = dz;
        dy[5] = dz1;
    }
}

/// A motor's side that rubs otherwise than the table.
fn rubbing() -> MotorSide {
    MotorSide {
        sliding: Sliding {
            static_n: 190.0,
            stribeck_velocity_m_per_s: 4.0e-3,
            viscous_n_s_per_m: 900.0,
            ..Sliding::dry(150.0)
        },
        law: Law::LuGre {
            bristle_stiffness_n_per_m: 2.0e7,
            bristle_damping_n_s_per_m: 9.0e3,
        },
    }
}

/// Table position after 0.4 s under [`force`], by our scheme.
fn ours(motor_side: Option<&MotorSide>, dt_s: f64) -> f64 {
    let machine = Machine::reference();
    let actual = &machine.axes[0].actual;
    let mut friction = Sides {
        table: Friction::new(actual.sliding, actual.law.clone()),
        motor: motor_side.map(|own| Friction::new(own.sliding, own.law.clone())),
    };
    let mut motion = Motion::default();
    push(
        &actual.mechanics,
        &mut friction,
        &mut motion,
        force,
        0.4,
        dt_s,
    );
    motion.table_m
}

#[test]
fn the_scheme_converges_to_a_high_accuracy_integration() {
    converges(None);
}

#[test]
fn so_it_does_where_the_motor_rubs_as_well() {
    let rubbing = rubbing();
    converges(Some(&rubbing));
    let way = |motor_side| ours(motor_side, SUB_STEP_S);
    assert!((way(Some(&rubbing)) - way(None)).abs() > 1.0e-4);
}

fn converges(motor_side: Option<&MotorSide>) {
    let machine = Machine::reference();
    let actual = &machine.axes[0].actual;
    let equations = Equations {
        mechanics: actual.mechanics,
        table: Bristle::of(actual.sliding, &actual.law),
        motor: motor_side.map(|own| Bristle::of(own.sliding, &own.law)),
    };
    // The kinks at reversals cost many small steps; only the end is kept.
    let mut solver = Dop853::from_param(
        equations,
        0.0,
        0.4,
        0.4,
        Vector::zeros(),
        1.0e-10,
        1.0e-14,
        0.9,
        0.0,
        0.333,
        6.0,
        1.0e-4,
        0.0,
        20_000_000,
        u32::MAX,
        OutputType::Sparse,
    );
    solver.integrate().unwrap();
    let exact = solver.y_out().last().unwrap()[2];
    let errors =
        [4.0, 8.0, 16.0, 32.0, 64.0].map(|n| 1.0e9 * (ours(motor_side, 1.0e-3 / n) - exact).abs());
    println!(
        "table after 0.4 s: {:.6} mm; error at 1/4, 1/8, 1/16, 1/32, 1/64 ms: {errors:.3?} nm",
        1.0e3 * exact
    );
    // At the sub-step that is used: a ten-thousandth of the way; and it goes on converging, at
    // least at first order.
    assert!(errors[2] < 1.0e5 * exact.abs(), "{errors:?} nm");
    let order = (errors[2] / errors[4]).log2() / 2.0;
    assert!((0.8..2.6).contains(&order), "order {order}, {errors:?} nm");
}

#[test]
fn the_sub_step_is_where_halving_it_no_longer_matters() {
    // A free axis under a force that reverses it, without a loop that would correct anything.
    let run = |sub_step_s: f64| {
        let parameters = AxisParameters {
            force_noise_n: 0.0,
            ..Machine::reference().axes[0].actual.clone()
        };
        let mut axis = Axis::new(parameters, 1).with_sub_step(sub_step_s);
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for cycle in 0..1000 {
            axis.advance(900.0 * (TAU * 2.0e-3 * f64::from(cycle)).sin(), 1.0e-3);
            (low, high) = (
                low.min(axis.motion().table_m),
                high.max(axis.motion().table_m),
            );
        }
        (axis.motion().table_m, high - low)
    };
    let (finest, travel) = run(1.0e-3 / 256.0);
    let error = |n: f64| (run(1.0e-3 / n).0 - finest).abs() / travel;
    let (coarse, used, fine) = (error(4.0), error(1.0e-3 / SUB_STEP_S), error(64.0));
    println!(
        "difference to 1/256 ms after 1 s and a travel of {:.3} mm: {coarse:.1e} of it at 1/4 ms, {used:.1e} at the sub-step, {fine:.1e} at 1/64 ms",
        1.0e3 * travel
    );
    assert!(
        used < 1.0e-4 && used < coarse && fine < used,
        "{coarse:e} {used:e} {fine:e}"
    );
}

#[test]
fn a_current_loop_without_lag_delivers_the_whole_impulse() {
    let mut parameters = AxisParameters {
        force_noise_n: 0.0,
        ..Machine::reference().axes[0].actual.clone()
    };
    parameters.sliding = Sliding::dry(0.0);
    parameters.law = Law::Coulomb;
    parameters.current_loop_time_constant_s = 0.0;
    let mut axis = Axis::new(parameters.clone(), 1);
    axis.advance(1000.0, 1.0e-3);
    let (m, motion) = (parameters.mechanics, axis.motion());
    let momentum =
        m.motor_inertia_kg * motion.motor_m_per_s + m.table_mass_kg * motion.table_m_per_s;
    assert!((momentum - 1.0).abs() < 1.0e-9, "{momentum} N s");
}
