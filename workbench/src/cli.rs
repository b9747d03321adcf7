//! The command line: what can be said on it, and what it means.
//!
//! The texts of this file are those of `quadrant --help`.

mod machine_arguments;
mod values;

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};

pub use machine_arguments::{MachineArguments, Pace, PaceArguments, machine_file};
pub use values::{circle, feed};
use values::{fault_plan, micrometres, node_id};

/// A servo axis that removes its own reversal errors, and the bench that proves it.
#[derive(Debug, Parser)]
#[command(
    name = "quadrant",
    version,
    about,
    max_term_width = 100,
    arg_required_else_help = true
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Commission a machine: record, fit, find the missing effect, tune, download, circle before
    /// and after
    Commission(Commission),
    /// Compare runs of `commission`: spikes and G from run to run, and which parameters changed
    Compare(Compare),
    /// Identify a recorded axis: which effect does its declared model lack? Offline
    Identify(Identify),
    /// Run one reference circle over the bus and print its figures
    Circle(CircleArguments),
    /// Run a contour of dense points over the bus and print how far from it the table was
    Contour(ContourArguments),
    /// Find compensation parameters from circles, as at a real machine
    Tune(Tune),
    /// Measure how long the cycles of a machine take: loop timing
    Timing(Timing),
    /// Run the plant node of one axis on a CAN interface
    Plant(Plant),
    /// Run the servo node of one axis on a CAN interface
    Servo(Servo),
    /// Print the built-in reference machine file, to start your own from
    Machine,
    /// Print completions for a shell: `quadrant completions bash >
    /// ~/.local/share/bash-completion/completions/quadrant`
    Completions {
        /// Shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
}

/// Arguments of `commission`.
#[derive(Debug, clap::Args)]
pub struct Commission {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub machine: MachineArguments,
    /// Folder for report, records and results
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Largest circular deviation G of both directions that the circle after may have, µm: the
    /// certificate says pass or fail
    #[arg(long, value_name = "UM", allow_negative_numbers = true, value_parser = micrometres)]
    pub tolerance_um: Option<f64>,
    /// Write the frames of the circles before and after as candump logs too
    #[arg(long)]
    pub log: bool,
    /// With --can: real axes answer as plants on the bus; without it the report says SIMULATION
    #[arg(long)]
    pub real_axes: bool,
}

/// The circles of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Circles {
    /// Without compensation
    Before,
    /// With what the run has downloaded
    After,
}

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct Compare {
    /// Folders of `commission`, the earliest first
    #[arg(required = true, num_args = 2.., value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Write table, trend and circles as a page
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    /// Write the circles over each other
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Which circles that plot shows
    #[arg(long, value_enum, default_value_t = Circles::After)]
    pub circles: Circles,
    /// Write the comparison as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Arguments of `identify`.
#[derive(Debug, clap::Args)]
pub struct Identify {
    /// Folder with train.csv, dataset.toml and perhaps validate.csv
    pub dataset: PathBuf,
    /// Validation record; the dataset's validate.csv or the last 30 % of the time without it
    #[arg(long, value_name = "FILE")]
    pub validate: Option<PathBuf>,
    /// Declared effects, instead of those of dataset.toml
    #[arg(long, value_name = "EFFECT,…", value_delimiter = ',')]
    pub declared: Option<Vec<String>>,
    /// Write the result as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write report, prediction.csv and the JSON into a folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Reversal compensation of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Velocity and acceleration feedforward only
    None,
    /// A force in the commanded direction
    Coulomb,
    /// The paper's pulse on the speed setpoint
    Pulse,
    /// That pulse over the acceleration at the reversal
    Adaptive,
    /// A model of friction and of the screw's wind-up, fed forward
    Model,
}

/// What a circle or a contour is run with.
#[derive(Debug, clap::Args)]
pub struct CompensationArguments {
    /// Reversal compensation
    #[arg(long = "compensation", value_name = "COMPENSATION", value_enum, default_value_t = Method::None)]
    pub method: Method,
    /// Compensation file of `tune` or `commission`
    #[arg(long, value_name = "FILE")]
    pub compensation_file: Option<PathBuf>,
}

/// Arguments of `contour`.
#[derive(Debug, clap::Args)]
pub struct ContourArguments {
    /// CSV file with the columns x_mm and y_mm: dense points in order, about the middle of the
    /// travel
    pub points: PathBuf,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub machine: MachineArguments,
    /// Feed, mm/min
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    pub feed_mm_min: f64,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub compensation: CompensationArguments,
    /// Write the figures as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write all frames as a candump log
    #[arg(long, value_name = "FILE")]
    pub candump: Option<PathBuf>,
}

/// Arguments of `circle`.
#[derive(Debug, clap::Args)]
pub struct CircleArguments {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub machine: MachineArguments,
    /// Radius, mm
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub radius_mm: f64,
    /// Feed, mm/min
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    pub feed_mm_min: f64,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub compensation: CompensationArguments,
    /// Let the drives refine the model's levels of friction on so many circles first, and go on
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100))]
    pub self_tune: u32,
    /// Write the figures as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the polar plot
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Write all frames as a candump log
    #[arg(long, value_name = "FILE")]
    pub candump: Option<PathBuf>,
}

/// What `tune` can tune.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TuneMethod {
    /// The paper's pulse on the speed setpoint
    Pulse,
    /// That pulse over the acceleration at the reversal, from circles at many feeds
    Adaptive,
    /// A model of friction and of the screw's wind-up, from records of the axes
    Model,
}

/// Arguments of `tune`.
#[derive(Debug, clap::Args)]
pub struct Tune {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub machine: MachineArguments,
    /// What to tune
    #[arg(long, value_enum)]
    pub method: TuneMethod,
    /// Where to write the compensation file
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Radius of the tuning circle, mm
    #[arg(
        long,
        value_name = "R",
        allow_negative_numbers = true,
        default_value_t = 100.0
    )]
    pub radius_mm: f64,
    /// Feed of the tuning circle, mm/min
    #[arg(
        long,
        value_name = "F",
        allow_negative_numbers = true,
        default_value_t = 2000.0
    )]
    pub feed_mm_min: f64,
    /// Time from the reversal to the start of the pulse, ms; the paper has none, `adaptive` its own
    #[arg(
        long,
        value_name = "T",
        allow_negative_numbers = true,
        default_value_t = 0.0
    )]
    pub start_delay_ms: f64,
}

/// Arguments of `timing`.
#[derive(Debug, clap::Args)]
pub struct Timing {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub machine: MachineArguments,
    /// For so long, s of the machine's time: all axes go 10 mm to and fro at F 1000, or as far and
    /// fast as they can
    #[arg(long, value_name = "S", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=3600))]
    pub seconds: u32,
    /// Write the figures and histograms as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the histograms as a plot
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

/// Arguments of `plant`.
#[derive(Debug, clap::Args)]
pub struct Plant {
    /// Machine file (TOML); the built-in reference machine without it
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Node id: 0x11 (17) for the first axis, 0x12 for the second, …
    #[arg(long, value_name = "N", default_value = "0x11", value_parser = node_id)]
    pub node: u8,
    /// CAN interface
    #[arg(long, value_name = "IFACE")]
    pub can: String,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub pace: PaceArguments,
    /// Inject faults into the receiving port, for tests: seed,lost,doubled,late,corrupted[,from
    /// cycle] (the shares per mille)
    #[arg(long, hide = true, value_parser = fault_plan)]
    pub faults: Option<bus::FaultPlan>,
}

/// Arguments of `servo`.
#[derive(Debug, clap::Args)]
pub struct Servo {
    /// Node id of the servo
    #[arg(long, value_name = "N", value_parser = node_id)]
    pub node: u8,
    /// Node id of its plant
    #[arg(long, value_name = "P", value_parser = node_id)]
    pub plant_node: u8,
    /// CAN interface
    #[arg(long, value_name = "IFACE")]
    pub can: String,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub pace: PaceArguments,
    /// Inject faults into the receiving port, for tests: seed,lost,doubled,late,corrupted[,from
    /// cycle] (the shares per mille)
    #[arg(long, hide = true, value_parser = fault_plan)]
    pub faults: Option<bus::FaultPlan>,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn no_option_contradicts_another() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_machine_is_in_process_and_in_lock_step_unless_the_line_says_otherwise() {
        let line = ["quadrant", "commission"];
        let Command::Commission(commission) = Cli::try_parse_from(line).unwrap().command else {
            panic!("another command");
        };
        let (machine, place) = commission.machine.machine_and_place().unwrap();
        assert_eq!(machine.name, plant_sim::Machine::reference().name);
        assert_eq!(place, crate::network::place::Place::InProcess);
        let pace = commission.machine.pace.chosen();
        assert_eq!(pace, crate::network::interfaces::DEFAULT_PACE);
    }
}
