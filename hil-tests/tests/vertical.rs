//! A vertical axis (2500 N that nothing balances) at standstill: how far the table moves when
//! torque comes and goes.
//!
//! Where the measurement can be trusted, torque holds until the brake bites, and the preset carries
//! the axis when the brake opens: at most 10 µm, also with a preset that is 10 % wrong. Where
//! torque is lost or the measurement cannot be trusted, the axis drops until the brake bites. The
//! reference for that is the same plant, let alone with torque zero and brake commanded at that
//! instant; the drive may be 10 % worse.

use bus::FaultPlan;
use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::{PLANT, SERVO, set, vertical_axes};
use plant_sim::axis::Axis;
use plant_sim::{Machine, PlantNode};
use protocol::cob::FrameKind;
use protocol::message::NmtCommand;
use protocol::states::{BrakeState, ControlWord, DriveState};
use protocol::{Fault, Message};
use servo::objects::Parameter;
use workbench::compensation::AxisCompensation;
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::network::master::Master;

/// Largest way of the table where torque holds it, µm: issue 7.
const HELD_UM: f64 = 10.0;
/// The drive may drop farther than the plant by itself by this factor.
const WORSE: f64 = 1.10;
/// … and by one count of the scale: a brake of 0 ms holds the axis to nanometres, less than the
/// loop had it moving.
const RESOLUTION_UM: f64 = 0.010;
const GRAVITY_N: f64 = 2500.0;
const PERIOD_S: f64 = 1.0e-3;
/// Longer than any brake and its margin.
const WATCHED_CYCLES: u32 = 300;

/// Motor torque of a force at the table, µN·m.
fn torque(force_n: f64) -> i32 {
    (force_n * 0.010 / std::f64::consts::TAU * 1.0e6).round() as i32
}

/// What happens to the standing axis.
type Event = fn(&mut Master<InProcess>);

/// The axis hangs on its brake; its preset is off by a share.
fn hanging(machine: &Machine, preset: f64) -> Master<InProcess> {
    let mut master = Master::start(InProcess::new(machine, 0).unwrap(), machine).unwrap();
    master
        .configure(machine, &[AxisCompensation::default()])
        .unwrap();
    set(
        &mut master,
        0,
        &[(Parameter::PresetTorque, torque(preset * GRAVITY_N))],
    )
    .unwrap();
    master
}

/// It stands with torque, the brake open.
fn standing(machine: &Machine) -> Master<InProcess> {
    let mut master = hanging(machine, 1.0);
    master.enable().unwrap();
    (0..500).for_each(|_| master.cycle(&[0.0]).unwrap());
    master
}

fn table_m(plant: &PlantNode) -> f64 {
    plant.truth().table_m
}

/// Farthest way of the table, µm, from now on.
fn way_um(master: &mut Master<InProcess>) -> f64 {
    let plant = master.link_mut().plant(0);
    let from_m = table_m(&plant.borrow());
    (0..WATCHED_CYCLES).fold(0.0_f64, |way, _| {
        master.cycle(&[0.0]).unwrap();
        way.max(1.0e6 * (table_m(&plant.borrow()) - from_m).abs())
    })
}

fn enable(name: &str, machine: &Machine, preset: f64) -> Measured {
    let mut master = hanging(machine, preset);
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let start = Message::Nmt(NmtCommand::StartRemoteNode, None);
    master
        .link_mut()
        .send(0, start.encode(servo.borrow().ids()))
        .unwrap();
    for control in [ControlWord::SHUTDOWN, ControlWord::SWITCH_ON] {
        master.command(control);
        (0..3).for_each(|_| master.cycle(&[0.0]).unwrap());
    }
    // The brake opens while it is watched.
    master.command(ControlWord::ENABLE_OPERATION);
    assert_ne!(plant.borrow().truth().brake, BrakeState::Open, "{name}");
    let way = way_um(&mut master);
    assert_eq!(
        servo.borrow().drive().state(),
        DriveState::OperationEnabled,
        "{name}"
    );
    assert!(way <= HELD_UM, "{name}: {way} µm");
    row(name, way, "um")
}

fn held(name: &str, machine: &Machine, event: Event, end: DriveState) -> Measured {
    let mut master = standing(machine);
    event(&mut master);
    let way = way_um(&mut master);
    assert!(way <= HELD_UM, "{name}: {way} µm");
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    assert_eq!(servo.borrow().drive().state(), end, "{name}");
    assert_eq!(plant.borrow().truth().brake, BrakeState::Closed, "{name}");
    row(name, way, "um")
}

/// The same plant with torque zero and brake commanded, let alone.
fn alone_um(mut axis: Axis) -> f64 {
    let from_m = axis.motion().table_m;
    axis.command_brake(false);
    (0..WATCHED_CYCLES).fold(0.0_f64, |way, _| {
        axis.advance(0.0, PERIOD_S);
        way.max(1.0e6 * (axis.motion().table_m - from_m).abs())
    })
}

/// Drop with the drive, and of the plant alone from the instant at which torque ends; the way until
/// then is the drive's.
fn dropped(name: &str, machine: &Machine, fault: Option<Fault>, event: Event) -> [Measured; 2] {
    let mut master = standing(machine);
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let from_m = table_m(&plant.borrow());
    event(&mut master);
    let mut alone = plant.borrow().axis().clone();
    let mut way = 0.0_f64;
    for _ in 0..WATCHED_CYCLES {
        if plant.borrow().truth().commanded_n != 0.0 {
            alone = plant.borrow().axis().clone();
        }
        master.cycle(&[0.0]).unwrap();
        way = way.max(1.0e6 * (table_m(&plant.borrow()) - from_m).abs());
    }
    let alone = alone_um(alone);
    assert!(
        way <= WORSE * alone + RESOLUTION_UM,
        "{name}: {way} µm, the plant alone {alone} µm"
    );
    assert_eq!(servo.borrow().drive().fault(), fault, "{name}");
    assert_eq!(plant.borrow().truth().brake, BrakeState::Closed, "{name}");
    [
        row(format!("{name}, drop"), way, "um"),
        row(format!("{name}, drop of the plant alone"), alone, "um"),
    ]
}

fn cut(master: &mut Master<InProcess>, kind: FrameKind, place: usize) {
    let plan = FaultPlan {
        cut: Some((kind, 0)),
        ..FaultPlan::default()
    };
    master.link_mut().bus_mut(0).inject(place, 1, plan);
}

#[test]
fn a_vertical_axis_moves_ten_micrometres_where_torque_holds_it_and_drops_as_the_plant_does_where_not()
 {
    let mut rows = Vec::new();
    for (brake, machine) in vertical_axes() {
        let named = |what: &str| format!("{brake}: {what}");
        for (what, preset) in [
            ("enable", 1.0),
            ("enable, preset 10 % low", 0.9),
            ("enable, preset 10 % high", 1.1),
        ] {
            rows.push(enable(&named(what), &machine, preset));
        }
        rows.push(held(
            &named("disable operation"),
            &machine,
            |m| m.command(ControlWord::SWITCH_ON),
            DriveState::SwitchedOn,
        ));
        rows.push(held(
            &named("quick stop"),
            &machine,
            |m| m.command(ControlWord::QUICK_STOP),
            DriveState::SwitchOnDisabled,
        ));
        rows.push(held(
            &named("fault with trusted feedback (setpoint gone)"),
            &machine,
            |m| cut(m, FrameKind::Setpoint, SERVO),
            DriveState::Fault,
        ));
        let events: [(&str, Option<Fault>, Event); 5] = [
            ("disable voltage", None, |m| {
                m.command(ControlWord::DISABLE_VOLTAGE);
            }),
            ("feedback gone", Some(Fault::FeedbackMissing), |m| {
                cut(m, FrameKind::Feedback, SERVO);
            }),
            ("power stage drops out", Some(Fault::StageLost), |m| {
                m.link_mut().plant(0).borrow_mut().drop_out();
            }),
            ("torque frames gone", Some(Fault::PeerFault), |m| {
                cut(m, FrameKind::Torque, PLANT);
            }),
            ("servo dead", None, |m| m.link_mut().bus_mut(0).kill(SERVO)),
        ];
        for (what, fault, event) in events {
            rows.extend(dropped(&named(what), &machine, fault, event));
        }
    }
    golden::check("vertical", &rows);
}
