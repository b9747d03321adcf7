//! A train of bodies, and its step.
//!
//! M a = drive + joints + fields − drag − friction. The step is Moreau's midpoint rule (Acary and
//! Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 2008, §10): half a step of way,
//! a whole step of momentum in which rigid friction takes what it needs to stop the body and no
//! more than its level, half a step of way. Without friction that is Störmer and Verlet's rule: of
//! second order, and energy neither grows nor decays. With friction a body that sticks stands
//! exactly.

use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::{Contact, Scale, Surface};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;

/// What a train is made of. Body 0 is the motor, the last is the load.
#[derive(Clone, Debug, PartialEq)]
pub struct Train {
    /// Inertia of each body.
    pub inertias: Vec<Inertia>,
    /// Joint between a body and the next.
    pub joints: Vec<Joint>,
    /// Friction.
    pub surfaces: Vec<Surface>,
    /// Drag.
    pub drags: Vec<Drag>,
    /// Forces of place and time, with the body on which they act.
    pub fields: Vec<(usize, Field)>,
}

/// Where a train is.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainState {
    /// Position of each body.
    pub positions: Vec<f64>,
    /// Velocity of each body.
    pub velocities: Vec<f64>,
    /// Time, s.
    pub time_s: f64,
    bristles: Vec<Vec<f64>>,
    slipped: Vec<f64>,
    transmitted: Vec<f64>,
}

impl Train {
    /// One body with Coulomb and viscous friction.
    #[must_use]
    pub fn one(inertia: f64, coulomb: f64, viscous: f64) -> Self {
        use crate::mechanics::friction::Law;
        Self {
            inertias: vec![Inertia::Constant(inertia)],
            joints: Vec::new(),
            surfaces: vec![Surface::new(0, Law::coulomb(coulomb))],
            drags: vec![Drag::viscous(0, viscous)],
            fields: Vec::new(),
        }
    }

    /// The same train with a further body behind a joint.
    #[must_use]
    pub fn then(mut self, joint: Joint, inertia: f64, coulomb: f64, viscous: f64) -> Self {
        let next = Self::one(inertia, coulomb, viscous);
        let body = self.inertias.len();
        let at_body = |mut surface: Surface| {
            surface.body = body;
            surface
        };
        self.surfaces.extend(next.surfaces.into_iter().map(at_body));
        self.drags.push(Drag::viscous(body, viscous));
        self.inertias.extend(next.inertias);
        self.joints.push(joint);
        self
    }

    /// The body at the end.
    #[must_use]
    pub fn load(&self) -> usize {
        self.inertias.len() - 1
    }

    /// Inertia of all bodies.
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.inertias.iter().map(Inertia::nominal).sum()
    }

    /// Sliding level of all surfaces.
    #[must_use]
    pub fn coulomb(&self) -> f64 {
        self.surfaces.iter().map(|s| s.law.level()).sum()
    }

    /// The same in the middle of the travel, where a report has its Coulomb friction.
    #[must_use]
    pub fn coulomb_amid(&self) -> f64 {
        (0..self.inertias.len())
            .map(|body| self.coulomb_amid_of(body))
            .sum()
    }

    /// The same of one body.
    #[must_use]
    pub fn coulomb_amid_of(&self, body: usize) -> f64 {
        let level = |surface: &Surface| {
            let factors = surface.scales.iter().map(Scale::amid);
            surface.law.level() * factors.product::<f64>()
        };
        let own = self.surfaces.iter().filter(|own| own.body == body);
        own.map(level).sum()
    }

    /// Viscous friction of all bodies, mean of both directions.
    #[must_use]
    pub fn viscous(&self) -> f64 {
        self.drags
            .iter()
            .map(|d| 0.5 * (d.forward + d.backward))
            .sum()
    }

    /// The same machine on another day: Coulomb friction and viscous friction times factors.
    #[must_use]
    pub fn on_another_day(mut self, coulomb: f64, viscous: f64) -> Self {
        for surface in &mut self.surfaces {
            surface.law = surface.law.clone().scaled(coulomb);
        }
        for drag in &mut self.drags {
            drag.forward *= viscous;
            drag.backward *= viscous;
        }
        self
    }

    /// At rest at a position.
    #[must_use]
    pub fn at_rest(&self, position: f64) -> TrainState {
        let count = self.inertias.len();
        TrainState {
            positions: vec![position; count],
            velocities: vec![0.0; count],
            time_s: 0.0,
            bristles: self
                .surfaces
                .iter()
                .map(|s| vec![0.0; s.law.states()])
                .collect(),
            slipped: vec![0.0; self.joints.len()],
            transmitted: vec![0.0; count],
        }
    }

    /// One step under the effort of the drive.
    pub fn step(&self, state: &mut TrainState, drive: f64, step_s: f64) {
        drift(state, 0.5 * step_s);
        state.time_s += 0.5 * step_s;
        let mut efforts = self.free_efforts(state, drive, step_s);
        let mut levels = vec![0.0; efforts.len()];
        self.add_friction(state, step_s, &mut efforts, &mut levels);
        for body in 0..efforts.len() {
            let inertia = self.inertias[body].at(state.positions[body], state.time_s);
            let free = state.velocities[body] + step_s * efforts[body] / inertia;
            state.velocities[body] = held(free, step_s * levels[body] / inertia);
        }
        drift(state, 0.5 * step_s);
        state.time_s += 0.5 * step_s;
    }

    /// Effort on each body without friction of surfaces.
    fn free_efforts(&self, state: &mut TrainState, drive: f64, step_s: f64) -> Vec<f64> {
        let mut efforts = vec![0.0; self.inertias.len()];
        efforts[0] = drive;
        state.transmitted[0] = drive;
        self.add_joints(state, &mut efforts, step_s);
        for drag in &self.drags {
            let narrowed = drag.narrowed(state.positions[drag.body]);
            let against = drag.against(state.velocities[drag.body], state.time_s);
            efforts[drag.body] -= narrowed * against;
        }
        for (body, field) in &self.fields {
            efforts[*body] += field.at(state.positions[*body], state.time_s);
        }
        for (body, inertia) in self.inertias.iter().enumerate() {
            let velocity = state.velocities[body];
            efforts[body] -= 0.5 * inertia.slope(state.positions[body]) * velocity * velocity;
            efforts[body] -= inertia.rate(state.time_s) * velocity;
        }
        efforts
    }

    fn add_joints(&self, state: &mut TrainState, efforts: &mut [f64], step_s: f64) {
        for (i, joint) in self.joints.iter().enumerate() {
            let deflection = state.positions[i] - state.positions[i + 1];
            let rate = state.velocities[i] - state.velocities[i + 1];
            let at = state.positions[i + 1];
            let carried = joint.carry(deflection, rate, at, state.slipped[i]);
            let rolled = state.velocities[i] * step_s;
            state.slipped[i] = carried.slipped + joint.creeps(carried.effort, rolled);
            state.transmitted[i + 1] = carried.effort;
            efforts[i] -= carried.effort;
            efforts[i + 1] += carried.effort;
        }
    }

    fn add_friction(
        &self,
        state: &mut TrainState,
        step_s: f64,
        efforts: &mut [f64],
        levels: &mut [f64],
    ) {
        for (surface, bristles) in self.surfaces.iter().zip(&mut state.bristles) {
            let body = surface.body;
            let velocity = state.velocities[body];
            let contact = Contact {
                position: state.positions[body],
                velocity,
                direction: if velocity == 0.0 {
                    efforts[body]
                } else {
                    velocity
                }
                .signum(),
                transmitted: state.transmitted[body],
                time_s: state.time_s,
            };
            let reaction = surface.react(bristles, &contact, step_s);
            efforts[body] -= reaction.force;
            levels[body] += reaction.level;
        }
    }
}

fn drift(state: &mut TrainState, time_s: f64) {
    for (position, velocity) in state.positions.iter_mut().zip(&state.velocities) {
        *position += time_s * velocity;
    }
}

/// The velocity after friction that can take so much of it.
fn held(free: f64, most: f64) -> f64 {
    free - free.clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::friction::{Law, Scale};
    use std::f64::consts::TAU;

    fn free(inertia: f64) -> Train {
        Train::one(inertia, 0.0, 0.0)
    }

    /// Two bodies on a shaft, with the shaft wound up.
    fn two_bodies() -> (Train, TrainState) {
        let train = free(3.0).then(Joint::stiff(1.2e5, 0.0), 5.0, 0.0, 0.0);
        let mut state = train.at_rest(0.0);
        state.positions[0] = 1.0e-3;
        (train, state)
    }

    fn energy(state: &TrainState) -> f64 {
        let kinetic = 1.5 * state.velocities[0].powi(2) + 2.5 * state.velocities[1].powi(2);
        kinetic + 0.6e5 * (state.positions[0] - state.positions[1]).powi(2)
    }

    #[test]
    fn energy_stays_for_a_hundred_thousand_steps() {
        let (train, mut state) = two_bodies();
        let start = energy(&state);
        for _ in 0..100_000 {
            train.step(&mut state, 0.0, 1.0e-5);
        }
        assert!((energy(&state) / start - 1.0).abs() < 1.0e-3);
    }

    #[test]
    fn two_bodies_swing_at_the_root_of_stiffness_over_reduced_inertia() {
        let (train, mut state) = two_bodies();
        let (mut crossings, mut last) = (0, 1.0_f64);
        let expected_hz = (1.2e5 * (1.0 / 3.0 + 1.0 / 5.0_f64)).sqrt() / TAU;
        let steps = (100.0 / expected_hz / 1.0e-5).round() as usize;
        for _ in 0..steps {
            train.step(&mut state, 0.0, 1.0e-5);
            let deflection = state.positions[0] - state.positions[1];
            crossings += usize::from(deflection * last < 0.0);
            last = deflection;
        }
        assert!((199..=201).contains(&crossings), "{crossings}");
    }

    #[test]
    fn a_body_sticks_below_the_level_and_slides_above_it() {
        let train = Train::one(2.0, 10.0, 0.0);
        let mut state = train.at_rest(0.1);
        for _ in 0..1000 {
            train.step(&mut state, 9.99, 1.0e-5);
        }
        assert_eq!((state.positions[0], state.velocities[0]), (0.1, 0.0));
        for _ in 0..1000 {
            train.step(&mut state, 14.0, 1.0e-5);
        }
        // (14 − 10)/2 · 10 ms
        assert!((state.velocities[0] - 0.02).abs() < 1.0e-9);
    }

    #[test]
    fn a_body_comes_to_rest_after_its_kinetic_energy_is_gone() {
        let train = Train::one(2.0, 10.0, 0.0);
        let mut state = train.at_rest(0.0);
        state.velocities[0] = 0.5;
        for _ in 0..20_000 {
            train.step(&mut state, 0.0, 1.0e-5);
        }
        assert_eq!(state.velocities[0], 0.0);
        // ½·2·0.5²/10
        assert!((state.positions[0] - 0.025).abs() < 1.0e-6);
    }

    #[test]
    fn an_arm_keeps_its_energy_while_its_inertia_changes() {
        let mut train = free(1.0);
        train.inertias[0] = Inertia::Harmonic {
            mean: 2.0,
            share: 0.5,
            waves: 2.0,
            phase: 0.0,
        };
        let mut state = train.at_rest(0.0);
        state.velocities[0] = 3.0;
        let energy = |state: &TrainState| {
            0.5 * train.inertias[0].at(state.positions[0], 0.0) * state.velocities[0].powi(2)
        };
        let start = energy(&state);
        let mut slowest = 3.0_f64;
        let mut fastest = 3.0_f64;
        for _ in 0..200_000 {
            train.step(&mut state, 0.0, 1.0e-5);
            slowest = slowest.min(state.velocities[0]);
            fastest = fastest.max(state.velocities[0]);
        }
        assert!((energy(&state) / start - 1.0).abs() < 1.0e-3);
        // Inertia from 1 to 3: velocity by its root.
        assert!((fastest / slowest - 3.0_f64.sqrt()).abs() < 1.0e-2);
    }

    #[test]
    fn a_skater_keeps_the_momentum_while_the_arms_come_and_go() {
        let mut train = free(2.0);
        train.inertias[0] = Inertia::Breathing {
            mean: 2.0,
            share: 0.4,
            frequency_hz: 0.5,
        };
        let mut state = train.at_rest(0.0);
        state.velocities[0] = 3.0;
        for _ in 0..50_000 {
            train.step(&mut state, 0.0, 1.0e-5);
        }
        // 2·3 over 2·1.4 after a quarter of a period
        assert!((state.velocities[0] - 6.0 / 2.8).abs() < 1.0e-3);
    }

    #[test]
    fn friction_that_grows_with_load_takes_its_share_of_the_drive() {
        let mut train = Train::one(1.0, 5.0, 0.0);
        train.surfaces[0] = Surface::new(0, Law::coulomb(5.0)).with(Scale::Load(0.01));
        let mut state = train.at_rest(0.0);
        for _ in 0..1000 {
            train.step(&mut state, 100.0, 1.0e-5);
        }
        // 100 − 5·(1 + 0.01·100) = 90 N for 10 ms
        assert!((state.velocities[0] - 0.9).abs() < 1.0e-9);
    }

    #[test]
    fn a_pulled_trolley_falls_behind_its_wheel_by_effort_times_way() {
        let contact = Joint {
            creep: 2.0e-5,
            ..Joint::stiff(1.0e6, 3.0e3)
        };
        let train = free(5.0).then(contact, 20.0, 100.0, 0.0);
        let mut state = train.at_rest(0.0);
        for _ in 0..100_000 {
            // Held at 0.5 m/s against the trolley's 100 N.
            let effort = 100.0 + 2000.0 * (0.5 - state.velocities[0]);
            train.step(&mut state, effort, 1.0e-5);
        }
        let behind = state.positions[0] - state.positions[1];
        // 100 N: 0.1 mm of spring, and 2 mm on every metre; the start adds its acceleration.
        let expected = 1.0e-4 + 2.0e-5 * (100.0 * state.positions[1] + 0.5 * 20.0 * 0.25);
        assert!(
            (behind / expected - 1.0).abs() < 0.03,
            "{behind} {expected}"
        );
    }

    #[test]
    fn a_drum_behind_an_oil_clutch_has_63_percent_of_the_speed_after_its_time_constant() {
        let train = free(1.0e6).then(Joint::stiff(0.0, 2.0), 0.1, 0.0, 0.0);
        let mut state = train.at_rest(0.0);
        state.velocities[0] = 10.0;
        // 0.1 kg m² over 2 N m s/rad
        for _ in 0..5000 {
            train.step(&mut state, 0.0, 1.0e-5);
        }
        assert!((state.velocities[1] - 6.321).abs() < 2.0e-3);
    }

    #[test]
    fn a_flywheel_behind_a_freewheel_is_driven_one_way_and_coasts_the_other() {
        let clutch = Joint {
            one_way: true,
            ..Joint::stiff(0.0, 2.0)
        };
        let train = free(1.0e6).then(clutch, 0.1, 0.0, 0.0);
        let after = |motor: f64, flywheel: f64| {
            let mut state = train.at_rest(0.0);
            state.velocities = vec![motor, flywheel];
            (0..5000).for_each(|_| train.step(&mut state, 0.0, 1.0e-5));
            state.velocities[1]
        };
        // 0.1 kg m² over 2 N m s/rad
        assert!((after(10.0, 0.0) - 6.321).abs() < 2.0e-3);
        assert_eq!(after(-10.0, 3.0), 3.0);
    }

    #[test]
    fn another_day_has_other_levels_and_the_same_inertia() {
        let day = Train::one(2.0, 10.0, 4.0).on_another_day(1.15, 0.9);
        assert_eq!(day.inertia(), 2.0);
        assert!((day.coulomb() - 11.5).abs() < 1e-12 && (day.viscous() - 3.6).abs() < 1e-12);
    }

    #[test]
    fn a_bump_beside_the_middle_of_the_travel_is_in_the_level_there() {
        let mut train = Train::one(2.0, 10.0, 4.0);
        let bump = Scale::Bump {
            centre: -0.3,
            width: 0.3,
            share: 0.5,
        };
        train.surfaces[0].scales = vec![Scale::Slope(2.0), bump, Scale::Load(3.0)];
        assert_eq!(train.coulomb(), 10.0);
        let wanted = 10.0 + 5.0 * libm::exp(-1.0);
        assert!((train.coulomb_amid() - wanted).abs() < 1e-12);
        let two = train.then(Joint::stiff(1e6, 1.0), 3.0, 7.0, 1.0);
        assert!((two.coulomb_amid() - wanted - 7.0).abs() < 1e-12);
        assert_eq!(two.coulomb_amid_of(1), 7.0);
    }
}
