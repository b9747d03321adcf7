//! A simulated axis of an identified model: one mass, or a motor and a load behind a gap.
//!
//! Friction is solved for, not looked up: over a sub-step it takes away what momentum there is, at
//! most its level (Moreau's time stepping), so that standstill is exact. A bristle (Dahl 1968, with
//! the micro-damping of LuGre) replaces that by a force over displacement. In a gap the motor and
//! the load move alone until they meet; impacts follow Newton's law, contact can only push.

/// What makes a reversal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// Deflection of the bristle; zero: rigid friction.
    pub deflection: f64,
    /// Micro-damping of the bristle, effort over velocity.
    pub damping: f64,
    /// Width of the gap; zero: none.
    pub gap: f64,
    /// Share of the mass behind the gap.
    pub load_share: f64,
    /// Share of the friction level that acts on the motor side of the gap.
    pub motor_friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

/// What acts during a sub-step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Acting {
    /// Delivered effort minus what acts on the motor side whatever the direction.
    pub motor: f64,
    /// What acts on the load side whatever the direction, against positive motion.
    pub load: f64,
    /// Friction level.
    pub level: f64,
}

/// One body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Body {
    /// Position.
    pub x: f64,
    /// Velocity.
    pub v: f64,
}

/// Where the axis stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Axis {
    /// Motor.
    pub motor: Body,
    /// Load.
    pub load: Body,
    /// Bristle, −1…1.
    bristle: f64,
    /// Which side of the gap is closed: −1, 0, 1.
    contact: f64,
}

/// Impacts that rebound with less than this share of a gap per sub-step stay in contact.
const SETTLED: f64 = 1.0e-3;

impl Axis {
    /// An axis at a place and velocity, in the middle of its gap.
    #[must_use]
    pub(crate) const fn at(x: f64, v: f64) -> Self {
        let body = Body { x, v };
        Self {
            motor: body,
            load: body,
            bristle: 0.0,
            contact: 0.0,
        }
    }

    /// One sub-step.
    pub(crate) fn advance(&mut self, acting: Acting, mass: f64, shape: &Shape, h: f64) {
        if shape.gap <= 0.0 {
            let body = self.friction_step(
                self.motor,
                acting.motor - acting.load,
                acting.level,
                mass,
                shape,
                h,
            );
            (self.motor, self.load) = (body, body);
        } else if self.contact == 0.0 || !self.advance_together(acting, mass, shape, h) {
            self.advance_apart(acting, mass, shape, h);
        }
    }

    /// Both as one body; false, and nothing moved, where the contact would have to pull.
    fn advance_together(&mut self, acting: Acting, mass: f64, shape: &Shape, h: f64) -> bool {
        let before = *self;
        let body = self.friction_step(
            self.motor,
            acting.motor - acting.load,
            acting.level,
            mass,
            shape,
            h,
        );
        let push = if body.v == 0.0 && before.motor.v == 0.0 {
            let held = shape.motor_friction * acting.level;
            acting.motor - acting.motor.clamp(-held, held)
        } else {
            let friction =
                (1.0 - shape.motor_friction) * acting.level * (body.v + before.motor.v).signum();
            shape.load_share * mass * (body.v - before.motor.v) / h + acting.load + friction
        };
        if push * self.contact < 0.0 {
            *self = Self {
                contact: 0.0,
                ..before
            };
            return false;
        }
        self.motor = body;
        self.load = Body {
            x: body.x - 0.5 * shape.gap * self.contact,
            v: body.v,
        };
        true
    }

    fn advance_apart(&mut self, acting: Acting, mass: f64, shape: &Shape, h: f64) {
        let (m2, held) = (shape.load_share * mass, shape.motor_friction * acting.level);
        let m1 = mass - m2;
        self.motor = rigid_step(self.motor, acting.motor, held, m1, h);
        self.load = self.friction_step(self.load, -acting.load, acting.level - held, m2, shape, h);
        let (lag, half) = (self.motor.x - self.load.x, 0.5 * shape.gap);
        if lag.abs() < half {
            return;
        }
        let side = lag.signum();
        let closing = side * (self.motor.v - self.load.v);
        let excess = lag - side * half;
        self.motor.x -= excess * m2 / mass;
        self.load.x += excess * m1 / mass;
        if closing > 0.0 {
            let common = (m1 * self.motor.v + m2 * self.load.v) / mass;
            let rebound = shape.restitution * closing;
            self.motor.v = common - side * rebound * m2 / mass;
            self.load.v = common + side * rebound * m1 / mass;
            if rebound * h < SETTLED * shape.gap {
                (self.motor.v, self.load.v) = (common, common);
                self.contact = side;
            }
        }
    }

    /// A body under a force and the friction law.
    fn friction_step(
        &mut self,
        body: Body,
        force: f64,
        level: f64,
        mass: f64,
        shape: &Shape,
        h: f64,
    ) -> Body {
        if shape.deflection <= 0.0 {
            return rigid_step(body, force, level, mass, h);
        }
        let free = body.v + h * force / mass;
        let guess = if body.v == 0.0 { free } else { body.v };
        let open = (1.0 - self.bristle * guess.signum()).max(0.0);
        // The mean deflection and the mean velocity of the sub-step, both trapezoidal.
        let implicit = 0.5 * h * open * (0.5 * h * level / shape.deflection + shape.damping);
        let v = (mass * free - h * level * self.bristle - implicit * body.v) / (mass + implicit);
        let step = 0.5 * h * (body.v + v);
        if step != 0.0 {
            let sign = step.signum();
            self.bristle = sign + (self.bristle - sign) * (-step.abs() / shape.deflection).exp();
        }
        Body {
            x: body.x + step,
            v,
        }
    }
}

/// A body under a force and rigid friction.
fn rigid_step(body: Body, force: f64, level: f64, mass: f64, h: f64) -> Body {
    let free = body.v + h * force / mass;
    let most = h * level.max(0.0) / mass;
    let v = free - free.clamp(-most, most);
    // Friction opposes the motion that there is: where the velocity changes sign within the
    // sub-step, it first stops.
    let v = if v * body.v < 0.0 && free.abs() < body.v.abs() {
        0.0
    } else {
        v
    };
    Body {
        x: body.x + 0.5 * h * (body.v + v),
        v,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 2.5e-4;

    #[test]
    fn a_body_stops_where_friction_says_and_stays() {
        // 0.1 m/s, 1 kg, 2 N: v²/2a = 2.5 mm.
        let mut axis = Axis::at(0.0, 0.1);
        for _ in 0..4000 {
            axis.advance(
                Acting {
                    motor: 0.5,
                    load: 0.5,
                    level: 2.0,
                },
                1.0,
                &Shape::default(),
                H,
            );
        }
        assert!(
            (axis.motor.x - 2.5e-3).abs() < 1.0e-5 && axis.motor.v == 0.0,
            "{axis:?}"
        );
    }

    #[test]
    fn a_motor_crosses_its_gap_without_the_load_and_then_pushes_it() {
        let shape = Shape {
            gap: 1.0e-3,
            load_share: 0.5,
            restitution: 0.5,
            ..Shape::default()
        };
        let mut axis = Axis::at(0.0, 0.0);
        let mut moved_alone = false;
        for _ in 0..8000 {
            axis.advance(
                Acting {
                    motor: 3.0,
                    load: 0.0,
                    level: 2.0,
                },
                2.0,
                &shape,
                H,
            );
            moved_alone |= axis.motor.x > 1.0e-4 && axis.load.x == 0.0;
        }
        assert!(moved_alone);
        assert!(
            (axis.motor.x - axis.load.x - 0.5e-3).abs() < 1.0e-9,
            "{axis:?}"
        );
        // One body in the end: (3 − 2) N on 2 kg over 2 s, less the little that the impacts cost.
        assert!((axis.motor.v - 1.0).abs() < 0.02, "{axis:?}");
    }

    #[test]
    fn a_bristle_gives_way_and_springs_back() {
        let shape = Shape {
            deflection: 10.0e-6,
            damping: 500.0,
            ..Shape::default()
        };
        let mut axis = Axis::at(0.0, 0.0);
        let mut ramp = |from: f64, to: f64| {
            for step in 0..=8000 {
                let motor = from + (to - from) * f64::from(step) / 8000.0;
                axis.advance(
                    Acting {
                        motor,
                        load: 0.0,
                        level: 100.0,
                    },
                    10.0,
                    &shape,
                    H,
                );
            }
            axis.motor.x
        };
        // Dahl: F = G (1 − exp(−x/δ)), half the level at δ ln 2.
        let there = ramp(0.0, 50.0);
        assert!((there - 10.0e-6 * 2.0_f64.ln()).abs() < 0.1e-6, "{there}");
        // Back along dF/dx = (G + F)/δ: x falls by δ ln 1.5.
        let back = ramp(50.0, 0.0);
        assert!(
            (there - back - 10.0e-6 * 1.5_f64.ln()).abs() < 0.1e-6,
            "{back}"
        );
    }
}
