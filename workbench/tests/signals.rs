//! Ctrl-C and SIGTERM: the first signal stops the machine and keeps what was recorded, the second
//! one ends the program at once.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::Duration;

/// The program, with its progress lines on stderr.
struct Program {
    child: Child,
    stderr: BufReader<ChildStderr>,
}

impl Program {
    fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_quadrant"))
            .args(arguments)
            .env("QUADRANT_PROGRESS", "1")
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        Self { child, stderr }
    }

    fn commission(out: &Path) -> Self {
        Self::start(&["commission", "--out", out.to_str().unwrap()])
    }

    fn wait_for(&mut self, progress: &str) {
        let mut line = String::new();
        while !line.contains(progress) {
            line.clear();
            assert!(
                self.stderr.read_line(&mut line).unwrap() > 0,
                "it ended before `{progress}`"
            );
        }
    }

    fn signal(&self, signal: i32) {
        let pid = i32::try_from(self.child.id()).unwrap();
        #[expect(unsafe_code, reason = "std has no interface that sends a signal")]
        // SAFETY: a plain system call; the child has not been waited for, so the id is its own.
        let sent = unsafe { libc::kill(pid, signal) };
        assert_eq!(sent, 0);
    }

    /// Exit code, and the lines for the user: those of the progress begin with blanks.
    fn end(mut self) -> (Option<i32>, Vec<String>) {
        let lines = self.stderr.lines().map(Result::unwrap);
        let told = lines.filter(|line| !line.starts_with(' ')).collect();
        (self.child.wait().unwrap().code(), told)
    }
}

fn lines(path: &Path) -> usize {
    std::fs::read_to_string(path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .lines()
        .count()
}

#[test]
fn ctrl_c_while_recording_keeps_the_records_and_the_log_and_exits_with_130() {
    let out = tempfile::tempdir().unwrap();
    let mut commission = Program::commission(out.path());
    commission.wait_for("recording: slow and fast runs");
    // The records take a fifth of a second on a fast machine.
    std::thread::sleep(Duration::from_millis(80));
    commission.signal(libc::SIGINT);
    let (code, told) = commission.end();
    assert_eq!(code, Some(130), "{told:?}");
    let [line] = &told[..] else {
        panic!("one line: {told:?}")
    };
    assert!(
        line.starts_with("quadrant: interrupted by SIGINT; all axes were stopped and disabled"),
        "{line}"
    );
    assert!(
        line.contains(".csv broke off after") && line.contains(&out.path().display().to_string()),
        "{line}"
    );
    for axis in ["records-X", "records-Y"] {
        assert!(
            lines(&out.path().join(axis).join("train.csv")) > 10,
            "{axis}"
        );
        let text = std::fs::read_to_string(out.path().join(axis).join("dataset.toml")).unwrap();
        assert!(
            text.starts_with("# ") && text.contains("broke off: interrupted by SIGINT"),
            "{text}"
        );
    }
    assert!(lines(&out.path().join("records.candump.log")) > 100);
    assert!(!out.path().join("report.html").exists());
}

#[test]
fn sigterm_while_identifying_ends_at_once_with_143_and_whole_records() {
    let out = tempfile::tempdir().unwrap();
    let mut commission = Program::commission(out.path());
    commission.wait_for("identifying axis X");
    commission.signal(libc::SIGTERM);
    let (code, told) = commission.end();
    assert_eq!(code, Some(143), "{told:?}");
    let wanted = format!("the records are in {}", out.path().display());
    assert!(
        told.len() == 1 && told[0].starts_with("quadrant: interrupted by SIGTERM"),
        "{told:?}"
    );
    assert!(told[0].ends_with(&wanted), "{told:?}");
    let text = std::fs::read_to_string(out.path().join("records-X/dataset.toml")).unwrap();
    assert!(!text.contains("broke off"), "{text}");
    assert!(lines(&out.path().join("records-Y/validate.csv")) > 10_000);
}

#[test]
fn sigterm_on_a_circle_keeps_its_frames() {
    let out = tempfile::tempdir().unwrap();
    let log = out.path().join("circle.log");
    let path = log.to_str().unwrap();
    // At 10 mm/min three turns take a quarter of an hour, far more than the test gives them.
    let mut circle = Program::start(&[
        "circle",
        "--radius-mm",
        "10",
        "--feed-mm-min",
        "10",
        "--candump",
        path,
    ]);
    circle.wait_for("circle R 10 mm");
    std::thread::sleep(Duration::from_millis(200));
    circle.signal(libc::SIGTERM);
    let (code, told) = circle.end();
    assert_eq!(code, Some(143), "{told:?}");
    let wanted = format!(
        "quadrant: interrupted by SIGTERM; all axes were stopped and disabled; log: {path}"
    );
    assert_eq!(told, [wanted]);
    assert!(lines(&log) > 100);
}

#[test]
fn a_second_signal_does_not_wait_for_the_machine() {
    let out = tempfile::tempdir().unwrap();
    let mut commission = Program::commission(out.path());
    commission.wait_for("recording: slow and fast runs");
    commission.signal(libc::SIGINT);
    commission.signal(libc::SIGTERM);
    let (code, told) = commission.end();
    // Where both are pending the kernel chooses which handler runs first; stopping in a controlled
    // way would have told a line.
    assert!(
        matches!(code, Some(130 | 143)) && told.is_empty(),
        "{code:?}: {told:?}"
    );
}
