//! Makes that nobody expects: written by somebody who had seen neither the identification nor a
//! verdict of it, after those of [`unforeseen`](mod@super::unforeseen) had been run.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! They are what customers of a maker of drives bring along: machine tools, a portal on racks,
//! presses, a robot's joint, carriages of textile machines and small laboratory axes. Masses go
//! from six hundred grams to two and a half tonnes, rates from 250 Hz to 4 kHz.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod cutting;
pub mod fine;
pub mod forming;
pub mod handling;
pub mod textile;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 5] = [
    cutting::MAKES,
    forming::MAKES,
    handling::MAKES,
    textile::MAKES,
    fine::MAKES,
];
