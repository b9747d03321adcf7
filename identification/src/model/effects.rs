//! The library of effects: one file each, one list.
//!
//! An effect of the inverse model gives columns for the regression, at most one nonlinear parameter
//! with its grid, and a test whether what was fitted is physical. Adding one touches its file and
//! [`LIBRARY`].

use axis_model::EffectName;

use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::units::AxisKind;

pub(crate) mod coulomb;
pub(crate) mod delay;
pub(crate) mod friction_drift;
pub(crate) mod hum;
pub(crate) mod inertia;
pub(crate) mod load_inertia;
pub(crate) mod offset;
pub(crate) mod position_dependent_friction;
pub(crate) mod quadratic_drag;
pub(crate) mod spring;
pub(crate) mod stribeck;
pub(crate) mod torque_ripple;
pub(crate) mod torque_saturation;
pub(crate) mod trend;
pub(crate) mod viscous;
pub(crate) mod viscous_asymmetry;

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
    /// Time since the start of the record, s.
    pub time_s: f64,
    /// Time over the duration of the training record.
    pub time_share: f64,
}

/// What an effect does to a simulated axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Action {
    /// Part of the friction level, which acts against motion and holds at rest.
    pub level: f64,
    /// Force against positive motion, whatever the direction.
    pub force: f64,
}

impl Action {
    /// A part of the friction level.
    #[must_use]
    pub(crate) const fn level(level: f64) -> Self {
        Self { level, force: 0.0 }
    }

    /// A force.
    #[must_use]
    pub(crate) const fn force(force: f64) -> Self {
        Self { level: 0.0, force }
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

    /// What it does to a simulated axis; `own` are the coefficients of its columns.
    fn action(&self, _at: &Instant, _parameter: f64, _own: &[f64]) -> Action {
        Action::default()
    }

    /// Number of columns at a nonlinear parameter.
    fn width(&self, _parameter: f64) -> usize {
        1
    }

    /// Whether the nonlinear parameter is a quantity (and not a choice, or nothing).
    fn is_tuned(&self) -> bool {
        false
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

    /// Whether it must hold at the lower cut-off too: quantisation that comes back through the loop
    /// imitates it at the higher one.
    fn is_judged_slow_too(&self) -> bool {
        false
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

    /// Whether all its columns are parts of the friction level, which holds at rest.
    fn is_level(&self) -> bool {
        false
    }

    /// Whether it acts on the motor and its screw rather than on the load.
    fn acts_on_motor(&self) -> bool {
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

    /// What it is best seen against.
    fn against(&self) -> Against {
        Against::Velocity
    }

    /// Its parameters for people.
    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named>;
}

/// Every effect of the inverse model; the first four are the usual declared ones.
pub(crate) static LIBRARY: [&dyn Effect; 15] = [
    &inertia::Inertia,
    &viscous::Viscous,
    &coulomb::Coulomb,
    &offset::Offset,
    &viscous_asymmetry::ViscousAsymmetry,
    &stribeck::Stribeck,
    &torque_ripple::TorqueRipple,
    &position_dependent_friction::PositionDependentFriction,
    &friction_drift::FrictionDrift,
    &quadratic_drag::QuadraticDrag,
    &spring::Spring,
    &hum::Hum,
    &trend::Trend,
    &delay::Delay,
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
