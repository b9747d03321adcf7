//! Runs on a machine: connect, configure, enable, move; and whatever happens, stop, disable, write
//! the log.

use std::path::Path;

use plant_sim::Machine;
use servo::objects;

use crate::ballbar::Point;
use crate::compensation::AxisCompensation;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::network::candump::write_logs;
use crate::network::link::Link;
use crate::network::master::{AxisCycle, Master};
use crate::network::place::Place;
use crate::progress;
use crate::trajectory::circle_limits::{Slowest, check_circle};
use crate::trajectory::{Circle, MEASURE_FROM_RAD, Move};

/// A machine at its place, and the operator who may stop it: what every test on it needs.
#[derive(Clone, Debug)]
pub struct Stand<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Where it is.
    pub place: Place,
    /// The wish of the operator that it stops.
    pub interrupt: Interrupt,
}

impl<'a> Stand<'a> {
    /// A machine in this process, which nobody interrupts.
    #[must_use]
    pub fn in_process(machine: &'a Machine) -> Self {
        Self {
            machine,
            place: Place::InProcess,
            interrupt: Interrupt::never(),
        }
    }

    /// Connects to the machine; nothing is sent yet. `run` tells the noise of one run from that of
    /// another.
    ///
    /// # Errors
    /// Where an interface cannot be opened.
    pub fn connect(&self, run: u64) -> Outcome<Session<'a>> {
        Session::connect(self.machine, &self.place, run, &self.interrupt)
    }

    /// No compensation on any axis.
    #[must_use]
    pub fn uncompensated(&self) -> Vec<AxisCompensation> {
        vec![AxisCompensation::default(); self.machine.axes.len()]
    }

    /// Names of the axes.
    #[must_use]
    pub fn axis_names(&self) -> Vec<String> {
        self.machine
            .axes
            .iter()
            .map(|axis| axis.name.clone())
            .collect()
    }
}

/// A machine that moves, and stops as one where an axis has trouble or the operator wants it.
pub struct Session<'a, L: Link = Box<dyn Link>> {
    machine: &'a Machine,
    master: Master<L>,
    interrupt: Interrupt,
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
        Self::on(place.open(machine, run)?, machine, interrupt)
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
        // Every frame stays in memory until it is written: hours of tuning would fill it.
        if log.is_some() {
            self.master.link_mut().start_log();
        }
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
        let slowest = Slowest::of(self.machine);
        let path = Move::new(
            &from,
            to,
            0.5 * slowest.velocity_m_per_s,
            0.5 * slowest.acceleration_m_per_s2,
        );
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
        // On a clock nothing may wait for a terminal.
        let mut told = (!self.master.follows_clock()).then(|| progress::Long::of(cycles));
        while index < cycles {
            if let Some(told) = told.as_mut().filter(|_| index % ASK_EVERY == 0.0) {
                told.at(index);
            }
            // The setpoint that is sent in this cycle is due in the next one.
            let due = |skipped: u32| at((index + f64::from(skipped) + 1.0) * period_s);
            index += f64::from(self.master.cycle_at(due)?);
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

    /// Does some work while the machine holds its place: a clock does not wait for it, all others
    /// do.
    ///
    /// # Errors
    /// Where an interface is gone.
    ///
    /// # Panics
    /// Where the work does.
    pub fn meanwhile<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> Outcome<T> {
        if !self.master.follows_clock() {
            return Ok(work());
        }
        std::thread::scope(|scope| {
            let work = scope.spawn(work);
            while !work.is_finished() {
                self.master.hold()?;
            }
            work.join()
                .map_or_else(|panic| std::panic::resume_unwind(panic), Ok)
        })
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
        let machine = self.machine;
        let measured = MEASURE_FROM_RAD..circle.measure_to_rad();
        self.follow(
            circle.duration_s(),
            |time_s| setpoints(circle.at(time_s)),
            |time_s, axes| {
                let angle_rad = circle.angle_rad(time_s);
                if measured.contains(&angle_rad) && axes.iter().all(AxisCycle::shows_table) {
                    points.push(point(machine, angle_rad, axes));
                }
            },
        )?;
        Ok(points)
    }

    /// The factor on the levels of friction that each drive has refined.
    ///
    /// # Errors
    /// Where a drive does not answer.
    pub fn refined_levels(&mut self) -> Outcome<Vec<f64>> {
        let axes = 0..self.machine.axes.len();
        let read = |axis: usize| {
            let own = self.master.upload(axis, objects::REFINED_LEVEL)?;
            Ok(1.0e-6 * f64::from(own.to_i32()))
        };
        axes.map(read).collect()
    }

    /// What is seen: the table, by an instrument at the machine, or the load scale.
    #[must_use]
    pub fn sees(&self) -> &'static str {
        if self.master.axis(0).truth.is_some() {
            AT_TABLE
        } else {
            "load scale"
        }
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

/// What an instrument at the machine sees.
pub const AT_TABLE: &str = "table";

/// Cycles between two looks at the watch.
const ASK_EVERY: f64 = 256.0;

/// Rest after a move, so that nothing of it is left on the record.
const SETTLE_S: f64 = 0.3;

/// Where the table is in the plane of the first two axes: by an instrument, which sees both at
/// once, or by their scales.
#[must_use]
pub fn table_m(machine: &Machine, axes: &[AxisCycle]) -> [f64; 2] {
    in_plane(machine, axes, &AxisCycle::table_m)
}

/// The motors at the table, by the same instrument.
fn motor_m(machine: &Machine, axes: &[AxisCycle]) -> [f64; 2] {
    let of = |axis: &AxisCycle| axis.truth.map_or(axis.motor_m, |truth| truth.motor_m);
    in_plane(machine, axes, &of)
}

fn in_plane(machine: &Machine, axes: &[AxisCycle], of: &dyn Fn(&AxisCycle) -> f64) -> [f64; 2] {
    let place = [of(&axes[0]), of(&axes[1])];
    if axes.iter().all(|axis| axis.truth.is_some()) {
        machine.in_plane(place)
    } else {
        place
    }
}

fn point(machine: &Machine, angle_rad: f64, axes: &[AxisCycle]) -> Point {
    Point {
        angle_rad,
        table_m: table_m(machine, axes),
        motor_m: motor_m(machine, axes),
        reference_m: [axes[0].reference_m, axes[1].reference_m],
    }
}
