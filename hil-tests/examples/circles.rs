//! Prints the circles between files, crates and folders, with all uses that are part of one:
//! `cargo run -q -p hil-tests --example circles`.

use hil_tests::architecture::{Graph, Sources, crates, rooms, workspace};

fn show(what: &str, graph: &Graph) {
    let knots = graph.knotted();
    println!("{what}: {} circles", knots.len());
    for (shortest, all) in graph.circles().iter().zip(&knots) {
        println!("  shortest:");
        shortest
            .to_string()
            .lines()
            .for_each(|line| println!("    {line}"));
        println!("  all uses in this knot:");
        all.to_string()
            .lines()
            .for_each(|line| println!("    {line}"));
    }
}

fn main() -> std::io::Result<()> {
    let members = crates::members(&workspace())?;
    show("crates", &crates::between_crates(&members));
    show("folders", &crates::between_folders(&members));
    for member in members {
        let sources = Sources::read(&workspace().join(&member.folder))?;
        show(&member.name, &sources.uses());
        if member.name == "identification" {
            let wrong = rooms::against_the_order(&sources, &rooms::IDENTIFICATION);
            println!("{}: {} uses of a later room", member.name, wrong.len());
            println!("{}", wrong.join("\n"));
        }
    }
    Ok(())
}
