//! The shape at reversals of a simulated model for people, with intervals.
//!
//! Masses, forces and actuator were fitted to the positions too, but what is told of them are the
//! estimates of the inverse dynamics: one parameter has one value.

use axis_model::vocabulary::{Backlash, Presliding};
use axis_model::{Effect, Estimate};

use super::Simulated;
use crate::record::dataset::Dataset;
use crate::simulate::parameters::Place;

/// Half widths of 95 % intervals, by the place of their parameter.
struct HalfWidths(Vec<(Place, f64)>);

impl HalfWidths {
    /// Half width of the parameter at a place; zero where there is none.
    fn of(&self, place: Place) -> f64 {
        let row = self.0.iter().find(|(other, _)| *other == place);
        row.map_or(0.0, |(_, half_width)| *half_width)
    }

    fn estimate(&self, place: Place, value: f64, unit: &str) -> Estimate {
        let half_width = self.of(place);
        Estimate {
            value,
            unit: unit.into(),
            low: value - half_width,
            high: value + half_width,
        }
    }
}

impl Simulated {
    /// Bristle and gap; `half_widths` in the order of the table of parameters.
    #[must_use]
    pub(crate) fn estimates(
        &self,
        dataset: &Dataset,
        half_widths: &[f64],
    ) -> Vec<Effect<Estimate>> {
        let table = self.parameters().into_iter().map(|row| row.place);
        let half_widths = HalfWidths(table.zip(half_widths.iter().copied()).collect());
        self.estimated_shape(dataset, &half_widths)
    }

    /// Bristle and gap, where there are any.
    fn estimated_shape(
        &self,
        dataset: &Dataset,
        half_widths: &HalfWidths,
    ) -> Vec<Effect<Estimate>> {
        let length = dataset.kind.position_unit();
        let damping = format!("{} s/{length}", dataset.effort.unit());
        let of = |place, value, unit| half_widths.estimate(place, value, unit);
        let shape = self.mechanics.shape;
        let bristle = shape.bristle.map(|bristle| {
            Effect::from(Presliding {
                deflection: of(Place::Deflection, bristle.deflection, length),
                damping: Some(of(Place::Damping, bristle.damping, &damping)),
            })
        });
        let gap = shape.gap.map(|gap| {
            let share = |place, value, unit| Some(of(place, value, unit));
            Effect::from(Backlash {
                gap: of(Place::GapWidth, gap.width, length),
                load_share: share(Place::LoadShare, gap.load_share, "of the moved mass"),
                motor_friction: share(Place::MotorFriction, gap.motor_friction, "of the friction"),
                restitution: share(Place::Restitution, gap.restitution, "of the velocity"),
            })
        });
        bristle.into_iter().chain(gap).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::axis::{Gap, Shape};
    use crate::simulate::friction::Bristle;
    use crate::simulate::made;

    /// Every kind of entry once. Hold and record agree, so the whole delay stays.
    fn simulated(dataset: &Dataset) -> Simulated {
        use axis_model::EffectName::{Coulomb, Delay, Inertia, Stribeck, TorqueSaturation};
        let fitted = made::fitted(&[
            (Inertia, 0.0, &[700.0]),
            (Coulomb, 0.0, &[300.0]),
            (Stribeck, 0.006, &[180.0]),
            (TorqueSaturation, 1.0e-4, &[]),
            (Delay, 7.0e-4, &[]),
        ]);
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
        let values: Vec<f64> = model.parameters().iter().map(|row| row.value).collect();
        let half_widths: Vec<f64> = (1..=values.len()).map(|place| place as f64).collect();
        let shape = model.estimates(&dataset, &half_widths);
        let shape = shape.iter().flat_map(Effect::parts);
        let shape = shape.map(|(row, estimate)| {
            let half_width = 0.5 * (estimate.high - estimate.low);
            (row.report_name(), estimate.value, half_width)
        });
        let all: Vec<(String, f64, f64)> = shape.collect();
        let names: Vec<&str> = all.iter().map(|(name, ..)| name.as_str()).collect();
        let wanted = [
            "presliding_deflection",
            "presliding_damping",
            "backlash_gap",
            "backlash_load_share",
            "backlash_motor_friction",
            "backlash_restitution",
        ];
        assert_eq!(names, wanted);
        for ((name, value, half_width), (place, wanted)) in
            all.iter().zip((1_u8..).zip(values).skip(6))
        {
            assert!((value / wanted - 1.0).abs() < 1.0e-12, "{name}: {value}");
            assert!(
                (half_width - f64::from(place)).abs() < 1.0e-9,
                "{name}: {half_width}"
            );
        }
    }
}
