//! Features of motion that a residual may go with, by family.
//!
//! A family stands for one kind of thing that a model can lack. Its features are products of a
//! force of motion (acceleration, its rate, velocity, direction, transmitted force) with powers of
//! the position over the travel, u = −1…1, or of the time over the record, s = −1…1. Forces over
//! position, over time and over velocity by direction are piecewise linear.
//!
//! | family | features |
//! |---|---|
//! | inertia over position | a u, a u², a u³, v², v² u, v² u² (Lagrange: `m(x) a + m'(x) v²/2`) |
//! | inertia over time | a s, a s², a s³ |
//! | size of the acceleration | \|a\|, \|a\| u, sign(v) \|a\| |
//! | transmitted force | sign(v) \|F\| · 1, u, u², s |
//! | rate of the acceleration | da/dt · 1, u, u² |
//! | viscous over position or time | v u, v u², v s, v s² |
//! | friction over position | sign(v) · u, u², u³ |
//! | friction over time | sign(v) · s, s², s³ |
//! | velocity by direction, position, time | hats |

use axis_model::EffectName::{
    self, FrictionDrift, LoadDependentFriction, Payload, PositionDependentFriction,
    PositionDependentInertia, Presliding, QuadraticDrag, Stribeck, TorqueSaturation,
    ViscousAsymmetry,
};

use crate::fit::bench::Bench;
use crate::motion::kinematics::Kinematics;

/// Features of one kind.
pub(crate) struct Family {
    /// What a residual that goes with them goes over.
    pub over: &'static str,
    /// Effects whose own equation may leave this, where the axis has another shape of them.
    pub shapes: &'static [EffectName],
    /// Structures without a name that go with the same.
    pub nameless: &'static [&'static str],
    /// Whether it is a shift in time of a kind.
    pub is_shift: bool,
    /// What that looks like, and what to do next.
    pub looks_like: &'static str,
    columns: fn(&Scene<'_>) -> Vec<Vec<f64>>,
}

/// A motion with what features are made of.
pub(crate) struct Scene<'a> {
    motion: &'a Kinematics,
    /// Position over the travel of the training record.
    u: Vec<f64>,
    /// Time over this record.
    s: Vec<f64>,
    /// Low-passed force that the model predicts.
    force: &'a [f64],
}

impl<'a> Scene<'a> {
    /// The scene of a record and the force that a model predicts for it.
    pub(crate) fn of(bench: &Bench<'a>, force: &'a [f64]) -> Self {
        let motion = bench.motion;
        let (middle, half) = bench.dataset.travel();
        let (first, last) = (motion.time_s.first(), motion.time_s.last());
        let (first, last) = (first.copied().unwrap_or(0.0), last.copied().unwrap_or(1.0));
        let centre = 0.5 * (first + last);
        let reach = (0.5 * (last - first)).max(f64::MIN_POSITIVE);
        let positions = motion.position_lp.iter();
        let times = motion.time_s.iter();
        Self {
            motion,
            u: positions.map(|x| (x - middle) / half).collect(),
            s: times.map(|t| (t - centre) / reach).collect(),
            force,
        }
    }

    /// The columns of a family, low-passed.
    pub(crate) fn columns(&self, family: &Family) -> Vec<Vec<f64>> {
        self.motion.all_low_passed(&(family.columns)(self))
    }

    fn each(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..self.motion.len()).map(value).collect()
    }

    /// A force times powers of a scaled quantity.
    fn times(&self, force: impl Fn(usize) -> f64, scaled: &[f64], powers: &[i32]) -> Vec<Vec<f64>> {
        let column = |power: &i32| self.each(|row| force(row) * scaled[row].powi(*power));
        powers.iter().map(column).collect()
    }

    fn acceleration(&self, row: usize) -> f64 {
        self.motion.acceleration[row]
    }

    fn velocity(&self, row: usize) -> f64 {
        self.motion.velocity_lp[row]
    }

    fn direction(&self, row: usize) -> f64 {
        self.motion.direction[row]
    }
}

/// Every family.
pub(crate) static FAMILIES: [Family; 11] = [
    Family {
        over: "acceleration times position",
        shapes: &[PositionDependentInertia],
        nameless: &[],
        is_shift: false,
        looks_like: "inertia that changes with position: declare position_dependent_inertia, or record shorter strokes at several places",
        columns: |scene| {
            let inertia = scene.times(|row| scene.acceleration(row), &scene.u, &[1, 2, 3]);
            let slope = scene.times(|row| scene.velocity(row).powi(2), &scene.u, &[0, 1, 2]);
            [inertia, slope].concat()
        },
    },
    Family {
        over: "acceleration times time",
        shapes: &[Payload],
        nameless: &[],
        is_shift: false,
        looks_like: "inertia that changes during the record: declare payload, or record one load at a time",
        columns: |scene| scene.times(|row| scene.acceleration(row), &scene.s, &[1, 2, 3]),
    },
    Family {
        over: "the size of the acceleration",
        shapes: &[LoadDependentFriction, TorqueSaturation],
        nameless: &[],
        is_shift: false,
        looks_like: "a force that acceleration and braking share: a drive or gear that gives less one way, or an inclined load",
        columns: |scene| {
            let size = |row| scene.acceleration(row).abs();
            let resisting = scene.each(|row| size(row) * scene.direction(row));
            [scene.times(size, &scene.u, &[0, 1]), vec![resisting]].concat()
        },
    },
    Family {
        over: "the transmitted force by direction",
        shapes: &[LoadDependentFriction, Presliding],
        nameless: &[],
        is_shift: false,
        looks_like: "friction that grows with load: declare load_dependent_friction",
        columns: |scene| {
            let friction = |row: usize| scene.direction(row) * scene.force[row].abs();
            let over_time = scene.times(friction, &scene.s, &[1]);
            [scene.times(friction, &scene.u, &[0, 1, 2]), over_time].concat()
        },
    },
    Family {
        over: "the rate of the acceleration",
        shapes: &[Presliding],
        nameless: &[],
        is_shift: true,
        looks_like: "a current loop or a time shift that depends on the motion: check the time stamps, or record the current instead of the command",
        columns: |scene| {
            let rate = rate(
                scene.motion,
                &scene.motion.low_passed(&scene.motion.acceleration),
            );
            scene.times(|row| rate[row], &scene.u, &[0, 1, 2])
        },
    },
    Family {
        over: "velocity times position or time",
        shapes: &[PositionDependentFriction, FrictionDrift],
        nameless: &[],
        is_shift: false,
        looks_like: "viscous friction that changes with position or time: record at one temperature and place",
        columns: |scene| {
            let velocity = |row| scene.velocity(row);
            let over_position = scene.times(velocity, &scene.u, &[1, 2]);
            [over_position, scene.times(velocity, &scene.s, &[1, 2])].concat()
        },
    },
    Family {
        over: "direction times position",
        shapes: &[PositionDependentFriction],
        nameless: &[],
        is_shift: false,
        looks_like: "friction that changes with position otherwise than by a parabola: record the travel in parts",
        columns: |scene| scene.times(|row| scene.direction(row), &scene.u, &[1, 2, 3]),
    },
    Family {
        over: "direction times time",
        shapes: &[FrictionDrift],
        nameless: &[],
        is_shift: false,
        looks_like: "friction that changes during the record: record a warm axis, or declare friction_drift",
        columns: |scene| scene.times(|row| scene.direction(row), &scene.s, &[1, 2, 3]),
    },
    Family {
        over: "velocity by direction",
        shapes: &[Stribeck, QuadraticDrag, ViscousAsymmetry, Presliding],
        nameless: &[],
        is_shift: false,
        looks_like: "friction of another law over velocity: record more speeds, both ways",
        columns: |scene| {
            let motion = scene.motion;
            [1.0, -1.0]
                .into_iter()
                .flat_map(|sign| hats(&split(&motion.velocity_lp, sign), motion, 8))
                .collect()
        },
    },
    Family {
        over: "position",
        shapes: &[],
        nameless: &["force over position"],
        is_shift: false,
        looks_like: "a force over position: a spring, a balance, a cable; record slow strokes over the whole travel",
        columns: |scene| hats(&scene.motion.position_lp, scene.motion, 12),
    },
    Family {
        over: "time",
        // Where strokes back and forth are not alike, friction that drifts is a force that drifts.
        shapes: &[FrictionDrift],
        nameless: &["force over time", "drifting force"],
        is_shift: false,
        looks_like: "a force that drifts: something else acts on the axis during the record",
        columns: |scene| hats(&scene.motion.time_s, scene.motion, 8),
    },
];

/// Rate of a signal, per second; pieces are not looked across.
pub(crate) fn rate(motion: &Kinematics, signal: &[f64]) -> Vec<f64> {
    let mut rate = vec![0.0; signal.len()];
    for piece in &motion.pieces {
        for row in piece.start + 1..piece.end.saturating_sub(1) {
            rate[row] = (signal[row + 1] - signal[row - 1]) / (2.0 * motion.period_s);
        }
    }
    rate
}

fn split(values: &[f64], sign: f64) -> Vec<f64> {
    values
        .iter()
        .map(|v| if v * sign > 0.0 { *v } else { f64::NAN })
        .collect()
}

/// Piecewise linear features with knots at quantiles of the moving samples; `NaN` stands outside.
fn hats(values: &[f64], motion: &Kinematics, count: usize) -> Vec<Vec<f64>> {
    let moving = values
        .iter()
        .zip(&motion.moving)
        .filter(|(v, moving)| **moving && v.is_finite());
    let mut sorted: Vec<f64> = moving.map(|(v, _)| *v).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.len() < 100 {
        return Vec::new();
    }
    let mut knots: Vec<f64> = (0..count)
        .map(|i| sorted[i * (sorted.len() - 1) / (count - 1)])
        .collect();
    knots.dedup_by(|a, b| (*a - *b).abs() <= 1.0e-12);
    (0..knots.len())
        .map(|at| values.iter().map(|v| hat(&knots, at, *v)).collect())
        .collect()
}

fn hat(knots: &[f64], at: usize, value: f64) -> f64 {
    if !value.is_finite() {
        return 0.0;
    }
    let rise = at.checked_sub(1).map_or(
        if value <= knots[at] {
            1.0
        } else {
            f64::INFINITY
        },
        |left| (value - knots[left]) / (knots[at] - knots[left]),
    );
    let fall = knots.get(at + 1).map_or(
        if value >= knots[at] {
            1.0
        } else {
            f64::INFINITY
        },
        |right| (right - value) / (right - knots[at]),
    );
    rise.min(fall).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, usual};

    #[test]
    fn a_hat_is_one_at_its_knot_zero_at_its_neighbours_and_flat_beyond_the_ends() {
        let knots = [1.0, 2.0, 4.0];
        for (at, value, wanted) in [
            (1, 2.0, 1.0),
            (1, 1.5, 0.5),
            (1, 3.0, 0.5),
            (1, 1.0, 0.0),
            (1, 4.5, 0.0),
            (0, 0.0, 1.0),
            (0, 1.25, 0.75),
            (2, 9.0, 1.0),
            (2, 3.5, 0.75),
            (0, f64::NAN, 0.0),
        ] {
            assert!(
                (hat(&knots, at, value) - wanted).abs() < 1.0e-12,
                "{at} {value}"
            );
        }
        // Together they are one everywhere.
        for value in [0.0, 1.3, 2.0, 3.7, 8.0] {
            let sum: f64 = (0..3).map(|at| hat(&knots, at, value)).sum();
            assert!((sum - 1.0).abs() < 1.0e-12);
        }
    }

    #[test]
    fn knots_stand_at_quantiles_of_moving_samples_the_ends_among_them() {
        let mut axis = axis(usual);
        let motion = &mut axis.motion;
        motion.moving.fill(false);
        motion.moving[..701].fill(true);
        // Squares of 0, 1 … 700: a seventh of the samples from knot to knot. Others are outside.
        let squares: Vec<f64> = (0..motion.len()).map(|row| (row as f64).powi(2)).collect();
        let hats = hats(&squares, motion, 8);
        assert_eq!(hats.len(), 8);
        for (at, hat) in hats.iter().enumerate() {
            let ones: Vec<usize> = (0..=700).filter(|row| hat[*row] == 1.0).collect();
            assert_eq!(ones, [100 * at]);
        }
        assert_eq!(hats[7][5000], 1.0);
        // Half way from 100² to 200² are 25 000.
        assert!((hats[1][158] - (40_000.0 - 24_964.0) / 30_000.0).abs() < 1.0e-12);
        assert_eq!(self::hats(&vec![3.0; motion.len()], motion, 8).len(), 1);
    }

    #[test]
    fn values_of_the_other_sign_stand_outside() {
        let forwards = split(&[1.0, -2.0, 0.0], 1.0);
        assert!(forwards[0] == 1.0 && forwards[1].is_nan() && forwards[2].is_nan());
        let backwards = split(&[1.0, -2.0, 0.0], -1.0);
        assert!(backwards[0].is_nan() && backwards[1] == -2.0);
    }

    #[test]
    fn a_hundred_moving_samples_are_needed_for_features() {
        let mut axis = axis(usual);
        let moving: Vec<usize> = (0..axis.motion.len())
            .filter(|row| axis.motion.moving[*row])
            .collect();
        let count =
            |axis: &crate::fit::made::Axis| hats(&axis.motion.time_s, &axis.motion, 8).len();
        axis.motion.moving.fill(false);
        moving[..99]
            .iter()
            .for_each(|row| axis.motion.moving[*row] = true);
        assert_eq!(count(&axis), 0);
        axis.motion.moving[moving[99]] = true;
        assert_eq!(count(&axis), 8);
    }
}
