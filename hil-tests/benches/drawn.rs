//! What the model of friction leaves on machines that nobody chose: `cargo bench -p hil-tests
//! --bench drawn [-- MACHINES [FIRST]]`. How they are drawn: `hil-tests/src/drawn.rs`.
//!
//! They are commissioned as a user would: loops first, records, identification, model, and the
//! model refined by the drives. The table has the largest burst, µm, without → with the model of
//! what the machine file says → with the model of its records → refined, at R 100 F 500, 2000 and
//! 8000, what identification named, and what was told of the loops.

use hil_tests::drawn::{self, Commissioned, Drawn, FEEDS};
use hil_tests::on_all_cores;
use plant_sim::friction::Law;
use workbench::commissioning::feeds::less_percent;
use workbench::commissioning::fitness::Oscillation;
use workbench::compensation::AxisCompensation;
use workbench::session::Stand;

/// Machines.
const MACHINES: u64 = 12;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let mut number = |usual: u64| {
        let text = arguments.next();
        text.and_then(|text| text.parse().ok()).unwrap_or(usual)
    };
    let (machines, first) = (number(MACHINES), number(1));
    let numbers: Vec<u64> = (first..first + machines).collect();
    println!("| machine | friction | F 500 | F 2000 | F 8000 | named | loops |");
    println!("|---|---|---|---|---|---|---|");
    for line in on_all_cores(&numbers, |number| of_number(*number)) {
        println!("{line}");
    }
}

fn of_number(number: u64) -> String {
    let own = Drawn::of_number(number);
    let called = called(&own);
    let told = match &own.loops {
        Ok(found) => told(found),
        Err(failure) => failure.to_string(),
    };
    if own.is_unfit() {
        return format!("| {number} | {called} | not commissioned | | | | {told} |");
    }
    let stand = Stand::in_process(&own.machine);
    let Commissioned { named, mut models } = Commissioned::of(&stand, true);
    models.insert(0, drawn::exact(&own.machine));
    let [slow, usual, fast] = FEEDS.map(|feed| cell(&stand, feed, &models));
    format!("| {number} | {called} | {slow} | {usual} | {fast} | {named} | {told} |")
}

/// What a machine has.
fn called(own: &Drawn) -> String {
    let actual = &own.machine.axes[0].actual;
    let mut words = match &actual.law {
        Law::MaxwellSlip { share, .. } => format!("Maxwell slip, {} elements", share.len()),
        _ => "LuGre".into(),
    };
    if let Some(motor) = &actual.motor_side {
        let (motor_n, table_n) = (motor.sliding.coulomb_n, actual.sliding.coulomb_n);
        let share = 100.0 * motor_n / (motor_n + table_n);
        words += &format!(", {share:.0} % of it at the motor");
    }
    let gap_um = 1.0e6 * actual.mechanics.backlash_m;
    if gap_um > 0.0 {
        words += &format!(", gap {gap_um:.1} µm");
    }
    if own.redrawn > 0 {
        words += &format!(", draw {}", own.redrawn + 1);
    }
    words
}

fn told(loops: &[Oscillation]) -> String {
    let each = loops.iter().map(|own| {
        let (hz, um) = (own.frequency_hz, own.amplitude_um);
        let at = own.creeping_m_per_s;
        let at = at.map_or(String::new(), |at| format!(" at {:.1} mm/s", 1.0e3 * at));
        format!("{}: {hz:.0} Hz, {um:.1} µm{at}", own.axis)
    });
    each.collect::<Vec<_>>().join("; ")
}

fn cell(stand: &Stand<'_>, feed: f64, models: &[Vec<AxisCompensation>]) -> String {
    let burst_um = |compensation: &[AxisCompensation]| drawn::burst_um(stand, feed, compensation);
    let none = match burst_um(&stand.uncompensated()) {
        Ok(none_um) => none_um,
        Err(failure) => return failure.to_string(),
    };
    let with = models.iter().map(|model| match burst_um(model) {
        Ok(um) => format!(" → {um:.2} ({:.1} %)", less_percent(none, um)),
        Err(failure) => format!(" → {failure}"),
    });
    format!("{none:.1}{}", with.collect::<String>())
}
