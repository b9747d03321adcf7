//! The library of effects: one file each, one list.
//!
//! An effect of the inverse model gives columns for the regression, at most one nonlinear parameter
//! with its grid, and a test whether what was fitted is physical. Adding one touches its file and
//! [`LIBRARY`].

use std::ops::Range;

use axis_model::EffectName;

use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::units::AxisKind;
use by_motion::Others;
use stribeck::Stribeck;

pub(crate) mod by_motion;
pub(crate) mod coulomb;
pub(crate) mod curve;
pub(crate) mod delay;
pub(crate) mod few_periods;
pub(crate) mod friction_drift;
pub(crate) mod hum;
pub(crate) mod inertia;
pub(crate) mod load_dependent_friction;
pub(crate) mod load_inertia;
pub(crate) mod logged_late;
pub(crate) mod offset;
pub(crate) mod payload;
pub(crate) mod polynomial;
pub(crate) mod position_dependent_friction;
pub(crate) mod position_dependent_inertia;
pub(crate) mod quadratic_drag;
pub(crate) mod spring;
pub(crate) mod stribeck;
pub(crate) mod torque_constant_ripple;
pub(crate) mod torque_ripple;
pub(crate) mod torque_saturation;
pub(crate) mod trend;
pub(crate) mod turning;
pub(crate) mod viscous;
pub(crate) mod viscous_asymmetry;
pub(crate) mod wave;

/// What an effect may need to know besides the motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting<'a> {
    /// The axis.
    pub dataset: &'a Dataset,
    /// Residual of the present model, low-passed; empty where columns are made for prediction.
    pub residual: &'a [f64],
}

/// What was fitted so far, for the physical test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fitted<'a> {
    /// The nonlinear parameter.
    pub parameter: f64,
    /// Coefficients of this effect's columns.
    pub own: &'a [f64],
    /// Inertia of the same fit.
    pub inertia: f64,
    /// Coulomb coefficient of the same fit.
    pub coulomb: f64,
    /// Viscous coefficient of the same fit.
    pub viscous: f64,
}

/// A parameter for people.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Named {
    /// Name, with the effect's name in front where it has several.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Half width of its 95 % interval, where there is one.
    pub half_width: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// How an effect's parameters are named.
pub(crate) struct Naming<'a> {
    /// Nonlinear parameter.
    pub parameter: f64,
    /// Half width of its 95 % interval, where it was found.
    pub parameter_half_width: Option<f64>,
    /// Half width of the 95 % interval of its form ([`Effect::form`]), where that was found.
    pub form_half_width: Option<f64>,
    /// Half width of the 95 % interval of its lag ([`Effect::lag_s`]), where that was found.
    pub lag_half_width: Option<f64>,
    /// Coefficients with the half widths of their intervals.
    pub coefficients: &'a [(f64, f64)],
    /// The axis.
    pub dataset: &'a Dataset,
}

impl Naming<'_> {
    /// Unit of effort divided (or multiplied) by something.
    #[must_use]
    pub(crate) fn effort_unit(&self, rest: &str) -> String {
        format!("{}{rest}", self.dataset.effort.unit())
    }

    /// "m" or "rad".
    #[must_use]
    pub(crate) const fn length(&self) -> &'static str {
        match self.dataset.kind {
            AxisKind::Linear => "m",
            AxisKind::Rotary => "rad",
        }
    }

    /// A coefficient by place.
    #[must_use]
    pub(crate) fn coefficient(&self, name: &str, place: usize, unit: String) -> Named {
        let (value, half_width) = self.coefficients.get(place).copied().unwrap_or((0.0, 0.0));
        Named {
            name: name.into(),
            value,
            half_width: Some(half_width),
            unit,
        }
    }

    /// A quantity that is proportional to the nonlinear parameter, or to one over it.
    #[must_use]
    pub(crate) fn nonlinear(&self, name: &str, value: f64, unit: String) -> Named {
        let half_width = self
            .parameter_half_width
            .map(|half| half * (value / self.parameter).abs());
        Named {
            name: name.into(),
            value,
            half_width,
            unit,
        }
    }
}

/// Where a simulated axis stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Instant {
    /// Position.
    pub position: f64,
    /// Position over the travel of the training record, −1…1.
    pub scaled: f64,
    /// Velocity.
    pub velocity: f64,
    /// What is left of a fall that lags.
    pub left: Option<f64>,
    /// Time since the start of the record, s.
    pub time_s: f64,
    /// Time over the duration of the training record.
    pub time_share: f64,
    /// Effort on the motor, without what acts against it there. Like what comes next, only effects
    /// that follow the load are told it.
    pub effort: f64,
    /// Friction level of the axis over its Coulomb friction.
    pub surface: f64,
    /// Force against the motor by all effects that do not follow the load, the inertia apart.
    pub resistance: f64,
}

/// What an effect does to a simulated axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Action {
    /// Part of the friction level, which acts against motion and holds at rest.
    pub level: f64,
    /// Force against positive motion, whatever the direction.
    pub force: f64,
    /// Mass that moves along beside the axis' own.
    pub mass: f64,
}

impl Action {
    /// A part of the friction level.
    #[must_use]
    pub(crate) const fn level(level: f64) -> Self {
        Self {
            level,
            force: 0.0,
            mass: 0.0,
        }
    }

    /// A force.
    #[must_use]
    pub(crate) const fn force(force: f64) -> Self {
        Self {
            level: 0.0,
            force,
            mass: 0.0,
        }
    }
}

/// What an effect does to a simulated axis at every place and at every time alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Steady {
    /// Part of the friction level.
    pub level: f64,
    /// Force against positive motion.
    pub force: f64,
    /// Force by the velocity.
    pub by_velocity: f64,
    /// Force by its magnitude.
    pub by_speed: f64,
}

impl Steady {
    /// What it is at a velocity.
    #[inline]
    #[must_use]
    pub(crate) fn at(&self, velocity: f64) -> Action {
        Action {
            level: self.level,
            force: self.force + self.by_velocity * velocity + self.by_speed * velocity.abs(),
            mass: 0.0,
        }
    }

    /// This and another one.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            level: self.level + other.level,
            force: self.force + other.force,
            by_velocity: self.by_velocity + other.by_velocity,
            by_speed: self.by_speed + other.by_speed,
        }
    }
}

/// What an effect is best seen against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Against {
    /// Velocity.
    Velocity,
    /// Position.
    Position,
    /// Position within one period of the nonlinear parameter.
    Period,
    /// Time.
    Time,
}

/// Where between motion and recorded effort an effect acts, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// A force: columns of the regression.
    Force,
    /// When the effort acts.
    Time,
    /// What the drive makes of a command.
    Actuator,
}

/// An effect of the inverse model.
pub(crate) trait Effect: Sync {
    /// What it is called. A structure without a name keeps named effects from absorbing it, and
    /// leads to `unexplained`.
    fn called(&self) -> Called;

    /// The equation, for people.
    fn equation(&self) -> &'static str;

    /// Columns at a nonlinear parameter.
    fn columns(&self, motion: &Kinematics, dataset: &Dataset, parameter: f64) -> Vec<Vec<f64>>;

    /// Columns beside the other effects of a model, by what these did in an earlier fit: for an
    /// effect that is a factor of their forces.
    fn columns_beside(
        &self,
        motion: &Kinematics,
        dataset: &Dataset,
        parameter: f64,
        _others: &Others,
    ) -> Vec<Vec<f64>> {
        self.columns(motion, dataset, parameter)
    }

    /// What it does to a simulated axis; `own` are the coefficients of its columns.
    fn action(&self, at: &Instant, _parameter: f64, own: &[f64]) -> Action {
        let steady = self.steady(own);
        steady.map_or_else(Action::default, |steady| steady.at(at.velocity))
    }

    /// The same, where it is so at every place and time. Such an effect acts on the load's side;
    /// the one that has a level is Coulomb friction.
    fn steady(&self, _own: &[f64]) -> Option<Steady> {
        None
    }

    /// Number of columns at a nonlinear parameter.
    fn width(&self, _parameter: f64) -> usize {
        1
    }

    /// Whether the nonlinear parameter is a quantity (and not a choice, or nothing).
    fn is_tuned(&self) -> bool {
        false
    }

    /// Forms of the same effect in the order of [`Effect::form`], the usual one last; it is one of
    /// them. Empty where there is no choice.
    fn forms(&self) -> &'static [&'static dyn Effect] {
        &[]
    }

    /// The same form with a size of its own for each direction, where there is one.
    fn by_direction(&self) -> Option<&'static dyn Effect> {
        None
    }

    /// What tells its forms apart: an exponent.
    fn form(&self) -> f64 {
        0.0
    }

    /// The same form with each lag, the first of which is none. Empty where it has no state.
    fn lags(&self) -> &'static [&'static dyn Effect] {
        &[]
    }

    /// Time in which 63 % of a change of its level has come, s.
    fn lag_s(&self) -> f64 {
        0.0
    }

    /// The same form with a lag that is so much longer at rest, as a share, where there is one.
    fn lag_growing(&self, _growth: f64) -> Option<&'static dyn Effect> {
        None
    }

    /// By how much longer its lag is at rest, as a share.
    fn lag_growth(&self) -> f64 {
        0.0
    }

    /// The same effect with fewer periods within the travel than tell themselves ([`few_periods`]).
    fn with_few_periods(&self) -> &'static [&'static dyn Effect] {
        &[]
    }

    /// What it must not be taken for where it has few periods within the travel: the same with a
    /// polynomial over position, whose nonlinear parameter is the degree.
    fn smooth(&self) -> Option<&'static dyn Effect> {
        None
    }

    /// Start values of the nonlinear parameter; one dummy value where there is none.
    fn grid(&self, _motion: &Kinematics, _setting: &Setting<'_>) -> Vec<f64> {
        vec![0.0]
    }

    /// Start value of the nonlinear parameter where a dataset declares the effect.
    fn start(&self, _dataset: &Dataset) -> f64 {
        0.0
    }

    /// Whether a declared effect of another name is the same column.
    fn stands_for(&self, _declared: EffectName) -> bool {
        false
    }

    /// Where between motion and recorded effort it acts.
    fn stage(&self) -> Stage {
        Stage::Force
    }

    /// Whether it must hold at the lower cut-off too: what comes back through the loop (rounding of
    /// an encoder, blows of a gap) imitates it at the higher one.
    fn is_judged_slow_too(&self) -> bool {
        false
    }

    /// For a wave over position: about where it is strongest in what is left, of so many periods
    /// within the travel. Nothing for what is no wave.
    fn strongest(
        &self,
        _motion: &Kinematics,
        _setting: &Setting<'_>,
        _periods: Range<f64>,
    ) -> Vec<f64> {
        Vec::new()
    }

    /// First step of the descent about the best of the grid; zero where there is nothing to refine.
    fn first_step(&self, _motion: &Kinematics, _parameter: f64) -> f64 {
        0.0
    }

    /// First step of the joint refinement with other effects: what the grid left is small by then.
    fn later_step(&self, motion: &Kinematics, parameter: f64) -> f64 {
        0.3 * self.first_step(motion, parameter)
    }

    /// Step of the derivative by the nonlinear parameter, for its interval.
    fn derivative_step(&self, parameter: f64) -> f64 {
        1.0e-4 * parameter
    }

    /// How far apart the nonlinear parameters of two of its kind must be, where it repeats.
    fn least_distance(&self, _motion: &Kinematics) -> f64 {
        0.0
    }

    /// Bounds of the nonlinear parameter.
    fn bounds(&self, _motion: &Kinematics) -> (f64, f64) {
        (f64::MIN_POSITIVE, f64::MAX)
    }

    /// Whether what was fitted can be this effect.
    fn is_physical(&self, _fitted: &Fitted<'_>) -> bool {
        true
    }

    /// What it must beat by the rule of the evidence, at the same nonlinear parameter: itself
    /// without what it is named after, and other causes that nearly look like it.
    fn look_alikes(&self) -> &'static [&'static dyn Effect] {
        &[]
    }

    /// Listed effects that it must beat, each at its own best.
    fn rivals(&self) -> &'static [EffectName] {
        &[]
    }

    /// Whether it is one of the nearest outsiders of the list: a name that comes in only where no
    /// listed one is as good.
    fn is_nearest_outsider(&self) -> bool {
        false
    }

    /// Whether one of its columns is a part of the friction level, which holds at rest and bends
    /// before it slips.
    fn is_level(&self, _column: usize) -> bool {
        false
    }

    /// The law of a level that falls with velocity; `None` where it does not fall.
    fn fall(&self) -> Option<Stribeck> {
        None
    }

    /// Whether it acts on the motor and its screw rather than on the load.
    fn acts_on_motor(&self) -> bool {
        false
    }

    /// Whether it needs to know the forces of the other effects ([`Instant::effort`],
    /// [`Effect::columns_beside`]).
    fn follows_load(&self) -> bool {
        false
    }

    /// Whether it is a mass in motion: a simulation has it in its state, not among the forces.
    fn is_mass(&self) -> bool {
        false
    }

    /// Whether it may be found more than once (ripple orders).
    fn repeats(&self) -> bool {
        false
    }

    /// Whether it may go again: two of it may show together where one alone does not.
    fn comes_and_goes(&self) -> bool {
        false
    }

    /// What it is best seen against.
    fn against(&self) -> Against {
        Against::Velocity
    }

    /// Its parameters for people.
    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named>;
}

/// Every effect of the inverse model; the first four are the usual declared ones.
pub(crate) static LIBRARY: [&dyn Effect; 20] = [
    &inertia::Inertia,
    &viscous::Viscous,
    &coulomb::Coulomb,
    &offset::Offset,
    &viscous_asymmetry::ViscousAsymmetry,
    &stribeck::GAUSSIAN,
    &torque_ripple::TorqueRipple,
    &position_dependent_friction::PositionDependentFriction,
    friction_drift::BOTH_WAYS,
    &quadratic_drag::QuadraticDrag,
    load_dependent_friction::OWN_SURFACE,
    &payload::Payload,
    &position_dependent_inertia::PositionDependentInertia,
    &torque_constant_ripple::TorqueConstantRipple,
    &spring::Spring,
    &hum::Hum,
    &trend::Trend,
    &delay::Delay,
    &logged_late::LoggedLate,
    &torque_saturation::TorqueSaturation,
];

/// The effect that is called so, where it is one of the inverse model.
#[must_use]
pub(crate) fn find(called: impl Into<Called>) -> Option<&'static dyn Effect> {
    let called = called.into();
    LIBRARY.into_iter().find(|effect| effect.called() == called)
}

/// `count` values from `low` to `high` with a constant ratio.
#[must_use]
pub(crate) fn geometric(low: f64, high: f64, count: u32) -> Vec<f64> {
    let ratio = (high / low).powf(1.0 / f64::from(count.max(2) - 1));
    (0..count)
        .map(|i| low * ratio.powi(i32::try_from(i).unwrap_or(0)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, usual};
    use EffectName::{
        Coulomb, Delay, FrictionDrift, Inertia, LoggedLate, Offset, Payload,
        PositionDependentFriction, PositionDependentInertia, QuadraticDrag, Stribeck,
        TorqueConstantRipple, TorqueRipple, TorqueSaturation, Viscous, ViscousAsymmetry,
    };
    use std::f64::consts::PI;

    #[test]
    fn what_is_the_same_everywhere_acts_on_the_load_and_its_level_is_coulombs() {
        let own = [2.0, 3.0];
        let mut called = Vec::new();
        for effect in LIBRARY {
            let Some(steady) = effect.steady(&own) else {
                continue;
            };
            called.push(effect.called());
            assert!(!effect.acts_on_motor() && !effect.comes_and_goes());
            let is_coulomb = effect.called() == Coulomb;
            assert_eq!(steady.level != 0.0, is_coulomb, "{:?}", effect.called());
        }
        let wanted = [Coulomb, Viscous, Offset, ViscousAsymmetry];
        assert!(
            wanted
                .iter()
                .all(|name| called.contains(&Called::from(*name)))
        );
        assert_eq!(called.len(), wanted.len());
        let both = Steady {
            force: 1.0,
            by_velocity: 2.0,
            ..Steady::default()
        };
        let more = Steady {
            level: 5.0,
            by_speed: 3.0,
            ..Steady::default()
        };
        let action = both.and(more).at(-2.0);
        assert_eq!((action.level, action.force), (5.0, 3.0));
    }

    /// A parameter at which each effect is tried.
    fn parameter(effect: &dyn Effect) -> f64 {
        match effect.called() {
            Called::Effect(Stribeck) => 0.02,
            Called::Effect(TorqueRipple | TorqueConstantRipple) => 120.0,
            Called::Effect(PositionDependentInertia) => 12.0,
            Called::Effect(FrictionDrift) => 2.0,
            Called::Structure("force over time") => 3.0,
            Called::Effect(PositionDependentFriction) | Called::Structure(_) => 2.0,
            Called::Effect(_) => 0.0,
        }
    }

    #[test]
    fn an_effect_is_the_same_force_in_the_fit_and_in_the_simulation() {
        let axis = axis(usual);
        let (motion, dataset) = (&axis.motion, &axis.dataset);
        let (middle, half) = dataset.travel();
        let force = |effect: &&&dyn Effect| {
            effect.stage() == Stage::Force && !effect.is_mass() && !effect.follows_load()
        };
        for effect in LIBRARY.iter().filter(force) {
            let parameter = parameter(*effect);
            let columns = effect.columns(motion, dataset, parameter);
            let own: Vec<f64> = (0..columns.len()).map(|i| 2.0 - 5.0 * i as f64).collect();
            for row in [700, 1500, 3300] {
                let at = Instant {
                    position: motion.position_lp[row],
                    scaled: (motion.position_lp[row] - middle) / half,
                    velocity: motion.velocity_lp[row],
                    time_s: motion.time_s[row],
                    time_share: motion.time_s[row] / 6.0,
                    ..Instant::default()
                };
                let Action { level, force, mass } = effect.action(&at, parameter, &own);
                let simulated =
                    level * motion.direction[row] + force + mass * motion.acceleration[row];
                let pairs = columns.iter().zip(&own);
                let fitted: f64 = pairs.map(|(column, own)| own * column[row]).sum();
                let error = (fitted - simulated).abs();
                assert!(error < 2.0e-3, "{} {fitted} {simulated}", effect.called());
            }
        }
    }

    #[test]
    fn the_width_of_an_effect_is_the_number_of_its_columns() {
        let axis = axis(usual);
        for effect in LIBRARY {
            for parameter in [0.5, 1.0, 2.0] {
                let columns = effect.columns(&axis.motion, &axis.dataset, parameter);
                assert_eq!(
                    columns.len(),
                    effect.width(parameter),
                    "{}",
                    effect.called()
                );
                assert!(
                    columns
                        .iter()
                        .all(|column| column.len() == axis.motion.len())
                );
            }
        }
    }

    #[test]
    fn each_name_stands_once_in_the_library() {
        let names: std::collections::BTreeSet<Called> =
            LIBRARY.iter().map(|effect| effect.called()).collect();
        assert_eq!(names.len(), LIBRARY.len());
        for effect in LIBRARY {
            let found = find(effect.called()).unwrap();
            assert_eq!(found.equation(), effect.equation());
        }
        assert!(find(EffectName::Backlash).is_none());
    }

    /// What an effect does at 0.05 m/s, 30 mm (u = 0.5) and 2 s, with coefficients 3 and 4.
    fn at(name: EffectName, parameter: f64) -> (f64, f64) {
        let at = Instant {
            position: 0.030,
            scaled: 0.5,
            velocity: -0.05,
            time_s: 2.0,
            time_share: 0.25,
            ..Instant::default()
        };
        let effect = find(name).unwrap();
        let own = &[3.0, 4.0, 5.0][..effect.width(parameter)];
        let Action { level, force, mass } = effect.action(&at, parameter, own);
        assert_eq!(
            mass != 0.0,
            matches!(name, Payload | PositionDependentInertia)
        );
        (level, force)
    }

    #[test]
    fn each_effect_has_the_value_of_its_equation() {
        let e = (-1.0_f64).exp();
        let table = [
            (Inertia, 0.0, (0.0, 0.0)),
            (Coulomb, 0.0, (3.0, 0.0)),
            (Viscous, 0.0, (0.0, -0.15)),
            (Offset, 0.0, (0.0, 3.0)),
            (ViscousAsymmetry, 0.0, (0.0, 0.15)),
            (QuadraticDrag, 0.0, (0.0, -0.0075)),
            (Stribeck, 0.05, (3.0 * e, 0.0)),
            (FrictionDrift, 2.0, (3.0 * e, -0.2 * e)),
            // 25 periods per metre: three quarters of one at 30 mm.
            (TorqueRipple, 25.0, (0.0, -4.0)),
            (PositionDependentFriction, 2.0, (2.5, 0.0)),
            (Payload, 1.0, (4.0, 5.0)),
            // Half a slope of π k (b cos − a sin) with v² = 0.0025.
            (
                PositionDependentInertia,
                25.0,
                (0.0, 25.0 * PI * 3.0 * 0.0025),
            ),
        ];
        for (name, parameter, wanted) in table {
            let (level, force) = at(name, parameter);
            let error = (level - wanted.0).abs().max((force - wanted.1).abs());
            assert!(error < 1.0e-9, "{name}: {level} {force}");
        }
    }

    fn named(name: EffectName, parameter: f64) -> Vec<Named> {
        let axis = axis(|_, _| 0.0);
        let naming = Naming {
            parameter,
            parameter_half_width: Some(0.1 * parameter),
            form_half_width: None,
            lag_half_width: None,
            coefficients: &[(3.0, 0.3), (4.0, 0.4)],
            dataset: &Dataset {
                lead_m_per_rev: Some(0.01),
                ..axis.dataset
            },
        };
        find(name).unwrap().parameters(&naming)
    }

    #[test]
    fn parameters_have_the_names_and_units_that_reports_are_read_by() {
        let units = |name, parameter| -> Vec<(String, String)> {
            let named = named(name, parameter).into_iter();
            named.map(|named| (named.name, named.unit)).collect()
        };
        let pair = |name: &str, unit: &str| (name.to_owned(), unit.to_owned());
        assert_eq!(units(Inertia, 0.0), [pair("inertia", "N s2/m")]);
        assert_eq!(units(Viscous, 0.0), [pair("viscous", "N s/m")]);
        assert_eq!(units(Coulomb, 0.0), [pair("coulomb", "N")]);
        assert_eq!(units(Offset, 0.0), [pair("offset", "N")]);
        assert_eq!(
            units(ViscousAsymmetry, 0.0),
            [pair("viscous_asymmetry", "N s/m")]
        );
        assert_eq!(
            units(QuadraticDrag, 0.0),
            [pair("quadratic_drag", "N s2/m2")]
        );
        assert_eq!(units(Delay, 1.0e-3), [pair("delay", "s")]);
        assert_eq!(
            units(TorqueSaturation, 1.0e-3),
            [pair("torque_saturation", "1/N")]
        );
        let stribeck = [
            pair("stribeck_excess", "N"),
            pair("stribeck_velocity", "m/s"),
        ];
        assert_eq!(units(Stribeck, 0.01), stribeck);
    }

    #[test]
    fn a_ripple_has_amplitude_period_order_and_phase_with_their_intervals() {
        // 3 cos + 4 sin = 5 sin(θ + atan2(3, 4)); 200 periods per metre, 10 mm per revolution.
        let named = named(TorqueRipple, 200.0);
        let wanted = [
            ("torque_ripple_amplitude", 5.0, 0.5),
            ("torque_ripple_period", 0.005, 0.0005),
            ("torque_ripple_order", 2.0, 0.2),
            ("torque_ripple_phase", 3.0_f64.atan2(4.0), 0.1),
        ];
        for (named, (name, value, half)) in named.iter().zip(wanted) {
            assert_eq!(named.name, name);
            assert!((named.value - value).abs() < 1.0e-12, "{named:?}");
            assert!(
                (named.half_width.unwrap() - half).abs() < 1.0e-12,
                "{named:?}"
            );
        }
        assert_eq!(named.len(), 4);
        assert!(named[3].value.abs() < PI);
    }

    #[test]
    fn what_cannot_be_its_effect_is_not_taken_for_it() {
        let physical = |name, parameter, own: &[f64]| {
            find(name).unwrap().is_physical(&Fitted {
                parameter,
                own,
                inertia: 90.0,
                coulomb: 10.0,
                viscous: 100.0,
            })
        };
        for (name, parameter, own, wanted) in [
            (Stribeck, 0.01, &[39.9][..], true),
            (Stribeck, 0.01, &[40.1], false),
            (Stribeck, 0.01, &[-0.1], false),
            (QuadraticDrag, 0.0, &[0.1], true),
            (QuadraticDrag, 0.0, &[-0.1], false),
            (Delay, 1.01e-4, &[], true),
            (Delay, 0.99e-4, &[], false),
            (Delay, -2.0e-3, &[], false),
            (LoggedLate, 1.51e-4, &[], true),
            (LoggedLate, 1.49e-4, &[], false),
            (LoggedLate, -2.0e-3, &[], false),
            (TorqueConstantRipple, 100.0, &[0.3, 0.39], true),
            (TorqueConstantRipple, 100.0, &[0.3, 0.41], false),
            (TorqueSaturation, 1.0e-6, &[], true),
            (TorqueSaturation, 0.0, &[], false),
            (TorqueRipple, 100.0, &[-1.0, 2.0], true),
        ] {
            assert_eq!(
                physical(name, parameter, own),
                wanted,
                "{name} {parameter} {own:?}"
            );
        }
    }

    #[test]
    fn a_geometric_grid_has_both_ends_and_one_ratio() {
        let grid = geometric(1.0e-3, 1.0, 4);
        let wanted = [1.0e-3, 1.0e-2, 0.1, 1.0];
        assert_eq!(grid.len(), 4);
        for (value, wanted) in grid.iter().zip(wanted) {
            assert!((value / wanted - 1.0).abs() < 1.0e-9, "{grid:?}");
        }
    }
}
