//! What is true of a record: `truth.json`.

use serde::Serialize;

/// Names of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // The names are those of the interface, which says what they are.
pub enum Effect {
    Inertia,
    Viscous,
    Coulomb,
    Offset,
    CoulombAsymmetry,
    ViscousAsymmetry,
    Stribeck,
    Presliding,
    Backlash,
    Compliance,
    TorqueRipple,
    PitchError,
    PositionDependentFriction,
    FrictionDrift,
    QuadraticDrag,
    TorqueSaturation,
    Delay,
    Payload,
    PositionDependentInertia,
    LoadDependentFriction,
    TorqueConstantRipple,
    LoggedLate,
}

impl Effect {
    /// Usually declared.
    pub const USUAL: [Self; 4] = [Self::Inertia, Self::Viscous, Self::Coulomb, Self::Offset];

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> String {
        let quoted = serde_json::to_string(&self).unwrap_or_default();
        quoted.trim_matches('"').into()
    }
}

/// The verdict that is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing structured is left.
    Explained,
    /// Something is left that no effect explains.
    Unexplained,
    /// The record is refused, or `unexplained`.
    RefusedOrUnexplained,
}

/// A parameter, in the units of the recorded effort.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Known {
    /// Its name in reports.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: String,
}

/// What is true of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Make or disturbance.
    pub make: String,
    /// Form.
    pub form: String,
    /// Effects that the declared model lacks.
    pub effects: Vec<Effect>,
    /// The verdict.
    pub verdict: Verdict,
    /// Whether `unexplained` is right as well: the effect is one of a list's new names, of another
    /// shape than its equation.
    pub or_unexplained: bool,
    /// The same force by another name: pairs of which either is right.
    pub same_force: Vec<(Effect, Effect)>,
    /// The declared list of `dataset.toml`.
    pub declared: Vec<Effect>,
    /// The declared list that would be true: what an oracle is told.
    pub oracle: Vec<Effect>,
    /// Parameters.
    pub parameters: Vec<Known>,
    /// What is wrong outside the list, or with the record; empty where nothing is.
    pub cause: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_interface() {
        assert_eq!(
            Effect::PositionDependentFriction.name(),
            "position_dependent_friction"
        );
        assert_eq!(Effect::LoggedLate.name(), "logged_late");
    }
}
