//! The machine stops as one: trouble of one axis, or the operator, brings every axis to rest, and
//! what was recorded stays.
//!
//! In process, two axes with a bus each. A plug is pulled at a bus: the servo's is silence, the
//! plant's is a fault of its servo.

use plant_sim::Machine;
use plant_sim::machine::PositionSensor;
use protocol::Fault;
use protocol::states::DriveState;
use workbench::axis_records::dataset_folder::DatasetFolder;
use workbench::axis_records::{self, Part, Plan};
use workbench::cli::{Commission, MachineArguments};
use workbench::commands::commission;
use workbench::compensation::AxisCompensation;
use workbench::error::Failure;
use workbench::interrupt::Interrupt;
use workbench::network::in_process::InProcess;
use workbench::network::link::Link;
use workbench::session::Session;

/// Places on the bus of an axis.
const PLANT: usize = 0;
const SERVO: usize = 1;

/// Feed of the tests, m/s; the reference axes do 0.5 m/s and 5 m/s².
const FEED_M_PER_S: f64 = 0.4;
/// A ramp of 5 m/s² from the feed: v²/2a.
const RAMP_M: f64 = FEED_M_PER_S * FEED_M_PER_S / 10.0;

/// An axis without torque rings on the presliding of its friction: 1.5 mm/s at most were seen a
/// status period after the ramp, some µm of way.
const STANDS_M_PER_S: f64 = 2.0e-3;

fn quiet() -> Machine {
    let mut machine = Machine::reference();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.actual.force_noise_n = 0.0);
    machine
}

fn ready<'a>(machine: &'a Machine, interrupt: &Interrupt) -> Session<'a, InProcess> {
    let mut session = Session::on(InProcess::new(machine, 0).unwrap(), machine, interrupt).unwrap();
    session
        .ready(&vec![AxisCompensation::default(); machine.axes.len()])
        .unwrap();
    session
}

/// X and Y accelerate to the feed at 4 m/s² and go on.
fn straight(time_s: f64) -> f64 {
    const ACCELERATION: f64 = 4.0;
    let ramp_s = FEED_M_PER_S / ACCELERATION;
    if time_s < ramp_s {
        0.5 * ACCELERATION * time_s * time_s
    } else {
        FEED_M_PER_S * (time_s - 0.5 * ramp_s)
    }
}

/// What axis Y does after something happened to X at 0.3 s, where X is asked to go `x_jump_m` aside
/// too: the way of Y to standstill, the failure that the session tells, and the session.
fn way_of_y(
    x_jump_m: f64,
    happen: impl Fn(&mut Session<'_, InProcess>),
) -> (f64, Failure, Session<'static, InProcess>) {
    let machine: &'static Machine = Box::leak(Box::new(quiet()));
    let mut session = ready(machine, &Interrupt::never());
    session
        .follow(0.3, |time_s| vec![straight(time_s); 2], |_, _| ())
        .unwrap();
    let y = session.master_mut().link_mut().plant(1);
    let begun_m = y.borrow().truth().table_m;
    happen(&mut session);
    let path = |time_s: f64| vec![straight(0.3 + time_s) + x_jump_m, straight(0.3 + time_s)];
    let failure = session.follow(0.2, path, |_, _| ()).unwrap_err();
    let truth = y.borrow().truth();
    assert!(
        truth.motor_m_per_s.abs() < STANDS_M_PER_S,
        "Y still moves: {truth:?}"
    );
    (truth.table_m - begun_m, failure, session)
}

/// The ramp, and what passes before it begins at 0.4 mm per cycle: noticing, and the cycle in which
/// the setpoint with `quick stop` is on its way.
fn assert_ramp(way_m: f64, cycles_to_notice: f64) {
    let noticing_m = FEED_M_PER_S * 1.0e-3 * (cycles_to_notice + 3.0);
    println!("Y stands after {:.2} mm", 1.0e3 * way_m);
    assert!(
        (RAMP_M - 1.0e-3..RAMP_M + noticing_m).contains(&way_m),
        "Y went {:.2} mm",
        1.0e3 * way_m
    );
}

#[test]
fn a_silent_servo_stops_the_other_axis_on_its_ramp() {
    let (way_m, failure, session) = way_of_y(0.0, |session| {
        session
            .master_mut()
            .link_mut()
            .bus_mut(0)
            .connect(SERVO, false);
    });
    assert_ramp(way_m, 3.0);
    let text = failure.to_string();
    assert!(
        text.starts_with("axis X: the servo (node 1) sent no torque for 3 cycles"),
        "{text}"
    );
    assert!(text.ends_with("the other axes were stopped"), "{text}");
    assert_eq!(
        session.master().state(1),
        Some(DriveState::SwitchOnDisabled)
    );
}

#[test]
fn a_fault_of_one_axis_stops_the_other_on_its_ramp() {
    let (way_m, failure, session) = way_of_y(0.05, |_| ());
    assert_ramp(way_m, 10.0);
    let fault = session
        .master()
        .fault(0)
        .expect("X cannot follow a jump of 50 mm");
    let text = failure.to_string();
    assert!(
        text.starts_with("axis X: the drive is not enabled (") && text.contains(fault.text()),
        "{text}"
    );
    assert!(text.ends_with("the other axes were stopped"), "{text}");
    assert_eq!(
        (session.master().fault(1), session.master().state(1)),
        (None, Some(DriveState::SwitchOnDisabled))
    );
}

#[test]
fn a_lost_plant_of_one_axis_stops_the_other_on_its_ramp() {
    let (way_m, failure, session) = way_of_y(0.0, |session| {
        session
            .master_mut()
            .link_mut()
            .bus_mut(0)
            .connect(PLANT, false);
    });
    // The fault itself comes after the feedbacks that the servo may bridge.
    assert_ramp(way_m, 10.0);
    let text = failure.to_string();
    assert!(
        text.starts_with("axis X: ") && text.ends_with("the other axes were stopped"),
        "{text}"
    );
    assert_eq!(session.master().fault(0), Some(Fault::FeedbackMissing));
    assert_eq!(
        (session.master().fault(1), session.master().state(1)),
        (None, Some(DriveState::SwitchOnDisabled))
    );
}

#[test]
fn an_interruption_stops_and_disables_all_axes_on_their_ramps() {
    let machine = quiet();
    let interrupt = Interrupt::never();
    let mut session = ready(&machine, &interrupt);
    session
        .follow(0.3, |time_s| vec![straight(time_s); 2], |_, _| ())
        .unwrap();
    interrupt.raise(libc::SIGINT);
    let before = session.cycles();
    let failure = session
        .follow(10.0, |time_s| vec![straight(0.3 + time_s); 2], |_, _| ())
        .unwrap_err();
    assert_eq!(
        failure.to_string(),
        "interrupted by SIGINT; all axes were stopped and disabled"
    );
    // 80 ms of ramp, a status period of standstill, one status period for the way down.
    let cycles = session.cycles() - before;
    assert!((80..=130).contains(&cycles), "{cycles} cycles");
    for axis in 0..2 {
        assert_eq!(
            session.master().state(axis),
            Some(DriveState::SwitchOnDisabled)
        );
        let truth = session.master_mut().link_mut().plant(axis).borrow().truth();
        assert!(truth.motor_m_per_s.abs() < STANDS_M_PER_S, "{truth:?}");
    }
}

#[test]
fn nothing_is_enabled_after_an_interruption() {
    let machine = quiet();
    let interrupt = Interrupt::never();
    let mut session =
        Session::on(InProcess::new(&machine, 0).unwrap(), &machine, &interrupt).unwrap();
    interrupt.raise(libc::SIGTERM);
    let failure = session.ready(&[]).unwrap_err();
    assert!(
        failure.to_string().starts_with("interrupted by SIGTERM"),
        "{failure}"
    );
    assert_eq!(session.cycles(), 0);
}

#[test]
fn disabling_in_motion_leaves_no_drive_in_operation() {
    let machine = quiet();
    let mut session = ready(&machine, &Interrupt::never());
    session
        .follow(0.3, |time_s| vec![straight(time_s); 2], |_, _| ())
        .unwrap();
    session.master_mut().disable().unwrap();
    for axis in 0..2 {
        assert_eq!(
            session.master().state(axis),
            Some(DriveState::SwitchOnDisabled)
        );
    }
}

#[test]
fn an_axis_that_does_not_come_up_takes_the_others_down() {
    let machine = quiet();
    let mut session = Session::on(
        InProcess::new(&machine, 0).unwrap(),
        &machine,
        &Interrupt::never(),
    )
    .unwrap();
    let master = session.master_mut();
    master.find_nodes().unwrap();
    master.configure(&machine, &[]).unwrap();
    // Without feedback no loop can be closed on X.
    master.link_mut().bus_mut(0).connect(PLANT, false);
    let text = master.enable().unwrap_err().to_string();
    assert!(text.starts_with("axis X: "), "{text}");
    assert_ne!(master.state(1), Some(DriveState::OperationEnabled));
}

#[test]
fn an_axis_is_enabled_where_the_encoder_of_its_loop_stands() {
    let mut machine = quiet();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.gains.position_sensor = PositionSensor::Motor);
    let mut session = ready(&machine, &Interrupt::never());
    // Four steps, each confirmed by a status that comes every tenth cycle at the latest.
    println!("enabled after {} cycles", session.cycles());
    assert!(
        (4..=45).contains(&session.cycles()),
        "{} cycles",
        session.cycles()
    );
    for axis in 0..2 {
        let now = session.master().axis(axis);
        assert!((now.reference_m - now.motor_m).abs() < 1.0e-6, "{now:?}");
        let way_m = session
            .master_mut()
            .link_mut()
            .plant(axis)
            .borrow()
            .truth()
            .table_m;
        assert!(
            way_m.abs() < 1.0e-6,
            "enabling moved the table by {way_m} m"
        );
    }
}

#[test]
fn frames_are_kept_where_they_are_to_be_written_and_nowhere_else() {
    let machine = quiet();
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log");
    for (log, is_kept) in [(None, false), (Some(log.as_path()), true)] {
        let link = InProcess::new(&machine, 0).unwrap();
        let session = Session::on(link, &machine, &Interrupt::never()).unwrap();
        let logs = session.perform(&[], log, |session| {
            Ok(session.master_mut().link_mut().take_logs())
        });
        let frames = logs
            .unwrap()
            .iter()
            .map(|log| log.frames().len())
            .sum::<usize>();
        assert_eq!(frames > 0, is_kept, "{frames} frames, log {log:?}");
    }
}

#[test]
fn a_record_that_breaks_off_is_on_disk_up_to_there_and_says_why() {
    let machine = quiet();
    let [train, validate] = Part::BOTH.map(|part| Plan::of(&machine, part));
    let out = tempfile::tempdir().unwrap();
    let log = out.path().join("records.candump.log");
    let session = Session::on(
        InProcess::new(&machine, 0).unwrap(),
        &machine,
        &Interrupt::never(),
    )
    .unwrap();
    let folder = out.path().join("records-Y");
    let folder_of_y = DatasetFolder {
        path: &folder,
        machine: &machine,
        axis: &machine.axes[1],
    };
    let failure = session
        .perform(&[], Some(&log), |session| {
            let mut records = Vec::new();
            axis_records::record(session, &machine, &train, &mut records)?;
            folder_of_y.write(Part::Train, &records[1], None)?;
            session
                .master_mut()
                .link_mut()
                .bus_mut(1)
                .connect(PLANT, false);
            let outcome = axis_records::record(session, &machine, &validate, &mut records);
            let broke_off = outcome.as_ref().err();
            folder_of_y.write(Part::Validate, &records[1], broke_off)?;
            outcome
        })
        .unwrap_err();
    assert!(failure.to_string().starts_with("axis Y: "), "{failure}");
    let lines = |name: &str| {
        std::fs::read_to_string(folder.join(name))
            .unwrap()
            .lines()
            .count()
    };
    assert!(lines("train.csv") > 10_000, "{}", lines("train.csv"));
    assert_eq!(
        lines("validate.csv"),
        1,
        "it broke off before its first row: only the header"
    );
    let description = std::fs::read_to_string(folder.join("dataset.toml")).unwrap();
    assert!(
        description.starts_with("# validate.csv broke off: axis Y: "),
        "{description}"
    );
    assert!(std::fs::read_to_string(&log).unwrap().lines().count() > 100_000);
}

#[test]
fn a_fault_in_the_middle_of_commissioning_leaves_the_record_so_far_and_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("weak.toml"), folder.path().join("out"));
    // The slow bursts need 520 N for friction; the fast ones 3.3 kN more, which the motor has not
    // got.
    let weak =
        Machine::reference_text().replace("force_limit_n = 9000.0", "force_limit_n = 1500.0");
    std::fs::write(&path, weak).unwrap();
    let arguments = Commission {
        machine: MachineArguments {
            machine: Some(path),
            ..MachineArguments::default()
        },
        out: out.clone(),
        tolerance_um: None,
        log: false,
        real_axes: false,
    };
    let text = commission::run(&arguments, &Interrupt::never())
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("FollowingError") && text.contains("; the other axes were stopped; "),
        "{text}"
    );
    let wanted = format!(
        "what was recorded is in {}; log: {0}/records.candump.log",
        out.display()
    );
    assert!(
        text.contains("train.csv broke off after ") && text.ends_with(&wanted),
        "{text}"
    );
    for axis in ["records-X", "records-Y"] {
        let rows = std::fs::read_to_string(out.join(axis).join("train.csv"))
            .unwrap()
            .lines()
            .count()
            - 1;
        assert!(
            text.contains(&format!("after {rows} rows")) && rows > 1000,
            "{text}"
        );
        assert!(!out.join(axis).join("validate.csv").exists());
    }
}
