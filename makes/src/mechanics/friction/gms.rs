//! Generalised Maxwell slip: elements side by side, each of which sticks or slips.
//!
//! | element | what its force does | until |
//! |---|---|---|
//! | sticks | dF = k·dx | F reaches share·s(v) in the direction of motion |
//! | slips | dF/dt = sign(v)·C·(share − abs(F)/s(v)) | the velocity changes its sign |
//!
//! s(v) is Stribeck's curve. Beneath it the elements remember every reversal that has not been
//! passed; on it friction follows the curve with the time constant s/C, behind the velocity
//! (frictional lag: Hess and Soom, ASME J. Tribology 112, 1990). Lampaert, Al-Bender and Swevers,
//! IEEE PhysCon, St Petersburg, 2003; Al-Bender, Lampaert and Swevers, IEEE TAC 50, 2005. Both are
//! stepped in closed form, at the velocity of the step.

use super::{Law, Stribeck, fall};

/// One of the elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asperity {
    /// Its share of the level; those of all elements add up to one.
    pub share: f64,
    /// Stiffness while it sticks.
    pub stiffness: f64,
}

/// The law.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneralisedMaxwellSlip {
    /// Sliding level.
    pub coulomb: f64,
    /// Fall.
    pub stribeck: Option<Stribeck>,
    /// Time constant of the lag where friction has fallen to its sliding level, s: C is the level
    /// over it.
    pub lag_s: f64,
    /// The elements.
    pub elements: Vec<Asperity>,
}

/// Force and direction of slip of an element; zero while it sticks.
pub(super) const STATES_OF_ONE: usize = 2;

impl GeneralisedMaxwellSlip {
    pub(super) fn stiffness(&self) -> f64 {
        self.elements.iter().map(|e| e.stiffness).sum()
    }

    /// The force at the end of a step.
    pub(super) fn slide(&self, state: &mut [f64], velocity: f64, step_s: f64) -> f64 {
        if velocity != 0.0 {
            let curve = self.coulomb * fall(self.stribeck, velocity);
            let kept = libm::exp(-step_s * self.coulomb / (self.lag_s * curve));
            for (state, element) in state.chunks_exact_mut(STATES_OF_ONE).zip(&self.elements) {
                element.slide(state, velocity * step_s, element.share * curve, kept);
            }
        }
        state.iter().step_by(STATES_OF_ONE).sum()
    }
}

impl Asperity {
    /// Over a way, with its part of the curve and what is kept of the distance to it while it
    /// slips.
    fn slide(&self, state: &mut [f64], way: f64, limit: f64, kept: f64) {
        let direction = way.signum();
        let forward = state[0] * direction;
        if state[1] * direction > 0.0 || forward >= limit {
            state[0] = direction * (limit + (forward - limit) * kept);
            state[1] = direction;
        } else {
            let stuck = forward + self.stiffness * way.abs();
            state[0] = direction * stuck.min(limit);
            state[1] = if stuck < limit { 0.0 } else { direction };
        }
    }
}

impl Law {
    /// Generalised Maxwell slip of so many elements of one share, which slip at the sliding level
    /// one after the other, evenly up to a deflection.
    #[must_use]
    pub fn generalised_maxwell_slip(
        coulomb: f64,
        stribeck: Option<Stribeck>,
        lag_s: f64,
        deflection: f64,
        count: usize,
    ) -> Self {
        let share = 1.0 / count as f64;
        let element = |i: usize| Asperity {
            share,
            stiffness: coulomb / (deflection * (i + 1) as f64),
        };
        Self::GeneralisedMaxwellSlip(GeneralisedMaxwellSlip {
            coulomb,
            stribeck,
            lag_s,
            elements: (0..count).map(element).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FALL: Stribeck = Stribeck {
        excess: 0.6,
        velocity: 0.02,
        exponent: 1.3,
    };
    const LAG_S: f64 = 4.0e-3;

    fn law(stribeck: Option<Stribeck>) -> Law {
        Law::generalised_maxwell_slip(10.0, stribeck, LAG_S, 2.0e-5, 8)
    }

    /// Force after a time at a velocity.
    fn after(law: &Law, state: &mut [f64], velocity: f64, time_s: f64) -> f64 {
        let mut force = 0.0;
        for _ in 0..10_000 {
            force = law.slide(state, velocity, time_s * 1.0e-4).force;
        }
        force
    }

    #[test]
    fn far_from_a_reversal_it_is_on_its_curve() {
        let law = law(Some(FALL));
        let mut state = vec![0.0; law.states()];
        for velocity in [0.5, 0.02, -0.01, -0.5, 0.005] {
            let curve = 10.0 * FALL.factor(velocity) * velocity.signum();
            let force = after(&law, &mut state, velocity, 0.2);
            assert!((force - curve).abs() < 1.0e-6, "{velocity}: {force}");
        }
        assert_eq!((law.level(), law.states()), (10.0, 16));
        assert_eq!(law.clone().scaled(1.5).level(), 15.0);
    }

    #[test]
    fn it_is_stiff_first_and_soft_later() {
        let law = law(Some(FALL));
        let mut state = vec![0.0; law.states()];
        let first = after(&law, &mut state, 1.0e-4, 1.0e-2);
        let more = after(&law, &mut state, 1.0e-4, 0.1);
        assert!((first - 1.0e-6 * 10.0 / law.deflection()).abs() < 1.0e-9);
        assert!(more < 8.0 * first && more > first, "{first} {more}");
    }

    #[test]
    fn after_a_step_of_the_velocity_63_percent_of_the_change_has_come_with_the_lag() {
        let law = law(Some(FALL));
        for (from, to) in [(0.005, 0.03), (0.03, 0.005), (-0.01, -0.2)] {
            let mut state = vec![0.0; law.states()];
            let before = after(&law, &mut state, from, 0.2);
            let lag_s = LAG_S * FALL.factor(to);
            let then = after(&law, &mut state, to, lag_s);
            let settled = after(&law, &mut state, to, 0.2);
            let come = (then - before) / (settled - before);
            assert!((come - 0.632_12).abs() < 1.0e-4, "{from} {to}: {come}");
        }
    }

    #[test]
    fn without_a_fall_it_is_maxwell_slip_whatever_the_lag() {
        let (law, plain) = (law(None), Law::maxwell_slip(10.0, 2.0e-5, 8));
        let mut states = [vec![0.0; law.states()], vec![0.0; plain.states()]];
        for k in 0..20_000 {
            let k = f64::from(k);
            let velocity = 0.01 * libm::cos(3.0e-3 * k) + 0.006 * libm::sin(7.1e-3 * k);
            let force = law.slide(&mut states[0], velocity, 1.0e-5).force;
            let wanted = plain.slide(&mut states[1], velocity, 1.0e-5).force;
            assert!((force - wanted).abs() < 1.0e-9, "{k}: {force} {wanted}");
        }
    }

    /// A small loop closes where it began, and what comes after it is as if it had not been.
    #[test]
    fn beneath_the_curve_it_remembers_every_reversal_that_has_not_been_passed() {
        let law = law(Some(FALL));
        let mut states = [vec![0.0; law.states()], vec![0.0; law.states()]];
        let [outer, looped] = &mut states;
        for state in [&mut *outer, &mut *looped] {
            after(&law, state, 1.0e-4, 0.18);
            after(&law, state, -1.0e-4, 0.08);
        }
        let bottom = after(&law, looped, 1.0e-4, 1.0e-9);
        after(&law, looped, 1.0e-4, 0.05);
        let closed = after(&law, looped, -1.0e-4, 0.05);
        assert!((closed - bottom).abs() < 1.0e-6, "{closed} {bottom}");
        let [then, wanted] = [looped, outer].map(|state| after(&law, state, -1.0e-4, 0.07));
        assert!((then - wanted).abs() < 1.0e-6, "{then} {wanted}");
    }

    #[test]
    fn what_stands_keeps_its_force_and_a_reversal_makes_it_stick() {
        let law = law(Some(FALL));
        let mut state = vec![0.0; law.states()];
        let moving = after(&law, &mut state, 0.1, 0.2);
        assert!((after(&law, &mut state, 0.0, 0.2) - moving).abs() < 1.0e-12);
        let back = after(&law, &mut state, -1.0e-4, 1.0e-3);
        let sprung = 1.0e-7 * 10.0 / law.deflection();
        assert!((moving - back - sprung).abs() < 1.0e-9);
        assert!(state.iter().skip(1).step_by(2).all(|slips| *slips == 0.0));
    }
}
