//! Runs on a machine: connect, configure, enable, move; and whatever happens, stop, disable, write
//! the log.

use std::path::Path;

use plant_sim::Machine;
use quadrant_host::Pace;

use crate::ballbar::Point;
use crate::compensation::AxisCompensation;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::network::link::{InProcess, Interfaces, Link};
use crate::network::master::{AxisCycle, Master};
use crate::trajectory::{Circle, MEASURE_FROM_RAD, Move};

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

/// A machine that moves, and stops as one where an axis has trouble or the operator wants it.
pub struct Session<'a, L: Link = Box<dyn Link>> {
    machine: &'a Machine,
    master: Master<L>,
    interrupt: Interrupt,
}

impl Link for Box<dyn Link> {
    fn buses(&self) -> usize {
        self.as_ref().buses()
    }

    fn bus_of(&self, axis: usize) -> usize {
        self.as_ref().bus_of(axis)
    }

    fn send(&mut self, bus: usize, frame: protocol::CanFrame) -> Outcome<()> {
        self.as_mut().send(bus, frame)
    }

    fn receive(
        &mut self,
        bus: usize,
        timeout: std::time::Duration,
    ) -> Outcome<Option<protocol::CanFrame>> {
        self.as_mut().receive(bus, timeout)
    }

    fn receive_in_cycle(
        &mut self,
        bus: usize,
        most: Option<std::time::Duration>,
    ) -> Outcome<Option<protocol::CanFrame>> {
        self.as_mut().receive_in_cycle(bus, most)
    }

    fn pass(&mut self, cycle: std::time::Duration) {
        self.as_mut().pass(cycle);
    }

    fn truth(&self, axis: usize) -> Option<plant_sim::node::Truth> {
        self.as_ref().truth(axis)
    }

    fn start_log(&mut self) {
        self.as_mut().start_log();
    }

    fn take_logs(&mut self) -> Vec<bus::BusLog> {
        self.as_mut().take_logs()
    }
}

impl<'a> Session<'a> {
    /// Connects to a machine, downloads its parameters and enables its drives. `run` tells the
    /// noise of one run from that of another.
    ///
    /// # Errors
    /// Where a node does not answer, or a drive does not come up.
    pub fn open(
        machine: &'a Machine,
        place: &Place,
        compensation: &[AxisCompensation],
        run: u64,
    ) -> Outcome<Self> {
        let mut session = Self::connect(machine, place, run, &Interrupt::never())?;
        session.ready(compensation)?;
        Ok(session)
    }

    /// Connects to a machine; nothing is sent yet.
    ///
    /// # Errors
    /// Where an interface cannot be opened.
    pub fn connect(
        machine: &'a Machine,
        place: &Place,
        run: u64,
        interrupt: &Interrupt,
    ) -> Outcome<Self> {
        let link: Box<dyn Link> = match place {
            Place::InProcess => Box::new(InProcess::new(machine, run)?),
            Place::Can { names, pace } => {
                Box::new(Interfaces::open(machine, names)?.with_pace(*pace))
            }
        };
        Self::on(link, machine, interrupt)
    }
}

impl<'a, L: Link> Session<'a, L> {
    /// A session on a link; nothing is sent yet.
    ///
    /// # Errors
    /// Beyond 16 axes.
    pub fn on(link: L, machine: &'a Machine, interrupt: &Interrupt) -> Outcome<Self> {
        let master = Master::on(link, machine)?.until(interrupt.clone());
        Ok(Self {
            machine,
            master,
            interrupt: interrupt.clone(),
        })
    }

    /// Finds the nodes, downloads the parameters and enables the drives.
    ///
    /// # Errors
    /// Where a node does not answer, a drive does not come up, or the operator has interrupted.
    pub fn ready(&mut self, compensation: &[AxisCompensation]) -> Outcome<()> {
        self.interrupt.check()?;
        let configured = self
            .master
            .find_nodes()
            .and_then(|()| self.master.configure(self.machine, compensation));
        // A signal ends the waiting for an answer too: that is no silence of the node.
        self.interrupt.check()?;
        configured?;
        self.master.enable()
    }

    /// Enables the drives, does `work`, disables them and writes the candump log: whatever becomes
    /// of the work.
    ///
    /// # Errors
    /// The first of: enabling, the work, disabling, writing.
    pub fn perform<T>(
        mut self,
        compensation: &[AxisCompensation],
        log: Option<&Path>,
        work: impl FnOnce(&mut Self) -> Outcome<T>,
    ) -> Outcome<T> {
        let outcome = self.ready(compensation).and_then(|()| work(&mut self));
        // A machine that has never cycled has nothing to disable and nothing to tell.
        if self.master.cycles() == 0 {
            return outcome;
        }
        let disabled = self.master.disable();
        let logs = self.master.into_link().take_logs();
        let written = log.map_or(Ok(()), |path| write_logs(path, &logs));
        match (outcome, log, written) {
            (Ok(done), _, written) => disabled.and(written).map(|()| done),
            (Err(failure), None, _) => Err(failure),
            (Err(failure), Some(path), Ok(())) => {
                Err(Failure::new(format!("{failure}; log: {}", path.display())))
            }
            (Err(failure), Some(_), Err(lost)) => Err(Failure::new(format!(
                "{failure}; and its log was lost: {lost}"
            ))),
        }
    }

    /// The master: what the drives told last.
    #[must_use]
    pub const fn master(&self) -> &Master<L> {
        &self.master
    }

    /// The master, for tests that pull plugs.
    pub fn master_mut(&mut self) -> &mut Master<L> {
        &mut self.master
    }

    /// Changes the compensation of drives that are running.
    ///
    /// # Errors
    /// Where the drive refuses it.
    pub fn compensate(&mut self, compensation: &[AxisCompensation]) -> Outcome<()> {
        self.master.configure(self.machine, compensation)
    }

    /// Moves to a position and comes to rest.
    ///
    /// # Errors
    /// Where a drive faults on the way.
    pub fn go_to(&mut self, to: &[f64]) -> Outcome<()> {
        let from: Vec<f64> = (0..to.len())
            .map(|axis| self.master.axis(axis).reference_m)
            .collect();
        let limits = self.machine.axes.iter().map(|axis| axis.limits);
        let velocity = limits
            .clone()
            .map(|l| l.velocity_m_per_s)
            .fold(f64::INFINITY, f64::min);
        let acceleration = limits
            .map(|l| l.acceleration_m_per_s2)
            .fold(f64::INFINITY, f64::min);
        let path = Move::new(&from, to, 0.5 * velocity, 0.5 * acceleration);
        self.follow(path.duration_s(), |time_s| path.at(time_s), |_, _| ())?;
        self.follow(SETTLE_S, |_| to.to_vec(), |_, _| ())
    }

    /// Follows a trajectory; `each` sees every cycle with the time since the begin.
    ///
    /// # Errors
    /// Where an axis faults or falls silent on the way, or the operator interrupts: all axes stand
    /// then, and are disabled.
    pub fn follow(
        &mut self,
        duration_s: f64,
        at: impl Fn(f64) -> Vec<f64>,
        mut each: impl FnMut(f64, &[AxisCycle]),
    ) -> Outcome<()> {
        let period_s = self.machine.period_s;
        let cycles = (duration_s / period_s).ceil().max(0.0);
        let mut now = vec![AxisCycle::default(); self.machine.axes.len()];
        let mut index = 0.0;
        while index < cycles {
            // The setpoint that is sent in this cycle is due in the next one.
            self.master.cycle(&at((index + 1.0) * period_s))?;
            for (axis, cycle) in now.iter_mut().enumerate() {
                *cycle = self.master.axis(axis);
            }
            each(index * period_s, &now);
            index += 1.0;
            if self.master.must_stop() {
                return Err(self.master.stop());
            }
        }
        Ok(())
    }

    /// Runs a circle and gives the turns that count.
    ///
    /// # Errors
    /// Where the machine has not two axes, the circle does not fit, or a drive faults.
    pub fn circle(&mut self, circle: &Circle) -> Outcome<Vec<Point>> {
        check_circle(self.machine, circle)?;
        let rest: Vec<f64> = vec![0.0; self.machine.axes.len() - 2];
        let setpoints = |[x, y]: [f64; 2]| [vec![x, y], rest.clone()].concat();
        self.go_to(&setpoints(circle.at(0.0)))?;
        let mut points = Vec::new();
        let measured = MEASURE_FROM_RAD..circle.measure_to_rad();
        self.follow(
            circle.duration_s(),
            |time_s| setpoints(circle.at(time_s)),
            |time_s, axes| {
                let angle_rad = circle.angle_rad(time_s);
                if measured.contains(&angle_rad) {
                    points.push(point(angle_rad, axes));
                }
            },
        )?;
        Ok(points)
    }

    /// Whether bursts are seen by an instrument at the machine, or by the load scale.
    #[must_use]
    pub fn sees_truth(&self) -> bool {
        self.master.axis(0).truth.is_some()
    }

    /// Disables the drives and gives the logs of all buses.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn close(mut self) -> Outcome<Vec<bus::BusLog>> {
        self.master.disable()?;
        Ok(self.master.into_link().take_logs())
    }

    /// Cycles whose torque did not come in time.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.master.missed()
    }

    /// Cycles so far.
    #[must_use]
    pub const fn cycles(&self) -> u64 {
        self.master.cycles()
    }
}

/// Writes the logs of all buses into one candump log.
///
/// # Errors
/// Where it cannot be written.
pub fn write_logs(path: &Path, logs: &[bus::BusLog]) -> Outcome<()> {
    let failed = |error: std::io::Error| Failure::file(path, &error);
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).map_err(failed)?);
    logs.iter()
        .try_for_each(|log| log.write(&mut file))
        .map_err(failed)?;
    std::io::Write::flush(&mut file).map_err(failed)
}

/// Rest after a move, so that nothing of it is left on the record.
const SETTLE_S: f64 = 0.3;

fn point(angle_rad: f64, axes: &[AxisCycle]) -> Point {
    let of = |value: &dyn Fn(&AxisCycle) -> f64| [value(&axes[0]), value(&axes[1])];
    Point {
        angle_rad,
        table_m: of(&|axis| axis.truth.map_or(axis.load_m, |truth| truth.table_m)),
        motor_m: of(&|axis| axis.truth.map_or(axis.motor_m, |truth| truth.motor_m)),
        reference_m: of(&|axis| axis.reference_m),
    }
}

/// Refuses a circle that the machine cannot run.
///
/// # Errors
/// What does not fit, and the limit.
pub fn check_circle(machine: &Machine, circle: &Circle) -> Outcome<()> {
    let [x, y, ..] = &machine.axes[..] else {
        return Err(Failure::new(format!(
            "machine {}: a circle needs two axes, this machine has {}",
            machine.name,
            machine.axes.len()
        )));
    };
    for axis in [x, y] {
        let limits = &axis.limits;
        let acceleration = circle.feed_m_per_s * circle.feed_m_per_s / circle.radius_m;
        for (what, wanted, limit, unit) in [
            (
                "--radius-mm",
                circle.radius_m * 1.0e3,
                limits.travel_m * 1.0e3,
                "mm of travel",
            ),
            (
                "--feed-mm-min",
                circle.feed_m_per_s * 6.0e4,
                limits.velocity_m_per_s * 6.0e4,
                "mm/min of velocity",
            ),
            (
                "--feed-mm-min with --radius-mm",
                acceleration,
                limits.acceleration_m_per_s2,
                "m/s² of acceleration",
            ),
        ] {
            if wanted > limit {
                return Err(Failure::new(format!(
                    "{what}: axis {} allows {limit} {unit}, the circle needs {wanted:.3}",
                    axis.name
                )));
            }
        }
    }
    Ok(())
}
