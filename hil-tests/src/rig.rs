//! The rig: machines for scenarios, and a master on the in-process bus whose plugs can be pulled.

use plant_sim::Machine;
use plant_sim::brake::BrakeParameters;
use plant_sim::friction::Law;
use plant_sim::machine::PositionSensor;
use protocol::sdo::Expedited;
use servo::objects::{COMMIT, COMMIT_KEY, Parameter, TABLE};
use workbench::compensation::AxisCompensation;
use workbench::error::{Failure, Outcome};
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::network::master::Master;
use workbench::trajectory::Circle;

/// The reference machine without noise, for figures that have to repeat to the digit.
#[must_use]
pub fn quiet_reference() -> Machine {
    let mut machine = Machine::reference();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.actual.force_noise_n = 0.0);
    machine
}

/// Three counter-clockwise turns of a radius in mm at a feed in mm/min.
#[must_use]
pub fn circle(radius_mm: f64, feed_mm_min: f64) -> Circle {
    Circle {
        radius_m: 1.0e-3 * radius_mm,
        feed_m_per_s: feed_mm_min / 6.0e4,
        turns: 3,
        counter_clockwise: true,
    }
}

/// The reference machine with both axes on one bus, as on a single vcan.
#[must_use]
pub fn shared_bus() -> Machine {
    let mut machine = Machine::reference();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.interface = Some("vcan0".into()));
    machine
}

/// The first axis only.
#[must_use]
pub fn one_axis() -> Machine {
    let mut machine = quiet_reference();
    machine.axes.truncate(1);
    machine
}

/// A vertical axis, positive up: 2500 N of gravity that nothing balances, and a brake of 4 kN on
/// the motor that opens in 30 ms and bites after 40 ms.
#[must_use]
pub fn vertical() -> Machine {
    vertical_with_brake(0.030, 0.040)
}

/// The vertical axis with a faster or slower brake.
#[must_use]
pub fn vertical_with_brake(open_s: f64, close_s: f64) -> Machine {
    let mut machine = one_axis();
    for axis in &mut machine.axes {
        axis.actual.mounting.gravity_n = -2500.0;
        axis.actual.mounting.brake = Some(BrakeParameters {
            rated_force_n: 4000.0,
            open_s,
            close_s,
            rise_s: 0.0,
        });
    }
    machine
}

/// The vertical axis with each brake of the tables: name, machine. A brake of 0 ms opens at once
/// too, that of 10 ms in 8 ms.
#[must_use]
pub fn vertical_axes() -> [(&'static str, Machine); 3] {
    [
        ("brake of 0 ms", vertical_with_brake(0.0, 0.0)),
        ("brake of 10 ms", vertical_with_brake(0.008, 0.010)),
        ("brake of 40 ms", vertical()),
    ]
}

/// One axis with an absolute scale whose table stands at `table_m` at power-up, while its motor
/// encoder counts from zero.
#[must_use]
pub fn absolute_scale(table_m: f64) -> Machine {
    let mut machine = one_axis();
    for axis in &mut machine.axes {
        axis.actual.mounting.start_m = table_m;
        axis.actual.mounting.motor_zero_m = table_m;
    }
    machine
}

/// One axis with a lead of 1 mm and 10 m of travel to either side: ten thousand revolutions of 2^20
/// increments one way, five times the 2^31 of the frame, within the 21.5 m that a setpoint can say.
#[must_use]
pub fn long_way() -> Machine {
    let mut machine = one_axis();
    for axis in &mut machine.axes {
        axis.actual.lead_m_per_rev = 1.0e-3;
        axis.limits.travel_m = 10.0;
    }
    machine
}

/// The paper's Fig. 4: a gap outside the position loop.
#[must_use]
pub fn gap_outside(gap_m: f64) -> Machine {
    let mut machine = quiet_reference();
    for axis in &mut machine.axes {
        axis.actual.mechanics.backlash_m = gap_m;
        axis.gains.position_sensor = PositionSensor::Motor;
    }
    machine
}

/// The paper's Fig. 5: a gap inside the position loop, in the 2 kHz loop (60 /s, 45 Hz, integral
/// 11.25 Hz) of the prototype's figures.
#[must_use]
pub fn gap_inside(gap_m: f64) -> Machine {
    let mut machine = quiet_reference();
    machine.period_s = 0.5e-3;
    for axis in &mut machine.axes {
        axis.actual.mechanics.backlash_m = gap_m;
        axis.gains.position_gain_per_s = 60.0;
        axis.gains.velocity_bandwidth_hz = 45.0;
        axis.gains.velocity_integral_hz = 11.25;
    }
    machine
}

/// The paper's Fig. 8: dry friction with a rigid stick phase, a stiff motor-side loop.
#[must_use]
pub fn dry_friction() -> Machine {
    let mut machine = quiet_reference();
    for axis in &mut machine.axes {
        axis.actual.law = Law::Coulomb;
        axis.actual.sliding.static_n = axis.actual.sliding.coulomb_n;
    }
    machine
}

/// A master on an enabled machine, no compensation.
///
/// # Errors
/// Where the machine does not come up.
pub fn enabled(machine: &Machine) -> Outcome<Master<InProcess>> {
    enabled_on(InProcess::new(machine, 0)?, machine)
}

/// The same on a link to it.
///
/// # Errors
/// Where the machine does not come up.
pub fn enabled_on(link: InProcess, machine: &Machine) -> Outcome<Master<InProcess>> {
    let mut master = Master::start(link, machine)?;
    master.configure(
        machine,
        &vec![AxisCompensation::default(); machine.axes.len()],
    )?;
    master.enable()?;
    Ok(master)
}

/// Place of the plant on the bus of its axis, where every axis has a bus of its own.
pub const PLANT: usize = 0;
/// Place of the servo.
pub const SERVO: usize = 1;

/// Writes parameters of an axis and makes them active as a whole, as an engineer would over SDO; in
/// motion as well.
///
/// # Errors
/// Where the drive refuses a value or the set.
pub fn set<L: Link>(
    master: &mut Master<L>,
    axis: usize,
    values: &[(Parameter, i32)],
) -> Outcome<()> {
    for (parameter, value) in values {
        let entry = TABLE.iter().find(|entry| entry.parameter == *parameter);
        let entry = entry.ok_or_else(|| Failure::new("the drive has no such object"))?;
        master.download(axis, entry.address, Expedited::i32(*value))?;
    }
    master.download(axis, COMMIT, Expedited::u32(COMMIT_KEY))
}
