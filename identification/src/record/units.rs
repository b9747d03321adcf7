//! What a record is measured in: the kind of axis tells the unit of positions, the column of the
//! effort tells its own.

use serde::Deserialize;

/// Kind of axis: tells the units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisKind {
    /// Metres.
    #[default]
    Linear,
    /// Radians.
    Rotary,
}

impl AxisKind {
    /// Velocity above which a sample counts as moving: 1 mm/s or 0.1 rad/s.
    #[must_use]
    pub const fn moving_velocity(self) -> f64 {
        match self {
            Self::Linear => 1.0e-3,
            Self::Rotary => 0.1,
        }
    }

    /// Suffix of position columns.
    #[must_use]
    pub const fn position_unit(self) -> &'static str {
        match self {
            Self::Linear => "m",
            Self::Rotary => "rad",
        }
    }

    /// Names of the column of the drive's velocity, the usual one first.
    #[must_use]
    pub(crate) const fn velocity_columns(self) -> [&'static str; 2] {
        match self {
            Self::Linear => ["velocity_m_s", "velocity_m_per_s"],
            Self::Rotary => ["velocity_rad_s", "velocity_rad_per_s"],
        }
    }

    /// Millionths of the position's unit: what position errors are told in.
    #[must_use]
    pub const fn millionths(self) -> &'static str {
        match self {
            Self::Linear => "µm",
            Self::Rotary => "µrad",
        }
    }
}

/// Which effort was recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// `force_n`.
    Force,
    /// `torque_nm`.
    Torque,
    /// `current_a`.
    Current,
}

impl Effort {
    /// Every effort that a record may have.
    pub(crate) const ALL: [Self; 3] = [Self::Force, Self::Torque, Self::Current];

    /// Name of its column.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::Force => "force_n",
            Self::Torque => "torque_nm",
            Self::Current => "current_a",
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Torque => "N m",
            Self::Current => "A",
        }
    }
}

/// When the effort of a row acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EffortHold {
    /// At the time of its row.
    #[default]
    Instant,
    /// From the time of its row until that of the next.
    ZeroOrder,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_column_of_an_effort_ends_in_its_unit() {
        for effort in Effort::ALL {
            let suffix = effort.unit().to_lowercase().replace(' ', "");
            assert!(
                effort.column().ends_with(&format!("_{suffix}")),
                "{effort:?}"
            );
        }
    }

    #[test]
    fn an_axis_moves_above_a_millimetre_or_a_tenth_of_a_radian_a_second() {
        assert_eq!(AxisKind::Linear.moving_velocity(), 1.0e-3);
        assert_eq!(AxisKind::Rotary.moving_velocity(), 0.1);
    }
}
