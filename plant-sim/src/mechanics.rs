//! Two masses on a ball screw, everything expressed at the table in SI units.
//!
//! ```text
//! M1 ẍ1 = F − Fs − F_rubs − F_brake − F_ripple(x1)    motor, coupling, screw; brake on the shaft
//! M2 ẍ2 = Fs − F_friction − F_offset + F_gravity + F_stop   table and what is added to it
//! Fs    = K·dead zone(x1 − x2, gap) + C (ẋ1 − ẋ2)      the screw: it only pushes where there is
//!                                                     a gap, and damps in contact only
//! ```
//!
//! Integration: leapfrog (kick at the middle of the drift) with the damping of the screw and the
//! friction taken implicitly. The screw is integrated at second order, the bristles' coefficients
//! lag by half a sub-step and make the whole first order: 6·10⁻⁵ of the way at the sub-step that is
//! used (`tests/mechanics.rs`, against a high-accuracy integration). A brake comes first, then the
//! friction of the motor's side with the table as fast as it was, then the table.

use crate::friction::{Body, Friction, Sides};

/// A table keeps at least this share of its mass: without one it has no equation of motion.
const SMALLEST_SHARE: f64 = 1.0e-3;

/// Inertia and screw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanics {
    /// Motor, coupling and screw, seen at the table, kg.
    pub motor_inertia_kg: f64,
    /// Table, kg.
    pub table_mass_kg: f64,
    /// Screw stiffness K, N/m.
    pub screw_stiffness_n_per_m: f64,
    /// Screw damping C, N·s/m.
    pub screw_damping_n_s_per_m: f64,
    /// Backlash: width of the gap between screw and table, m.
    pub backlash_m: f64,
}

/// Positions and velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Motor position at the table, m.
    pub motor_m: f64,
    /// Motor velocity, m/s.
    pub motor_m_per_s: f64,
    /// Table position, m.
    pub table_m: f64,
    /// Table velocity, m/s.
    pub table_m_per_s: f64,
}

/// Forces of one sub-step that do not come from the screw or from friction at the table.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drive {
    /// Net force on the motor side, N.
    pub motor_n: f64,
    /// External force on the table, N.
    pub table_n: f64,
    /// Factor on the friction level at the table.
    pub friction_factor: f64,
    /// Friction level at the table beside the one of the law, N.
    pub friction_level_n: f64,
    /// Mass that moves with the table beside its own, kg; below zero where one was put down.
    pub added_mass_kg: f64,
    /// Force up to which a brake holds the motor, N; zero without one.
    pub brake_n: f64,
}

impl Mechanics {
    /// Deflection of the screw beyond the gap, m.
    #[must_use]
    pub fn deflection_m(&self, motion: &Motion) -> f64 {
        let wind_up = motion.motor_m - motion.table_m;
        let half_gap = 0.5 * self.backlash_m;
        wind_up - wind_up.clamp(-half_gap, half_gap)
    }

    /// Force that the screw transmits to the table, N; a gap that is open transmits none.
    #[must_use]
    pub fn transmitted_n(&self, motion: &Motion) -> f64 {
        let deflection_m = self.deflection_m(motion);
        let spring_n = self.screw_stiffness_n_per_m * deflection_m;
        if self.backlash_m == 0.0 || deflection_m != 0.0 {
            spring_n + self.screw_damping_n_s_per_m * (motion.motor_m_per_s - motion.table_m_per_s)
        } else {
            0.0
        }
    }

    /// Mass of the table with what is added to it, or without what was put down, kg.
    fn moved_kg(&self, added_kg: f64) -> f64 {
        (self.table_mass_kg + added_kg).max(SMALLEST_SHARE * self.table_mass_kg)
    }

    /// One sub-step.
    #[expect(
        clippy::inline_always,
        reason = "a call a sub-step passes a dozen numbers through memory: with the two below, 35 of 540 instructions"
    )]
    #[inline(always)]
    pub fn advance(&self, motion: &mut Motion, friction: &mut Sides, drive: Drive, dt_s: f64) {
        motion.motor_m += 0.5 * dt_s * motion.motor_m_per_s;
        motion.table_m += 0.5 * dt_s * motion.table_m_per_s;
        self.kick(motion, friction, drive, dt_s);
        motion.motor_m += 0.5 * dt_s * motion.motor_m_per_s;
        motion.table_m += 0.5 * dt_s * motion.table_m_per_s;
    }

    #[expect(
        clippy::inline_always,
        reason = "a call a sub-step passes a dozen numbers through memory: as above"
    )]
    #[inline(always)]
    fn kick(&self, motion: &mut Motion, friction: &mut Sides, drive: Drive, dt_s: f64) {
        let deflection = self.deflection_m(motion);
        let in_contact = self.backlash_m == 0.0 || deflection != 0.0;
        let damping = if in_contact {
            self.screw_damping_n_s_per_m
        } else {
            0.0
        };
        let before = *motion;
        let can_separate = self.backlash_m > 0.0 && in_contact;
        if can_separate {
            friction.keep();
        }
        self.solve(motion, friction, drive, deflection, damping, dt_s);
        if can_separate {
            let relative = mean(before.motor_m_per_s, motion.motor_m_per_s)
                - mean(before.table_m_per_s, motion.table_m_per_s);
            let force = self.screw_stiffness_n_per_m * deflection + damping * relative;
            if force * deflection < 0.0 {
                *motion = before;
                friction.go_back();
                self.separate(motion, friction, drive, dt_s);
            }
        }
    }

    /// A gap cannot pull: the same without force.
    #[cold]
    fn separate(&self, motion: &mut Motion, friction: &mut Sides, drive: Drive, dt_s: f64) {
        self.solve(motion, friction, drive, 0.0, 0.0, dt_s);
    }

    /// Velocities after the kick: damping trapezoidal, friction as its law says, the brake as
    /// [`Kick::braked`] does.
    #[expect(
        clippy::inline_always,
        reason = "a call a sub-step passes a dozen numbers through memory: as above"
    )]
    #[inline(always)]
    fn solve(
        &self,
        motion: &mut Motion,
        friction: &mut Sides,
        drive: Drive,
        deflection: f64,
        damping: f64,
        dt_s: f64,
    ) {
        let spring = self.screw_stiffness_n_per_m * deflection;
        let half = 0.5 * damping * dt_s;
        let (m1, m2) = (self.motor_inertia_kg, self.moved_kg(drive.added_mass_kg));
        let relative = motion.motor_m_per_s - motion.table_m_per_s;
        // m1 v1' = p1 − half (v1' − v2'),  m2 v2' = p2 + half (v1' − v2') − friction
        let p1 = m1 * motion.motor_m_per_s + dt_s * (drive.motor_n - spring) - half * relative;
        let p2 = m2 * motion.table_m_per_s + dt_s * (spring + drive.table_n) + half * relative;
        let kick = Kick {
            m1,
            m2,
            p1,
            p2,
            half,
            factor: drive.friction_factor,
            level_n: drive.friction_level_n,
            dt_s,
        };
        if drive.brake_n == 0.0 {
            let kick = kick.rubbed(motion, friction);
            kick.free(motion, &mut friction.table);
        } else {
            kick.braked(motion, friction, drive.brake_n);
        }
    }
}

/// One sub-step's equations for the two velocities: masses, momenta with everything explicit in
/// them, implicit damping.
#[derive(Clone, Copy)]
struct Kick {
    m1: f64,
    m2: f64,
    p1: f64,
    p2: f64,
    half: f64,
    factor: f64,
    level_n: f64,
    dt_s: f64,
}

impl Kick {
    /// What the friction of the motor's side leaves.
    fn rubbed(self, motion: &Motion, friction: &mut Sides) -> Self {
        if friction.motor.is_none() {
            return self;
        }
        let mass_kg = self.m1 + self.half;
        let motor = Body {
            velocity: motion.motor_m_per_s,
            free_velocity: (self.p1 + self.half * motion.table_m_per_s) / mass_kg,
            mass_kg,
            dt_s: self.dt_s,
            factor: 1.0,
            level_n: 0.0,
        };
        Self {
            p1: self.p1 - friction.taken_of_motor(motor),
            ..self
        }
    }

    /// Eliminating the motor leaves one equation for the table with an effective mass and a free
    /// velocity.
    fn free(self, motion: &mut Motion, friction: &mut Friction) {
        let Self {
            m1,
            m2,
            p1,
            p2,
            half,
            ..
        } = self;
        let mass = m2 + half * m1 / (m1 + half);
        let free = (p2 + half * p1 / (m1 + half)) / mass;
        motion.table_m_per_s = friction.advance(self.table(motion.table_m_per_s, free, mass));
        motion.motor_m_per_s = (p1 + half * motion.table_m_per_s) / (m1 + half);
    }

    /// Moreau: the brake takes what stops the shaft within the sub-step if that is within its
    /// force; else it slips against that force. The motor's velocity grows with its momentum, so a
    /// slipping shaft keeps its direction. A shaft that is held bends no bristle of the motor.
    fn braked(self, motion: &mut Motion, friction: &mut Sides, brake_n: f64) {
        friction.keep();
        let mass = self.m2 + self.half;
        let held = self.table(motion.table_m_per_s, self.p2 / mass, mass);
        let held = friction.table.advance(held);
        let stopping = self.p1 + self.half * held;
        let most = brake_n * self.dt_s;
        if stopping.abs() <= most {
            motion.table_m_per_s = held;
            motion.motor_m_per_s = 0.0;
            return;
        }
        friction.go_back();
        let slipping = Self {
            p1: self.p1 - most * stopping.signum(),
            ..self
        };
        let slipping = slipping.rubbed(motion, friction);
        slipping.free(motion, &mut friction.table);
    }

    fn table(&self, velocity: f64, free_velocity: f64, mass_kg: f64) -> Body {
        Body {
            velocity,
            free_velocity,
            mass_kg,
            dt_s: self.dt_s,
            factor: self.factor,
            level_n: self.level_n,
        }
    }
}

fn mean(a: f64, b: f64) -> f64 {
    0.5 * (a + b)
}
