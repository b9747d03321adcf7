//! Clean records: nothing is lacking, and the record is not pretty. They have to stay explained.

use crate::bench::{ROOM, VALIDATION_S, fast, plain, plain_at, rotary, scaled};
use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::CurrentLoop;
use crate::entry::{Entry, truth};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Law;
use crate::motion::{Motion, Programme, Room};
use crate::rig::Rig;
use crate::sensing::{Encoder, Noise, Outliers, Rounding, Stamps, Wave};

/// A clean record.
#[derive(Clone, Copy, Debug)]
pub struct Clean {
    /// Its name.
    pub name: &'static str,
    build: fn(&mut Draw) -> Rig,
}

/// All of them.
#[rustfmt::skip]
pub const CLEAN: &[Clean] = &[
    Clean { name: "quantised-current", build: quantised_current },
    Clean { name: "force-early", build: force_early },
    Clean { name: "pink-noise", build: pink_noise },
    Clean { name: "outliers", build: outliers },
    Clean { name: "gravity-tenfold", build: gravity_tenfold },
    Clean { name: "slow-rows", build: slow_rows },
    Clean { name: "mains-ripple", build: mains_ripple },
    Clean { name: "jittered-stamps", build: jittered_stamps },
    Clean { name: "jitter-with-velocity", build: jitter_with_velocity },
    Clean { name: "lost-rows", build: lost_rows },
    Clean { name: "folded-rounding", build: folded_rounding },
    Clean { name: "coarse-encoder", build: coarse_encoder },
    Clean { name: "interpolation-error", build: interpolation_error },
    Clean { name: "switched-controller", build: switched_controller },
    Clean { name: "one-second-validation", build: one_second_validation },
    Clean { name: "steep-tanh", build: steep_tanh },
    Clean { name: "stated-lag", build: stated_lag },
    Clean { name: "white-noise", build: white_noise },
    Clean { name: "open-loop", build: open_loop },
    Clean { name: "declared-compliance", build: scaled },
    Clean { name: "rotary", build: rotary },
];

impl Clean {
    /// The rig of a seed.
    #[must_use]
    pub fn rig(&self, seed: u64) -> Rig {
        (self.build)(&mut Draw::of(self.name, seed))
    }

    /// The record of a seed.
    #[must_use]
    pub fn entry(&self, seed: u64) -> Entry {
        let rig = self.rig(seed);
        let truth = truth(self.name, "clean", &rig, &rig.base, &[]);
        Entry::of(self.name, &rig, truth, seed)
    }
}

/// A current in steps of a few percent of its peak: about 6 % of the effort is left, and none of
/// it is motion's.
fn quantised_current(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.effort.quantum = 15.0;
    rig
}

/// An effort that acts an eighth of a millisecond after its row: not worth a name.
fn force_early(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    // Steps of 12.5 µs, so that ten of them are the time.
    rig.steps_per_tick = 80;
    rig.sensing.steps_per_row = 80;
    rig.drive.dead_time_s = 1.25e-4;
    rig.drive.current_loop = CurrentLoop::Ideal;
    rig
}

/// 1/f noise of a Hall sensor, several times the white one.
fn pink_noise(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.effort.noise.pink = 2.5;
    rig
}

/// Eight spikes of twenty times the friction.
fn outliers(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.effort.outliers = Some(Outliers {
        count: 8,
        size: 800.0,
    });
    rig
}

/// An axis that hangs: gravity ten times friction and more, and declared.
fn gravity_tenfold(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    let weight = 11.0 * rig.train.coulomb();
    rig.train.fields.push((0, Field::Constant(-weight)));
    rig
}

/// 250 Hz.
fn slow_rows(draw: &mut Draw) -> Rig {
    let mut rig = plain_at(draw, 4.0e-3);
    rig.moved(
        draw,
        ROOM.lasting(60.0),
        [Room::workshop, Room::circles],
        25.0,
    );
    rig
}

/// A sensor that picks up mains.
fn mains_ripple(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.effort.noise = Noise {
        white: 0.8,
        pink: 0.0,
        mains: 2.0,
    };
    rig
}

/// Rows of an operating system: off by a fifth of a period, and stamped as they were.
fn jittered_stamps(draw: &mut Draw) -> Rig {
    let mut rig = fast(draw);
    rig.sensing.stamps.jitter_s = 2.0e-4;
    rig
}

/// The same with the drive's own velocity beside it.
fn jitter_with_velocity(draw: &mut Draw) -> Rig {
    let mut rig = jittered_stamps(draw);
    rig.sensing.velocity = Some(1.0e-5);
    rig
}

/// One row in a hundred did not arrive.
fn lost_rows(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.stamps = Stamps {
        jitter_s: 0.0,
        lost_share: 0.01,
    };
    rig
}

/// A drive that rounds the velocity at 8 kHz and is logged at 1 kHz: at a constant speed the
/// rounding is always caught in the same phase, and looks like a force.
fn folded_rounding(draw: &mut Draw) -> Rig {
    fast(draw)
}

/// Five micrometres, cut off.
fn coarse_encoder(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.motor.resolution = 5.0e-6;
    rig.controller.filter_share = 0.2;
    rig
}

/// A scale that errs by a tenth of a micrometre within each signal period of 20 µm.
fn interpolation_error(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.sensing.motor = Encoder::of(1.0e-8, Rounding::Nearest).with(Wave {
        amplitude: 1.0e-7,
        period: 2.0e-5,
        phase: 1.0,
    });
    rig
}

/// Softer gains from the middle on; the mechanics do not care.
fn switched_controller(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    let mass = rig.train.inertia();
    let softer = Controller::cascade(mass, 3.0, 16.0, rig.controller.period_s);
    rig.controller.switch = Some(crate::control::Switch {
        at_s: 14.0,
        law: softer.law,
    });
    rig
}

/// A second and a half of validation, in which one second is motion.
fn one_second_validation(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.moved(draw, ROOM, [Room::workshop, Room::points], 1.5);
    rig
}

/// Friction without stick: a tanh with its knee at 0.2 mm/s.
fn steep_tanh(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    let coulomb = rig.train.coulomb();
    rig.train.surfaces[0].law = Law::Smooth {
        coulomb,
        knee: 2.0e-4,
    };
    rig
}

/// A current loop of 0.8 ms, the command recorded, and the lag stated.
fn stated_lag(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.drive.current_loop = CurrentLoop::First(8.0e-4);
    rig.stated.effort_lag_s = Some(8.0e-4);
    rig
}

/// White noise that leaves about a tenth.
fn white_noise(draw: &mut Draw) -> Rig {
    let mut rig = plain(draw);
    rig.noisy(12.0);
    rig
}

/// Steps of force, no loop, no setpoint.
fn open_loop(draw: &mut Draw) -> Rig {
    let mut rig = rotary(draw);
    rig.controller = Controller::open(1.0e-3);
    rig.sensing.reference = false;
    rig.training = (Motion::Effort(Programme::Chirp(26.0, 0.3, 6.0, 8.0)), 28.0);
    rig.validation = (Motion::Effort(Programme::Steps(24.0, 0.5, 9)), VALIDATION_S);
    rig
}
