//! What is refused at enable, and what must not be: cycle times, the way to the setpoint, the
//! stage, the relation of the encoders, a long way.

use bus::FaultPlan;
use hil_tests::rig::{PLANT, SERVO, absolute_scale, enabled, long_way, one_axis, set};
use plant_sim::Machine;
use protocol::cob::FrameKind;
use protocol::message::Decoded;
use protocol::sdo::Expedited;
use protocol::states::{ControlWord, DriveState};
use protocol::{AxisIds, Fault, Message};
use servo::objects::{DECLARED_PERIOD, Parameter};
use workbench::compensation::AxisCompensation;
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::network::master::Master;

fn configured(machine: &Machine) -> Master<InProcess> {
    let mut link = InProcess::new(machine, 0).unwrap();
    link.start_log();
    let mut master = Master::start(link, machine).unwrap();
    master
        .configure(machine, &[AxisCompensation::default()])
        .unwrap();
    master
}

/// Faults in the EMCYs that the servo has sent, in their order.
fn emergencies(master: Master<InProcess>) -> Vec<Fault> {
    let ids = AxisIds::of_axis(0).unwrap();
    let log = master.into_link().take_logs().remove(0);
    let fault = |frame| match protocol::message::decode(ids, frame) {
        Ok(Decoded::Message(Message::ServoEmergency(emergency))) => {
            Fault::from_code(emergency.vendor_specific[0])
        }
        _ => None,
    };
    log.frames()
        .iter()
        .filter_map(|(_, frame)| fault(frame))
        .collect()
}

/// The master's own way up, with a setpoint that is not where its encoders are.
fn way_up(master: &mut Master<InProcess>, setpoint_m: f64) {
    let start = Message::Nmt(protocol::message::NmtCommand::StartRemoteNode, None);
    master
        .link_mut()
        .send(0, start.encode(AxisIds::of_axis(0).unwrap()))
        .unwrap();
    for control in [
        ControlWord::SHUTDOWN,
        ControlWord::SWITCH_ON,
        ControlWord::ENABLE_OPERATION,
    ] {
        master.command(control);
        (0..20).for_each(|_| master.cycle(&[setpoint_m]).unwrap());
    }
}

/// Enabling was refused once, with this EMCY, and there was never torque.
fn expect_refused(mut master: Master<InProcess>, fault: Fault) {
    assert!(master.enable().is_err());
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    assert_ne!(servo.borrow().drive().state(), DriveState::OperationEnabled);
    assert_eq!(
        servo.borrow().drive().fault(),
        None,
        "a refusal is said and not latched"
    );
    assert_eq!(
        (
            servo.borrow().torque().to_micro_nm_lossy(),
            plant.borrow().commanded_n()
        ),
        (0, 0.0)
    );
    assert_eq!(emergencies(master), [fault]);
}

#[test]
fn a_set_made_for_one_millisecond_is_refused_where_the_master_declares_two() {
    let mut master = configured(&one_axis());
    master
        .download(0, DECLARED_PERIOD, Expedited::u32(2000))
        .unwrap();
    expect_refused(master, Fault::CycleTimeMismatch);
}

#[test]
fn a_set_made_for_one_millisecond_is_refused_where_sync_comes_every_two() {
    let mut machine = one_axis();
    machine.period_s = 2.0e-3;
    let mut master = configured(&machine);
    // The same machine, its set made for 1 ms.
    machine.period_s = 1.0e-3;
    master
        .configure(&machine, &[AxisCompensation::default()])
        .unwrap();
    expect_refused(master, Fault::CycleTimeMismatch);
}

#[test]
fn a_set_made_for_two_milliseconds_runs_at_two() {
    let mut machine = one_axis();
    machine.period_s = 2.0e-3;
    let mut master = configured(&machine);
    master
        .download(0, DECLARED_PERIOD, Expedited::u32(2000))
        .unwrap();
    master.enable().unwrap();
}

#[test]
fn enabling_with_the_setpoint_a_millimetre_and_nine_tenths_away_is_refused_with_its_reason() {
    let mut master = configured(&one_axis());
    way_up(&mut master, 1.9e-3);
    let servo = master.link_mut().servo(0);
    assert_eq!(servo.borrow().drive().state(), DriveState::SwitchedOn);
    assert_eq!(servo.borrow().torque().to_micro_nm_lossy(), 0);
    // With the actual position it comes up.
    master.command(ControlWord::SWITCH_ON);
    (0..5).for_each(|_| master.cycle(&[0.0]).unwrap());
    master.command(ControlWord::ENABLE_OPERATION);
    (0..20).for_each(|_| master.cycle(&[0.0]).unwrap());
    assert_eq!(servo.borrow().drive().state(), DriveState::OperationEnabled);
    assert_eq!(emergencies(master), [Fault::ReferenceTooFar]);
}

#[test]
fn a_lost_switch_on_never_leaves_operation_enabled_without_a_stage() {
    // Torque frames (they carry the stage's control word) are lost, each of the first in turn, then
    // all of them.
    for cycle in 0..30_u32 {
        let mut master = configured(&one_axis());
        let once = FaultPlan {
            once: Some((FrameKind::Torque, cycle, bus::Damage::Lost)),
            ..FaultPlan::default()
        };
        master.link_mut().bus_mut(0).inject(PLANT, 1, once);
        master.enable().unwrap();
        let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
        assert_eq!(
            servo.borrow().drive().state(),
            DriveState::OperationEnabled,
            "cycle {cycle}"
        );
        assert_eq!(
            plant.borrow().drive(),
            plant_sim::node::TorqueDrive::OperationEnabled,
            "cycle {cycle}"
        );
    }
    let mut master = configured(&one_axis());
    let all = FaultPlan {
        cut: Some((FrameKind::Torque, 0)),
        ..FaultPlan::default()
    };
    master.link_mut().bus_mut(0).inject(PLANT, 1, all);
    assert!(master.enable().is_err());
    let servo = master.link_mut().servo(0);
    assert_eq!(servo.borrow().drive().fault(), Some(Fault::StageRefused));
}

#[test]
fn a_lost_setpoint_on_the_way_up_never_leaves_operation_enabled_without_a_stage() {
    for cycle in 0..30_u32 {
        let mut master = configured(&one_axis());
        let once = FaultPlan {
            once: Some((FrameKind::Setpoint, cycle, bus::Damage::Lost)),
            ..FaultPlan::default()
        };
        master.link_mut().bus_mut(0).inject(SERVO, 1, once);
        master.enable().unwrap();
        assert_eq!(
            master.link_mut().plant(0).borrow().drive(),
            plant_sim::node::TorqueDrive::OperationEnabled
        );
    }
}

#[test]
fn a_scale_at_a_hundred_millimetres_with_the_motor_at_zero_is_refused_until_its_relation_is_set() {
    let mut master = configured(&absolute_scale(0.1));
    set(&mut master, 0, &[(Parameter::RelationOffset, 0)]).unwrap();
    expect_refused(master, Fault::EncoderRelation);
    // The workbench writes the relation of the machine file.
    master = configured(&absolute_scale(0.1));
    way_up(&mut master, 0.1);
    master.expect_enabled().unwrap();
    let truth = master.axis(0).truth.unwrap();
    assert!((truth.table_m - 0.1).abs() < 1.0e-6, "{}", truth.table_m);
}

#[test]
fn ten_thousand_motor_revolutions_one_way_pass_and_the_position_is_exact() {
    // 10 m at 0.45 m/s with a lead of 1 mm, and a little more than the machine's travel.
    let machine = long_way();
    let (way_m, speed_m_per_s, rise_s) = (10.01_f64, 0.45_f64, 0.3_f64);
    let mut master = enabled(&machine).unwrap();
    set(&mut master, 0, &[(Parameter::PositionMax, i32::MAX)]).unwrap();
    let duration_s = way_m / speed_m_per_s + rise_s;
    let at = |time_s: f64| {
        let area = |u: f64| u.powi(4) * (2.5 - 3.0 * u + u * u);
        let up = |t: f64| {
            let u = (t / rise_s).clamp(0.0, 1.0);
            speed_m_per_s * (rise_s * area(u) + (t - rise_s).max(0.0))
        };
        if time_s < duration_s / 2.0 {
            up(time_s)
        } else {
            way_m - up((duration_s - time_s).max(0.0))
        }
    };
    let cycles = (duration_s * 1.0e3) as u32 + 500;
    for cycle in 1..cycles {
        master.cycle(&[at(f64::from(cycle) * 1.0e-3)]).unwrap();
    }
    master.expect_enabled().unwrap();
    let truth = master.axis(0).truth.unwrap();
    println!(
        "{} um off after {} revolutions",
        1.0e6 * (truth.table_m - way_m),
        truth.motor_m / 1.0e-3
    );
    assert!(
        (truth.table_m - way_m).abs() < 1.0e-6,
        "{} m",
        truth.table_m
    );
    assert!(truth.motor_m / 1.0e-3 > 10_000.0);
}
