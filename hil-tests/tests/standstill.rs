//! Ways to standstill of the table from 0.4 m/s, whatever ends the motion.
//!
//! The axis is the reference machine's X: 5 m/s² at most, ramps with a jerk of 1000 m/s³. A ramp of
//! `u² / 2 D + u D / 2 J` takes 17 mm; what an event adds is the time until the ramp begins. The
//! way counts from the cycle in which the event happens, by the plant's true table.
//!
//! Rows with a brake: 4 kN on the motor, it bites 40 ms after it is told. There torque ends at
//! once, so the way is that of the brake.

use bus::FaultPlan;
use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::{PLANT, SERVO, enabled, one_axis, set};
use plant_sim::Machine;
use plant_sim::brake::BrakeParameters;
use protocol::cob::FrameKind;
use protocol::message::NmtCommand;
use protocol::states::{BrakeState, ControlWord};
use protocol::{AxisIds, Fault, Message};
use servo::objects::Parameter;
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::network::master::Master;

/// Largest way that a controlled stop may take, mm: issue 7.
const CONTROLLED_MM: f64 = 20.0;
/// The ramp's own way, mm: no stop of this axis is shorter than 0.4² / (2 · 5) m.
const RAMP_MM: f64 = 16.0;
/// Periods from the last good frame to torque zero and brake.
const PERIODS_TO_ZERO: u32 = 5;
/// Cycles of the path before the event: 160 ms to come to 0.4 m/s, 60 ms at it.
const EVENT_CYCLE: u32 = 220;
const SPEED_M_PER_S: f64 = 0.4;
const PERIOD_US: u64 = 1000;
/// A ramp takes 85 ms, a brake 80 ms, coasting 0.6 s.
const WATCHED_CYCLES: u32 = 1500;

/// Position after so many cycles: up to 0.4 m/s with a smoothstep of the velocity (4.7 m/s² at
/// most), then at it.
fn path(cycle: u32) -> f64 {
    let (time_s, rise_s) = (f64::from(cycle) * 1.0e-3, 0.160);
    let u = (time_s / rise_s).min(1.0);
    let risen = u.powi(4) * (2.5 - 3.0 * u + u * u);
    SPEED_M_PER_S * (rise_s * risen + (time_s - rise_s).max(0.0))
}

/// The axis at 0.4 m/s.
fn moving(machine: &Machine, values: &[(Parameter, i32)]) -> Master<InProcess> {
    let mut master = enabled(machine).unwrap();
    set(
        &mut master,
        0,
        &[&[(Parameter::RampJerk, 1_000_000)], values].concat(),
    )
    .unwrap();
    (1..EVENT_CYCLE).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    let velocity = master.axis(0).truth.unwrap().table_m_per_s;
    assert!(
        (velocity / SPEED_M_PER_S - 1.0).abs() < 1.0e-3,
        "{velocity}"
    );
    master
}

fn braked(machine: Machine) -> Machine {
    let mut machine = machine;
    let brake = BrakeParameters {
        rated_force_n: 4000.0,
        open_s: 0.030,
        close_s: 0.040,
        rise_s: 0.0,
    };
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.actual.mounting.brake = Some(brake));
    machine
}

/// What the plant does after the event.
struct Stop {
    way_mm: f64,
    /// Cycles until no torque is commanded and the brake is told to close.
    to_zero: Option<u32>,
    fault: Option<Fault>,
}

/// Lets the machine come to rest; `cycle` makes one cycle of the bus pass.
fn stop(
    master: &mut Master<InProcess>,
    mut cycle: impl FnMut(&mut Master<InProcess>, u32),
) -> Stop {
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let from_m = plant.borrow().truth().table_m;
    let (mut way_mm, mut to_zero) = (0.0_f64, None);
    for index in 0..WATCHED_CYCLES {
        cycle(master, EVENT_CYCLE + index);
        let truth = plant.borrow().truth();
        way_mm = way_mm.max(1.0e3 * (truth.table_m - from_m));
        if to_zero.is_none() && truth.commanded_n == 0.0 && truth.brake != BrakeState::Open {
            to_zero = Some(index + 1);
        }
    }
    let truth = plant.borrow().truth();
    // A plant that is not operational and slower than this for 20 ms counts as standing.
    assert!(
        truth.table_m_per_s.abs() < 1.0e-3,
        "still {} m/s",
        truth.table_m_per_s
    );
    let fault = servo.borrow().drive().fault();
    Stop {
        way_mm,
        to_zero,
        fault,
    }
}

fn on_the_path(master: &mut Master<InProcess>, cycle: u32) {
    // The master goes on as if nothing had happened, as long as the travel lasts.
    master.cycle(&[path(cycle.min(EVENT_CYCLE + 300))]).unwrap();
}

fn nmt(master: &mut Master<InProcess>, command: NmtCommand) {
    let ids = AxisIds::of_axis(0).unwrap();
    master
        .link_mut()
        .send(0, Message::Nmt(command, None).encode(ids))
        .unwrap();
}

fn cut(master: &mut Master<InProcess>, kind: FrameKind, place: usize) {
    let plan = FaultPlan {
        cut: Some((kind, 0)),
        ..FaultPlan::default()
    };
    master.link_mut().bus_mut(0).inject(place, 1, plan);
}

/// What happens at 0.4 m/s.
type Event = fn(&mut Master<InProcess>);

fn controlled(
    name: &str,
    values: &[(Parameter, i32)],
    fault: Option<Fault>,
    event: Event,
) -> Measured {
    let mut master = moving(&one_axis(), values);
    event(&mut master);
    let stop = stop(&mut master, on_the_path);
    assert_eq!(stop.fault, fault, "{name}");
    assert!(
        (RAMP_MM..CONTROLLED_MM).contains(&stop.way_mm),
        "{name}: {} mm",
        stop.way_mm
    );
    row(name, stop.way_mm, "mm")
}

fn master_silent() -> Measured {
    let mut master = moving(&one_axis(), &[]);
    let stop = stop(&mut master, |master, _| {
        let _ = master.link_mut().bus_mut(0).receive(PERIOD_US);
    });
    assert_eq!(
        stop.fault,
        Some(Fault::SetpointMissing),
        "three setpoints may be missing, SYNC for five periods"
    );
    assert!(
        (RAMP_MM..CONTROLLED_MM).contains(&stop.way_mm),
        "master silent: {} mm",
        stop.way_mm
    );
    row("master silent", stop.way_mm, "mm")
}

#[test]
fn a_controlled_stop_takes_twenty_millimetres_and_where_torque_ends_the_brake_is_told_within_five_periods()
 {
    golden::check(
        "standstill",
        &[controlled_stops(), stops_without_torque()].concat(),
    );
}

/// At most 20 mm each.
fn controlled_stops() -> Vec<Measured> {
    let mut rows = vec![
        controlled("quick stop", &[], None, |master| {
            master.command(ControlWord::QUICK_STOP);
        }),
        controlled("disable operation", &[], None, |master| {
            master.command(ControlWord::SWITCH_ON);
        }),
        controlled(
            "shutdown, 605Bh = 1",
            &[(Parameter::ShutdownOption, 1)],
            None,
            |master| {
                master.command(ControlWord::SHUTDOWN);
            },
        ),
        controlled("halt", &[], None, |master| {
            master.command(ControlWord::ENABLE_OPERATION.with(ControlWord::HALT));
        }),
        controlled("NMT stop", &[], None, |master| {
            nmt(master, NmtCommand::StopRemoteNode);
        }),
        controlled("NMT pre-operational", &[], None, |master| {
            nmt(master, NmtCommand::EnterPreOperational);
        }),
        controlled("NMT reset", &[], None, |master| {
            nmt(master, NmtCommand::ResetNode);
        }),
        controlled(
            "setpoint gone",
            &[],
            Some(Fault::SetpointMissing),
            |master| {
                cut(master, FrameKind::Setpoint, SERVO);
            },
        ),
        controlled(
            "following error beyond a window made narrow",
            &[],
            Some(Fault::FollowingError),
            |master| {
                set(master, 0, &[(Parameter::FollowingErrorWindow, 1)]).unwrap();
            },
        ),
    ];
    rows.push(controlled(
        "SYNC gone",
        &[],
        Some(Fault::SyncMissing),
        |master| {
            for place in [PLANT, SERVO] {
                cut(master, FrameKind::Sync, place);
            }
        },
    ));
    rows.push(master_silent());
    rows.push(following_error());
    rows
}

/// The axis cannot follow: the torque limit is that of 2.9 m/s² in an acceleration of 5 m/s². The
/// ramp begins with what it does.
fn following_error() -> Measured {
    const NAME: &str = "following error, torque limit too low for the path";
    // From 0.28 m/s the axis is at 0.4 m/s when the reference is 2 mm ahead.
    let (start, from_m_per_s) = (140_u32, 0.277_f64);
    let path = |cycle: u32| {
        let t = f64::from(cycle) * 1.0e-3;
        let (rise_s, begin_s) = (0.120, f64::from(start) * 1.0e-3);
        let u = (t / rise_s).min(1.0);
        let slow =
            from_m_per_s * (rise_s * u.powi(4) * (2.5 - 3.0 * u + u * u) + (t - rise_s).max(0.0));
        let faster = (t - begin_s).clamp(0.0, 0.040);
        slow + 2.5 * faster * faster + 0.2 * (t - begin_s - 0.040).max(0.0)
    };
    let mut master = enabled(&one_axis()).unwrap();
    let limit = 3900.0 * 0.010 / std::f64::consts::TAU * 1.0e6;
    set(
        &mut master,
        0,
        &[
            (Parameter::RampJerk, 1_000_000),
            (Parameter::TorqueLimit, limit as i32),
        ],
    )
    .unwrap();
    let servo = master.link_mut().servo(0);
    let mut cycle = 1;
    while servo.borrow().drive().fault().is_none() && cycle < 400 {
        master.cycle(&[path(cycle)]).unwrap();
        cycle += 1;
    }
    let truth = master.axis(0).truth.unwrap();
    assert_eq!(servo.borrow().drive().fault(), Some(Fault::FollowingError));
    assert!(
        (0.40..0.41).contains(&truth.table_m_per_s),
        "{} m/s at the fault, cycle {cycle}",
        truth.table_m_per_s
    );
    let stop = stop(&mut master, |master, _| master.cycle(&[0.1]).unwrap());
    assert!(
        (RAMP_MM..CONTROLLED_MM).contains(&stop.way_mm),
        "{NAME}: {} mm",
        stop.way_mm
    );
    row(NAME, stop.way_mm, "mm")
}

fn without_torque(name: &str, machine: &Machine, fault: Option<Fault>, event: Event) -> Stop {
    let mut master = moving(machine, &[]);
    event(&mut master);
    let stop = stop(&mut master, on_the_path);
    assert_eq!(stop.fault, fault, "{name}");
    let to_zero = stop.to_zero.unwrap_or(u32::MAX);
    assert!(
        to_zero <= PERIODS_TO_ZERO,
        "{name}: torque zero and brake after {to_zero} periods"
    );
    stop
}

/// Torque ends at once: the way is that of the brake, or of friction alone.
fn stops_without_torque() -> Vec<Measured> {
    let events: [(&str, Option<Fault>, Event); 9] = [
        ("disable voltage", None, |master| {
            master.command(ControlWord::DISABLE_VOLTAGE);
        }),
        ("shutdown with the default", None, |master| {
            master.command(ControlWord::SHUTDOWN);
        }),
        ("servo dead", None, |master| {
            master.link_mut().bus_mut(0).kill(SERVO);
        }),
        (
            "servo off the bus",
            Some(Fault::FeedbackMissing),
            |master| {
                master.link_mut().bus_mut(0).connect(SERVO, false);
            },
        ),
        (
            "plant off the bus",
            Some(Fault::FeedbackMissing),
            |master| {
                master.link_mut().bus_mut(0).connect(PLANT, false);
            },
        ),
        ("feedback gone", Some(Fault::FeedbackMissing), |master| {
            cut(master, FrameKind::Feedback, SERVO);
        }),
        (
            "encoders jump by 1 mm",
            Some(Fault::EncoderJump),
            |master| {
                let plant = master.link_mut().plant(0);
                let mut motion = *plant.borrow().axis().motion();
                (motion.motor_m, motion.table_m) =
                    (motion.motor_m + 1.0e-3, motion.table_m + 1.0e-3);
                plant.borrow_mut().place(motion);
            },
        ),
        ("torque frames gone", Some(Fault::PeerFault), |master| {
            cut(master, FrameKind::Torque, PLANT);
        }),
        ("power stage drops out", Some(Fault::StageLost), |master| {
            master.link_mut().plant(0).borrow_mut().drop_out();
        }),
    ];
    let (free, braked) = (one_axis(), braked(one_axis()));
    let mut rows = Vec::new();
    for (name, fault, event) in events {
        let [coasting, braked] =
            [&free, &braked].map(|machine| without_torque(name, machine, fault, event));
        rows.push(row(format!("{name}, brake of 40 ms"), braked.way_mm, "mm"));
        rows.push(row(format!("{name}, no brake"), coasting.way_mm, "mm"));
        rows.push(row(
            format!("{name}, torque zero and brake after"),
            f64::from(braked.to_zero.unwrap()),
            "periods",
        ));
    }
    rows
}
