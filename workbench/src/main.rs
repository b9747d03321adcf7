//! The `quadrant` program.

use std::process::ExitCode;

use clap::Parser;
use workbench::cli::{Cli, Command};
use workbench::{circle, commission, identify, nodes};

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Commission(arguments) => commission::command(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Circle(arguments) => circle::command(&arguments),
        Command::Tune(arguments) => circle::tune(&arguments),
        Command::Plant(arguments) => nodes::plant(&arguments),
        Command::Servo(arguments) => nodes::servo(&arguments),
        Command::Machine => {
            print!("{}", plant_sim::Machine::reference_text());
            Ok(())
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("quadrant: {failure}");
            ExitCode::from(2)
        }
    }
}
