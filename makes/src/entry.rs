//! An entry: a folder with `dataset.toml`, `train.csv`, `validate.csv` and `truth.json`.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use crate::control::{Law, Sensor};
use crate::draw::Draw;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Source;
use crate::table::Table;
use crate::truth::{Effect, Known, Truth, Verdict};

/// An entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of its folder.
    pub name: String,
    /// `dataset.toml`.
    pub dataset: String,
    /// Training record.
    pub train: Table,
    /// Validation record.
    pub validate: Table,
    /// What is true.
    pub truth: Truth,
}

impl Entry {
    /// Records a rig; the truth says what its declared model, the rig's base, lacks.
    #[must_use]
    pub fn of(name: &str, rig: &Rig, truth: Truth, seed: u64) -> Self {
        Self::with_validation(name, rig, rig, truth, seed)
    }

    /// The same, with the validation record from another rig.
    #[must_use]
    pub fn with_validation(name: &str, rig: &Rig, other: &Rig, truth: Truth, seed: u64) -> Self {
        // Noise by make: the forms that share a training record share it to the last digit.
        let mut draw = Draw::of(&format!("noise of {}", truth.make), seed);
        Self {
            name: name.into(),
            dataset: dataset(name, rig, &truth.declared),
            train: rig.table(&rig.training, &mut draw),
            validate: other.table(&other.validation, &mut draw),
            truth,
        }
    }

    /// Writes it into a folder of its name.
    ///
    /// # Errors
    /// Where the folder cannot be written.
    pub fn write(&self, root: &Path) -> io::Result<()> {
        let folder = root.join(&self.name);
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("dataset.toml"), &self.dataset)?;
        std::fs::write(folder.join("train.csv"), self.train.csv())?;
        std::fs::write(folder.join("validate.csv"), self.validate.csv())?;
        let truth = serde_json::to_string_pretty(&self.truth).map_err(io::Error::other)?;
        std::fs::write(folder.join("truth.json"), truth + "\n")
    }
}

/// The truth of a rig that lacks some effects.
#[must_use]
pub fn truth(make: &str, form: &str, rig: &Rig, declared: &[Effect], lacking: &[Effect]) -> Truth {
    Truth {
        make: make.into(),
        form: form.into(),
        effects: lacking.to_vec(),
        verdict: Verdict::Explained,
        or_unexplained: false,
        same_force: vec![(Effect::Offset, Effect::CoulombAsymmetry)],
        declared: declared.to_vec(),
        oracle: [declared, lacking].concat(),
        parameters: parameters(rig),
        cause: String::new(),
    }
}

/// Inertia, Coulomb and viscous friction in the unit of the record, and what the make knows.
fn parameters(rig: &Rig) -> Vec<Known> {
    let per = rig.column.per_effort();
    let (effort, position) = (rig.column.unit(), rig.kind.position_unit());
    let known = |name, value: f64, unit: String| Known {
        name,
        value: value * per,
        unit,
    };
    let mut all = vec![
        known(
            "inertia",
            rig.train.inertia(),
            format!("{effort} s2/{position}"),
        ),
        known("coulomb", rig.train.coulomb_amid(), effort.into()),
        known(
            "viscous",
            rig.train.viscous(),
            format!("{effort} s/{position}"),
        ),
    ];
    let motor_coulomb = motor_coulomb(rig);
    all.extend(motor_coulomb.map(|level| known("motor_coulomb", level, effort.into())));
    let of_make = |own: &Known| match own.name {
        "logged_late" => Known {
            value: lateness(rig, own.value),
            ..own.clone()
        },
        "delay" => Known {
            value: rig.drive.dead_steps(rig.step_s()) as f64 * rig.step_s() - lateness(rig, 0.0),
            ..own.clone()
        },
        "compliance_stiffness" => known(own.name, own.value, format!("{effort}/{position}")),
        _ => own.clone(),
    };
    all.extend(rig.known.iter().map(of_make));
    all
}

/// Coulomb friction of the motor's own side, before a spring without a gap, where a scale at the
/// load shows it apart from that of the load.
fn motor_coulomb(rig: &Rig) -> Option<f64> {
    let train = &rig.train;
    let [joint] = &train.joints[..] else {
        return None;
    };
    let level = train.coulomb_amid_of(0);
    (rig.sensing.load.is_some() && joint.gap == 0.0 && level > 0.0).then_some(level)
}

/// How late the effort of a log is that is read so late; below zero where it acts later.
///
/// What is read is held over a tick of the controller, and the current loop follows it. A command
/// is stated as held from its row on, and acts as much later as that loop lags behind a ramp. A
/// current is stated as that of its instant: a ramp of commands is a staircase, half a tick and
/// that lag behind it, and what is read of it is behind by what the loop has not yet followed of
/// each stair. Rows whose stamps jitter begin anywhere in a tick.
fn lateness(rig: &Rig, late_s: f64) -> f64 {
    let (tick_s, step_s) = (rig.controller.period_s, rig.step_s());
    let late_steps = (late_s / step_s).round() as usize;
    let late_s = late_steps as f64 * step_s;
    let a_tick = rig.steps_per_tick;
    let since = (a_tick - late_steps % a_tick) % a_tick;
    let begun_s = if rig.sensing.stamps.jitter_s > 0.0 {
        late_s + 0.5 * tick_s
    } else {
        late_s + since as f64 * step_s
    };
    let behind = rig.drive.current_loop.behind(step_s);
    let lag_s = step_s * behind.iter().sum::<f64>();
    match rig.sensing.effort.source {
        Source::Command => begun_s - lag_s,
        Source::Current => {
            let unread = behind.iter().skip(since).step_by(a_tick).sum::<f64>();
            begun_s - 0.5 * tick_s - lag_s + tick_s * unread
        }
    }
}

/// Text of `dataset.toml`.
fn dataset(name: &str, rig: &Rig, declared: &[Effect]) -> String {
    let mut text = format!("name = \"{name}\"\nsample_period_s = {:e}\n", rig.row_s());
    text.push_str(match rig.sensing.effort.source {
        Source::Command => "effort_hold = \"zero-order\"\n",
        Source::Current => "effort_hold = \"instant\"\n",
    });
    if let Some(lag_s) = rig.stated.effort_lag_s {
        let _ = writeln!(text, "effort_lag_s = {lag_s:e}");
    }
    text.push_str(&axis(rig));
    text.push_str(&controller(rig));
    let names: Vec<String> = declared
        .iter()
        .map(|e| format!("\"{}\"", e.name()))
        .collect();
    let _ = write!(text, "\n[declared]\neffects = [{}]\n", names.join(", "));
    text
}

fn axis(rig: &Rig) -> String {
    let (kind, unit) = match rig.kind {
        Kind::Linear => ("linear", "m"),
        Kind::Rotary => ("rotary", "rad"),
    };
    let mut text = format!("\n[axis]\nkind = \"{kind}\"\n");
    if let Some(lead) = rig.stated.lead_m_per_rev {
        let _ = writeln!(text, "lead_m_per_rev = {lead:e}");
    }
    if rig.stated.resolution {
        let motor = rig.sensing.motor.resolution;
        let _ = writeln!(text, "encoder_resolution_{unit} = {motor:e}");
        if let Some(scale) = &rig.sensing.load {
            let _ = writeln!(
                text,
                "load_encoder_resolution_{unit} = {:e}",
                scale.resolution
            );
        }
    }
    text
}

/// The form of the file knows a cascade on force.
fn controller(rig: &Rig) -> String {
    let Law::Cascade {
        position_per_s,
        velocity,
        integral_per_s,
        feedforward: true,
    } = rig.controller.law
    else {
        return String::new();
    };
    if !rig.stated.controller || rig.column != EffortColumn::Force {
        return String::new();
    }
    let sensor = match rig.controller.sensor {
        Sensor::Motor => "motor",
        Sensor::Load => "load",
    };
    format!(
        "\n[controller]\nposition_gain_per_s = {position_per_s:e}\n\
         velocity_gain_n_s_per_m = {velocity:e}\nintegral_per_s = {integral_per_s:e}\n\
         velocity_filter = {:e}\nacceleration_feedforward_kg = {:e}\n\
         position_sensor = \"{sensor}\"\n",
        rig.controller.filter_share, rig.controller.feedforward_inertia
    )
}

#[cfg(test)]
mod tests {
    use super::lateness;
    use crate::drive::CurrentLoop;
    use crate::make::Presence;
    use crate::sensing::Source;
    use crate::truth::Known;

    fn known(record: &str) -> Vec<Known> {
        let mut recipes = crate::recipes(1);
        recipes.retain(|recipe| recipe.name == record);
        recipes.remove(0).entry().truth.parameters
    }

    fn of<'a>(all: &'a [Known], name: &str) -> &'a Known {
        all.iter().find(|known| known.name == name).unwrap()
    }

    #[test]
    fn a_stiffness_is_that_of_the_record_in_the_unit_of_its_effort() {
        for (record, unit, range) in [
            // 81 N/µm at a lead of 16 mm, and 18 kN m/rad at 9 N m/A.
            ("covered-table-declared", "N m/m", 1.0e5..4.0e5),
            ("exoskeleton-knee-declared", "A/rad", 1.0e3..4.0e3),
            ("tracking-antenna-declared", "N m/rad", 1.0e6..1.0e7),
        ] {
            let all = known(record);
            let stiffness = of(&all, "compliance_stiffness");
            assert_eq!(stiffness.unit, unit, "{record}");
            assert!(range.contains(&stiffness.value), "{record}: {stiffness:?}");
            let mass = of(&all, "inertia");
            let effort = |unit: &str| unit.split([' ', '/']).next().map(str::to_owned);
            assert_eq!(effort(&mass.unit), effort(unit), "{record}");
        }
    }

    #[test]
    fn a_delay_is_as_long_as_the_simulation_makes_it() {
        let all = known("die-bonder-declared");
        // Seven steps a tick. The current loop lags by 40 µs, less what a step goes ahead.
        let step_s = 1.25e-4 / 7.0;
        let follows = libm::exp(-step_s / 4.0e-5);
        let steps = of(&all, "delay").value / step_s - follows / (1.0 - follows);
        assert!((steps - steps.round()).abs() < 1.0e-6, "{steps}");
    }

    #[test]
    fn a_current_that_is_smooth_over_a_tick_is_as_late_as_it_is_read_and_a_staircase_half_of_one() {
        let mut makes = crate::make::logs::MAKES.iter();
        let fieldbus = makes.find(|make| make.name == "fieldbus-log").unwrap();
        let mut rig = fieldbus.rig(Presence::Present, 1);
        let tick_s = rig.controller.period_s;
        for (current_loop, late_ticks, wanted_ticks) in [
            (CurrentLoop::First(10.0 * tick_s), 4.25, 4.25),
            (CurrentLoop::Second(0.02 / tick_s, 0.8), 4.25, 4.25),
            (CurrentLoop::Ideal, 4.25, 4.5),
            (CurrentLoop::Ideal, 4.0, 3.5),
        ] {
            rig.drive.current_loop = current_loop;
            rig.sensing.effort.source = Source::Current;
            let ticks = lateness(&rig, late_ticks * tick_s) / tick_s;
            // A step of the simulation is held too: half a sixteenth of a tick.
            assert!(
                (ticks - wanted_ticks).abs() < 0.04,
                "{current_loop:?} {ticks}"
            );
        }
    }
}
