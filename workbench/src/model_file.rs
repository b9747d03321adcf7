//! The identified model as a machine file, which `circle`, `tune` and `plant` accept.
//!
//! `[axis.mechanics]` and `[axis.actual.effects]` are the identified model, in the words of the
//! vocabulary; `[axis.identified]` beside them holds the parameters as they were found, with
//! intervals and units, and says what a record does not: where the split of the masses comes from
//! (`table_mass`), and what the simulator cannot be told (`left_out`). A screw whose stiffness was
//! not identified is stiff for the simulator.

use axis_model::EffectTable;
use identification::{Identification, ParameterTable};
use plant_sim::friction::Law;
use plant_sim::machine::{ActuatorForm, Bus, EncodersForm, Gains, Limits, MechanicsForm, Timing};
use serde::Serialize;

mod known;
mod motor_side;
mod stated;

pub use known::{Known, relation_m};
pub use motor_side::MotorSide;

/// The file.
#[derive(Serialize)]
struct ModelFile {
    name: String,
    seed: u64,
    bus: Bus,
    #[serde(rename = "loop")]
    timing: Timing,
    axis: Vec<AxisTables>,
}

/// One `[[axis]]`: with tables of its own, or like another.
#[derive(Serialize)]
#[serde(untagged)]
enum AxisTables {
    Own(Box<Own>),
    Like { name: String, like: String },
}

#[derive(Serialize)]
struct Own {
    name: String,
    mechanics: MechanicsForm,
    encoders: EncodersForm,
    actuator: ActuatorForm,
    limits: Limits,
    gains: Gains,
    actual: Actual,
    declared: Declared,
    identified: Identified,
}

#[derive(Serialize)]
struct Actual {
    effects: EffectTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    friction: Option<Law>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motor_side: Option<motor_side::Tables>,
}

#[derive(Serialize)]
struct Declared {
    effects: Vec<String>,
}

/// For people: the simulator does not read it.
#[derive(Serialize)]
struct Identified {
    verdict: String,
    table_mass: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<String>,
    #[serde(flatten)]
    parameters: ParameterTable,
}

/// The first line of the file.
const HEAD: &str = "# Identified model: a machine file for circle, tune and plant.\n";
/// The first line where there is no machine file to make.
const HEAD_WITHOUT_MACHINE: &str = "# Identified model. No machine file: the simulator has linear \
                                    axes with efforts in newtons.\n";
/// Bit rate of the bus of each axis: classic CAN at its fastest.
const BUS: Bus = Bus::Classic {
    bit_rate: 1_000_000,
};

/// The machine file of identified axes. One axis gets a second one like it, since a circle needs
/// two.
#[must_use]
pub fn text(name: &str, axes: &[(String, Known, &Identification)]) -> String {
    let period_s = axes.first().map_or(1.0e-3, |(_, known, _)| known.period_s);
    let mut tables: Vec<AxisTables> = axes
        .iter()
        .map(|(name, known, result)| AxisTables::Own(Box::new(Own::of(name, known, result))))
        .collect();
    if let [(name, ..)] = axes {
        tables.push(AxisTables::Like {
            name: format!("{name}2"),
            like: name.clone(),
        });
    }
    let file = ModelFile {
        name: name.into(),
        seed: 1,
        bus: BUS,
        timing: Timing { period_s },
        axis: tables,
    };
    written(HEAD, &file)
}

fn written(head: &str, form: &impl Serialize) -> String {
    let text = toml::to_string(form).expect("the form has nothing that TOML cannot say");
    format!("{head}{text}")
}

impl Own {
    fn of(name: &str, known: &Known, result: &Identification) -> Self {
        let report = &result.report;
        let (mechanics, table_mass) = stated::mechanics(known, &result.effects);
        let motor = MotorSide::of(&report.parameters);
        let motor_kg = mechanics.motor_inertia_kg;
        let curve = report.presliding.as_ref();
        let of_motor = curve.map_or(&[][..], |curve| &curve.motor_elements);
        let motor_side = motor.map(|motor| motor.tables(&result.effects, of_motor, motor_kg));
        let of_table = match motor {
            Some(motor) => motor.left(&result.effects),
            None => result.effects.clone(),
        };
        let friction = stated::friction(curve, &of_table, mechanics.table_mass_kg);
        let mut stated = stated::effects(known, &of_table, mechanics.table_mass_kg);
        if friction.is_some() {
            stated.without_presliding();
        }
        let unknown = report.parameters.unknown.keys();
        let unknown = unknown.filter(|name| !report.parameters.is_used_amid_interval(name));
        stated
            .left_out
            .extend(unknown.map(|name| format!("{name}: unknown")));
        let names = report.declared.iter().chain(&report.found);
        Self {
            name: name.into(),
            mechanics,
            encoders: stated::encoders(known),
            actuator: stated::actuator(known, result),
            limits: known.limits,
            gains: known.gains,
            actual: Actual {
                effects: stated.effects,
                friction,
                motor_side,
            },
            declared: Declared {
                effects: names.cloned().collect(),
            },
            identified: Identified {
                verdict: report.verdict.clone(),
                table_mass,
                left_out: stated.left_out,
                parameters: report.parameters.clone(),
            },
        }
    }
}

/// An axis that the simulator does not have.
#[derive(Serialize)]
struct ParametersOnly<'a> {
    name: &'a str,
    declared: &'a [String],
    found: &'a [String],
    verdict: &'a str,
    identified: &'a ParameterTable,
}

/// Parameters alone, for an axis that the simulator does not have.
#[must_use]
pub fn parameters_only(name: &str, result: &Identification) -> String {
    let report = &result.report;
    let form = ParametersOnly {
        name,
        declared: &report.declared,
        found: &report.found,
        verdict: &report.verdict,
        identified: &report.parameters,
    };
    written(HEAD_WITHOUT_MACHINE, &form)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axis_model::{
        Backlash, Coulomb, Delay, Effect, Estimate, FrictionDrift, Inertia, Presliding,
        TorqueRipple, ViscousAsymmetry,
    };
    use identification::{PreslidingCurve, Report, SlipElement, UnknownParameter};
    use plant_sim::Machine;
    use std::collections::BTreeMap;

    fn estimate(value: f64) -> Estimate {
        Estimate {
            value,
            unit: "N".into(),
            low: value - 1.0,
            high: value + 1.0,
        }
    }

    fn identification(effects: Vec<Effect<Estimate>>) -> Identification {
        Identification {
            effects,
            residual_rms: 3.0,
            report: Report {
                declared: vec!["inertia".into(), "coulomb".into()],
                found: vec!["delay".into()],
                verdict: "explained".into(),
                parameters: ParameterTable {
                    known: BTreeMap::from([("coulomb".into(), estimate(250.0))]),
                    ..ParameterTable::default()
                },
                ..Report::default()
            },
            ..Identification::default()
        }
    }

    /// The file of one axis, and the machine that it is read to.
    fn written(effects: Vec<Effect<Estimate>>) -> (toml::Table, Machine) {
        written_of(&identification(effects))
    }

    fn written_of(result: &Identification) -> (toml::Table, Machine) {
        let machine = Machine::reference();
        let known = Known {
            hold_s: 0.5e-3,
            origin_m: 0.0,
            ..Known::of_machine(&machine.axes[0], machine.period_s)
        };
        let text = text("test", &[("X".into(), known, result)]);
        let machine = Machine::parse("model.toml", &text).unwrap();
        (text.parse().unwrap(), machine)
    }

    fn inertia(inertia: f64, load: Option<f64>) -> Effect<Estimate> {
        let load = load.map(estimate);
        Effect::Inertia(Inertia {
            inertia: estimate(inertia),
            load,
        })
    }

    fn identified(file: &toml::Table) -> &toml::Table {
        file["axis"][0]["identified"].as_table().unwrap()
    }

    #[test]
    fn what_was_identified_is_what_the_simulator_reads() {
        let (file, machine) = written(vec![
            inertia(700.0, Some(300.0)),
            Effect::Coulomb(Coulomb {
                coulomb: estimate(250.0),
            }),
            Effect::ViscousAsymmetry(ViscousAsymmetry {
                viscous_asymmetry: estimate(-0.2),
            }),
            Effect::Delay(Delay {
                delay: estimate(0.8e-3),
            }),
        ]);
        let [x, second] = machine.axes.as_slice() else {
            panic!("a circle needs two axes");
        };
        let mechanics = x.actual.mechanics;
        assert!((mechanics.table_mass_kg - 300.0).abs() < 1.0e-9);
        assert!((mechanics.motor_inertia_kg - 400.0).abs() < 1.0e-9);
        let sliding = x.actual.sliding;
        assert_eq!((sliding.coulomb_n, sliding.static_n), (250.0, 250.0));
        assert_eq!(sliding.viscous_asymmetry, -0.2);
        assert!(
            (x.actual.effects.delay_s() - 0.3e-3).abs() < 1.0e-12,
            "beyond the hold"
        );
        assert_eq!(x.declared.len(), 3);
        assert_eq!((second.name.as_str(), &second.actual), ("X2", &x.actual));
        assert_eq!(
            identified(&file)["table_mass"].as_str(),
            Some("motor and load position")
        );
        assert_eq!(identified(&file)["coulomb"]["high"].as_float(), Some(251.0));
    }

    #[test]
    fn where_the_mass_of_the_table_comes_from_is_said() {
        let gap = Effect::Backlash(Backlash {
            gap: estimate(2.0e-5),
            load_share: Some(estimate(0.3)),
            motor_friction: None,
            restitution: None,
        });
        let (file, machine) = written(vec![inertia(700.0, None), gap]);
        let mechanics = machine.axes[0].actual.mechanics;
        assert!((mechanics.table_mass_kg - 210.0).abs() < 1.0e-9);
        assert_eq!(mechanics.backlash_m, 2.0e-5);
        assert_eq!(
            identified(&file)["table_mass"].as_str(),
            Some("impacts in the gap")
        );
        let (file, machine) = written(vec![inertia(700.0, None)]);
        assert!((machine.axes[0].actual.mechanics.table_mass_kg - 280.0).abs() < 1.0e-9);
        assert_eq!(identified(&file)["table_mass"].as_str(), Some("assumed"));
        assert!(!identified(&file).contains_key("left_out"));
    }

    #[test]
    fn what_the_simulator_cannot_be_told_is_left_out_and_said() {
        let ripple = |phase| {
            Effect::TorqueRipple(TorqueRipple {
                amplitude: estimate(20.0),
                order: Some(estimate(6.0)),
                period: Some(estimate(0.01 / 6.0)),
                phase,
            })
        };
        let drift = Effect::FrictionDrift(FrictionDrift {
            gain: estimate(0.4),
            time_constant: estimate(20.0),
            viscous_gain: Some(estimate(0.1)),
        });
        let effects = vec![ripple(Some(estimate(0.3))), ripple(None), drift];
        let (file, machine) = written([vec![inertia(700.0, None)], effects].concat());
        let left_out = identified(&file)["left_out"].as_array().unwrap();
        let left_out: Vec<&str> = left_out.iter().filter_map(|word| word.as_str()).collect();
        let wanted = [
            "torque_ripple without a phase",
            "viscous_gain of friction_drift",
        ];
        assert_eq!(left_out, wanted);
        assert_eq!(machine.axes[0].actual.effects.list().len(), 2);
    }

    #[test]
    fn what_the_record_does_not_know_is_left_out_and_has_no_value() {
        let mut result = identification(Vec::new());
        let unknown = UnknownParameter {
            unknown: true,
            unit: "N s/m".into(),
            low: 0.0,
            high: 90.0,
            record: "long moves",
        };
        let table = &mut result.report.parameters.unknown;
        table.extend(["inertia", "viscous"].map(|name| (name.to_owned(), unknown.clone())));
        let (file, machine) = written_of(&result);
        let left_out = identified(&file)["left_out"].as_array().unwrap();
        let left_out: Vec<&str> = left_out.iter().filter_map(|word| word.as_str()).collect();
        assert_eq!(left_out, ["inertia: unknown", "viscous: unknown"]);
        let viscous = identified(&file)["viscous"].as_table().unwrap();
        assert_eq!(viscous["unknown"].as_bool(), Some(true));
        assert!(!viscous.contains_key("value"));
        let own = Machine::reference().axes[0].actual.mechanics;
        let mechanics = machine.axes[0].actual.mechanics;
        let moved_kg = |m: plant_sim::mechanics::Mechanics| m.motor_inertia_kg + m.table_mass_kg;
        assert!((moved_kg(mechanics) - moved_kg(own)).abs() < 1.0e-9);
        assert_eq!(machine.axes[0].actual.sliding.viscous_n_s_per_m, 0.0);
    }

    #[test]
    fn bristles_are_not_stiffer_than_the_sub_step_carries() {
        let presliding = Effect::Presliding(Presliding {
            deflection: estimate(1.0e-9),
            damping: None,
        });
        let coulomb = Effect::Coulomb(Coulomb {
            coulomb: estimate(250.0),
        });
        let (_, machine) = written(vec![inertia(700.0, None), coulomb, presliding]);
        let stiffness = machine.axes[0].actual.law.stiffness_n_per_m();
        let most = 0.2 * 280.0 / plant_sim::axis::SUB_STEP_S.powi(2);
        assert!((stiffness / most - 1.0).abs() < 1.0e-9, "{stiffness}");
    }

    #[test]
    fn friction_of_the_motors_side_has_its_tables_and_the_table_has_the_rest() {
        let effects = vec![
            inertia(700.0, None),
            Effect::Coulomb(Coulomb {
                coulomb: estimate(200.0),
            }),
            Effect::Presliding(Presliding {
                deflection: estimate(1.0e-5),
                damping: Some(estimate(4.0e3)),
            }),
        ];
        let mut result = identification(effects);
        for (name, value) in [
            ("motor_coulomb", 50.0),
            ("load_coulomb", 150.0),
            ("motor_deflection", 4.0e-6),
            ("presliding_deflection", 1.0e-5),
        ] {
            let known = &mut result.report.parameters.known;
            known.insert(name.into(), estimate(value));
        }
        let (_, machine) = written_of(&result);
        let actual = &machine.axes[0].actual;
        let motor = actual.motor_side.as_ref().unwrap();
        assert_eq!(
            (motor.sliding.coulomb_n, actual.sliding.coulomb_n),
            (50.0, 150.0)
        );
        let parts = |law: &Law| match *law {
            Law::LuGre {
                bristle_stiffness_n_per_m,
                bristle_damping_n_s_per_m,
            } => [bristle_stiffness_n_per_m, bristle_damping_n_s_per_m],
            _ => panic!("{law:?}"),
        };
        for (law, wanted) in [
            (&motor.law, [50.0 / 4.0e-6, 1.0e3]),
            (&actual.law, [150.0 / 1.0e-5, 3.0e3]),
        ] {
            for (is, should) in parts(law).into_iter().zip(wanted) {
                assert!((is / should - 1.0).abs() < 1.0e-9, "{law:?} {wanted:?}");
            }
        }
    }

    #[test]
    fn elements_of_maxwell_slip_are_the_friction_law_in_the_place_of_presliding() {
        let element = |deflection: f64, share: f64| SlipElement { deflection, share };
        let effects = vec![
            inertia(700.0, None),
            Effect::Coulomb(Coulomb {
                coulomb: estimate(200.0),
            }),
            Effect::Presliding(Presliding {
                deflection: estimate(2.0e-6),
                damping: None,
            }),
        ];
        let mut result = identification(effects);
        result.report.presliding = Some(PreslidingCurve {
            law: "maxwell-slip",
            elements: vec![element(1.0e-9, 0.25), element(1.0e-5, 0.75)],
            motor_elements: vec![element(2.0e-6, 0.4), element(8.0e-6, 0.6)],
            points: Vec::new(),
        });
        for (name, value) in [("motor_coulomb", 50.0), ("load_coulomb", 150.0)] {
            let known = &mut result.report.parameters.known;
            known.insert(name.into(), estimate(value));
        }
        let (file, machine) = written_of(&result);
        let axis = &machine.axes[0];
        let motor = axis.actual.motor_side.as_ref().unwrap();
        let of_motor = Law::MaxwellSlip {
            stiffness_n_per_m: vec![1.0e7, 3.75e6],
            share: vec![0.4, 0.6],
        };
        assert_eq!(motor.law, of_motor);
        let Law::MaxwellSlip {
            stiffness_n_per_m,
            share,
        } = &axis.actual.law
        else {
            panic!("{:?}", axis.actual.law);
        };
        // The first one is as stiff as the sub-step carries.
        let most = 0.2 * 280.0 / plant_sim::axis::SUB_STEP_S.powi(2);
        assert!((stiffness_n_per_m[0] / (0.25 * most) - 1.0).abs() < 1.0e-9);
        assert!((stiffness_n_per_m[1] - 1.125e7).abs() < 1.0e-3);
        assert_eq!(share, &[0.25, 0.75]);
        assert!(!identified(&file).contains_key("left_out"));
    }
}
