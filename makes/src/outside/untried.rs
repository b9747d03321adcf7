//! Disturbances outside the list on machines that nobody has tried, as the makes of
//! [`mod@crate::make::untried`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | cake slitter | ultrasound takes friction away, on and off |
//! | sluice gate | the counterweight's tank drains: a force that grows evenly |
//! | funicular | the supply's voltage is eaten up by speed, u·(1 − (v/v₀)²) |
//! | zoom ring | click stops at uneven places |
//! | ore sampler | blows of a stamp mill next door |
//! | people mover | one magnet of the track is weak |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

mod powers;
mod pushes;

use super::{Outside, of};
use crate::truth::Effect;
use powers::{funicular, people_mover, slitter, starved, ultrasound, weak_magnet};
use pushes::{click_stops, draining_tank, sampler, sluice, stamp_mill, zoom_ring};

/// All of them.
#[rustfmt::skip]
pub const UNTRIED: &[Outside] = &[
    of("cake-slitter", "ultrasound takes friction away, on and off", slitter, ultrasound),
    of("sluice-gate", "the counterweight's tank drains", sluice, draining_tank),
    of("funicular", "the supply's voltage is eaten up by speed", funicular, starved),
    of("zoom-ring", "click stops at uneven places", zoom_ring, click_stops),
    of("ore-sampler", "blows of a stamp mill next door", sampler, stamp_mill),
    of("people-mover", "one magnet of the track is weak", people_mover, weak_magnet).or(Effect::TorqueConstantRipple),
];
