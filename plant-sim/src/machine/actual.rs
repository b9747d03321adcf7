//! `[axis.actual]`: from the vocabulary to what the simulator computes with.
//!
//! The effects of sliding friction become the sliding curve, presliding becomes a friction law, the
//! others become [`Effects`]. `[axis.actual.sliding]` and `[axis.actual.friction]` state the curve
//! and the law themselves; then the effects of these are not stated again. All that is friction at
//! the table; `[axis.actual.motor_side]` has the two tables of what turns with the motor.

use axis_model::{Effect, Presliding};
use toml::Spanned;

use super::forms::{ActualForm, MotorSideForm};
use super::source::{MachineError, Source, Start};
use crate::effects::Effects;
use crate::friction::{Law, Sliding, gaussian};

/// What an axis really has, besides its mechanics.
pub(super) struct Actual {
    /// Friction at the table.
    pub table: Side,
    /// Friction of what turns with the motor.
    pub motor: Option<Side>,
    pub effects: Effects,
}

/// Friction of one side of the screw.
pub(super) struct Side {
    pub sliding: Sliding,
    pub law: Law,
    /// Where the sliding friction is stated.
    pub sliding_at: Start,
    /// Where the friction law is stated.
    pub law_at: Start,
}

/// Reads `[axis.actual]`; `None` where it states no friction.
pub(super) fn read(
    source: Source<'_>,
    form: &Spanned<ActualForm>,
) -> Result<Option<Actual>, MachineError> {
    let ActualForm {
        sliding,
        friction,
        motor_side,
        effects,
    } = form.get_ref();
    let mut stated = Stated::default();
    if let Some(table) = sliding {
        source.check(table)?;
        stated.curve = Some(*table.get_ref());
    }
    if let Some(table) = friction {
        source.check(table)?;
        stated.law = Some(table.get_ref().clone());
    }
    if let Some(table) = effects {
        let refused = |effect: &Effect, text: &str| {
            let text = format!("the simulator refuses this effect: {text}");
            source.error(Start::of(table), effect.name().as_str(), text)
        };
        for effect in &table.get_ref().0 {
            stated.take(effect).map_err(|text| refused(effect, text))?;
        }
    }
    let effects_at = effects.as_ref().map_or(Start::of(form), Start::of);
    let sliding_at = sliding.as_ref().map_or(effects_at, Start::of);
    let law_at = friction.as_ref().map_or(effects_at, Start::of);
    let motor = motor_side.as_ref().map(|form| side(source, form));
    let motor = motor.transpose()?;
    Ok(stated.actual(sliding_at, law_at, motor))
}

/// Friction of the motor's side, as its tables state it.
fn side(source: Source<'_>, form: &MotorSideForm) -> Result<Side, MachineError> {
    source.check(&form.sliding)?;
    if let Some(table) = &form.friction {
        source.check(table)?;
    }
    let sliding_at = Start::of(&form.sliding);
    let law = form.friction.as_ref();
    Ok(Side {
        sliding: *form.sliding.get_ref(),
        law: law.map_or(Law::Coulomb, |table| table.get_ref().clone()),
        sliding_at,
        law_at: law.map_or(sliding_at, Start::of),
    })
}

/// Why `[axis.actual.effects]` cannot state an effect, and what to do; `None` where it can.
#[must_use]
pub fn refusal(effect: &Effect) -> Option<&'static str> {
    Stated::default().take(effect).err()
}

/// What was stated so far.
#[derive(Default)]
struct Stated {
    /// From `[axis.actual.sliding]`.
    curve: Option<Sliding>,
    /// From `[axis.actual.friction]`.
    law: Option<Law>,
    /// The effects of the sliding curve, in the order of the vocabulary.
    on_curve: Vec<Effect>,
    presliding: Option<Presliding>,
    others: Effects,
}

impl Stated {
    /// Takes an effect to where the simulator has it.
    fn take(&mut self, effect: &Effect) -> Result<(), &'static str> {
        match effect {
            Effect::Presliding(own) => self.take_presliding(*own),
            Effect::Coulomb(_)
            | Effect::Viscous(_)
            | Effect::Stribeck(_)
            | Effect::CoulombAsymmetry(_)
            | Effect::ViscousAsymmetry(_)
            | Effect::QuadraticDrag(_) => self.take_on_curve(*effect),
            _ => self.others.add(*effect).map_err(|refused| refused.text),
        }
    }

    fn take_on_curve(&mut self, effect: Effect) -> Result<(), &'static str> {
        if self.curve.is_some() {
            return Err("[axis.actual.sliding] states it already; leave one of them out");
        }
        let name = effect.name();
        if self.on_curve.iter().any(|other| other.name() == name) {
            return Err("it is stated twice; leave one of them out");
        }
        self.on_curve.push(effect);
        Ok(())
    }

    fn take_presliding(&mut self, presliding: Presliding) -> Result<(), &'static str> {
        if self.law.is_some() {
            return Err("[axis.actual.friction] states it already; leave one of them out");
        }
        if self.presliding.replace(presliding).is_some() {
            return Err("it is stated twice; leave one of them out");
        }
        Ok(())
    }

    /// What was stated, as the simulator computes with it; `None` without friction.
    fn actual(self, sliding_at: Start, law_at: Start, motor: Option<Side>) -> Option<Actual> {
        let has_friction = self.curve.is_some() || !self.on_curve.is_empty();
        let sliding = self.curve.unwrap_or_else(|| curve(&self.on_curve));
        let bristle = || self.presliding.map(|own| bristle(&sliding, own));
        let law = self.law.clone().or_else(bristle).unwrap_or(Law::Coulomb);
        has_friction.then_some(Actual {
            table: Side {
                sliding,
                law,
                sliding_at,
                law_at,
            },
            motor,
            effects: self.others,
        })
    }
}

/// The sliding curve of its effects; Coulomb friction comes before the Stribeck fall.
fn curve(effects: &[Effect]) -> Sliding {
    let mut curve = Sliding::dry(0.0);
    for effect in effects {
        match effect {
            Effect::Coulomb(own) => {
                curve.coulomb_n = own.coulomb;
                curve.static_n = own.coulomb;
            }
            Effect::Stribeck(own) => {
                curve.static_n = curve.coulomb_n + own.excess;
                curve.stribeck_velocity_m_per_s = own.velocity;
                curve.stribeck_exponent = own.exponent.unwrap_or_else(gaussian);
                curve.stribeck_lag_s = own.lag.unwrap_or(0.0);
                curve.stribeck_lag_growth = own.lag_growth.unwrap_or(0.0);
            }
            Effect::Viscous(own) => curve.viscous_n_s_per_m = own.viscous,
            Effect::CoulombAsymmetry(own) => curve.coulomb_asymmetry = own.coulomb_asymmetry,
            Effect::ViscousAsymmetry(own) => curve.viscous_asymmetry = own.viscous_asymmetry,
            Effect::QuadraticDrag(own) => curve.quadratic_drag_n_s2_per_m2 = own.quadratic_drag,
            _ => {}
        }
    }
    curve
}

/// Bristles that slip after a deflection: their stiffness is the level over it.
fn bristle(sliding: &Sliding, presliding: Presliding) -> Law {
    Law::LuGre {
        bristle_stiffness_n_per_m: sliding.coulomb_n / presliding.deflection,
        bristle_damping_n_s_per_m: presliding.damping.unwrap_or(0.0),
    }
}

#[cfg(test)]
mod tests {
    use crate::axis::MotorSide;
    use crate::friction::Law;
    use crate::machine::Machine;

    /// The built-in machine with another `[axis.actual]`.
    fn machine(actual: &str) -> Result<Machine, String> {
        let text = Machine::reference_text();
        let (from, to) = (
            text.find("[axis.actual.sliding]").unwrap(),
            text.find("[axis.declared]").unwrap(),
        );
        let text = format!("{}{actual}\n{}", &text[..from], &text[to..]);
        Machine::parse("m.toml", &text).map_err(|error| error.to_string())
    }

    fn line_of_actual() -> usize {
        let text = Machine::reference_text();
        let actual = |line: &str| line.starts_with("[axis.actual.sliding]");
        text.lines().position(actual).unwrap() + 1
    }

    #[test]
    fn friction_as_effects_says_the_same_as_its_own_tables() {
        let machine = machine(
            "[axis.actual.effects]\ncoulomb_n = 400.0\nviscous_n_s_per_m = 2000.0\n\
             stribeck = { excess_n = 120.0, velocity_m_per_s = 1.5e-3 }\n\
             presliding = { deflection_m = 1.0e-5, damping_n_s_per_m = 3.0e4 }",
        )
        .unwrap();
        assert_eq!(machine, Machine::reference());
    }

    #[test]
    fn a_fall_has_the_exponent_that_is_stated() {
        for (stated, power) in [
            ("", 4.0),
            (", exponent = 1.0", 2.0),
            (", exponent = 0.5", 2.0_f64.sqrt()),
        ] {
            let machine = machine(&format!(
                "[axis.actual.effects]\ncoulomb_n = 400.0\nviscous_n_s_per_m = 0.0\n\
                 stribeck = {{ excess_n = 120.0, velocity_m_per_s = 1.5e-3{stated} }}",
            ));
            let sliding = machine.unwrap().axes[0].actual.sliding;
            let wanted = 400.0 + 120.0 * (-power).exp();
            for v in [3.0e-3, -3.0e-3] {
                assert!((sliding.level_n(v) - wanted).abs() < 1.0e-9, "{stated} {v}");
            }
        }
        let refused = machine(
            "[axis.actual.effects]\ncoulomb_n = 1.0\nstribeck = { excess_n = 1.0, velocity_m_per_s = 1e-3, exponent = 3.0 }",
        );
        assert!(refused.unwrap_err().contains("exponent: must be 0.5 to 2"));
    }

    #[test]
    fn an_effect_that_the_simulator_does_not_have_is_refused_with_line_name_and_what_to_do() {
        let tables = "[axis.actual.sliding]\ncoulomb_n = 1.0\nstatic_n = 1.0\n\
                      stribeck_velocity_m_per_s = 1e-3\nviscous_n_s_per_m = 0.0\n\
                      [axis.actual.effects]\n";
        let refused = |line: &str, text: &str| {
            let error = machine(&format!("{tables}{line}")).unwrap_err();
            let (name, _) = line.split_once([' ', '=']).unwrap();
            let at = line_of_actual() + 6;
            let start = format!("m.toml:{at}: {name}: the simulator refuses this effect: {text}");
            assert!(error.starts_with(&start), "{error}\n{start}");
        };
        refused("backlash = { gap_m = 1e-5 }", "give backlash_m in");
        refused(
            "inertia = { inertia_n_s2_per_m = 1e3 }",
            "give motor_inertia_kg",
        );
        refused(
            "coulomb = { coulomb_n = 1.0 }",
            "[axis.actual.sliding] states it",
        );
        refused(
            "torque_ripple = { amplitude_n = 1.0 }",
            "give order_per_rev or",
        );
        let drift = "friction_drift = { gain = 0.1, time_constant_s = 1.0, viscous_gain = 0.1 }";
        refused(drift, "the simulator's viscous friction does not drift");
    }

    #[test]
    fn the_motors_side_has_tables_of_its_own_with_their_own_errors() {
        let with = |tables: &str| {
            let table = "[axis.actual.sliding]\ncoulomb_n = 1.0\nstatic_n = 1.0\n\
                         stribeck_velocity_m_per_s = 1e-3\nviscous_n_s_per_m = 0.0\n";
            machine(&format!("{table}{tables}"))
        };
        let sliding = "[axis.actual.motor_side.sliding]\ncoulomb_n = 50.0\nstatic_n = 60.0\n\
                       stribeck_velocity_m_per_s = 2e-3\nviscous_n_s_per_m = 300.0\n";
        let bristle = "[axis.actual.motor_side.friction]\nlaw = \"lu-gre\"\n\
                       bristle_stiffness_n_per_m = 1e7\nbristle_damping_n_s_per_m = 0.0\n";
        let motor_side = |tables: &str| with(tables).unwrap().axes[0].actual.motor_side.clone();
        assert_eq!(motor_side(""), None);
        let rigid = motor_side(sliding).unwrap();
        assert_eq!((rigid.sliding.coulomb_n, rigid.law), (50.0, Law::Coulomb));
        let stiffness = |own: &MotorSide| own.law.stiffness_n_per_m();
        let bristled = motor_side(&format!("{sliding}{bristle}"));
        assert_eq!(bristled.as_ref().map(stiffness), Some(1.0e7));

        let at = line_of_actual() + 5;
        let low = sliding.replace("60.0", "40.0");
        let error = with(&low).unwrap_err();
        let start = format!("m.toml:{}: static_n: must be 50 to", at + 2);
        assert!(error.starts_with(&start), "{error}");
        let stiff = format!("{sliding}{}", bristle.replace("1e7", "1e11"));
        let error = with(&stiff).unwrap_err();
        let start = format!("m.toml:{}: law: with this mass of the motor", at + 6);
        assert!(error.starts_with(&start), "{error}");
        assert!(
            with(bristle)
                .unwrap_err()
                .contains("missing field `sliding`")
        );
    }

    #[test]
    fn an_axis_without_friction_is_told_what_it_lacks() {
        let error = machine("[axis.actual.effects]\noffset_n = 1.0").unwrap_err();
        assert!(error.contains("axis X lacks"), "{error}");
        let bristles = "[axis.actual.effects]\npresliding = { deflection_m = 1e-5 }";
        assert!(machine(bristles).unwrap_err().contains("axis X lacks"));
    }
}
