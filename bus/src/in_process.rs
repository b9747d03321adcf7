//! A bus in one thread and virtual time.
//!
//! Frames go round in the order they were sent, to every station but the sender; the master (the workbench) reads its own queue.
//! When nothing is on its way and the master waits, virtual time jumps to the end of its waiting, and the stations notice.

use std::collections::VecDeque;

use protocol::CanFrame;

use crate::faults::{FaultPlan, FaultyPort};
use crate::log::BusLog;
use crate::station::{Received, Station};

/// Who put a frame on the bus: the master, or a station by its place.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sender {
    Master,
    Station(usize),
}

struct Place {
    station: Box<dyn Station>,
    port: Option<FaultyPort>,
    connected: bool,
}

/// A bus with its stations.
pub struct InProcessBus {
    places: Vec<Place>,
    queue: VecDeque<(Sender, CanFrame)>,
    for_master: VecDeque<CanFrame>,
    now_us: u64,
    ticked_us: u64,
    log: Option<BusLog>,
    received: Vec<Received>,
    sent: Vec<CanFrame>,
}

impl Default for InProcessBus {
    fn default() -> Self {
        Self::new()
    }
}

impl InProcessBus {
    /// An empty bus.
    #[must_use]
    pub fn new() -> Self {
        Self {
            places: Vec::new(),
            queue: VecDeque::new(),
            for_master: VecDeque::new(),
            now_us: 0,
            ticked_us: 0,
            log: None,
            received: Vec::new(),
            sent: Vec::new(),
        }
    }

    /// Puts a station on the bus; gives its place. It boots at once.
    pub fn add(&mut self, mut station: Box<dyn Station>) -> usize {
        let place = self.places.len();
        let mut out = Vec::new();
        station.boot(&mut out);
        self.places.push(Place { station, port: None, connected: true });
        self.queue.extend(out.into_iter().map(|frame| (Sender::Station(place), frame)));
        place
    }

    /// Gives a station's receiving port faults; `receiver` tells its decisions from those of other ports (its node id).
    pub fn inject(&mut self, place: usize, receiver: u8, plan: FaultPlan) {
        if let Some(place) = self.places.get_mut(place) {
            place.port = Some(FaultyPort::new(plan, place.station.ids(), receiver));
        }
    }

    /// Plugs a station in or out: a dead node, or a cut cable.
    pub fn connect(&mut self, place: usize, connected: bool) {
        if let Some(place) = self.places.get_mut(place) {
            place.connected = connected;
        }
    }

    /// Replaces a station by a freshly booted one.
    pub fn replace(&mut self, place: usize, mut station: Box<dyn Station>) {
        let mut out = Vec::new();
        station.boot(&mut out);
        if let Some(old) = self.places.get_mut(place) {
            old.station = station;
            old.connected = true;
        }
        self.queue.extend(out.into_iter().map(|frame| (Sender::Station(place), frame)));
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
        self.places.iter().filter_map(|place| place.port.as_ref()).map(|port| port.injected).sum()
    }

    /// Virtual time, µs.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Lets virtual time pass: a cycle of a paced run, or a pause.
    pub fn pass(&mut self, us: u64) {
        self.now_us += us;
    }

    /// The master sends a frame.
    pub fn send(&mut self, frame: CanFrame) {
        self.queue.push_back((Sender::Master, frame));
    }

    /// The master waits for a frame; `None` when none comes within `timeout_us` of virtual time.
    pub fn receive(&mut self, timeout_us: u64) -> Option<CanFrame> {
        if let Some(frame) = self.next() {
            return Some(frame);
        }
        self.now_us += timeout_us;
        self.tick();
        self.next()
    }

    fn next(&mut self) -> Option<CanFrame> {
        // A busy bus never goes quiet, so the stations notice the time once per millisecond of it here too.
        if self.now_us >= self.ticked_us + 1000 {
            self.tick();
        }
        while self.for_master.is_empty() {
            let (sender, frame) = self.queue.pop_front()?;
            self.deliver(sender, frame);
        }
        self.for_master.pop_front()
    }

    fn deliver(&mut self, sender: Sender, frame: CanFrame) {
        if let Some(log) = &mut self.log {
            log.push(self.now_us, &frame);
        }
        if sender != Sender::Master {
            self.for_master.push_back(frame);
        }
        let Self { places, queue, received, sent, now_us, .. } = self;
        for (at, place) in places.iter_mut().enumerate().filter(|(_, place)| place.connected) {
            if sender == Sender::Station(at) {
                continue;
            }
            match &mut place.port {
                None => place.station.take(Received::Frame(frame), *now_us, sent),
                Some(port) => {
                    port.receive(frame, received);
                    received.drain(..).for_each(|received| place.station.take(received, *now_us, sent));
                }
            }
            queue.extend(sent.drain(..).map(|frame| (Sender::Station(at), frame)));
        }
    }

    fn tick(&mut self) {
        self.ticked_us = self.now_us;
        let Self { places, queue, sent, now_us, .. } = self;
        for (at, place) in places.iter_mut().enumerate().filter(|(_, place)| place.connected) {
            place.station.tick(*now_us, sent);
            queue.extend(sent.drain(..).map(|frame| (Sender::Station(at), frame)));
        }
    }
}
