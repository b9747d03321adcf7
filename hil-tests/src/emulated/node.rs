//! The emulated node in the place of the host's on an in-process bus: frames go to it as SLCAN
//! lines over the UART of its machine, and so does the time (`firmware/emulated/src/node`).
//!
//! Nothing of the node runs here. The bus asks when it wants to be woken, so it says that with
//! every answer.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use protocol::{AxisIds, CanFrame, Station};

use super::machine::qemu;
use super::rig::{AT, PASSES, WAITS, times_of};
use super::slcan::{BEL, CR, frame_of, line_of};

/// An answer takes less than a millisecond; a node that does not answer for so long never will.
const PATIENCE: Duration = Duration::from_secs(30);

/// A node on an emulated Cortex-M4, reset. It ends with the value.
pub struct EmulatedNode {
    ids: AxisIds,
    line: RefCell<Line>,
    waits_us: [Option<u64>; 2],
    _machine: Running,
}

/// A process that ends with the value.
pub struct Running(pub Child);

impl Running {
    /// The connection that the process makes; it may end instead.
    fn connects(&mut self, listener: &UnixListener) -> UnixStream {
        let waits = listener.set_nonblocking(true);
        waits.expect("a socket can be asked");
        let begun = Instant::now();
        loop {
            if let Ok((stream, _)) = listener.accept() {
                stream.set_nonblocking(false).expect("a socket can wait");
                return stream;
            }
            let ended = self.0.try_wait().expect("a child can be asked");
            assert!(
                ended.is_none() && begun.elapsed() < PATIENCE,
                "the emulator does not connect to its serial line: {ended:?}"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The image `emulated-node` with its UART somewhere, in the words of QEMU.
    fn with_uart(images: &Path, uart: &str) -> Self {
        let mut qemu = qemu();
        qemu.args(["-serial", uart])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(images.join("emulated-node"))
            .stdout(Stdio::piped());
        Self(qemu.spawn().expect("qemu-system-arm starts"))
    }

    /// The image `emulated-node` as an SLCAN adapter at a serial line, and that line.
    ///
    /// # Panics
    /// Where the emulator does not start.
    #[must_use]
    pub fn at_serial_line(images: &Path) -> (Self, String) {
        let mut machine = Self::with_uart(images, "pty");
        let said = machine.0.stdout.as_mut().expect("a pipe");
        let line = BufReader::new(said).lines().find_map(|said| {
            let said = said.expect("the emulator says text");
            let place = said.split(' ').find(|word| word.starts_with("/dev/"));
            place.map(str::to_owned)
        });
        (machine, line.expect("the emulator tells its serial line"))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

struct Line {
    heard: BufReader<UnixStream>,
    /// Time that the node was told.
    told_us: Option<u64>,
}

impl EmulatedNode {
    /// Starts the image `emulated-node`. Its ids are those of the first axis.
    ///
    /// # Panics
    /// Where the emulator does not start.
    #[must_use]
    pub fn start(images: &Path) -> Self {
        // Not in the target folder: the path of a socket has a hundred characters at most.
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let path = folder.path().join("uart");
        let listener = UnixListener::bind(&path).expect("a socket in it");
        let mut machine = Running::with_uart(images, &format!("unix:{}", path.display()));
        let stream = machine.connects(&listener);
        stream
            .set_read_timeout(Some(PATIENCE))
            .expect("a socket has a timeout");
        Self {
            ids: AxisIds::of_axis(0).expect("an axis 0"),
            line: RefCell::new(Line {
                heard: BufReader::new(stream),
                told_us: None,
            }),
            waits_us: [None; 2],
            _machine: machine,
        }
    }

    /// Says a line, and passes on what the node answers until it is ready again.
    fn say(&mut self, line: &[u8], now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let mut uart = self.line.borrow_mut();
        uart.say(line, now_us);
        loop {
            let answer = uart.hear();
            match answer.split_first() {
                None | Some((b'z', [])) => return,
                Some((&WAITS, times)) => {
                    self.waits_us = times_of(times).expect("the node says two times");
                }
                Some((&BEL, _)) => panic!("the node does not take {}", text(line)),
                Some(_) => {
                    let frame = frame_of(&answer);
                    send(frame.unwrap_or_else(|| panic!("the node says {}", text(&answer))));
                }
            }
        }
    }
}

impl Line {
    fn say(&mut self, line: &[u8], now_us: u64) {
        let mut all = Vec::new();
        if self.told_us.replace(now_us) != Some(now_us) {
            all.push(AT);
            all.extend(format!("{now_us:X}").bytes().chain([CR]));
        }
        all.extend(line);
        let sent = self.heard.get_mut().write_all(&all);
        sent.expect("the emulator takes what is sent");
    }

    /// The next line, without its end.
    fn hear(&mut self) -> Vec<u8> {
        let mut line = Vec::new();
        loop {
            let mut byte = [0];
            let heard = self.heard.read_exact(&mut byte);
            heard.expect("the node answers in time");
            match byte {
                [CR] => return line,
                // A line that is not taken has no end.
                [BEL] => return vec![BEL],
                [byte] => line.push(byte),
            }
        }
    }
}

fn text(line: &[u8]) -> String {
    String::from_utf8_lossy(line).trim_end().to_owned()
}

impl Station for EmulatedNode {
    fn ids(&self) -> AxisIds {
        self.ids
    }

    /// Opening the channel resets the node.
    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        self.say(b"O\r", 0, send);
        self.waits_us = [None; 2];
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.say(&line_of(frame), now_us, send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.say(&[PASSES, CR], now_us, send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.waits_us[0]
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.waits_us[1]
    }
}
