//! Disturbances outside the list on machines that nobody has foreseen, as the makes of
//! [`mod@crate::make::unforeseen`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | plankton winch | a net sinks more slowly than its rope is paid out |
//! | gondola arm | a seat on board is swung in and out by itself |
//! | clarifier rake | sludge sets at rest and is stirred thin |
//! | orchard shuttle | a radio link is silent for moments |
//! | facade lift | the holding brake opens late after every stop |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

mod carried;
mod started;

use super::{Outside, of};
use crate::truth::Effect;
use carried::{gondola, plankton_winch, sinking_net, swung_seat};
use started::{facade_lift, late_brake, rake, shuttle, silence, sludge};

/// All of them.
#[rustfmt::skip]
pub const UNFORESEEN: &[Outside] = &[
    of("plankton-winch", "a net sinks more slowly than its rope is paid out", plankton_winch, sinking_net).or(Effect::QuadraticDrag),
    of("gondola-arm", "inertia breathes with time", gondola, swung_seat),
    of("clarifier-rake", "sludge sets at rest and is stirred thin", rake, sludge).or(Effect::FrictionDrift),
    of("orchard-shuttle", "telegrams are lost for moments", shuttle, silence).or(Effect::Delay),
    of("facade-lift", "the holding brake opens late", facade_lift, late_brake),
];
