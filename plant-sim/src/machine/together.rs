//! One axis of a machine file: its tables made one, and what has to go together across them.

use axis_model::EffectName;
use toml::Spanned;

use super::MachineAxis;
use super::actual::{self, Actual, Side};
use super::forms::{
    ActuatorForm, AxisForm, DeclaredForm, EncodersForm, Gains, Geometry, LONGEST_PERIOD_S, Limits,
    MechanicsForm,
};
use super::source::{MachineError, Source, Start};
use crate::axis::{AxisParameters, MotorSide, Mounting, SUB_STEP_S};
use crate::brake::BrakeParameters;
use crate::friction::{Law, Sliding};
use crate::mechanics::Mechanics;
use crate::ranges::Quantity;
use crate::stops::{Stops, StopsForm};

/// The tables of an axis, all of them there and each quantity within its range.
struct Tables {
    mechanics: Spanned<MechanicsForm>,
    encoders: Spanned<EncodersForm>,
    actuator: Spanned<ActuatorForm>,
    brake: Option<Spanned<BrakeParameters>>,
    stops: Option<Spanned<StopsForm>>,
    limits: Spanned<Limits>,
    gains: Spanned<Gains>,
    declared: Spanned<DeclaredForm>,
}

/// Reads one axis of those of the file.
pub(super) fn axis(
    source: Source<'_>,
    axis: &Spanned<AxisForm>,
    all: &[Spanned<AxisForm>],
) -> Result<MachineAxis, MachineError> {
    let form = modelled(source, axis, all)?;
    let missing = |table: &str| {
        let text = format!("axis {} lacks [axis.{table}]", form.name);
        source.error(Start::of(axis), "name", text)
    };
    let actual_table = form.actual.clone().ok_or_else(|| missing(FRICTION))?;
    let actual = actual::read(source, &actual_table)?.ok_or_else(|| missing(FRICTION))?;
    let tables = Tables::of(&form, missing)?;
    tables.check(source)?;
    for side in [Some(&actual.table), actual.motor.as_ref()]
        .into_iter()
        .flatten()
    {
        check_friction(source, side)?;
    }
    tables.check_together(source, &actual)?;
    let declared = declared(source, &tables.declared)?;
    Ok(MachineAxis {
        name: form.name.clone(),
        interface: form.interface.clone(),
        force_record_noise_n: tables.actuator.get_ref().force_record_noise_n,
        limits: *tables.limits.get_ref(),
        gains: *tables.gains.get_ref(),
        geometry: geometry(source, form.geometry.as_ref())?,
        actual: tables.parameters(actual),
        declared,
    })
}

/// How an axis stands; true where nothing is said of it.
fn geometry(
    source: Source<'_>,
    form: Option<&Spanned<Geometry>>,
) -> Result<Geometry, MachineError> {
    let Some(table) = form else {
        return Ok(Geometry::default());
    };
    source.check(table)?;
    Ok(*table.get_ref())
}

/// What an axis without friction lacks.
const FRICTION: &str = "actual.sliding], or coulomb_n in [axis.actual.effects";

/// The axis with what it takes from another one.
fn modelled(
    source: Source<'_>,
    axis: &Spanned<AxisForm>,
    all: &[Spanned<AxisForm>],
) -> Result<AxisForm, MachineError> {
    let own = axis.get_ref().clone();
    let Some(like) = own.like.clone() else {
        return Ok(own);
    };
    let mut others = all.iter().map(Spanned::get_ref);
    let model = others.find(|other| other.name == like && other.like.is_none());
    let text = format!("there is no axis \"{like}\" with tables of its own");
    let model = model.ok_or_else(|| source.error(Start::of(axis), "like", text))?;
    Ok(own.like(model))
}

impl Tables {
    fn of(form: &AxisForm, missing: impl Fn(&str) -> MachineError) -> Result<Self, MachineError> {
        let form = form.clone();
        Ok(Self {
            mechanics: form.mechanics.ok_or_else(|| missing("mechanics"))?,
            encoders: form.encoders.ok_or_else(|| missing("encoders"))?,
            actuator: form.actuator.ok_or_else(|| missing("actuator"))?,
            brake: form.brake,
            stops: form.stops,
            limits: form.limits.ok_or_else(|| missing("limits"))?,
            gains: form.gains.ok_or_else(|| missing("gains"))?,
            declared: form.declared.ok_or_else(|| missing("declared"))?,
        })
    }

    /// Each quantity by itself.
    fn check(&self, source: Source<'_>) -> Result<(), MachineError> {
        source.check(&self.mechanics)?;
        source.check(&self.encoders)?;
        source.check(&self.actuator)?;
        source.check(&self.limits)?;
        source.check(&self.gains)?;
        self.brake
            .as_ref()
            .map_or(Ok(()), |table| source.check(table))?;
        self.stops
            .as_ref()
            .map_or(Ok(()), |table| source.check(table))
    }

    /// Quantities with each other.
    fn check_together(&self, source: Source<'_>, actual: &Actual) -> Result<(), MachineError> {
        self.check_sub_step(source, actual)?;
        self.check_increments(source)?;
        self.check_noise(source)?;
        self.check_start(source)?;
        self.check_brake(source)?;
        self.check_stops(source)
    }

    /// The sub-step has to resolve the fastest vibration: ω · dt below one half.
    fn check_sub_step(&self, source: Source<'_>, actual: &Actual) -> Result<(), MachineError> {
        let form = self.mechanics.get_ref();
        let (m1, m2) = (form.motor_inertia_kg, form.table_mass_kg);
        let screw = stiffest(m1 * m2 / (m1 + m2));
        if form.screw_stiffness_n_per_m > screw {
            let text = format!(
                "with these masses the simulation resolves at most {screw:.3e} N/m, got {:.3e}",
                form.screw_stiffness_n_per_m
            );
            return Err(source.error(Start::of(&self.mechanics), "screw_stiffness_n_per_m", text));
        }
        let sides = [
            (Some(&actual.table), m2, "of the table"),
            (actual.motor.as_ref(), m1, "of the motor"),
        ];
        for (side, mass, whose) in sides {
            let most = stiffest(mass);
            let stiff = side.filter(|side| side.law.stiffness_n_per_m() > most);
            if let Some(side) = stiff {
                let text = format!(
                    "with this mass {whose} the simulation resolves friction stiffness up to \
                     {most:.3e} N/m, got {:.3e}",
                    side.law.stiffness_n_per_m()
                );
                return Err(source.error(side.law_at, "law", text));
            }
        }
        Ok(())
    }

    /// The feedback carries the low 32 bits of the increments and the drive unwraps them: one cycle
    /// at the velocity limit, 20 ms at most, has to stay below half of that.
    fn check_increments(&self, source: Source<'_>) -> Result<(), MachineError> {
        let counts_per_rev = f64::from(self.encoders.get_ref().motor_counts_per_rev);
        let counts_per_m = counts_per_rev / self.mechanics.get_ref().lead_m_per_rev;
        let velocity = self.limits.get_ref().velocity_m_per_s;
        let increments = velocity * LONGEST_PERIOD_S * counts_per_m;
        if increments < f64::from(i32::MAX) {
            return Ok(());
        }
        let text = format!(
            "{increments:.3e} increments in 20 ms at the velocity limit: the drive cannot unwrap \
             the 32 bits of the feedback"
        );
        Err(source.error(Start::of(&self.encoders), "motor_counts_per_rev", text))
    }

    /// Noise is less than what the drive can do.
    fn check_noise(&self, source: Source<'_>) -> Result<(), MachineError> {
        let form = self.actuator.get_ref();
        let range = (0.0, form.force_limit_n);
        let acting = Quantity::new("force_noise_n", form.force_noise_n, range);
        let recorded = Quantity::new("force_record_noise_n", form.force_record_noise_n, range);
        let start = Start::of(&self.actuator);
        source.within(start, acting)?;
        source.within(start, recorded)
    }

    /// The axis stands within its travel.
    fn check_start(&self, source: Source<'_>) -> Result<(), MachineError> {
        let travel_m = self.limits.get_ref().travel_m;
        let start_m = self.mechanics.get_ref().start_m;
        let quantity = Quantity::new("start_m", start_m, (-travel_m, travel_m));
        source.within(Start::of(&self.mechanics), quantity)
    }

    /// The rise is a part of the time to close.
    fn check_brake(&self, source: Source<'_>) -> Result<(), MachineError> {
        let Some(table) = &self.brake else {
            return Ok(());
        };
        let form = table.get_ref();
        let rise = Quantity::new("rise_s", form.rise_s, (0.0, form.close_s));
        source.within(Start::of(table), rise)
    }

    /// The stop is not nearer than the start, and the sub-step has to resolve it as well: ω · dt
    /// below one half, and no more than half of the velocity damped away in one.
    fn check_stops(&self, source: Source<'_>) -> Result<(), MachineError> {
        let Some(table) = &self.stops else {
            return Ok(());
        };
        let (form, mechanics) = (table.get_ref(), self.mechanics.get_ref());
        let position_m = form.position_m(self.limits.get_ref().travel_m);
        let mass = mechanics.table_mass_kg;
        let (stiffness, damping) = (form.stop_stiffness_n_per_m, form.stop_damping_n_s_per_m);
        let start_m = mechanics.start_m.abs();
        let quantities = [
            Quantity::new("stop_m", position_m, (start_m, FURTHEST_STOP_M)),
            Quantity::new("stop_stiffness_n_per_m", stiffness, (1.0e3, stiffest(mass))),
            Quantity::new(
                "stop_damping_n_s_per_m",
                damping,
                (0.0, 0.5 * mass / SUB_STEP_S),
            ),
        ];
        let mut quantities = quantities.into_iter();
        quantities.try_for_each(|quantity| source.within(Start::of(table), quantity))
    }

    fn parameters(&self, actual: Actual) -> AxisParameters {
        let (mechanics, encoders) = (self.mechanics.get_ref(), self.encoders.get_ref());
        let actuator = self.actuator.get_ref();
        AxisParameters {
            mechanics: Mechanics {
                motor_inertia_kg: mechanics.motor_inertia_kg,
                table_mass_kg: mechanics.table_mass_kg,
                screw_stiffness_n_per_m: mechanics.screw_stiffness_n_per_m,
                screw_damping_n_s_per_m: mechanics.screw_damping_n_s_per_m,
                backlash_m: mechanics.backlash_m,
            },
            lead_m_per_rev: mechanics.lead_m_per_rev,
            sliding: actual.table.sliding,
            law: actual.table.law,
            motor_side: actual.motor.map(|side| MotorSide {
                sliding: side.sliding,
                law: side.law,
            }),
            effects: actual.effects,
            motor_encoder_counts_per_rev: encoders.motor_counts_per_rev,
            load_encoder_resolution_m: encoders.load_resolution_m,
            current_loop_time_constant_s: actuator.current_loop_time_constant_s,
            force_limit_n: actuator.force_limit_n,
            force_noise_n: actuator.force_noise_n,
            mounting: self.mounting(),
        }
    }

    fn mounting(&self) -> Mounting {
        let (mechanics, encoders) = (self.mechanics.get_ref(), self.encoders.get_ref());
        let travel_m = self.limits.get_ref().travel_m;
        let stops = |table: &Spanned<StopsForm>| -> Stops { table.get_ref().stops(travel_m) };
        Mounting {
            gravity_n: mechanics.gravity_n,
            brake: self.brake.as_ref().map(|table| *table.get_ref()),
            stops: self.stops.as_ref().map(stops),
            start_m: mechanics.start_m,
            motor_zero_m: encoders.motor_zero_m,
            load_zero_m: encoders.load_zero_m,
        }
    }
}

/// Longest travel and a margin.
const FURTHEST_STOP_M: f64 = 10.1;

/// The stiffness that the sub-step resolves at a mass, N/m: ω · dt = ½.
fn stiffest(mass_kg: f64) -> f64 {
    0.25 * mass_kg / (SUB_STEP_S * SUB_STEP_S)
}

/// Least friction level of bristles, N: without friction they have no equation.
const BRISTLE_LEVEL_N: f64 = 1.0e-3;

/// Breakaway is not below sliding, bristles slip at some level, and the elements of Maxwell
/// friction share it.
fn check_friction(source: Source<'_>, side: &Side) -> Result<(), MachineError> {
    let start = side.sliding_at;
    let Sliding {
        coulomb_n,
        static_n,
        ..
    } = side.sliding;
    source.within(
        start,
        Quantity::new("static_n", static_n, (coulomb_n, 1.0e6)),
    )?;
    match &side.law {
        Law::Coulomb => Ok(()),
        Law::LuGre { .. } => {
            let level = Quantity::new("coulomb_n", coulomb_n, (BRISTLE_LEVEL_N, 1.0e6));
            source.within(start, level)
        }
        Law::MaxwellSlip {
            stiffness_n_per_m,
            share,
        } => check_shares(source, side.law_at, stiffness_n_per_m.len(), share),
    }
}

fn check_shares(
    source: Source<'_>,
    start: Start,
    elements: usize,
    share: &[f64],
) -> Result<(), MachineError> {
    if elements == 0 || elements != share.len() {
        let text = "must have as many elements as stiffness_n_per_m, at least one";
        return Err(source.error(start, "share", text));
    }
    let sum: f64 = share.iter().sum();
    if (sum - 1.0).abs() > 1.0e-6 || share.iter().any(|share| *share <= 0.0) {
        return Err(source.error(
            start,
            "share",
            "the shares must be positive and add up to 1",
        ));
    }
    Ok(())
}

fn declared(
    source: Source<'_>,
    table: &Spanned<DeclaredForm>,
) -> Result<Vec<EffectName>, MachineError> {
    let names = table.get_ref().effects.iter();
    names
        .map(|word| {
            let name = word.parse::<EffectName>();
            name.map_err(|error| source.error(Start::of(table), "effects", error))
        })
        .collect()
}
