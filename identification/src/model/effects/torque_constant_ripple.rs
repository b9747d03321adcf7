//! Ripple of the torque constant: of an effort u the motor delivers `q = u (1 + w)`,
//! `w = c cos(2π k x + φ)`.
//!
//! The recorded effort carries the wave with the other sign, weighted with itself: `u = q − u w`.
//! A torque ripple ([`super::torque_ripple`]) is there at any effort. This one changes its sign
//! with the effort, and where there is none it is nothing.
//!
//! The columns are −u cos and −u sin. The u in them is computed from the motion ([`ByMotion`]), and
//! with its own wave: with q in its place the second order would look like a ripple of twice the
//! wave number.

use std::ops::Range;

use axis_model::EffectName;

use super::by_motion::{ByMotion, Others, Usual};
use super::few_periods::{FewPeriods, WaveNumbers};
use super::position_dependent_inertia::PositionDependentInertia;
use super::torque_ripple::TorqueRipple;
use super::wave::{self, Names, Weight};
use super::{
    Action, Against, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting, polynomial,
};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// −u (a cos(2π k x) + b sin(2π k x)).
pub(crate) struct TorqueConstantRipple;

/// A torque constant that changes smoothly over the travel: −u (a₁ T₁ + a₂ T₂ + …). The nonlinear
/// parameter is the degree.
pub(crate) struct SmoothTorqueConstant;

/// Friction with a wave over position: sign(v) (a cos(2π k x) + b sin(2π k x)). Where friction is
/// most of the effort, it looks like a torque constant that ripples.
pub(crate) struct FrictionWave;

/// At least so many periods within the travel for a period that is searched: fewer are no period
/// yet, and the wave would be taken for a part of the effort itself.
const FEWEST_PERIODS: f64 = 3.0;

/// The orders with fewer periods. A wave of the same period that is a force, an inertia or friction
/// is no torque constant's.
static AT_KNOWN_ORDERS: [&dyn Effect; 1] = [&FewPeriods {
    of: &TorqueConstantRipple,
    below_periods: FEWEST_PERIODS,
    wave_numbers: WaveNumbers::KnownOrders,
    smooth: &SmoothTorqueConstant,
    look_alikes: &[&TorqueRipple, &PositionDependentInertia, &FrictionWave],
}];
/// Half the torque: no motor is made so.
const LARGEST: f64 = 0.5;
/// Rounds in which the effort and its wave are made to agree: each leaves a tenth of the error, as
/// the wave is a tenth of the effort.
const ROUNDS: usize = 3;

/// The columns with the effort of each row by the motion that agrees with its wave, `q / (1 + w)`.
fn consistent(motion: &Kinematics, k: f64, others: &Others) -> Vec<Vec<f64>> {
    let waves = wave::columns(motion, k, |_| Weight::PLAIN);
    let by_motion = ByMotion::beside(motion, others);
    let with_wave = |usual: Usual, own: &[f64]| {
        let effort = |row| by_motion.effort(usual, row) + others.all(row);
        with_wave(&effort, own, &waves)
    };
    let (mut usual, mut own) = by_motion.fit(&[]);
    for _ in 0..ROUNDS {
        let efforts = with_wave(usual, &own);
        (usual, own) = by_motion.fit(&columns(&waves, &efforts));
    }
    columns(&waves, &with_wave(usual, &own))
}

/// Effort of each row by the motion, over one and its wave; without coefficients of that as it is.
fn with_wave(effort: &dyn Fn(usize) -> f64, own: &[f64], waves: &[Vec<f64>]) -> Vec<f64> {
    let rows = waves[0].iter().zip(&waves[1]).enumerate();
    rows.map(|(row, (cos, sin))| {
        let wave = match own {
            [a, b] => a * cos + b * sin,
            _ => 0.0,
        };
        effort(row) / (1.0 + wave.clamp(-LARGEST, LARGEST))
    })
    .collect()
}

fn columns(waves: &[Vec<f64>], efforts: &[f64]) -> Vec<Vec<f64>> {
    let by_effort = |wave: &Vec<f64>| {
        let pairs = wave.iter().zip(efforts);
        pairs.map(|(wave, effort)| -effort * wave).collect()
    };
    waves.iter().map(by_effort).collect()
}

impl Effect for TorqueConstantRipple {
    fn called(&self) -> Called {
        EffectName::TorqueConstantRipple.into()
    }

    fn equation(&self) -> &'static str {
        "-u (a cos(2 pi k x) + b sin(2 pi k x)), u = effort by motion"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, k: f64) -> Vec<Vec<f64>> {
        self.columns_beside(motion, dataset, k, &Others::default())
    }

    fn columns_beside(
        &self,
        motion: &Kinematics,
        _: &Dataset,
        k: f64,
        others: &Others,
    ) -> Vec<Vec<f64>> {
        consistent(motion, k, others)
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_nearest_outsider(&self) -> bool {
        true
    }

    fn with_few_periods(&self) -> &'static [&'static dyn Effect] {
        &AT_KNOWN_ORDERS
    }

    fn acts_on_motor(&self) -> bool {
        true
    }

    fn follows_load(&self) -> bool {
        true
    }

    fn repeats(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Period
    }

    fn action(&self, at: &Instant, k: f64, own: &[f64]) -> Action {
        Action::force(-at.effort * wave::value(own, k, at.position))
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        dataset.lead_m_per_rev.map_or(100.0, |lead| 1.0 / lead)
    }

    fn least_distance(&self, motion: &Kinematics) -> f64 {
        wave::of_periods(motion, 2.0)
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        self.strongest(motion, setting, FEWEST_PERIODS..f64::INFINITY)
    }

    fn strongest(
        &self,
        motion: &Kinematics,
        setting: &Setting<'_>,
        periods: Range<f64>,
    ) -> Vec<f64> {
        let efforts = ByMotion::of(motion).efforts();
        wave::strongest(motion, setting, periods, |row| Weight {
            wave: -efforts[row],
            half_slope: 0.0,
        })
    }

    fn first_step(&self, motion: &Kinematics, _: f64) -> f64 {
        wave::of_periods(motion, 0.05)
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        (wave::of_periods(motion, FEWEST_PERIODS), f64::MAX)
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        wave::amplitude(fitted.own) < LARGEST
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let name = EffectName::TorqueConstantRipple.as_str();
        let names = Names {
            amplitude: name,
            rest: name,
        };
        wave::named(naming, &names, String::new())
    }
}

impl Effect for SmoothTorqueConstant {
    fn called(&self) -> Called {
        Called::Structure("smooth torque constant over position")
    }

    fn equation(&self) -> &'static str {
        "-u (a1 x + a2 x^2 + ...), u = effort by motion, x = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, degree: f64) -> Vec<Vec<f64>> {
        let efforts = ByMotion::of(motion).efforts();
        let positions = polynomial::over_travel(motion, dataset);
        let pairs = positions.zip(efforts.iter().map(|effort| -effort));
        polynomial::of_degree(pairs, self.width(degree))
    }

    fn width(&self, degree: f64) -> usize {
        degree as usize
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

impl Effect for FrictionWave {
    fn called(&self) -> Called {
        Called::Structure("friction with a wave over position")
    }

    fn equation(&self) -> &'static str {
        "sign(v) (a cos(2 pi k x) + b sin(2 pi k x))"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, k: f64) -> Vec<Vec<f64>> {
        wave::columns(motion, k, |row| Weight {
            wave: motion.direction[row],
            half_slope: 0.0,
        })
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, found, model, usual};
    use EffectName::{Coulomb, Inertia, Offset, TorqueRipple, Viscous};

    const K: f64 = 160.0;
    const OWN: [f64; 2] = [0.09, -0.05];

    fn rippled() -> Axis {
        axis(|motion, row| {
            usual(motion, row) / (1.0 + wave::value(&OWN, K, motion.position_lp[row]))
        })
    }

    #[test]
    fn the_wave_of_a_torque_constant_comes_back_and_nothing_of_the_second_order_is_left() {
        let axis = rippled();
        let bench = axis.bench();
        let declared = model(&[Inertia, Viscous, Coulomb, Offset]);
        let error = |name: EffectName| {
            let fitted = bench.fit(&declared.with(found(name, K)));
            (
                fitted.of(name).unwrap().to_vec(),
                bench.force_error_percent(&fitted),
            )
        };
        let (own, left) = error(EffectName::TorqueConstantRipple);
        for (own, wanted) in own.iter().zip(OWN) {
            assert!((own - wanted).abs() < 0.002, "{own} {wanted}");
        }
        assert!(left < 0.4, "{left}");
        assert!(error(TorqueRipple).1 > 5.0 * left);
    }

    #[test]
    fn a_simulated_motor_delivers_more_or_less_of_its_effort_by_position() {
        let at = Instant {
            position: 0.25 / K,
            effort: 40.0,
            ..Instant::default()
        };
        let action = TorqueConstantRipple.action(&at, K, &OWN);
        // A quarter of a period on: the sine alone, −5 %, so that 2 N act against motion.
        assert!((action.force - 2.0).abs() < 1.0e-9, "{}", action.force);
        assert_eq!(action.level, 0.0);
    }
}
