//! Makes that are held back: written by somebody who had seen neither what the identification says
//! about the other makes nor what it says about these.
//!
//! No threshold is moved to suit them. They are run once, at the end, and are a table of their own.
//! The machines are of other trades than those beside them: optics, robotics, stores and doors,
//! diving, printing. Controllers work by increments, with scheduled gains, with an integral that
//! is led back, by feedforward alone.

pub mod joints;
pub mod stages;
pub mod tools;
pub mod travels;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 4] =
    [stages::MAKES, tools::MAKES, joints::MAKES, travels::MAKES];
