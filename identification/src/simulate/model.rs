//! An identified model, ready to be simulated, and its parameters as one vector.

use axis_model::EffectName;

use super::axis::{Acting, Mechanics, Shape};
use crate::fit::fitted::Fitted;
use crate::model::effects::torque_saturation::Saturation;
use crate::model::effects::{Action, Instant, Stage};
use crate::model::inverse::Part;
use crate::record::dataset::Dataset;
use crate::record::units::EffortHold;

pub(crate) mod estimates;

/// A force with its coefficients.
#[derive(Clone)]
pub(crate) struct Active {
    part: Part,
    own: Vec<f64>,
}

/// A model for free-run simulation.
#[derive(Clone)]
pub(crate) struct Simulated {
    /// Moved mass, and what makes a reversal.
    pub mechanics: Mechanics,
    /// Terms other than the mass.
    terms: Vec<Active>,
    /// The actuator.
    saturation: Saturation,
    /// Delay beyond the hold, s.
    pub delay_s: f64,
    travel: (f64, f64),
    duration_s: f64,
}

/// One entry of the parameter vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    /// Its size, for scaling.
    pub scale: f64,
    /// Step of the numerical derivative, in units of the scale.
    pub step: f64,
    /// Whether it stays positive.
    pub positive: bool,
}

const STEP: f64 = 1.0e-3;
/// The cost over a gap is jagged: contacts come and go with it.
const JAGGED_STEP: f64 = 0.04;

impl Entry {
    /// Whether the cost over it is jagged.
    #[must_use]
    pub(crate) fn is_jagged(&self) -> bool {
        self.step >= JAGGED_STEP
    }
}

impl Simulated {
    /// The simulation of an inverse model; `None` where it has no mass.
    #[must_use]
    pub(crate) fn new(
        dataset: &Dataset,
        period_s: f64,
        fitted: &Fitted,
        shape: Shape,
    ) -> Option<Self> {
        let mass = *fitted.of(EffectName::Inertia)?.first()?;
        let is_force = |part: &Part| part.effect.stage() == Stage::Force && !part.effect.is_mass();
        let forces = fitted.terms().filter(|term| is_force(term.part));
        let terms = forces.map(|term| Active {
            part: term.part.clone(),
            own: term.own.to_vec(),
        });
        // A simulated effort is held from its row on; an instantaneous record sees half a period of
        // that as delay.
        let hold_s = if dataset.hold == EffortHold::Instant {
            0.5 * period_s
        } else {
            0.0
        };
        let delay_s = (fitted.model().delay_s() - hold_s).max(0.0);
        let saturation = fitted.model().saturation();
        let duration_s = dataset.train.duration_s();
        (mass > 0.0).then_some(Self {
            mechanics: Mechanics { mass, shape },
            terms: terms.collect(),
            saturation,
            delay_s,
            travel: dataset.travel(),
            duration_s,
        })
    }

    /// What acts at an instant under a commanded effort.
    #[must_use]
    pub(crate) fn acting(
        &self,
        position: f64,
        velocity: f64,
        time_s: f64,
        commanded: f64,
    ) -> Acting {
        let scaled = (position - self.travel.0) / self.travel.1;
        let at = Instant {
            position,
            scaled,
            velocity,
            time_s,
            time_share: time_s / self.duration_s,
        };
        let delivered = self.saturation.delivered(commanded);
        let mut acting = Acting {
            motor: delivered,
            ..Acting::default()
        };
        for Active { part, own } in &self.terms {
            let Action { level, force } = part.effect.action(&at, part.parameter, own);
            acting.level += level;
            if part.effect.acts_on_motor() {
                acting.motor -= force;
            } else {
                acting.load += force;
            }
        }
        acting
    }

    /// The entries of the parameter vector.
    #[must_use]
    pub(crate) fn entries(&self) -> Vec<Entry> {
        let coulomb = self
            .terms
            .iter()
            .find(|active| active.part.is(EffectName::Coulomb));
        let force = coulomb
            .map_or(self.mechanics.mass, |active| active.own[0].abs())
            .max(f64::MIN_POSITIVE);
        let free = |scale: f64| Entry {
            scale,
            step: STEP,
            positive: false,
        };
        let positive = |scale: f64| Entry {
            positive: true,
            ..free(scale)
        };
        let jagged = |scale: f64| Entry {
            step: JAGGED_STEP,
            ..positive(scale)
        };
        let mut entries = vec![positive(self.mechanics.mass)];
        for Active { part, own } in &self.terms {
            let is_coulomb = part.is(EffectName::Coulomb);
            let scales = own.iter().map(|value| value.abs().max(0.05 * force));
            entries.extend(scales.map(|scale| {
                if is_coulomb {
                    positive(scale)
                } else {
                    free(scale)
                }
            }));
            entries.extend(
                part.effect
                    .is_tuned()
                    .then(|| positive(part.parameter.abs())),
            );
        }
        entries.extend((!self.saturation.is_ideal()).then(|| positive(self.saturation.per_effort)));
        entries.extend((self.delay_s != 0.0).then(|| positive(self.delay_s)));
        if let Some(bristle) = self.mechanics.shape.bristle {
            entries.extend([
                positive(bristle.deflection),
                positive(bristle.damping.max(2.0 * self.mechanics.mass)),
            ]);
        }
        if let Some(gap) = self.mechanics.shape.gap {
            entries.extend([gap.width, 1.0, 1.0, 1.0].map(jagged));
        }
        entries
    }

    /// The parameter vector, unscaled, in the order of the entries.
    #[must_use]
    pub(crate) fn values(&self) -> Vec<f64> {
        let mut copy = self.clone();
        let mut values = Vec::new();
        copy.visit(&mut |value| values.push(*value));
        values
    }

    /// The model with another parameter vector.
    #[must_use]
    pub(crate) fn with(&self, values: &[f64]) -> Self {
        let mut copy = self.clone();
        let mut rest = values.iter();
        copy.visit(&mut |value| *value = rest.next().copied().unwrap_or(*value));
        if let Some(gap) = &mut copy.mechanics.shape.gap {
            gap.load_share = gap.load_share.clamp(0.05, 0.95);
            gap.motor_friction = gap.motor_friction.clamp(0.0, 0.95);
            gap.restitution = gap.restitution.clamp(0.0, 0.98);
        }
        copy
    }

    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        each(&mut self.mechanics.mass);
        for Active { part, own } in &mut self.terms {
            own.iter_mut().for_each(&mut *each);
            if part.effect.is_tuned() {
                each(&mut part.parameter);
            }
        }
        if !self.saturation.is_ideal() {
            each(&mut self.saturation.per_effort);
        }
        if self.delay_s != 0.0 {
            each(&mut self.delay_s);
        }
        if let Some(bristle) = &mut self.mechanics.shape.bristle {
            each(&mut bristle.deflection);
            each(&mut bristle.damping);
        }
        if let Some(gap) = &mut self.mechanics.shape.gap {
            each(&mut gap.width);
            each(&mut gap.load_share);
            each(&mut gap.motor_friction);
            each(&mut gap.restitution);
        }
    }
}
