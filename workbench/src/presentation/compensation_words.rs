//! A compensation in a few words, with its units.

use crate::compensation::{Compensation, Model};

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
            "model of {:.1} N ({:.0} N at standstill), viscous {:.0} N s/m, screw {:.1} N/µm{}",
            model.level_n(),
            model.level_n() * model.factor[0],
            model.viscous_n_s_per_m,
            1.0e-6 * model.stiffness_n_per_m,
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

/// First and last of some values, in a unit of which there are so many in the SI unit.
fn span(per_si: f64, values: &[f64]) -> String {
    let [first, .., last] = values else {
        return "none".into();
    };
    format!("{:.3} to {:.3}", per_si * first, per_si * last)
}
