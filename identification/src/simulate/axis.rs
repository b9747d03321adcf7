//! A simulated axis of an identified model: one mass, or a motor and a load behind a gap.
//!
//! ```text
//!            one mass                              a gap
//!   effort ─▶ [ m ] ◀─ friction      effort ─▶ [ m₁ ]│  │[ m₂ ] ◀─ friction of the load
//!                                    friction ──▲     gap
//! ```
//!
//! In the gap motor and load move alone until they meet. The impact keeps the momentum and follows
//! Newton's law ([`gap`](crate::simulate::gap)). What rebounds by less than a thousandth of the gap
//! in a sub-step stays in contact. In contact both are one body, as long as the motor has to push:
//! contact cannot pull. Friction of each body: [`friction`](crate::simulate::friction).
//!
//! Units: those of the record (m or rad, N or N·m, s).

use crate::simulate::friction::{Bend, Body, Bristle, Push};
use crate::simulate::gap::{Side, rebound};

/// Rebounds that cover less than this share of a gap in a sub-step stay in contact: the rest of
/// the bounces would take less than the gap's thousandth part.
const SETTLED: f64 = 1.0e-3;

/// What a search tries may put down more mass than there is; so much of it stays.
const LEAST_SHARE: f64 = 1.0e-2;

/// A gap between motor and load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gap {
    /// Its width.
    pub width: f64,
    /// Share of the mass behind it.
    pub load_share: f64,
    /// Share of the friction level that acts on its motor side.
    pub motor_friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

/// What makes a reversal; rigid friction on one mass where there is neither.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// A bristle.
    pub bristle: Option<Bristle>,
    /// A gap.
    pub gap: Option<Gap>,
}

/// What is built: mass and shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Mechanics {
    /// Moved mass, motor and load.
    pub mass: f64,
    /// What makes a reversal.
    pub shape: Shape,
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
    /// Mass that moves with the load beside its own.
    pub mass: f64,
}

/// Where the axis stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    /// Motor.
    pub motor: Body,
    /// Load.
    pub load: Body,
    bend: Bend,
    /// Where motor and load are in contact.
    contact: Option<Side>,
}

/// One sub-step of an axis with a gap.
#[derive(Clone, Copy)]
struct Stretch<'a> {
    mechanics: &'a Mechanics,
    gap: Gap,
    acting: Acting,
    step_s: f64,
}

impl Mechanics {
    /// A body on which the friction law of the axis acts.
    #[inline]
    fn carry(&self, bend: Bend, body: Body, push: &Push) -> (Body, Bend) {
        match self.shape.bristle {
            Some(bristle) => bristle.carry(bend, body, push),
            None => (body.rigid(push), bend),
        }
    }

    /// What acts on motor and load as one body.
    #[inline]
    fn on_both(&self, acting: Acting, step_s: f64) -> Push {
        Push {
            force: acting.motor - acting.load,
            level: acting.level,
            mass: (self.mass + acting.mass).max(LEAST_SHARE * self.mass),
            step_s,
        }
    }
}

impl Axis {
    /// An axis at a place and velocity, in the middle of its gap.
    #[must_use]
    pub(crate) const fn at(x: f64, v: f64) -> Self {
        let body = Body { x, v };
        Self {
            motor: body,
            load: body,
            bend: 0.0,
            contact: None,
        }
    }

    /// The axis after a sub-step.
    #[inline]
    #[must_use]
    pub(crate) fn after(&self, mechanics: &Mechanics, acting: Acting, step_s: f64) -> Self {
        let Some(gap) = mechanics.shape.gap else {
            return self.as_one(mechanics, acting, step_s);
        };
        let stretch = Stretch {
            mechanics,
            gap,
            acting,
            step_s,
        };
        let together = self.contact.and_then(|side| self.together(side, &stretch));
        together.unwrap_or_else(|| self.apart(&stretch))
    }

    /// One mass.
    #[inline]
    fn as_one(&self, mechanics: &Mechanics, acting: Acting, step_s: f64) -> Self {
        let push = mechanics.on_both(acting, step_s);
        let (body, bend) = mechanics.carry(self.bend, self.motor, &push);
        Self {
            motor: body,
            load: body,
            bend,
            contact: self.contact,
        }
    }

    /// Both as one body; `None` where the contact would have to pull.
    #[inline]
    fn together(&self, side: Side, stretch: &Stretch<'_>) -> Option<Self> {
        let Stretch {
            mechanics,
            gap,
            acting,
            step_s,
        } = *stretch;
        let push = mechanics.on_both(acting, step_s);
        let (body, bend) = mechanics.carry(self.bend, self.motor, &push);
        let pulls = stretch.transmitted(self.motor, body) * side.sign() < 0.0;
        let load = Body {
            x: body.x - 0.5 * gap.width * side.sign(),
            v: body.v,
        };
        (!pulls).then_some(Self {
            motor: body,
            load,
            bend,
            contact: Some(side),
        })
    }

    /// Each alone, until they meet.
    #[inline]
    fn apart(&self, stretch: &Stretch<'_>) -> Self {
        let motor = self.motor.rigid(&stretch.on_motor());
        let (load, bend) = stretch
            .mechanics
            .carry(self.bend, self.load, &stretch.on_load());
        let free = Self {
            motor,
            load,
            bend,
            contact: None,
        };
        free.met(stretch)
    }

    /// The axis where motor and load have run into each other: pushed apart to the gap's width,
    /// about the common centre of mass, and after the impact.
    #[inline]
    fn met(mut self, stretch: &Stretch<'_>) -> Self {
        let (lag, half) = (self.motor.x - self.load.x, 0.5 * stretch.gap.width);
        if lag.abs() < half {
            return self;
        }
        let side = Side::of(lag);
        let (m1, m2) = (stretch.m1(), stretch.m2());
        let mass = m1 + m2;
        let excess = lag - side.sign() * half;
        self.motor.x -= excess * m2 / mass;
        self.load.x += excess * m1 / mass;
        let closing = side.sign() * (self.motor.v - self.load.v);
        if closing > 0.0 {
            self.hit(side, closing, stretch);
        }
        self
    }

    /// The impact: momentum is kept, the bodies part by Newton's law or stay in contact.
    #[inline]
    fn hit(&mut self, side: Side, closing: f64, stretch: &Stretch<'_>) {
        let (m1, m2) = (stretch.m1(), stretch.m2());
        let mass = m1 + m2;
        let common = (m1 * self.motor.v + m2 * self.load.v) / mass;
        let parting = rebound(stretch.gap.restitution, closing);
        self.motor.v = common - side.sign() * parting * m2 / mass;
        self.load.v = common + side.sign() * parting * m1 / mass;
        if parting * stretch.step_s < SETTLED * stretch.gap.width {
            (self.motor.v, self.load.v) = (common, common);
            self.contact = Some(side);
        }
    }
}

impl Stretch<'_> {
    #[inline]
    fn m1(&self) -> f64 {
        (1.0 - self.gap.load_share) * self.mechanics.mass
    }

    #[inline]
    fn m2(&self) -> f64 {
        let own = self.gap.load_share * self.mechanics.mass;
        (own + self.acting.mass).max(LEAST_SHARE * own)
    }

    /// Friction level on the motor side.
    #[inline]
    fn motor_level(&self) -> f64 {
        self.gap.motor_friction * self.acting.level
    }

    #[inline]
    fn on_motor(&self) -> Push {
        Push {
            force: self.acting.motor,
            level: self.motor_level(),
            mass: self.m1(),
            step_s: self.step_s,
        }
    }

    #[inline]
    fn on_load(&self) -> Push {
        Push {
            force: -self.acting.load,
            level: self.acting.level - self.motor_level(),
            mass: self.m2(),
            step_s: self.step_s,
        }
    }

    /// Force through the contact where both go from one motion to another as one body: what the
    /// load needs; at rest, what the motor's friction leaves of the effort.
    #[inline]
    fn transmitted(&self, before: Body, after: Body) -> f64 {
        let Acting {
            motor, load, level, ..
        } = self.acting;
        if after.v == 0.0 && before.v == 0.0 {
            let held = self.motor_level().max(0.0);
            return motor - motor.clamp(-held, held);
        }
        let friction = (1.0 - self.gap.motor_friction) * level * (after.v + before.v).signum();
        self.m2() * (after.v - before.v) / self.step_s + load + friction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 2.5e-4;

    fn near(value: f64, wanted: f64, within: f64) {
        assert!((value - wanted).abs() <= within, "{value}, not {wanted}");
    }

    /// 4 kg, a quarter of it behind a gap of 2 mm, without friction on the motor's side.
    fn with_gap(restitution: f64) -> Mechanics {
        let gap = Gap {
            width: 2.0e-3,
            load_share: 0.25,
            motor_friction: 0.0,
            restitution,
        };
        Mechanics {
            mass: 4.0,
            shape: Shape {
                bristle: None,
                gap: Some(gap),
            },
        }
    }

    fn with_motor_friction(share: f64) -> Mechanics {
        let mut mechanics = with_gap(0.0);
        let gap = mechanics.shape.gap.as_mut().unwrap();
        gap.motor_friction = share;
        mechanics
    }

    /// An axis whose motor and load stand and move apart.
    fn between(motor: (f64, f64), load: (f64, f64)) -> Axis {
        let body = |(x, v)| Body { x, v };
        Axis {
            motor: body(motor),
            load: body(load),
            ..Axis::at(0.0, 0.0)
        }
    }

    fn in_contact(side: Side, v: f64) -> Axis {
        Axis {
            contact: Some(side),
            ..between((0.0, v), (-1.0e-3 * side.sign(), v))
        }
    }

    fn acting(motor: f64, load: f64, level: f64) -> Acting {
        Acting {
            motor,
            load,
            level,
            mass: 0.0,
        }
    }

    #[test]
    fn a_mass_that_moves_along_slows_the_axis_and_is_on_the_load_of_a_gap() {
        let loaded = Acting {
            mass: 2.0,
            ..acting(12.0, 0.0, 0.0)
        };
        let one = Mechanics {
            mass: 4.0,
            ..Mechanics::default()
        };
        let after = Axis::at(0.0, 0.0).after(&one, loaded, 1.0e-3);
        assert!(
            (after.motor.v - 2.0e-3).abs() < 1.0e-12,
            "{}",
            after.motor.v
        );
        let gap = Gap {
            width: 1.0e-3,
            load_share: 0.5,
            ..Gap::default()
        };
        let stretch = |mass: f64| Stretch {
            mechanics: &one,
            gap,
            acting: Acting { mass, ..loaded },
            step_s: 1.0e-3,
        };
        assert_eq!((stretch(2.0).m1(), stretch(2.0).m2()), (2.0, 4.0));
        // More is put down than there is.
        assert_eq!(stretch(-3.0).m2(), 0.02);
    }

    #[test]
    fn one_mass_feels_effort_less_load_and_level() {
        let mechanics = Mechanics {
            mass: 2.0,
            ..Mechanics::default()
        };
        // (5 − 1 − 2) N on 2 kg over 0.1 s.
        let axis = Axis::at(0.0, 0.0).after(&mechanics, acting(5.0, 1.0, 2.0), 0.1);
        near(axis.motor.v, 0.1, 1.0e-15);
        near(axis.motor.x, 0.005, 1.0e-15);
        assert_eq!(axis.motor, axis.load);
    }

    #[test]
    fn one_mass_on_a_bristle_keeps_its_bend() {
        let bristle = Bristle {
            deflection: 1.0e-3,
            damping: 10.0,
        };
        let mechanics = Mechanics {
            mass: 2.0,
            shape: Shape {
                bristle: Some(bristle),
                gap: None,
            },
        };
        let first = Axis::at(0.0, 0.0).after(&mechanics, acting(5.0, 1.0, 2.0), 0.01);
        let second = first.after(&mechanics, acting(5.0, 1.0, 2.0), 0.01);
        let push = mechanics.on_both(acting(5.0, 1.0, 2.0), 0.01);
        let by_hand = bristle.carry(0.0, Body::default(), &push);
        assert_eq!((first.motor, first.bend), by_hand);
        assert!(first.bend > 0.0);
        assert_eq!(second.motor, bristle.carry(by_hand.1, by_hand.0, &push).0);
    }

    #[test]
    fn in_the_gap_effort_moves_the_motor_alone_and_load_forces_the_load_alone() {
        let axis =
            Axis::at(0.0, 0.0).after(&with_motor_friction(0.25), acting(5.0, 3.0, 4.0), 0.01);
        // Motor: (5 − 0.25·4) N on 3 kg; load: −(3 − 0.75·4) N on 1 kg, held by its friction.
        near(axis.motor.v, 0.04 / 3.0, 1.0e-15);
        assert_eq!(axis.load, Body::default());
        let axis =
            Axis::at(0.0, 0.0).after(&with_motor_friction(0.25), acting(0.0, 5.0, 4.0), 0.01);
        near(axis.load.v, -0.02, 1.0e-15);
        assert_eq!(axis.motor, Body::default());
    }

    #[test]
    fn an_impact_keeps_the_momentum_and_parts_by_the_restitution() {
        // 3 kg at 0.2 m/s against 1 kg at −0.2 m/s: common 0.1 m/s, closing 0.4 m/s.
        for sign in [1.0, -1.0] {
            let axis = between((sign * 1.0e-3, sign * 0.2), (0.0, -sign * 0.2));
            let after = axis.after(&with_gap(0.5), Acting::default(), H);
            near(after.motor.v, sign * (0.1 - 0.2 * 0.25), 1.0e-15);
            near(after.load.v, sign * (0.1 + 0.2 * 0.75), 1.0e-15);
            near(3.0 * after.motor.v + after.load.v, sign * 0.4, 1.0e-15);
            assert_eq!(after.contact, None);
        }
    }

    #[test]
    fn an_impact_loses_the_energy_that_newtons_law_says() {
        let energy = |axis: &Axis| 1.5 * axis.motor.v.powi(2) + 0.5 * axis.load.v.powi(2);
        for restitution in [0.3, 0.6, 1.0] {
            let before = between((1.0e-3, 0.3), (0.0, 0.1));
            let after = before.after(&with_gap(restitution), Acting::default(), H);
            // ½ μ (1 − e²) w² with μ = 0.75 kg, w = 0.2 m/s.
            let lost = 0.5 * 0.75 * (1.0 - restitution * restitution) * 0.04;
            near(energy(&before) - energy(&after), lost, 1.0e-15);
        }
    }

    #[test]
    fn what_ran_into_each_other_is_pushed_apart_about_the_centre_of_mass() {
        for sign in [1.0, -1.0] {
            // 0.1 mm too far.
            let axis = between((sign * 1.1e-3, 0.0), (0.0, 0.0));
            let after = axis.after(&with_gap(0.5), Acting::default(), H);
            near(after.motor.x - after.load.x, sign * 1.0e-3, 1.0e-18);
            near(3.0 * after.motor.x + after.load.x, sign * 3.3e-3, 1.0e-17);
        }
    }

    #[test]
    fn within_the_gap_or_while_they_part_there_is_no_impact() {
        let mechanics = with_gap(0.5);
        let inside = between((0.9e-3, 0.0), (0.0, -0.1));
        assert_eq!(inside.after(&mechanics, Acting::default(), H).load.v, -0.1);
        let parting = between((1.2e-3, 0.1), (0.0, 0.3));
        let after = parting.after(&mechanics, Acting::default(), H);
        assert_eq!((after.motor.v, after.load.v), (0.1, 0.3));
        // As fast as each other is not closing.
        let level = between((1.1e-3, 0.1), (0.0, 0.1));
        assert_eq!(level.after(&mechanics, Acting::default(), H).contact, None);
    }

    #[test]
    fn a_rebound_of_less_than_a_thousandth_of_the_gap_stays_in_contact() {
        // Half of the closing velocity over 0.25 ms against 2 µm: 16 mm/s.
        for (closing, contact) in [(0.0159, Some(Side::Ahead)), (0.0161, None)] {
            let axis = between((1.0e-3, closing), (0.0, 0.0));
            let after = axis.after(&with_gap(0.5), Acting::default(), H);
            assert_eq!(after.contact, contact, "{closing} m/s");
        }
        let axis = between((-1.0e-3, -0.01), (0.0, 0.0));
        let after = axis.after(&with_gap(0.5), Acting::default(), H);
        assert_eq!(after.contact, Some(Side::Behind));
        near(after.motor.v, -0.0075, 1.0e-15);
        assert_eq!(after.motor.v, after.load.v);
    }

    #[test]
    fn in_contact_both_are_one_body_half_a_gap_apart() {
        for side in [Side::Ahead, Side::Behind] {
            let axis = in_contact(side, 0.0);
            let push = acting(8.0 * side.sign(), 0.0, 4.0);
            let after = axis.after(&with_gap(0.5), push, 0.1);
            // (8 − 4) N on 4 kg over 0.1 s.
            near(after.motor.v, 0.1 * side.sign(), 1.0e-15);
            assert_eq!(after.motor.v, after.load.v);
            near(after.motor.x - after.load.x, 1.0e-3 * side.sign(), 1.0e-18);
            assert_eq!(after.contact, Some(side));
        }
    }

    #[test]
    fn contact_lets_go_where_it_would_have_to_pull() {
        // The load needs 1 kg · a + its friction + the load force; it must not be negative.
        let cases = [
            ("coasting with the motor", 0.0, 0.0, 0.0, true),
            (
                "the brake is weaker than the load's friction",
                -11.9,
                0.0,
                4.0,
                true,
            ),
            (
                "the brake is stronger than the load's friction",
                -12.1,
                0.0,
                4.0,
                false,
            ),
            ("the load is held back by a force", -2.9, 1.0, 0.0, true),
            (
                "the load is held back by too small a force",
                -3.1,
                1.0,
                0.0,
                false,
            ),
            (
                "the load is carried, the motor is faster",
                3.1,
                -1.0,
                0.0,
                true,
            ),
            (
                "the load is carried, the motor is slower",
                2.9,
                -1.0,
                0.0,
                false,
            ),
        ];
        for side in [Side::Ahead, Side::Behind] {
            for (sentence, motor, load, level, stays) in cases {
                let (sign, axis) = (side.sign(), in_contact(side, 0.5 * side.sign()));
                let push = acting(sign * motor, sign * load, level);
                let after = axis.after(&with_gap(0.0), push, H);
                assert_eq!(after.contact.is_some(), stays, "{sentence}");
            }
        }
    }

    #[test]
    fn the_motors_share_of_the_friction_is_not_transmitted() {
        // 4 kg at −(12 + 4)/4 m/s²: −4 N for the load, +4 N of friction, less the motor's share.
        for (share, stays) in [(0.0, true), (0.01, false)] {
            let axis = in_contact(Side::Ahead, 0.5);
            let after = axis.after(&with_motor_friction(share), acting(-11.999, 0.0, 4.0), H);
            assert_eq!(after.contact.is_some(), stays, "{share}");
        }
    }

    #[test]
    fn at_rest_the_contact_holds_what_the_motors_friction_leaves_of_the_effort() {
        let mechanics = with_motor_friction(0.5);
        for (motor, stays) in [(3.9, true), (0.0, true), (-1.9, true), (-2.1, false)] {
            let after = in_contact(Side::Ahead, 0.0).after(&mechanics, acting(motor, 0.0, 4.0), H);
            assert_eq!(after.contact.is_some(), stays, "{motor} N");
        }
        let after = in_contact(Side::Behind, 0.0).after(&mechanics, acting(2.1, 0.0, 4.0), H);
        assert_eq!(after.contact, None);
    }

    #[test]
    fn where_the_contact_lets_go_each_moves_by_its_own_forces() {
        let axis = in_contact(Side::Ahead, 0.5);
        let after = axis.after(&with_gap(0.0), acting(-30.0, 0.0, 4.0), 1.0e-3);
        near(after.motor.v, 0.5 - 0.01, 1.0e-15);
        near(after.load.v, 0.5 - 0.004, 1.0e-15);
    }

    #[test]
    fn a_motor_crosses_its_gap_without_the_load_and_then_pushes_it() {
        let gap = Gap {
            width: 1.0e-3,
            load_share: 0.5,
            motor_friction: 0.0,
            restitution: 0.5,
        };
        let mechanics = Mechanics {
            mass: 2.0,
            shape: Shape {
                bristle: None,
                gap: Some(gap),
            },
        };
        let mut axis = Axis::at(0.0, 0.0);
        let mut moved_alone = false;
        for _ in 0..8000 {
            axis = axis.after(&mechanics, acting(3.0, 0.0, 2.0), H);
            moved_alone |= axis.motor.x > 1.0e-4 && axis.load.x == 0.0;
        }
        assert!(moved_alone);
        near(axis.motor.x - axis.load.x, 0.5e-3, 1.0e-9);
        // One body in the end: (3 − 2) N on 2 kg over 2 s, less the little that the impacts cost.
        near(axis.motor.v, 1.0, 0.02);
    }
}
