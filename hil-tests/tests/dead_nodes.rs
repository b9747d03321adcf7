//! Dead nodes and cut wires: torque is zero within the stated cycles, the fault is named and
//! latched, and only a fault reset brings the axis back.
//!
//! How far the table goes meanwhile is in `golden/standstill.md`, what single losses do in
//! `golden/silence.md`.

use bus::FaultPlan;
use hil_tests::rig::{PLANT, SERVO, enabled, enabled_on, one_axis};
use protocol::cob::FrameKind;
use protocol::states::DriveState;
use protocol::{AxisIds, Fault, Message, message};
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::network::master::Master;

/// From rest, 26 mm/s at most.
fn path(cycle: u32) -> f64 {
    0.010 * (1.0 - (std::f64::consts::TAU * f64::from(cycle) / 2400.0).cos())
}

fn moving() -> Master<InProcess> {
    let mut master = enabled(&one_axis()).unwrap();
    (0..1000).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
    assert_ne!(master.link_mut().plant(0).borrow().commanded_n(), 0.0);
    master
}

/// What dies, and how.
#[derive(Clone, Copy, Debug)]
enum Death {
    /// A kind of frame no longer reaches this place.
    Frame(FrameKind, usize),
    /// A node.
    Node(usize),
}

impl Death {
    fn strikes(self, master: &mut Master<InProcess>) {
        let bus = master.link_mut().bus_mut(0);
        match self {
            Self::Frame(kind, place) => {
                bus.inject(
                    place,
                    1,
                    FaultPlan {
                        cut: Some((kind, 0)),
                        ..FaultPlan::default()
                    },
                );
            }
            Self::Node(place) => bus.kill(place),
        }
    }
}

/// Cycles until no torque is commanded at the servo, and none is due at the plant.
type CyclesToZero = [Option<u32>; 2];

fn cycles_to_zero(master: &mut Master<InProcess>) -> CyclesToZero {
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let mut zero = [None; 2];
    for cycle in 1..=600 {
        master.cycle(&[path(999 + cycle)]).unwrap();
        let is_zero = [
            servo.borrow().torque().to_micro_nm_lossy() == 0,
            plant.borrow().commanded_n() == 0.0,
        ];
        for (zero, _) in zero.iter_mut().zip(is_zero).filter(|(_, is_zero)| *is_zero) {
            zero.get_or_insert(cycle);
        }
    }
    zero
}

/// What died, how, the servo's fault, cycles to zero at servo and plant. A dead node computes
/// nothing any more; what counts is the other one. Setpoint and heartbeat: a ramp comes first; so
/// many periods without a heartbeat are allowed, and they count from the last one.
const DEATHS: [(&str, Death, Option<Fault>, CyclesToZero); 6] = [
    (
        "setpoint",
        Death::Frame(FrameKind::Setpoint, SERVO),
        Some(Fault::SetpointMissing),
        [Some(8), Some(8)],
    ),
    (
        "feedback",
        Death::Frame(FrameKind::Feedback, SERVO),
        Some(Fault::FeedbackMissing),
        [Some(4), Some(4)],
    ),
    (
        "heartbeat",
        Death::Frame(FrameKind::PlantHeartbeat, SERVO),
        Some(Fault::HeartbeatLost),
        [Some(449), Some(449)],
    ),
    (
        "torque",
        Death::Frame(FrameKind::Torque, PLANT),
        Some(Fault::PeerFault),
        [Some(5), Some(5)],
    ),
    (
        "plant",
        Death::Node(PLANT),
        Some(Fault::FeedbackMissing),
        [Some(4), None],
    ),
    ("servo", Death::Node(SERVO), None, [None, Some(5)]),
];

#[test]
fn whatever_dies_torque_is_zero_within_the_stated_cycles_and_the_fault_is_latched() {
    for (name, death, fault, wanted) in DEATHS {
        let mut master = moving();
        death.strikes(&mut master);
        let zero = cycles_to_zero(&mut master);
        println!("{name} gone: {zero:?}");
        for (zero, wanted) in zero
            .into_iter()
            .zip(wanted)
            .filter(|(_, wanted)| wanted.is_some())
        {
            assert_eq!(zero, wanted, "{name}");
        }
        let servo = master.link_mut().servo(0);
        assert_eq!(servo.borrow().drive().fault(), fault, "{name}");
        (0..50).for_each(|_| master.cycle(&[0.0]).unwrap());
        assert_eq!(servo.borrow().drive().fault(), fault, "{name}: latched");
    }
}

#[test]
fn a_fault_reset_brings_the_axis_back_and_nothing_else_does() {
    let mut master = moving();
    Death::Frame(FrameKind::Feedback, SERVO).strikes(&mut master);
    (0..100).for_each(|cycle| master.cycle(&[path(1000 + cycle)]).unwrap());
    assert_eq!(master.fault(0), Some(Fault::FeedbackMissing));
    master
        .link_mut()
        .bus_mut(0)
        .inject(SERVO, 1, FaultPlan::default());
    (0..300).for_each(|cycle| master.cycle(&[path(1100 + cycle)]).unwrap());
    assert_eq!(
        master.state(0),
        Some(DriveState::Fault),
        "feedback is back, the fault stays"
    );
    master.reset_fault().unwrap();
    master.enable().unwrap();
    assert_eq!(master.state(0), Some(DriveState::OperationEnabled));
}

#[test]
fn the_workbench_does_not_go_on_with_a_servo_that_is_gone() {
    let mut master = moving();
    Death::Node(SERVO).strikes(&mut master);
    (0..20).for_each(|cycle| master.cycle(&[path(1000 + cycle)]).unwrap());
    assert!(master.has_lost_a_servo());
    let why = master.expect_enabled().unwrap_err().to_string();
    assert!(
        why.contains("axis X") && why.contains("sent no torque"),
        "{why}"
    );
}

#[test]
fn a_servo_that_restarts_while_the_axis_moves_does_not_take_up_torque_by_itself() {
    let mut master = moving();
    let fresh = servo::Servo::new(master.link_mut().servo(0).borrow().ids());
    *master.link_mut().servo(0).borrow_mut() = fresh;
    (0..300).for_each(|cycle| master.cycle(&[path(1000 + cycle)]).unwrap());
    assert_eq!(master.link_mut().plant(0).borrow().commanded_n(), 0.0);
    assert_eq!(
        master.link_mut().plant(0).borrow().fault(),
        Some(Fault::TorqueMissing)
    );
    assert_eq!(
        master
            .link_mut()
            .servo(0)
            .borrow()
            .torque()
            .to_micro_nm_lossy(),
        0
    );
}

#[test]
fn without_sync_servo_and_plant_come_to_rest_by_their_own_timers() {
    let mut master = moving();
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let is_zero =
        || servo.borrow().torque().to_micro_nm_lossy() == 0 && plant.borrow().commanded_n() == 0.0;
    // The workbench sends nothing more, and virtual time passes.
    let begun_us = master.link_mut().bus_mut(0).now_us();
    while !is_zero() && master.link_mut().bus_mut(0).now_us() < begun_us + 1_000_000 {
        let _ = master.link_mut().bus_mut(0).receive(1000);
    }
    let zero_us = master.link_mut().bus_mut(0).now_us() - begun_us;
    println!("workbench silent: {zero_us} µs");
    // Three setpoints may be missing, then a ramp from 26 mm/s at 5 m/s², then nothing.
    assert!((4_000..=15_000).contains(&zero_us), "{zero_us} µs");
    assert_eq!(servo.borrow().drive().fault(), Some(Fault::SetpointMissing));
}

#[test]
fn two_runs_say_the_same_byte_for_byte() {
    let run = || {
        let mut machine = one_axis();
        machine.axes[0].actual.force_noise_n = 4.5;
        let mut link = InProcess::new(&machine, 0).unwrap();
        link.start_log();
        let mut master = enabled_on(link, &machine).unwrap();
        (0..3000).for_each(|cycle| master.cycle(&[path(cycle)]).unwrap());
        let cycles = master.cycles();
        (master.into_link().take_logs().remove(0), cycles)
    };
    let ((first, cycles), (second, _)) = (run(), run());
    assert_eq!(first.frames(), second.frames());
    assert!(first.frames().len() > 12_000);
    let ids = AxisIds::of_axis(0).unwrap();
    let is_sync = |frame| {
        matches!(
            message::decode(ids, frame),
            Ok(message::Decoded::Message(Message::Sync(_)))
        )
    };
    let syncs = first
        .frames()
        .iter()
        .filter(|(_, frame)| is_sync(frame))
        .count();
    assert_eq!(u64::try_from(syncs).unwrap(), cycles);
}
