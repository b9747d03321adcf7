//! A bare frame there and back: what a bus costs before any node does anything.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use bus::{CanPort, InProcessBus};
use embedded_can::{Frame as _, StandardId};
use protocol::cob::AxisIds;
use protocol::{CanFrame, Station};

use super::link::axis_ids;
use super::stopwatch::{Durations, no_durations, note};
use crate::error::{Failure, Outcome};

/// Identifiers that nobody has: above all heartbeats, beside LSS.
const THERE: u16 = 0x7F1;
const BACK: u16 = 0x7F2;
/// How long an answer is waited for.
const PATIENCE: Duration = Duration::from_millis(200);
/// How often the other end looks whether it is over.
const LOOK: Duration = Duration::from_millis(20);

fn id(raw: u16) -> Outcome<StandardId> {
    StandardId::new(raw).ok_or_else(|| Failure::new("an identifier has 11 bits"))
}

fn frame(raw: u16) -> Outcome<CanFrame> {
    let made = CanFrame::new(id(raw)?, &[0; 8]);
    made.ok_or_else(|| Failure::new("a frame has 8 bytes at most"))
}

/// Frames between two sockets on an interface, the other end a thread of its own; the bus should
/// have nothing else to do.
///
/// # Errors
/// Where the interface cannot be opened or is gone, or no frame comes back.
pub fn on_interface(name: &str, count: u32) -> Outcome<Durations> {
    let gone = |error: std::io::Error| Failure::new(format!("CAN interface {name}: {error}"));
    let open = |raw: u16| {
        CanPort::open(name, &[id(raw)?]).map_err(|error| Failure::new(error.to_string()))
    };
    let (own, other) = (open(BACK)?, open(THERE)?);
    let (there, back) = (frame(THERE)?, frame(BACK)?);
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                if matches!(other.receive(LOOK), Ok(Some(_))) && other.send(&back).is_err() {
                    break;
                }
            }
        });
        let mut trips = no_durations();
        let once = |trips: &mut Durations| {
            let begun = Instant::now();
            own.send(&there).map_err(gone)?;
            match own.receive(PATIENCE).map_err(gone)? {
                Some(_) => note(trips, begun.elapsed()),
                None => {
                    return Err(Failure::new(format!(
                        "CAN interface {name}: a frame of identifier 0x{THERE:X} did not come back within {} ms; is the interface up, and does somebody acknowledge?",
                        PATIENCE.as_millis()
                    )));
                }
            }
            Ok(())
        };
        let outcome = (0..count).try_for_each(|_| once(&mut trips));
        is_over.store(true, Ordering::Relaxed);
        outcome.map(|()| trips)
    })
}

/// Answers every frame.
struct Echo(AxisIds, CanFrame);

impl Station for Echo {
    fn ids(&self) -> AxisIds {
        self.0
    }

    fn boot(&mut self, _send: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, _frame: &CanFrame, _now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        send(self.1);
    }

    fn time(&mut self, _now_us: u64, _send: &mut dyn FnMut(CanFrame)) {}

    fn wake_at_us(&self) -> Option<u64> {
        None
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }
}

/// Frames to a station on the in-process bus that answers at once.
///
/// # Errors
/// Never: the frames are constants.
pub fn in_process(count: u32) -> Outcome<Durations> {
    let there = frame(THERE)?;
    let mut bus = InProcessBus::new();
    bus.add(Box::new(Echo(axis_ids(0)?, frame(BACK)?)));
    let mut trips = no_durations();
    for _ in 0..count {
        let begun = Instant::now();
        bus.send(there);
        if bus.receive(0).is_some() {
            note(&mut trips, begun.elapsed());
        }
    }
    Ok(trips)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_comes_back_in_process() {
        assert_eq!(in_process(100).unwrap().len(), 100);
    }

    #[test]
    fn an_interface_that_is_not_there_is_told_by_its_name() {
        let refusal = on_interface("nowhere0", 1).unwrap_err().to_string();
        assert!(refusal.contains("nowhere0"), "{refusal}");
    }
}
