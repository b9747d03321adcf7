//! The machine at the other end of CAN interfaces: its nodes run in processes or on boards of their
//! own, and time is that of the clock on the wall.
//!
//! Lock-step waits for everybody, clock pace sends SYNC on a grid of its period, and passes over
//! cycles for which it came too late. The patience with a cycle is
//! shared by its buses: what one bus has used up is not there for the others.

use std::io;
use std::time::{Duration, Instant};

use bus::{BusLog, CanPort, RealTime};
use plant_sim::Machine;
use plant_sim::node::Truth;
use protocol::CanFrame;
use quadrant_host::Pace;

use super::link::{Link, micros};
use crate::error::{Failure, Outcome};

/// Lock-step waits long for a frame, because on a busy machine a process may have to wait for its
/// turn.
pub const DEADLINE_MS: u64 = 1000;

/// The pace of interfaces of which nothing else was said.
pub const DEFAULT_PACE: Pace = Pace::Lockstep {
    deadline: Duration::from_millis(DEADLINE_MS),
};

/// The names of a list of interfaces, separated by commas.
pub(super) fn listed(names: &str) -> impl Iterator<Item = &str> + Clone {
    let names = names.split(',').map(str::trim);
    names.filter(|name| !name.is_empty())
}

/// Which axis is on which interface.
#[derive(Debug, PartialEq, Eq)]
struct Wiring {
    /// Interfaces, each once.
    names: Vec<String>,
    /// Place in `names`, per axis.
    bus_of: Vec<usize>,
}

impl Wiring {
    /// `own` are the interfaces that the machine file names; the other axes get those of `default`
    /// in turn.
    fn of<'m>(own: impl Iterator<Item = Option<&'m str>>, default: &str) -> Outcome<Self> {
        let defaults: Vec<&str> = listed(default).collect();
        if defaults.is_empty() {
            return Err(Failure::new(
                "--can needs the name of an interface, for example vcan0",
            ));
        }
        let mut names: Vec<String> = Vec::new();
        let mut bus_of = Vec::new();
        for (index, own) in own.enumerate() {
            let name = own.unwrap_or(defaults[index % defaults.len()]);
            let known = names.iter().position(|known| known == name);
            bus_of.push(known.unwrap_or(names.len()));
            if known.is_none() {
                names.push(name.to_owned());
            }
        }
        Ok(Self { names, bus_of })
    }
}

/// CAN interfaces of the kernel; the nodes run elsewhere.
pub struct Interfaces {
    ports: Vec<CanPort>,
    names: Vec<String>,
    bus_of: Vec<usize>,
    logs: Vec<BusLog>,
    logging: bool,
    begun: Instant,
    now_us: u64,
    pace: Pace,
    cycle_end: Option<Instant>,
    /// What is left of the patience of the present cycle.
    left: Duration,
    /// How much later than due the present cycle began, at clock pace.
    late: Option<Duration>,
    /// At clock pace, for as long as the interfaces are open.
    real_time: Option<RealTime>,
}

impl Interfaces {
    /// Opens the interfaces of a machine: `default` for axes that name none of their own; several
    /// names separated by commas are given to the axes in turn.
    ///
    /// # Errors
    /// Where an interface cannot be opened.
    pub fn open(machine: &Machine, default: &str) -> Outcome<Self> {
        let own = machine.axes.iter().map(|axis| axis.interface.as_deref());
        let Wiring { names, bus_of } = Wiring::of(own, default)?;
        let open = |name: &String| {
            CanPort::open(name, &[]).map_err(|error| Failure::new(error.to_string()))
        };
        let ports = names.iter().map(open).collect::<Outcome<Vec<_>>>()?;
        Ok(Self {
            ports,
            names,
            bus_of,
            logs: Vec::new(),
            logging: false,
            begun: Instant::now(),
            now_us: 0,
            pace: DEFAULT_PACE,
            cycle_end: None,
            left: Duration::ZERO,
            late: None,
            real_time: None,
        })
    }

    /// The same interfaces at another pace: that of the nodes. At clock pace the present thread
    /// runs in real time while they are open, where the system permits it.
    #[must_use]
    pub fn with_pace(self, pace: Pace) -> Self {
        let real_time = (pace == Pace::Clock).then(RealTime::begin);
        Self {
            pace,
            real_time,
            ..self
        }
    }

    /// How long a cycle waits for its frames. In lock-step half as long again as the nodes'
    /// deadline, so that a node that closes its cycle at the deadline is heard, and does not begin
    /// the next one by its own timer meanwhile.
    fn patience(&self) -> Duration {
        match self.pace {
            Pace::Lockstep { deadline } => deadline + deadline / 2,
            Pace::Clock => self.cycle_end.map_or(Duration::ZERO, |end| {
                end.saturating_duration_since(Instant::now())
            }),
        }
    }

    /// Clock pace: sleeps until the present cycle is over; gives how many cycles were passed over.
    fn wait_for_the_clock(&mut self, cycle: Duration) -> u32 {
        let mut due = self.cycle_end.unwrap_or_else(Instant::now);
        let mut skipped = 0;
        loop {
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            let late = Instant::now().saturating_duration_since(due);
            let (more, begins) = caught_up(late, cycle);
            due += cycle * more;
            skipped += more;
            if begins {
                self.late = Some(late.saturating_sub(cycle * more));
                self.cycle_end = Some(due + cycle);
                return skipped;
            }
        }
    }

    fn note(&mut self, bus: usize, frame: &CanFrame) {
        if self.logging {
            self.logs[bus].push(self.now_us, frame);
        }
    }

    fn failed(&self, bus: usize, error: &io::Error) -> Failure {
        Failure::new(format!("CAN interface {}: {error}", self.names[bus]))
    }
}

/// What is made of a cycle that begins late by so much: how many are passed over, and whether the
/// next one begins now or is waited for. The nodes go on by their own timers and count on, so the
/// cycles stay on the grid, each with the number that it has there; and two SYNCs close together
/// are worse for them than one that is missing.
fn caught_up(late: Duration, cycle: Duration) -> (u32, bool) {
    let whole = late.as_nanos() / cycle.as_nanos().max(1);
    let whole = u32::try_from(whole).unwrap_or(u32::MAX - 1);
    let rest = late.saturating_sub(cycle * whole);
    if rest > cycle / 2 {
        (whole + 1, false)
    } else {
        (whole, true)
    }
}

impl Link for Interfaces {
    fn buses(&self) -> usize {
        self.ports.len()
    }

    fn bus_of(&self, axis: usize) -> usize {
        self.bus_of[axis]
    }

    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()> {
        self.ports[bus]
            .send(&frame)
            .map_err(|error| self.failed(bus, &error))?;
        self.note(bus, &frame);
        Ok(())
    }

    fn receive(&mut self, bus: usize, timeout: Duration) -> Outcome<Option<CanFrame>> {
        let received = self.ports[bus]
            .receive(timeout)
            .map_err(|error| self.failed(bus, &error))?;
        if let Some(frame) = received {
            self.note(bus, &frame);
        }
        Ok(received)
    }

    fn receive_in_cycle(
        &mut self,
        bus: usize,
        most: Option<Duration>,
    ) -> Outcome<Option<CanFrame>> {
        if self.pace == Pace::Clock {
            self.left = self.patience();
        }
        // A short wait on this bus takes what it lasted, and no more, from the patience with the
        // others.
        let allowed = most.map_or(self.left, |most| most.min(self.left));
        let mut left = allowed;
        let received = self.ports[bus]
            .receive_within(&mut left)
            .map_err(|error| self.failed(bus, &error))?;
        self.left = self.left.saturating_sub(allowed.saturating_sub(left));
        if let Some(frame) = received {
            self.note(bus, &frame);
        }
        Ok(received)
    }

    /// The log's times are those of the begin of each cycle: reading the clock for every frame
    /// costs a third of a lock-step cycle where it is a system call.
    fn pass(&mut self, cycle: Duration) -> u32 {
        let skipped = if self.pace == Pace::Clock {
            self.wait_for_the_clock(cycle)
        } else {
            0
        };
        self.left = self.patience();
        self.now_us = micros(self.begun.elapsed());
        skipped
    }

    fn follows_clock(&self) -> bool {
        self.pace == Pace::Clock
    }

    fn scheduling(&self) -> Option<String> {
        self.real_time.as_ref().map(RealTime::granted)
    }

    fn is_due(&self) -> bool {
        let end = self.cycle_end.filter(|_| self.pace == Pace::Clock);
        end.is_some_and(|end| end <= Instant::now())
    }

    fn lateness(&self) -> Option<Duration> {
        self.late
    }

    fn truth(&self, _axis: usize) -> Option<Truth> {
        None
    }

    fn start_log(&mut self) {
        self.logs = self.names.iter().map(|name| BusLog::new(name)).collect();
        self.logging = true;
    }

    fn take_logs(&mut self) -> Vec<BusLog> {
        self.logging = false;
        std::mem::take(&mut self.logs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wiring(own: &[Option<&str>], default: &str) -> Outcome<(Vec<String>, Vec<usize>)> {
        Wiring::of(own.iter().copied(), default).map(|wiring| (wiring.names, wiring.bus_of))
    }

    #[test]
    fn a_late_cycle_has_the_number_of_the_grid_and_none_begins_in_its_second_half() {
        let ms = |value: f64| Duration::from_secs_f64(1.0e-3 * value);
        let near = |late: f64| caught_up(ms(late), ms(1.0));
        assert_eq!(near(0.0), (0, true));
        assert_eq!(near(0.4), (0, true));
        assert_eq!(near(0.7), (1, false));
        assert_eq!(near(3.4), (3, true));
        assert_eq!(near(3.8), (4, false));
        // A minute in a debugger.
        assert_eq!(near(60_000.2), (60_000, true));
    }

    #[test]
    fn axes_without_an_interface_of_their_own_get_the_named_ones_in_turn() {
        let (names, bus_of) = wiring(&[None, None, None], "can0, can1").unwrap();
        assert_eq!(names, ["can0", "can1"]);
        assert_eq!(bus_of, [0, 1, 0]);
    }

    #[test]
    fn an_interface_that_several_axes_name_is_opened_once() {
        let (names, bus_of) = wiring(&[Some("can7"), None, Some("can7")], "can0").unwrap();
        assert_eq!(names, ["can7", "can0"]);
        assert_eq!(bus_of, [0, 1, 0]);
    }

    #[test]
    fn no_interface_at_all_is_refused_with_an_example() {
        let refusal = wiring(&[None], " , ").unwrap_err().to_string();
        assert!(refusal.contains("for example vcan0"), "{refusal}");
    }
}
