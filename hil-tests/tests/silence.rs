use bus::{Damage, FaultPlan};
use hil_tests::on_all_cores;
use hil_tests::paths::{Phase, Profile, reversal, sine};
use hil_tests::rig::{PLANT, SERVO, enabled};
use plant_sim::Machine;
use protocol::cob::FrameKind;
use workbench::link::InProcess;
use workbench::master::Master;

fn noisy_axis() -> Machine {
    let mut machine = Machine::reference();
    machine.axes.truncate(1);
    machine
}

struct Row {
    name: &'static str,
    path: fn(f64) -> f64,
    loss: u32,
    cycles: u32,
}

fn constant(t: f64) -> f64 {
    let s = 0.001_f64.sqrt();
    Profile::new(&[Phase::Jerk(0.05, 0.0), Phase::Jerk(s, 50.0), Phase::Jerk(s, -50.0)]).at(t)
}
/// back at -0.3, then up
fn fast(t: f64) -> f64 {
    Profile::new(&[
        Phase::Jerk(0.05, 0.0),
        Phase::Jerk(0.06, -50.0),
        Phase::Jerk(0.06, 50.0),
        Phase::Jerk(0.1, 0.0),
        Phase::Jerk(0.1, 50.0),
        Phase::Jerk(0.03, 0.0),
        Phase::Jerk(0.1, -50.0),
    ])
    .at(t)
}
fn turn(t: f64) -> f64 {
    reversal(0.1, 6.0 * std::f64::consts::PI, 1.0, 0.5, t)
}
fn step_up(t: f64) -> f64 {
    Profile::new(&[
        Phase::Jerk(0.05, 0.0),
        Phase::Jump(1.0),
        Phase::Jerk(0.05, 0.0),
        Phase::Jump(-1.0),
        Phase::Jerk(0.2, 0.0),
        Phase::Jump(5.0),
        Phase::Jerk(0.06, 0.0),
        Phase::Jump(-5.0),
    ])
    .at(t)
}

struct Run {
    table: Vec<f64>,
    force: Vec<f64>,
    fault: Option<protocol::Fault>,
    servo: servo::watchdog::Counts,
    plant: plant_sim::node::Counters,
    refs: Vec<String>,
}

fn run(path: fn(f64) -> f64, cycles: u32, plans: &[(usize, FaultPlan)]) -> Run {
    let machine = noisy_axis();
    let mut master = enabled(&machine).unwrap();
    for (place, plan) in plans {
        master.link_mut().bus_mut(0).inject(*place, if *place == PLANT { 0x11 } else { 1 }, *plan);
    }
    let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
    let (s0, p0) = (servo.borrow().counts(), plant.borrow().counters());
    let mut run = Run { table: vec![], force: vec![], fault: None, servo: s0, plant: p0, refs: vec![] };
    let at = master.axis(0).reference_m;
    for cycle in 0..cycles {
        master.cycle(&[at + path(f64::from(cycle) * 1e-3)]).unwrap();
        let truth = plant.borrow().truth();
        run.table.push(truth.table_m);
        run.force.push(truth.commanded_n);
        run.refs.push(servo.borrow().reference().map_or("none".into(), |r| {
            format!(
                "x {:.3} v {:.4} a {:.4} next v {:.4} lim {} ref {} br {}",
                r.position.0.to_num::<f64>(),
                r.velocity.0.to_num::<f64>(),
                r.acceleration.0.to_num::<f64>(),
                r.next_velocity.0.to_num::<f64>(),
                r.limited,
                r.refused,
                r.bridged
            )
        }));
        run.fault = run.fault.or(servo.borrow().drive().fault()).or(plant.borrow().fault());
    }
    let (s, p) = (servo.borrow().counts(), plant.borrow().counters());
    run.servo = servo::watchdog::Counts {
        computed: s.computed - s0.computed,
        bridged: s.bridged - s0.bridged,
        refused: s.refused - s0.refused,
        by_deadline: s.by_deadline - s0.by_deadline,
        ..s
    };
    run.plant = plant_sim::node::Counters {
        cycles: p.cycles - p0.cycles,
        computed: p.computed - p0.computed,
        bridged: p.bridged - p0.bridged,
        refused: p.refused - p0.refused,
        by_deadline: p.by_deadline - p0.by_deadline,
    };
    run
}

fn rows() -> Vec<Row> {
    let mut all = vec![
        Row { name: "constant 50 mm/s", path: constant, loss: 400, cycles: 700 },
        Row { name: "5 m/s2, jerk phase", path: fast, loss: 50 + 120 + 100 + 50, cycles: 700 },
        Row { name: "5 m/s2, full", path: fast, loss: 50 + 120 + 100 + 115, cycles: 700 },
        Row { name: "reversal", path: turn, loss: 1250, cycles: 1700 },
    ];
    for loss in 298..306 {
        all.push(Row { name: "step", path: step_up, loss, cycles: 700 });
    }
    for loss in 269..273 {
        all.push(Row { name: "begin of jerk", path: fast, loss, cycles: 700 });
    }
    for loss in 355..363 {
        all.push(Row { name: "fast reversal", path: fast, loss, cycles: 700 });
    }
    all
}

fn damages(per_mille: u16, seed: u64) -> Vec<(&'static str, FaultPlan)> {
    let n = FaultPlan { seed, ..FaultPlan::default() };
    vec![
        ("lost", FaultPlan { lost_per_mille: per_mille, ..n }),
        ("doubled", FaultPlan { doubled_per_mille: per_mille, ..n }),
        ("late", FaultPlan { late_per_mille: per_mille, ..n }),
        ("corrupted", FaultPlan { corrupted_per_mille: per_mille, ..n }),
        (
            "all",
            FaultPlan {
                lost_per_mille: per_mille,
                doubled_per_mille: per_mille,
                late_per_mille: per_mille,
                corrupted_per_mille: per_mille,
                ..n
            },
        ),
    ]
}
fn quick_sine(t: f64) -> f64 {
    sine(0.020, 1.2, 0.5, t)
}
fn circle_x(t: f64) -> f64 {
    sine(0.1, 6.0 * std::f64::consts::PI, 1.0, t)
}

#[test]
fn explore_b() {
    let seeds: u64 = std::env::var("SEEDS").map_or(1, |s| s.parse().unwrap());
    let detail = std::env::var("DETAILB").ok();
    let paths: [(&str, fn(f64) -> f64); 2] = [("sine", quick_sine), ("circle", circle_x)];
    let bases = on_all_cores(&paths, |(_, path)| run(*path, 20_020, &[]));
    let cases: Vec<(usize, usize, u64)> =
        (0..2).flat_map(|p| (0..5).flat_map(move |d| (1..=seeds).map(move |s| (p, d, s)))).collect();
    let lines = on_all_cores(&cases, |(p, d, s)| {
        let (name, path) = paths[*p];
        let (what, plan) = damages(10, *s)[*d];
        let base = &bases[*p];
        let hit = run(path, 20_020, &[(SERVO, plan), (PLANT, plan)]);
        let (mut worst, mut at) = (0.0, 0);
        for k in 0..hit.table.len() {
            let e = 1e6 * (hit.table[k] - base.table[k]).abs();
            if e > worst {
                (worst, at) = (e, k);
            }
        }
        let force = base.force.iter().zip(&hit.force).map(|(a, b)| (a - b).abs() / 90.0).fold(0.0, f64::max);
        let sums = (
            hit.servo.computed + hit.servo.bridged + hit.servo.refused,
            hit.plant.computed + hit.plant.bridged + hit.plant.refused,
            hit.plant.cycles,
        );
        let bad = if worst > 5.0 || hit.fault.is_some() || sums != (20_020, 20_020, 20_020) { " <<<" } else { "" };
        let mut text = format!(
            "{name}, {what}, {s}: {worst:.3} um at {at} {force:.2} % {:?} servo {}/{}/{} d{} plant {}/{}/{} d{} {sums:?}{bad}\n",
            hit.fault,
            hit.servo.computed,
            hit.servo.bridged,
            hit.servo.refused,
            hit.servo.by_deadline,
            hit.plant.computed,
            hit.plant.bridged,
            hit.plant.refused,
            hit.plant.by_deadline
        );
        if detail.as_deref() == Some(&format!("{p},{d},{s}")) {
            let from = (0..hit.table.len())
                .rev()
                .filter(|k| *k < at)
                .find(|k| (hit.table[*k] - base.table[*k]).abs() < 0.1e-6)
                .unwrap();
            for k in from.saturating_sub(10)..at + 5 {
                text += &format!(
                    "  {k}: {:.3} um F {:.1} / {:.1}  \n      {}\n      {}\n",
                    1e6 * (hit.table[k] - base.table[k]),
                    base.force[k],
                    hit.force[k],
                    base.refs[k],
                    hit.refs[k]
                );
            }
        }
        text
    });
    println!("{}", lines.concat());
}

fn losses() -> Vec<(&'static str, usize, FrameKind, Damage)> {
    vec![
        ("SYNC at the servo", SERVO, FrameKind::Sync, Damage::Lost),
        ("SYNC at the plant", PLANT, FrameKind::Sync, Damage::Lost),
        ("setpoint", SERVO, FrameKind::Setpoint, Damage::Lost),
        ("feedback", SERVO, FrameKind::Feedback, Damage::Lost),
        ("torque", PLANT, FrameKind::Torque, Damage::Lost),
        ("setpoint +10um", SERVO, FrameKind::Setpoint, Damage::Setpoint(256_000)),
        ("setpoint -10um", SERVO, FrameKind::Setpoint, Damage::Setpoint(-256_000)),
        ("setpoint +1um", SERVO, FrameKind::Setpoint, Damage::Setpoint(25_600)),
        ("setpoint -1um", SERVO, FrameKind::Setpoint, Damage::Setpoint(-25_600)),
    ]
}

#[test]
fn explore() {
    let detail = std::env::var("DETAIL").ok();
    let cases: Vec<(usize, usize)> = (0..rows().len()).flat_map(|r| (0..losses().len()).map(move |l| (r, l))).collect();
    let lines = on_all_cores(&cases, |(r, l)| {
        let row = &rows()[*r];
        let (loss, place, kind, damage) = losses()[*l];
        let base = run(row.path, row.cycles, &[]);
        let mut text = String::new();
        let plan = FaultPlan { once: Some((kind, row.loss, damage)), ..FaultPlan::default() };
        let hit = run(row.path, row.cycles, &[(place, plan)]);
        let path = base.table.iter().zip(&hit.table).map(|(a, b)| 1e6 * (a - b).abs()).fold(0.0, f64::max);
        let force = base.force.iter().zip(&hit.force).map(|(a, b)| (a - b).abs() / 90.0).fold(0.0, f64::max);
        let bad = if path > 1.0 || force > 5.0 { " <<<" } else { "" };
        text += &format!(
            "{}, {loss}: {path:.3} um {force:.2} % {:?} servo {}/{}/{} d{} plant {}/{}/{} d{}{bad}\n",
            row.name,
            hit.fault,
            hit.servo.computed,
            hit.servo.bridged,
            hit.servo.refused,
            hit.servo.by_deadline,
            hit.plant.computed,
            hit.plant.bridged,
            hit.plant.refused,
            hit.plant.by_deadline
        );
        if detail.as_deref() == Some(&format!("{r},{l}")) {
            for k in row.loss as usize - 4..row.loss as usize + 16 {
                text += &format!(
                    "  {k}: {:.3} um F {:.1} / {:.1}  \n      {}\n      {}\n",
                    1e6 * (hit.table[k] - base.table[k]),
                    base.force[k],
                    hit.force[k],
                    base.refs[k],
                    hit.refs[k]
                );
            }
        }
        text
    });
    println!("{}", lines.concat());
}
