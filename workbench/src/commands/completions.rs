//! `quadrant completions`: what a shell needs to complete commands and options.

use clap::CommandFactory as _;
use clap_complete::{Shell, generate};

use crate::cli::Cli;
use crate::stdout;

/// Prints the completions for a shell.
pub fn run(shell: Shell) {
    let mut text = Vec::new();
    generate(shell, &mut Cli::command(), "quadrant", &mut text);
    stdout::text(format_args!("{}", String::from_utf8_lossy(&text)));
}
