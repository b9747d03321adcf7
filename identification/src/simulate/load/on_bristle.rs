//! A load on a bristle behind a gap, along a measured motor path.
//!
//! The bent bristle carries the load while the motor pushes. Friction acts on the load alone, so
//! where the motor draws back, the bristle springs back and the load follows it, until nothing is
//! transmitted any more:
//!
//! ```text
//! transmitted / m₂ = dv/dt + c·z        z: bend of the bristle, −1…1
//! ```
//!
//! A contact only pushes. From there on the load is alone: it coasts and rests, its bristle
//! unbent, and the motor feels neither its mass nor its friction until it meets the other side. A
//! bristle without a gap turns over at once, so its friction rises over the way without a rest
//! between. One step is one row of the record. Units: m or rad, s.

use super::{Behind, Load, Path};
use crate::simulate::friction::{Bend, bend_after};
use crate::simulate::gap::Side;

/// A gap and the load on its bristle behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OnBristle {
    /// Gap and friction; its impacts do not rebound.
    pub behind: Behind,
    /// Way over which the bristle bends.
    pub deflection: f64,
}

/// What a load does along a motor path, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Followed {
    /// Motor − load.
    pub lag: Vec<f64>,
    /// Bend of the bristle: friction over its level.
    pub bend: Vec<Bend>,
}

/// The load with its bristle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bent {
    load: Load,
    bend: Bend,
}

impl OnBristle {
    /// The load along a motor path; it starts at rest in the middle of the gap.
    #[must_use]
    pub(crate) fn follow(&self, motor: &[f64], period_s: f64) -> Followed {
        let path = Path { motor, period_s };
        let x = motor.first().copied().unwrap_or(0.0);
        let mut bent = Bent::default();
        bent.load.x = x;
        let mut followed = Followed::default();
        for row in 0..motor.len() {
            followed.lag.push(path.at(row) - bent.load.x);
            followed.bend.push(bent.bend);
            bent = self.after(bent, &path, row);
        }
        followed
    }

    /// The load at the next row.
    fn after(&self, bent: Bent, path: &Path<'_>, row: usize) -> Bent {
        let pushed = bent.load.pushed;
        let together = pushed.and_then(|side| self.together(bent, side, path, row));
        together.unwrap_or_else(|| self.alone(bent, path, row))
    }

    /// With the motor; `None` where the contact would have to pull.
    fn together(&self, bent: Bent, side: Side, path: &Path<'_>, row: usize) -> Option<Bent> {
        let x = path.at(row + 1) - 0.5 * self.behind.gap * side.sign();
        let bend = bend_after(bent.bend, x - bent.load.x, self.deflection);
        let v = path.velocity(row);
        let acceleration = (path.velocity(row + 1) - v) / path.period_s;
        let transmitted = acceleration + self.behind.coulomb * bend;
        let pushed = Some(side);
        (side.sign() * transmitted >= 0.0).then_some(Bent {
            load: Load { x, v, pushed },
            bend,
        })
    }

    /// By itself, until the motor meets it.
    fn alone(&self, bent: Bent, path: &Path<'_>, row: usize) -> Bent {
        let (x, v) = self.behind.coasted(bent.load, path.period_s);
        let (next, half) = (path.at(row + 1), 0.5 * self.behind.gap);
        let rested = if v == 0.0 { 0.0 } else { bent.bend };
        let met = Load {
            x: x.max(next - half).min(next + half),
            v: path.velocity(row),
            pushed: Some(Side::of(next - x)),
        };
        let free = Load { x, v, pushed: None };
        let load = if met.x == x { free } else { met };
        let step = load.x - bent.load.x;
        let is_at_rest = load.pushed.is_none() && v == 0.0;
        let bend = bend_after(rested, step, self.deflection);
        Bent {
            load,
            bend: if is_at_rest { 0.0 } else { bend },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gap of 20 µm before a load that stops at once, on a bristle of 2 µm.
    fn behind(gap: f64) -> OnBristle {
        OnBristle {
            behind: Behind {
                gap,
                coulomb: 1.0e3,
                ..Behind::default()
            },
            deflection: 2.0e-6,
        }
    }

    /// 200 µm there and back again at 0.1 mm/s.
    fn there_and_back() -> Vec<f64> {
        let row = |row: i32| 1.0e-7 * f64::from(if row < 2000 { row } else { 4000 - row });
        (0..4000).map(row).collect()
    }

    #[test]
    fn friction_is_missing_over_the_way_across_the_gap() {
        let followed = behind(20.0e-6).follow(&there_and_back(), 1.0e-3);
        let bend = &followed.bend;
        assert!(bend[1990] > 0.99 && bend[3990] < -0.99);
        // 100 rows are 10 µm. The load springs back with the motor by 2 µm·ln 2, then it rests.
        assert!(bend[2010] > 0.1, "{}", bend[2010]);
        assert!(bend[2020..2200].iter().all(|bend| *bend == 0.0));
        assert!(bend[2230] < -0.5 && bend[2300] < -0.95);
    }

    #[test]
    fn without_a_gap_the_bristle_turns_over_at_once() {
        let followed = behind(0.0).follow(&there_and_back(), 1.0e-3);
        assert!(followed.lag.iter().all(|lag| lag.abs() < 1.0e-12));
        let bend = &followed.bend;
        // After 2 µm·ln 2 it is upright, after 2 µm·ln 4 bent by a half.
        assert!(
            bend[2012] > 0.0 && bend[2016] < 0.0,
            "{:?}",
            &bend[2012..2017]
        );
        assert!((bend[2028] + 0.5).abs() < 0.05, "{}", bend[2028]);
    }

    #[test]
    fn motor_and_load_are_half_a_gap_apart_on_the_side_that_pushes() {
        let lag = behind(20.0e-6).follow(&there_and_back(), 1.0e-3).lag;
        assert!((lag[1990] - 10.0e-6).abs() < 1.0e-12);
        assert!((lag[3990] + 10.0e-6).abs() < 1.0e-12);
    }

    #[test]
    fn a_load_that_coasts_keeps_its_bristle_bent() {
        let mut gentle = behind(20.0e-6);
        gentle.behind.coulomb = 0.1;
        let bent = Bent {
            load: Load {
                v: 1.0e-3,
                ..Load::default()
            },
            bend: 1.0,
        };
        let path = Path {
            motor: &[0.0; 4],
            period_s: 1.0e-3,
        };
        let after = gentle.alone(bent, &path, 0);
        assert_eq!((after.bend, after.load.pushed), (1.0, None));
        assert!(after.load.x > 0.9e-6 && after.load.v < 1.0e-3);
    }
}
