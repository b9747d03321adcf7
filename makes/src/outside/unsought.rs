//! Disturbances outside the list on machines that nobody has looked for, as the makes of
//! [`mod@crate::make::unsought`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | tank for surfboard fins | a foil is pushed to one side with velocity squared, on either way |
//! | slide of a recoil tester | a dashpot drags more the farther it goes |
//! | luggage cart | its battery sags under load and recovers |
//! | worm that spaces bottles | a ripple whose pitch changes on its way |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

mod supplied;
mod wet;

use super::{Outside, of};
use crate::truth::Effect;
use supplied::{battery, bottle_spacer, growing_pitch, luggage_cart};
use wet::{fin_tank, foil, narrowing_groove, recoil_slide};

/// All of them.
#[rustfmt::skip]
pub const UNSOUGHT: &[Outside] = &[
    of("fin-tank", "a foil is pushed to one side on either way", fin_tank, foil).or(Effect::ViscousAsymmetry),
    of("recoil-slide", "a dashpot drags more the farther it goes", recoil_slide, narrowing_groove).or(Effect::PositionDependentFriction),
    of("luggage-cart", "the battery sags under load and recovers", luggage_cart, battery).or(Effect::TorqueSaturation),
    of("bottle-spacer", "a ripple whose pitch changes on its way", bottle_spacer, growing_pitch).or(Effect::TorqueRipple),
];
