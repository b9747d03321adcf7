//! Writes what `commission` records of the machines with a gap beside a compliance, those of the
//! grid or of any seeds: `cargo run -p hil-tests --example gaps -- DIR [SEED…]`.

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
    let seed = |text: String| {
        text.parse().unwrap_or_else(|_| {
            eprintln!("gaps: a seed is a whole number from 0 on, not {text}");
            std::process::exit(2);
        })
    };
    let asked: Vec<u64> = arguments.map(seed).collect();
    let seeds = if asked.is_empty() { &SEEDS[..] } else { &asked };
    for seed in seeds.iter().copied() {
        let machine = declaring_compliance(machine(seed, &GAPS_UM), true);
        let out = folder.join(seed.to_string());
        std::fs::create_dir_all(&out).expect("the folder can be made");
        identified_axes::record(&Stand::in_process(&machine), &out)?;
    }
    Ok(())
}
