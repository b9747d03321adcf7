//! The search for the best pulse: Nelder–Mead in (ln Δn·T_comp, ln T_comp).
//!
//! The cost is a narrow valley along constant product Δn·T_comp, which these coordinates make
//! parallel to an axis.

use std::cell::RefCell;
use std::ops::Range;

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;

use super::TOLERANCE_UM;
use super::tuning_circles::TuningCircles;
use crate::compensation::{AxisCompensation, Compensation, Pulse};
use crate::error::{Failure, Outcome};
use crate::progress;

/// Most circles of one search.
const MOST_CIRCLES: u64 = 30;
/// First steps of the search in ln(way) and ln(T).
const STEPS: [f64; 2] = [0.12, 0.15];
/// Time constants that make sense: from a tenth of a cycle to the longest that the drive holds,
/// which is longer than any reversal. A burst over which a loop rings would lead beyond it.
pub(super) const SENSIBLE_S: Range<f64> = 1.0e-4..2.1;
/// The largest step of speed that makes sense: as fast as the fastest of our axes moves.
const SENSIBLE_M_PER_S: f64 = 0.5;
/// What a pulse costs for which no circle is run: more than any burst.
const NO_CIRCLE_UM: f64 = 1.0e6;

/// The search on one axis.
pub(super) struct Search<'a, 'b, 'm> {
    /// Circles to try pulses on.
    pub(super) circles: &'b RefCell<TuningCircles<'a, 'm>>,
    /// The axis.
    pub(super) axis: usize,
    /// Compensation of all axes; that of this one is varied.
    pub(super) others: Vec<AxisCompensation>,
    /// Time from the reversal to the start of the pulse, which is not varied.
    pub(super) start_delay_s: f64,
    /// Why a circle could not be run: the solver's error has no room for it.
    pub(super) failure: RefCell<Option<Failure>>,
}

impl Search<'_, '_, '_> {
    /// The best pulse that circles find from a start.
    pub(super) fn run(self, start: Pulse) -> Outcome<Pulse> {
        let way = start.height_m_per_s * start.time_constant_s;
        let corner = vec![way.ln(), start.time_constant_s.ln()];
        let moved = |place: usize| {
            let mut corner = corner.clone();
            corner[place] += STEPS[place];
            corner
        };
        let solver = NelderMead::new(vec![corner.clone(), moved(0), moved(1)])
            .with_sd_tolerance(TOLERANCE_UM);
        let solver = solver.map_err(|error| Failure::new(error.to_string()))?;
        let executor =
            Executor::new(&self, solver).configure(|state| state.max_iters(MOST_CIRCLES));
        match executor.run() {
            Ok(result) => {
                let best = result.state().get_best_param().cloned().unwrap_or(corner);
                Ok(self.pulse(&best))
            }
            Err(error) => Err(self
                .failure
                .take()
                .unwrap_or_else(|| Failure::new(error.to_string()))),
        }
    }

    fn pulse(&self, corner: &[f64]) -> Pulse {
        let (way, time_constant_s) = (corner[0].exp(), corner[1].exp());
        Pulse {
            height_m_per_s: way / time_constant_s,
            time_constant_s,
            start_delay_s: self.start_delay_s,
        }
    }

    fn burst_um(&self, pulse: Pulse) -> Outcome<f64> {
        let mut compensation = self.others.clone();
        compensation[self.axis].reversal = Compensation::Pulse(pulse);
        let mut circles = self.circles.borrow_mut();
        let burst = circles.run(&compensation)?.bursts_um[self.axis];
        progress::step(&format!(
            "circle {}: {:.3} mm/s, {:.1} ms: burst {burst:.2} µm",
            circles.count,
            1.0e3 * pulse.height_m_per_s,
            1.0e3 * pulse.time_constant_s
        ));
        Ok(burst)
    }
}

impl CostFunction for &Search<'_, '_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, corner: &Self::Param) -> Result<f64, argmin::core::Error> {
        let pulse = self.pulse(corner);
        if !makes_sense(&pulse) {
            return Ok(NO_CIRCLE_UM);
        }
        self.burst_um(pulse).map_err(|failure| {
            *self.failure.borrow_mut() = Some(failure.clone());
            argmin::core::Error::msg(failure.0)
        })
    }
}

/// No circle is run for a pulse outside of this.
fn makes_sense(pulse: &Pulse) -> bool {
    SENSIBLE_S.contains(&pulse.time_constant_s) && pulse.height_m_per_s.abs() <= SENSIBLE_M_PER_S
}

#[cfg(test)]
mod tests {
    use servo::objects::{Parameter, TABLE};

    use super::*;

    #[test]
    fn every_time_constant_that_is_tried_can_be_downloaded() {
        let mut entries = TABLE.iter();
        let entry = entries.find(|entry| entry.parameter == Parameter::PulseTime);
        let entry = entry.unwrap();
        let most_s = f64::from(entry.max) / entry.unit().per_si as f64;
        let tried = |time_constant_s: f64| {
            makes_sense(&Pulse {
                height_m_per_s: 1.0e-3,
                time_constant_s,
                start_delay_s: 0.0,
            })
        };
        assert!(tried(0.05) && tried(2.0) && !tried(most_s), "{most_s}");
    }
}
