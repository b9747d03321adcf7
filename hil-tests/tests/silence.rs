//! What a drive does when the bus is silent: one frame once, one in a hundred, one in twenty, or whatever dies.
//!
//! Every row of `golden/silence.md` is a run compared with the same run without the losses, on the reference axis with its noise. The rows over
//! vcan run in a kernel that has it (`scripts/with-vcan`), every node a process of its own.

use bus::{Damage, FaultPlan};
use hil_tests::losses::{Axis, Extremes, Plans, Run, Watched, largest_difference, noisy_axis, run};
use hil_tests::matrix::{self, Row};
use hil_tests::paths::{Phase, Profile, reversal, sine};
use hil_tests::{Scope, on_all_cores};
use plant_sim::Machine;
use protocol::cob::FrameKind;
use protocol::states::DriveState;

/// Force limit of the reference axis in % of which torque differences are told.
const FORCE_LIMIT_N: f64 = 9000.0;

type Path = fn(f64) -> f64;

/// Up to 50 mm/s with a jerk of 50 m/s³, and on.
fn constant(time_s: f64) -> f64 {
    let rise = 0.001_f64.sqrt();
    Profile::new(&[Phase::Jerk(0.05, 0.0), Phase::Jerk(rise, 50.0), Phase::Jerk(rise, -50.0)]).at(time_s)
}

/// Back to −180 mm/s, then up: 0.27 s to 0.37 s the jerk phase, until 0.4 s at 5 m/s².
fn fast(time_s: f64) -> f64 {
    let back = [Phase::Jerk(0.05, 0.0), Phase::Jerk(0.06, -50.0), Phase::Jerk(0.06, 50.0), Phase::Jerk(0.1, 0.0)];
    let up = [Phase::Jerk(0.1, 50.0), Phase::Jerk(0.03, 0.0), Phase::Jerk(0.1, -50.0)];
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
    let to_50 = [Phase::Jerk(0.05, 0.0), Phase::Jerk(rise, 50.0), Phase::Jerk(rise, -50.0)];
    let steps = [Phase::Jerk(0.25 - 2.0 * rise, 0.0), Phase::Jump(5.0), Phase::Jerk(duration_s, 0.0), Phase::Jump(-5.0)];
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
    let plan = FaultPlan { once: Some((kind, cycle, damage)), ..FaultPlan::default() };
    if at_servo { Plans { servo: plan, ..Plans::default() } } else { Plans { plant: plan, ..Plans::default() } }
}

fn row(name: String, base: &Run, hit: &Run) -> Row {
    let path_um = 1.0e6 * largest_difference(&base.table_m, &hit.table_m);
    let torque = 100.0 * largest_difference(&base.force_n, &hit.force_n) / FORCE_LIMIT_N;
    assert_eq!([hit.servo.cycles(), hit.plant.cycles()], [hit.table_m.len() as u32; 2], "{name}: cycles counted");
    let counts = [
        hit.faults.len() as u32,
        hit.servo.bridged,
        hit.plant.bridged,
        hit.servo.refused,
        hit.plant.refused,
        hit.servo.by_deadline,
        hit.plant.by_deadline,
    ];
    let cells = [path_um, torque].into_iter().chain(counts.map(f64::from)).map(Some).collect();
    Row { name, cells, repeats: true }
}

fn cell(row: &Row, column: usize) -> f64 {
    row.cells[column].unwrap()
}

/// Where a loss hits a path: at any of these cycles of the path (the worst is told), and what is allowed.
struct Hit {
    name: &'static str,
    path: Path,
    cycles: std::ops::Range<u32>,
    path_um: f64,
    torque: f64,
    /// Acceleration limit of the axis, m/s².
    limit: f64,
}

const SMOOTH: [Hit; 5] = [
    Hit { name: "constant 50 mm/s", path: constant, cycles: 400..401, path_um: 1.0, torque: 5.0, limit: 5.0 },
    Hit { name: "jerk of 50 m/s³", path: fast, cycles: 300..301, path_um: 1.0, torque: 5.0, limit: 5.0 },
    Hit { name: "begin of that jerk", path: fast, cycles: 268..274, path_um: 1.0, torque: 5.0, limit: 5.0 },
    Hit { name: "at 5 m/s²", path: fast, cycles: 385..386, path_um: 1.0, torque: 5.0, limit: 5.0 },
    Hit { name: "reversal of R 100 F 2000", path: turn, cycles: 1248..1254, path_um: 1.0, torque: 5.0, limit: 5.0 },
];

/// A path that takes all that the axis may leaves nothing to catch up with before the acceleration ends: a lost setpoint costs up to three quarters of a cycle's
/// speed (3.75 mm/s) for so long. A tenth of reserve keeps it within the bound.
const STEPS: [Hit; 6] = [
    Hit { name: "step of 5 m/s² for 10 ms, limit 5.5 m/s²", path: short_step, cycles: 298..306, path_um: 25.0, torque: 100.0, limit: 5.5 },
    Hit { name: "step of 5 m/s² for 60 ms, limit 5.5 m/s²", path: long_step, cycles: 298..306, path_um: 25.0, torque: 100.0, limit: 5.5 },
    Hit { name: "end of that step, limit 5.5 m/s²", path: long_step, cycles: 357..366, path_um: 25.0, torque: 100.0, limit: 5.5 },
    Hit { name: "step of 5 m/s² for 10 ms, limit 5 m/s²", path: short_step, cycles: 298..306, path_um: 45.0, torque: 100.0, limit: 5.0 },
    Hit { name: "step of 5 m/s² for 60 ms, limit 5 m/s²", path: long_step, cycles: 298..306, path_um: 170.0, torque: 100.0, limit: 5.0 },
    Hit { name: "end of that step, limit 5 m/s²", path: long_step, cycles: 357..366, path_um: 25.0, torque: 100.0, limit: 5.0 },
];

fn machine_of(hit: &Hit) -> Machine {
    let mut machine = noisy_axis();
    machine.axes.iter_mut().for_each(|axis| axis.limits.acceleration_m_per_s2 = hit.limit);
    machine
}

/// The worst row over the cycles of a hit. The setpoint of a cycle of the path is sent in the cycle before it.
fn worst(hit: &Hit, what: &str, kind: FrameKind, at_servo: bool, damage: Damage) -> Row {
    let (machine, cycles) = (machine_of(hit), hit.cycles.end + 300);
    let base = run(&machine, &hit.path, cycles, Plans::default());
    let rows = hit.cycles.clone().map(|cycle| {
        let cycle = if kind == FrameKind::Setpoint { cycle + 1 } else { cycle + 2 };
        let plans = once(kind, at_servo, cycle, damage);
        row(format!("{}, {what}", hit.name), &base, &run(&machine, &hit.path, cycles, plans))
    });
    rows.max_by(|a, b| cell(a, 0).total_cmp(&cell(b, 0))).unwrap()
}

fn single_losses() -> Vec<Row> {
    let cases: Vec<_> = SMOOTH.iter().chain(&STEPS).flat_map(|hit| LOSSES.map(|loss| (hit, loss))).collect();
    on_all_cores(&cases, |(hit, (what, kind, at_servo))| {
        let row = worst(hit, what, *kind, *at_servo, Damage::Lost);
        let (path_um, torque, faults) = (cell(&row, 0), cell(&row, 1), cell(&row, 2));
        assert!(path_um <= hit.path_um && torque <= hit.torque && faults == 0.0, "{row:?}");
        assert!(cell(&row, 3) + cell(&row, 4) <= 1.0 && cell(&row, 7) + cell(&row, 8) <= 1.0, "{row:?}");
        row
    })
}

/// A setpoint that is wrong, which nobody can tell by itself.
fn wrong_setpoints() -> Vec<Row> {
    let wrong = [("10 µm", 10), ("−10 µm", -10), ("1 µm", 1), ("−1 µm", -1)];
    let cases: Vec<_> = SMOOTH.iter().flat_map(|hit| wrong.map(|wrong| (hit, wrong))).collect();
    on_all_cores(&cases, |(hit, (by, micrometres))| {
        let damage = Damage::Setpoint(micrometres * 25_600);
        let row = worst(hit, &format!("setpoint wrong by {by}"), FrameKind::Setpoint, true, damage);
        assert!(cell(&row, 0) <= hit.path_um && cell(&row, 1) <= hit.torque && cell(&row, 2) == 0.0, "{row:?}");
        row
    })
}

const PATHS: [(&str, Path); 2] = [("sine of 105 mm/s", quick_sine), ("R 100 F 2000", circle)];
const DAMAGES: [&str; 5] = ["lost", "doubled", "late", "corrupted", "lost, doubled, late, corrupted each"];

/// Shares of the damages of the list above.
fn plan(damage: usize, per_mille: u16, seed: u64) -> FaultPlan {
    let share = |of: usize| if damage == of || damage == 4 { per_mille } else { 0 };
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
    let bases = on_all_cores(&PATHS, |(_, path)| run(&noisy_axis(), path, MANY, Plans::default()));
    let cases: Vec<_> = (0..PATHS.len())
        .flat_map(|path| (0..DAMAGES.len()).flat_map(move |damage| seeds().into_iter().map(move |seed| (path, damage, seed))))
        .collect();
    let rows = on_all_cores(&cases, |(path, damage, seed)| {
        let (plan, (name, at)) = (plan(*damage, 10, *seed), PATHS[*path]);
        let hit = run(&noisy_axis(), &at, MANY, Plans { servo: plan, plant: plan });
        let row = row(format!("1 % {}: {name}, seed {seed}", DAMAGES[*damage]), &bases[*path], &hit);
        assert!(hit.faults.is_empty(), "{}: {:?}", row.name, hit.faults);
        assert!(cell(&row, 0) <= 5.0, "{row:?}");
        row
    });
    rows.chunks(seeds().len()).flat_map(first_and_worst).collect()
}

fn first_and_worst(rows: &[Row]) -> Vec<Row> {
    let worst = rows.iter().max_by(|a, b| cell(a, 0).total_cmp(&cell(b, 0))).filter(|_| rows.len() > 1);
    let name = |row: &Row| row.name.split(", seed").next().unwrap().to_owned();
    let worst = worst.map(|row| Row { name: format!("{}, worst of ten seeds", name(row)), ..row.clone() });
    rows.first().cloned().into_iter().chain(worst).collect()
}

/// A latched fault is reset, and the path begins anew where the axis is and towards the middle, as an operator would have it; gives how often.
fn survive(axis: &mut Axis, path: Path) -> u32 {
    let (mut faults, mut begun, mut sense) = (0, 0, 1.0);
    for cycle in 0..MANY {
        axis.cycle(sense * path(1.0e-3 * f64::from(cycle - begun)));
        if axis.servo.borrow().drive().state() == DriveState::Fault {
            assert!((0..20).any(|_| axis.enable_again()), "cycle {cycle}: cannot be enabled any more");
            (faults, begun) = (faults + 1, cycle + 1);
            sense = if axis.master.axis(0).reference_m > 0.0 { -1.0 } else { 1.0 };
        }
    }
    faults
}

fn five_percent() -> Vec<Row> {
    let cases: Vec<_> = (0..DAMAGES.len()).flat_map(|damage| seeds().into_iter().map(move |seed| (damage, seed))).collect();
    let rows = on_all_cores(&cases, |(damage, seed)| {
        let mut axis = Axis::enabled(&noisy_axis());
        let seen = Watched::replace(&mut axis);
        let plan = plan(*damage, 50, *seed);
        axis.inject(Plans { servo: plan, plant: plan });
        let faults = survive(&mut axis, quick_sine);
        let name = format!("5 % {}: {}, seed {seed}", DAMAGES[*damage], PATHS[0].0);
        keeps_limits(&name, *seen.borrow());
        Row { name, cells: [None, None, Some(f64::from(faults))].into_iter().chain([None; 6]).collect(), repeats: true }
    });
    rows.chunks(seeds().len()).filter_map(|rows| rows.first().cloned()).collect()
}

/// 0.5 m/s, 5 m/s² (and 12 bits of rounding), 0.25 m, 9 kN at 10 mm per revolution.
fn keeps_limits(name: &str, seen: Extremes) {
    println!("{name}: {seen:?}");
    assert!(seen.cycles > MANY / 2, "{name}: {seen:?}");
    assert!(seen.velocity <= 50_000.01 && seen.acceleration <= 500.1 && seen.position <= 25_000_000.0, "{name}: {seen:?}");
    assert!(seen.torque <= FORCE_LIMIT_N * 0.010 / std::f64::consts::TAU * 1.0e6 + 1.0, "{name}: {seen:?}");
    // It is the drive at work, not one that stands still.
    assert!(seen.velocity > 10_000.0 && seen.torque > 1.0e5, "{name}: {seen:?}");
}

#[test]
fn a_drive_stays_calm_when_the_bus_does_not() {
    let rows = [single_losses(), wrong_setpoints(), one_percent(), five_percent()].concat();
    let certify = Scope::now().is_complete();
    matrix::check("silence", &rows, &|name| !name.contains("vcan") && (certify || !name.contains("ten seeds")));
}
