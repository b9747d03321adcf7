//! Faults on the bus and dead nodes: nothing panics, nothing stands still, no torque on stale data for longer than stated, and it is reported.

use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::{PLANT, SERVO, enabled, one_axis};
use plant_sim::node::TORQUE_MISSES_ALLOWED;
use protocol::cob::FrameKind;
use protocol::states::DriveState;
use protocol::{Fault, Message};
use servo::objects::{Parameter, TABLE};
use workbench::link::InProcess;
use workbench::master::Master;

use bus::FaultPlan;

const CYCLES: u32 = 20_000;

/// A sine of 10 mm with 26 mm/s at most.
fn path(cycle: u32) -> f64 {
    0.010 * (1.0 - (std::f64::consts::TAU * f64::from(cycle) / 2400.0).cos())
}

fn default_of(parameter: Parameter) -> u16 {
    let entry = TABLE.iter().find(|entry| entry.parameter == parameter).unwrap();
    u16::try_from(entry.default).unwrap()
}

struct Seen {
    longest_setpoint: u16,
    longest_feedback: u16,
    longest_torque: u16,
    warnings: u32,
    faults: u32,
    enabled_cycles: u32,
}

/// Runs the path under faults; a latched fault is reset and the axis goes on, as an operator would.
fn survive(plan: FaultPlan) -> (Master<InProcess>, Seen) {
    let machine = one_axis();
    let mut master = enabled(&machine).unwrap();
    for (place, receiver) in [(PLANT, 0x11), (SERVO, 0x01)] {
        master.link_mut().bus_mut(0).inject(place, receiver, plan);
    }
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let mut seen =
        Seen { longest_setpoint: 0, longest_feedback: 0, longest_torque: 0, warnings: 0, faults: 0, enabled_cycles: 0 };
    for cycle in 0..CYCLES {
        master.cycle(&[path(cycle)]).unwrap();
        let (setpoints, feedbacks) = servo.borrow().bridged();
        if servo.borrow().torque().to_micro_nm_lossy() != 0 {
            seen.longest_setpoint = seen.longest_setpoint.max(setpoints);
            seen.longest_feedback = seen.longest_feedback.max(feedbacks);
        }
        if plant.borrow().commanded_n() != 0.0 {
            seen.longest_torque = seen.longest_torque.max(plant.borrow().bridged());
        }
        seen.enabled_cycles += u32::from(servo.borrow().drive().state() == DriveState::OperationEnabled);
        if servo.borrow().drive().fault().is_some() && servo.borrow().drive().state() == DriveState::Fault {
            seen.faults += 1;
            assert!(master.expect_enabled().is_err(), "the EMCY tells at once, the status may be ten cycles old");
            master.reset_fault().unwrap();
            // Under faults the way up may need another try.
            while master.enable().is_err() {
                master.reset_fault().unwrap();
            }
        }
    }
    seen.warnings = servo.borrow().counts().bridged;
    (master, seen)
}

#[test]
fn one_frame_in_twenty_may_be_lost_doubled_late_or_corrupted() {
    let five = FaultPlan { seed: 7, from_cycle: 100, ..FaultPlan::default() };
    let plans = [
        ("lost", FaultPlan { lost_per_mille: 50, ..five }),
        ("doubled", FaultPlan { doubled_per_mille: 50, ..five }),
        ("late", FaultPlan { late_per_mille: 50, ..five }),
        ("corrupted", FaultPlan { corrupted_per_mille: 50, ..five }),
        (
            "all four",
            FaultPlan {
                lost_per_mille: 50,
                doubled_per_mille: 50,
                late_per_mille: 50,
                corrupted_per_mille: 50,
                ..five
            },
        ),
    ];
    let feedback_allowed = default_of(Parameter::FeedbackMissesAllowed);
    let setpoint_allowed = default_of(Parameter::SetpointMissesAllowed) + 200;
    let mut rows: Vec<Measured> = Vec::new();
    for (name, plan) in plans {
        let (mut master, seen) = survive(plan);
        assert!(
            seen.longest_feedback <= feedback_allowed,
            "{name}: torque on feedback {} cycles old",
            seen.longest_feedback
        );
        assert!(
            seen.longest_setpoint <= setpoint_allowed,
            "{name}: torque on setpoint {} cycles old",
            seen.longest_setpoint
        );
        assert!(
            seen.longest_torque <= TORQUE_MISSES_ALLOWED,
            "{name}: force on torque {} cycles old",
            seen.longest_torque
        );
        assert!(seen.warnings > 0, "{name}: nothing was reported");
        assert!(master.link_mut().bus_mut(0).injected() > 1000, "{name}: hardly any fault was injected");
        for (what, value, unit) in [
            ("frames damaged", f64::from(master.link_mut().bus_mut(0).injected()), "frames"),
            ("reported by the servo", f64::from(seen.warnings), "frames"),
            ("longest bridged feedback", f64::from(seen.longest_feedback), "cycles"),
            ("longest bridged setpoint", f64::from(seen.longest_setpoint), "cycles"),
            ("longest bridged torque", f64::from(seen.longest_torque), "cycles"),
            ("latched faults", f64::from(seen.faults), ""),
            ("time enabled", 100.0 * f64::from(seen.enabled_cycles) / f64::from(CYCLES), "%"),
            ("cycles that the workbench waited for in vain", f64::from(master.missed()), "cycles"),
        ] {
            rows.push(row(format!("5 % {name}, {what}"), value, unit));
        }
    }
    golden::check("faults", &rows);
}

/// What dies, and how.
#[derive(Clone, Copy, Debug)]
enum Death {
    Frame(FrameKind, usize),
    Node(usize),
}

/// Cycles from a death to torque zero: at the servo's output, and as force in the plant.
fn cycles_to_zero(death: Death) -> (Master<InProcess>, Option<u32>, Option<u32>) {
    let machine = one_axis();
    let mut master = enabled(&machine).unwrap();
    (0..1000).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    match death {
        Death::Frame(kind, place) => {
            let plan = FaultPlan { cut: Some((kind, 0)), ..FaultPlan::default() };
            master.link_mut().bus_mut(0).inject(place, 1, plan);
        }
        Death::Node(place) => master.link_mut().bus_mut(0).connect(place, false),
    }
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let (mut servo_zero, mut plant_zero) = (None, None);
    for cycle in 1..=600 {
        master.cycle(&[path(1000 + cycle)]).unwrap();
        if servo_zero.is_none() && servo.borrow().torque().to_micro_nm_lossy() == 0 {
            servo_zero = Some(cycle);
        }
        if plant_zero.is_none() && plant.borrow().commanded_n() == 0.0 {
            plant_zero = Some(cycle);
        }
    }
    (master, servo_zero, plant_zero)
}

#[test]
fn whatever_dies_the_torque_is_zero_within_the_stated_cycles_until_a_fault_reset() {
    let deaths = [
        ("setpoint gone", Death::Frame(FrameKind::Setpoint, SERVO), Some(Fault::SetpointMissing)),
        ("feedback gone", Death::Frame(FrameKind::Feedback, SERVO), Some(Fault::FeedbackMissing)),
        ("plant heartbeat gone", Death::Frame(FrameKind::PlantHeartbeat, SERVO), Some(Fault::HeartbeatLost)),
        ("torque frame gone at the plant", Death::Frame(FrameKind::Torque, PLANT), Some(Fault::PeerFault)),
        ("plant dead", Death::Node(PLANT), Some(Fault::FeedbackMissing)),
        ("servo dead", Death::Node(SERVO), None),
    ];
    let mut rows = Vec::new();
    for (name, death, fault) in deaths {
        let (mut master, servo_zero, plant_zero) = cycles_to_zero(death);
        // A dead node computes nothing any more; what counts is the other one.
        if !matches!(death, Death::Node(SERVO)) {
            rows.push(row(format!("{name}: servo commands zero after"), f64::from(servo_zero.expect(name)), "cycles"));
            let servo = master.link_mut().servo(0);
            assert_eq!(servo.borrow().drive().fault(), fault, "{name}");
            (0..50).for_each(|_| master.cycle(&[0.0]).unwrap());
            assert_eq!(servo.borrow().drive().fault(), fault, "{name}: latched");
        }
        if !matches!(death, Death::Node(PLANT)) {
            rows.push(row(format!("{name}: plant force zero after"), f64::from(plant_zero.expect(name)), "cycles"));
        }
    }
    golden::check("dead-nodes", &rows);
}

#[test]
fn the_workbench_does_not_go_on_with_a_servo_that_is_gone() {
    let machine = one_axis();
    let mut master = enabled(&machine).unwrap();
    (0..100).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    master.link_mut().bus_mut(0).connect(SERVO, false);
    (0..20).for_each(|cycle| master.cycle(&[path(100 + cycle)]).unwrap());
    assert!(master.has_lost_a_servo());
    let why = master.expect_enabled().unwrap_err().to_string();
    assert!(why.contains("axis X") && why.contains("sent no torque"), "{why}");
}

#[test]
fn a_fault_reset_brings_the_axis_back_and_nothing_else_does() {
    let machine = one_axis();
    let mut master = enabled(&machine).unwrap();
    let plan = FaultPlan { cut: Some((FrameKind::Feedback, 0)), ..FaultPlan::default() };
    master.link_mut().bus_mut(0).inject(SERVO, 1, plan);
    (0..100).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    assert_eq!(master.fault(0), Some(Fault::FeedbackMissing));
    master.link_mut().bus_mut(0).inject(SERVO, 1, FaultPlan::default());
    (0..300).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    assert_eq!(master.state(0), Some(DriveState::Fault), "feedback is back, the fault stays");
    master.reset_fault().unwrap();
    master.enable().unwrap();
    assert_eq!(master.state(0), Some(DriveState::OperationEnabled));
}

#[test]
fn without_sync_both_nodes_go_to_zero_by_the_wall_clock() {
    let machine = one_axis();
    let mut master = enabled(&machine).unwrap();
    (0..1000).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    assert_ne!(plant.borrow().commanded_n(), 0.0);
    let mut zero_ms = None;
    for ms in 1..=2000_u32 {
        // The workbench is silent; 1 ms of virtual time passes.
        let _ = master.link_mut().bus_mut(0).receive(1000);
        if zero_ms.is_none() && servo.borrow().torque().to_micro_nm_lossy() == 0 && plant.borrow().commanded_n() == 0.0
        {
            zero_ms = Some(ms);
        }
    }
    assert_eq!(servo.borrow().drive().fault(), Some(Fault::SyncMissing));
    golden::check(
        "sync-gone",
        &[row("torque zero at servo and plant after SYNC is gone", f64::from(zero_ms.unwrap()), "ms")],
    );
}

#[test]
fn a_servo_that_restarts_while_the_axis_moves_does_not_take_up_torque_by_itself() {
    let machine = one_axis();
    let mut master = enabled(&machine).unwrap();
    (0..1000).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    let fresh = servo::Servo::new(master.link_mut().servo(0).borrow().ids());
    *master.link_mut().servo(0).borrow_mut() = fresh;
    (0..300).for_each(|cycle| master.cycle(&[path(1000 + cycle)]).unwrap());
    assert_eq!(master.link_mut().plant(0).borrow().commanded_n(), 0.0);
    assert_eq!(master.link_mut().plant(0).borrow().fault(), Some(Fault::TorqueMissing));
    assert_eq!(master.link_mut().servo(0).borrow().torque().to_micro_nm_lossy(), 0);
}

#[test]
fn two_runs_say_the_same_byte_for_byte() {
    let run = || {
        let mut machine = one_axis();
        machine.axes[0].actual.force_noise_n = 4.5;
        let mut master = enabled(&machine).unwrap();
        (0..3000).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
        let cycles = master.cycles();
        let mut link = master.into_link();
        (workbench::link::Link::take_logs(&mut link).remove(0), cycles)
    };
    let ((first, cycles), (second, _)) = (run(), run());
    assert_eq!(first.frames(), second.frames());
    assert!(first.frames().len() > 12_000);
    let ids = protocol::AxisIds::of_axis(0).unwrap();
    let syncs = first.frames().iter().filter(|(_, frame)| {
        matches!(protocol::message::decode(ids, frame), Ok(protocol::message::Decoded::Message(Message::Sync(_))))
    });
    assert_eq!(u64::try_from(syncs.count()).unwrap(), cycles);
}
