//! What holds an axis and what pulls at it: brake, gravity and end stops, against closed forms.

use plant_sim::axis::{Axis, AxisParameters, Mounting};
use plant_sim::brake::BrakeParameters;
use plant_sim::friction::Law;
use plant_sim::machine::Machine;
use plant_sim::mechanics::Motion;
use plant_sim::stops::Stops;
use protocol::states::BrakeState;

const CYCLE_S: f64 = 1.0e-3;
const BRAKE: BrakeParameters = BrakeParameters {
    rated_force_n: 4000.0,
    open_s: 0.030,
    close_s: 0.040,
    rise_s: 0.0,
};

/// The reference axis without noise, mounted in some way; `friction` scales its friction.
fn axis(mounting: Mounting, friction: f64) -> Axis {
    let mut parameters = AxisParameters {
        force_noise_n: 0.0,
        mounting,
        ..Machine::reference().axes[0].actual.clone()
    };
    if friction == 0.0 {
        parameters.law = Law::Coulomb;
        (parameters.sliding.coulomb_n, parameters.sliding.static_n) = (0.0, 0.0);
        parameters.sliding.viscous_n_s_per_m = 0.0;
    }
    Axis::new(parameters, 1)
}

fn run(axis: &mut Axis, force_n: f64, cycles: u32) {
    (0..cycles).for_each(|_| axis.advance(force_n, CYCLE_S));
}

/// Kinetic energy of both masses and energy in the screw and in the stop, J.
fn energy(axis: &Axis) -> f64 {
    let (motion, m) = (axis.motion(), axis.parameters().mechanics);
    let kinetic = m.motor_inertia_kg * motion.motor_m_per_s.powi(2)
        + m.table_mass_kg * motion.table_m_per_s.powi(2);
    let stop = axis.parameters().mounting.stops.map_or(0.0, |stops| {
        let depth = (motion.table_m.abs() - stops.position_m).max(0.0);
        stops.stiffness_n_per_m * depth * depth
    });
    0.5 * (kinetic + m.screw_stiffness_n_per_m * m.deflection_m(motion).powi(2) + stop)
}

fn mass(axis: &Axis) -> f64 {
    let m = axis.parameters().mechanics;
    m.motor_inertia_kg + m.table_mass_kg
}

#[test]
fn without_a_brake_a_vertical_axis_falls_as_newton_says() {
    let mut axis = axis(
        Mounting {
            gravity_n: -2500.0,
            ..Mounting::default()
        },
        0.0,
    );
    run(&mut axis, 0.0, 40);
    let (motion, m) = (*axis.motion(), axis.parameters().mechanics);
    let center =
        (m.motor_inertia_kg * motion.motor_m + m.table_mass_kg * motion.table_m) / mass(&axis);
    let start = m.motor_inertia_kg * (2500.0 / m.screw_stiffness_n_per_m) / mass(&axis);
    let wanted = -0.5 * 2500.0 / mass(&axis) * 0.040_f64.powi(2);
    assert!(
        ((center - start) / wanted - 1.0).abs() < 1.0e-9,
        "{} m of {wanted}",
        center - start
    );
}

#[test]
fn a_closed_brake_holds_the_shaft_exactly_still_below_its_rated_force() {
    for force_n in [0.0, 6400.0, -1400.0] {
        let mounting = Mounting {
            gravity_n: -2500.0,
            brake: Some(BRAKE),
            ..Mounting::default()
        };
        let mut axis = axis(mounting, 1.0);
        let start = *axis.motion();
        for _ in 0..200 {
            axis.advance(force_n, CYCLE_S);
            assert_eq!(
                (axis.motion().motor_m, axis.motion().motor_m_per_s),
                (start.motor_m, 0.0),
                "{force_n} N"
            );
        }
        assert!(
            (axis.motion().table_m - start.table_m).abs() < 1.0e-9,
            "the table hangs where it hung"
        );
    }
}

#[test]
fn above_its_rated_force_the_brake_slips_with_that_force() {
    for force_n in [4300.0, -4300.0] {
        let mut axis = axis(
            Mounting {
                brake: Some(BRAKE),
                ..Mounting::default()
            },
            0.0,
        );
        // Past the 0.5 ms of the current loop and the first swing of the screw.
        run(&mut axis, force_n, 100);
        let before = axis.motion().motor_m_per_s;
        run(&mut axis, force_n, 200);
        let wanted = (force_n - 4000.0_f64.copysign(force_n)) / mass(&axis) * 0.2;
        let got = axis.motion().motor_m_per_s - before;
        assert!((got / wanted - 1.0).abs() < 0.02, "{got} m/s of {wanted}");
    }
}

#[test]
fn a_moving_axis_comes_to_rest_in_the_brakes_way_and_stays_there() {
    for (closes_ms, close_s) in [(0.0, 0.0), (10.0, 0.010), (40.0, 0.040)] {
        let brake = BrakeParameters {
            open_s: 0.0,
            close_s,
            ..BRAKE
        };
        let mut axis = axis(
            Mounting {
                brake: Some(brake),
                ..Mounting::default()
            },
            0.0,
        );
        axis.command_brake(true);
        axis.place(Motion {
            motor_m_per_s: 0.4,
            table_m_per_s: 0.4,
            ..Motion::default()
        });
        axis.command_brake(false);
        let mut most = energy(&axis);
        for _ in 0..300 {
            axis.advance(0.0, CYCLE_S);
            assert!(
                energy(&axis) <= most * (1.0 + 1.0e-9),
                "the brake made energy"
            );
            most = energy(&axis);
        }
        let wanted = 0.4 * close_s + 0.5 * mass(&axis) * 0.4 * 0.4 / 4000.0;
        let way = axis.motion().motor_m;
        assert!(
            (way / wanted - 1.0).abs() < 0.01,
            "brake of {closes_ms} ms: {way} m of {wanted}"
        );
        assert_eq!(axis.motion().motor_m_per_s, 0.0);
        run(&mut axis, 0.0, 500);
        assert_eq!(axis.motion().motor_m, way, "it does not creep");
    }
}

#[test]
fn a_vertical_axis_drops_until_its_brake_bites() {
    // Pulled by gravity less Coulomb friction, then stopped by brake and friction: ½·a·t²·(1 +
    // a/b). Viscous friction takes up to a tenth of it.
    let (a, b) = (
        (2500.0 - 400.0) / 931.65,
        (4000.0 + 400.0 - 2500.0) / 931.65,
    );
    for close_s in [0.0, 0.010, 0.040] {
        let brake = BrakeParameters {
            open_s: 0.0,
            close_s,
            ..BRAKE
        };
        let mut axis = axis(
            Mounting {
                gravity_n: -2500.0,
                brake: Some(brake),
                ..Mounting::default()
            },
            1.0,
        );
        axis.command_brake(true);
        run(&mut axis, 2500.0, 50);
        let held = axis.motion().table_m;
        axis.command_brake(false);
        let state = if close_s == 0.0 {
            BrakeState::Closed
        } else {
            BrakeState::Moving
        };
        assert_eq!(axis.brake(), state);
        run(&mut axis, 0.0, 200);
        assert_eq!(
            (axis.brake(), axis.motion().motor_m_per_s),
            (BrakeState::Closed, 0.0)
        );
        let (drop, wanted) = (
            held - axis.motion().table_m,
            0.5 * a * close_s * close_s * (1.0 + a / b),
        );
        assert!(
            (0.88 * wanted - 2.0e-7..wanted + 2.0e-7).contains(&drop),
            "{drop} m of {wanted}"
        );
    }
}

#[test]
fn an_end_stop_stops_an_axis_from_full_speed_and_gives_no_energy() {
    let stops = Stops {
        position_m: 0.02,
        stiffness_n_per_m: 1.0e7,
        damping_n_s_per_m: 1.0e5,
    };
    for direction in [1.0, -1.0] {
        let mut axis = axis(
            Mounting {
                stops: Some(stops),
                ..Mounting::default()
            },
            0.0,
        );
        let v = 0.4 * direction;
        axis.place(Motion {
            motor_m_per_s: v,
            table_m_per_s: v,
            ..Motion::default()
        });
        let (first, mut most, mut deepest) = (energy(&axis), energy(&axis), 0.0_f64);
        for _ in 0..200 {
            axis.advance(0.0, CYCLE_S);
            assert!(
                energy(&axis) <= most * (1.0 + 1.0e-3),
                "{} J after {most} J",
                energy(&axis)
            );
            most = most.min(energy(&axis));
            deepest = deepest.max(direction * axis.motion().table_m - stops.position_m);
        }
        assert!(
            (1.0e-3..4.0e-3).contains(&deepest),
            "{deepest} m into the stop"
        );
        assert!(
            direction * axis.motion().table_m_per_s < 0.0,
            "it comes back"
        );
        assert!(
            energy(&axis) < 0.5 * first,
            "{} J of {first} J",
            energy(&axis)
        );
    }
}

#[test]
fn encoders_read_from_their_own_zeros_and_go_on_past_32_bits() {
    let mounting = Mounting {
        start_m: 0.1,
        motor_zero_m: 0.1,
        ..Mounting::default()
    };
    let mut axis = axis(mounting, 1.0);
    assert_eq!(
        (axis.read().motor_increments, axis.read().load_10_nm),
        (0, 10_000_000),
        "scale at 100 mm, motor at 0"
    );
    axis.place(Motion {
        motor_m: 100.1,
        table_m: 100.1,
        ..Motion::default()
    });
    assert_eq!(
        axis.read().motor_increments,
        10_000 * 1_048_576,
        "ten thousand revolutions"
    );
}
