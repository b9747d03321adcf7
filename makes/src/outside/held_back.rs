//! Disturbances outside the list on machines of their own, held back as the makes of
//! [`mod@crate::make::held_back`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | strut of a hexapod | air of the balance is a spring, p·Vⁿ = const |
//! | rope hoist | a load brings weight, not only inertia |
//! | trolley on rails | the wheel creeps, Δx' = F·|v|/C (Kalker 1990) |
//! | reel winder | inertia grows steadily |
//! | stirrer | an oil clutch, M = c·(ω₁ − ω₂), and no encoder behind it |
//! | press feeder | magnets lose force as they warm up |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

use super::{Outside, of};
use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::Flaw;
use crate::entry::{Entry, truth};
use crate::make::rig;
use crate::mechanics::field::Field;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::{Pace, Room};
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// All of them.
#[rustfmt::skip]
pub const HELD_BACK: &[Outside] = &[
    of("hexapod-strut", "the balance is an air spring", balanced_strut, air_spring),
    of("rope-hoist", "a load brings its weight with it", hoist, hooked_load).or(Effect::Payload),
    of("rail-trolley", "the wheel creeps on the rail", trolley, creeping_wheel),
    of("reel-winder", "inertia grows steadily", winder, filling_reel).or(Effect::Payload),
    of("oil-clutch-stirrer", "an oil clutch before the load", stirrer, oil_clutch),
    of("press-feeder", "the motor loses force as it warms up", feeder, warm_magnets),
];

impl Outside {
    /// Name of the record of the machine without its disturbance.
    #[must_use]
    pub fn empty_name(&self) -> String {
        format!("{}-empty", self.name)
    }

    /// The record of the machine without its disturbance: nothing is lacking.
    #[must_use]
    pub fn empty_entry(&self, seed: u64) -> Entry {
        let rig = self.good_rig(seed);
        let truth = truth(self.name, "empty", &rig, &rig.base, &[]);
        Entry::of(&self.empty_name(), &rig, truth, seed)
    }
}

/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;

/// A room around zero: half its width, velocity and acceleration, s.
fn room(half: f64, pace: (f64, f64), duration_s: f64) -> Room {
    Room {
        low: -half,
        high: half,
        pace: Pace {
            velocity: pace.0,
            acceleration: pace.1,
        },
        duration_s,
    }
}

/// Share of a strut's weight that its balance carries.
const BALANCED: f64 = 0.9;

/// A strut of a hexapod whose cylinder is balanced by a large vessel: pressure stays.
fn balanced_strut(draw: &mut Draw) -> Rig {
    let mass = draw.near(55.0);
    let mut train = Train::one(mass, draw.near(40.0), draw.near(130.0));
    let weight = mass * GRAVITY_M_S2;
    train.fields = vec![
        (0, Field::Constant(-weight)),
        (0, Field::Constant(BALANCED * weight)),
    ];
    let controller = Controller::pid(mass, 12.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(0.8);
    rig.moved(
        draw,
        room(0.1, (0.25, 2.0), 28.0),
        [Room::workshop, Room::points],
        14.0,
    );
    rig
}

/// The vessel is closed off: air in a column of some decimetres, between isothermal and adiabatic.
fn air_spring(rig: &mut Rig, draw: &mut Draw) {
    rig.train.fields[1].1 = Field::AirSpring {
        force: BALANCED * rig.train.inertia() * GRAVITY_M_S2,
        column: draw.near(0.35),
        exponent: 1.2,
    };
}

/// A hoist's drum, counted at the rope, with its hook; 500 Hz, controller in velocity form.
fn hoist(draw: &mut Draw) -> Rig {
    let (drum, hook) = (draw.near(40.0), draw.near(25.0));
    let mut train = Train::one(drum + hook, draw.near(60.0), draw.near(140.0));
    train
        .fields
        .push((0, Field::Constant(-hook * GRAVITY_M_S2)));
    let loops = Pi::of(drum + hook, 3.0, 18.0, Shape::VelocityForm(2000.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 2.0e-7);
    rig.noisy(1.5);
    rig.moved(
        draw,
        room(0.6, (0.6, 1.5), 40.0),
        [Room::points, Room::workshop],
        20.0,
    );
    rig
}

/// What is hooked on is there from a third of the record on, and it hangs.
fn hooked_load(rig: &mut Rig, draw: &mut Draw) {
    let empty = rig.train.inertia();
    let (load, at_s) = (draw.near(30.0), draw.between(11.0, 15.0));
    rig.train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + load,
        at_s: vec![at_s],
    };
    let weight = Field::Step {
        force: -load * GRAVITY_M_S2,
        at_s,
    };
    rig.train.fields.push((0, weight));
}

/// A trolley whose wheel is driven, with a bar code along the rail that is read to 50 µm: the
/// contact gives way by a tenth of that.
fn trolley(draw: &mut Draw) -> Rig {
    let (wheel, body) = (draw.near(120.0), draw.near(480.0));
    let contact = Joint::stiff(draw.near(8.0e7), 5.0e4);
    let train = Train::one(wheel, draw.near(30.0), draw.near(60.0)).then(
        contact,
        body,
        draw.near(110.0),
        draw.near(180.0),
    );
    let controller = Controller::cascade(wheel + body, 1.6, 9.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(5.0e-5, Rounding::Nearest));
    rig.noisy(3.0);
    rig.moved(
        draw,
        room(1.2, (1.0, 1.2), 45.0),
        [Room::points, Room::workshop],
        22.0,
    );
    rig
}

/// A wet rail: a hundred newtons cost a millimetre on a metre.
fn creeping_wheel(rig: &mut Rig, draw: &mut Draw) {
    rig.train.joints[0].creep = draw.near(1.0e-5);
}

/// A winder's shaft with an empty reel.
fn winder(draw: &mut Draw) -> Rig {
    let inertia = draw.near(0.15);
    let train = Train::one(inertia, draw.near(0.5), draw.near(0.06));
    let controller = Controller::pid(inertia, 10.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, 5.0e-7);
    rig.noisy(0.03);
    rig.moved(
        draw,
        room(20.0, (10.0, 25.0), 28.0),
        [Room::jogs, Room::points],
        14.0,
    );
    rig
}

/// It doubles in twenty seconds.
fn filling_reel(rig: &mut Rig, draw: &mut Draw) {
    let empty = rig.train.inertia();
    rig.train.inertias[0] = Inertia::Filling {
        empty,
        per_s: draw.near(0.05) * empty,
    };
}

/// Motor and drum of a stirrer in air, which turn together.
const STIRRER_MOTOR_KG_M2: f64 = 0.012;
const STIRRER_DRUM_KG_M2: f64 = 0.05;

/// A stirrer whose drum is keyed to the motor's shaft.
fn stirrer(draw: &mut Draw) -> Rig {
    let inertia = STIRRER_MOTOR_KG_M2 + STIRRER_DRUM_KG_M2;
    let train = Train::one(inertia, draw.near(0.25), draw.near(0.05));
    let controller = Controller::pid(inertia, 4.0, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, 3.0e-7);
    rig.column = EffortColumn::Current(1.0 / 0.4);
    rig.logs_current(2);
    rig.noisy(0.01);
    rig.moved(
        draw,
        room(10.0, (12.0, 80.0), 26.0),
        [Room::jogs, Room::points],
        13.0,
    );
    rig
}

/// The key is replaced by a clutch of silicone oil: the drum follows within some
/// hundred and fifty milliseconds.
fn oil_clutch(rig: &mut Rig, draw: &mut Draw) {
    let clutch = Joint::stiff(0.0, draw.near(0.35));
    rig.train.inertias[0] = Inertia::Constant(STIRRER_MOTOR_KG_M2);
    rig.train = rig.train.clone().then(clutch, STIRRER_DRUM_KG_M2, 0.0, 0.0);
}

/// A feeder of sheets to a press: a linear motor that accelerates most of the time.
fn feeder(draw: &mut Draw) -> Rig {
    let mass = draw.near(25.0);
    let train = Train::one(mass, draw.near(35.0), draw.near(70.0));
    let controller = Controller::state_feedback(mass, 10.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.logs_current(1);
    rig.noisy(0.8);
    rig.moved(
        draw,
        room(0.3, (1.0, 8.0), 26.0),
        [Room::jogs, Room::points],
        13.0,
    );
    rig
}

/// A good third of the force per ampere is gone when it is warm.
fn warm_magnets(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Fading(draw.near(0.38), draw.near(8.0)));
}
