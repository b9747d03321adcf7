//! Instructions of the servo node on a Cortex-M4, and whether it answers there as it does here.
//! `cargo bench -p hil-tests --bench instructions`
//!
//! One axis of the reference machine follows a circle on the in-process bus, plain and with every
//! compensation on, and a tap at the servo's place takes down what the servo hears and answers.
//! `firmware/emulated`, an image for QEMU's mps2-an386, hears the same, compares its own
//! answers byte for byte, and measures every event of the circle. The table splits a cycle into
//! SYNC, setpoint and feedback. The worst cycle is one that happened, with its own split; the worst
//! of each event may stand in another cycle. The benchmark fails on an answer that differs, and on
//! cycles outside `hil-tests/budgets.toml` on either side.
//!
//! Blind to: time (instructions are not cycles), interrupts, the CAN controller.
//!
//! QEMU is installed where it is missing (Debian: `qemu-system-arm`). `-- --profile NAME` builds
//! the image with another cargo profile.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use hil_tests::emulated::machine;
use hil_tests::emulated::recorded::{Circling, Drive, Measured, record};
use hil_tests::emulated::recording::Class;
use hil_tests::emulated::report::Report;
use hil_tests::stack::Functions;
use serde::Deserialize;

/// R 10 F 1000 at 1 kHz: X reverses after 1.9 s and after 3.8 s.
const CYCLES: u32 = 4000;

fn main() -> ExitCode {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("instructions");
    fs::create_dir_all(&folder).expect("the target folder is writable");
    let profile = option("--profile").unwrap_or_else(|| machine::PROFILE.into());
    let target = folder.ancestors().nth(2).expect("a target folder");
    let image = machine::images(target, &profile).join("emulated-cycle");
    let (budgets, outside) = budgets();
    println!(
        "instructions of the servo node, {}, profile {profile}; circle R 10 F 1000, {CYCLES} cycles",
        machine::TARGET
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
    let found = Outside::of(&folder, &image);
    let outside = found.print(&outside);
    let stack = stack_is_bounded(&image, &found);
    if plain && everything && model && outside && stack {
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
    let circling = Circling {
        drive,
        cycles: CYCLES,
        measured: Measured::Circle,
        lost: &[],
        torque_lost: None,
    };
    let taken = record(circling).expect("the circle runs");
    fs::write(&recording, taken.bytes).expect("the target folder is writable");
    let report = machine::replay(image, &recording);
    fs::write(folder.join(name).with_extension("txt"), &report)
        .expect("the target folder is writable");
    Run::of(&report).print(name, budget)
}

/// Instructions outside of a cycle: of the frame that takes longest from boot-up on, and of a
/// commit of the model.
struct Outside {
    longest: f64,
    conversion: f64,
    taking_over: f64,
    /// Of any frame, commits without their conversion.
    stack_bytes: u32,
}

impl Outside {
    fn of(folder: &Path, image: &Path) -> Self {
        let circling = Circling {
            drive: Drive::Model,
            cycles: 1,
            measured: Measured::Everything,
            lost: &[],
            torque_lost: None,
        };
        let recording = folder.join("commit.bin");
        let taken = record(circling).expect("the circle begins");
        fs::write(&recording, taken.bytes).expect("the target folder is writable");
        let report = Report::of(&machine::replay(image, &recording));
        let others = report.events.iter().filter(|(of, _)| *of == Class::Other);
        let commits = |place: usize| report.commits.iter().map(move |commit| commit[place]);
        Self {
            longest: others.map(|(_, taken)| *taken).fold(0.0, f64::max),
            conversion: commits(0).fold(0.0, f64::max),
            taking_over: commits(1).fold(0.0, f64::max),
            stack_bytes: report.stack_bytes,
        }
    }

    /// Prints it; whether all is well.
    fn print(&self, budget: &OutsideBudgets) -> bool {
        println!("\noutside of a cycle");
        let frame = budget.frame.hold("longest frame", self.longest);
        let conversion = budget
            .conversion
            .hold("conversion at a commit, in thread mode", self.conversion);
        frame
            & conversion
            & budget
                .taking_over
                .hold("taking over what was converted", self.taking_over)
    }
}

/// The stack that events took, beside what the image says that they take at most: what is summed up
/// for a board ([`hil_tests::stack`]) is no less than what is there.
fn stack_is_bounded(image: &Path, outside: &Outside) -> bool {
    let image = fs::read(image).expect("the image was just run");
    let functions = Functions::of(&image).expect("an image with symbols");
    let bound = functions
        .deepest(
            &["emulated_cycle::takes", "emulated_cycle::passes"],
            &[],
            &[],
        )
        .expect("the node calls no pointers");
    let taken = outside.stack_bytes;
    let is_within = taken <= bound.bytes + ALIGNMENT && 4 * taken >= bound.bytes;
    println!(
        "  stack of an event {taken} bytes, at most {}{}",
        bound.bytes,
        if is_within { "" } else { ": OUTSIDE" }
    );
    is_within
}

/// The frame of whoever looks, bytes.
const ALIGNMENT: u32 = 64;

// ---- the figures
// --------------------------------------------------------------------------------

/// Instructions of what belongs to no cycle.
#[derive(Deserialize)]
struct OutsideBudgets {
    frame: Bounds,
    conversion: Bounds,
    taking_over: Bounds,
}

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
            "  {what} {instructions:.0}, budget {min} to {max}{}",
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

fn budgets() -> (Budgets, OutsideBudgets) {
    #[derive(Deserialize)]
    struct File {
        instructions_of_a_cycle: Budgets,
        instructions_outside_of_a_cycle: OutsideBudgets,
    }
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/budgets.toml"))
        .expect("the budgets stand beside the benchmark");
    let file: File = toml::from_str(&text).expect("the budgets have a section for instructions");
    (
        file.instructions_of_a_cycle,
        file.instructions_outside_of_a_cycle,
    )
}

/// What the image reports, as cycles.
struct Run(Report);

impl Run {
    fn of(report: &str) -> Self {
        let report = Report::of(report);
        assert!(
            report.replayed > 3 * CYCLES && report.compared > CYCLES,
            "the image compared {} answers",
            report.compared
        );
        Self(report)
    }

    fn of_class(&self, class: Class) -> Vec<f64> {
        self.0
            .events
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
        self.print_answers()
            & budget.mean.hold("mean cycle", mean)
            & budget.worst.hold("worst cycle", largest)
    }

    fn print_answers(&self) -> bool {
        let Report {
            wrong,
            replayed,
            compared,
            ..
        } = &self.0;
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
