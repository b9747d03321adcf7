//! Makes that nobody has foreseen: written by somebody who had seen neither the identification nor
//! a verdict of it, after those of [`unmet`](mod@super::unmet) had been run.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! The trades are others again: printers, opticians, clean rooms and clinics, farms, wind and
//! weather, mills, open pits and stages. Masses go from four hundred grams to hundreds of tonnes,
//! rates from 250 Hz to 8 kHz; motions are soft shifts, swells of two waves and doublets too.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod farms;
pub mod heavy;
pub mod laboratory;
pub mod mills;
pub mod optics;
pub mod printing;
pub mod weather;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 7] = [
    printing::MAKES,
    optics::MAKES,
    laboratory::MAKES,
    farms::MAKES,
    weather::MAKES,
    mills::MAKES,
    heavy::MAKES,
];
