//! Makes that nobody has met: written by somebody who had seen neither the identification nor a
//! verdict of it, after those of [`untried`](mod@super::untried) had been run.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! The trades are others again: hospitals, harbours and locks, foundries, halls in which ham is
//! sliced, carpets are tufted and an orchestra is lifted, and domes. Rates go from 250 Hz to 8 kHz.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod foundry;
pub mod halls;
pub mod harbour;
pub mod hospital;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 4] = [
    hospital::MAKES,
    harbour::MAKES,
    foundry::MAKES,
    halls::MAKES,
];
