//! Runs of one axis with frames that go wrong, and what they differ by from the same run without.
//!
//! The axis is X of the reference machine *with* its force noise, whose seed is the machine's: two
//! runs differ by the losses alone.

use bus::{FaultPlan, Shared};
use plant_sim::Machine;
use plant_sim::node::Counters;
use protocol::cob::AxisIds;
use protocol::{CanFrame, Fault, Station};
use servo::Servo;
use servo::watchdog::Counts;
use workbench::network::in_process::InProcess;
use workbench::network::master::Master;

use crate::rig::{PLANT, SERVO, enabled};

/// Axis X of the reference machine with its force noise.
#[must_use]
pub fn noisy_axis() -> Machine {
    let mut machine = Machine::reference();
    machine.axes.truncate(1);
    machine
}

/// What happens to the frames of a run: at the servo's port and at the plant's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plans {
    /// At the servo.
    pub servo: FaultPlan,
    /// At the plant.
    pub plant: FaultPlan,
}

/// What the nodes counted during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Cycles with everything they needed.
    pub computed: u32,
    /// Cycles that went without something.
    pub bridged: u32,
    /// Cycles in which something was refused.
    pub refused: u32,
    /// Cycles that a deadline closed or the own timer began.
    pub by_deadline: u32,
}

impl Counted {
    fn servo(counts: Counts) -> Self {
        let Counts {
            computed,
            bridged,
            refused,
            by_deadline,
            ..
        } = counts;
        Self {
            computed,
            bridged,
            refused,
            by_deadline,
        }
    }

    fn plant(counters: Counters) -> Self {
        let Counters {
            computed,
            bridged,
            refused,
            by_deadline,
            ..
        } = counters;
        Self {
            computed,
            bridged,
            refused,
            by_deadline,
        }
    }

    fn since(self, before: Self) -> Self {
        Self {
            computed: self.computed - before.computed,
            bridged: self.bridged - before.bridged,
            refused: self.refused - before.refused,
            by_deadline: self.by_deadline - before.by_deadline,
        }
    }

    /// All cycles.
    #[must_use]
    pub const fn cycles(self) -> u32 {
        self.computed + self.bridged + self.refused
    }
}

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// True position of the table in each cycle, m.
    pub table_m: Vec<f64>,
    /// Force command at the plant, N.
    pub force_n: Vec<f64>,
    /// Faults latched.
    pub faults: Vec<Fault>,
    /// Frames that went wrong in a port.
    pub injected: u32,
    /// Counted by the servo.
    pub servo: Counted,
    /// Counted by the plant.
    pub plant: Counted,
}

/// Cycles at the end of a run that nothing disturbs, so that the counts of both nodes are complete.
pub const CALM_CYCLES: u32 = 20;

/// An enabled axis in the middle of a run.
pub struct Axis {
    /// The workbench.
    pub master: Master<InProcess>,
    /// The servo.
    pub servo: Shared<Servo>,
    /// The plant.
    pub plant: Shared<plant_sim::PlantNode>,
    origin_m: f64,
}

impl Axis {
    /// An enabled axis.
    ///
    /// # Panics
    /// Where it does not come up: there is nothing to test then.
    #[must_use]
    pub fn enabled(machine: &Machine) -> Self {
        let mut master = enabled(machine).expect("a healthy machine can be enabled");
        let (servo, plant) = (master.link_mut().servo(0), master.link_mut().plant(0));
        let origin_m = master.axis(0).reference_m;
        Self {
            master,
            servo,
            plant,
            origin_m,
        }
    }

    /// From now on this happens to the frames; cycle 1 of the plans is the next one.
    pub fn inject(&mut self, plans: Plans) {
        let bus = self.master.link_mut().bus_mut(0);
        bus.inject(SERVO, 0x01, plans.servo);
        bus.inject(PLANT, 0x11, plans.plant);
    }

    /// One cycle of the path: the setpoint of the next cycle, from where the axis was enabled.
    ///
    /// # Panics
    /// Where the bus is gone.
    pub fn cycle(&mut self, to_m: f64) {
        self.master
            .cycle(&[self.origin_m + to_m])
            .expect("an in-process bus is never gone");
    }

    /// Resets a fault and enables the axis where it is; tells whether that worked.
    pub fn enable_again(&mut self) -> bool {
        let up = self
            .master
            .reset_fault()
            .and_then(|()| self.master.enable());
        self.origin_m = self.master.axis(0).reference_m;
        up.is_ok()
    }

    fn counted(&self) -> [Counted; 2] {
        [
            Counted::servo(self.servo.borrow().counts()),
            Counted::plant(self.plant.borrow().counters()),
        ]
    }

    fn faults(&self) -> impl Iterator<Item = Fault> {
        [
            self.servo.borrow().drive().fault(),
            self.plant.borrow().fault(),
        ]
        .into_iter()
        .flatten()
    }
}

/// Follows a path for so many cycles of 1 ms with these frames going wrong.
#[must_use]
pub fn run(machine: &Machine, path: &dyn Fn(f64) -> f64, cycles: u32, plans: Plans) -> Run {
    let mut axis = Axis::enabled(machine);
    axis.inject(plans);
    let before = axis.counted();
    let mut run = Run::default();
    for cycle in 0..cycles + CALM_CYCLES {
        if cycle == cycles {
            run.injected = axis.master.link_mut().bus_mut(0).injected();
            axis.inject(Plans::default());
        }
        axis.cycle(path(1.0e-3 * f64::from(cycle)));
        let truth = axis.plant.borrow().truth();
        run.table_m.push(truth.table_m);
        run.force_n.push(truth.commanded_n);
        let new: Vec<Fault> = axis
            .faults()
            .filter(|fault| !run.faults.contains(fault))
            .collect();
        run.faults.extend(new);
    }
    let after = axis.counted();
    [run.servo, run.plant] = [after[0].since(before[0]), after[1].since(before[1])];
    run
}

/// Largest difference of two records.
#[must_use]
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// What a drive's limits are judged by, in its own units: way in 10 nm, velocity and acceleration
/// in 10 nm per cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// Largest velocity of the commanded reference.
    pub velocity: f64,
    /// Largest change of it from cycle to cycle.
    pub acceleration: f64,
    /// Largest distance from zero.
    pub position: f64,
    /// Largest torque, µN·m.
    pub torque: f64,
    /// Cycles with a reference.
    pub cycles: u32,
}

/// A servo whose commanded reference is looked at in every cycle, whoever makes it step.
pub struct Watched {
    servo: Shared<Servo>,
    seen: Shared<Extremes>,
    /// Cycles, velocity of the reference and fault after the last event.
    last: (u32, Option<f64>, Option<Fault>),
}

impl Watched {
    /// In the place of a servo on its bus; what it sees can be looked at.
    #[must_use]
    pub fn replace(axis: &mut Axis) -> Shared<Extremes> {
        let seen = Shared::new(Extremes::default());
        let last = (
            Counted::servo(axis.servo.borrow().counts()).cycles(),
            None,
            None,
        );
        let watched = Self {
            servo: axis.servo.clone(),
            seen: seen.clone(),
            last,
        };
        axis.master
            .link_mut()
            .bus_mut(0)
            .replace(SERVO, Box::new(watched));
        seen
    }

    fn look(&mut self) {
        let servo = self.servo.borrow();
        let (cycles, fault) = (
            Counted::servo(servo.counts()).cycles(),
            servo.drive().fault(),
        );
        let mut seen = self.seen.borrow_mut();
        seen.torque = seen
            .torque
            .max(f64::from(servo.torque().to_micro_nm_lossy()).abs());
        let steps = cycles - self.last.0;
        if steps == 0 {
            return;
        }
        let reference = servo.reference();
        let velocity = reference.map(|reference| reference.velocity.0.to_num::<f64>());
        if let (Some(reference), Some(velocity)) = (reference, velocity) {
            seen.cycles += steps;
            seen.position = seen
                .position
                .max(reference.position.0.to_num::<f64>().abs());
            seen.velocity = seen.velocity.max(velocity.abs());
            // A following error makes the reference start anew, where the axis is.
            let restarts = fault == Some(Fault::FollowingError) && self.last.2.is_none();
            if let (Some(before), false) = (self.last.1, restarts) {
                seen.acceleration = seen
                    .acceleration
                    .max((velocity - before).abs() / f64::from(steps));
            }
        }
        // The reference of the cycle in which a following error was latched is still the one before
        // the restart.
        let was_restarted = fault == Some(Fault::FollowingError) && self.last.2.is_none();
        self.last = (cycles, velocity.filter(|_| !was_restarted), fault);
    }
}

impl Station for Watched {
    fn ids(&self) -> AxisIds {
        self.servo.borrow().ids()
    }

    fn boot(&mut self, _: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.servo.take(frame, now_us, send);
        self.look();
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.servo.time(now_us, send);
        self.look();
    }

    fn wake_at_us(&self) -> Option<u64> {
        Station::wake_at_us(&self.servo)
    }

    fn sync_due_us(&self) -> Option<u64> {
        Station::sync_due_us(&self.servo)
    }
}
