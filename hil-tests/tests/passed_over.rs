//! A workbench at the pace of the clock that comes too late for some cycles: they are passed over,
//! the nodes go on by their own timers, and the next SYNC has its place on the grid.

use std::f64::consts::TAU;
use std::time::Duration;

use bus::BusLog;
use plant_sim::Machine;
use plant_sim::node::Truth;
use protocol::CanFrame;
use workbench::axis_records::{Part, Plan, record};
use workbench::compensation::AxisCompensation;
use workbench::error::Outcome;
use workbench::interrupt::Interrupt;
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::session::Session;

/// A link whose clock passes over some cycles once, after so many.
struct Late {
    link: InProcess,
    left: u32,
    skipped: u32,
}

impl Link for Late {
    fn buses(&self) -> usize {
        self.link.buses()
    }

    fn bus_of(&self, axis: usize) -> usize {
        self.link.bus_of(axis)
    }

    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()> {
        self.link.send(bus, frame)
    }

    fn receive(&mut self, bus: usize, timeout: Duration) -> Outcome<Option<CanFrame>> {
        self.link.receive(bus, timeout)
    }

    fn receive_in_cycle(
        &mut self,
        bus: usize,
        most: Option<Duration>,
    ) -> Outcome<Option<CanFrame>> {
        self.link.receive_in_cycle(bus, most)
    }

    fn pass(&mut self, cycle: Duration) -> u32 {
        let is_late = self.left == 1;
        self.left = self.left.saturating_sub(1);
        let skipped = if is_late { self.skipped } else { 0 };
        for _ in 0..=skipped {
            let _ = self.link.pass(cycle);
        }
        skipped
    }

    fn follows_clock(&self) -> bool {
        true
    }

    fn truth(&self, axis: usize) -> Option<Truth> {
        self.link.truth(axis)
    }

    fn start_log(&mut self) {
        self.link.start_log();
    }

    fn take_logs(&mut self) -> Vec<BusLog> {
        self.link.take_logs()
    }
}

/// Cycles until the clock is late: amid the motion, the axes have long been enabled.
const UNTIL_LATE: u32 = 500;
const DURATION_S: f64 = 1.5;

/// 10 mm to and fro within two seconds.
fn at(time_s: f64) -> Vec<f64> {
    vec![5.0e-3 * (1.0 - (0.5 * TAU * time_s).cos()); 2]
}

/// A session on a link that is late once.
fn late(machine: &Machine, left: u32, skipped: u32) -> Outcome<Session<'_, Late>> {
    let link = Late {
        link: InProcess::new(machine, 0)?,
        left,
        skipped,
    };
    let mut session = Session::on(link, machine, &Interrupt::never())?;
    session.ready(&vec![AxisCompensation::default(); machine.axes.len()])?;
    Ok(session)
}

/// Where the table was at the end, cycles that were missed, and all cycles; or why it broke off.
fn followed(skipped: u32) -> Outcome<(f64, u32, u64)> {
    let machine = Machine::reference();
    let mut session = late(&machine, UNTIL_LATE, skipped)?;
    let begun = session.cycles();
    let (mut last_m, mut beside_m) = (0.0, 0.0_f64);
    session.follow(DURATION_S, at, |time_s, axes| {
        last_m = axes[0].table_m();
        beside_m = beside_m.max((axes[0].reference_m - at(time_s)[0]).abs());
    })?;
    // What is told as the setpoint of a cycle is at most a cycle beside it.
    assert!(beside_m < 20.0e-6, "{skipped}: {beside_m}");
    Ok((last_m, session.missed(), session.cycles() - begun))
}

#[test]
fn cycles_that_are_passed_over_are_missed_and_the_axes_are_where_the_clock_is() {
    let (usual_m, missed, cycles) = followed(0).unwrap();
    assert_eq!((missed, cycles), (0, 1500));
    for skipped in 1..=3 {
        let (late_m, missed, cycles) = followed(skipped).unwrap();
        assert_eq!((missed, cycles), (skipped, 1500));
        let beside_um = 1.0e6 * (late_m - usual_m);
        assert!(beside_um.abs() < 1.0, "{skipped}: {beside_um} µm");
    }
}

#[test]
fn beyond_what_the_nodes_bridge_the_axes_are_stopped_by_name() {
    let told = followed(20).unwrap_err().to_string();
    assert!(told.contains("axis") && told.contains("Missing"), "{told}");
}

#[test]
fn a_record_has_no_row_of_a_cycle_whose_frames_did_not_come() {
    let mut machine = Machine::reference();
    machine.axes.truncate(1);
    let mut session = late(&machine, 6000, 2).unwrap();
    let (plan, mut records) = (Plan::of(&machine, Part::Validate), Vec::new());
    let begun = session.cycles();
    record(&mut session, &machine, &plan, &mut records).unwrap();
    let rows = &records[0].rows;
    let steps: Vec<f64> = rows
        .windows(2)
        .map(|pair| (1000.0 * (pair[1].0 - pair[0].0)).round())
        .collect();
    assert!(session.cycles() - begun > 6000);
    // Two were passed over; nobody saw the torque that acted in the one after them.
    assert_eq!(steps.iter().filter(|step| **step == 4.0).count(), 1);
    assert!(steps.iter().all(|step| [1.0, 4.0].contains(step)));
    // The axis moves: what is not its own row would stand still.
    let still = rows
        .windows(2)
        .filter(|pair| pair[0].1.motor_m == pair[1].1.motor_m);
    assert!(still.count() < rows.len() / 10);
}

#[test]
fn a_clock_does_not_wait_for_work_and_the_axes_hold_their_place_meanwhile() {
    let machine = Machine::reference();
    let mut session = late(&machine, 0, 0).unwrap();
    let begun = session.cycles();
    let done = session.meanwhile(|| {
        std::thread::sleep(Duration::from_millis(20));
        7
    });
    assert_eq!(done, Ok(7));
    assert!(session.cycles() > begun);
    session.master().expect_enabled().unwrap();
}
