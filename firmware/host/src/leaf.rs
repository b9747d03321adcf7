//! One station at one port: what delivers its frames and tells it the time.
//!
//! - *Lock-step*: time is [bus time](protocol::lockstep_time). Where no frame comes for the
//!   deadline, the station does what is due next. After three deadlines without a frame of the
//!   workbench it is gone, and time follows the clock until the workbench says something again.
//! - *Clock pace*: time is the clock, and the station wakes when it is due.

use std::convert::Infallible;
use std::io;

use board_timing::contract::{Contract, Due};
use bus::FaultyPort;
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use embedded_can::{Frame, Id, StandardId};
use protocol::cob::FrameKind;
use protocol::leaf::{LeafReport, StartedBy, Timed};
use protocol::table::{FRAMES, Sender};
use protocol::{CanFrame, LockstepTime, Station};

use crate::port::Port;

/// Deadlines without a frame of the workbench after which it counts as gone. One is a lost frame,
/// two are a lost SYNC and a lost frame; the workbench waits for one and a half.
const DEADLINES_UNTIL_ALONE: u8 = 3;

/// A station with its port.
pub(crate) struct Leaf {
    station: Box<dyn Station>,
    of_workbench: Vec<StandardId>,
    torque: Id,
    port: Port,
    faults: Option<FaultyPort>,
    received: Vec<CanFrame>,
    time: LockstepTime,
    /// What the station does is timed.
    is_timed: bool,
}

fn ns_since(begun: std::time::Instant) -> u32 {
    u32::try_from(begun.elapsed().as_nanos()).unwrap_or(u32::MAX)
}

/// The clock, counted on from a bus time.
#[derive(Clone, Copy)]
struct ClockTime {
    from: Instant,
    from_us: u64,
}

impl ClockTime {
    fn from(now_us: u64) -> Self {
        Self {
            from: Instant::now(),
            from_us: now_us,
        }
    }

    fn now_us(self) -> u64 {
        self.from_us.saturating_add(self.from.elapsed().as_micros())
    }

    fn at(self, us: u64) -> Instant {
        self.from + Duration::from_micros(us.saturating_sub(self.from_us))
    }
}

impl Leaf {
    pub(crate) fn new(station: Box<dyn Station>, port: Port, faults: Option<FaultyPort>) -> Self {
        let ids = station.ids();
        let of_workbench = FRAMES
            .iter()
            .filter(|spec| spec.sender == Sender::Workbench);
        let of_workbench = of_workbench.map(|spec| ids.identifier(spec.kind)).collect();
        Self {
            station,
            of_workbench,
            torque: ids.identifier(FrameKind::Torque).into(),
            port,
            faults,
            received: Vec::new(),
            time: LockstepTime::default(),
            is_timed: false,
        }
    }

    /// The boot-up message.
    pub(crate) fn boot(&mut self) -> io::Result<()> {
        self.act(|station, _, send| station.boot(send)).map(|_| ())
    }

    /// Runs in lock-step until the port fails.
    pub(crate) async fn in_step(
        &mut self,
        deadline: std::time::Duration,
    ) -> io::Result<Infallible> {
        loop {
            let mut silent = 0;
            while silent < DEADLINES_UNTIL_ALONE {
                let deadlines = LockstepTime::deadlines_to_wait(self.station.as_ref());
                match self
                    .port
                    .receive(Some(deadline * u32::from(deadlines)))
                    .await?
                {
                    Some(frame) => {
                        silent = if self.is_of_workbench(&frame) {
                            0
                        } else {
                            silent
                        };
                        self.deliver(frame, Self::take_in_step)?;
                    }
                    None => {
                        silent += deadlines;
                        self.wake()?;
                    }
                }
            }
            self.alone().await?;
        }
    }

    /// Runs by the clock until the port fails, and counts what it was late for. A program has no
    /// watchdog: beyond contract nothing more happens.
    pub(crate) async fn by_the_clock(&mut self) -> io::Result<Infallible> {
        self.is_timed = true;
        let clock = ClockTime::from(self.time.now_us());
        let (mut contract, mut due) = (Contract::default(), Due::default());
        loop {
            due.says(self.station.wake_at_us(), clock.now_us());
            match self.frame_or_wake(clock).await? {
                Some(frame) => {
                    self.time.reach(clock.now_us());
                    self.deliver(frame, Self::take)?;
                }
                None => self.was_woken(&due, &mut contract, clock.now_us()),
            }
        }
    }

    /// What was due is done.
    fn was_woken(&mut self, due: &Due, contract: &mut Contract, now_us: u64) {
        let Some(since_us) = due.since_us(now_us) else {
            return;
        };
        contract.done(since_us, now_us, false);
        self.station.report(LeafReport {
            started_by: StartedBy::Power,
            missed_deadlines: contract.missed(),
            latest_us: contract.latest_us(),
        });
    }

    /// The workbench is gone: time follows the clock until it says something. The peer's frames
    /// come meanwhile; it is as alone.
    async fn alone(&mut self) -> io::Result<()> {
        let clock = ClockTime::from(self.time.now_us());
        loop {
            if let Some(frame) = self.frame_or_wake(clock).await? {
                self.time.reach(clock.now_us());
                self.deliver(frame, Self::take_in_step)?;
                if self.is_of_workbench(&frame) {
                    return Ok(());
                }
            }
        }
    }

    /// The next frame; `None` where the station was due before one came, and did what was due.
    async fn frame_or_wake(&mut self, clock: ClockTime) -> io::Result<Option<CanFrame>> {
        let Some(due_us) = self.station.wake_at_us() else {
            return self.port.receive(None).await;
        };
        match select(self.port.receive(None), Timer::at(clock.at(due_us))).await {
            Either::First(received) => received,
            Either::Second(()) => self.wake().map(|()| None),
        }
    }

    /// A frame came in: what the port makes of it reaches the station.
    fn deliver(
        &mut self,
        frame: CanFrame,
        take: fn(&mut Self, &CanFrame) -> io::Result<()>,
    ) -> io::Result<()> {
        let Some(faults) = &mut self.faults else {
            return take(self, &frame);
        };
        let mut received = std::mem::take(&mut self.received);
        faults.receive(frame, &mut received);
        let outcome = received.drain(..).try_for_each(|frame| take(self, &frame));
        self.received = received;
        outcome
    }

    fn take_in_step(&mut self, frame: &CanFrame) -> io::Result<()> {
        self.act(|station, time, send| time.deliver(station, frame, send))
            .map(|_| ())
    }

    /// Of a torque that is due to the frame the node is told how long it took.
    fn take(&mut self, frame: &CanFrame) -> io::Result<()> {
        let begun = self.act(|station, time, send| station.take(frame, time.now_us(), send))?;
        if let Some(begun) = begun {
            self.station.took(Timed::ReceiveToTorque, ns_since(begun));
        }
        Ok(())
    }

    /// Time reaches what is due next.
    fn wake(&mut self) -> io::Result<()> {
        self.act(|station, time, send| time.wake(station, send))
            .map(|_| ())
    }

    /// Lets the station act and sends what it says. At the pace of the clock the station is told
    /// how long a torque took it, and the caller when that began: in lock-step nobody waits for it,
    /// and a clock is slow to read where the kernel is a process.
    fn act(
        &mut self,
        act: impl FnOnce(&mut dyn Station, &mut LockstepTime, &mut dyn FnMut(CanFrame)),
    ) -> io::Result<Option<std::time::Instant>> {
        let begun = self.is_timed.then(std::time::Instant::now);
        let (mut outcome, mut took_ns) = (Ok(()), None);
        let (port, torque) = (&self.port, self.torque);
        let mut send = |frame: CanFrame| {
            if frame.id() == torque {
                took_ns = begun.map(ns_since);
            }
            if outcome.is_ok() {
                outcome = port.send(&frame);
            }
        };
        act(self.station.as_mut(), &mut self.time, &mut send);
        if let Some(ns) = took_ns {
            self.station.took(Timed::ControlCycle, ns);
        }
        outcome.map(|()| begun.filter(|_| took_ns.is_some()))
    }

    fn is_of_workbench(&self, frame: &CanFrame) -> bool {
        self.of_workbench
            .iter()
            .any(|id| frame.id() == Id::Standard(*id))
    }
}
