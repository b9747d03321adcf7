//! Where a machine is, and the way to its buses.

use plant_sim::Machine;
use quadrant_host::Pace;

use super::in_process::InProcess;
use super::interfaces::{Interfaces, listed};
use super::link::Link;
use crate::error::{Failure, Outcome};
use crate::progress;

/// Where the machine is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Place {
    /// Servo and plant in this process.
    #[default]
    InProcess,
    /// On CAN interfaces.
    Can {
        /// Their names, separated by commas.
        names: String,
        /// Who beats the time.
        pace: Pace,
    },
}

impl Place {
    /// In a few words for a report.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self {
            Self::InProcess => "in-process bus".into(),
            Self::Can { names, pace } => {
                let pace = match pace {
                    Pace::Lockstep { .. } => "lock-step",
                    Pace::Clock => "clock",
                };
                format!("{names}, pace {pace}")
            }
        }
    }

    /// The buses of a machine at this place. `run` tells the noise of one run from that of another.
    ///
    /// # Errors
    /// Where an interface cannot be opened.
    pub fn open(&self, machine: &Machine, run: u64) -> Outcome<Box<dyn Link>> {
        Ok(match self {
            Self::InProcess => Box::new(InProcess::new(machine, run)?),
            Self::Can { names, pace } => {
                let link = Interfaces::open(machine, names)?.with_pace(*pace);
                if let Some(granted) = link.scheduling() {
                    progress::step(&format!("pace of the clock: {granted}"));
                }
                Box::new(link)
            }
        })
    }
}

/// A machine whose axes are on the interfaces that it names, the others on these in turn: what
/// shares a bus decides its load.
#[must_use]
pub fn wired(mut machine: Machine, names: &str) -> Machine {
    for (axis, name) in machine.axes.iter_mut().zip(listed(names).cycle()) {
        axis.interface.get_or_insert_with(|| name.to_owned());
    }
    machine
}

/// On a clock, a bus that cannot carry the cycle misses deadlines; vcan would not show it, so the
/// computed load decides.
///
/// # Errors
/// The load, and what makes it less.
pub fn refuse_overload(machine: &Machine, pace: Pace) -> Outcome<()> {
    let load = machine.bus_load_per_mille();
    if pace == Pace::Clock && load > protocol::load::CLOCK_PACED_LIMIT_PER_MILLE {
        return Err(Failure::new(format!(
            "machine {}: {}.{} % computed bus load, a clock-paced run takes at most {} %; give each axis its own interface, a longer period_s or CAN FD",
            machine.name,
            load / 10,
            load % 10,
            protocol::load::CLOCK_PACED_LIMIT_PER_MILLE / 10
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_axes_on_one_interface_are_more_than_a_clock_takes_and_one_each_are_not() {
        let machine = |names: &str| wired(Machine::reference(), names);
        assert_eq!(refuse_overload(&machine("can0,can1"), Pace::Clock), Ok(()));
        let refusal = refuse_overload(&machine("can0"), Pace::Clock).unwrap_err();
        assert!(refusal.to_string().contains("at most 80 %"), "{refusal}");
        let pace = crate::network::interfaces::DEFAULT_PACE;
        assert_eq!(refuse_overload(&machine("can0"), pace), Ok(()));
    }
}
