//! The command line.

use std::path::PathBuf;
use std::time::Duration;

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
    /// Commission a machine: record, fit, find the missing effect, tune, download, circle before
    /// and after
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
#[derive(Clone, Debug, Default, clap::Args)]
pub struct MachineArguments {
    /// Machine file (TOML); the built-in reference machine without it
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// CAN interface(s) with the nodes on them, comma-separated and given to the axes in turn; in
    /// process without it
    #[arg(long, value_name = "IFACE")]
    pub can: Option<String>,
    #[command(flatten)]
    #[expect(missing_docs, reason = "flattened")]
    pub pace: PaceArguments,
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
    /// The next SYNC waits for everybody
    Lockstep,
    /// SYNC follows the clock
    Clock,
}

/// How a run on CAN interfaces is paced.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct PaceArguments {
    /// Who beats the time on CAN interfaces
    #[arg(long, value_enum, default_value_t = Pace::Lockstep)]
    pub pace: Pace,
    /// Lock-step: a cycle whose frames stay away closes without them after so long; the same for
    /// the workbench and all nodes. Some milliseconds only where frames are lost on purpose
    #[arg(long, value_name = "MS", default_value_t = DEADLINE_MS, value_parser = clap::value_parser!(u64).range(1..=60_000))]
    pub deadline_ms: u64,
}

/// Long, because on a busy machine a process may have to wait for its turn.
const DEADLINE_MS: u64 = 1000;

impl Default for PaceArguments {
    fn default() -> Self {
        Self {
            pace: Pace::Lockstep,
            deadline_ms: DEADLINE_MS,
        }
    }
}

impl PaceArguments {
    /// The pace of nodes and workbench.
    #[must_use]
    pub const fn chosen(self) -> quadrant_host::Pace {
        match self.pace {
            Pace::Lockstep => quadrant_host::Pace::Lockstep {
                deadline: Duration::from_millis(self.deadline_ms),
            },
            Pace::Clock => quadrant_host::Pace::Clock,
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

/// A node id in decimal or hexadecimal.
fn node_id(text: &str) -> Result<u8, String> {
    let number = text
        .strip_prefix("0x")
        .map_or_else(|| text.parse(), |hex| u8::from_str_radix(hex, 16));
    match number.ok().and_then(protocol::NodeId::new) {
        Some(id) => Ok(id.get()),
        None => Err(format!(
            "a CANopen node id is 1 to 127 (0x01 to 0x7F), got {text}"
        )),
    }
}

/// Faults begin here unless the plan says otherwise: when the axes are enabled.
const FAULTS_FROM_CYCLE: u32 = 100;

fn fault_plan(text: &str) -> Result<bus::FaultPlan, String> {
    let numbers: Vec<u32> = text
        .split(',')
        .map(str::parse)
        .collect::<Result<_, _>>()
        .unwrap_or_default();
    let (seed, shares, from_cycle) = match numbers[..] {
        [seed, a, b, c, d] => (seed, [a, b, c, d], FAULTS_FROM_CYCLE),
        [seed, a, b, c, d, from_cycle] => (seed, [a, b, c, d], from_cycle),
        _ => {
            return Err(format!(
                "five or six whole numbers, seed,lost,doubled,late,corrupted[,from cycle], got {text}"
            ));
        }
    };
    if shares.iter().sum::<u32>() > 1000 {
        return Err(format!(
            "the shares are per mille of all frames and make at most 1000 together, got {shares:?}"
        ));
    }
    let [
        lost_per_mille,
        doubled_per_mille,
        late_per_mille,
        corrupted_per_mille,
    ] = shares.map(|share| u16::try_from(share).unwrap_or(u16::MAX));
    Ok(bus::FaultPlan {
        seed: u64::from(seed),
        lost_per_mille,
        doubled_per_mille,
        late_per_mille,
        corrupted_per_mille,
        from_cycle,
        ..bus::FaultPlan::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_plan_has_four_shares_and_perhaps_a_first_cycle() {
        let plan = fault_plan("7,50,0,10,0").unwrap();
        assert_eq!(
            (
                plan.seed,
                plan.lost_per_mille,
                plan.late_per_mille,
                plan.from_cycle
            ),
            (7, 50, 10, 100)
        );
        assert_eq!(fault_plan("7,50,0,10,0,2000").unwrap().from_cycle, 2000);
    }

    #[test]
    fn a_fault_plan_that_is_none_is_refused_with_what_was_wanted() {
        for wrong in [
            "",
            "7",
            "7,50,0,10",
            "7,50,0,10,0,1,1",
            "7,50,0,-10,0",
            "a,b,c,d,e",
        ] {
            assert!(
                fault_plan(wrong)
                    .unwrap_err()
                    .contains("five or six whole numbers"),
                "{wrong}"
            );
        }
        assert!(
            fault_plan("7,500,500,1,0")
                .unwrap_err()
                .contains("at most 1000")
        );
    }
}
