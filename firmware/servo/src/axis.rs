//! One control cycle of the axis: what came in, and what the power stage is told.
//!
//! ```text
//! feedback k ──▶ encoders ──▶ measured ───────────────┐
//! setpoint k+1 ─▶ control word ─▶ drive state ─┐       ├─▶ law ─▶ torque k
//!            └──▶ watchdogs      reference stage ──────┘
//! ```
//!
//! The law is stepped in every cycle in which there may be torque, bridged ones included: what is
//! missing is predicted (feedback) or extrapolated (setpoint), and the law never sees a hole.
//! Nothing here knows frames, time or identifiers.

use controller::reference::{Mode, Reference, ReferenceInput, ReferenceState};
use controller::units::{Position, PositionError, Torque, Velocity};
use controller::{Input, Output, State};
use fixed::types::I32F32;
use heapless::Vec;
use protocol::Fault;
use protocol::message::{Feedback, Setpoint};
use protocol::states::{Command, ControlWord};

use crate::drive::{Drive, Patience, RampKind};
use crate::encoders::{Encoders, Encoding, Measured};
use crate::inbox::{Contents, Miss};
use crate::settings::{Settings, StopOption};
use crate::stage::{StageInput, StageOutput};
use crate::watchdog::Watchdog;

/// What a cycle has to report beside its torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// A fault was latched.
    Latched(Fault),
    /// Enabling was refused; nothing is latched.
    Refused(Fault),
    /// A fault was reset.
    Reset,
}

/// Notices of one event; there are never more than a fault, a worse one and a reset.
pub type Notices = Vec<Notice, 4>;

/// The axis, from frame contents to torque.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// State of the drive.
    pub drive: Drive,
    /// What the power stage says.
    pub stage: StageInput,
    /// What the encoders say.
    pub encoders: Encoders,
    /// Misses and counts.
    pub watchdog: Watchdog,
    /// What the last cycle came to.
    pub last: Last,
    control: ControlWord,
    refusal: Option<Fault>,
    setpoint: Option<Position>,
    track: Option<ReferenceState>,
    law: State,
    held: Option<Torque>,
}

/// What the last cycle came to, for status frame and readings.
#[derive(Clone, Copy, Debug, Default)]
pub struct Last {
    /// Commanded torque, µN·m.
    pub micro_nm: i32,
    /// Reference − measurement.
    pub following_error: PositionError,
    /// The reference, where there is one.
    pub reference: Option<Reference>,
    /// The torque stands at its limit.
    pub limited: bool,
    /// Something was bridged or refused since the last status frame.
    pub warning: bool,
}

/// What the node knows beyond the frames of the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Circumstances {
    /// The master's SYNC period is that of the parameter set. Known without torque only, where it
    /// is asked; with torque it says so in any case.
    pub period_fits: bool,
    /// Control words count (NMT operational, and no way out of it pending).
    pub listens: bool,
    /// SYNC of this cycle came.
    pub in_sync: bool,
}

impl Axis {
    /// One control cycle.
    pub fn cycle(
        &mut self,
        settings: &Settings,
        contents: &Contents,
        circumstances: Circumstances,
        notices: &mut Notices,
    ) -> StageOutput {
        let expected = self.expects_setpoint(settings);
        let measured = self.measure(settings, contents.feedback, notices);
        self.watch_setpoints(settings, contents, expected, notices);
        if circumstances.listens && !self.goes_on(contents) {
            self.follow_control_word(settings, contents, circumstances, notices);
        }
        let refused = self.control_axis(settings, contents, measured, notices);
        let missed = contents.feedback.is_err()
            || (expected && contents.preview.is_err())
            || !circumstances.in_sync;
        let implausible = contents.feedback.is_ok() && self.watchdog.misses().1 > 0;
        self.watchdog.cycle(missed, refused || implausible);
        self.last.warning |= missed || refused || implausible;
        StageOutput {
            control: self.drive.stage_control(),
            micro_nm: self.last.micro_nm,
        }
    }

    /// Whether a setpoint is due in the present cycle.
    #[must_use]
    pub fn expects_setpoint(&self, settings: &Settings) -> bool {
        self.track
            .as_ref()
            .is_none_or(|track| track.expects_setpoint(&settings.config.reference))
    }

    /// Latches a fault; the first one stays.
    pub fn latch(&mut self, fault: Fault, settings: &Settings, notices: &mut Notices) {
        let before = self.drive.fault();
        self.drive = self.drive.faulted(fault, &settings.options);
        if before.is_none() && self.drive.fault().is_some() {
            // There are never more notices than the list holds.
            let _ = notices.push(Notice::Latched(fault));
        }
        if !self.drive.is_energised() {
            self.rest();
        }
    }

    /// The stage says something new.
    pub fn hear_stage(&mut self, stage: StageInput, settings: &Settings, notices: &mut Notices) {
        self.stage = stage;
        let delivers = !matches!(self.drive, Drive::Enabling(enabling) if !enabling.confirmed);
        if self.drive.is_energised() && delivers && !stage.is_enabled() {
            self.latch(Fault::StageLost, settings, notices);
        }
    }

    /// The position that the loop controls.
    #[must_use]
    pub fn position(&self, settings: &Settings) -> Option<Position> {
        self.encoders
            .position()
            .map(|at| at.of(settings.config.position_source))
    }

    /// Offset of the backlash unit.
    #[must_use]
    pub const fn backlash_offset(&self) -> PositionError {
        self.law.backlash_offset()
    }

    /// Whether the commanded motion has ended.
    #[must_use]
    pub fn is_standing(&self) -> bool {
        self.last
            .reference
            .is_none_or(|reference| reference.standing)
    }

    /// Refined factor on the levels of the friction model, 1e-6.
    #[must_use]
    pub fn refined_level_millionths(&self) -> i32 {
        let wide: I32F32 = self.law.level().into();
        wide.saturating_mul_int(1_000_000).saturating_to_num()
    }

    /// Other parameters hold from now on; what was refined is of the model before.
    pub(crate) fn begin_set(&mut self, before: Option<&Settings>, now: &Settings) {
        let same = before.is_some_and(|before| before.config.friction() == now.config.friction());
        if !same {
            self.law.forget_level();
        }
    }

    /// Whether halt is commanded.
    #[must_use]
    pub const fn is_halted(&self) -> bool {
        self.control.has(ControlWord::HALT)
    }

    fn measure(
        &mut self,
        settings: &Settings,
        feedback: Result<Feedback, Miss>,
        notices: &mut Notices,
    ) -> Option<Measured> {
        let encoding = encoding(settings);
        let accepted = feedback.and_then(|feedback| {
            self.encoders
                .accept(feedback, &encoding)
                .map_err(|_| Miss::Implausible)
        });
        match self
            .watchdog
            .feedback(accepted.err(), settings.limits.feedback_misses)
        {
            Some(fault) if self.drive.is_energised() => self.latch(fault, settings, notices),
            // Without torque nothing is at stake: forget the old position, so that nobody enables
            // on it.
            Some(_) => {
                self.encoders.forget();
                self.law.forget_friction();
            }
            None => {}
        }
        let acceleration = self
            .last
            .reference
            .map(|reference| reference.acceleration)
            .unwrap_or_default();
        accepted
            .ok()
            .or_else(|| self.encoders.predict(acceleration))
    }

    fn watch_setpoints(
        &mut self,
        settings: &Settings,
        contents: &Contents,
        expected: bool,
        notices: &mut Notices,
    ) {
        if let Some(setpoint) = contents.preview.ok().or(contents.present) {
            self.setpoint = Some(position_of(setpoint));
        }
        if !expected {
            return;
        }
        match self
            .watchdog
            .setpoint(contents.preview.err(), settings.limits.setpoint_misses)
        {
            Some(fault) if self.drive.is_energised() => self.latch(fault, settings, notices),
            // Nobody enables on a setpoint that is long gone.
            Some(_) => self.setpoint = None,
            None => {}
        }
    }

    /// The control word of an axis in operation is the one that has brought it there: nothing comes
    /// of it.
    fn goes_on(&self, contents: &Contents) -> bool {
        let same = |setpoint: Setpoint| setpoint.control == self.control;
        self.drive == Drive::OperationEnabled && contents.preview.is_ok_and(same)
    }

    fn follow_control_word(
        &mut self,
        settings: &Settings,
        contents: &Contents,
        circumstances: Circumstances,
        notices: &mut Notices,
    ) {
        let Ok(Setpoint { control, .. }) = contents.preview else {
            return;
        };
        let reset_edge = control.has(ControlWord::FAULT_RESET.0)
            && !self.control.has(ControlWord::FAULT_RESET.0);
        self.control = control;
        let mut command = control.command();
        if command == Some(Command::EnableOperation)
            && !self.drive.is_energised()
            && self.drive.fault().is_none()
        {
            let refusal = self.refusal(settings, contents, circumstances);
            self.say_refusal(refusal, notices);
            command = command.filter(|_| refusal.is_none());
        } else {
            self.refusal = None;
        }
        let before = self.drive;
        self.drive = self.drive.commanded(command, reset_edge, &settings.options);
        if before.fault().is_some() && self.drive.fault().is_none() {
            self.watchdog.forgive();
            let _ = notices.push(Notice::Reset);
        }
        if !before.is_energised() && self.drive.is_energised() {
            self.energise(settings);
        }
        if before.is_energised() && !self.drive.is_energised() {
            self.rest();
        }
    }

    /// Why the axis may not be enabled now; `None` where it may.
    fn refusal(
        &self,
        settings: &Settings,
        contents: &Contents,
        circumstances: Circumstances,
    ) -> Option<Fault> {
        let source = settings.config.position_source;
        let (Some(at), Some(setpoint)) = (self.position(settings), self.setpoint) else {
            return Some(Fault::FeedbackMissing);
        };
        let needs_scale = source == controller::PositionSource::Load;
        if contents.feedback.is_err() {
            Some(Fault::FeedbackMissing)
        } else if !circumstances.period_fits {
            Some(Fault::CycleTimeMismatch)
        } else if needs_scale && !self.encoders.relation_holds(settings.relation) {
            Some(Fault::EncoderRelation)
        } else if !self.stage.is_ready() {
            Some(Fault::StageRefused)
        } else if setpoint
            .error_from(at)
            .is_beyond(settings.limits.enable_window)
        {
            Some(Fault::ReferenceTooFar)
        } else {
            None
        }
    }

    /// A refusal is said once, not in every cycle in which the command stands.
    fn say_refusal(&mut self, refusal: Option<Fault>, notices: &mut Notices) {
        if let Some(fault) = refusal
            && self.refusal != refusal
        {
            let _ = notices.push(Notice::Refused(fault));
        }
        self.refusal = refusal;
    }

    /// Torque comes: the reference starts where the axis is and as it moves, the integral with the
    /// torque that held it last.
    fn energise(&mut self, settings: &Settings) {
        let preset = settings.preset;
        let torque = self
            .held
            .filter(|_| preset.from_last)
            .unwrap_or(preset.torque);
        self.law = State::holding(torque).with_friction(self.law.friction());
        let Some(at) = self.encoders.position() else {
            return;
        };
        let source = settings.config.position_source;
        // What an axis can stop within a cycle is no motion but the resolution of its encoder.
        let moves = self
            .encoders
            .velocity(source)
            .is_beyond(settings.config.reference.acceleration_limit);
        let velocity = if moves {
            self.encoders.velocity(source)
        } else {
            Velocity::ZERO
        };
        if moves {
            self.law = self.law.moving(
                at.motor,
                self.encoders.velocity(controller::PositionSource::Motor),
            );
        }
        self.track = Some(ReferenceState::at(at.of(source), velocity));
    }

    /// No torque: the law and the reference start anew; friction is where it was.
    fn rest(&mut self) {
        self.law = State::default().with_friction(self.law.friction());
        self.track = None;
        self.last.micro_nm = 0;
        self.last.reference = None;
        self.last.limited = false;
    }

    /// Reference, state and law of an axis with torque; tells whether a setpoint was refused.
    fn control_axis(
        &mut self,
        settings: &Settings,
        contents: &Contents,
        measured: Option<Measured>,
        notices: &mut Notices,
    ) -> bool {
        let Some(reference) = self.step_reference(settings, contents) else {
            if let Some(measured) = measured {
                let source = settings.config.position_source;
                self.law.follow(&settings.config, measured.of(source));
            }
            return false;
        };
        self.advance(settings, reference.standing, notices);
        if let (Some(measured), true) = (measured, self.drive.is_energised()) {
            self.step_law(settings, reference, measured, notices);
        }
        self.watch_reference(settings, &reference, notices);
        reference.refused
    }

    fn step_reference(&mut self, settings: &Settings, contents: &Contents) -> Option<Reference> {
        let mode = self.mode(settings);
        let track = self.track.as_mut()?;
        let input = ReferenceInput {
            present: contents.present.map(position_of),
            preview: contents.preview.ok().map(position_of),
            mode,
        };
        let reference = track.step(&settings.config.reference, &input);
        self.last.reference = Some(reference);
        Some(reference)
    }

    fn mode(&self, settings: &Settings) -> Mode {
        match self.drive {
            Drive::OperationEnabled if !self.is_halted() => Mode::Follow,
            Drive::OperationEnabled => match settings.options.halt {
                StopOption::SlowDown | StopOption::SlowDownAndStay => Mode::SlowDown,
                StopOption::QuickStop
                | StopOption::QuickStopAndStay
                | StopOption::DisableAtOnce => Mode::QuickStop,
            },
            Drive::Stopping(stop) | Drive::Holding(stop, _) => match stop.ramp {
                RampKind::SlowDown => Mode::SlowDown,
                RampKind::QuickStop => Mode::QuickStop,
            },
            Drive::SwitchOnDisabled
            | Drive::ReadyToSwitchOn
            | Drive::SwitchedOn
            | Drive::Enabling(_)
            | Drive::QuickStopped
            | Drive::Faulted(_) => Mode::QuickStop,
        }
    }

    fn advance(&mut self, settings: &Settings, standing: bool, notices: &mut Notices) {
        // Nothing comes of that by itself, and it is almost every cycle.
        if self.drive == Drive::OperationEnabled && self.stage.is_enabled() {
            return;
        }
        let patience = Patience {
            stage: settings.limits.stage_cycles,
            brake_opens: settings.brake.open_cycles,
            brake_closes: settings.brake.close_cycles,
        };
        let before = self.drive;
        match self.drive.advanced(self.stage, standing, patience) {
            Ok(drive) => self.drive = drive,
            Err(fault) => self.latch(fault, settings, notices),
        }
        if before.is_energised() && !self.drive.is_energised() {
            if matches!(before, Drive::Holding(..)) {
                self.held = Some(Torque::from_micro_nm(self.last.micro_nm));
            }
            self.rest();
        }
    }

    fn step_law(
        &mut self,
        settings: &Settings,
        reference: Reference,
        measured: Measured,
        notices: &mut Notices,
    ) {
        let input = Input {
            reference,
            motor: measured.motor,
            load: measured.load,
        };
        let Output {
            micro_nm,
            following_error,
            limited,
        } = controller::step(&settings.config, &mut self.law, &input);
        self.last.following_error = following_error;
        self.last.limited = limited || reference.limited;
        self.last.micro_nm = micro_nm;
        if following_error.is_beyond(settings.limits.following_error)
            && self.drive.fault().is_none()
        {
            self.latch(Fault::FollowingError, settings, notices);
            // The ramp starts from what the axis does, not from a reference that it does not
            // follow.
            let source = settings.config.position_source;
            let (position, velocity) = (measured.of(source), self.encoders.velocity(source));
            self.law.begin_anew();
            self.track = self
                .track
                .as_ref()
                .map(|_| ReferenceState::at(position, velocity));
        }
    }

    fn watch_reference(
        &mut self,
        settings: &Settings,
        reference: &Reference,
        notices: &mut Notices,
    ) {
        let refusals = self.track.as_ref().map_or(0, ReferenceState::refusals);
        if refusals > settings.limits.refusals {
            self.latch(Fault::SetpointImplausible, settings, notices);
        }
        if reference.overrun && self.drive.is_energised() {
            self.latch(Fault::LimitOverrun, settings, notices);
        }
    }
}

fn position_of(setpoint: Setpoint) -> Position {
    Position::from_fine_counts(setpoint.position.counts())
}

const fn encoding(settings: &Settings) -> Encoding {
    Encoding {
        way: settings.way,
        relation: settings.relation,
        jump: settings.limits.encoder_jump,
        source: settings.config.position_source,
    }
}
