//! Machines with a gap beside a compliance: what `commission` records, and `identify` has to tell
//! apart.
//!
//! The reference machine, and machines like it that are drawn by seed: masses, frictions, stiffness
//! and damping of the screw, lead and presliding differ by up to a half from it. One machine has an
//! axis for each gap, inside the position loop and outside it; axes share nothing but the SYNC, so
//! that one recording gives all of them. What is declared is no matter of the recording.

use axis_model::EffectName;
use plant_sim::Machine;
use plant_sim::friction::Law;
use plant_sim::machine::{MachineAxis, PositionSensor};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};

/// Widths of the gaps, µm.
pub const GAPS_UM: [u32; 7] = [0, 2, 5, 10, 20, 50, 100];

/// Seeds of the machines; 0 is the reference machine itself. 8, 9 and 12 are left out: with a half
/// of the masses on one side their gains are unstable with a gap outside the loop, and the drive
/// stops them. The loop of 26 hardly damps.
pub const SEEDS: [u64; 14] = [0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 13, 14, 15, 26];

/// Where the gap is, seen from the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// The loop is closed at the load: the gap is inside.
    Inside,
    /// The loop is closed at the motor: the gap is outside.
    Outside,
}

impl Loop {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Inside, Self::Outside];

    /// The word of tables and folders.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::Outside => "outside",
        }
    }

    const fn sensor(self) -> PositionSensor {
        match self {
            Self::Inside => PositionSensor::Load,
            Self::Outside => PositionSensor::Motor,
        }
    }
}

/// Name of the axis with a gap.
#[must_use]
pub fn name(gap_um: u32, place: Loop) -> String {
    format!("{}{gap_um}", place.word())
}

/// The machine of a seed, with an axis for each gap and each place of it.
#[must_use]
pub fn machine(seed: u64, gaps_um: &[u32]) -> Machine {
    let mut machine = Machine::reference();
    machine.name = format!("gaps-{seed}");
    machine.seed = 40 + seed;
    let drawn = drawn(machine.axes.swap_remove(0), seed);
    let places = |gap_um: &u32| Loop::BOTH.map(|place| axis(&drawn, *gap_um, place));
    machine.axes = gaps_um.iter().flat_map(places).collect();
    machine
}

fn axis(drawn: &MachineAxis, gap_um: u32, place: Loop) -> MachineAxis {
    let mut axis = drawn.clone();
    axis.name = name(gap_um, place);
    axis.actual.mechanics.backlash_m = 1.0e-6 * f64::from(gap_um);
    axis.gains.position_sensor = place.sensor();
    axis
}

/// The axis with everything that differs from machine to machine; that of seed 0 as it is.
fn drawn(mut axis: MachineAxis, seed: u64) -> MachineAxis {
    if seed == 0 {
        return axis;
    }
    let mut stream = ChaCha8Rng::seed_from_u64(seed);
    let range = Uniform::new_inclusive(0.5, 1.5).expect("0.5 is less than 1.5");
    let mut factor = || range.sample(&mut stream);
    let actual = &mut axis.actual;
    let screw = &mut actual.mechanics;
    screw.motor_inertia_kg *= factor();
    screw.table_mass_kg *= factor();
    screw.screw_stiffness_n_per_m *= factor();
    screw.screw_damping_n_s_per_m *= factor();
    actual.lead_m_per_rev *= factor();
    let sliding = &mut actual.sliding;
    let friction = factor();
    sliding.coulomb_n *= friction;
    // The breakaway friction stays above the sliding one.
    sliding.static_n = sliding.coulomb_n * (1.0 + 0.3 * factor());
    sliding.stribeck_velocity_m_per_s *= factor();
    sliding.viscous_n_s_per_m *= factor();
    if let Law::LuGre {
        bristle_stiffness_n_per_m,
        bristle_damping_n_s_per_m,
    } = &mut actual.law
    {
        *bristle_stiffness_n_per_m *= factor();
        *bristle_damping_n_s_per_m *= factor();
    }
    axis
}

/// The machine with compliance declared, or not.
#[must_use]
pub fn declaring_compliance(mut machine: Machine, declared: bool) -> Machine {
    if !declared {
        for axis in &mut machine.axes {
            axis.declared.retain(|name| *name != EffectName::Compliance);
        }
    }
    machine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_zero_is_the_reference_machine_with_gaps() {
        let machine = machine(0, &GAPS_UM);
        let reference = Machine::reference().axes.swap_remove(0);
        assert_eq!(machine.axes.len(), 14);
        let mut outside = machine.axes[9].clone();
        assert_eq!(outside.name, "outside20");
        let gap_um = 1.0e6 * outside.actual.mechanics.backlash_m;
        assert!((gap_um - 20.0).abs() < 1.0e-9, "{gap_um}");
        assert_eq!(outside.gains.position_sensor, PositionSensor::Motor);
        outside.actual.mechanics.backlash_m = 0.0;
        assert_eq!(outside.actual, reference.actual);
    }

    #[test]
    fn other_seeds_differ_by_up_to_a_half_and_can_be() {
        let reference = Machine::reference().axes.swap_remove(0);
        for seed in SEEDS.into_iter().skip(1) {
            let axis = &machine(seed, &[0]).axes[0];
            let ratio = |of: fn(&MachineAxis) -> f64| of(axis) / of(&reference);
            for ratio in [
                ratio(|axis| axis.actual.mechanics.table_mass_kg),
                ratio(|axis| axis.actual.mechanics.screw_stiffness_n_per_m),
                ratio(|axis| axis.actual.sliding.coulomb_n),
                ratio(|axis| axis.actual.lead_m_per_rev),
            ] {
                assert!(
                    (0.5..=1.5).contains(&ratio) && ratio != 1.0,
                    "{seed} {ratio}"
                );
            }
            let sliding = axis.actual.sliding;
            assert!(sliding.static_n > sliding.coulomb_n);
        }
    }
}
