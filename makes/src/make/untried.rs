//! Makes that nobody has tried: written by somebody who knew neither the identification nor what it
//! says about any make, after those of [`unseen`](mod@super::unseen) had been run.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! The trades are others once more: ships and basins, rails, timber and paper, field and bakery,
//! mines and kilns, opticians and laboratories, sport and film, dials and the sun. Some controllers
//! observe the disturbance; motions are packets, rasters, seeking and errands.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod bench;
pub mod ground;
pub mod kitchen;
pub mod rails;
pub mod shows;
pub mod timber;
pub mod turned;
pub mod water;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 8] = [
    water::MAKES,
    rails::MAKES,
    timber::MAKES,
    kitchen::MAKES,
    ground::MAKES,
    bench::MAKES,
    shows::MAKES,
    turned::MAKES,
];
