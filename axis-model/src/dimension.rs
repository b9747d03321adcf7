//! What a parameter is measured in, whatever the axis: powers of effort, position and time.
//!
//! A machine file counts effort in newtons and position in metres, so that a dimension becomes the
//! end of a key: effort · time / position is `_n_s_per_m`.

use std::fmt::Write as _;

/// Powers of the base quantities of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension {
    /// Of effort: N on a linear axis in SI units; N m or A elsewhere.
    pub effort: i8,
    /// Of time: s.
    pub time: i8,
    /// Of position: m; rad on a rotary axis.
    pub position: i8,
    /// Of an angle within a period: rad.
    pub angle: i8,
    /// Of revolutions of the motor.
    pub revolution: i8,
}

impl Dimension {
    /// A plain ratio.
    pub const RATIO: Self = Self {
        effort: 0,
        time: 0,
        position: 0,
        angle: 0,
        revolution: 0,
    };
    /// Effort.
    pub const EFFORT: Self = Self {
        effort: 1,
        ..Self::RATIO
    };
    /// One over effort.
    pub const PER_EFFORT: Self = Self {
        effort: -1,
        ..Self::RATIO
    };
    /// Effort per position.
    pub const STIFFNESS: Self = Self {
        position: -1,
        ..Self::EFFORT
    };
    /// Effort per velocity.
    pub const DAMPING: Self = Self {
        time: 1,
        ..Self::STIFFNESS
    };
    /// Effort per acceleration.
    pub const INERTIA: Self = Self {
        time: 2,
        ..Self::STIFFNESS
    };
    /// Effort per velocity squared.
    pub const DRAG: Self = Self {
        effort: 1,
        time: 2,
        position: -2,
        ..Self::RATIO
    };
    /// Position.
    pub const POSITION: Self = Self {
        position: 1,
        ..Self::RATIO
    };
    /// One over position.
    pub const PER_POSITION: Self = Self {
        position: -1,
        ..Self::RATIO
    };
    /// One over position squared.
    pub const PER_POSITION_SQUARED: Self = Self {
        position: -2,
        ..Self::RATIO
    };
    /// Velocity.
    pub const VELOCITY: Self = Self {
        time: -1,
        ..Self::POSITION
    };
    /// Time.
    pub const TIME: Self = Self {
        time: 1,
        ..Self::RATIO
    };
    /// Angle within a period.
    pub const ANGLE: Self = Self {
        angle: 1,
        ..Self::RATIO
    };
    /// Periods per revolution.
    pub const PER_REVOLUTION: Self = Self {
        revolution: -1,
        ..Self::RATIO
    };

    /// End of a machine file's key, `_n_s_per_m`; empty for a ratio.
    #[must_use]
    pub fn key_end(self) -> String {
        let mut end = String::new();
        for (unit, power) in self.powers().into_iter().filter(|(_, power)| *power > 0) {
            let _ = write!(end, "_{unit}{}", exponent(power));
        }
        let below = self.powers().into_iter().filter(|(_, power)| *power < 0);
        for (place, (unit, power)) in below.enumerate() {
            let per = if place == 0 { "_per" } else { "" };
            let _ = write!(end, "{per}_{unit}{}", exponent(-power));
        }
        end
    }

    const fn powers(self) -> [(&'static str, i8); 5] {
        [
            ("n", self.effort),
            ("s", self.time),
            ("m", self.position),
            ("rad", self.angle),
            ("rev", self.revolution),
        ]
    }
}

fn exponent(power: i8) -> String {
    if power == 1 {
        String::new()
    } else {
        power.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dimension_ends_a_key_as_machine_files_write_it() {
        let ends = [
            (Dimension::RATIO, ""),
            (Dimension::EFFORT, "_n"),
            (Dimension::PER_EFFORT, "_per_n"),
            (Dimension::STIFFNESS, "_n_per_m"),
            (Dimension::DAMPING, "_n_s_per_m"),
            (Dimension::INERTIA, "_n_s2_per_m"),
            (Dimension::DRAG, "_n_s2_per_m2"),
            (Dimension::POSITION, "_m"),
            (Dimension::PER_POSITION, "_per_m"),
            (Dimension::PER_POSITION_SQUARED, "_per_m2"),
            (Dimension::VELOCITY, "_m_per_s"),
            (Dimension::TIME, "_s"),
            (Dimension::ANGLE, "_rad"),
            (Dimension::PER_REVOLUTION, "_per_rev"),
        ];
        for (dimension, end) in ends {
            assert_eq!(dimension.key_end(), end, "{dimension:?}");
        }
    }
}
