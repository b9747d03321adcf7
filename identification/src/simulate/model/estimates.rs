//! The parameters of a simulated model for people, with intervals.

use axis_model::vocabulary::{Backlash, Presliding};
use axis_model::{Effect, EffectName, Estimate};

use super::{Active, Simulated};
use crate::model::effects::{Named, Naming};
use crate::record::dataset::Dataset;

/// What a simulation was fitted to be.
pub(crate) struct Estimates {
    /// What the inverse model has too: mass, forces, actuator.
    pub parts: Vec<Named>,
    /// What makes a reversal: bristle and gap.
    pub shape: Vec<Effect<Estimate>>,
}

/// Half widths of 95 % intervals, in the order of the entries of the parameter vector.
struct HalfWidths<'a>(std::slice::Iter<'a, f64>);

impl HalfWidths<'_> {
    fn next(&mut self) -> f64 {
        self.0.next().copied().unwrap_or(0.0)
    }

    fn named(&mut self, name: String, value: f64, unit: String) -> Named {
        Named {
            name,
            value,
            half_width: Some(self.next()),
            unit,
        }
    }

    fn estimate(&mut self, value: f64, unit: &str) -> Estimate {
        let half_width = self.next();
        Estimate {
            value,
            unit: unit.into(),
            low: value - half_width,
            high: value + half_width,
        }
    }
}

impl Simulated {
    /// The parameters; `half_widths` in the order of the entries.
    #[must_use]
    pub(crate) fn estimates(&self, dataset: &Dataset, half_widths: &[f64]) -> Estimates {
        let mut half_widths = HalfWidths(half_widths.iter());
        let mut parts = self.forces(dataset, &mut half_widths);
        parts.extend(self.actuator(dataset, &mut half_widths));
        Estimates {
            parts,
            shape: self.shape(dataset, &mut half_widths),
        }
    }

    /// Mass, then the forces in their order.
    fn forces(&self, dataset: &Dataset, half_widths: &mut HalfWidths<'_>) -> Vec<Named> {
        let (effort, length) = (dataset.effort.unit(), dataset.kind.position_unit());
        let mut named = vec![half_widths.named(
            EffectName::Inertia.to_string(),
            self.mechanics.mass,
            format!("{effort} s^2/{length}"),
        )];
        for Active { part, own } in &self.terms {
            let coefficients: Vec<(f64, f64)> = own
                .iter()
                .map(|value| (*value, half_widths.next()))
                .collect();
            let is_tuned = part.effect.is_tuned();
            named.extend(part.effect.parameters(&Naming {
                parameter: part.parameter,
                parameter_half_width: is_tuned.then(|| half_widths.next()),
                coefficients: &coefficients,
                dataset,
            }));
        }
        named
    }

    /// Saturation and delay, where there are any.
    fn actuator(&self, dataset: &Dataset, half_widths: &mut HalfWidths<'_>) -> Vec<Named> {
        let mut named = Vec::new();
        if !self.saturation.is_ideal() {
            named.push(half_widths.named(
                EffectName::TorqueSaturation.to_string(),
                self.saturation.per_effort,
                format!("1/{}", dataset.effort.unit()),
            ));
        }
        if self.delay_s != 0.0 {
            let name = format!("{}_beyond_hold", EffectName::Delay);
            named.push(half_widths.named(name, self.delay_s, "s".into()));
        }
        named
    }

    /// Bristle and gap, where there are any.
    fn shape(&self, dataset: &Dataset, half_widths: &mut HalfWidths<'_>) -> Vec<Effect<Estimate>> {
        let length = dataset.kind.position_unit();
        let damping_unit = format!("{} s/{length}", dataset.effort.unit());
        let shape = self.mechanics.shape;
        let bristle = shape.bristle.map(|bristle| {
            Effect::from(Presliding {
                deflection: half_widths.estimate(bristle.deflection, length),
                damping: Some(half_widths.estimate(bristle.damping, &damping_unit)),
            })
        });
        let gap = shape.gap.map(|gap| {
            Effect::from(Backlash {
                gap: half_widths.estimate(gap.width, length),
                load_share: Some(half_widths.estimate(gap.load_share, "of the moved mass")),
                motor_friction: Some(half_widths.estimate(gap.motor_friction, "of the friction")),
                restitution: Some(half_widths.estimate(gap.restitution, "of the velocity")),
            })
        });
        bristle.into_iter().chain(gap).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fitted::Fitted;
    use crate::model::effects::find;
    use crate::model::inverse::{Model, Part};
    use crate::simulate::axis::{Gap, Shape};
    use crate::simulate::friction::Bristle;
    use crate::simulate::made;

    /// Every kind of entry once. Hold and record agree, so the whole delay stays.
    fn simulated(dataset: &Dataset) -> Simulated {
        use EffectName::{Coulomb, Delay, Inertia, Stribeck, TorqueSaturation};
        let parts = [
            (Inertia, 0.0),
            (Coulomb, 0.0),
            (Stribeck, 0.006),
            (TorqueSaturation, 1.0e-4),
            (Delay, 7.0e-4),
        ];
        let part = |(name, parameter)| Some(Part::found(find(name)?, parameter));
        let parts = parts.into_iter().filter_map(part).collect();
        let fitted = Fitted::new(Model { parts }, &[700.0, 300.0, 180.0]);
        let shape = Shape {
            bristle: Some(Bristle {
                deflection: 8.0e-6,
                damping: 500.0,
            }),
            gap: Some(Gap {
                width: 2.0e-5,
                load_share: 0.4,
                motor_friction: 0.2,
                restitution: 0.5,
            }),
        };
        Simulated::new(dataset, 1.0e-3, &fitted, shape).unwrap()
    }

    #[test]
    fn each_half_width_goes_to_the_entry_in_whose_place_it_stands() {
        let dataset = made::dataset(made::record(1.0e-3, made::two_sines(3000)), None);
        let model = simulated(&dataset);
        let values = model.values();
        let half_widths: Vec<f64> = (1..=values.len()).map(|place| place as f64).collect();
        let estimates = model.estimates(&dataset, &half_widths);
        let parts = estimates.parts.iter();
        let parts = parts.map(|named| (named.name.clone(), named.value, named.half_width.unwrap()));
        let shape = estimates.shape.iter().flat_map(Effect::parts);
        let shape = shape.map(|(row, estimate)| {
            let half_width = 0.5 * (estimate.high - estimate.low);
            (row.report_name(), estimate.value, half_width)
        });
        let all: Vec<(String, f64, f64)> = parts.chain(shape).collect();
        let names: Vec<&str> = all.iter().map(|(name, ..)| name.as_str()).collect();
        let wanted = [
            "inertia",
            "coulomb",
            "stribeck_excess",
            "stribeck_velocity",
            "torque_saturation",
            "delay_beyond_hold",
            "presliding_deflection",
            "presliding_damping",
            "backlash_gap",
            "backlash_load_share",
            "backlash_motor_friction",
            "backlash_restitution",
        ];
        assert_eq!(names, wanted);
        for ((name, value, half_width), (place, wanted)) in all.iter().zip((1_u8..).zip(values)) {
            assert!((value / wanted - 1.0).abs() < 1.0e-12, "{name}: {value}");
            assert!(
                (half_width - f64::from(place)).abs() < 1.0e-9,
                "{name}: {half_width}"
            );
        }
    }
}
