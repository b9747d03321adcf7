//! Writes the records on which the identification is judged, with `truth.json` beside each: `cargo
//! run -p hil-tests --example records -- DIR`.

use std::path::PathBuf;

use hil_tests::records::{self, plans::plans};

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: records DIR");
        std::process::exit(2);
    };
    for plan in plans() {
        let folder = folder.join(plan.seed.to_string());
        std::fs::create_dir_all(&folder)?;
        records::write(&folder, &plan)?;
        let names: Vec<String> = plan
            .hidden
            .iter()
            .map(|hidden| format!("\"{}\"", hidden.word()))
            .collect();
        std::fs::write(
            folder.join("truth.json"),
            format!("{{ \"effects\": [{}] }}\n", names.join(", ")),
        )?;
    }
    Ok(())
}
