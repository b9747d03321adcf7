//! Whether the parameters of `commission` are true: `cargo bench -p hil-tests --bench commissioned
//! [-- DRAWS]`.
//!
//! The reference machine, recorded as `commission` records it, with other noise in every draw (20).
//! Its axes share nothing but the SYNC, so a machine of ten axes gives ten draws. Nothing is
//! declared beyond what the machine file declares: what is missing has to be found first. What the
//! table says: [`hil_tests::intervals`].

use std::path::Path;

use hil_tests::intervals::{self, Draw, Said};
use hil_tests::on_all_cores;
use identification::{Dataset, identify};
use plant_sim::Machine;
use plant_sim::friction::Law;
use plant_sim::machine::MachineAxis;
use workbench::commissioning::identified_axes;
use workbench::session::Stand;

/// Draws.
const DRAWS: usize = 20;
/// Axes of a machine.
const TOGETHER: usize = 10;
/// Seed of the noise of the first machine.
const FIRST_SEED: u64 = 301;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let draws = arguments.next().and_then(|text| text.parse().ok());
    let machines: Vec<u64> = (0..draws.unwrap_or(DRAWS).div_ceil(TOGETHER) as u64).collect();
    let drawn: Vec<Draw> = machines.into_iter().flat_map(of_machine).collect();
    intervals::print(&drawn);
}

/// The reference machine with its first axis many times, and noise of its own.
fn machine(place: u64) -> Machine {
    let mut machine = Machine::reference();
    machine.seed = FIRST_SEED + place;
    let axis = machine.axes.swap_remove(0);
    let named = |place: usize| MachineAxis {
        name: format!("A{place}"),
        ..axis.clone()
    };
    machine.axes = (0..TOGETHER).map(named).collect();
    machine
}

fn of_machine(place: u64) -> Vec<Draw> {
    let machine = machine(place);
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    identified_axes::record(&Stand::in_process(&machine), folder.path())
        .expect("the reference machine can be recorded");
    let draws = on_all_cores(&machine.axes, |axis| drawn(folder.path(), axis, place));
    draws.into_iter().flatten().collect()
}

fn drawn(folder: &Path, axis: &MachineAxis, place: u64) -> Vec<Draw> {
    let records = folder.join(format!("records-{}", axis.name));
    let dataset = Dataset::read(&records, None, None).unwrap_or_else(|why| panic!("{why}"));
    let identified = identify(&dataset, &mut |_| ()).unwrap_or_else(|why| panic!("{why}"));
    let table = &identified.report.parameters;
    let said = |name| Said::in_table(table.get(name), table.unknown.contains_key(name));
    let draw = |(name, truth): (&'static str, f64)| Draw {
        make: "reference".into(),
        seed: place,
        name,
        truth,
        said: said(name),
    };
    truths(axis).into_iter().map(draw).collect()
}

/// What is true of an axis, by the names of reports.
fn truths(axis: &MachineAxis) -> Vec<(&'static str, f64)> {
    let (sliding, mechanics) = (&axis.actual.sliding, &axis.actual.mechanics);
    let mut truths = vec![
        (
            "inertia",
            mechanics.motor_inertia_kg + mechanics.table_mass_kg,
        ),
        ("load_inertia", mechanics.table_mass_kg),
        ("coulomb", sliding.coulomb_n),
        ("viscous", sliding.viscous_n_s_per_m),
        ("offset", 0.0),
        ("stribeck_excess", sliding.static_n - sliding.coulomb_n),
        ("stribeck_velocity", sliding.stribeck_velocity_m_per_s),
        ("compliance_stiffness", mechanics.screw_stiffness_n_per_m),
        ("compliance_damping", mechanics.screw_damping_n_s_per_m),
    ];
    if let Law::LuGre {
        bristle_stiffness_n_per_m,
        bristle_damping_n_s_per_m,
    } = axis.actual.law
    {
        // Where the Coulomb level is reached.
        let deflection = sliding.coulomb_n / bristle_stiffness_n_per_m;
        truths.push(("presliding_deflection", deflection));
        truths.push(("presliding_damping", bristle_damping_n_s_per_m));
    }
    truths
}
