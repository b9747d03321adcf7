//! Disturbances outside the list on machines that nobody has looked at, as the makes of
//! [`mod@crate::make::unseen`] are.
//!
//! | machine | what no name of the list says |
//! |---|---|
//! | brake of a ski lift | its disc springs are progressive, F = k·x·(1 + (x/a)²) |
//! | coaster car | an eddy-current brake drags most at one speed (Wouterse 1991) |
//! | glue spreader | the glue thins under shear, F = c·vⁿ (Ostwald, de Waele) |
//! | shaker table | a dashpot hangs in rubber: Maxwell's element, c·v behind a spring |
//! | dish in the wind | gusts: a force over time with no period of its own |
//! | furnace electrode | the supply flickers and the force with it |
//! | valve cylinder | the spool sticks: force lags the current by a play |
//! | spot-welding gun | the amplifier clips; the log shows what was asked for |
//! | freewheel drum | a flywheel is there in one direction only |
//!
//! Each of them without its disturbance is a record on which nothing is lacking.

mod drives;
mod forces;
mod masses;

use super::{Outside, of};
use crate::truth::Effect;
use drives::{clipped, electrode, flickering, gun, spool, sticking};
use forces::{
    coaster_car, disc_springs, eddy_brake, glue_film, lift_brake, rubber_dashpot, shaker, spreader,
};
use masses::{dish, drum, freewheel, gusts};

/// All of them.
#[rustfmt::skip]
pub const UNSEEN: &[Outside] = &[
    of("ski-lift-brake", "the brake's disc springs are progressive", lift_brake, disc_springs),
    of("eddy-brake-car", "an eddy-current brake drags most at one speed", coaster_car, eddy_brake),
    of("glue-spreader", "the glue thins under shear", spreader, glue_film),
    of("freewheel-drum", "a flywheel is driven one way only", drum, freewheel),
    of("dish-in-wind", "gusts of wind", dish, gusts),
    of("furnace-electrode", "the supply flickers", electrode, flickering),
    of("valve-cylinder", "the spool sticks within a play", spool, sticking),
    of("shaker-dashpot", "a dashpot hangs in rubber", shaker, rubber_dashpot),
    of("spot-welding-gun", "the amplifier clips", gun, clipped).or(Effect::TorqueSaturation),
];
