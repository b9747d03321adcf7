//! A compensation in a few words, with its units.

use crate::compensation::{AxisCompensation, Compensation, Model};

/// A compensation in a few words.
#[must_use]
pub fn in_words(reversal: &Compensation) -> String {
    match reversal {
        Compensation::None => "no compensation".into(),
        Compensation::Coulomb { force_n } => format!("Coulomb {force_n:.0} N"),
        Compensation::Pulse(pulse) => format!(
            "{:.3} mm/s, {:.1} ms, start delay {:.1} ms",
            1.0e3 * pulse.height_m_per_s,
            1.0e3 * pulse.time_constant_s,
            1.0e3 * pulse.start_delay_s
        ),
        Compensation::Adaptive(own) => format!(
            "pulses over the acceleration: forward {}, backward {} mm/s, {} ms, start delay {} ms at {} mm/s²",
            span(1.0e3, &own.forward_m_per_s),
            span(1.0e3, &own.backward_m_per_s),
            span(1.0e3, &own.time_constant_s),
            span(1.0e3, &own.start_delay_s),
            span(1.0e3, &own.accelerations_m_per_s2()),
        ),
        Compensation::Model(model) => format!(
            "model of {:.1} N ({:.0} N at standstill), viscous {:.0} N s/m, screw {}{}",
            model.level_n(),
            model.level_n() * model.factor[0],
            model.viscous_n_s_per_m,
            screw(model.stiffness_n_per_m, " N/µm"),
            on_motor(model)
        ),
    }
}

/// How much of the friction is of the motor's own side, where some is.
fn on_motor(model: &Model) -> String {
    let share = 100.0 * model.on_motor();
    if share > 0.0 {
        format!(", {share:.0} % of the friction on the motor's side")
    } else {
        String::new()
    }
}

/// The stiffness of a screw in N/µm, with its unit; a model that knows none winds nothing up.
fn screw(stiffness_n_per_m: f64, unit: &str) -> String {
    if stiffness_n_per_m.is_finite() {
        format!("{:.1}{unit}", 1.0e-6 * stiffness_n_per_m)
    } else {
        "taken for rigid".into()
    }
}

/// First and last of some values, in a unit of which there are so many in the SI unit.
fn span(per_si: f64, values: &[f64]) -> String {
    let [first, .., last] = values else {
        return "none".into();
    };
    format!("{:.3} to {:.3}", per_si * first, per_si * last)
}

/// Parameters of a compensation with their units in their names, for a table; those that say
/// nothing are left out.
#[must_use]
pub fn values(axis: &AxisCompensation) -> Vec<(&'static str, String)> {
    let mut values = match &axis.reversal {
        Compensation::None => Vec::new(),
        Compensation::Coulomb { force_n } => vec![("Coulomb force, N", format!("{force_n:.1}"))],
        Compensation::Pulse(pulse) => vec![
            (
                "pulse height, mm/s",
                format!("{:.3}", 1.0e3 * pulse.height_m_per_s),
            ),
            (
                "its time constant, ms",
                format!("{:.1}", 1.0e3 * pulse.time_constant_s),
            ),
            (
                "its start delay, ms",
                format!("{:.1}", 1.0e3 * pulse.start_delay_s),
            ),
        ],
        Compensation::Adaptive(_) => vec![("adaptive pulse", in_words(&axis.reversal))],
        Compensation::Model(model) => of_model(model),
    };
    if axis.backlash_m > 0.0 {
        values.push(("backlash, µm", format!("{:.2}", 1.0e6 * axis.backlash_m)));
    }
    values
}

fn of_model(model: &Model) -> Vec<(&'static str, String)> {
    let mut values = vec![
        ("friction, moving, N", format!("{:.1}", model.level_n())),
        (
            "friction, from standstill, N",
            format!("{:.1}", model.level_n() * model.factor[0]),
        ),
        (
            "viscous friction, N s/m",
            format!("{:.0}", model.viscous_n_s_per_m),
        ),
        ("screw stiffness, N/µm", screw(model.stiffness_n_per_m, "")),
    ];
    let more = [
        (
            "of it on the motor's side, %",
            100.0 * model.on_motor(),
            0.05,
        ),
        ("gap, µm", 1.0e6 * model.gap_m, 0.005),
        (
            "friction more forward than backward, N",
            2.0 * model.level_asymmetry_n,
            0.05,
        ),
        (
            "viscous more forward than backward, N s/m",
            2.0 * model.viscous_asymmetry_n_s_per_m,
            0.5,
        ),
        (
            "change of friction along the travel, %/m",
            100.0 * model.slope_per_m,
            0.05,
        ),
    ];
    let said = more
        .into_iter()
        .filter(|(_, value, least)| value.abs() >= *least);
    values.extend(said.map(|(name, value, _)| (name, format!("{value:.2}"))));
    let ripples = model
        .ripple
        .iter()
        .filter(|ripple| ripple.amplitude_n > 0.0)
        .count();
    if ripples > 0 {
        values.push(("waves of torque ripple", ripples.to_string()));
    }
    if model.self_tuning > 0.0 {
        values.push(("refined by the drive while it moves", "yes".to_owned()));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screw_without_a_stiffness_is_said_to_be_rigid() {
        assert_eq!(screw(1.2e8, " N/µm"), "120.0 N/µm");
        assert_eq!(screw(f64::INFINITY, " N/µm"), "taken for rigid");
    }
}
