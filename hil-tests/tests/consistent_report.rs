//! A report agrees with itself: what one place says, another one bears out.
//!
//! Seeded records of the simulator, and records of makes that share nothing with it, go through
//! `identify` with all its files. Every claim of the report is then held against the others.

#[path = "consistent_report/claims.rs"]
mod claims;
#[path = "consistent_report/written.rs"]
mod written;

use std::path::{Path, PathBuf};

use hil_tests::records::{self, plans::plans};
use hil_tests::{Scope, on_all_cores};
use identification::{Dataset, Identification, identify};
use workbench::commands::identify::write_folder;

use claims::Claim;
use written::Written;

/// Seed of the makes.
const SEED: u64 = 1;

/// Seeds of records of the simulator: nothing hidden, a Stribeck fall, presliding, a gap.
const SEEDED: [u64; 4] = [1005, 1023, 1024, 1027];

/// Records of makes: presliding, a gap with a scale, ripple of a rotary axis, a controller that is
/// refuted, a disturbance outside the list.
const OF_MAKES: [&str; 5] = [
    "makes/damped-stage-hidden",
    "makes/gapped-screw-hidden",
    "makes/bench-rotor-hidden",
    "clean/declared-compliance",
    "outside/late-log",
];

/// How a record comes into a folder.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A seed of the simulator.
    Seeded(u64),
    /// A record of a make, `table/name`.
    Made(&'static str),
}

fn sources() -> Vec<Source> {
    let seeded = SEEDED.into_iter().map(Source::Seeded);
    let all: Vec<Source> = seeded
        .chain(OF_MAKES.into_iter().map(Source::Made))
        .collect();
    let few = vec![Source::Seeded(1023), Source::Made(OF_MAKES[1])];
    let some = vec![
        Source::Seeded(1024),
        Source::Made(OF_MAKES[1]),
        Source::Made(OF_MAKES[2]),
        Source::Made(OF_MAKES[3]),
    ];
    Scope::now().pick(few, some, all)
}

impl Source {
    /// Writes the record below a folder, and says where.
    fn write(self, root: &Path) -> Option<PathBuf> {
        match self {
            Self::Seeded(seed) => {
                let plan = plans().into_iter().find(|plan| plan.seed == seed)?;
                records::write(root, &plan).ok()?;
                Some(root.to_owned())
            }
            Self::Made(wanted) => {
                let (table, name) = wanted.split_once('/')?;
                let mut all = makes::recipes(SEED).into_iter();
                let recipe = all.find(|recipe| recipe.table == table && recipe.name == name)?;
                recipe.entry().write(root).ok()?;
                Some(root.join(name))
            }
        }
    }
}

/// The result of a record, and the files that are written of it.
fn identified(source: Source) -> (Identification, Written) {
    let folder = tempfile::tempdir().unwrap();
    let record = source.write(folder.path());
    let record = record.unwrap_or_else(|| panic!("no record {source:?}"));
    let dataset = Dataset::read(&record, None, None).unwrap();
    let result = identify(&dataset, &mut |_| ()).unwrap();
    let out = folder.path().join("out");
    write_folder(&out, &dataset, &result).unwrap();
    let written = Written::read(&out);
    (result, written)
}

fn contradictions(source: &Source) -> Vec<String> {
    let (result, written) = identified(*source);
    let claims = claims::ALL.iter();
    let broken = claims.flat_map(|Claim { sentence, broken }| {
        let cases = broken(&result, &written).into_iter();
        cases.map(move |case| format!("{source:?}: {sentence}: {case}"))
    });
    broken.collect()
}

#[test]
fn what_one_place_of_a_report_says_another_one_bears_out() {
    let broken = on_all_cores(&sources(), contradictions).concat();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
