//! The machine in this process: servo and plant of every axis on simulated buses, in virtual time.
//!
//! Each axis has a bus of its own; axes that name the same interface in the machine file share one,
//! as they would share the cable.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use bus::{BusLog, InProcessBus, Shared};
use plant_sim::node::Truth;
use plant_sim::{Machine, PlantNode};
use protocol::{CanFrame, Station};

use super::link::{Link, axis_ids, micros};
use super::stopwatch::{Durations, Watched};
use crate::error::Outcome;

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
        Self::assembled(machine, run, |servo| Box::new(servo))
    }

    /// The same, with what each drive costs for one torque noted.
    ///
    /// # Errors
    /// Beyond 16 axes.
    pub fn watched(machine: &Machine, run: u64, steps: &Rc<RefCell<Durations>>) -> Outcome<Self> {
        Self::assembled(machine, run, |servo| {
            Box::new(Watched::new(servo, Rc::clone(steps)))
        })
    }

    fn assembled(
        machine: &Machine,
        run: u64,
        on_bus: impl Fn(Shared<servo::Servo>) -> Box<dyn Station>,
    ) -> Outcome<Self> {
        let mut link = Self {
            buses: Vec::new(),
            bus_of: Vec::new(),
            plants: Vec::new(),
            servos: Vec::new(),
            period_us: micros(Duration::from_secs_f64(machine.period_s)),
        };
        let mut names = Vec::new();
        for (index, axis) in machine.axes.iter().enumerate() {
            let ids = axis_ids(index)?;
            let seed = plant_seed(machine.seed, run, index);
            let plant = PlantNode::new(ids, axis.actual.clone(), machine.period_s, seed);
            let bus = link.bus_named(&mut names, axis.interface.as_deref());
            let servo = Shared::new(servo::Servo::new(ids));
            link.add_axis(bus, plant, servo.clone(), on_bus(servo));
        }
        Ok(link)
    }

    /// The bus of an interface's name; axes that name none have a bus each.
    fn bus_named<'m>(&mut self, names: &mut Vec<Option<&'m str>>, name: Option<&'m str>) -> usize {
        let known = names
            .iter()
            .position(|known| known.is_some() && *known == name);
        known.unwrap_or_else(|| {
            names.push(name);
            self.buses.push(InProcessBus::new());
            self.buses.len() - 1
        })
    }

    fn add_axis(
        &mut self,
        bus: usize,
        plant: PlantNode,
        servo: Shared<servo::Servo>,
        on_bus: Box<dyn Station>,
    ) {
        let plant = Shared::new(plant);
        self.buses[bus].add(Box::new(plant.clone()));
        self.buses[bus].add(on_bus);
        self.plants.push(plant);
        self.servos.push(servo);
        self.bus_of.push(bus);
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

    fn pass(&mut self, cycle: Duration) -> u32 {
        self.buses
            .iter_mut()
            .for_each(|bus| bus.pass(micros(cycle)));
        0
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
