//! The inverse model of an axis: motion in, commanded effort out.
//!
//! ```text
//! q = Σ θ · column          wanted effort: the parts that are forces
//! u = q / (1 − k |q|)       commanded effort of a drive that falls behind (torque saturation)
//! u(t) acts at t + delay    (delay; below zero: logged late)
//! ```
//!
//! All of them are parts of one list. A part that is a force has columns and one coefficient each;
//! delay and saturation have a nonlinear parameter and no column.

use axis_model::EffectName;

use crate::model::effects::torque_saturation::Saturation;
use crate::model::effects::{Effect, LIBRARY, Stage};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// Where a part comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The dataset declares it: it is not removed.
    Declared,
    /// The identification found it.
    Found,
}

/// An effect with its nonlinear parameter.
#[derive(Clone)]
pub(crate) struct Part {
    /// Which effect.
    pub effect: &'static dyn Effect,
    /// Its nonlinear parameter.
    pub parameter: f64,
    /// Where it comes from.
    pub origin: Origin,
    /// Coefficients of its columns about which a saturating actuator is linearised; empty: zero.
    pub about: Vec<f64>,
    /// What the other parts did in an earlier fit: for an effect that follows the load.
    pub beside: Vec<Beside>,
}

/// A part of an earlier fit, with the coefficients of its columns.
#[derive(Clone)]
pub(crate) struct Beside {
    /// The part.
    pub part: Part,
    /// Its coefficients, one a column.
    pub own: Vec<f64>,
}

impl Part {
    /// A part that was found.
    #[must_use]
    pub(crate) fn found(effect: &'static dyn Effect, parameter: f64) -> Self {
        Self {
            effect,
            parameter,
            origin: Origin::Found,
            about: Vec::new(),
            beside: Vec::new(),
        }
    }

    /// A part that was declared.
    #[must_use]
    pub(crate) fn declared(effect: &'static dyn Effect, parameter: f64) -> Self {
        Self {
            origin: Origin::Declared,
            ..Self::found(effect, parameter)
        }
    }

    /// What it is called.
    #[must_use]
    pub(crate) fn called(&self) -> Called {
        self.effect.called()
    }

    /// Number of its columns.
    #[must_use]
    pub(crate) fn width(&self) -> usize {
        self.effect.width(self.parameter)
    }

    /// Whether it is the same effect with the same nonlinear parameter, of the same form and lag.
    #[must_use]
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.called() == other.called()
            && self.parameter == other.parameter
            && self.effect.form() == other.effect.form()
            && self.effect.lag_s() == other.effect.lag_s()
            && self.effect.lag_growth() == other.effect.lag_growth()
            && self.width() == other.width()
    }

    /// Whether it has another form than the usual one.
    #[must_use]
    pub(crate) fn is_reshaped(&self) -> bool {
        let usual = self.effect.forms().last();
        usual.is_some_and(|usual| usual.form() != self.effect.form())
    }

    /// Whether it has this name.
    #[must_use]
    pub(crate) fn is(&self, name: EffectName) -> bool {
        self.called() == name
    }
}

/// An inverse model: a list of parts, the declared ones first, the others in the order in which
/// they were found.
#[derive(Clone, Default)]
pub(crate) struct Model {
    /// Its parts.
    pub parts: Vec<Part>,
}

impl Model {
    /// What a dataset declares, as far as it is an effect of the inverse model.
    #[must_use]
    pub(crate) fn declared(dataset: &Dataset) -> Self {
        let is_declared = |effect: &&'static dyn Effect| {
            let called = effect.called();
            let stands_for = |name: &EffectName| called == *name || effect.stands_for(*name);
            dataset.declared.iter().any(stands_for)
        };
        let parts = LIBRARY.into_iter().filter(is_declared);
        Self {
            parts: parts
                .map(|effect| Part::declared(effect, effect.start(dataset)))
                .collect(),
        }
    }

    /// The part of a name, where it is in the model; the first one of those that repeat.
    #[must_use]
    pub(crate) fn of(&self, name: EffectName) -> Option<&Part> {
        self.parts.iter().find(|part| part.is(name))
    }

    /// Whether a part of this name is in it.
    #[must_use]
    pub(crate) fn has(&self, name: impl Into<Called>) -> bool {
        let called = name.into();
        self.parts.iter().any(|part| part.called() == called)
    }

    /// The recorded effort acts this much later than the record says, s; below zero where it was
    /// logged late.
    #[must_use]
    pub(crate) fn delay_s(&self) -> f64 {
        self.time_of(EffectName::Delay) - self.logged_late_s()
    }

    /// The recorded effort was logged so late, s.
    #[must_use]
    pub(crate) fn logged_late_s(&self) -> f64 {
        self.time_of(EffectName::LoggedLate)
    }

    fn time_of(&self, name: EffectName) -> f64 {
        self.of(name).map_or(0.0, |part| part.parameter)
    }

    /// Whether an effect can come in besides: one that is not there yet, or may be there several
    /// times. A record has one shift of time.
    #[must_use]
    pub(crate) fn is_open_to(&self, effect: &dyn Effect) -> bool {
        let shifts = |part: &Part| part.effect.stage() == Stage::Time;
        let is_shifted = effect.stage() == Stage::Time && self.parts.iter().any(shifts);
        effect.repeats() || !(is_shifted || self.has(effect.called()))
    }

    /// The actuator; an ideal one where it does not saturate.
    #[must_use]
    pub(crate) fn saturation(&self) -> Saturation {
        saturation(&self.parts)
    }

    /// The model with one more part.
    #[must_use]
    pub(crate) fn with(&self, part: Part) -> Self {
        let mut model = self.clone();
        model.parts.push(part);
        model
    }

    /// The model without one of its parts.
    #[must_use]
    pub(crate) fn without(&self, part: &Part) -> Self {
        let mut model = self.clone();
        model.parts.retain(|other| !other.is_same(part));
        model
    }

    /// The model with another nonlinear parameter of a part.
    #[must_use]
    pub(crate) fn with_parameter(&self, place: usize, parameter: f64) -> Self {
        let mut model = self.clone();
        model.parts[place].parameter = parameter;
        model
    }

    /// The model with another form of a part.
    #[must_use]
    pub(crate) fn with_form(&self, place: usize, form: &'static dyn Effect) -> Self {
        let mut model = self.clone();
        model.parts[place].effect = form;
        model
    }

    /// Places of the parts in the order in which they are refined: from the forces to the recorded
    /// effort, that is forces, delay, actuator.
    #[must_use]
    pub(crate) fn outwards(&self) -> Vec<usize> {
        let mut places: Vec<usize> = (0..self.parts.len()).collect();
        places.sort_by_key(|place| self.parts[*place].effect.stage());
        places
    }

    /// The parts that were found, once each, in the order in which they were found.
    #[must_use]
    pub(crate) fn found(&self) -> Vec<Called> {
        let mut list = Vec::new();
        for part in self.parts.iter().filter(|p| p.origin == Origin::Found) {
            if !list.contains(&part.called()) {
                list.push(part.called());
            }
        }
        list
    }
}

/// What a drive makes of its effort by the parts of a model.
#[must_use]
pub(crate) fn saturation<'a>(parts: impl IntoIterator<Item = &'a Part>) -> Saturation {
    let mut parts = parts.into_iter();
    let saturates = parts.find(|part| part.is(EffectName::TorqueSaturation));
    Saturation {
        per_effort: saturates.map_or(0.0, |part| part.parameter),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{found, model};
    use crate::model::effects::find;
    use EffectName::{
        Coulomb, CoulombAsymmetry, Delay, FrictionDrift, Inertia, LoggedLate, Offset,
        PositionDependentFriction, Presliding, Stribeck, TorqueRipple, TorqueSaturation, Viscous,
    };

    fn names(model: &Model) -> Vec<&'static str> {
        let parts = model.parts.iter();
        parts.map(|part| part.called().as_str()).collect()
    }

    #[test]
    fn a_declared_model_has_the_columns_that_are_declared_in_the_order_of_the_library() {
        let mut dataset = crate::fit::made::axis(|_, _| 0.0).dataset;
        dataset.declared = vec![Stribeck, Coulomb, Inertia, Presliding];
        let declared = Model::declared(&dataset);
        assert_eq!(names(&declared), ["inertia", "coulomb", "stribeck"]);
        assert!(
            declared
                .parts
                .iter()
                .all(|part| part.origin == Origin::Declared)
        );
        assert!(declared.found().is_empty());
    }

    #[test]
    fn an_asymmetry_of_coulomb_friction_is_the_column_of_the_offset_and_comes_once() {
        let mut dataset = crate::fit::made::axis(|_, _| 0.0).dataset;
        for declared in [vec![CoulombAsymmetry], vec![Offset, CoulombAsymmetry]] {
            dataset.declared = declared;
            assert_eq!(names(&Model::declared(&dataset)), ["offset"]);
        }
    }

    #[test]
    fn declared_parameters_start_where_the_axis_is_likely_to_have_them() {
        let mut dataset = crate::fit::made::axis(|_, _| 0.0).dataset;
        dataset.declared = vec![
            Stribeck,
            FrictionDrift,
            PositionDependentFriction,
            TorqueRipple,
            Delay,
        ];
        let start = |dataset: &Dataset, name| Model::declared(dataset).of(name).unwrap().parameter;
        // Five times the moving velocity; 30 % of six seconds; linear.
        assert!((start(&dataset, Stribeck) - 5.0e-3).abs() < 1.0e-12);
        assert!((start(&dataset, FrictionDrift) - 1.8).abs() < 1.0e-3);
        assert_eq!(start(&dataset, PositionDependentFriction), 1.0);
        assert_eq!(start(&dataset, Delay), 2.5e-4);
        // Once a revolution, where that is known.
        assert_eq!(start(&dataset, TorqueRipple), 100.0);
        dataset.lead_m_per_rev = Some(0.005);
        assert_eq!(start(&dataset, TorqueRipple), 200.0);
    }

    #[test]
    fn delay_and_saturation_are_parts_and_without_them_there_is_neither() {
        let plain = model(&[Inertia]);
        assert_eq!(plain.delay_s(), 0.0);
        assert!(plain.saturation().is_ideal());
        let full = plain
            .with(found(Delay, 1.0e-3))
            .with(found(TorqueSaturation, 2.0e-3));
        assert_eq!(full.delay_s(), 1.0e-3);
        assert_eq!(full.saturation().per_effort, 2.0e-3);
        assert!(full.has(Delay) && !plain.has(Delay));
        assert_eq!(
            names(&full.without(&full.parts[1])),
            ["inertia", "torque_saturation"]
        );
    }

    #[test]
    fn a_late_log_is_a_delay_below_zero_and_a_model_has_one_of_the_two() {
        let plain = model(&[Inertia]);
        let late = plain.with(found(LoggedLate, 2.0e-3));
        assert_eq!((late.delay_s(), late.logged_late_s()), (-2.0e-3, 2.0e-3));
        let open = |model: &Model, name| model.is_open_to(find(name).unwrap());
        for name in [Delay, LoggedLate] {
            assert!(open(&plain, name));
            assert!(!open(&late, name) && !open(&plain.with(found(Delay, 1.0e-3)), name));
        }
        assert!(!open(&late, Inertia) && open(&late, Stribeck));
        assert!(open(&late.with(found(TorqueRipple, 100.0)), TorqueRipple));
    }

    #[test]
    fn found_effects_come_once_in_the_order_in_which_they_came_in() {
        let full = model(&[Inertia])
            .with(found(Delay, 1.0e-3))
            .with(found(TorqueRipple, 100.0))
            .with(found(Stribeck, 0.01))
            .with(found(TorqueRipple, 300.0));
        assert_eq!(
            full.found(),
            [Delay, TorqueRipple, Stribeck].map(Called::from)
        );
        // Of two ripples one goes, by its period; the other keeps the name.
        let one = full.without(&full.parts[2]);
        assert_eq!(one.parts.len(), 4);
        assert_eq!(one.of(TorqueRipple).unwrap().parameter, 300.0);
    }

    #[test]
    fn parts_are_refined_from_the_forces_outwards() {
        let full = model(&[TorqueSaturation, Delay, Viscous]).with(found(Stribeck, 0.01));
        assert_eq!(full.outwards(), [2, 3, 1, 0]);
    }

    #[test]
    fn another_parameter_leaves_the_other_parts_alone() {
        let full = model(&[Inertia]).with(found(Stribeck, 0.01));
        let moved = full.with_parameter(1, 0.02);
        assert_eq!(
            (full.parts[1].parameter, moved.parts[1].parameter),
            (0.01, 0.02)
        );
        assert!(full.parts[0].is_same(&moved.parts[0]) && !full.parts[1].is_same(&moved.parts[1]));
    }
}
