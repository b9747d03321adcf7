//! Makes that nobody has looked for: written by somebody who had seen neither the identification
//! nor a verdict of it, after those of [`unexpected`](mod@super::unexpected) had been run.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! They stand out of doors, about aircraft, on test benches, in stores and in works that make
//! crystals and cans. Inertias go from some hundredths of a kilogram metre squared to four million,
//! rates from 250 Hz to 8 kHz.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod aircraft;
pub mod outdoors;
pub mod stores;
pub mod testing;
pub mod works;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 5] = [
    outdoors::MAKES,
    aircraft::MAKES,
    testing::MAKES,
    stores::MAKES,
    works::MAKES,
];
