//! Prints how long the functions of each crate are and how much of it is tests: `cargo run -q -p
//! hil-tests --example shape`. With `--longest N` also the N longest functions of each crate.

use std::process::ExitCode;

use hil_tests::architecture::shape::Shape;
use hil_tests::architecture::{crates, workspace};

const HEAD: &str = "| crate | files | lines | functions | p50 | p95 | longest | tests, % |\n\
                    |---|---|---|---|---|---|---|---|";

fn line(name: &str, shape: &Shape) -> String {
    let longest = shape.longest().map_or_else(
        || "–".into(),
        |function| format!("{} ({}, {})", function.lines, function.name, function.place),
    );
    format!(
        "| {name} | {} | {} | {} | {} | {} | {longest} | {:.1} |",
        shape.files,
        shape.lines,
        shape.functions.len(),
        shape.length_at(0.50),
        shape.length_at(0.95),
        shape.test_percent()
    )
}

/// How many of the longest functions are asked for.
fn wanted() -> Option<usize> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Some(0),
        ["--longest", count] => count.parse().ok(),
        _ => None,
    }
}

fn print(longest: usize) -> std::io::Result<()> {
    println!("{HEAD}");
    for member in crates::members(&workspace())? {
        let shape = Shape::of(&workspace().join(&member.folder))?;
        println!("{}", line(&member.name, &shape));
        for function in shape.functions.iter().rev().take(longest) {
            println!("  {} {} {}", function.lines, function.name, function.place);
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    let Some(longest) = wanted() else {
        eprintln!("usage: shape [--longest N]");
        return ExitCode::from(2);
    };
    match print(longest) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
