//! Instructions of the servo node on a Cortex-M4, and whether it answers there as it does here.
//! `cargo bench -p hil-tests --bench instructions`
//!
//! One axis of the reference machine follows a circle on the in-process bus, plain and with every
//! compensation on, and a tap at the servo's place takes down what the servo hears and answers.
//! `firmware/emulated-cycle`, an image for QEMU's mps2-an386, hears the same, compares its own
//! answers byte for byte, and measures every event of the circle. The table splits a cycle into
//! SYNC, setpoint and feedback. The worst cycle is one that happened, with its own split; the worst
//! of each event may stand in another cycle. The benchmark fails on an answer that differs, and on
//! cycles outside `hil-tests/budgets.toml` on either side.
//!
//! Blind to: time (instructions are not cycles), interrupts, the CAN controller.
//!
//! QEMU is installed where it is missing (Debian: `qemu-system-arm`). `-- --profile NAME` builds
//! the image with another cargo profile.

use std::cell::{Cell, RefCell};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::rc::Rc;
use std::time::{Duration, Instant};

use embedded_can::{Frame, Id};
use hil_tests::rig::SERVO;
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use protocol::cob::{AxisIds, FrameKind};
use protocol::sdo::Expedited;
use protocol::{CanFrame, Station};
use serde::Deserialize;
use servo::Servo;
use servo::objects::{self, Parameter};
use workbench::compensation::{Adaptive, AxisCompensation, Compensation, ELEMENTS, Model, POINTS};
use workbench::drive_parameters;
use workbench::error::Outcome;
use workbench::network::in_process::InProcess;
use workbench::network::master::Master;
use workbench::trajectory::Circle;

#[path = "../../firmware/emulated-cycle/src/recording.rs"]
mod recording;

use recording::{Class, Event, Events, FRAME};

/// The drive board's target, and the profile that its image ships with.
const TARGET: &str = "thumbv7em-none-eabihf";
const PROFILE: &str = "firmware";
/// R 10 F 1000 at 1 kHz: X reverses after 1.9 s and after 3.8 s.
const CYCLES: u32 = 4000;
/// An instruction takes 1 ns of virtual time (`-icount shift=0`), a tick of SysTick 40 ns (25 MHz).
const INSTRUCTIONS_PER_TICK: f64 = 40.0;
/// The emulated run takes about ten seconds; one that hangs is ended.
const PATIENCE: Duration = Duration::from_mins(5);

fn main() -> ExitCode {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("instructions");
    fs::create_dir_all(&folder).expect("the target folder is writable");
    have_qemu();
    let profile = option("--profile").unwrap_or_else(|| PROFILE.into());
    let image = build(&profile);
    let budgets = budgets();
    println!(
        "instructions of the servo node, {TARGET}, profile {profile}; circle R 10 F 1000, {CYCLES} cycles"
    );
    let plain = one(&folder, &image, "plain", Drive::Plain, &budgets.plain);
    let everything = one(
        &folder,
        &image,
        "everything",
        Drive::Everything,
        &budgets.everything,
    );
    let model = one(&folder, &image, "model", Drive::Model, &budgets.model);
    let notices = a_wrong_bit_is_noticed(&folder, &image);
    println!(
        "\none bit of one recorded answer turned: {}",
        if notices { "noticed" } else { "NOT NOTICED" }
    );
    if plain && everything && model && notices {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn option(name: &str) -> Option<String> {
    std::env::args()
        .skip_while(|argument| argument != name)
        .nth(1)
}

/// Records, emulates and prints one configuration; whether all is well.
fn one(folder: &Path, image: &Path, name: &str, drive: Drive, budget: &Budget) -> bool {
    let recording = folder.join(name).with_extension("bin");
    fs::write(&recording, record(drive).expect("the circle runs"))
        .expect("the target folder is writable");
    let report = emulate(image, &recording);
    fs::write(folder.join(name).with_extension("txt"), &report)
        .expect("the target folder is writable");
    Run::of(&report).print(name, budget)
}

// ---- the recording
// --------------------------------------------------------------------------------

/// What the drive does about friction, gap and resonance.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Drive {
    /// Velocity and acceleration feedforward.
    Plain,
    /// Pulse, Coulomb feedforward, backlash and a torque filter as well.
    Everything,
    /// The model of friction.
    Model,
}

/// A servo on the bus that takes down what it hears and says.
struct Tap {
    servo: Servo,
    bytes: Rc<RefCell<Vec<u8>>>,
    is_measured: Rc<Cell<bool>>,
}

impl Tap {
    fn note(&self, class: Class, now_us: u64, frame: [u8; FRAME], answers: &[CanFrame]) {
        let answers: Vec<[u8; FRAME]> = answers.iter().map(bytes).collect();
        let is_measured = self.is_measured.get();
        Event {
            class,
            is_measured,
            now_us,
            frame,
            answers: &answers,
        }
        .write(&mut *self.bytes.borrow_mut());
    }

    fn class(&self, frame: &CanFrame) -> Class {
        let Id::Standard(id) = frame.id() else {
            return Class::Other;
        };
        match self.servo.ids().classify(id) {
            Some(FrameKind::Sync) => Class::Sync,
            Some(FrameKind::Setpoint) => Class::Setpoint,
            Some(FrameKind::Feedback) => Class::Feedback,
            _ => Class::Other,
        }
    }
}

impl Station for Tap {
    fn ids(&self) -> AxisIds {
        self.servo.ids()
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        let answers = self.servo.boot().to_vec();
        self.note(Class::Boot, 0, [0; FRAME], &answers);
        answers.into_iter().for_each(send);
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let answers = self.servo.on_frame(frame, now_us).to_vec();
        self.note(self.class(frame), now_us, bytes(frame), &answers);
        answers.into_iter().for_each(send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let answers = self.servo.on_time(now_us).to_vec();
        self.note(Class::Time, now_us, [0; FRAME], &answers);
        answers.into_iter().for_each(send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.servo.wake_at_us()
    }

    fn sync_due_us(&self) -> Option<u64> {
        Station::sync_due_us(&self.servo)
    }
}

fn bytes(frame: &CanFrame) -> [u8; FRAME] {
    recording::to_bytes(frame).expect("our nodes send data frames with standard identifiers")
}

/// What the servo hears and answers from boot-up to the end of the circle; the circle is measured.
fn record(drive: Drive) -> Outcome<Vec<u8>> {
    let mut machine = Machine::reference();
    machine.axes.truncate(1);
    machine.axes[0].gains.torque_low_pass_hz = (drive == Drive::Everything).then_some(LOW_PASS_HZ);
    let (taken, is_measured) = (Rc::new(RefCell::new(Vec::new())), Rc::new(Cell::new(false)));
    let mut link = InProcess::new(&machine, 0)?;
    let servo = Servo::new(link.servo(0).borrow().ids());
    let tap = Tap {
        servo,
        bytes: Rc::clone(&taken),
        is_measured: Rc::clone(&is_measured),
    };
    link.bus_mut(0).replace(SERVO, Box::new(tap));
    let mut master = Master::start(link, &machine)?;
    configure(&mut master, &machine, drive)?;
    master.enable()?;
    is_measured.set(true);
    let circle = Circle {
        radius_m: 0.010,
        feed_m_per_s: 1.0 / 60.0,
        turns: 1,
        counter_clockwise: true,
    };
    for cycle in 1..=CYCLES {
        master.cycle(&circle.at(f64::from(cycle) * machine.period_s)[..1])?;
    }
    master.expect_enabled()?;
    Ok(with_length(&taken.borrow()))
}

/// The counter-proof: a comparison that cannot fail proves nothing. The plain recording,
/// unmeasured, with the lowest bit of its last torque turned.
fn a_wrong_bit_is_noticed(folder: &Path, image: &Path) -> bool {
    let whole = fs::read(folder.join("plain.bin")).expect("the plain recording was written before");
    let events: Vec<Event<'_>> = Events(&whole[4..]).collect();
    let last = events
        .iter()
        .rposition(|event| event.class == Class::Feedback)
        .expect("a circle has feedbacks");
    let mut turned = Vec::new();
    for (at, event) in events.iter().enumerate() {
        let mut answers = event.answers.to_vec();
        answers
            .iter_mut()
            .take(usize::from(at == last))
            .for_each(|torque| torque[FIRST_DATA_BYTE] ^= 1);
        Event {
            is_measured: false,
            answers: &answers,
            ..*event
        }
        .write(&mut turned);
    }
    let path = folder.join("turned.bin");
    fs::write(&path, with_length(&turned)).expect("the target folder is writable");
    Run::of(&emulate(image, &path)).wrong == [last.to_string()]
}

/// Behind identifier and length.
const FIRST_DATA_BYTE: usize = 3;

fn with_length(events: &[u8]) -> Vec<u8> {
    assert!(
        events.len() + 4 <= recording::SPACE,
        "the recording does not fit into the PSRAM of the emulated machine"
    );
    let length = u32::try_from(events.len()).expect("16 MiB at most");
    [&length.to_le_bytes(), events].concat()
}

/// Above the velocity loop's 30 Hz, so that the loop stays calm; the instructions do not depend on
/// it.
const LOW_PASS_HZ: f64 = 250.0;
/// Pulses near what `tune --method adaptive` finds for the reference machine. A gap that the
/// machine does not have shifts its path and harms nothing else.
fn everything() -> AxisCompensation {
    let adaptive = Adaptive {
        forward_m_per_s: [2.0e-3; POINTS],
        backward_m_per_s: [2.0e-3; POINTS],
        time_constant_s: [0.02; POINTS],
        start_delay_s: [0.002; POINTS],
        ..Adaptive::OFF
    };
    AxisCompensation {
        reversal: Compensation::Adaptive(Box::new(adaptive)),
        backlash_m: 20.0e-6,
    }
}

/// Near what `tune --method model` finds for the reference machine.
fn model() -> AxisCompensation {
    let mut model = Model {
        level_n: [40.0; ELEMENTS],
        span_m_per_s: 3.7e-3,
        lag_m: 1.3e-5,
        viscous_n_s_per_m: 2000.0,
        stiffness_n_per_m: 1.2e8,
        level_asymmetry_n: 40.0,
        way_asymmetry: 0.1,
        motor_share: [0.2; ELEMENTS],
        motor_inertia_kg: 632.0,
        ahead_s: 5.0e-4,
        damping_s: 7.5e-4,
        windup_ahead_s: 5.8e-4,
        ..Model::OFF
    };
    for (place, slip_m) in model.slip_m.iter_mut().enumerate() {
        *slip_m = 1.0e-6 * (1 + 2 * place) as f64;
    }
    for (place, factor) in model.factor.iter_mut().enumerate() {
        *factor = 1.0 + 0.3 * (-0.02 * (place * place) as f64).exp();
    }
    AxisCompensation {
        reversal: Compensation::Model(Box::new(model)),
        backlash_m: 0.0,
    }
}

fn configure(master: &mut Master<InProcess>, machine: &Machine, drive: Drive) -> Outcome<()> {
    match drive {
        Drive::Plain => master.configure(machine, &[AxisCompensation::default()]),
        Drive::Everything => {
            master.configure(machine, &[everything()])?;
            add_coulomb(master, &machine.axes[0], machine.period_s)
        }
        Drive::Model => master.configure(machine, &[model()]),
    }
}

/// A compensation file holds pulses or a Coulomb feedforward; the drive can do both at once.
fn add_coulomb(master: &mut Master<InProcess>, axis: &MachineAxis, period_s: f64) -> Outcome<()> {
    let reversal = Compensation::Coulomb { force_n: 200.0 };
    let set = drive_parameters::parameters(
        axis,
        period_s,
        &AxisCompensation {
            reversal,
            backlash_m: 0.0,
        },
    )?;
    for (entry, value) in set
        .into_iter()
        .filter(|(entry, _)| entry.parameter == Parameter::CoulombTorque)
    {
        master.download(0, entry.address, Expedited::i32(value))?;
    }
    master.download(0, objects::COMMIT, Expedited::u32(objects::COMMIT_KEY))
}

// ---- the emulated machine
// --------------------------------------------------------------------------------

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn have_qemu() {
    let is_there = |program: &str| {
        Command::new(program)
            .arg("--version")
            .stdout(Stdio::null())
            .status()
            .is_ok()
    };
    if is_there("qemu-system-arm") {
        return;
    }
    eprintln!("installing qemu-system-arm");
    let install = "run() { if [ \"$(id -u)\" = 0 ]; then \"$@\"; else sudo -n \"$@\"; fi; }
        run apt-get -qq update && run env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends install qemu-system-arm >&2";
    let installed = Command::new("sh").args(["-c", install]).status();
    assert!(
        installed.is_ok_and(|status| status.success()) && is_there("qemu-system-arm"),
        "qemu-system-arm is missing and cannot be installed: install QEMU's ARM system emulator"
    );
}

/// Builds the image in a target folder of its own, so that features and locks of the host's build
/// do not meet it.
fn build(profile: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .expect("a target folder")
        .join("cortex-m");
    hil_tests::targets::install(TARGET);
    let built = Command::new(env!("CARGO"))
        .args([
            "build",
            "--locked",
            "--package",
            "emulated-cycle",
            "--target",
            TARGET,
            "--profile",
            profile,
        ])
        .arg("--target-dir")
        .arg(&folder)
        .current_dir(root())
        .env_remove("RUSTFLAGS")
        .output()
        .expect("cargo runs");
    assert!(
        built.status.success(),
        "emulated-cycle: {}",
        String::from_utf8_lossy(&built.stderr)
    );
    folder.join(TARGET).join(profile).join("emulated-cycle")
}

/// Runs the image on a recording; gives what it reports.
fn emulate(image: &Path, recording: &Path) -> String {
    let loader = format!(
        "loader,file={},addr={:#x},force-raw=on",
        recording.display(),
        recording::ADDRESS
    );
    let mut qemu = Command::new("qemu-system-arm")
        .args([
            "-machine",
            "mps2-an386",
            "-icount",
            "shift=0",
            "-display",
            "none",
            "-monitor",
            "none",
        ])
        .args([
            "-serial",
            "none",
            "-semihosting-config",
            "enable=on,target=native",
            "-device",
            &loader,
            "-kernel",
        ])
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .expect("qemu-system-arm starts");
    let mut output = qemu.stdout.take().expect("a pipe");
    let reader = std::thread::spawn(move || {
        std::io::read_to_string(&mut output).expect("the report is text")
    });
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = qemu.try_wait().expect("a child can be asked") {
            break status;
        }
        if begun.elapsed() > PATIENCE {
            qemu.kill().expect("a child can be ended");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let report = reader.join().expect("the reader ends with the pipe");
    assert!(
        status.success(),
        "the image did not come to its end: {status}\n{}",
        last_lines(&report)
    );
    report
}

fn last_lines(report: &str) -> String {
    let lines: Vec<&str> = report.lines().collect();
    lines[lines.len().saturating_sub(5)..].join("\n")
}

// ---- the figures
// --------------------------------------------------------------------------------

/// Instructions of SYNC, setpoint and feedback together.
#[derive(Deserialize)]
struct Budget {
    mean: Bounds,
    worst: Bounds,
}

#[derive(Deserialize)]
struct Bounds {
    min: f64,
    max: f64,
}

impl Bounds {
    fn hold(&self, what: &str, instructions: f64) -> bool {
        let Self { min, max } = self;
        let is_within = (*min..=*max).contains(&instructions);
        println!(
            "  {what} cycle {instructions:.0}, budget {min} to {max}{}",
            if is_within { "" } else { ": OUTSIDE" }
        );
        is_within
    }
}

#[derive(Deserialize)]
struct Budgets {
    plain: Budget,
    everything: Budget,
    model: Budget,
}

fn budgets() -> Budgets {
    #[derive(Deserialize)]
    struct File {
        instructions_of_a_cycle: Budgets,
    }
    let text = fs::read_to_string(root().join("hil-tests/budgets.toml"))
        .expect("the budgets stand beside the benchmark");
    let file: File = toml::from_str(&text).expect("the budgets have a section for instructions");
    file.instructions_of_a_cycle
}

/// What the image reports, in instructions.
#[derive(Default)]
struct Run {
    events: Vec<(Class, f64)>,
    wrong: Vec<String>,
    replayed: u32,
    compared: u32,
}

impl Run {
    fn of(report: &str) -> Self {
        let mut run = Self::default();
        let (mut empty, mut repeats) = (0.0, 1.0);
        let number = |text: &str| text.parse::<f64>().expect("the image reports numbers");
        for line in report.lines() {
            match line.split(' ').collect::<Vec<_>>()[..] {
                ["delay", instructions, ticks] => check_clock(number(instructions), number(ticks)),
                ["empty", times, ticks] => (repeats, empty) = (number(times), number(ticks)),
                ["wrong", event] => run.wrong.push(event.to_owned()),
                ["end", events, frames] => {
                    (run.replayed, run.compared) = (number(events) as u32, number(frames) as u32);
                }
                [class, ticks] => {
                    let class = class
                        .parse()
                        .ok()
                        .and_then(Class::from_byte)
                        .expect("a class of the recording");
                    run.events.push((
                        class,
                        (number(ticks) - empty) * INSTRUCTIONS_PER_TICK / repeats,
                    ));
                }
                _ => panic!("the image reports \"{line}\""),
            }
        }
        assert!(
            run.replayed > 3 * CYCLES && run.compared > CYCLES,
            "the image compared {} answers",
            run.compared
        );
        run
    }

    fn of_class(&self, class: Class) -> Vec<f64> {
        self.events
            .iter()
            .filter(|(of, _)| *of == class)
            .map(|(_, instructions)| *instructions)
            .collect()
    }

    /// SYNC, setpoint and feedback of each cycle.
    fn cycles(&self) -> Vec<[f64; 3]> {
        let parts =
            [Class::Sync, Class::Setpoint, Class::Feedback].map(|class| self.of_class(class));
        assert!(
            parts.iter().all(|part| part.len() == CYCLES as usize),
            "a cycle has one frame of each kind"
        );
        let [sync, setpoint, feedback] = parts;
        sync.into_iter()
            .zip(setpoint)
            .zip(feedback)
            .map(|((sync, setpoint), feedback)| [sync, setpoint, feedback])
            .collect()
    }

    fn print(&self, name: &str, budget: &Budget) -> bool {
        let cycles = self.cycles();
        let sum = |cycle: &[f64; 3]| cycle.iter().sum::<f64>();
        let worst = cycles
            .iter()
            .copied()
            .max_by(|a, b| sum(a).total_cmp(&sum(b)))
            .expect("a circle has cycles");
        println!(
            "\n{name:<34}{:>8}{:>8}{:>22}",
            "mean", "worst", "in the worst cycle"
        );
        for (part, name) in ["SYNC", "setpoint", "feedback"].into_iter().enumerate() {
            let (mean, largest) = mean_and_largest(cycles.iter().map(|cycle| cycle[part]));
            println!("  {name:<32}{mean:>8.0}{largest:>8.0}{:>22.0}", worst[part]);
        }
        let (mean, largest) = mean_and_largest(cycles.iter().map(sum));
        println!(
            "  {:<32}{mean:>8.0}{largest:>8.0}{:>22.0}",
            "cycle",
            sum(&worst)
        );
        for (class, name) in [
            (Class::Time, "time passes, not in the cycle"),
            (Class::Other, "other frames, not in the cycle"),
        ] {
            let (mean, largest) = mean_and_largest(self.of_class(class).into_iter());
            println!("  {name:<32}{mean:>8.0}{largest:>8.0}");
        }
        self.print_answers() & budget.mean.hold("mean", mean) & budget.worst.hold("worst", largest)
    }

    fn print_answers(&self) -> bool {
        let Self {
            wrong,
            replayed,
            compared,
            ..
        } = self;
        println!(
            "  {compared} answers to {replayed} events compared with the host's: {} differ",
            wrong.len()
        );
        if let Some(first) = wrong.first() {
            println!("  the first one at event {first}");
        }
        wrong.is_empty()
    }
}

/// Without `-icount shift=0`, or on another clock, the figures would be noise.
fn check_clock(instructions: f64, ticks: f64) {
    let per_tick = instructions / ticks;
    let is_right = (per_tick / INSTRUCTIONS_PER_TICK - 1.0).abs() < 1.0e-3;
    assert!(
        is_right,
        "SysTick counts {per_tick:.2} instructions a tick, not {INSTRUCTIONS_PER_TICK}"
    );
}

fn mean_and_largest(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (count, sum, largest) = values.fold((0, 0.0, 0.0_f64), |(n, sum, max), v| {
        (n + 1, sum + v, max.max(v))
    });
    (
        if count == 0 {
            0.0
        } else {
            sum / f64::from(count)
        },
        largest,
    )
}
