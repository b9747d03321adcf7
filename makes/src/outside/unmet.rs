//! Disturbances outside the list on machines that nobody has met, as the makes of
//! [`mod@crate::make::unmet`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | drawer tester | a burr catches one way only |
//! | ceiling stand | a bundle of hoses resists by where it came from, over decimetres |
//! | ballast table | a loose weight is pushed from one stop to the other |
//! | wave paddle | a flap drags with velocity squared, one way only |
//! | braiding carriage | the current loop rings |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

mod loose;
mod rubs;

use super::{Outside, of};
use crate::truth::Effect;
use loose::{ballast, braider, loose_weight, ringing};
use rubs::{burr, ceiling_stand, drawer, flap, hoses, paddle};

/// All of them.
#[rustfmt::skip]
pub const UNMET: &[Outside] = &[
    of("drawer-tester", "a burr catches one way only", drawer, burr).or(Effect::PositionDependentFriction),
    of("ceiling-stand", "a bundle of hoses has hysteresis over decimetres", ceiling_stand, hoses).or(Effect::Presliding),
    of("ballast-table", "a loose weight is pushed from stop to stop", ballast, loose_weight).or(Effect::Backlash),
    of("wave-paddle", "a flap drags with velocity squared one way only", paddle, flap).or(Effect::QuadraticDrag),
    of("braiding-carriage", "the current loop rings", braider, ringing).or(Effect::Delay),
];
