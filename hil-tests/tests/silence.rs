//! What a drive does when the bus is silent: one frame once, one in a hundred, one in twenty, or
//! whatever dies.
//!
//! Every row of `golden/silence.md` is a run compared with the same run without the losses, on the
//! reference axis with its noise. The rows over vcan run in a kernel that has it
//! (`scripts/with-vcan`), every node a process of its own.

use std::collections::BTreeMap;
use std::process::{Child, Command};
use std::time::Duration;

use bus::{BusLog, Damage, FaultPlan};
use hil_tests::losses::{Axis, Extremes, Plans, Run, Watched, largest_difference, noisy_axis, run};
use hil_tests::matrix::{self, Row};
use hil_tests::paths::{Phase, Profile, reversal, sine};
use hil_tests::{Scope, on_all_cores, program};
use protocol::cob::{AxisIds, FrameKind};
use protocol::message::{Decoded, decode};
use protocol::sdo::Address;
use protocol::states::DriveState;
use protocol::{Message, SyncCounter};
use quadrant_host::Pace;
use workbench::compensation::AxisCompensation;
use workbench::network::interfaces::Interfaces;
use workbench::network::link::Link;
use workbench::network::master::Master;

/// Force limit of the reference axis in % of which torque differences are told.
const FORCE_LIMIT_N: f64 = 9000.0;

type Path = fn(f64) -> f64;

/// Up to 50 mm/s with a jerk of 50 m/s³, and on.
fn constant(time_s: f64) -> f64 {
    let rise = 0.001_f64.sqrt();
    Profile::new(&[
        Phase::Jerk(0.05, 0.0),
        Phase::Jerk(rise, 50.0),
        Phase::Jerk(rise, -50.0),
    ])
    .at(time_s)
}

/// Back to −180 mm/s, then up: 0.27 s to 0.37 s the jerk phase, until 0.4 s at 5 m/s².
fn fast(time_s: f64) -> f64 {
    let back = [
        Phase::Jerk(0.05, 0.0),
        Phase::Jerk(0.06, -50.0),
        Phase::Jerk(0.06, 50.0),
        Phase::Jerk(0.1, 0.0),
    ];
    let up = [
        Phase::Jerk(0.1, 50.0),
        Phase::Jerk(0.03, 0.0),
        Phase::Jerk(0.1, -50.0),
    ];
    Profile::new(&[back.as_slice(), up.as_slice()].concat()).at(time_s)
}

/// X of R 100 F 2000, from one second before its reversal, which comes at 1.25 s.
fn turn(time_s: f64) -> f64 {
    reversal(0.1, 6.0 * std::f64::consts::PI, 1.0, 0.5, time_s)
}

/// 50 mm/s, and at 0.3 s suddenly 5 m/s² for 10 ms.
fn short_step(time_s: f64) -> f64 {
    step_of(0.010).at(time_s)
}

/// The same for 60 ms.
fn long_step(time_s: f64) -> f64 {
    step_of(0.060).at(time_s)
}

fn step_of(duration_s: f64) -> Profile {
    let rise = 0.001_f64.sqrt();
    let to_50 = [
        Phase::Jerk(0.05, 0.0),
        Phase::Jerk(rise, 50.0),
        Phase::Jerk(rise, -50.0),
    ];
    let steps = [
        Phase::Jerk(0.25 - 2.0 * rise, 0.0),
        Phase::Jump(5.0),
        Phase::Jerk(duration_s, 0.0),
        Phase::Jump(-5.0),
    ];
    Profile::new(&[to_50.as_slice(), steps.as_slice()].concat())
}

/// 105 mm/s and 0.55 m/s² at most.
fn quick_sine(time_s: f64) -> f64 {
    sine(0.020, 1.2, 0.5, time_s)
}

/// X of R 100 F 2000.
fn circle(time_s: f64) -> f64 {
    sine(0.1, 6.0 * std::f64::consts::PI, 1.0, time_s)
}

/// What can be lost: its name, the frame, and whether it is the servo that does not get it.
const LOSSES: [(&str, FrameKind, bool); 5] = [
    ("SYNC lost at the servo", FrameKind::Sync, true),
    ("SYNC lost at the plant", FrameKind::Sync, false),
    ("setpoint lost", FrameKind::Setpoint, true),
    ("feedback lost", FrameKind::Feedback, true),
    ("torque lost", FrameKind::Torque, false),
];

fn once(kind: FrameKind, at_servo: bool, cycle: u32, damage: Damage) -> Plans {
    let plan = FaultPlan {
        once: Some((kind, cycle, damage)),
        ..FaultPlan::default()
    };
    if at_servo {
        Plans {
            servo: plan,
            ..Plans::default()
        }
    } else {
        Plans {
            plant: plan,
            ..Plans::default()
        }
    }
}

fn row(name: String, base: &Run, hit: &Run) -> Row {
    let path_um = 1.0e6 * largest_difference(&base.table_m, &hit.table_m);
    let torque = 100.0 * largest_difference(&base.force_n, &hit.force_n) / FORCE_LIMIT_N;
    assert_eq!(
        [hit.servo.cycles(), hit.plant.cycles()],
        [hit.table_m.len() as u32; 2],
        "{name}: cycles counted"
    );
    let counts = [
        hit.faults.len() as u32,
        hit.servo.bridged,
        hit.plant.bridged,
        hit.servo.refused,
        hit.plant.refused,
        hit.servo.by_deadline,
        hit.plant.by_deadline,
    ];
    let cells = [path_um, torque]
        .into_iter()
        .chain(counts.map(f64::from))
        .map(Some)
        .collect();
    Row {
        name,
        cells,
        repeats: true,
    }
}

fn cell(row: &Row, column: usize) -> f64 {
    row.cells[column].unwrap()
}

/// Where a loss hits a path: at any of these cycles of the path (the worst is told), and what is
/// allowed.
struct Hit {
    name: &'static str,
    path: Path,
    cycles: std::ops::Range<u32>,
    path_um: f64,
    torque: f64,
}

const SMOOTH: [Hit; 5] = [
    Hit {
        name: "constant 50 mm/s",
        path: constant,
        cycles: 400..401,
        path_um: 1.0,
        torque: 5.0,
    },
    Hit {
        name: "jerk of 50 m/s³",
        path: fast,
        cycles: 300..301,
        path_um: 1.0,
        torque: 5.0,
    },
    Hit {
        name: "begin of that jerk",
        path: fast,
        cycles: 268..274,
        path_um: 1.0,
        torque: 5.0,
    },
    Hit {
        name: "at 5 m/s²",
        path: fast,
        cycles: 385..386,
        path_um: 1.0,
        torque: 5.0,
    },
    Hit {
        name: "reversal of R 100 F 2000",
        path: turn,
        cycles: 1248..1254,
        path_um: 1.0,
        torque: 5.0,
    },
];

/// A lost setpoint at a step costs up to three quarters of a cycle's speed (3.75 mm/s) until the
/// drive has caught up: it may do a tenth more than a path (`workbench::drive_parameters`).
const STEPS: [Hit; 3] = [
    Hit {
        name: "step of 5 m/s² for 10 ms",
        path: short_step,
        cycles: 298..306,
        path_um: 25.0,
        torque: 100.0,
    },
    Hit {
        name: "step of 5 m/s² for 60 ms",
        path: long_step,
        cycles: 298..306,
        path_um: 25.0,
        torque: 100.0,
    },
    Hit {
        name: "end of that step",
        path: long_step,
        cycles: 357..366,
        path_um: 25.0,
        torque: 100.0,
    },
];

/// The worst row over the cycles of a hit. The setpoint of a cycle of the path is sent in the cycle
/// before it.
fn worst(hit: &Hit, what: &str, kind: FrameKind, at_servo: bool, damage: Damage) -> Row {
    let (machine, cycles) = (noisy_axis(), hit.cycles.end + 300);
    let base = run(&machine, &hit.path, cycles, Plans::default());
    let rows = hit.cycles.clone().map(|cycle| {
        let cycle = if kind == FrameKind::Setpoint {
            cycle + 1
        } else {
            cycle + 2
        };
        let plans = once(kind, at_servo, cycle, damage);
        row(
            format!("{}, {what}", hit.name),
            &base,
            &run(&machine, &hit.path, cycles, plans),
        )
    });
    rows.max_by(|a, b| cell(a, 0).total_cmp(&cell(b, 0)))
        .unwrap()
}

fn single_losses() -> Vec<Row> {
    let cases: Vec<_> = SMOOTH
        .iter()
        .chain(&STEPS)
        .flat_map(|hit| LOSSES.map(|loss| (hit, loss)))
        .collect();
    on_all_cores(&cases, |(hit, (what, kind, at_servo))| {
        let row = worst(hit, what, *kind, *at_servo, Damage::Lost);
        let (path_um, torque, faults) = (cell(&row, 0), cell(&row, 1), cell(&row, 2));
        assert!(
            path_um <= hit.path_um && torque <= hit.torque && faults == 0.0,
            "{row:?}"
        );
        assert!(
            cell(&row, 3) + cell(&row, 4) <= 1.0 && cell(&row, 7) + cell(&row, 8) <= 1.0,
            "{row:?}"
        );
        row
    })
}

/// A setpoint that is wrong, which nobody can tell by itself.
fn wrong_setpoints() -> Vec<Row> {
    let wrong = [("10 µm", 10), ("−10 µm", -10), ("1 µm", 1), ("−1 µm", -1)];
    let cases: Vec<_> = SMOOTH
        .iter()
        .flat_map(|hit| wrong.map(|wrong| (hit, wrong)))
        .collect();
    on_all_cores(&cases, |(hit, (by, micrometres))| {
        let damage = Damage::Setpoint(micrometres * 25_600);
        let row = worst(
            hit,
            &format!("setpoint wrong by {by}"),
            FrameKind::Setpoint,
            true,
            damage,
        );
        assert!(
            cell(&row, 0) <= hit.path_um && cell(&row, 1) <= hit.torque && cell(&row, 2) == 0.0,
            "{row:?}"
        );
        row
    })
}

const PATHS: [(&str, Path); 2] = [("sine of 105 mm/s", quick_sine), ("R 100 F 2000", circle)];
const DAMAGES: [&str; 5] = [
    "lost",
    "doubled",
    "late",
    "corrupted",
    "lost, doubled, late, corrupted each",
];

/// Shares of the damages of the list above.
fn plan(damage: usize, per_mille: u16, seed: u64) -> FaultPlan {
    let share = |of: usize| {
        if damage == of || damage == 4 {
            per_mille
        } else {
            0
        }
    };
    FaultPlan {
        seed,
        lost_per_mille: share(0),
        doubled_per_mille: share(1),
        late_per_mille: share(2),
        corrupted_per_mille: share(3),
        ..FaultPlan::default()
    }
}

const MANY: u32 = 20_000;

/// Seed 1 of every row, and the worst of ten where the scope runs them.
fn seeds() -> Vec<u64> {
    (1..=Scope::now().pick(1, 1, 10)).collect()
}

fn one_percent() -> Vec<Row> {
    let bases = on_all_cores(&PATHS, |(_, path)| {
        run(&noisy_axis(), path, MANY, Plans::default())
    });
    let cases: Vec<_> = (0..PATHS.len())
        .flat_map(|path| {
            (0..DAMAGES.len())
                .flat_map(move |damage| seeds().into_iter().map(move |seed| (path, damage, seed)))
        })
        .collect();
    let rows = on_all_cores(&cases, |(path, damage, seed)| {
        let (plan, (name, at)) = (plan(*damage, 10, *seed), PATHS[*path]);
        let hit = run(
            &noisy_axis(),
            &at,
            MANY,
            Plans {
                servo: plan,
                plant: plan,
            },
        );
        let row = row(
            format!("1 % {}: {name}, seed {seed}", DAMAGES[*damage]),
            &bases[*path],
            &hit,
        );
        assert!(hit.faults.is_empty(), "{}: {:?}", row.name, hit.faults);
        assert!(cell(&row, 0) <= 5.0, "{row:?}");
        // Three kinds of frames at the servo, two at the plant, and 400 heartbeats.
        assert!(
            (800..6000).contains(&hit.injected),
            "{}: {} frames went wrong",
            row.name,
            hit.injected
        );
        row
    });
    rows.chunks(seeds().len())
        .flat_map(first_and_worst)
        .collect()
}

fn first_and_worst(rows: &[Row]) -> Vec<Row> {
    let worst = rows
        .iter()
        .max_by(|a, b| cell(a, 0).total_cmp(&cell(b, 0)))
        .filter(|_| rows.len() > 1);
    let name = |row: &Row| row.name.split(", seed").next().unwrap().to_owned();
    let worst = worst.map(|row| Row {
        name: format!("{}, worst of ten seeds", name(row)),
        ..row.clone()
    });
    rows.first().cloned().into_iter().chain(worst).collect()
}

/// A latched fault is reset, and the path begins anew where the axis is and towards the middle, as
/// an operator would have it; gives how often.
fn survive(axis: &mut Axis, path: Path) -> u32 {
    let (mut faults, mut begun, mut sense) = (0, 0, 1.0);
    for cycle in 0..MANY {
        axis.cycle(sense * path(1.0e-3 * f64::from(cycle - begun)));
        if axis.servo.borrow().drive().state() == DriveState::Fault {
            assert!(
                (0..20).any(|_| axis.enable_again()),
                "cycle {cycle}: cannot be enabled any more"
            );
            (faults, begun) = (faults + 1, cycle + 1);
            sense = if axis.master.axis(0).reference_m > 0.0 {
                -1.0
            } else {
                1.0
            };
        }
    }
    faults
}

fn five_percent() -> Vec<Row> {
    let cases: Vec<_> = (0..DAMAGES.len())
        .flat_map(|damage| seeds().into_iter().map(move |seed| (damage, seed)))
        .collect();
    let rows = on_all_cores(&cases, |(damage, seed)| {
        let mut axis = Axis::enabled(&noisy_axis());
        let seen = Watched::replace(&mut axis);
        let plan = plan(*damage, 50, *seed);
        axis.inject(Plans {
            servo: plan,
            plant: plan,
        });
        let faults = survive(&mut axis, quick_sine);
        let name = format!("5 % {}: {}, seed {seed}", DAMAGES[*damage], PATHS[0].0);
        println!("{name}: {faults} faults");
        keeps_limits(&name, *seen.borrow());
        Row {
            name,
            cells: [None, None, Some(f64::from(faults))]
                .into_iter()
                .chain([None; 6])
                .collect(),
            repeats: true,
        }
    });
    rows.chunks(seeds().len())
        .filter_map(|rows| rows.first().cloned())
        .collect()
}

/// 0.5 m/s, 5.5 m/s² (and 12 bits of rounding), 0.25 m, 9 kN at 10 mm per revolution.
fn keeps_limits(name: &str, seen: Extremes) {
    println!("{name}: {seen:?}");
    assert!(seen.cycles > MANY / 2, "{name}: {seen:?}");
    assert!(
        seen.velocity <= 50_000.01 && seen.acceleration <= 550.1 && seen.position <= 25_000_000.0,
        "{name}: {seen:?}"
    );
    assert!(
        seen.torque <= FORCE_LIMIT_N * 0.010 / std::f64::consts::TAU * 1.0e6 + 1.0,
        "{name}: {seen:?}"
    );
    // It is the drive at work, not one that stands still.
    assert!(
        seen.velocity > 10_000.0 && seen.torque > 1.0e5,
        "{name}: {seen:?}"
    );
}

/// Rows over vcan in the order in which a scope takes them: seed,lost,doubled,late,corrupted per
/// mille, from a cycle after the axis was enabled.
const OVER_VCAN: [(&str, &str); 5] = [
    ("1 % lost", "1,10,0,0,0,100"),
    ("1 % doubled", "1,0,10,0,0,100"),
    ("1 % late", "1,0,0,10,0,100"),
    ("1 % corrupted", "1,0,0,0,10,100"),
    (
        "1 % lost, doubled, late, corrupted each",
        "1,10,10,10,10,100",
    ),
];
const OVER_VCAN_CYCLES: u32 = 5000;
/// Long enough for a process to get its turn, short enough for a test.
const DEADLINE: Duration = Duration::from_millis(20);

/// Node processes of axis X; they end with the value.
struct Nodes(Vec<Child>);

impl Nodes {
    fn start(faults: Option<&str>) -> Self {
        let program =
            std::env::var_os("QUADRANT_PROGRAM").expect("rows_over_vcan says where the program is");
        let node = |arguments: &[&str]| {
            let mut command = Command::new(&program);
            command.args(arguments).args([
                "--can",
                "vcan0",
                "--deadline-ms",
                &DEADLINE.as_millis().to_string(),
            ]);
            command
                .args(faults.into_iter().flat_map(|plan| ["--faults", plan]))
                .spawn()
                .unwrap()
        };
        let nodes = Self(vec![
            node(&["plant", "--node", "0x11"]),
            node(&["servo", "--node", "1", "--plant-node", "0x11"]),
        ]);
        // They say nothing before they are asked; give them time to open their sockets.
        std::thread::sleep(Duration::from_secs(1));
        nodes
    }
}

impl Drop for Nodes {
    fn drop(&mut self) {
        for node in &mut self.0 {
            let _ = node.kill();
            let _ = node.wait();
        }
    }
}

/// A run over vcan as its frames tell it: load scale in 10 nm and torque in µN·m of each cycle, the
/// counts of the servo, and its fault.
struct Cable {
    load: Vec<f64>,
    torque: Vec<f64>,
    counts: [f64; 4],
    fault: Option<protocol::Fault>,
}

fn over_cable(faults: Option<&str>) -> Cable {
    let (machine, _nodes) = (noisy_axis(), Nodes::start(faults));
    let mut link = Interfaces::open(&machine, "vcan0")
        .unwrap()
        .with_pace(Pace::Lockstep { deadline: DEADLINE });
    link.start_log();
    let mut master = Master::start(link, &machine).unwrap();
    master
        .configure(&machine, &[AxisCompensation::default()])
        .unwrap();
    master.enable().unwrap();
    let origin_m = master.axis(0).reference_m;
    for cycle in 0..OVER_VCAN_CYCLES {
        master
            .cycle(&[origin_m + quick_sine(1.0e-3 * f64::from(cycle))])
            .unwrap();
    }
    let counts = [1, 2, 3, 4]
        .map(|at| f64::from(master.upload(0, Address::new(0x2200, at)).unwrap().to_u32()));
    let (fault, mut link) = (master.fault(0), master.into_link());
    let (load, torque) = cycles_of(&link.take_logs().remove(0));
    Cable {
        load,
        torque,
        counts,
        fault,
    }
}

/// Load scale and torque of each cycle, told by their counters: a plant that missed SYNC answers
/// late.
fn cycles_of(log: &BusLog) -> (Vec<f64>, Vec<f64>) {
    let ids = AxisIds::of_axis(0).unwrap();
    let (mut load, mut torque): (BTreeMap<u32, f64>, BTreeMap<u32, f64>) =
        (BTreeMap::new(), BTreeMap::new());
    let (mut cycle, mut now, mut scale) = (0_u32, None, None);
    for (_, frame) in log.frames() {
        let Ok(Decoded::Message(message)) = decode(ids, frame) else {
            continue;
        };
        // The cycle of a counter near the present SYNC.
        let of = |counter: SyncCounter| {
            let ahead = i64::from(now.map_or(0, |now| counter.cycles_since(now)));
            u32::try_from(i64::from(cycle) + if ahead > 120 { ahead - 240 } else { ahead }).unwrap()
        };
        match message {
            Message::Sync(counter) => (cycle, now) = (cycle + 1, Some(counter)),
            Message::Feedback(feedback) => {
                let before = scale.map_or((feedback.load, 0), |before| before);
                let counts: i64 = before.1 + i64::from(before.0.step_to(feedback.load));
                scale = Some((feedback.load, counts));
                load.insert(of(feedback.counter), counts as f64);
            }
            Message::Torque(frame) => {
                _ = torque.insert(of(frame.counter), f64::from(frame.torque.0));
            }
            _ => {}
        }
    }
    let all = |of: BTreeMap<u32, f64>| {
        (1..=cycle)
            .map(|cycle| of.get(&cycle).copied().unwrap_or(f64::NAN))
            .collect()
    };
    (all(load), all(torque))
}

#[test]
#[ignore = "run by a_drive_stays_calm_when_the_bus_does_not, in a kernel that has vcan"]
fn rows_over_vcan() {
    let base = over_cable(None);
    assert_eq!(
        base.counts[1..],
        [0.0; 3],
        "a run without losses closes no cycle by deadline"
    );
    for (name, plan) in Scope::now().rows("rows over vcan", &OVER_VCAN, 1, 1) {
        let hit = over_cable(Some(plan));
        let path_um = 0.01 * largest_difference(&base.load, &hit.load);
        let torque = largest_difference(&base.torque, &hit.torque) / 1.0e4 * std::f64::consts::TAU
            / 0.010
            / FORCE_LIMIT_N;
        let missing = |of: &[f64]| of.iter().filter(|value| value.is_nan()).count();
        let faults = u32::from(hit.fault.is_some());
        // For the parent: a line of the table.
        println!(
            "ROW|{name} over vcan: {}|{path_um}|{torque}|{faults}|{}|{}|{}",
            PATHS[0].0, hit.counts[1], hit.counts[2], hit.counts[3]
        );
        println!(
            "without a feedback {}, without a torque {}, {:?}",
            missing(&hit.load),
            missing(&hit.torque),
            hit.fault
        );
        assert!(
            path_um <= 5.0 && hit.fault.is_none(),
            "{name}: {path_um} µm, {:?}",
            hit.fault
        );
        assert_eq!(
            hit.counts[..3].iter().sum::<f64>(),
            hit.load.len() as f64,
            "{name}: cycles counted"
        );
    }
}

/// Runs the rows over vcan in a kernel that has it; gives what it printed.
fn over_vcan() -> Vec<Row> {
    let target = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .unwrap();
    let out = program::ignored_tests_under_vcan(target, &["--exact", "rows_over_vcan"], &[]);
    assert!(out.contains("1 passed"), "the rows over vcan did not run");
    out.lines()
        .filter_map(|line| line.split_once("ROW|"))
        .map(|(_, line)| printed(line))
        .collect()
}

fn printed(line: &str) -> Row {
    let (name, cells) = line.trim().split_once('|').unwrap();
    let cells: Vec<Option<f64>> = cells
        .split('|')
        .map(|cell| Some(cell.parse().unwrap()))
        .collect();
    let [path, torque, faults, bridged, refused, late] = cells[..] else {
        panic!("{line}")
    };
    let cells = vec![
        path, torque, faults, bridged, None, refused, None, late, None,
    ];
    Row {
        name: name.to_owned(),
        cells,
        repeats: false,
    }
}

#[test]
fn a_drive_stays_calm_when_the_bus_does_not() {
    let scope = Scope::now();
    let cable = if scope == Scope::Quick {
        Vec::new()
    } else {
        over_vcan()
    };
    let rows = [
        single_losses(),
        wrong_setpoints(),
        one_percent(),
        five_percent(),
        cable,
    ]
    .concat();
    let is_meant =
        |name: &str| scope.is_complete() || !(name.contains("vcan") || name.contains("ten seeds"));
    matrix::check("silence", &rows, &is_meant);
}
