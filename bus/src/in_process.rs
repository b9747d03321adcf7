//! A bus in one thread and virtual time: a discrete-event driver of its stations.
//!
//! Frames go round in the order they were sent, to every station but the sender, and take no time.
//! The master (the workbench) is no station: it reads its own queue. Time stands still while a
//! frame is on its way. When none is and the master waits, time jumps to the earliest
//! [`Station::wake_at_us`], that station acts, and what it sent goes round before the next one;
//! where no station is due, time jumps to the end of the waiting. Ties go by place. So a cycle
//! whose frames all come closes before any deadline, and the same run says the same bytes every
//! time.
//!
//! ```text
//! pass ─▶ SYNC, setpoints ─▶ feedback, torque        (all at t_k: nothing waits)
//! pass ─▶ SYNC, setpoints ─▶ feedback (lost)
//!                              time jumps to t_k + D ─▶ the servo closes the cycle ─▶ torque
//! ```

use std::collections::VecDeque;

use protocol::{CanFrame, Station};

use crate::faults::{FaultPlan, FaultyPort};
use crate::log::BusLog;

/// Who put a frame on the bus: the master, or a station by its place.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sender {
    Master,
    Station(usize),
}

/// What a place is good for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Plug {
    /// Frames and time.
    In,
    /// The cable is cut: time goes on, frames go nowhere.
    Out,
    /// The node is dead.
    Dead,
}

struct Place {
    station: Box<dyn Station>,
    port: Option<FaultyPort>,
    plug: Plug,
}

/// Wakes at one time after which a station counts as broken. A node has a handful of reasons to
/// wake; one that was dead for ten minutes and is connected again catches up on 600 000 cycles.
const WAKES_AT_ONE_TIME: u32 = 5_000_000;

/// A bus with its stations.
#[derive(Default)]
pub struct InProcessBus {
    places: Vec<Place>,
    queue: VecDeque<(Sender, CanFrame)>,
    for_master: VecDeque<CanFrame>,
    now_us: u64,
    cycle_start_us: Option<u64>,
    log: Option<BusLog>,
    received: Vec<CanFrame>,
    wakes_at_now: u32,
}

impl InProcessBus {
    /// An empty bus.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts a station on the bus; gives its place. It boots at once.
    pub fn add(&mut self, station: Box<dyn Station>) -> usize {
        let place = self.places.len();
        self.places.push(Place {
            station,
            port: None,
            plug: Plug::In,
        });
        self.boot(place);
        place
    }

    /// Gives a station's receiving port faults; `receiver` tells its decisions from those of other
    /// ports (its node id).
    pub fn inject(&mut self, place: usize, receiver: u8, plan: FaultPlan) {
        let place = &mut self.places[place];
        place.port = Some(FaultyPort::new(plan, place.station.ids(), receiver));
    }

    /// Cuts a station's cable, or mends it. The station lives on without frames.
    pub fn connect(&mut self, place: usize, connected: bool) {
        self.places[place].plug = if connected { Plug::In } else { Plug::Out };
    }

    /// Ends a station: no frames and no time, until it is connected or replaced.
    pub fn kill(&mut self, place: usize) {
        self.places[place].plug = Plug::Dead;
    }

    /// Replaces a station by a freshly booted one.
    pub fn replace(&mut self, place: usize, station: Box<dyn Station>) {
        self.places[place].station = station;
        self.places[place].plug = Plug::In;
        self.boot(place);
    }

    fn boot(&mut self, at: usize) {
        self.places[at]
            .station
            .boot(&mut |frame| self.queue.push_back((Sender::Station(at), frame)));
    }

    /// Logs every frame from now on.
    pub fn log(&mut self, log: BusLog) {
        self.log = Some(log);
    }

    /// The log so far, which ends here.
    pub fn take_log(&mut self) -> Option<BusLog> {
        self.log.take()
    }

    /// Faults injected so far, over all ports.
    #[must_use]
    pub fn injected(&self) -> u32 {
        self.places
            .iter()
            .filter_map(|place| place.port.as_ref())
            .map(|port| port.injected)
            .sum()
    }

    /// Virtual time, µs.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// When the master's present cycle began, µs; `None` before the first.
    #[must_use]
    pub const fn cycle_start_us(&self) -> Option<u64> {
        self.cycle_start_us
    }

    /// The master's next cycle begins: one period after the present one, whenever the master asks;
    /// at once if that time is over already, and for the first cycle. What is due before it happens
    /// first.
    pub fn pass(&mut self, period_us: u64) {
        let start = self.cycle_start_us.map_or(self.now_us, |start| {
            start.saturating_add(period_us).max(self.now_us)
        });
        self.settle();
        // What is due at the start itself is done by the station when SYNC comes, before it takes
        // it.
        while let Some((at, due)) = self.next_wake().filter(|(_, due)| *due < start) {
            self.wake(at, due);
            self.settle();
        }
        self.now_us = start;
        self.cycle_start_us = Some(start);
    }

    /// The master sends a frame.
    pub fn send(&mut self, frame: CanFrame) {
        self.queue.push_back((Sender::Master, frame));
    }

    /// The master waits for a frame; `None` when none comes within `timeout_us` of virtual time.
    pub fn receive(&mut self, timeout_us: u64) -> Option<CanFrame> {
        self.receive_until(self.now_us.saturating_add(timeout_us))
    }

    /// The master waits for a frame; `None` when none has come by `end_us`.
    pub fn receive_until(&mut self, end_us: u64) -> Option<CanFrame> {
        loop {
            if let Some(frame) = self.next_for_master() {
                return Some(frame);
            }
            match self.next_wake().filter(|(_, due)| *due <= end_us) {
                Some((at, due)) => self.wake(at, due),
                None => {
                    self.now_us = self.now_us.max(end_us);
                    return None;
                }
            }
        }
    }

    fn next_for_master(&mut self) -> Option<CanFrame> {
        while self.for_master.is_empty() {
            let (sender, frame) = self.queue.pop_front()?;
            self.deliver(sender, frame);
        }
        self.for_master.pop_front()
    }

    /// Delivers what is on its way, and what that causes.
    fn settle(&mut self) {
        while let Some((sender, frame)) = self.queue.pop_front() {
            self.deliver(sender, frame);
        }
    }

    fn deliver(&mut self, sender: Sender, frame: CanFrame) {
        if let Sender::Station(at) = sender
            && self.places[at].plug != Plug::In
        {
            return;
        }
        if let Some(log) = &mut self.log {
            log.push(self.now_us, &frame);
        }
        if sender != Sender::Master {
            self.for_master.push_back(frame);
        }
        for at in 0..self.places.len() {
            if sender != Sender::Station(at) && self.places[at].plug == Plug::In {
                self.hand_over(at, frame);
            }
        }
    }

    fn hand_over(&mut self, at: usize, frame: CanFrame) {
        let Self {
            places,
            queue,
            received,
            now_us,
            ..
        } = self;
        let Place { station, port, .. } = &mut places[at];
        let mut send = |frame| queue.push_back((Sender::Station(at), frame));
        match port {
            None => station.take(&frame, *now_us, &mut send),
            Some(port) => {
                port.receive(frame, received);
                received
                    .drain(..)
                    .for_each(|frame| station.take(&frame, *now_us, &mut send));
            }
        }
    }

    /// Which living station is due first, and when.
    fn next_wake(&self) -> Option<(usize, u64)> {
        let living = self
            .places
            .iter()
            .enumerate()
            .filter(|(_, place)| place.plug != Plug::Dead);
        let due = living.filter_map(|(at, place)| place.station.wake_at_us().map(|due| (at, due)));
        due.min_by_key(|(at, due)| (*due, *at))
    }

    /// One station acts at the time when it is due.
    ///
    /// # Panics
    /// Where stations are due again and again without end: virtual time could not go on.
    fn wake(&mut self, at: usize, due_us: u64) {
        self.wakes_at_now = if due_us > self.now_us {
            0
        } else {
            self.wakes_at_now + 1
        };
        assert!(
            self.wakes_at_now < WAKES_AT_ONE_TIME,
            "place {at} is due again and again at {} µs",
            self.now_us
        );
        let Self {
            places,
            queue,
            now_us,
            ..
        } = self;
        *now_us = due_us.max(*now_us);
        places[at].station.time(*now_us, &mut |frame| {
            queue.push_back((Sender::Station(at), frame));
        });
    }
}
