//! Writes what `commission` records of the machines with a gap beside a compliance: `cargo run -p
//! hil-tests --example gaps -- DIR [SEED…]`.

use std::path::PathBuf;

use hil_tests::gaps::{GAPS_UM, SEEDS, declaring_compliance, machine};
use workbench::commissioning::identified_axes;
use workbench::error::Outcome;
use workbench::session::Stand;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        eprintln!("usage: gaps DIR [SEED…]");
        std::process::exit(2);
    };
    let asked: Vec<u64> = arguments.filter_map(|seed| seed.parse().ok()).collect();
    let is_asked = |seed: &u64| asked.is_empty() || asked.contains(seed);
    for seed in SEEDS.into_iter().filter(is_asked) {
        let machine = declaring_compliance(machine(seed, &GAPS_UM), true);
        let out = folder.join(seed.to_string());
        std::fs::create_dir_all(&out).expect("the folder can be made");
        identified_axes::record(&Stand::in_process(&machine), &out)?;
    }
    Ok(())
}
