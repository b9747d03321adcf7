//! The `quadrant` program: command line in, exit code out.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Parser as _;
use clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use workbench::cli::{Cli, Command};
use workbench::commands::{
    circle, commission, compare, completions, contour, identify, machine, plant, servo, timing,
    tune,
};
use workbench::error::{Failure, Outcome};
use workbench::interrupt::Interrupt;
use workbench::stdout;

/// A reader that has seen enough (`| head`) is no error; Rust's start-up code turns the signal off,
/// and printing then panics.
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
    let told = lines.take_while(|line| {
        !line.starts_with("Usage:") && !line.starts_with("For more information")
    });
    let text = told.collect::<Vec<_>>().join(" ");
    format!(
        "{}; see `quadrant --help`",
        text.trim_start_matches("error: ")
    )
}

/// The first signal asks the machine to stop, the second one ends the process at once. A process
/// that a signal ended says 128 + its number, as shells do.
fn stop_on_signals() -> Outcome<Interrupt> {
    let interrupt = Interrupt::never();
    let armed = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal finds the way out still closed.
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&armed))
            .and_then(|_| flag::register(signal, Arc::clone(&armed)))
            .and_then(|_| {
                flag::register_usize(signal, interrupt.cell(), signal.unsigned_abs() as usize)
            })
            .map_err(|error| Failure::new(format!("signal {signal} cannot be handled: {error}")))?;
    }
    Ok(interrupt)
}

/// Runs a command that moves a machine; an interrupted one ends with the code of its signal.
fn moving(command: impl FnOnce(&Interrupt) -> Outcome<()>) -> (Outcome<()>, Option<i32>) {
    match stop_on_signals() {
        Ok(interrupt) => (command(&interrupt), interrupt.signal()),
        Err(failure) => (Err(failure), None),
    }
}

/// 0, 2 with a line on stderr, or that of the signal that ended the work.
fn exit_code((outcome, signal): (Outcome<()>, Option<i32>)) -> ExitCode {
    let written = stdout::finish();
    if outcome.is_ok() && written.is_ok() {
        return ExitCode::SUCCESS;
    }
    for failure in [outcome, written].into_iter().filter_map(Result::err) {
        eprintln!("quadrant: {failure}");
    }
    let code = signal.and_then(|signal| u8::try_from(128 + signal).ok());
    ExitCode::from(code.unwrap_or(2))
}

fn main() -> ExitCode {
    end_quietly_on_a_closed_pipe();
    stdout::take_over();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // Help and version go to stdout as they are; nothing said is a wish for help.
        Err(error) if !error.use_stderr() => error.exit(),
        Err(error) if error.kind() == DisplayHelpOnMissingArgumentOrSubcommand => {
            stdout::text(format_args!("{}", error.render()));
            return exit_code((Ok(()), None));
        }
        Err(error) => {
            eprintln!("quadrant: {}", one_line(&error.render().to_string()));
            return ExitCode::from(2);
        }
    };
    exit_code(dispatch(cli.command))
}

/// Runs the command. One that moves a machine can be interrupted; what happens then is in the code.
fn dispatch(command: Command) -> (Outcome<()>, Option<i32>) {
    let still = |outcome| (outcome, None);
    match command {
        Command::Commission(arguments) => {
            moving(|interrupt| commission::run(&arguments, interrupt))
        }
        Command::Circle(arguments) => moving(|interrupt| circle::run(&arguments, interrupt)),
        Command::Contour(arguments) => moving(|interrupt| contour::run(&arguments, interrupt)),
        Command::Tune(arguments) => moving(|interrupt| tune::run(&arguments, interrupt)),
        Command::Timing(arguments) => moving(|interrupt| timing::run(&arguments, interrupt)),
        Command::Identify(arguments) => still(identify::run(&arguments)),
        Command::Compare(arguments) => still(compare::run(&arguments)),
        Command::Plant(arguments) => still(plant::run(&arguments)),
        Command::Servo(arguments) => still(servo::run(&arguments)),
        Command::Machine => {
            machine::run();
            still(Ok(()))
        }
        Command::Completions { shell } => {
            completions::run(shell);
            still(Ok(()))
        }
    }
}
