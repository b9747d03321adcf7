//! How the identification scales: `cargo bench -p hil-tests --bench identification [-- DIR…]`.
//!
//! One axis with a Stribeck fall, ripple and presliding, recorded for longer and longer: so many
//! rows for training and as many for validation, through files, with everything written that
//! `identify DIR --out` writes. Every candidate is scored, every shape of reversal fitted.
//! Screening is everything on the inverse model; the whole adds the free-run fits, the judgement of
//! all rows and the files. All cores that the process may use (`taskset -c 0,1` for two).
//!
//! DIR is the folder of a dataset: with any, those are measured instead. A second table says which
//! step took how much of the processor time.

use std::path::{Path, PathBuf};
use std::time::Instant;

use hil_tests::records::Hidden::{Presliding, Stribeck, TorqueRipple};
use hil_tests::records::{self, Plan};
use identification::{Dataset, Step, identify};
use workbench::commands::identify::write_folder;

const ROWS: [usize; 4] = [25_000, 100_000, 400_000, 1_000_000];

/// What an identification took.
struct Cost {
    /// Of the training record.
    rows: usize,
    read_s: f64,
    screening_s: f64,
    whole_s: f64,
    /// Time of all cores together: it does not see what else the machine does.
    cores_s: f64,
    peak_mb: f64,
    found: Vec<String>,
    /// Steps as they began, with the time of all cores until then, s.
    steps: Vec<(&'static str, f64)>,
}

fn main() {
    let arguments = std::env::args_os().skip(1);
    let folders = arguments.filter(|argument| argument != "--bench");
    let folders: Vec<PathBuf> = folders.map(PathBuf::from).collect();
    println!(
        "| record | rows | reading, s | screening, s | whole, s | screening per 25 000 rows, s | whole per 25 000 rows, s | all cores, s | peak memory, MB | found |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    let mut costs = Vec::new();
    for folder in &folders {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let cost = cost(folder);
        print(&name, &cost);
        costs.push((name.into_owned(), cost));
    }
    if folders.is_empty() {
        for rows in ROWS {
            let folder = tempfile::tempdir().expect("a temporary folder can be made");
            write_record(folder.path(), rows);
            let cost = cost(folder.path());
            print("ripple and presliding", &cost);
            costs.push((format!("{rows} rows"), cost));
        }
    }
    print_steps(&costs);
}

/// The steps of an identification in a word.
const STEPS: [&str; 11] = [
    "reading",
    "declared",
    "candidates",
    "motor and load",
    "rigid",
    "bristle",
    "gap",
    "bristle and gap",
    "validating",
    "all rows",
    "files",
];

fn word(step: &Step) -> &'static str {
    match step {
        Step::Declared => "declared",
        Step::Candidates | Step::Found { .. } => "candidates",
        Step::MotorAndLoad => "motor and load",
        Step::Rigid => "rigid",
        Step::Bristle => "bristle",
        Step::Gap => "gap",
        Step::BristleAndGap => "bristle and gap",
        Step::Validating => "validating",
        Step::AllRows => "all rows",
    }
}

fn print_steps(costs: &[(String, Cost)]) {
    println!("\n| record, s of all cores | {} |", STEPS.join(" | "));
    println!("|---{}|", "|---".repeat(STEPS.len()));
    for (name, cost) in costs {
        let ends = cost.steps.iter().skip(1).map(|(_, at)| *at);
        let ends = ends.chain([cost.cores_s]);
        let of = |word: &str| {
            let spans = cost.steps.iter().zip(ends.clone());
            let spans = spans.filter(|((step, _), _)| *step == word);
            spans.map(|((_, from), to)| to - from).sum::<f64>()
        };
        let cells: Vec<String> = STEPS
            .iter()
            .map(|step| format!("{:.2}", of(step)))
            .collect();
        println!("| {name} | {} |", cells.join(" | "));
    }
}

fn print(name: &str, cost: &Cost) {
    let of_25_000 = 25_000.0 / cost.rows as f64;
    println!(
        "| {name} | {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.0} | {} |",
        cost.rows,
        cost.read_s,
        cost.screening_s,
        cost.whole_s,
        cost.screening_s * of_25_000,
        cost.whole_s * of_25_000,
        cost.cores_s,
        cost.peak_mb,
        cost.found.join(", ")
    );
}

fn write_record(folder: &Path, rows: usize) {
    let hidden = vec![
        Stribeck {
            ratio: 1.5,
            velocity_m_per_s: 4.0e-3,
        },
        TorqueRipple {
            amplitude_n: 15.0,
            order_per_rev: 6.0,
        },
        Presliding {
            deflection_m: 8.0e-6,
        },
    ];
    let plan = Plan {
        hidden,
        rows,
        seed: 7,
        ..Plan::default()
    };
    records::write(folder, &plan).expect("the folder can be written");
}

fn cost(folder: &Path) -> Cost {
    forget_peak();
    let (start, before_s) = (Instant::now(), cores_s());
    let dataset = Dataset::read(folder, None, None).unwrap_or_else(|why| panic!("{why}"));
    let read_s = start.elapsed().as_secs_f64();
    let mut screening_s = 0.0;
    let mut steps = vec![("reading", 0.0)];
    let result = identify(&dataset, &mut |step| {
        steps.push((word(step), cores_s() - before_s));
        if matches!(step, Step::Rigid) {
            screening_s = start.elapsed().as_secs_f64() - read_s;
        }
    })
    .unwrap_or_else(|why| panic!("{why}"));
    let out = tempfile::tempdir().expect("a temporary folder can be made");
    steps.push(("files", cores_s() - before_s));
    write_folder(out.path(), &dataset, &result).expect("the folder can be written");
    Cost {
        rows: dataset.train.len(),
        read_s,
        screening_s,
        whole_s: start.elapsed().as_secs_f64(),
        cores_s: cores_s() - before_s,
        peak_mb: peak_mb(),
        found: result.report.found,
        steps,
    }
}

/// Time that all cores gave to this process so far, s (proc(5), `stat`: fields 14 and 15, in
/// hundredths of a second on Linux).
fn cores_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2);
    ticks
        .filter_map(|field| field.parse::<f64>().ok())
        .sum::<f64>()
        / 100.0
}

/// Lets the peak of this process begin anew (proc(5), `clear_refs`).
fn forget_peak() {
    // Where this is not allowed the peak is that of the longest record so far: they rise.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Peak resident memory of this process, MB.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kb = line.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    kb.unwrap_or(f64::NAN) / 1024.0
}
