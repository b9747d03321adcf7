//! Which sines: an A-optimal design, one sine after the other.
//!
//! Each parameter is to be known to a share of its size, so the sum of all relative variances is
//! what has to fall: the trace of (I + F)⁻¹, F the information of what is moved, I that of somebody
//! who knows each parameter to its own size. The sine is taken that lowers the mean of its
//! logarithm over the usual axes most for each second that it lasts, until the time is used up
//! (Atkinson, Donev, Tobias 2007, Optimum Experimental Designs, chapters 10 to 12). No sine is
//! taken twice at a place, so that what the design does not know of is seen at several places, and
//! in several stretches of the record.

use std::f64::consts::TAU;

use plant_sim::machine::MachineAxis;

use super::information::{Information, UsualAxis};
use crate::trajectory::windowed_sine::WindowedSine;

/// Peak velocities and peak accelerations, as shares of the limits of the axis.
const VELOCITIES: [f64; 8] = [0.003, 0.008, 0.02, 0.05, 0.12, 0.25, 0.45, 0.65];
const ACCELERATIONS: [f64; 8] = [0.0008, 0.004, 0.015, 0.05, 0.12, 0.25, 0.45, 0.65];
/// Sines of the menu, Hz: a slower one lasts too long, a faster one is beyond the position loop.
const FREQUENCIES_HZ: std::ops::Range<f64> = 0.25..12.0;
/// Shortest stroke from the centre, m: several times a usual bristle.
const LEAST_AMPLITUDE_M: f64 = 1.0e-4;
/// The most of the travel that is used.
const MOST_TRAVEL: f64 = 0.8;
/// Periods of a sine at full amplitude.
const PERIODS: f64 = 2.5;
/// Rest before a sine, s.
const REST_S: f64 = 0.3;

/// Falls and deflections of the usual axes: shares of the largest velocity, and m.
const FALLS: [f64; 3] = [0.001, 0.004, 0.016];
const DEFLECTIONS_M: [f64; 2] = [4.0e-6, 20.0e-6];
/// Coulomb friction, and viscous friction at the largest velocity, as shares of the largest effort.
const COULOMB: f64 = 0.04;
const VISCOUS: f64 = 0.1;
/// Load, as a share of the moved mass, and its frequency on the screw of a motor that stands, Hz.
const LOAD: f64 = 0.4;
const LOCKED_HZ: f64 = 80.0;
/// Noise of the effort, as a share of the Coulomb friction.
const NOISE: f64 = 0.1;

/// How a record moves, as shares: so that two records of an axis do not move alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Menu {
    /// Of every velocity.
    pub velocity: f64,
    /// Of every acceleration.
    pub acceleration: f64,
    /// Centres, as shares of the travel.
    pub centres: &'static [f64],
    /// The time of the record, s.
    pub time_s: f64,
}

/// The sines of a record within a time, in the order of their centres, the slow ones first.
#[must_use]
pub(super) fn design(
    axis: &MachineAxis,
    period_s: f64,
    menu: &Menu,
    mut left_s: f64,
) -> Vec<WindowedSine> {
    let usual = usual_axes(axis, period_s);
    let mut known = vec![Information::identity(); usual.len()];
    let sines = menu.sines(axis);
    let mut choices: Vec<Choice> = sines.map(|sine| Choice::of(sine, &usual)).collect();
    while let Some(best) = best(&choices, &known, left_s) {
        let chosen = &mut choices[best];
        chosen.is_taken = true;
        left_s -= chosen.lasts_s();
        for (known, told) in known.iter_mut().zip(&chosen.told) {
            *known += told;
        }
    }
    choices.retain(|choice| choice.is_taken);
    let begins = [1.0, -1.0].into_iter().cycle();
    let sines = choices.iter().zip(begins);
    sines
        .map(|(choice, direction)| WindowedSine {
            direction,
            ..choice.sine
        })
        .collect()
}

/// A sine with what it tells of each usual axis.
struct Choice {
    sine: WindowedSine,
    told: Vec<Information>,
    is_taken: bool,
}

impl Choice {
    fn of(sine: WindowedSine, usual: &[UsualAxis]) -> Self {
        let told = usual.iter().map(|axis| PERIODS * axis.of_a_period(&sine));
        Self {
            sine,
            told: told.collect(),
            is_taken: false,
        }
    }

    /// With the rest before it.
    fn lasts_s(&self) -> f64 {
        self.sine.duration_s() + REST_S
    }

    /// By how much it lowers the mean of the variance's logarithm, which is so large, per second.
    fn gain_per_s(&self, known: &[Information], before: f64) -> f64 {
        let with = known.iter().zip(&self.told);
        let with: Vec<Information> = with.map(|(known, told)| known + told).collect();
        (before - mean_ln_variance(&with)) / self.lasts_s()
    }
}

/// The place of the sine that tells most per second in the time that is left.
fn best(choices: &[Choice], known: &[Information], left_s: f64) -> Option<usize> {
    let fits = |one: &Choice| !one.is_taken && one.lasts_s() <= left_s;
    let places = (0..choices.len()).filter(|place| fits(&choices[*place]));
    let before = mean_ln_variance(known);
    let gains = places.map(|place| (choices[place].gain_per_s(known, before), place));
    let best = gains.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, place)| place)
}

/// Mean of the logarithm over the usual axes.
fn mean_ln_variance(known: &[Information]) -> f64 {
    known.iter().map(ln_variance).sum::<f64>() / known.len() as f64
}

/// The logarithm of the sum of all relative variances.
fn ln_variance(information: &Information) -> f64 {
    information
        .cholesky()
        .map_or(f64::INFINITY, |factor| factor.inverse().trace().ln())
}

impl Menu {
    /// All sines within the limits of an axis.
    fn sines(&self, axis: &MachineAxis) -> impl Iterator<Item = WindowedSine> {
        let (limits, menu) = (axis.limits, *self);
        let sine = move |(centre, (v, a)): (f64, (f64, f64))| WindowedSine {
            centre_m: centre * limits.travel_m,
            velocity_m_per_s: v * menu.velocity * limits.velocity_m_per_s,
            acceleration_m_per_s2: a * menu.acceleration * limits.acceleration_m_per_s2,
            periods: PERIODS,
            direction: 1.0,
        };
        let is_possible = move |sine: &WindowedSine| {
            let amplitude_m = sine.amplitude_m();
            let reach_m = sine.centre_m.abs() + amplitude_m;
            FREQUENCIES_HZ.contains(&sine.period_s().recip())
                && amplitude_m >= LEAST_AMPLITUDE_M
                && reach_m <= MOST_TRAVEL * limits.travel_m
        };
        let speeds = || {
            let both = |v: f64| ACCELERATIONS.into_iter().map(move |a| (v, a));
            VELOCITIES.into_iter().flat_map(both)
        };
        let at_centre = move |centre: &f64| {
            let centre = *centre;
            speeds().map(move |speeds| (centre, speeds))
        };
        let all = self.centres.iter().flat_map(at_centre);
        all.map(sine).filter(is_possible)
    }
}

/// With what friction alone slows the load of a usual axis down, m/s².
#[must_use]
pub(super) fn coasting_m_per_s2(axis: &MachineAxis) -> f64 {
    let coulomb_n = COULOMB * axis.actual.force_limit_n;
    coulomb_n / (LOAD * gains_are_for_kg(axis))
}

/// What the drive's gains are for.
fn gains_are_for_kg(axis: &MachineAxis) -> f64 {
    let mechanics = axis.actual.mechanics;
    mechanics.motor_inertia_kg + mechanics.table_mass_kg
}

/// Axes that this one may turn out to be.
fn usual_axes(axis: &MachineAxis, period_s: f64) -> Vec<UsualAxis> {
    let own = &axis.actual;
    let limits = axis.limits;
    let inertia_kg = gains_are_for_kg(axis);
    let load_kg = LOAD * inertia_kg;
    let coulomb_n = COULOMB * own.force_limit_n;
    let usual = UsualAxis {
        inertia_kg,
        load_kg,
        coulomb_n,
        viscous_n_s_per_m: VISCOUS * own.force_limit_n / limits.velocity_m_per_s,
        fall_m_per_s: 0.0,
        deflection_m: 0.0,
        stiffness_n_per_m: load_kg * (TAU * LOCKED_HZ).powi(2),
        effort_noise_n: NOISE * coulomb_n,
        scale_noise_m: Some(own.load_encoder_resolution_m),
        travel_m: limits.travel_m,
        lead_m: own.lead_m_per_rev,
        rate_hz: period_s.recip(),
    };
    let fall = |share: f64| UsualAxis {
        fall_m_per_s: share * limits.velocity_m_per_s,
        ..usual
    };
    let deflection = |axis: UsualAxis| {
        DEFLECTIONS_M.map(|deflection_m| UsualAxis {
            deflection_m,
            ..axis
        })
    };
    FALLS.map(fall).into_iter().flat_map(deflection).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant_sim::Machine;

    /// Mean over the usual axes of the logarithm of what is left of the variance.
    fn left(sines: &[WindowedSine]) -> f64 {
        let usual = usual_axes(&Machine::reference().axes[0], 1.0e-3);
        let of_axis = |axis: &UsualAxis| {
            let told = sines
                .iter()
                .map(|sine| sine.periods * axis.of_a_period(sine));
            told.fold(Information::identity(), |sum, told| sum + told)
        };
        mean_ln_variance(&usual.iter().map(of_axis).collect::<Vec<_>>())
    }

    /// Nine sines of one place, as somebody would choose them without a design: 30 s.
    const BY_HAND: [(f64, f64); 9] = [
        (0.003, 0.0008),
        (0.008, 0.004),
        (0.02, 0.02),
        (0.05, 0.05),
        (0.12, 0.15),
        (0.3, 0.15),
        (0.3, 0.6),
        (0.6, 0.4),
        (0.1, 0.5),
    ];

    #[test]
    fn the_design_leaves_less_than_half_of_the_variance_of_sines_chosen_by_hand() {
        let axis = &Machine::reference().axes[0];
        let menu = Menu {
            velocity: 1.0,
            acceleration: 1.0,
            centres: &[-0.6, -0.3, 0.0, 0.3, 0.6],
            time_s: 0.0,
        };
        let by_hand = BY_HAND.map(|(v, a)| WindowedSine {
            centre_m: 0.0,
            velocity_m_per_s: v * axis.limits.velocity_m_per_s,
            acceleration_m_per_s2: a * axis.limits.acceleration_m_per_s2,
            periods: PERIODS,
            direction: 1.0,
        });
        let time_s: f64 = by_hand.iter().map(|sine| sine.duration_s() + REST_S).sum();
        let designed = design(axis, 1.0e-3, &menu, time_s);
        let gain = left(&by_hand) - left(&designed);
        assert!(gain > 2.0_f64.ln(), "{gain}");
    }

    #[test]
    fn more_time_leaves_less() {
        let axis = &Machine::reference().axes[0];
        let menu = Menu {
            velocity: 0.8,
            acceleration: 0.65,
            centres: &[-0.4, 0.4],
            time_s: 0.0,
        };
        let [short, long] = [10.0, 30.0].map(|time_s| design(axis, 1.0e-3, &menu, time_s));
        assert!(left(&long) < left(&short) && short.len() < long.len());
        let lasts_s =
            |sines: &[WindowedSine]| -> f64 { sines.iter().map(WindowedSine::duration_s).sum() };
        assert!(lasts_s(&short) < 10.0 && lasts_s(&long) < 30.0);
    }
}
