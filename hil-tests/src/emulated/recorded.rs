//! What a servo hears and answers on a circle, taken down on the host.

use std::cell::RefCell;
use std::rc::Rc;

use bus::{Damage, FaultPlan};
use embedded_can::{Frame, Id};
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use protocol::cob::{AxisIds, FrameKind};
use protocol::sdo::Expedited;
use protocol::{CanFrame, Station};
use servo::Servo;
use servo::objects::{self, Parameter};
use servo::watchdog::Counts;
use workbench::compensation::{Adaptive, AxisCompensation, Compensation, ELEMENTS, Model, POINTS};
use workbench::drive_parameters;
use workbench::error::Outcome;
use workbench::network::in_process::InProcess;
use workbench::network::master::Master;
use workbench::trajectory::Circle;

use super::recording::{self, Class, Event, FRAME};
use crate::rig::{PLANT, SERVO};

/// What the drive does about friction, gap and resonance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Velocity and acceleration feedforward.
    Plain,
    /// Pulse, Coulomb feedforward, backlash and a torque filter as well.
    Everything,
    /// The model of friction.
    Model,
}

/// What a servo heard and said.
#[derive(Default)]
struct Taken {
    bytes: Vec<u8>,
    /// The circle is on.
    is_circle: bool,
    /// Cycles of it that have begun at the bus.
    cycle: u32,
    counts: Counts,
}

/// A servo on the bus that takes down what it hears and says.
struct Tap {
    servo: Servo,
    run: Circling,
    taken: Rc<RefCell<Taken>>,
}

impl Tap {
    fn note(&self, class: Class, now_us: u64, frame: [u8; FRAME], answers: &[CanFrame]) {
        let answers: Vec<[u8; FRAME]> = answers.iter().map(bytes).collect();
        let mut taken = self.taken.borrow_mut();
        let is_measured = match self.run.measured {
            Measured::Nothing => false,
            Measured::Circle => taken.is_circle,
            Measured::Everything => true,
        };
        Event {
            class,
            is_measured,
            now_us,
            frame,
            answers: &answers,
        }
        .write(&mut taken.bytes);
        taken.counts = self.servo.counts();
    }

    /// Whether a frame does not reach the servo.
    fn is_lost(&self, class: Class) -> bool {
        let mut taken = self.taken.borrow_mut();
        taken.cycle += u32::from(taken.is_circle && class == Class::Sync);
        self.run.lost.contains(&(class, taken.cycle))
    }

    fn class(&self, frame: &CanFrame) -> Class {
        let Id::Standard(id) = frame.id() else {
            return Class::Other;
        };
        match self.servo.ids().classify(id) {
            Some(FrameKind::Sync) => Class::Sync,
            Some(FrameKind::Setpoint) => Class::Setpoint,
            Some(FrameKind::Feedback) => Class::Feedback,
            _ => Class::Other,
        }
    }
}

impl Station for Tap {
    fn ids(&self) -> AxisIds {
        self.servo.ids()
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        let answers = self.servo.boot().to_vec();
        self.note(Class::Boot, 0, [0; FRAME], &answers);
        answers.into_iter().for_each(send);
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let class = self.class(frame);
        if self.is_lost(class) {
            return;
        }
        let answers = self.servo.on_frame(frame, now_us).to_vec();
        self.note(class, now_us, bytes(frame), &answers);
        answers.into_iter().for_each(send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let answers = self.servo.on_time(now_us).to_vec();
        self.note(Class::Time, now_us, [0; FRAME], &answers);
        answers.into_iter().for_each(send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.servo.wake_at_us()
    }

    fn sync_due_us(&self) -> Option<u64> {
        Station::sync_due_us(&self.servo)
    }
}

fn bytes(frame: &CanFrame) -> [u8; FRAME] {
    recording::to_bytes(frame).expect("our nodes send data frames with standard identifiers")
}

/// Events whose instructions are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// None.
    Nothing,
    /// Those of the circle.
    Circle,
    /// All, from boot-up on.
    Everything,
}

/// A circle of R 10 F 1000 at 1 kHz, of which X is recorded: it reverses after 1.9 s and after
/// 3.8 s.
#[derive(Clone, Copy)]
pub struct Circling {
    /// What the drive does.
    pub drive: Drive,
    /// Cycles of the circle.
    pub cycles: u32,
    /// Whose instructions are wanted.
    pub measured: Measured,
    /// Frames that do not reach the servo, with the cycle of the circle, from 1 on.
    pub lost: &'static [(Class, u32)],
    /// The cycle, counted from the first SYNC, whose torque does not reach the plant.
    pub torque_lost: Option<u32>,
}

/// A recording.
pub struct Recording {
    /// As the image wants it.
    pub bytes: Vec<u8>,
    /// What the servo counted.
    pub counts: Counts,
}

/// What the servo hears and answers from boot-up to the end of the circle.
///
/// # Errors
/// Where the circle does not come to its end.
pub fn record(run: Circling) -> Outcome<Recording> {
    let mut machine = Machine::reference();
    machine.axes.truncate(1);
    machine.axes[0].gains.torque_low_pass_hz =
        (run.drive == Drive::Everything).then_some(LOW_PASS_HZ);
    let taken = Rc::new(RefCell::new(Taken::default()));
    let mut link = InProcess::new(&machine, 0)?;
    let servo = Servo::new(link.servo(0).borrow().ids());
    let plant = servo.ids().plant.get();
    let bus = link.bus_mut(0);
    let tap = Tap {
        servo,
        run,
        taken: Rc::clone(&taken),
    };
    bus.replace(SERVO, Box::new(tap));
    let once = run
        .torque_lost
        .map(|cycle| (FrameKind::Torque, cycle, Damage::Lost));
    let plan = FaultPlan {
        once,
        ..FaultPlan::default()
    };
    bus.inject(PLANT, plant, plan);
    let mut master = Master::start(link, &machine)?;
    configure(&mut master, &machine, run.drive)?;
    master.enable()?;
    taken.borrow_mut().is_circle = true;
    let circle = Circle {
        radius_m: 0.010,
        feed_m_per_s: 1.0 / 60.0,
        turns: u32::MAX,
        counter_clockwise: true,
    };
    for cycle in 1..=run.cycles {
        master.cycle(&circle.at(f64::from(cycle) * machine.period_s)[..1])?;
    }
    master.expect_enabled()?;
    let taken = taken.borrow();
    Ok(Recording {
        bytes: with_length(&taken.bytes),
        counts: taken.counts,
    })
}

/// Events with their length before them.
///
/// # Panics
/// Where they do not fit into the memory that the image has for them.
#[must_use]
pub fn with_length(events: &[u8]) -> Vec<u8> {
    assert!(
        events.len() + 4 <= recording::SPACE,
        "the recording does not fit into the PSRAM of the emulated machine"
    );
    let length = u32::try_from(events.len()).expect("16 MiB at most");
    [&length.to_le_bytes(), events].concat()
}

/// Above the velocity loop's 30 Hz, so that the loop stays calm; the instructions do not depend on
/// it.
const LOW_PASS_HZ: f64 = 250.0;
/// Pulses near what `tune --method adaptive` finds for the reference machine. A gap that the
/// machine does not have shifts its path and harms nothing else.
fn everything() -> AxisCompensation {
    let adaptive = Adaptive {
        forward_m_per_s: [2.0e-3; POINTS],
        backward_m_per_s: [2.0e-3; POINTS],
        time_constant_s: [0.02; POINTS],
        start_delay_s: [0.002; POINTS],
        ..Adaptive::OFF
    };
    AxisCompensation {
        reversal: Compensation::Adaptive(Box::new(adaptive)),
        backlash_m: 20.0e-6,
    }
}

/// Near what `tune --method model` finds for the reference machine.
fn model() -> AxisCompensation {
    let mut model = Model {
        level_n: [40.0; ELEMENTS],
        span_m_per_s: 3.7e-3,
        lag_m: 1.3e-5,
        viscous_n_s_per_m: 2000.0,
        stiffness_n_per_m: 1.2e8,
        level_asymmetry_n: 40.0,
        way_asymmetry: 0.1,
        motor_share: [0.2; ELEMENTS],
        motor_inertia_kg: 632.0,
        ahead_s: 5.0e-4,
        damping_s: 7.5e-4,
        windup_ahead_s: 5.8e-4,
        ..Model::OFF
    };
    for (place, slip_m) in model.slip_m.iter_mut().enumerate() {
        *slip_m = 1.0e-6 * (1 + 2 * place) as f64;
    }
    for (place, factor) in model.factor.iter_mut().enumerate() {
        *factor = 1.0 + 0.3 * (-0.02 * (place * place) as f64).exp();
    }
    AxisCompensation {
        reversal: Compensation::Model(Box::new(model)),
        backlash_m: 0.0,
    }
}

fn configure(master: &mut Master<InProcess>, machine: &Machine, drive: Drive) -> Outcome<()> {
    match drive {
        Drive::Plain => master.configure(machine, &[AxisCompensation::default()]),
        Drive::Everything => {
            master.configure(machine, &[everything()])?;
            add_coulomb(master, &machine.axes[0], machine.period_s)
        }
        Drive::Model => master.configure(machine, &[model()]),
    }
}

/// A compensation file holds pulses or a Coulomb feedforward; the drive can do both at once.
fn add_coulomb(master: &mut Master<InProcess>, axis: &MachineAxis, period_s: f64) -> Outcome<()> {
    let reversal = Compensation::Coulomb { force_n: 200.0 };
    let set = drive_parameters::parameters(
        axis,
        period_s,
        &AxisCompensation {
            reversal,
            backlash_m: 0.0,
        },
    )?;
    for (entry, value) in set
        .into_iter()
        .filter(|(entry, _)| entry.parameter == Parameter::CoulombTorque)
    {
        master.download(0, entry.address, Expedited::i32(value))?;
    }
    master.download(0, objects::COMMIT, Expedited::u32(objects::COMMIT_KEY))
}
