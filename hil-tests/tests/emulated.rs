//! The node as ARM code on an emulated Cortex-M4: it answers as the host's does, bit for bit, and
//! closes the loop in its place.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::Duration;

use bus::CanPort;
use hil_tests::Scope;
use hil_tests::emulated::machine::{self, PROFILE};
use hil_tests::emulated::node::{EmulatedNode, Running};
use hil_tests::emulated::recorded::{Circling, Drive, Measured, record, with_length};
use hil_tests::emulated::recording::{Class, Event, Events};
use hil_tests::emulated::report::Report;
use hil_tests::{program, rig};
use plant_sim::Machine;
use protocol::message::{Message, NmtState};
use protocol::{AxisIds, CanFrame, Station};
use quadrant_host::Pace;
use servo::Servo;
use workbench::ballbar::{Point, figures};
use workbench::compensation::AxisCompensation;
use workbench::interrupt::Interrupt;
use workbench::network::in_process::InProcess;
use workbench::network::interfaces::Interfaces;
use workbench::network::link::{Link, axis_ids};
use workbench::session::Session;
use workbench::trajectory::{Circle, MEASURE_FROM_RAD};

/// Twelve seconds of R 10 F 1000: X turns round six times.
const CYCLES: u32 = 12_000;
/// One frame of each kind that the drive hears, on the way and near a reversal; the fourth is the
/// drive's own.
const LOST: [(Class, u32); 3] = [
    (Class::Sync, 1881),
    (Class::Setpoint, 3766),
    (Class::Feedback, 7540),
];
const TORQUE_LOST: u32 = 9000;
/// Radius, m, and feed, m/s.
const REFERENCE: (f64, f64) = (0.010, 1.0 / 60.0);

/// An emulator and what talks to it need a processor each.
static ALONE: Mutex<()> = Mutex::new(());

fn target() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .unwrap()
        .to_path_buf()
}

fn folder() -> PathBuf {
    let folder = target().join("emulated");
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Records a circle with losses and plays it to the image.
fn replayed(image: &Path, name: &str, drive: Drive) -> Report {
    let taken = record(Circling {
        drive,
        cycles: CYCLES,
        measured: Measured::Nothing,
        lost: &LOST,
        torque_lost: Some(TORQUE_LOST),
    })
    .unwrap();
    let counts = taken.counts;
    assert_eq!(
        (counts.bridged, counts.by_deadline, counts.refused),
        (3, 3, 0),
        "a cycle for each frame that the drive lacks: {counts:?}"
    );
    let path = folder().join(name).with_extension("bin");
    fs::write(&path, taken.bytes).unwrap();
    Report::of(&machine::replay(image, &path))
}

#[test]
fn the_emulated_law_repeats_the_golden_vectors() {
    let images = machine::images(&target(), PROFILE);
    let report = machine::report(&images.join("emulated-law"), &[]);
    assert_eq!(report.trim(), "vectors 400 0");
}

#[test]
fn the_emulated_node_answers_a_circle_with_losses_as_the_host_does() {
    let image = machine::images(&target(), PROFILE).join("emulated-cycle");
    for (name, drive) in [("everything", Drive::Everything), ("model", Drive::Model)] {
        let report = replayed(&image, name, drive);
        println!(
            "{name}: {} answers to {} events",
            report.compared, report.replayed
        );
        assert!(
            report.wrong.is_empty(),
            "{name}: other answers to {:?}",
            report.wrong
        );
        assert!(
            report.compared > CYCLES && report.replayed > 3 * CYCLES,
            "{report:?}"
        );
    }
    one_turned_bit_is_noticed(&image);
}

/// One turn of R 10 F 1000 that counts, after the half turn before; in `cargo test` a smaller and
/// faster one.
fn circle() -> Circle {
    let (radius_m, feed_m_per_s) = match Scope::now() {
        Scope::Quick | Scope::Test => (0.002, 1.0 / 30.0),
        Scope::Landing | Scope::Certify => REFERENCE,
    };
    Circle {
        radius_m,
        feed_m_per_s,
        turns: 1,
        counter_clockwise: true,
    }
}

/// Points of the circle on the reference machine with a servo for X, and what went over its bus.
fn circled(servo_of_x: Box<dyn Station>) -> (Vec<Point>, Vec<(u64, CanFrame)>) {
    let machine = Machine::reference();
    let mut link = InProcess::new(&machine, 0).unwrap();
    link.bus_mut(0).replace(rig::SERVO, servo_of_x);
    link.start_log();
    let mut session = Session::on(link, &machine, &Interrupt::never()).unwrap();
    session
        .ready(&vec![AxisCompensation::default(); machine.axes.len()])
        .unwrap();
    let points = session.circle(&circle()).unwrap();
    let logs = session.close().unwrap();
    (points, logs[0].frames().to_vec())
}

#[test]
fn the_emulated_node_closes_the_loop_in_process_and_the_bus_is_that_of_the_hosts_node() {
    let images = machine::images(&target(), PROFILE);
    let _alone = ALONE.lock();
    let emulated = circled(Box::new(EmulatedNode::start(&images)));
    let host = circled(Box::new(Servo::new(AxisIds::of_axis(0).unwrap())));
    let differing = host.1.iter().zip(&emulated.1).position(|(a, b)| a != b);
    assert_eq!(differing, None, "the first frame that differs");
    assert_eq!(host.1.len(), emulated.1.len());
    assert_eq!(host.0, emulated.0);
    println!("{} frames, {} points", host.1.len(), host.0.len());
}

/// The emulated node of X is on slcan0, every other node a process: the plant of X on slcan0, those
/// of Y on vcan0; and then with a process for X.
#[test]
fn the_emulated_node_closes_the_loop_over_socketcan_as_a_process_does() {
    let images = machine::images(&target(), PROFILE);
    let _alone = ALONE.lock();
    let (_machine, line) = Running::at_serial_line(&images);
    let scenario = ["--exact", "figures_over_socketcan"];
    let line = [("VCAN_SLCAN", OsStr::new(&line))];
    let out = program::ignored_tests_under_vcan(&target(), &scenario, &line);
    assert!(out.contains("1 passed; 0 failed"), "{out}");
}

#[test]
#[ignore = "run by the test above, in a kernel that has vcan and slcan"]
fn figures_over_socketcan() {
    let emulated = over(["slcan0", "vcan0"], &[PLANT_X, PLANT_Y, SERVO_Y]);
    let process = over(["vcan1", "vcan0"], &[PLANT_X, SERVO_X, PLANT_Y, SERVO_Y]);
    let figures = figures(&emulated.0, circle().radius_m, 0.0, MEASURE_FROM_RAD);
    println!("on slcan0: {figures:?}, {} cycles missed", emulated.1);
    assert_eq!((emulated.1, process.1), (0, 0), "cycles missed");
    assert_eq!(emulated.0, process.0);
}

/// A node: its axis, how `quadrant` is told to be it, and what it says when it has booted.
type Node = (usize, &'static [&'static str], Message);
const PLANT: Message = Message::PlantHeartbeat(NmtState::Initialising);
const SERVO: Message = Message::ServoHeartbeat(NmtState::Initialising);
const PLANT_X: Node = (0, &["plant", "--node", "0x11"], PLANT);
const SERVO_X: Node = (0, &["servo", "--node", "1", "--plant-node", "0x11"], SERVO);
const PLANT_Y: Node = (1, &["plant", "--node", "0x12"], PLANT);
const SERVO_Y: Node = (1, &["servo", "--node", "2", "--plant-node", "0x12"], SERVO);

/// In lock-step the figures do not depend on how long anybody waits. A guest that shares its
/// processor pauses for seconds.
const DEADLINE: Duration = Duration::from_secs(10);

/// Points of the circle with the axes on these interfaces and such nodes as processes, and cycles
/// that were missed.
fn over(interfaces: [&str; 2], nodes: &[Node]) -> (Vec<Point>, u32) {
    let program = std::env::var_os("QUADRANT_PROGRAM").expect("the test above says where it is");
    let nodes = nodes.iter().map(|(axis, arguments, boot_up)| {
        let listener = CanPort::open(interfaces[*axis], &[]).unwrap();
        let mut node = Command::new(&program);
        node.args(*arguments).args(["--can", interfaces[*axis]]);
        node.args(["--deadline-ms", &DEADLINE.as_millis().to_string()]);
        let node = Running(node.spawn().unwrap());
        let boot_up = boot_up.encode(axis_ids(*axis).unwrap());
        program::await_frames(&listener, vec![boot_up]);
        node
    });
    let _nodes: Vec<Running> = nodes.collect();
    let machine = Machine::reference();
    let link = Interfaces::open(&machine, &interfaces.join(",")).unwrap();
    let link = link.with_pace(Pace::Lockstep { deadline: DEADLINE });
    let mut session = Session::on(link, &machine, &Interrupt::never()).unwrap();
    session
        .ready(&vec![AxisCompensation::default(); machine.axes.len()])
        .unwrap();
    let points = session.circle(&circle()).unwrap();
    let missed = session.missed();
    session.close().unwrap();
    (points, missed)
}

/// The counter-proof: the lowest bit of the last torque turned.
fn one_turned_bit_is_noticed(image: &Path) {
    let whole = fs::read(folder().join("model.bin")).unwrap();
    let events: Vec<Event<'_>> = Events(&whole[4..]).collect();
    let is_feedback = |event: &Event<'_>| event.class == Class::Feedback;
    let last = events.iter().rposition(is_feedback).unwrap();
    let mut turned = Vec::new();
    for (at, event) in events.iter().enumerate() {
        let mut answers = event.answers.to_vec();
        let torque = answers.first_mut().filter(|_| at == last);
        if let Some(torque) = torque {
            torque[3] ^= 1;
        }
        let answers = &answers;
        Event { answers, ..*event }.write(&mut turned);
    }
    let path = folder().join("turned.bin");
    fs::write(&path, with_length(&turned)).unwrap();
    let report = Report::of(&machine::replay(image, &path));
    assert_eq!(report.wrong, [u32::try_from(last).unwrap()]);
}
