//! A fitted model: every part with the coefficients of its own columns.
//!
//! A regression gives one list of coefficients, in the order of the columns. Here, and nowhere
//! else, it is cut into the parts' own.

use axis_model::EffectName;

use crate::model::effects::Effect;
use crate::model::inverse::{Model, Part};

/// A model with its coefficients.
#[derive(Clone, Default)]
pub(crate) struct Fitted {
    model: Model,
    own: Vec<Vec<f64>>,
}

/// A part with the coefficients of its own columns.
#[derive(Clone, Copy)]
pub(crate) struct Term<'a> {
    /// The part.
    pub part: &'a Part,
    /// Its coefficients, one a column.
    pub own: &'a [f64],
}

/// A part with half widths of 95 % intervals.
#[derive(Clone)]
pub(crate) struct Estimate {
    /// The part.
    pub part: Part,
    /// Coefficients with their half widths, one a column.
    pub own: Vec<(f64, f64)>,
    /// Half width of its nonlinear parameter, where that is a quantity.
    pub parameter_half_width: Option<f64>,
    /// Half width of what tells its forms apart, where that was found.
    pub form_half_width: Option<f64>,
    /// Half width of its lag, where it has one.
    pub lag_half_width: Option<f64>,
}

/// What of a part is found by a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Searched {
    /// Its nonlinear parameter.
    Parameter,
    /// Its form.
    Form,
    /// Its lag.
    Lag,
}

impl Searched {
    /// What a part may be instead of an effect, in the order of [`Self::of`]; nothing where there
    /// is no choice.
    pub(crate) fn choices(self, effect: &dyn Effect) -> &'static [&'static dyn Effect] {
        match self {
            Self::Parameter => &[],
            Self::Form => effect.forms(),
            Self::Lag => effect.lags(),
        }
    }

    /// What tells them apart.
    pub(crate) fn of(self, effect: &dyn Effect) -> f64 {
        match self {
            Self::Parameter => 0.0,
            Self::Form => effect.form(),
            Self::Lag => effect.lag_s(),
        }
    }

    /// Place of an effect among its choices, where it has one of them.
    pub(crate) fn place(self, effect: &dyn Effect) -> Option<usize> {
        let mut choices = self.choices(effect).iter();
        choices.position(|choice| self.of(*choice) == self.of(effect))
    }
}

/// The first values of a list, taken off it.
fn take<'a, T>(rest: &mut &'a [T], count: usize) -> &'a [T] {
    let (own, others) = rest.split_at(count.min(rest.len()));
    *rest = others;
    own
}

impl Fitted {
    /// A model with the coefficients of its columns.
    #[must_use]
    pub(crate) fn new(model: Model, coefficients: &[f64]) -> Self {
        let mut rest = coefficients;
        let own = model
            .parts
            .iter()
            .map(|part| take(&mut rest, part.width()).to_vec())
            .collect();
        Self { model, own }
    }

    /// The model.
    #[must_use]
    pub(crate) const fn model(&self) -> &Model {
        &self.model
    }

    /// The model, without the coefficients.
    #[must_use]
    pub(crate) fn into_model(self) -> Model {
        self.model
    }

    /// Its parts, each with its own coefficients.
    pub(crate) fn terms(&self) -> impl DoubleEndedIterator<Item = Term<'_>> {
        let pairs = self.model.parts.iter().zip(&self.own);
        pairs.map(|(part, own)| Term { part, own })
    }

    /// Coefficients of the part of a name, where it is in the model.
    #[must_use]
    pub(crate) fn of(&self, name: EffectName) -> Option<&[f64]> {
        let named = self.terms().find(|term| term.part.is(name));
        named.map(|term| term.own)
    }

    /// The same coefficients with another nonlinear parameter of a part.
    #[must_use]
    pub(crate) fn with_parameter(&self, place: usize, parameter: f64) -> Self {
        Self {
            model: self.model.with_parameter(place, parameter),
            own: self.own.clone(),
        }
    }

    /// The same coefficients with another form of a part.
    #[must_use]
    pub(crate) fn with_form(&self, place: usize, form: &'static dyn Effect) -> Self {
        Self {
            model: self.model.with_form(place, form),
            own: self.own.clone(),
        }
    }

    /// Its parts with half widths: those of the columns in their order, and those of what was
    /// searched, by place.
    #[must_use]
    pub(crate) fn estimates(
        &self,
        half_widths: &[f64],
        searched: impl Fn(usize, Searched) -> Option<f64>,
    ) -> Vec<Estimate> {
        let mut rest = half_widths;
        let mut estimate = |(place, term): (usize, Term<'_>)| {
            let half_widths = take(&mut rest, term.own.len());
            let own = term.own.iter().copied().zip(half_widths.iter().copied());
            Estimate {
                part: term.part.clone(),
                own: own.collect(),
                parameter_half_width: searched(place, Searched::Parameter),
                form_half_width: searched(place, Searched::Form),
                lag_half_width: searched(place, Searched::Lag),
            }
        };
        self.terms().enumerate().map(&mut estimate).collect()
    }
}

impl Term<'_> {
    /// This part alone, as a fitted model.
    #[must_use]
    pub(crate) fn alone(&self) -> Fitted {
        let model = Model {
            parts: vec![self.part.clone()],
        };
        Fitted::new(model, self.own)
    }
}

impl Estimate {
    /// Whether what was fitted differs from zero: a coefficient, or the parameter of a part without
    /// columns.
    #[must_use]
    pub(crate) fn is_certain(&self) -> bool {
        if self.own.is_empty() {
            let half_width = self.parameter_half_width;
            return half_width.is_some_and(|half| half < self.part.parameter);
        }
        self.own.iter().any(|(value, half)| value.abs() > *half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{found, model};
    use EffectName::{Coulomb, Delay, FrictionDrift, Inertia, Viscous};

    /// One column, none, two, one.
    fn mixed() -> Fitted {
        let mixed = model(&[Inertia])
            .with(found(Delay, 0.002))
            .with(found(FrictionDrift, 7.0))
            .with(found(Coulomb, 0.0));
        Fitted::new(mixed, &[90.0, 3.0, 4.0, 25.0])
    }

    #[test]
    fn each_part_has_the_coefficients_of_its_own_columns() {
        let fitted = mixed();
        let own: Vec<&[f64]> = fitted.terms().map(|term| term.own).collect();
        assert_eq!(own, [&[90.0][..], &[], &[3.0, 4.0], &[25.0]]);
        assert_eq!(fitted.of(Coulomb), Some(&[25.0][..]));
        assert_eq!(fitted.of(FrictionDrift), Some(&[3.0, 4.0][..]));
        assert_eq!(fitted.of(Viscous), None);
    }

    #[test]
    fn a_part_alone_keeps_its_coefficients_and_its_parameter() {
        let fitted = mixed();
        let drift = fitted.terms().nth(2).unwrap().alone();
        assert_eq!(drift.of(FrictionDrift), Some(&[3.0, 4.0][..]));
        assert_eq!(drift.model().parts[0].parameter, 7.0);
        assert_eq!(drift.terms().count(), 1);
    }

    #[test]
    fn half_widths_go_to_the_columns_in_order_and_to_parameters_by_place() {
        let estimates = mixed().estimates(&[1.0, 0.3, 0.4, 2.5], |place, what| {
            (place == 1 && what == Searched::Parameter).then_some(1.0e-4)
        });
        assert!(estimates.iter().all(|one| one.form_half_width.is_none()));
        assert_eq!(estimates[0].own, [(90.0, 1.0)]);
        assert_eq!(estimates[2].own, [(3.0, 0.3), (4.0, 0.4)]);
        assert_eq!(estimates[3].own, [(25.0, 2.5)]);
        let widths: Vec<Option<f64>> = estimates
            .iter()
            .map(|estimate| estimate.parameter_half_width)
            .collect();
        assert_eq!(widths, [None, Some(1.0e-4), None, None]);
    }

    #[test]
    fn an_estimate_is_certain_where_one_of_its_intervals_excludes_zero() {
        let estimate = |own: &[(f64, f64)], parameter_half_width| Estimate {
            part: found(Delay, 0.002),
            own: own.to_vec(),
            parameter_half_width,
            form_half_width: None,
            lag_half_width: None,
        };
        for (own, half_width, certain) in [
            (&[(3.0, 3.0)][..], None, false),
            (&[(-3.0, 2.9)], None, true),
            (&[(0.1, 3.0), (4.0, 3.9)], None, true),
            // Columns count, not the parameter, where there are columns.
            (&[(0.1, 3.0)], Some(1.0e-9), false),
            (&[], Some(0.0019), true),
            (&[], Some(0.002), false),
            (&[], None, false),
        ] {
            let one = estimate(own, half_width);
            assert_eq!(one.is_certain(), certain, "{own:?} {half_width:?}");
        }
    }

    #[test]
    fn another_parameter_leaves_the_coefficients_as_they_are() {
        let moved = mixed().with_parameter(1, 0.003);
        assert_eq!(moved.model().delay_s(), 0.003);
        assert_eq!(moved.of(Inertia), Some(&[90.0][..]));
        assert_eq!(moved.into_model().parts.len(), 4);
    }
}
