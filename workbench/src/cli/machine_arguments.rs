//! Where the machine is and who beats its time: arguments that several commands share.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::ValueEnum;
use plant_sim::Machine;

use crate::error::Outcome;
use crate::network::interfaces::DEADLINE_MS;
use crate::network::place::{Place, refuse_overload, wired};

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

/// The machine of a file; the built-in reference machine without one.
///
/// # Errors
/// Where the file is wrong.
pub fn machine_file(path: Option<&Path>) -> Outcome<Machine> {
    match path {
        Some(path) => Ok(Machine::read(path)?),
        None => Ok(Machine::reference()),
    }
}

impl MachineArguments {
    /// The machine, and the place where it is.
    ///
    /// # Errors
    /// Where its file is wrong, or its bus cannot carry the cycle at the pace of a clock.
    pub fn machine_and_place(&self) -> Outcome<(Machine, Place)> {
        let machine = machine_file(self.machine.as_deref())?;
        let Some(names) = self.can.clone() else {
            return Ok((machine, Place::InProcess));
        };
        let machine = wired(machine, &names);
        let pace = self.pace.chosen();
        refuse_overload(&machine, pace)?;
        Ok((machine, Place::Can { names, pace }))
    }
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
