//! Circles that tuning runs, one turn each: a turn shows each reversal once, and noise is far below
//! the burst.

use crate::ballbar::{self, CircleFigures, Point};
use crate::compensation::AxisCompensation;
use crate::error::Outcome;
use crate::session::Session;
use crate::trajectory::{Circle, MEASURE_FROM_RAD};

/// A session that runs tuning circles, and counts them.
pub(super) struct TuningCircles<'a, 'm> {
    session: &'a mut Session<'m>,
    /// The circle, one turn of it.
    pub(super) circle: Circle,
    /// How many were run.
    pub(super) count: u32,
}

impl<'a, 'm> TuningCircles<'a, 'm> {
    /// On a session that is ready to move.
    pub(super) fn on(session: &'a mut Session<'m>, circle: &Circle) -> Self {
        Self {
            session,
            circle: Circle {
                turns: 1,
                ..*circle
            },
            count: 0,
        }
    }

    /// The points of one more circle, with this compensation.
    pub(super) fn points(&mut self, compensation: &[AxisCompensation]) -> Outcome<Vec<Point>> {
        self.session.compensate(compensation)?;
        self.count += 1;
        self.session.circle(&self.circle)
    }

    /// The figures of its points; the window about the reversals is not widened for a gap, which a
    /// real machine does not tell.
    pub(super) fn figures(&self, points: &[Point]) -> CircleFigures {
        ballbar::figures(points, self.circle.radius_m, 0.0, MEASURE_FROM_RAD)
    }
}
