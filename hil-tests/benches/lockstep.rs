//! Lock-step cycles per second over vcan, beside a bare relay of the same processes, filters and
//! frames with no computation in it, and the raw ping-pong of two sockets; all in one run. `cargo
//! bench -p hil-tests --bench lockstep` gets a vcan by itself (`scripts/with-vcan`).
//!
//! The program is its own node: `--relay NODE` runs one of the relay's processes, which answers
//! frames with frames of the same identifiers and lengths.

use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use bus::CanPort;
use embedded_can::{Frame, Id, StandardId};
use hil_tests::rig::shared_bus;
use protocol::CanFrame;
use protocol::cob::{AxisIds, FrameKind, HEARD_BY_PLANT, HEARD_BY_SERVO};
use workbench::compensation::AxisCompensation;
use workbench::network::interfaces::Interfaces;
use workbench::network::link::axis_ids;
use workbench::network::master::Master;

const CYCLES: u32 = 5000;
const ROUNDS: usize = 5;
const PATIENCE: Duration = Duration::from_secs(2);

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|argument| argument == "--relay") {
        Some(at) => relay_node(&arguments[at + 1]),
        None if std::env::var_os("VCAN").is_some() => measure(),
        None => with_vcan(),
    }
}

/// Builds the program and starts this benchmark again where there is a vcan.
fn with_vcan() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let built = Command::new(env!("CARGO"))
        .args([
            "build",
            "--release",
            "--package",
            "workbench",
            "--bin",
            "quadrant",
        ])
        .current_dir(&root)
        .status();
    assert!(
        built.is_ok_and(|status| status.success()),
        "the program does not build"
    );
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let me = std::env::current_exe().expect("a program knows its path");
    let ran = Command::new(root.join("scripts/with-vcan"))
        .arg(me)
        .env("QUADRANT_PROGRAM", target.join("release/quadrant"))
        .status();
    assert!(
        ran.is_ok_and(|status| status.success()),
        "the benchmark did not run under vcan"
    );
}

struct Processes(Vec<Child>);

impl Drop for Processes {
    fn drop(&mut self) {
        for process in &mut self.0 {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

fn spawn(program: &PathBuf, arguments: &[&[&str]]) -> Processes {
    let start = |arguments: &&[&str]| {
        Command::new(program)
            .args(*arguments)
            .spawn()
            .expect("the node starts")
    };
    let processes = Processes(arguments.iter().map(start).collect());
    std::thread::sleep(Duration::from_millis(500));
    processes
}

fn measure() {
    let load = shared_bus().bus_load_per_mille();
    let (mut real, mut bare, mut raw) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        real.push(quadrant());
        bare.push(relay());
        raw.push(ping_pong());
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let ratios: Vec<f64> = real
        .iter()
        .zip(&bare)
        .map(|(real, bare)| real / bare)
        .collect();
    let (low, high) = ratios.iter().fold((f64::MAX, 0.0_f64), |(low, high), r| {
        (low.min(*r), high.max(*r))
    });
    let ratio = median(&mut ratios.clone());
    println!(
        "two axes, five processes on vcan0, median of {ROUNDS} rounds in one run      per second"
    );
    println!(
        "lock-step cycles of Quadrant                                    {:>16.0}",
        median(&mut real)
    );
    println!(
        "cycles of the bare relay                                        {:>16.0}",
        median(&mut bare)
    );
    println!(
        "round trips of two sockets                                      {:>16.0}",
        median(&mut raw)
    );
    println!("Quadrant over relay: {ratio:.2} ({low:.2} to {high:.2}), wanted 0.70");
    println!(
        "computed bus load of both axes on one classic bus at 1 kHz: {}.{} %",
        load / 10,
        load % 10
    );
}

fn quadrant() -> f64 {
    let program = std::env::var_os("QUADRANT_PROGRAM")
        .expect("with_vcan says where the program is")
        .into();
    let _nodes = spawn(
        &program,
        &[
            &["plant", "--node", "0x11", "--can", "vcan0"],
            &[
                "servo",
                "--node",
                "1",
                "--plant-node",
                "0x11",
                "--can",
                "vcan0",
            ],
            &["plant", "--node", "0x12", "--can", "vcan0"],
            &[
                "servo",
                "--node",
                "2",
                "--plant-node",
                "0x12",
                "--can",
                "vcan0",
            ],
        ],
    );
    let machine = shared_bus();
    let link = Interfaces::open(&machine, "vcan0").expect("vcan0 is there");
    let mut master = Master::start(link, &machine).expect("the nodes answer");
    master
        .configure(&machine, &vec![AxisCompensation::default(); 2])
        .expect("the drives take their parameters");
    master.enable().expect("the drives come up");
    let begun = Instant::now();
    for cycle in 0..CYCLES {
        let x = 0.01 * (1.0 - (1.0e-3 * f64::from(cycle)).cos());
        master.cycle(&[x, x]).expect("vcan0 takes every frame");
    }
    let run = master.expect_enabled();
    run.expect("axes that the drives have stopped are no closed loop");
    f64::from(CYCLES) / begun.elapsed().as_secs_f64()
}

fn standard(frame: &CanFrame) -> Option<StandardId> {
    match frame.id() {
        Id::Standard(id) => Some(id),
        Id::Extended(_) => None,
    }
}

fn ids(axis: usize) -> AxisIds {
    axis_ids(axis).expect("two axes")
}

/// A node of the relay: the plant answers SYNC with a feedback, the servo answers a feedback with a
/// torque (and every tenth time a status).
fn relay_node(node: &str) {
    let (role, axis) = node.split_at(1);
    let ids = ids(axis.parse().expect("an axis index"));
    let id = |kind: FrameKind| ids.identifier(kind);
    // The same filters as the real nodes.
    let heard = if role == "p" {
        &HEARD_BY_PLANT[..]
    } else {
        &HEARD_BY_SERVO[..]
    };
    let accepted: Vec<StandardId> = heard.iter().map(|kind| id(*kind)).collect();
    let port = CanPort::open("vcan0", &accepted).expect("vcan0 is there");
    let (mut feedbacks, mut answers) = (0_u32, Vec::new());
    while let Ok(received) = port.receive(PATIENCE) {
        let Some(frame) = received else { continue };
        match (role, standard(&frame)) {
            ("p", Some(sync)) if sync == id(FrameKind::Sync) => {
                answers.push(CanFrame::full(id(FrameKind::Feedback), [0; 8]));
            }
            ("s", Some(feedback)) if feedback == id(FrameKind::Feedback) => {
                answers.push(CanFrame::of(id(FrameKind::Torque), [0; 7]));
                if feedbacks.is_multiple_of(10) {
                    answers.push(CanFrame::full(id(FrameKind::Status), [0; 8]));
                }
                feedbacks += 1;
            }
            _ => {}
        }
        for frame in answers.drain(..) {
            port.send(&frame).expect("vcan0 takes every frame");
        }
    }
}

fn relay() -> f64 {
    let me = std::env::current_exe().expect("a program knows its path");
    let _nodes = spawn(
        &me,
        &[
            &["--relay", "p0"],
            &["--relay", "s0"],
            &["--relay", "p1"],
            &["--relay", "s1"],
        ],
    );
    let port = CanPort::open("vcan0", &[]).expect("vcan0 is there");
    let torques = [0, 1].map(|axis| ids(axis).identifier(FrameKind::Torque));
    let begun = Instant::now();
    for _ in 0..CYCLES {
        port.send(&CanFrame::of(ids(0).identifier(FrameKind::Sync), [1]))
            .expect("vcan0 takes every frame");
        for axis in 0..2 {
            port.send(&CanFrame::full(
                ids(axis).identifier(FrameKind::Setpoint),
                [0; 8],
            ))
            .expect("vcan0 takes every frame");
        }
        let mut seen = 0;
        while seen < 2 {
            let frame = port
                .receive(PATIENCE)
                .expect("vcan0 stays")
                .expect("the relay answers");
            seen += usize::from(standard(&frame).is_some_and(|id| torques.contains(&id)));
        }
    }
    f64::from(CYCLES) / begun.elapsed().as_secs_f64()
}

/// Two sockets in two threads: the least that a round trip costs.
fn ping_pong() -> f64 {
    let (ping, pong) = (
        ids(0).identifier(FrameKind::Sync),
        ids(0).identifier(FrameKind::Feedback),
    );
    let other = std::thread::spawn(move || {
        let port = CanPort::open("vcan0", &[ping]).expect("vcan0 is there");
        for _ in 0..CYCLES {
            if port.receive(PATIENCE).ok().flatten().is_none() {
                return;
            }
            port.send(&CanFrame::full(pong, [0; 8]))
                .expect("vcan0 takes every frame");
        }
    });
    let port = CanPort::open("vcan0", &[pong]).expect("vcan0 is there");
    std::thread::sleep(Duration::from_millis(200));
    let begun = Instant::now();
    for _ in 0..CYCLES {
        port.send(&CanFrame::of(ping, [1]))
            .expect("vcan0 takes every frame");
        port.receive(PATIENCE)
            .expect("vcan0 stays")
            .expect("the other socket answers");
    }
    let rate = f64::from(CYCLES) / begun.elapsed().as_secs_f64();
    other.join().expect("the other thread ends");
    rate
}
