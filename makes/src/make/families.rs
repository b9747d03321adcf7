//! Makes by the families of friction, waves and masses: written by somebody who had seen neither
//! the identification nor a verdict of it, after those of [`unsought`](mod@super::unsought).
//!
//! | family | makes |
//! |---|---|
//! | generalised Maxwell slip that lags | knife grinder, marble router |
//! | a Stribeck curve with another exponent | knife grinder, kneading hook, sausage filler |
//! | friction over position that is no line | retort basket, film scanner, kneading hook |
//! | several waves of torque ripple | film scanner, pinning drum |
//! | several waves of the pitch | jig borer, tile glazer |
//! | friction of motor and load apart | marble router, jig borer, tile glazer |
//! | masses of motor and load apart | tile glazer; by the motor alone: soil auger |
//!
//! Inertias go from some millionths of a kilogram metre squared to two tonnes, rates from 250 Hz
//! to 4 kHz.
//!
//! A make asks for each of its effects by name, so that each of them can be shown alone: see
//! [`Presence::Only`](super::Presence::Only).

pub mod lags;
pub mod masses;
pub mod places;
pub mod waves;

use crate::make::Make;

/// The families.
pub(super) const FAMILIES: [&[Make]; 4] = [lags::MAKES, places::MAKES, waves::MAKES, masses::MAKES];
