//! Friction of the motor's own side, as far as identification saw some.
//!
//! It has the elements that were identified, or is a bristle with a level and a deflection of its
//! own, or rigid where the axis has no presliding. Viscous friction is not told apart: the
//! simulator has all of it at the table.

use axis_model::{Coulomb, Effect, Estimate, Presliding, Stribeck};
use identification::{ParameterTable, SlipElement};
use plant_sim::friction::{Law, Sliding};
use serde::Serialize;

use super::stated::{LEAST_LEVEL_N, SOFTEST_BRISTLE, slip, stiffest};

/// Deflections in those of the table's friction.
const DEFLECTIONS: (f64, f64) = (0.05, 5.0);

/// Friction of the motor's side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorSide {
    /// Its Coulomb level, N.
    pub coulomb_n: f64,
    /// Its share of the Coulomb level of both sides.
    pub share: f64,
    /// Its deflection in those of the table's friction.
    pub deflection: f64,
}

/// `[axis.actual.motor_side]`.
#[derive(Serialize)]
pub(super) struct Tables {
    sliding: Sliding,
    friction: Law,
}

impl MotorSide {
    /// What identification says of it; `None` where it saw none.
    #[must_use]
    pub fn of(parameters: &ParameterTable) -> Option<Self> {
        let value = |name: &str| parameters.get(name).map(|own| own.value.max(0.0));
        let (coulomb_n, load_n) = (value("motor_coulomb")?, value("load_coulomb")?);
        let both = value("motor_deflection").zip(value("presliding_deflection"));
        let ratio = both.map_or(1.0, |(own_m, of_load_m)| own_m / of_load_m);
        (coulomb_n > 0.0).then(|| Self {
            coulomb_n,
            share: coulomb_n / (coulomb_n + load_n),
            deflection: ratio.clamp(DEFLECTIONS.0, DEFLECTIONS.1),
        })
    }

    /// The effects of both sides as those of the table alone.
    pub(super) fn left(&self, effects: &[Effect<Estimate>]) -> Vec<Effect<Estimate>> {
        let effects = effects.iter().cloned();
        effects.map(|effect| self.left_of(effect)).collect()
    }

    fn left_of(&self, effect: Effect<Estimate>) -> Effect<Estimate> {
        let of_table = |mut estimate: Estimate| {
            estimate.value *= 1.0 - self.share;
            estimate
        };
        match effect {
            Effect::Coulomb(Coulomb { coulomb }) => Effect::Coulomb(Coulomb {
                coulomb: of_table(coulomb),
            }),
            Effect::Stribeck(own) => Effect::Stribeck(Stribeck {
                excess: of_table(own.excess),
                ..own
            }),
            Effect::Presliding(own) => Effect::Presliding(Presliding {
                damping: own.damping.map(of_table),
                ..own
            }),
            other => other,
        }
    }

    /// Its tables beside the effects of both sides, elements of its own and a motor of such a mass.
    pub(super) fn tables(
        &self,
        effects: &[Effect<Estimate>],
        elements: &[SlipElement],
        motor_kg: f64,
    ) -> Tables {
        let mut sliding = Sliding::dry(self.coulomb_n.max(LEAST_LEVEL_N));
        let mut friction = Law::Coulomb;
        for effect in effects {
            match effect.stated() {
                Effect::Stribeck(own) => {
                    sliding.static_n += self.share * own.excess;
                    sliding.stribeck_velocity_m_per_s = own.velocity;
                    sliding.stribeck_exponent = own.exponent.unwrap_or(2.0);
                    sliding.stribeck_lag_s = own.lag.unwrap_or(0.0);
                    sliding.stribeck_lag_growth = own.lag_growth.unwrap_or(0.0);
                }
                Effect::Presliding(own) => {
                    let slipping = slip(elements, sliding.coulomb_n, motor_kg);
                    friction = slipping.unwrap_or_else(|| self.bristle(own, motor_kg));
                }
                Effect::CoulombAsymmetry(own) => sliding.coulomb_asymmetry = own.coulomb_asymmetry,
                _ => {}
            }
        }
        Tables { sliding, friction }
    }

    fn bristle(&self, of_table: Presliding, motor_kg: f64) -> Law {
        let stiffness = self.coulomb_n / (self.deflection * of_table.deflection);
        Law::LuGre {
            bristle_stiffness_n_per_m: stiffness.max(SOFTEST_BRISTLE).min(stiffest(motor_kg)),
            bristle_damping_n_s_per_m: self.share * of_table.damping.unwrap_or(0.0),
        }
    }
}
