//! The scenarios over a real vcan, every node a process of its own.
//!
//! `over_vcan` is the test: it builds the program, gets a kernel with vcan (this one, or a
//! user-mode guest: `scripts/with-vcan`) and runs the others, which are marked as ignored only
//! because they need that kernel. It fails where they did not run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

use bus::CanPort;
use hil_tests::rig::shared_bus;
use hil_tests::{Scope, program};
use protocol::message::{Decoded, NmtState, decode};
use protocol::{Fault, Message};
use quadrant_host::Pace;
use workbench::compensation::AxisCompensation;
use workbench::network::interfaces::Interfaces;
use workbench::network::link::{Link, axis_ids};
use workbench::network::master::Master;

/// The scenarios of a scope by their names, and what the runner says when all of them passed.
const QUICK: (&[&str], &str) = (&["separate_processes"], "1 passed; 0 failed");
const ALL: (&[&str], &str) = (&[], "4 passed; 0 failed");

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_path_buf()
}

fn folder() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .unwrap()
        .join("vcan");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn program() -> PathBuf {
    std::env::var_os("QUADRANT_PROGRAM")
        .expect("over_vcan says where the program is")
        .into()
}

#[test]
fn over_vcan() {
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .unwrap()
        .to_path_buf();
    let (scenarios, passed) = Scope::now().pick(QUICK, ALL, ALL);
    let stats = folder().join("kernel-stats.txt");
    let arguments = [&["--test-threads=1"], scenarios].concat();
    let out = program::ignored_tests_under_vcan(
        &target,
        &arguments,
        &[("VCAN_STATS", stats.as_os_str())],
    );
    assert!(out.contains(passed), "not all vcan scenarios ran: {out}");
    assert!(
        std::fs::read_to_string(stats)
            .unwrap()
            .contains("transmitted frames")
    );

    let decoded = Command::new(root().join("scripts/decode-candump"))
        .arg(folder().join("first.candump.log"))
        .arg(root().join("protocol/quadrant.dbc"))
        .env("CARGO_TARGET_DIR", &target)
        .output()
        .unwrap();
    let out = String::from_utf8_lossy(&decoded.stdout);
    println!("{out}{}", String::from_utf8_lossy(&decoded.stderr));
    assert!(
        decoded.status.success() && out.contains("unknown 0"),
        "{out}"
    );
}

/// How the node processes are started.
#[derive(Clone, Copy, Default)]
struct Setup<'a> {
    /// Faults in every receiving port: seed,lost,doubled,late,corrupted per mille.
    faults: Option<&'a str>,
    /// The lock-step deadline of nodes and master; long without it.
    deadline: Option<Duration>,
    /// Nodes follow the clock, each axis on a bus of its own: two on one are more than it carries.
    clock: bool,
}

impl Setup<'_> {
    fn interface(self, axis: usize) -> &'static str {
        if self.clock && axis == 1 {
            "vcan1"
        } else {
            "vcan0"
        }
    }

    fn node(self, axis: usize, arguments: &[&str]) -> Child {
        let mut command = Command::new(program());
        command
            .args(arguments)
            .args(["--can", self.interface(axis)]);
        if self.clock {
            command.args(["--pace", "clock"]);
        }
        if let Some(plan) = self.faults {
            command.args(["--faults", plan]);
        }
        if let Some(deadline) = self.deadline {
            command
                .arg("--deadline-ms")
                .arg(deadline.as_millis().to_string());
        }
        command.spawn().unwrap()
    }

    /// A master on the enabled machine.
    fn enabled(self) -> Master<Interfaces> {
        let machine = shared_bus();
        let mut link = Interfaces::open(&machine, "vcan0").unwrap();
        if let Some(deadline) = self.deadline {
            link = link.with_pace(Pace::Lockstep { deadline });
        }
        let mut master = Master::start(link, &machine).unwrap();
        master
            .configure(&machine, &vec![AxisCompensation::default(); 2])
            .unwrap();
        master.enable().unwrap();
        master
    }
}

/// Places of the processes.
const PLANT_X: usize = 0;
const SERVO_X: usize = 1;

/// Node processes of both axes; they end with the value.
struct Nodes(Vec<Child>);

impl Nodes {
    fn start(setup: Setup<'_>) -> Self {
        let listeners = [0, 1].map(|axis| CanPort::open(setup.interface(axis), &[]).unwrap());
        let nodes = Self(vec![
            setup.node(0, &["plant", "--node", "0x11"]),
            setup.node(0, &["servo", "--node", "1", "--plant-node", "0x11"]),
            setup.node(1, &["plant", "--node", "0x12"]),
            setup.node(1, &["servo", "--node", "2", "--plant-node", "0x12"]),
        ]);
        for (axis, listener) in listeners.iter().enumerate() {
            await_boot_ups(listener, axis);
        }
        nodes
    }

    /// Dies on the spot.
    fn kill(&mut self, node: usize) {
        self.0[node].kill().unwrap();
        self.0[node].wait().unwrap();
    }

    /// Is asked to end; gives how it did.
    fn end(&mut self, node: usize, signal: &str) -> ExitStatus {
        let node = &mut self.0[node];
        assert!(
            Command::new("kill")
                .arg(signal)
                .arg(node.id().to_string())
                .status()
                .unwrap()
                .success()
        );
        node.wait().unwrap()
    }
}

/// Hears the boot-up of both nodes of an axis.
fn await_boot_ups(listener: &CanPort, axis: usize) {
    let ids = axis_ids(axis).unwrap();
    let boot_ups = vec![
        Message::PlantHeartbeat(NmtState::Initialising).encode(ids),
        Message::ServoHeartbeat(NmtState::Initialising).encode(ids),
    ];
    program::await_frames(listener, boot_ups);
}

impl Drop for Nodes {
    fn drop(&mut self) {
        for node in &mut self.0 {
            let _ = node.kill();
            let _ = node.wait();
        }
    }
}

fn machine_file() -> PathBuf {
    let text = plant_sim::Machine::reference_text()
        .replace("like = \"X\"", "like = \"X\"\ninterface = \"vcan0\"");
    let text = text.replacen("name = \"X\"", "name = \"X\"\ninterface = \"vcan0\"", 1);
    let path = folder().join("shared-bus.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// Runs a circle and gives its log, frame by frame without times.
fn circle(name: &str, can: Option<&str>) -> Vec<String> {
    let log = folder().join(format!("{name}.candump.log"));
    let mut command = Command::new(program());
    command
        .args([
            "circle",
            "--radius-mm",
            "5",
            "--feed-mm-min",
            "2000",
            "--machine",
        ])
        .arg(machine_file());
    command.arg("--candump").arg(&log);
    if let Some(interface) = can {
        command.args(["--can", interface]);
    }
    let ran = command.output().unwrap();
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    let text = std::fs::read_to_string(log).unwrap();
    text.lines()
        .map(|line| line.rsplit(' ').next().unwrap().to_owned())
        .collect()
}

/// Frames of each identifier, from the reset of all nodes on: before it, processes boot when they
/// like.
fn by_identifier(frames: &[String]) -> BTreeMap<String, Vec<String>> {
    let reset = frames
        .iter()
        .position(|frame| frame == "000#8200")
        .expect("the workbench resets all nodes");
    let mut sequences: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for frame in &frames[reset..] {
        let (identifier, data) = frame.split_once('#').unwrap();
        sequences
            .entry(identifier.into())
            .or_default()
            .push(data.into());
    }
    sequences
}

fn kernel_frames() -> u64 {
    let text = std::fs::read_to_string("/proc/net/can/stats").expect("this kernel has CAN");
    let line = text.lines().find(|line| line.contains("(TXF)")).unwrap();
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
#[ignore = "run by over_vcan, in a kernel that has vcan"]
fn separate_processes_say_byte_for_byte_what_one_process_says_and_say_it_again() {
    let in_process = by_identifier(&circle("in-process", None));
    let (first, counted) = {
        let _nodes = Nodes::start(Setup::default());
        let before = kernel_frames();
        let first = circle("first", Some("vcan0"));
        (first, kernel_frames() - before)
    };
    let second = {
        let _nodes = Nodes::start(Setup::default());
        circle("second", Some("vcan0"))
    };
    // Outside the log there are heartbeats of four nodes, before the workbench listens and after it
    // has closed its log.
    let outside = counted - first.len() as u64;
    assert!(
        outside <= 8,
        "the kernel counts every frame of the log, and {outside} more"
    );
    println!(
        "vcan: {} frames in the log, {counted} counted by the kernel",
        first.len()
    );
    for (name, other) in [
        ("first run over vcan", by_identifier(&first)),
        ("second run over vcan", by_identifier(&second)),
    ] {
        assert_eq!(
            in_process.keys().collect::<Vec<_>>(),
            other.keys().collect::<Vec<_>>(),
            "{name}: identifiers"
        );
        for (identifier, frames) in &in_process {
            let differing = frames
                .iter()
                .zip(&other[identifier])
                .position(|(a, b)| a != b);
            assert_eq!(differing, None, "{name}: identifier {identifier} differs");
            assert_eq!(
                frames.len(),
                other[identifier].len(),
                "{name}: identifier {identifier} has another number of frames"
            );
        }
    }
}

/// From rest: 10 mm to and fro with 26 mm/s at most.
fn path(cycle: u32) -> Vec<f64> {
    let x = 0.010 * (1.0 - (std::f64::consts::TAU * f64::from(cycle) / 2400.0).cos());
    vec![x, x]
}

/// Long enough for a process to get its turn, short enough for a test.
const DEADLINE: Duration = Duration::from_millis(20);

#[test]
#[ignore = "run by over_vcan, in a kernel that has vcan"]
fn frames_that_go_wrong_in_the_ports_stop_no_cycle_over_vcan() {
    for plan in [
        "7,10,0,0,0",
        "7,0,10,0,0",
        "7,0,0,10,0",
        "7,0,0,0,10",
        "7,10,10,10,10",
    ] {
        let setup = Setup {
            faults: Some(plan),
            deadline: Some(DEADLINE),
            ..Setup::default()
        };
        let _nodes = Nodes::start(setup);
        let mut master = setup.enabled();
        let begun = Instant::now();
        (0..500).for_each(|cycle| master.cycle(&path(cycle)).unwrap());
        let (took, missed) = (begun.elapsed(), master.missed());
        println!(
            "faults {plan}: {missed} cycles waited for in vain, {took:?}, faults {:?}",
            [0, 1].map(|axis| master.fault(axis))
        );
        assert!(took < 500 * 3 * DEADLINE, "{plan}: {took:?}");
    }
}

#[test]
#[ignore = "run by over_vcan, in a kernel that has vcan"]
fn dead_processes_and_a_silent_workbench_are_noticed_over_vcan() {
    let deadline = Duration::from_millis(200);
    let setup = Setup {
        deadline: Some(deadline),
        ..Setup::default()
    };
    // Servo of X is asked to end and does, with nothing more to say: its plant notices that torque
    // is missing.
    let mut nodes = Nodes::start(setup);
    let mut master = setup.enabled();
    (0..500).for_each(|cycle| master.cycle(&path(cycle)).unwrap());
    assert_eq!(nodes.end(SERVO_X, "-TERM").code(), Some(0), "SIGTERM");
    (500..510).for_each(|cycle| master.cycle(&path(cycle)).unwrap());
    assert_eq!(master.fault(0), Some(Fault::TorqueMissing), "plant of X");
    assert_eq!(master.fault(1), None, "Y goes on");
    assert_eq!(nodes.end(PLANT_X, "-INT").code(), Some(0), "SIGINT");
    drop(nodes);

    // Plant of X dies: its servo notices that feedback is missing.
    let mut nodes = Nodes::start(setup);
    let mut master = setup.enabled();
    (0..500).for_each(|cycle| master.cycle(&path(cycle)).unwrap());
    nodes.kill(PLANT_X);
    (500..510).for_each(|cycle| master.cycle(&path(cycle)).unwrap());
    assert_eq!(master.fault(0), Some(Fault::FeedbackMissing), "servo of X");
    drop(nodes);

    // The workbench falls silent: after three deadlines (a frame of the peer delays each once) time
    // follows the clock, and both axes notice.
    let _nodes = Nodes::start(setup);
    let mut master = setup.enabled();
    (0..500).for_each(|cycle| master.cycle(&path(cycle)).unwrap());
    let reported = emergencies(&mut master.into_link(), Duration::from_secs(3));
    println!("the workbench is silent: {reported:?}");
    for axis in 0..2 {
        let first = reported
            .iter()
            .find(|(_, of, _)| *of == axis)
            .map(|(at, _, fault)| (*at, *fault));
        let (at, fault) =
            first.unwrap_or_else(|| panic!("axis {axis} reports nothing: {reported:?}"));
        assert!(
            matches!(fault, Fault::SetpointMissing | Fault::SyncMissing),
            "axis {axis}: {fault:?}"
        );
        assert!(
            at >= 3 * deadline * 9 / 10 && at < 6 * deadline,
            "axis {axis}: {at:?}"
        );
    }
}

/// The faults that nodes report for some time from now on: when, which axis, what.
fn emergencies(link: &mut Interfaces, patience: Duration) -> Vec<(Duration, usize, Fault)> {
    let begun = Instant::now();
    let mut reported = Vec::new();
    while begun.elapsed() < patience {
        let Some(frame) = link.receive(0, Duration::from_millis(50)).unwrap() else {
            continue;
        };
        for axis in 0..2 {
            if let Ok(Decoded::Message(
                Message::ServoEmergency(emergency) | Message::PlantEmergency(emergency),
            )) = decode(axis_ids(axis).unwrap(), &frame)
            {
                let fault = Fault::from_code(emergency.vendor_specific[0]);
                reported.extend(fault.map(|fault| (begun.elapsed(), axis, fault)));
            }
        }
    }
    reported
}

/// What `timing` over vcan writes as JSON, or why it broke off.
fn timing(place: &[&str]) -> Result<serde_json::Value, String> {
    let file = folder().join("timing.json");
    let ran = Command::new(program())
        .args(["timing", "--seconds", TIMED_S, "--can"])
        .args(place)
        .arg("--json")
        .arg(&file)
        .output()
        .unwrap();
    println!("{}", String::from_utf8_lossy(&ran.stdout));
    if !ran.status.success() {
        assert_eq!(ran.status.code(), Some(2));
        return Err(String::from_utf8_lossy(&ran.stderr).into_owned());
    }
    Ok(serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap())
}

/// Seconds that are timed, and their cycles.
const TIMED_S: &str = "3";
const TIMED: u64 = 3000;
/// So many of a duration, and of cycles that were missed.
fn counts(timing: &serde_json::Value, of: &str) -> (u64, u64) {
    let all = timing["times"].as_array().unwrap();
    let one = all.iter().find(|times| times["of"] == of);
    let count = one.map_or(0, |times| times["count"].as_u64().unwrap());
    assert!(timing["cycles"].as_u64().unwrap() >= TIMED);
    (count, timing["missed_cycles"].as_u64().unwrap())
}

/// What each drive has timed by its own clock.
fn drives_times(timing: &serde_json::Value) -> Vec<Vec<serde_json::Value>> {
    let drives = timing["drives"].as_array().unwrap();
    assert_eq!(drives.len(), 2);
    let times = |drive: &serde_json::Value| drive["times"].as_array().unwrap().clone();
    drives.iter().map(times).collect()
}

/// Every cycle, and a little more: they go on while the objects are read.
fn assert_timed(times: &[serde_json::Value]) {
    let of = |place: usize| times[place]["of"].as_str().unwrap();
    assert_eq!(of(0), "frame received to torque sent");
    assert_eq!((times.len(), of(1)), (2, "control cycle"));
    let count = times[1]["count"].as_u64().unwrap();
    assert!(
        (TIMED - TIMED / 20..TIMED + 300).contains(&count),
        "{count}"
    );
    let mean_us = |place: usize| times[place]["mean_us"].as_f64().unwrap();
    assert!(0.0 < mean_us(1) && mean_us(1) < mean_us(0), "{times:?}");
}

#[test]
#[ignore = "run by over_vcan, in a kernel that has vcan"]
fn every_cycle_is_timed_over_vcan_and_a_clock_that_is_not_kept_stops_the_axes_by_name() {
    let nodes = Nodes::start(Setup::default());
    let in_step = timing(&["vcan0"]).unwrap();
    assert_eq!(counts(&in_step, "SYNC to the last torque"), (TIMED, 0));
    assert_eq!(counts(&in_step, "SYNC to feedback"), (2 * TIMED, 0));
    assert_eq!(counts(&in_step, "feedback to torque"), (2 * TIMED, 0));
    assert_eq!(counts(&in_step, "bare frame, there and back"), (2000, 0));
    assert_eq!(counts(&in_step, "lateness of SYNC"), (0, 0));
    // In lock-step nobody waits for a drive's clock.
    assert!(drives_times(&in_step).iter().all(Vec::is_empty));
    drop(nodes);

    let setup = Setup {
        clock: true,
        ..Setup::default()
    };
    let _nodes = Nodes::start(setup);
    match timing(&["vcan0,vcan1", "--pace", "clock"]) {
        Ok(kept) => {
            let (timed, missed) = counts(&kept, "SYNC to the last torque");
            assert_eq!(kept["cycles"], timed + missed);
            let (late, _) = counts(&kept, "lateness of SYNC");
            assert!((timed..=TIMED).contains(&late), "{late} of {timed}");
            assert!(kept["scheduling"].is_string());
            for times in &drives_times(&kept) {
                assert_timed(times);
            }
        }
        // The guest has one processor, and its host other work.
        Err(told) => {
            println!("the clock was not kept: {told}");
            assert!(told.starts_with("quadrant: axis "), "{told}");
        }
    }
}
