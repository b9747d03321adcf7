//! Torque that is periodic in the position of the motor, fed forward: cogging, a bearing, a screw.
//!
//! ```text
//! T = Σ A sin(2π x / period + φ)     x where the reference is when the torque acts
//! ```
//!
//! The angle is a 32-bit fraction of a turn that wraps round, so it is as exact at the end of a
//! long travel as at its middle.

use crate::friction::Ahead;
use crate::reference::Reference;
use crate::units::{Position, Torque};
use fixed::types::I40F24;

/// Waves that are compensated.
pub const WAVES: usize = 2;

/// A wave over the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wave {
    /// A, µN·m; below 2²⁸. Zero switches it off.
    pub amplitude_micro_nm: i32,
    /// Turns of the angle per 2⁻⁸ of 10 nm, 2⁻⁵⁶.
    pub per_position: i64,
    /// φ, 2⁻³² turns.
    pub phase: i32,
}

/// What the drive knows of the ripple of its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RippleConfig {
    /// The waves.
    pub waves: [Wave; WAVES],
    /// From x(k+1) to when the torque acts.
    pub ahead: Ahead,
}

impl RippleConfig {
    /// Whether no wave has a height.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.waves.iter().all(|wave| wave.amplitude_micro_nm == 0)
    }

    /// The torque that overcomes it.
    pub(crate) fn torque(&self, reference: &Reference) -> Torque {
        if self.is_off() {
            return Torque::ZERO;
        }
        let waves = self
            .waves
            .iter()
            .filter(|wave| wave.amplitude_micro_nm != 0);
        let at = || {
            let (velocity, acceleration) = (reference.next_velocity, reference.acceleration);
            let next = reference.position.after(velocity);
            next.after(self.ahead.way(velocity, acceleration))
        };
        waves.fold(Torque::ZERO, |sum, wave| sum.plus(wave.torque(at())))
    }
}

impl Wave {
    fn torque(self, at: Position) -> Torque {
        // What wraps away are whole turns; 32 of the 56 fractional bits stay.
        let turns =
            at.0.to_bits()
                .wrapping_mul(self.per_position)
                .wrapping_shr(24);
        let angle = low_bits(turns).wrapping_add(self.phase);
        let (_, sine) = idsp::cossin(angle);
        // 28 bits times 31 fractional ones, of which 24 stay.
        let product = i64::from(self.amplitude_micro_nm).wrapping_mul(i64::from(sine));
        Torque(I40F24::from_bits(product.wrapping_shr(7)))
    }
}

fn low_bits(wide: i64) -> i32 {
    let [a, b, c, d, ..] = wide.to_le_bytes();
    i32::from_le_bytes([a, b, c, d])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_is_its_sine_to_ten_thousandths_all_along_the_travel() {
        // 2 mm: 200 000 counts.
        let wave = Wave {
            amplitude_micro_nm: 1_000_000,
            per_position: (1_i64 << 48) / 200_000,
            phase: 1 << 30,
        };
        for count in (-130_000_000_i64..130_000_000).step_by(1_234_567) {
            let torque: f64 = wave.torque(Position::from_counts(count)).0.to_num();
            let turn = f64::from(i32::try_from(count).unwrap()) / 200_000.0 + 0.25;
            let wanted = 1.0e6 * (std::f64::consts::TAU * turn).sin();
            assert!(
                (torque - wanted).abs() < 100.0,
                "{count}: {torque} {wanted}"
            );
        }
    }
}
