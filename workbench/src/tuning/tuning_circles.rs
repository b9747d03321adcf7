//! Circles that tuning runs, one turn each: a turn shows each reversal once, and noise is far below
//! the burst.

use crate::ballbar::{self, Point};
use crate::compensation::AxisCompensation;
use crate::error::Outcome;
use crate::session::Session;
use crate::trajectory::{Circle, MEASURE_FROM_RAD};

/// A circle that was run.
pub(super) struct TuningCircle {
    /// Turn that counts.
    pub(super) points: Vec<Point>,
    /// Nominal radius, m.
    pub(super) radius_m: f64,
    /// Largest burst of each axis, µm.
    pub(super) bursts_um: [f64; 2],
}

/// A session that runs tuning circles, and counts them.
pub(super) struct TuningCircles<'a, 'm> {
    session: &'a mut Session<'m>,
    circle: Circle,
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

    /// Runs one more circle, with this compensation.
    pub(super) fn run(&mut self, compensation: &[AxisCompensation]) -> Outcome<TuningCircle> {
        self.session.compensate(compensation)?;
        self.count += 1;
        let points = self.session.circle(&self.circle)?;
        let radius_m = self.circle.radius_m;
        // The window about the reversals is not widened for a gap: a real machine does not tell it.
        let figures = || ballbar::figures(&points, radius_m, 0.0, MEASURE_FROM_RAD);
        let figures = self.session.meanwhile(figures)?;
        Ok(TuningCircle {
            points,
            radius_m,
            bursts_um: figures.axis_bursts_um(),
        })
    }
}
