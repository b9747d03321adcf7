//! How the identification scales: `cargo bench -p hil-tests --bench identification`.
//!
//! One axis with a Stribeck fall, ripple and presliding, recorded for longer and longer; every
//! candidate is scored, every shape of reversal fitted. Screening is everything on the inverse
//! model; the whole adds the free-run fits. One thread. Memory is the peak of the process, so
//! records come in rising length.

use std::time::Instant;

use hil_tests::records::Hidden::{Presliding, Stribeck, TorqueRipple};
use hil_tests::records::{self, Plan};
use identification::{Dataset, identify};

const ROWS: [usize; 3] = [25_000, 100_000, 400_000];

/// Peak resident memory of this process, MB.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kb = line.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    kb.unwrap_or(f64::NAN) / 1024.0
}

fn main() {
    println!(
        "| rows | screening, s | whole, s | per 25 000 rows, s | peak memory, MB | found |\n|---|---|---|---|---|---|"
    );
    for rows in ROWS {
        let folder = tempfile::tempdir().expect("a temporary folder can be made");
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
        records::write(folder.path(), &plan).expect("the folder can be written");
        let dataset = Dataset::read(folder.path(), None, None).expect("the record is good");
        let start = Instant::now();
        let mut screening_s = 0.0;
        let report = identify(&dataset, &mut |step| {
            if step.starts_with("simulating") {
                screening_s = start.elapsed().as_secs_f64();
            }
        })
        .expect("the record is good")
        .report;
        let whole_s = start.elapsed().as_secs_f64();
        let each_s = whole_s * 25_000.0 / rows as f64;
        let found = report.found.join(", ");
        println!(
            "| {rows} | {screening_s:.2} | {whole_s:.2} | {each_s:.2} | {:.0} | {found} |",
            peak_mb()
        );
    }
}
