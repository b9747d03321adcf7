//! Makes that nobody has looked at: written by somebody who had seen neither the identification
//! nor what it says about any make, after those of [`held_back`](mod@super::held_back) had been
//! run.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! The trades are others again: cloth, wafers, glass and stone, cranes and stages, medicine,
//! antennas, bottles. Controllers are lead compensators and sliding modes too, motions are strokes,
//! indexing, tracking, weaving and a ladder of speeds.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod clamping;
pub mod cleanroom;
pub mod cutting;
pub mod lifting;
pub mod medicine;
pub mod packing;
pub mod pointing;
pub mod textiles;
pub mod turning;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 9] = [
    textiles::MAKES,
    cleanroom::MAKES,
    cutting::MAKES,
    clamping::MAKES,
    lifting::MAKES,
    turning::MAKES,
    medicine::MAKES,
    pointing::MAKES,
    packing::MAKES,
];

/// Standard gravity, m/s².
pub(crate) const GRAVITY_M_S2: f64 = 9.806_65;
