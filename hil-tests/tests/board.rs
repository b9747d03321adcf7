//! The board images link within their budgets, and no panic is reachable from the control path.
//! Linking is not booting.

use std::path::{Path, PathBuf};
use std::process::Command;

use hil_tests::stack::{Chain, Functions, Rule};
use hil_tests::targets;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf};
use serde::Deserialize;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_path_buf()
}

/// Builds a leaf for a Cortex-M target, in a target folder of its own so that it does not wait for
/// the tests' lock; gives the image.
fn build(package: &str, target: &str, profile: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .unwrap()
        .join("cortex-m");
    targets::install(target);
    let built = Command::new(env!("CARGO"))
        .args([
            "build",
            "--locked",
            "--package",
            package,
            "--target",
            target,
            "--profile",
            profile,
            "--target-dir",
        ])
        .arg(&folder)
        .current_dir(root())
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{package}: {}",
        String::from_utf8_lossy(&built.stderr)
    );
    folder.join(target).join(profile).join(package)
}

#[derive(Deserialize)]
struct Budget {
    min: u64,
    max: u64,
    of: u64,
}

#[derive(Deserialize)]
struct Image {
    flash: Budget,
    static_ram: Budget,
    stack: Budget,
    ram: Budget,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Budgets {
    board_g431: Image,
    board_g474: Image,
}

fn check(what: &str, used: u64, budget: &Budget) {
    println!(
        "{what}: {used} of {} bytes ({:.1} %)",
        budget.of,
        100.0 * used as f64 / budget.of as f64
    );
    assert!(
        (budget.min..=budget.max).contains(&used),
        "{what}: {used} bytes, budget {} to {}",
        budget.min,
        budget.max
    );
}

#[test]
fn the_board_images_link_within_their_budgets_with_vector_table_and_entry() {
    let text = std::fs::read_to_string(root().join("hil-tests/budgets.toml")).unwrap();
    let budgets: Budgets = toml::from_str(&text).unwrap();
    for (board, budget) in [
        ("board-g431", &budgets.board_g431),
        ("board-g474", &budgets.board_g474),
    ] {
        println!("{board}");
        links(board, budget);
    }
}

fn links(board: &str, budget: &Image) {
    let image = build(board, "thumbv7em-none-eabihf", "firmware");
    let bytes = std::fs::read(&image).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let (mut flash, mut ram) = (0, 0);
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 || section.address() < 0x0800_0000 {
            continue;
        }
        let in_ram = (0x2000_0000..0x2000_8000).contains(&section.address());
        let is_stored = section.kind() != SectionKind::UninitializedData;
        flash += if is_stored { section.size() } else { 0 };
        ram += if in_ram { section.size() } else { 0 };
    }
    check("flash", flash, &budget.flash);
    check("static RAM", ram, &budget.static_ram);
    let stack = worst_stack(&bytes);
    check("stack at worst", stack, &budget.stack);
    check("RAM with it", ram + stack, &budget.ram);

    let table = file.section_by_name(".vector_table").unwrap();
    assert_eq!(table.address(), 0x0800_0000);
    let words: Vec<u32> = table
        .data()
        .unwrap()
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
        .collect();
    assert_eq!(
        words[0],
        0x2000_0000 + 22 * 1024,
        "initial stack pointer at the end of RAM"
    );
    let reset = file
        .symbols()
        .find(|symbol| symbol.name() == Ok("Reset"))
        .unwrap()
        .address();
    assert_eq!(
        u64::from(words[1]) | 1,
        reset | 1,
        "the reset vector points to Reset"
    );
    assert_eq!(file.entry() | 1, reset | 1);
    // Numbers of interrupts: RM0440 table 97.
    for (name, number) in [("PVD_PVM", 1), ("FDCAN1_IT0", 21), ("USART3", 39)] {
        let handler = file.symbols().find(|symbol| symbol.name() == Ok(name));
        let handler = handler.unwrap_or_else(|| panic!("no {name}")).address();
        assert_eq!(u64::from(words[16 + number]) | 1, handler | 1, "{name}");
        assert_ne!(handler | 1, default_handler(&file) | 1, "{name}");
    }
    let known = PRIORITIES.iter().flat_map(|(_, roots)| *roots);
    let known: Vec<u64> = known.map(|name| address_of(&file, name)).collect();
    for handler in words.iter().skip(16).filter(|word| **word != 0) {
        let handler = u64::from(*handler) & !1;
        let is_known = handler == default_handler(&file) & !1 || known.contains(&handler);
        assert!(is_known, "{handler:#x} has no priority in {PRIORITIES:?}");
    }
}

fn address_of(file: &object::File<'_>, name: &str) -> u64 {
    let found = file.symbols().find(|symbol| symbol.name() == Ok(name));
    found.unwrap_or_else(|| panic!("no {name}")).address() & !1
}

/// Who runs: thread mode, and an interrupt of each priority on top of it.
const PRIORITIES: [(&str, &[&str]); 4] = [
    ("thread", &["Reset"]),
    ("node", &["USART3"]),
    ("CAN", &["FDCAN1_IT0"]),
    (
        "time and supply, and what nobody has given a priority",
        &["TIM1_BRK_TIM15", "PVD_PVM", "FDCAN1_IT1"],
    ),
];
/// Makes the node, once, before it runs.
const MAKES: &[&str] = &["drive_board::servo"];
/// What an interrupt puts onto the stack: registers, those of the FPU, and a word to align them
/// (Armv7-M Architecture Reference Manual, B1.5.7).
const INTERRUPT: u64 = 4 * (8 + 18 + 1);
/// What the node's task calls, and none of thread mode.
const NODE: &[&str] = &["servo::frames_in"];
/// What embassy calls by a pointer: tasks by an executor, wakers by everybody, and a channel whose
/// size is not known by whoever receives of it.
const POINTERS: [Rule; 4] = [
    Rule {
        of: &["thread::Executor::run"],
        calls: &["TaskStorage<F>::poll"],
        but_for_callers_of: NODE,
    },
    Rule {
        of: &["USART3"],
        calls: &["TaskStorage<F>::poll"],
        but_for_callers_of: MAKES,
    },
    Rule {
        of: &[
            "DynamicChannel",
            "drop_in_place<embassy_sync::channel",
            "RawMutex>::lock",
            "_embassy_time_schedule_wake",
            "Queue::next_expiration",
        ],
        calls: &["raw::waker::"],
        but_for_callers_of: &[],
    },
    Rule {
        of: &[
            "FDCAN1_IT0",
            "RxMode::on_interrupt",
            "TaskStorage<F>::poll",
            "drive_board::transmit",
        ],
        calls: &["raw::waker::", "DynamicChannel"],
        but_for_callers_of: &[],
    },
];

/// Stack of thread mode and of an interrupt of each priority, one on the other: while the node
/// runs, or while it is made.
fn worst_stack(image: &[u8]) -> u64 {
    let functions = Functions::of(image).unwrap();
    let own = |(what, roots): (&str, &[&str]), ends| {
        let Chain { bytes, frames } = functions.deepest(roots, &POINTERS, ends).unwrap();
        println!("  {what}: {bytes} bytes");
        for (name, frame) in frames.iter().filter(|(_, frame)| *frame >= 64) {
            println!("    {frame:5} {name}");
        }
        u64::from(bytes)
    };
    let [thread, node, can, time] = PRIORITIES.map(|priority| own(priority, MAKES));
    let boot = own(("thread, while the node is made", PRIORITIES[0].1), &[]);
    (thread + INTERRUPT + node).max(boot) + 2 * INTERRUPT + can + time
}

fn default_handler(file: &object::File<'_>) -> u64 {
    let mut symbols = file.symbols();
    let found = symbols.find(|symbol| symbol.name() == Ok("DefaultHandler_"));
    found.map_or(0, |symbol| symbol.address())
}

#[test]
fn no_panic_no_float_and_no_long_division_is_reachable_from_the_control_path() {
    let image = build("control-path", "thumbv7em-none-eabi", "proof");
    let bytes = std::fs::read(&image).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let names: Vec<&str> = file
        .symbols()
        .filter_map(|symbol| symbol.name().ok())
        .collect();
    for entry in [
        "entry_new",
        "entry_boot",
        "entry_frame",
        "entry_time",
        "entry_due",
    ] {
        assert!(names.contains(&entry), "{entry} is not in the image");
    }
    let soft = |name: &&&str| {
        name.starts_with("__aeabi_f")
            || name.starts_with("__aeabi_d")
            || name.ends_with("ldivmod")
            || name.contains("panic")
    };
    assert_eq!(
        names.iter().filter(soft).collect::<Vec<_>>(),
        Vec::<&&str>::new()
    );
    let text = file.section_by_name(".text").unwrap().size();
    println!("control path: {text} bytes of code");
    assert!(
        (10_000..75_000).contains(&text),
        "{text} bytes of code: is the control path really in it?"
    );
}

#[test]
fn the_proof_would_notice_a_panic() {
    // The same leaf with a panic in it must not link: otherwise the proof proves nothing.
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("panics.rs");
    let body = "#![no_std]\n#![no_main]\nunsafe extern \"C\" { safe fn a_panic_is_reachable_from_the_control_path() -> !; }\n\
                #[panic_handler] fn panic(_: &core::panic::PanicInfo<'_>) -> ! { a_panic_is_reachable_from_the_control_path() }\n\
                #[unsafe(no_mangle)] extern \"C\" fn entry(data: &[u8; 4], at: usize) -> u8 { data[at] }\n";
    std::fs::write(&source, body).unwrap();
    let target = "thumbv7em-none-eabi";
    targets::install(target);
    let linked = Command::new("rustc")
        .args([
            "--edition=2024",
            "--target",
            target,
            "-C",
            "opt-level=3",
            "-C",
            "panic=abort",
            "-C",
            "link-arg=--entry=entry",
            "-o",
        ])
        .arg(folder.path().join("panics"))
        .arg(&source)
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&linked.stderr);
    assert!(
        !linked.status.success() && message.contains("a_panic_is_reachable_from_the_control_path"),
        "{message}"
    );
}
