//! Disturbances outside the list on machines that nobody expects, as the makes of
//! [`mod@crate::make::unexpected`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | stair lift | a centrifugal brake drags above a speed |
//! | stone saw | a lubricator gives a shot of oil every few seconds |
//! | bus door | the drive lets its force grow no faster than a ramp |
//! | thread grinder | the screw grows while it warms up |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

mod driven;
mod worked;

use super::{Outside, of};
use crate::truth::Effect;
use driven::{bus_door, centrifugal_brake, ramp, stair_lift};
use worked::{growing_screw, lubricator, stone_saw, thread_grinder};

/// All of them.
#[rustfmt::skip]
pub const UNEXPECTED: &[Outside] = &[
    of("stair-lift", "a centrifugal brake drags above a speed", stair_lift, centrifugal_brake).or(Effect::QuadraticDrag),
    of("stone-saw", "shots of oil take friction away by turns", stone_saw, lubricator).or(Effect::FrictionDrift),
    of("bus-door", "force grows no faster than a ramp", bus_door, ramp).or(Effect::Delay),
    of("thread-grinder", "the screw grows while it warms up", thread_grinder, growing_screw),
];
