//! The makes: machines that differ from each other, each with something that its declared model
//! may lack.
//!
//! A file holds a family. A make is one line in [`all`] and a function that builds its rig with the
//! effect present or absent; its head says which machine it stands for, with equation and source,
//! and what makes it unlike the others.

pub mod arms;
pub mod belts;
pub mod direct;
pub mod families;
pub mod gears;
pub mod held_back;
pub mod logs;
pub mod loops;
pub mod screws;
pub mod unexpected;
pub mod unforeseen;
pub mod unmet;
pub mod unseen;
pub mod unsought;
pub mod untried;
pub mod vertical;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::Drive;
use crate::entry::{Entry, truth};
use crate::mechanics::train::Train;
use crate::motion::{Motion, Path, Room};
use crate::rig::{EffortColumn, Kind, Rig, Stated};
use crate::sensing::{EffortLog, Encoder, Rounding, Sensing, Source, Stamps};
use crate::truth::Effect;

/// A make.
#[derive(Clone, Copy, Debug)]
pub struct Make {
    /// Its name.
    pub name: &'static str,
    /// What it hides, by the names of the interface.
    pub hides: &'static [Effect],
    /// Builds its rig.
    pub build: fn(&mut Draw, Presence) -> Rig,
}

/// Whether what a make hides is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// It is.
    Present,
    /// It is not: the same axis with nothing lacking.
    Absent,
    /// One effect alone, of a make that asks for each of its effects by name.
    Only(Effect),
}

impl Presence {
    /// One value or the other.
    #[must_use]
    pub fn or<T>(self, present: T, absent: T) -> T {
        match self {
            Self::Present | Self::Only(_) => present,
            Self::Absent => absent,
        }
    }

    /// Whether an effect is there.
    #[must_use]
    pub fn has(self, effect: Effect) -> bool {
        match self {
            Self::Present => true,
            Self::Absent => false,
            Self::Only(one) => effect == one,
        }
    }

    /// The value of an effect, or zero where the effect is not there.
    #[must_use]
    pub fn size_of(self, effect: Effect, present: f64) -> f64 {
        if self.has(effect) { present } else { 0.0 }
    }

    /// A value, or zero.
    #[must_use]
    pub fn size(self, present: f64) -> f64 {
        self.or(present, 0.0)
    }
}

/// A form of a make's record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The effect is there and not declared.
    Hidden,
    /// The effect is not there, and not declared.
    Empty,
    /// The effect is there and declared.
    Declared,
    /// As hidden; the validation record is from another day.
    AnotherDay,
}

impl Form {
    /// All.
    pub const ALL: [Self; 4] = [Self::Hidden, Self::Empty, Self::Declared, Self::AnotherDay];

    /// Its word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Hidden => "hidden",
            Self::Empty => "empty",
            Self::Declared => "declared",
            Self::AnotherDay => "another-day",
        }
    }
}

/// Coulomb friction of another day, as a factor.
pub const ANOTHER_DAYS_COULOMB: f64 = 1.15;
/// Viscous friction of another day, as a factor.
pub const ANOTHER_DAYS_VISCOUS: f64 = 0.9;

impl Make {
    /// Its rig, with parameters drawn by a seed.
    #[must_use]
    pub fn rig(&self, presence: Presence, seed: u64) -> Rig {
        (self.build)(&mut Draw::of(self.name, seed), presence)
    }

    /// Name of the record of a form.
    #[must_use]
    pub fn record_name(&self, form: Form) -> String {
        format!("{}-{}", self.name, form.word())
    }

    /// The record of a form.
    #[must_use]
    pub fn entry(&self, form: Form, seed: u64) -> Entry {
        let presence = match form {
            Form::Empty => Presence::Absent,
            Form::Hidden | Form::Declared | Form::AnotherDay => Presence::Present,
        };
        let rig = self.rig(presence, seed);
        let (declared, lacking) = match form {
            Form::Hidden | Form::AnotherDay => (rig.base.clone(), self.hides),
            Form::Empty => (rig.base.clone(), &[][..]),
            Form::Declared => ([&rig.base, self.hides].concat(), &[][..]),
        };
        let name = self.record_name(form);
        let truth = truth(self.name, form.word(), &rig, &declared, lacking);
        if form == Form::AnotherDay {
            let mut other = rig.clone();
            other.train = other
                .train
                .on_another_day(ANOTHER_DAYS_COULOMB, ANOTHER_DAYS_VISCOUS);
            Entry::with_validation(&name, &rig, &other, truth, seed)
        } else {
            Entry::of(&name, &rig, truth, seed)
        }
    }
}

/// Makes that are written before any threshold of the identification moves, and run once at the
/// end: families in files of their own. They are a table of their own.
#[must_use]
pub fn held_back() -> Vec<Make> {
    held_back::FAMILIES.concat()
}

/// Makes that are held back after those of [`held_back()`] had been run and had become known. They
/// are a table of their own.
#[must_use]
pub fn unseen() -> Vec<Make> {
    unseen::FAMILIES.concat()
}

/// Makes that are written after those of [`unseen()`] had been run and had become known. They are a
/// table of their own.
#[must_use]
pub fn untried() -> Vec<Make> {
    untried::FAMILIES.concat()
}

/// Makes that are written after those of [`untried()`] had been run and had become known. They are
/// a table of their own.
#[must_use]
pub fn unmet() -> Vec<Make> {
    unmet::FAMILIES.concat()
}

/// Makes that are written after those of [`unmet()`] had been run and had become known. They are a
/// table of their own.
#[must_use]
pub fn unforeseen() -> Vec<Make> {
    unforeseen::FAMILIES.concat()
}

/// Makes that are written after those of [`unforeseen()`] had been run and had become known. They
/// are a table of their own.
#[must_use]
pub fn unexpected() -> Vec<Make> {
    unexpected::FAMILIES.concat()
}

/// Makes that are written after those of [`unexpected()`] had been run and had become known. They
/// are a table of their own.
#[must_use]
pub fn unsought() -> Vec<Make> {
    unsought::FAMILIES.concat()
}

/// Makes by the families of friction, waves and masses, written after those of [`unsought()`]. They
/// are a table of their own.
#[must_use]
pub fn families() -> Vec<Make> {
    families::FAMILIES.concat()
}

/// All makes but those that are held back.
#[must_use]
pub fn all() -> Vec<Make> {
    let families = [
        screws::MAKES,
        belts::MAKES,
        direct::MAKES,
        gears::MAKES,
        vertical::MAKES,
        arms::MAKES,
        loops::MAKES,
        logs::MAKES,
    ];
    families.concat()
}

/// Largest step of the integration, s: a twelfth of a period at 4 kHz, which no joint reaches.
const LONGEST_STEP_S: f64 = 2.0e-5;

/// A rig as most are: command recorded with the controller's period, setpoint too, resolution
/// stated. A make changes what is its own.
pub(crate) fn rig(kind: Kind, train: Train, controller: Controller, encoder: f64) -> Rig {
    let steps = (controller.period_s / LONGEST_STEP_S).ceil() as usize;
    Rig {
        kind,
        column: match kind {
            Kind::Linear => EffortColumn::Force,
            Kind::Rotary => EffortColumn::Torque(1.0),
        },
        train,
        drive: Drive::default(),
        controller,
        sensing: Sensing {
            steps_per_row: steps,
            motor: Encoder::of(encoder, Rounding::Down),
            load: None,
            growth: None,
            reference: true,
            velocity: None,
            effort: EffortLog::of(Source::Command, 0.0),
            stamps: Stamps::default(),
        },
        steps_per_tick: steps,
        training: (Motion::Path(Path::from(0.0)), 0.0),
        validation: (Motion::Path(Path::from(0.0)), 0.0),
        stated: Stated {
            resolution: true,
            ..Stated::default()
        },
        base: Effect::USUAL.to_vec(),
        known: Vec::new(),
    }
}

/// How an axis is moved.
pub(crate) type Style = fn(&Room, &mut Draw) -> Path;

impl Rig {
    /// Moves it: training in a room by one style, validation for another time by another.
    pub(crate) fn moved(&mut self, draw: &mut Draw, room: Room, how: [Style; 2], validate_s: f64) {
        let other = room.lasting(validate_s);
        self.training = (Motion::Path(how[0](&room, draw)), room.duration_s);
        self.validation = (Motion::Path(how[1](&other, draw)), validate_s);
    }

    /// Records the drive's current at every n-th tick.
    pub(crate) fn logs_current(&mut self, ticks_per_row: usize) {
        self.sensing.effort.source = Source::Current;
        self.sensing.steps_per_row = self.steps_per_tick * ticks_per_row;
    }

    /// White noise of the log.
    pub(crate) fn noisy(&mut self, white: f64) {
        self.sensing.effort.noise.white = white;
    }

    /// Declares what is always there.
    pub(crate) fn declare(&mut self, effect: Effect) {
        self.base.push(effect);
    }
}
