//! The `quadrant` program.

use std::process::ExitCode;

use clap::Parser as _;
use workbench::cli::{Cli, Command};
use workbench::{circle, commission, identify, nodes};

/// A reader that has seen enough (`| head`) is no error; Rust's start-up code turns the signal off, and printing then panics.
fn end_quietly_on_a_closed_pipe() {
    #[expect(unsafe_code, reason = "signal dispositions have no safe interface")]
    // SAFETY: called once, before any other thread exists; SIG_DFL is a valid disposition.
    unsafe {
        libc::signal(libc::SIGPIPE, libc::SIG_DFL);
    }
}

/// What the argument parser says, in one line.
fn one_line(text: &str) -> String {
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let told = lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"));
    let text = told.collect::<Vec<_>>().join(" ");
    format!("{}; see `quadrant --help`", text.trim_start_matches("error: "))
}

fn main() -> ExitCode {
    end_quietly_on_a_closed_pipe();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // Help and version go to stdout as they are.
        Err(error) if !error.use_stderr() => error.exit(),
        Err(error) => {
            eprintln!("quadrant: {}", one_line(&error.render().to_string()));
            return ExitCode::from(2);
        }
    };
    let outcome = match cli.command {
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
