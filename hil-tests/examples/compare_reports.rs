//! Compares what two programs identified: `cargo run -q -p hil-tests --example compare_reports --
//! BEFORE AFTER [TOLERANCE]`. `scripts/compare-identification` makes the two folders.
//!
//! Prints each difference and a closing line. Exit status 0 where there is none, 1 where there are
//! some, 2 where it could not compare.

use std::path::PathBuf;
use std::process::ExitCode;

use hil_tests::comparison::{Comparer, TOLERANCE};

struct Wanted {
    before: PathBuf,
    after: PathBuf,
    tolerance: f64,
}

fn wanted() -> Option<Wanted> {
    let mut arguments = std::env::args().skip(1);
    let wanted = Wanted {
        before: arguments.next()?.into(),
        after: arguments.next()?.into(),
        tolerance: match arguments.next() {
            None => TOLERANCE,
            Some(text) => text.parse().ok()?,
        },
    };
    arguments.next().is_none().then_some(wanted)
}

fn compare(wanted: &Wanted) -> std::io::Result<ExitCode> {
    let mut comparer = Comparer::new(wanted.tolerance);
    let records = comparer.folders(&wanted.before, &wanted.after)?;
    let found = comparer.found;
    for line in &found.differences {
        println!("{line}");
    }
    println!(
        "{records} records, {} numbers, {} differences beyond {:e}; worst {:.1e} {}; \
         values that only one machine file has: {}",
        found.numbers,
        found.differences.len(),
        wanted.tolerance,
        found.worst,
        found.worst_at,
        found.only_in_one
    );
    let is_same = records > 0 && found.differences.is_empty();
    Ok(ExitCode::from(u8::from(!is_same)))
}

fn main() -> ExitCode {
    let Some(wanted) = wanted() else {
        eprintln!("usage: compare_reports BEFORE AFTER [TOLERANCE]");
        return ExitCode::from(2);
    };
    compare(&wanted).unwrap_or_else(|error| {
        eprintln!("compare_reports: {error}");
        ExitCode::from(2)
    })
}
