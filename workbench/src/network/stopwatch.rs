//! A stopwatch at the buses: a link that notes when the frames of each cycle went by, as the
//! workbench sees them.
//!
//! ```text
//! begin of the cycle   SYNC sent        feedback seen      torque seen
//!   ├───────────────────┼─────────────────┼──────────────────┤
//!    lateness (clock)        plant              drive
//!                       └───────────── cycle ────────────────┘  of the last axis
//! ```

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use bus::BusLog;
use hdrhistogram::Histogram;
use plant_sim::node::Truth;
use protocol::cob::AxisIds;
use protocol::message::{Decoded, decode};
use protocol::{CanFrame, Message, Station, SyncCounter};

use super::link::{Link, axis_ids};
use crate::error::Outcome;

/// Durations in ns, to three digits, up to a minute.
pub type Durations = Histogram<u64>;

const LONGEST_NS: u64 = 60_000_000_000;

/// No durations yet.
///
/// # Panics
/// Never: the bounds are constants that fit.
#[must_use]
pub fn no_durations() -> Durations {
    Histogram::new_with_bounds(1, LONGEST_NS, 3).expect("the bounds fit")
}

/// Notes a duration; one beyond a minute as a minute.
pub fn note(durations: &mut Durations, duration: Duration) {
    let nanos = u64::try_from(duration.as_nanos()).unwrap_or(LONGEST_NS);
    durations.saturating_record(nanos.max(1));
}

/// What a stopwatch has noted of the cycles while it ran.
#[derive(Clone, Debug)]
pub struct Times {
    /// Cycles that ended with the torques of all axes.
    pub cycles: u64,
    /// Cycles in which one stayed away, or that the clock has passed over.
    pub missed: u64,
    /// From when a cycle was due to when it began; empty without a clock.
    pub lateness: Durations,
    /// From the begin of a cycle to that of the next.
    pub interval: Durations,
    /// From SYNC to the torque of the last axis.
    pub cycle: Durations,
    /// From SYNC to the feedback of each axis on the first bus.
    pub feedback: Durations,
    /// From the feedback of an axis on the first bus to its torque.
    pub drive: Durations,
}

impl Times {
    fn none() -> Self {
        Self {
            cycles: 0,
            missed: 0,
            lateness: no_durations(),
            interval: no_durations(),
            cycle: no_durations(),
            feedback: no_durations(),
            drive: no_durations(),
        }
    }
}

/// What is known of an axis in the present cycle.
#[derive(Clone, Copy, Default)]
struct Seen {
    feedback: Option<Instant>,
    torque: Option<Instant>,
}

struct Noted {
    runs: bool,
    begun: Option<Instant>,
    sync: Option<(Instant, SyncCounter)>,
    seen: Vec<Seen>,
    /// Whether an axis is on the bus that is read first. On the others frames are read when those
    /// of the first have all come, so when they came is not known.
    on_first_bus: Vec<bool>,
    times: Times,
}

impl Noted {
    fn begins(&mut self, now: Instant, late: Option<Duration>, skipped: u32) {
        self.end();
        let before = self.begun.replace(now);
        if !self.runs {
            return;
        }
        self.times.missed += u64::from(skipped);
        if let Some(late) = late {
            note(&mut self.times.lateness, late);
        }
        if let Some(before) = before {
            note(&mut self.times.interval, now - before);
        }
    }

    /// The present cycle is over.
    fn end(&mut self) {
        let Some((sync, _)) = self.sync.take() else {
            return;
        };
        let last = self.seen.iter().try_fold(sync, |last, axis| {
            axis.torque.map(|torque| torque.max(last))
        });
        match last {
            Some(last) => {
                self.times.cycles += 1;
                note(&mut self.times.cycle, last - sync);
            }
            None => self.times.missed += 1,
        }
        for (axis, is_first) in self.seen.iter_mut().zip(&self.on_first_bus) {
            let Seen { feedback, torque } = std::mem::take(axis);
            let Some(feedback) = feedback.filter(|_| *is_first) else {
                continue;
            };
            note(&mut self.times.feedback, feedback - sync);
            if let Some(torque) = torque {
                note(
                    &mut self.times.drive,
                    torque.saturating_duration_since(feedback),
                );
            }
        }
    }
}

/// Starts and stops a [`Stopwatch`], and reads it.
#[derive(Clone)]
pub struct Button(Rc<RefCell<Noted>>);

impl Button {
    /// From now on cycles are noted.
    pub fn start(&self) {
        let mut noted = self.0.borrow_mut();
        noted.runs = true;
        noted.begun = None;
    }

    /// Cycles are noted no longer; gives what was. The present one counts.
    #[must_use]
    pub fn stop(&self) -> Times {
        let mut noted = self.0.borrow_mut();
        noted.end();
        noted.runs = false;
        std::mem::replace(&mut noted.times, Times::none())
    }
}

/// A link with a stopwatch.
pub struct Stopwatch<L> {
    link: L,
    /// Ids and bus of each axis.
    axes: Vec<(AxisIds, usize)>,
    noted: Rc<RefCell<Noted>>,
}

impl<L: Link> Stopwatch<L> {
    /// At a link to such a number of axes; the button starts it.
    ///
    /// # Errors
    /// Beyond 16 axes.
    pub fn at(link: L, axes: usize) -> Outcome<(Self, Button)> {
        let of_axis = |axis: usize| Ok((axis_ids(axis)?, link.bus_of(axis)));
        let axes = (0..axes).map(of_axis).collect::<Outcome<Vec<_>>>()?;
        let noted = Rc::new(RefCell::new(Noted {
            runs: false,
            begun: None,
            sync: None,
            seen: vec![Seen::default(); axes.len()],
            on_first_bus: axes.iter().map(|(_, bus)| *bus == 0).collect(),
            times: Times::none(),
        }));
        let button = Button(Rc::clone(&noted));
        Ok((Self { link, axes, noted }, button))
    }

    fn note(&self, bus: usize, frame: &CanFrame) {
        let now = Instant::now();
        let mut noted = self.noted.borrow_mut();
        let Some((_, counter)) = noted.sync else {
            return;
        };
        let axes = self.axes.iter().zip(&mut noted.seen);
        for ((ids, _), seen) in axes.filter(|((_, own), _)| *own == bus) {
            match decode(*ids, frame) {
                Ok(Decoded::Message(Message::Feedback(own))) if own.counter == counter => {
                    seen.feedback.get_or_insert(now);
                }
                Ok(Decoded::Message(Message::Torque(own))) if own.counter == counter => {
                    seen.torque.get_or_insert(now);
                }
                _ => {}
            }
        }
    }
}

impl<L: Link> Link for Stopwatch<L> {
    fn buses(&self) -> usize {
        self.link.buses()
    }

    fn bus_of(&self, axis: usize) -> usize {
        self.link.bus_of(axis)
    }

    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()> {
        let mut noted = self.noted.borrow_mut();
        if noted.runs
            && noted.sync.is_none()
            && let Some((ids, _)) = self.axes.first()
            && let Ok(Decoded::Message(Message::Sync(counter))) = decode(*ids, &frame)
        {
            noted.sync = Some((Instant::now(), counter));
        }
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
        let received = self.link.receive_in_cycle(bus, most)?;
        if let Some(frame) = &received {
            self.note(bus, frame);
        }
        Ok(received)
    }

    fn pass(&mut self, cycle: Duration) -> u32 {
        let skipped = self.link.pass(cycle);
        let late = self.link.lateness();
        self.noted
            .borrow_mut()
            .begins(Instant::now(), late, skipped);
        skipped
    }

    fn follows_clock(&self) -> bool {
        self.link.follows_clock()
    }

    fn scheduling(&self) -> Option<String> {
        self.link.scheduling()
    }

    fn is_due(&self) -> bool {
        self.link.is_due()
    }

    fn lateness(&self) -> Option<Duration> {
        self.link.lateness()
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

/// A station whose own work is timed: all that it does for one torque.
pub struct Watched<S> {
    station: S,
    worked: Duration,
    steps: Rc<RefCell<Durations>>,
}

impl<S: Station> Watched<S> {
    /// A station, and where its steps are noted.
    pub const fn new(station: S, steps: Rc<RefCell<Durations>>) -> Self {
        Self {
            station,
            worked: Duration::ZERO,
            steps,
        }
    }

    /// Does some work that may send frames.
    fn work(
        &mut self,
        send: &mut dyn FnMut(CanFrame),
        work: impl FnOnce(&mut S, &mut dyn FnMut(CanFrame)),
    ) {
        let (ids, mut is_done) = (self.station.ids(), false);
        let begun = Instant::now();
        work(&mut self.station, &mut |frame| {
            let message = decode(ids, &frame);
            is_done |= matches!(message, Ok(Decoded::Message(Message::Torque(_))));
            send(frame);
        });
        self.worked += begun.elapsed();
        if is_done {
            note(&mut self.steps.borrow_mut(), self.worked);
            self.worked = Duration::ZERO;
        }
    }
}

impl<S: Station> Station for Watched<S> {
    fn ids(&self) -> AxisIds {
        self.station.ids()
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        self.station.boot(send);
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.work(send, |station, send| station.take(frame, now_us, send));
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.work(send, |station, send| station.time(now_us, send));
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.station.wake_at_us()
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.station.sync_due_us()
    }
}
