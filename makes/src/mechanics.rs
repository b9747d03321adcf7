//! What moves: bodies in a row, joints between them, friction on them, forces of place and time.
//!
//! The pieces are plain values. [`train::Train`] puts them together and steps them. Positions are
//! in metres and efforts in newtons on a linear axis, in radians and newton metres on a rotary one;
//! inertia is kg or kg m² with it. The motor's position is counted at the load (gear and lead are
//! divided out), so that all bodies of a train move by the same amount.

pub mod field;
pub mod friction;
pub mod inertia;
pub mod joint;
pub mod resistance;
pub mod train;
