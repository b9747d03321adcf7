//! The command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};

/// A servo axis that removes its own reversal errors, and the bench that proves it.
#[derive(Debug, Parser)]
#[command(name = "quadrant", version, about, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Commission a machine: record, fit, find the missing effect, tune, download, circle before and after
    Commission(Commission),
    /// Identify a recorded axis: which effect does its declared model lack? Offline
    Identify(Identify),
    /// Run one reference circle over the bus and print its figures
    Circle(CircleArguments),
    /// Find compensation parameters from circles, as at a real machine
    Tune(Tune),
    /// Run the plant node of one axis on a CAN interface
    Plant(Plant),
    /// Run the servo node of one axis on a CAN interface
    Servo(Servo),
    /// Print the built-in reference machine file, to start your own from
    Machine,
}

/// Where the machine is.
#[derive(Clone, Debug, clap::Args)]
pub struct MachineArguments {
    /// Machine file (TOML); the built-in reference machine without it
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// CAN interface(s) with the nodes on them, comma-separated and given to the axes in turn; in process without it
    #[arg(long, value_name = "IFACE")]
    pub can: Option<String>,
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
}

/// Arguments of `circle`.
#[derive(Debug, clap::Args)]
pub struct CircleArguments {
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub machine: MachineArguments,
    /// Radius, mm
    #[arg(long, value_name = "R")]
    pub radius_mm: f64,
    /// Feed, mm/min
    #[arg(long, value_name = "F")]
    pub feed_mm_min: f64,
    /// Reversal compensation
    #[arg(long, value_enum, default_value_t = Method::None)]
    pub compensation: Method,
    /// Compensation file of `tune` or `commission`
    #[arg(long, value_name = "FILE")]
    pub compensation_file: Option<PathBuf>,
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
    #[arg(long, value_name = "R", default_value_t = 100.0)]
    pub radius_mm: f64,
    /// Feed of the tuning circle, mm/min
    #[arg(long, value_name = "F", default_value_t = 2000.0)]
    pub feed_mm_min: f64,
    /// Time from the reversal to the start of the pulse, ms; the paper has none
    #[arg(long, value_name = "T", default_value_t = 0.0)]
    pub start_delay_ms: f64,
}

/// Who beats the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Pace {
    /// The next SYNC waits for everybody: SYNC counts as gone after a second
    Lockstep,
    /// SYNC follows the clock: it counts as gone after 20 ms
    Clock,
}

impl Pace {
    /// SYNC timeout, µs.
    #[must_use]
    pub const fn sync_timeout_us(self) -> u32 {
        match self {
            Self::Lockstep => 1_000_000,
            Self::Clock => 20_000,
        }
    }
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
    /// Who beats the time
    #[arg(long, value_enum, default_value_t = Pace::Lockstep)]
    pub pace: Pace,
    /// Inject faults into the receiving port, for tests: seed,lost,doubled,late,corrupted (the last four per mille)
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
    /// Who beats the time
    #[arg(long, value_enum, default_value_t = Pace::Lockstep)]
    pub pace: Pace,
    /// Inject faults into the receiving port, for tests: seed,lost,doubled,late,corrupted (the last four per mille)
    #[arg(long, hide = true, value_parser = fault_plan)]
    pub faults: Option<bus::FaultPlan>,
}

/// A node id in decimal or hexadecimal.
fn node_id(text: &str) -> Result<u8, String> {
    let number = text.strip_prefix("0x").map_or_else(|| text.parse(), |hex| u8::from_str_radix(hex, 16));
    match number.ok().and_then(protocol::NodeId::new) {
        Some(id) => Ok(id.get()),
        None => Err(format!("a CANopen node id is 1 to 127 (0x01 to 0x7F), got {text}")),
    }
}

fn fault_plan(text: &str) -> Result<bus::FaultPlan, String> {
    let numbers: Result<Vec<u16>, _> = text.split(',').map(str::parse).collect();
    match numbers.as_deref() {
        Ok([seed, lost, doubled, late, corrupted]) => Ok(bus::FaultPlan {
            seed: u64::from(*seed),
            lost_per_mille: *lost,
            doubled_per_mille: *doubled,
            late_per_mille: *late,
            corrupted_per_mille: *corrupted,
            from_cycle: 100,
            ..bus::FaultPlan::default()
        }),
        _ => Err("five numbers: seed,lost,doubled,late,corrupted".into()),
    }
}
