//! The workbench's end of the buses: one trait, in process or on CAN interfaces.

use std::io;
use std::time::{Duration, Instant};

use bus::{BusLog, CanPort, InProcessBus, Shared};
use plant_sim::node::Truth;
use plant_sim::{Machine, PlantNode};
use protocol::CanFrame;
use protocol::cob::AxisIds;
use quadrant_host::Pace;

use crate::cli::PaceArguments;
use crate::error::{Failure, Outcome};

/// The buses of a machine, seen by the workbench.
pub trait Link {
    /// Number of buses.
    fn buses(&self) -> usize;
    /// Bus of an axis.
    fn bus_of(&self, axis: usize) -> usize;
    /// Sends a frame on a bus.
    ///
    /// # Errors
    /// Where the interface does not take it.
    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()>;
    /// Waits for a frame on a bus; `None` after the timeout.
    ///
    /// # Errors
    /// Where the interface is gone.
    fn receive(&mut self, bus: usize, timeout: Duration) -> Outcome<Option<CanFrame>>;
    /// Waits for a frame of the present cycle; `None` when the cycle does not wait any longer: in
    /// process and at clock pace at its end, in lock-step over interfaces after some time
    /// ([`Interfaces::with_pace`]). Where nobody but silent nodes is waited for, `most` ends the
    /// wait earlier.
    ///
    /// # Errors
    /// Where the interface is gone.
    fn receive_in_cycle(&mut self, bus: usize, most: Option<Duration>)
    -> Outcome<Option<CanFrame>>;
    /// The next cycle begins.
    fn pass(&mut self, cycle: Duration);
    /// What the axis truly does, where an instrument can see it; `None` over a cable.
    fn truth(&self, axis: usize) -> Option<Truth>;
    /// Starts logging all frames.
    fn start_log(&mut self);
    /// Ends logging; one log per bus.
    fn take_logs(&mut self) -> Vec<BusLog>;
}

/// Node ids of axis `index`.
///
/// # Errors
/// Beyond 16 axes.
pub fn axis_ids(index: usize) -> Outcome<AxisIds> {
    let ids = u8::try_from(index).ok().and_then(AxisIds::of_axis);
    ids.ok_or_else(|| Failure::new("a machine has at most 16 axes"))
}

/// Servo and plant of every axis in this process, one bus per axis (or per named interface).
pub struct InProcess {
    buses: Vec<InProcessBus>,
    bus_of: Vec<usize>,
    plants: Vec<Shared<PlantNode>>,
    servos: Vec<Shared<servo::Servo>>,
    period_us: u64,
}

impl InProcess {
    /// A machine on in-process buses. `run` tells the noise of one run from that of another.
    ///
    /// # Errors
    /// Beyond 16 axes.
    pub fn new(machine: &Machine, run: u64) -> Outcome<Self> {
        let period_us = micros(Duration::from_secs_f64(machine.period_s));
        let mut link = Self {
            buses: Vec::new(),
            bus_of: Vec::new(),
            plants: Vec::new(),
            servos: Vec::new(),
            period_us,
        };
        let mut names: Vec<Option<&str>> = Vec::new();
        for (index, axis) in machine.axes.iter().enumerate() {
            let shared = names
                .iter()
                .position(|name| name.is_some() && *name == axis.interface.as_deref());
            let bus = shared.unwrap_or_else(|| {
                names.push(axis.interface.as_deref());
                link.buses.push(InProcessBus::new());
                link.buses.len() - 1
            });
            let ids = axis_ids(index)?;
            let plant = PlantNode::new(
                ids,
                axis.actual.clone(),
                machine.period_s,
                plant_seed(machine.seed, run, index),
            );
            let plant = Shared::new(plant);
            let servo = Shared::new(servo::Servo::new(ids));
            link.buses[bus].add(Box::new(plant.clone()));
            link.buses[bus].add(Box::new(servo.clone()));
            link.plants.push(plant);
            link.servos.push(servo);
            link.bus_of.push(bus);
        }
        Ok(link)
    }

    /// The bus of an axis, for faults and dead nodes. Places: plant `2 a`, servo `2 a + 1` where
    /// each axis has its own bus (0 and 1 then).
    pub fn bus_mut(&mut self, axis: usize) -> &mut InProcessBus {
        &mut self.buses[self.bus_of[axis]]
    }

    /// The servo of an axis.
    #[must_use]
    pub fn servo(&self, axis: usize) -> Shared<servo::Servo> {
        self.servos[axis].clone()
    }

    /// The plant of an axis.
    #[must_use]
    pub fn plant(&self, axis: usize) -> Shared<PlantNode> {
        self.plants[axis].clone()
    }
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// Seed of a plant's noise: the same for a plant process of its own, so that runs over vcan repeat
/// those in process.
#[must_use]
pub fn plant_seed(machine_seed: u64, run: u64, axis: usize) -> u64 {
    let axis = u64::try_from(axis).unwrap_or(u64::MAX);
    machine_seed
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(run << 8)
        .wrapping_add(axis)
}

impl Link for InProcess {
    fn buses(&self) -> usize {
        self.buses.len()
    }

    fn bus_of(&self, axis: usize) -> usize {
        self.bus_of[axis]
    }

    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()> {
        self.buses[bus].send(frame);
        Ok(())
    }

    fn receive(&mut self, bus: usize, timeout: Duration) -> Outcome<Option<CanFrame>> {
        Ok(self.buses[bus].receive(micros(timeout)))
    }

    /// The end of the cycle is patience enough: nobody is late in process.
    fn receive_in_cycle(
        &mut self,
        bus: usize,
        _most: Option<Duration>,
    ) -> Outcome<Option<CanFrame>> {
        let bus = &mut self.buses[bus];
        let begun_us = bus.cycle_start_us().unwrap_or(bus.now_us());
        Ok(bus.receive_until(begun_us.saturating_add(self.period_us)))
    }

    fn pass(&mut self, cycle: Duration) {
        self.buses
            .iter_mut()
            .for_each(|bus| bus.pass(micros(cycle)));
    }

    fn truth(&self, axis: usize) -> Option<Truth> {
        Some(self.plants[axis].borrow().truth())
    }

    fn start_log(&mut self) {
        for (index, bus) in self.buses.iter_mut().enumerate() {
            bus.log(BusLog::new(&format!("can{index}")));
        }
    }

    fn take_logs(&mut self) -> Vec<BusLog> {
        self.buses
            .iter_mut()
            .filter_map(InProcessBus::take_log)
            .collect()
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
}

impl Interfaces {
    /// Opens the interfaces of a machine: `default` for axes that name none of their own; several
    /// names separated by commas are given to the axes in turn.
    ///
    /// # Errors
    /// Where an interface cannot be opened.
    pub fn open(machine: &Machine, default: &str) -> Outcome<Self> {
        let defaults: Vec<&str> = default
            .split(',')
            .map(str::trim)
            .filter(|name| !name.is_empty())
            .collect();
        if defaults.is_empty() {
            return Err(Failure::new(
                "--can needs the name of an interface, for example vcan0",
            ));
        }
        let mut names: Vec<String> = Vec::new();
        let mut bus_of = Vec::new();
        for (index, axis) in machine.axes.iter().enumerate() {
            let name = axis
                .interface
                .clone()
                .unwrap_or_else(|| defaults[index % defaults.len()].to_owned());
            let bus = names
                .iter()
                .position(|known| *known == name)
                .unwrap_or_else(|| {
                    names.push(name);
                    names.len() - 1
                });
            bus_of.push(bus);
        }
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
            pace: PaceArguments::default().chosen(),
            cycle_end: None,
            left: Duration::ZERO,
        })
    }

    /// The same interfaces at another pace: that of the nodes.
    #[must_use]
    pub fn with_pace(self, pace: Pace) -> Self {
        Self { pace, ..self }
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

    /// Clock pace: sleeps until the present cycle is over. The cycles lie on a grid; one that
    /// begins more than half a period late moves it, because two SYNCs close together are worse for
    /// the nodes than one that is late.
    fn wait_for_the_clock(&mut self, cycle: Duration) {
        let now = Instant::now();
        let due = self.cycle_end.unwrap_or(now);
        std::thread::sleep(due.saturating_duration_since(now));
        let woke = Instant::now();
        let start = if woke.saturating_duration_since(due) > cycle / 2 {
            woke
        } else {
            due
        };
        self.cycle_end = Some(start + cycle);
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
    fn pass(&mut self, cycle: Duration) {
        if self.pace == Pace::Clock {
            self.wait_for_the_clock(cycle);
        }
        self.left = self.patience();
        self.now_us = micros(self.begun.elapsed());
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
