//! The drive node of one axis, sans-I/O: frames and time go in, frames come out.
//!
//! ```text
//!  frames ─▶ frames_in ─▶ inbox ──┐                      ┌─▶ frames_out ─▶ torque k, status,
//!                                 ├─▶ cycle ─▶ axis ──────┘                 heartbeat, EMCY, SDO
//!  time ───▶ timing ──────────────┘    (drive, encoders, reference, law)
//! ```
//!
//! The contract of a cycle (`docs/frames.md`): cycle k closes when feedback k and the setpoint of
//! cycle k + 1 are in, or at its deadline; then the law is stepped and torque k goes out, always
//! before the next SYNC. What did not come is predicted or extrapolated. A node with torque that
//! misses SYNC goes on by its own timer. Time is an argument: the clock, lock-step bus time or
//! virtual time, as the leaf has it.
//!
//! Where to look: the states of the drive in [`drive`], the power stage in [`stage`], one control
//! cycle in [`axis`], what makes a cycle begin and close in `cycle`, its times in [`timing`],
//! parameters in [`objects`], [`parameters`], [`commit`], [`conversion`] and [`settings`].
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![deny(
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::arithmetic_side_effects,
    clippy::as_conversions
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::panic,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::as_conversions
    )
)]

pub mod axis;
pub mod commit;
pub mod conversion;
mod cycle;
pub mod drive;
pub mod encoders;
mod frames_in;
mod frames_out;
pub mod inbox;
pub mod objects;
pub mod parameters;
pub mod physical;
pub mod sdo_server;
pub mod settings;
pub mod stage;
mod station;
pub mod timing;
pub mod watchdog;

use controller::reference::Reference;
use controller::units::{PositionError, Torque};
use heapless::Vec;
use protocol::cob::AxisIds;
use protocol::leaf::{LeafReport, LeafTimes};
use protocol::message::{EmergencyMessage, NmtCommand, NmtState};
use protocol::{CanFrame, Fault, SyncTracker};

use axis::Axis;
use commit::Commits;
use drive::Drive;
use frames_out::Periodic;
use inbox::Inbox;
use parameters::ParameterSet;
use sdo_server::SdoServer;
use settings::Settings;
use timing::Timing;
use watchdog::Counts;

/// Frames that one event can cause. The worst is a SYNC that finds the cycle before it still open:
/// that cycle's torque, status, heartbeat and two EMCYs; then an SDO response never comes with it,
/// and a reset's boot-up neither. Twice five leaves room.
pub type Outbox = Vec<CanFrame, 10>;

/// The drive node of one axis.
#[derive(Clone, Debug)]
pub struct Servo {
    ids: AxisIds,
    nmt: NmtState,
    /// An NMT command that waits until the axis stands without torque.
    pending_nmt: Option<NmtCommand>,
    sync: SyncTracker,
    timing: Timing,
    inbox: Inbox,
    /// SYNC of the present cycle came.
    in_sync: bool,
    axis: Axis,
    /// The last EMCY: its code, and the cycle in which it was sent.
    emergency: (u16, u8),
    periodic: Periodic,
    server: SdoServer,
    commits: Commits,
    active: Option<Settings>,
    committed: Option<Settings>,
    /// What the leaf reports of itself.
    leaf: LeafReport,
    /// What it has timed.
    times: LeafTimes,
    /// What the present event has to say.
    outbox: Outbox,
}

impl Servo {
    /// A node in its reset state; [`Self::boot`] announces it.
    #[must_use]
    #[inline(never)]
    pub fn new(ids: AxisIds) -> Self {
        let active = defaults();
        Self {
            ids,
            nmt: NmtState::PreOperational,
            pending_nmt: None,
            sync: SyncTracker::default(),
            timing: Timing::new(period_us(active.as_ref())),
            inbox: Inbox::default(),
            in_sync: false,
            axis: Axis::default(),
            emergency: (0, 0),
            periodic: Periodic::default(),
            server: SdoServer::default(),
            commits: Commits::default(),
            active,
            committed: None,
            leaf: LeafReport::default(),
            times: LeafTimes::default(),
            outbox: Outbox::new(),
        }
    }

    /// As new, but for what the leaf reports and what has to be said. In its place: a second node
    /// beside it would take 3 KB of a board's stack.
    pub(crate) fn reset(&mut self) {
        let Self {
            ids: _,
            nmt,
            pending_nmt,
            sync,
            timing,
            inbox,
            in_sync,
            axis,
            emergency,
            periodic,
            server,
            commits,
            active,
            committed,
            leaf: _,
            times: _,
            outbox: _,
        } = self;
        *nmt = NmtState::PreOperational;
        *pending_nmt = None;
        renew(sync);
        renew(inbox);
        *in_sync = false;
        renew(axis);
        *emergency = (0, 0);
        renew(periodic);
        renew(server);
        commits.forget();
        *committed = None;
        renew_settings(active);
        *timing = Timing::new(period_us(active.as_ref()));
    }

    /// The node ids of the axis.
    #[must_use]
    pub const fn ids(&self) -> AxisIds {
        self.ids
    }

    /// State of the drive.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.axis.drive
    }

    /// Torque that is commanded at present.
    #[must_use]
    pub fn torque(&self) -> Torque {
        Torque::from_micro_nm(self.axis.last.micro_nm)
    }

    /// The commanded reference of the last cycle; `None` without torque.
    #[must_use]
    pub const fn reference(&self) -> Option<Reference> {
        self.axis.last.reference
    }

    /// Offset that the backlash unit adds to the reference.
    #[must_use]
    pub const fn backlash_offset(&self) -> PositionError {
        self.axis.backlash_offset()
    }

    /// Refined factor on the levels of the friction model, 1e-6.
    #[must_use]
    pub fn refined_level_millionths(&self) -> i32 {
        self.axis.refined_level_millionths()
    }

    /// Setpoints and feedbacks in a row that the present torque had to do without.
    #[must_use]
    pub const fn bridged(&self) -> (u16, u16) {
        self.axis.watchdog.misses()
    }

    /// What happened on the bus since reset.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        Counts {
            scale_warnings: self.axis.encoders.scale_warnings(),
            ..self.axis.watchdog.counts
        }
    }

    /// The active parameters.
    #[must_use]
    pub const fn settings(&self) -> Option<&Settings> {
        self.active.as_ref()
    }
}

/// Apart, so that what is made is not on the stack beside what was made before.
#[inline(never)]
fn renew<T: Default>(place: &mut T) {
    *place = T::default();
}

/// The settings of a set that nobody has written to.
fn defaults() -> Option<Settings> {
    ParameterSet::default().settings().ok()
}

#[inline(never)]
fn renew_settings(active: &mut Option<Settings>) {
    *active = defaults();
}

fn period_us(settings: Option<&Settings>) -> u32 {
    settings.map_or(0, |settings| settings.period_us)
}

const fn emergency(fault: Fault, counter: u8) -> EmergencyMessage {
    EmergencyMessage::new(
        fault.emergency_code(),
        ERROR_REGISTER,
        [fault.code(), counter, 0, 0, 0],
    )
}

const ERROR_REGISTER: protocol::message::ErrorRegister =
    protocol::message::ErrorRegister(protocol::message::ErrorRegister::GENERIC);
