//! Friction on one body over one sub-step: rigid, or a bristle that gives way.
//!
//! Both laws take a [`Body`] and a [`Push`] and give the body after the sub-step. The position
//! follows the trapezoid `x⁺ = x + h (v + v⁺)/2`; h is the sub-step, m the mass, F the force, G the
//! friction level.
//!
//! - *Rigid* (Moreau's time stepping, 1988): friction is solved for, not looked up. It takes away
//!   what momentum there is, at most its level: `v⁺ = u − clamp(u, ±hG/m)` with `u = v + hF/m`, so
//!   that standstill is exact.
//! - *Bristle* (Dahl 1968, micro-damping after LuGre 1995): friction is a force over displacement,
//!   `G z + d (1 − z sign v) v`, whose state z goes from −1 to 1 by `dz/dx = (sign dx − z)/δ`. It
//!   is implicit in the mean velocity of the sub-step: stable however stiff `G/δ` is.
//!
//! Units: those of the record (m or rad, N or N·m, s).

/// A body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Body {
    /// Position.
    pub x: f64,
    /// Velocity.
    pub v: f64,
}

/// What acts on a body during a sub-step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Push {
    /// Force, without friction.
    pub force: f64,
    /// Friction level.
    pub level: f64,
    /// Mass of the body.
    pub mass: f64,
    /// Length of the sub-step, s.
    pub step_s: f64,
}

/// A bristle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bristle {
    /// Deflection δ over which its force builds up.
    pub deflection: f64,
    /// Micro-damping d, effort over velocity.
    pub damping: f64,
}

/// How far a bristle is bent: force over friction level, −1…1.
pub(crate) type Bend = f64;

/// Dahl's state after a step of the position: `dz/dx = (sign dx − z)/δ`, solved exactly.
#[inline]
#[must_use]
pub(crate) fn bend_after(bend: Bend, step: f64, deflection: f64) -> Bend {
    if step == 0.0 {
        return bend;
    }
    let sign = step.signum();
    sign + (bend - sign) * (-step.abs() / deflection).exp()
}

impl Push {
    /// Change of velocity by a unit of force.
    #[inline]
    fn per_force(&self) -> f64 {
        self.step_s / self.mass
    }

    /// Velocity after the sub-step, were there no friction.
    #[inline]
    fn free(&self, body: Body) -> f64 {
        body.v + self.per_force() * self.force
    }
}

impl Body {
    /// The body where its velocity goes to `v` along a sub-step.
    #[inline]
    fn moved(self, v: f64, step_s: f64) -> Self {
        Self {
            x: self.x + 0.5 * step_s * (self.v + v),
            v,
        }
    }

    /// The body after a push under rigid friction.
    #[inline]
    #[must_use]
    pub(crate) fn rigid(self, push: &Push) -> Self {
        let free = push.free(self);
        let most = push.per_force() * push.level.max(0.0);
        let v = free - free.clamp(-most, most);
        // Friction opposes the motion that there is: where the velocity changes sign within the
        // sub-step, it first stops.
        let stops = v * self.v < 0.0 && free.abs() < self.v.abs();
        self.moved(if stops { 0.0 } else { v }, push.step_s)
    }
}

impl Bristle {
    /// The body after a push, and how far the bristle is bent then.
    #[inline]
    #[must_use]
    pub(crate) fn carry(&self, bend: Bend, body: Body, push: &Push) -> (Body, Bend) {
        let Push {
            level,
            mass,
            step_s: h,
            ..
        } = *push;
        let free = push.free(body);
        let guess = if body.v == 0.0 { free } else { body.v };
        let open = (1.0 - bend * guess.signum()).max(0.0);
        // The mean bend and the mean velocity of the sub-step, both trapezoidal.
        let implicit = 0.5 * h * open * (0.5 * h * level / self.deflection + self.damping);
        let v = (mass * free - h * level * bend - implicit * body.v) / (mass + implicit);
        let step = 0.5 * h * (body.v + v);
        let after = Body {
            x: body.x + step,
            v,
        };
        (after, bend_after(bend, step, self.deflection))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 2.5e-4;

    fn near(value: f64, wanted: f64, within: f64) {
        assert!((value - wanted).abs() <= within, "{value}, not {wanted}");
    }

    /// A body of 2 kg under a force and a level of 6 N.
    fn push(force: f64) -> Push {
        Push {
            force,
            level: 6.0,
            mass: 2.0,
            step_s: 0.01,
        }
    }

    #[test]
    fn rigid_friction_takes_its_level_from_the_momentum_and_the_position_is_the_trapezoid() {
        // u = 1 + 0.01·10/2 = 1.05; less 0.01·6/2 = 0.03.
        for sign in [1.0, -1.0] {
            let body = Body { x: 3.0, v: sign };
            let after = body.rigid(&push(sign * 10.0));
            near(after.v, sign * 1.02, 1.0e-15);
            near(after.x, 3.0 + sign * 0.005 * 2.02, 1.0e-15);
        }
    }

    #[test]
    fn at_rest_rigid_friction_holds_up_to_its_level_and_not_beyond() {
        let rest = Body { x: 3.0, v: 0.0 };
        for sign in [1.0, -1.0] {
            assert_eq!(rest.rigid(&push(sign * 6.0)), rest, "at the level");
            near(rest.rigid(&push(sign * 6.2)).v, sign * 1.0e-3, 1.0e-15);
        }
    }

    #[test]
    fn a_body_that_friction_stops_stands_still_exactly() {
        let after = Body { x: 0.0, v: 0.02 }.rigid(&push(0.0));
        assert_eq!(after, Body { x: 1.0e-4, v: 0.0 });
    }

    #[test]
    fn where_the_velocity_changes_sign_the_body_first_stops() {
        // u = 0.06 − 0.1 = −0.04, friction leaves −0.01: it stops, because |u| < 0.06.
        assert_eq!(Body { x: 0.0, v: 0.06 }.rigid(&push(-20.0)).v, 0.0);
        assert_eq!(Body { x: 0.0, v: -0.06 }.rigid(&push(20.0)).v, 0.0);
        // u = 0.04 − 0.1 = −0.06: the force is too strong for a stop.
        near(
            Body { x: 0.0, v: 0.04 }.rigid(&push(-20.0)).v,
            -0.03,
            1.0e-15,
        );
        // u = 0.05 − 0.1 = −0.05: as fast as before is not slower.
        near(
            Body { x: 0.0, v: 0.0625 }.rigid(&push(-25.0)).v,
            -0.0325,
            1.0e-15,
        );
    }

    #[test]
    fn a_negative_level_is_no_friction_and_no_drive() {
        let push = Push {
            level: -6.0,
            ..push(10.0)
        };
        near(Body { x: 0.0, v: 1.0 }.rigid(&push).v, 1.05, 1.0e-15);
    }

    #[test]
    fn a_body_stops_after_v2_over_2a() {
        // 0.1 m/s, 1 kg, 2 N: v²/2a = 2.5 mm.
        let push = Push {
            force: 0.0,
            level: 2.0,
            mass: 1.0,
            step_s: H,
        };
        let body = (0..4000).fold(Body { x: 0.0, v: 0.1 }, |body, _| body.rigid(&push));
        near(body.x, 2.5e-3, 1.0e-9);
        assert_eq!(body.v, 0.0);
    }

    #[test]
    fn the_bend_follows_dahls_curve_and_forgets_over_its_deflection() {
        let e = (-1.0_f64).exp();
        near(bend_after(0.0, 5.0, 5.0), 1.0 - e, 1.0e-15);
        near(bend_after(0.0, -5.0, 5.0), e - 1.0, 1.0e-15);
        near(bend_after(1.0, -5.0, 5.0), 2.0 * e - 1.0, 1.0e-15);
        near(bend_after(-0.5, 10.0, 5.0), 1.0 - 1.5 * e * e, 1.0e-15);
        // The exact solution does not care how a step is cut.
        let cut = bend_after(bend_after(0.3, 1.0, 5.0), 2.0, 5.0);
        near(cut, bend_after(0.3, 3.0, 5.0), 1.0e-15);
        // A bristle does not relax while nothing moves.
        assert_eq!(bend_after(0.7, 0.0, 5.0), 0.7);
    }

    #[test]
    fn one_implicit_step_of_the_bristle_agrees_with_the_hand() {
        let bristle = Bristle {
            deflection: 1.0e-3,
            damping: 50.0,
        };
        for sign in [1.0, -1.0] {
            let body = Body {
                x: 0.0,
                v: sign * 0.1,
            };
            let (after, bend) = bristle.carry(sign * 0.25, body, &push(sign * 4.0));
            // open = 0.75; 0.5·0.01·0.75·(0.5·0.01·6/0.001 + 50) = 0.3 kg;
            // v⁺ = (2·0.12 − 0.01·6·0.25 − 0.3·0.1)/2.3.
            let wanted = 0.195 / 2.3;
            near(after.v, sign * wanted, 1.0e-15);
            near(after.x, sign * 0.005 * (0.1 + wanted), 1.0e-15);
            let curve = 1.0 - 0.75 * (-after.x.abs() / 1.0e-3).exp();
            near(bend, sign * curve, 1.0e-15);
        }
    }

    #[test]
    fn at_rest_the_force_says_which_way_the_bristle_opens() {
        let bristle = Bristle {
            deflection: 1.0e-3,
            damping: 50.0,
        };
        let rest = Body::default();
        // Towards the bend it is open by 0.5, away from it by 1.5.
        for (force, open) in [(4.0, 0.5), (-4.0, 1.5)] {
            let (after, _) = bristle.carry(0.5, rest, &push(force));
            let implicit = 0.005 * open * 80.0;
            near(after.v, (0.01 * force - 0.03) / (2.0 + implicit), 1.0e-15);
        }
    }

    #[test]
    fn a_bristle_gives_way_and_springs_back() {
        let bristle = Bristle {
            deflection: 10.0e-6,
            damping: 500.0,
        };
        let mut at = (Body::default(), 0.0);
        let mut ramp = |from: f64, to: f64| {
            for step in 0..=8000 {
                let push = Push {
                    force: from + (to - from) * f64::from(step) / 8000.0,
                    level: 100.0,
                    mass: 10.0,
                    step_s: H,
                };
                at = bristle.carry(at.1, at.0, &push);
            }
            at.0.x
        };
        // F = G (1 − exp(−x/δ)): half the level at δ ln 2.
        let there = ramp(0.0, 50.0);
        near(there, 10.0e-6 * 2.0_f64.ln(), 0.1e-6);
        // Back along dF/dx = (G + F)/δ: x falls by δ ln 1.5.
        near(there - ramp(50.0, 0.0), 10.0e-6 * 1.5_f64.ln(), 0.1e-6);
    }
}
