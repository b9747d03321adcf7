//! The in-process bus is a discrete-event driver: frames first, then the earliest wake, and nothing
//! else moves time.

use std::cell::RefCell;
use std::rc::Rc;

use bus::{Damage, FaultPlan, InProcessBus};
use protocol::cob::{AxisIds, FrameKind};
use protocol::message::{NmtState, Torque};
use protocol::states::ControlWord;
use protocol::weight::TorqueMicroNm;
use protocol::{CanFrame, Message, Station, SyncCounter};

const PERIOD_US: u64 = 1000;
const DEADLINE_US: u64 = 600;
/// When a node that misses SYNC goes on by itself, after the time when it was due.
const OWN_TIMER_US: u64 = 300;

fn ids() -> AxisIds {
    AxisIds::of_axis(0).unwrap()
}

fn sync(count: u8) -> CanFrame {
    Message::Sync(SyncCounter::new(count).unwrap()).encode(ids())
}

fn torque(count: u8) -> CanFrame {
    let counter = SyncCounter::new(count).unwrap();
    Message::Torque(Torque {
        torque: TorqueMicroNm(0),
        control: ControlWord::default(),
        counter,
    })
    .encode(ids())
}

fn heartbeat() -> CanFrame {
    Message::PlantHeartbeat(NmtState::Operational).encode(ids())
}

/// What happened to a station, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    /// A frame came.
    Frame(u64, CanFrame),
    /// It was due.
    Due(u64),
}

type Seen = Rc<RefCell<Vec<Event>>>;

/// Sends its answer when a frame comes that it waits for, and at its alarms.
struct Probe {
    alarms: Vec<u64>,
    answer: Option<(CanFrame, CanFrame)>,
    seen: Seen,
}

impl Probe {
    fn on(bus: &mut InProcessBus, alarms: &[u64], answer: Option<(CanFrame, CanFrame)>) -> Seen {
        let seen = Seen::default();
        bus.add(Box::new(Self {
            alarms: alarms.to_vec(),
            answer,
            seen: Rc::clone(&seen),
        }));
        seen
    }
}

impl Station for Probe {
    fn ids(&self) -> AxisIds {
        ids()
    }

    fn boot(&mut self, _send: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.seen.borrow_mut().push(Event::Frame(now_us, *frame));
        self.answer
            .into_iter()
            .filter(|(question, _)| question == frame)
            .for_each(|(_, answer)| send(answer));
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.seen.borrow_mut().push(Event::Due(now_us));
        self.alarms.remove(0);
        send(heartbeat());
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.alarms.first().copied()
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }
}

#[test]
fn frames_take_no_time_and_come_before_any_wake() {
    let mut bus = InProcessBus::new();
    let seen = Probe::on(&mut bus, &[600], Some((sync(1), torque(1))));
    bus.send(sync(1));
    assert_eq!(bus.receive(PERIOD_US), Some(torque(1)));
    assert_eq!(*seen.borrow(), [Event::Frame(0, sync(1))]);
    assert_eq!(bus.now_us(), 0);
}

#[test]
fn waiting_jumps_from_wake_to_wake_and_what_is_sent_goes_round_before_the_next() {
    let mut bus = InProcessBus::new();
    let first = Probe::on(&mut bus, &[200, 700], None);
    let second = Probe::on(&mut bus, &[200, 500], None);
    let mut times = Vec::new();
    while bus.receive(400).is_some() {
        times.push(bus.now_us());
    }
    assert_eq!(times, [200, 200, 500, 700]);
    assert_eq!(bus.now_us(), 1100, "the end of the waiting");
    let heard = |at| Event::Frame(at, heartbeat());
    assert_eq!(
        *first.borrow(),
        [Event::Due(200), heard(200), heard(500), Event::Due(700)]
    );
    assert_eq!(
        *second.borrow(),
        [heard(200), Event::Due(200), Event::Due(500), heard(700)],
        "ties go by place"
    );
}

#[test]
fn the_cycles_of_the_master_lie_on_a_grid_however_long_it_waited_within_them() {
    let mut bus = InProcessBus::new();
    Probe::on(&mut bus, &[], None);
    let mut starts = Vec::new();
    for waiting in [0, 400, 999, 0, 2500, 0] {
        bus.pass(PERIOD_US);
        starts.push(bus.now_us());
        assert_eq!(bus.receive(waiting), None);
    }
    assert_eq!(
        starts,
        [0, 1000, 2000, 3000, 4000, 6500],
        "a waiting past the end of the cycle moves the grid"
    );
}

#[test]
fn what_is_due_before_the_next_cycle_happens_before_it() {
    let mut bus = InProcessBus::new();
    let seen = Probe::on(&mut bus, &[400, 900, 1000], None);
    bus.pass(PERIOD_US);
    bus.pass(PERIOD_US);
    assert_eq!(
        *seen.borrow(),
        [Event::Due(400), Event::Due(900)],
        "what is due at its start waits for SYNC"
    );
    assert_eq!(bus.now_us(), 1000);
    assert_eq!(
        [bus.receive(0), bus.receive(0), bus.receive(0)],
        [Some(heartbeat()); 3]
    );
}

#[test]
fn a_node_with_a_cut_cable_lives_on_and_a_dead_one_does_not() {
    let mut bus = InProcessBus::new();
    let cut = Probe::on(&mut bus, &[100], None);
    let dead = Probe::on(&mut bus, &[100], None);
    bus.connect(0, false);
    bus.kill(1);
    bus.send(sync(1));
    assert_eq!(
        bus.receive(500),
        None,
        "nobody hears the heartbeat of the first"
    );
    assert_eq!(
        (&*cut.borrow(), &*dead.borrow()),
        (&vec![Event::Due(100)], &vec![])
    );
}

/// The cycle contract at its smallest: a servo that answers SYNC with a torque, by the frame, by
/// its own timer or at the deadline of a feedback that does not come.
#[derive(Default)]
struct Cycle {
    began: Option<(u64, SyncCounter)>,
    open: bool,
    by_deadline: u32,
}

impl Cycle {
    fn begin(&mut self, at_us: u64, counter: SyncCounter) {
        self.began = Some((at_us, counter));
        self.open = true;
    }

    fn close(&mut self, send: &mut dyn FnMut(CanFrame)) {
        if let (true, Some((_, counter))) = (self.open, self.began) {
            self.open = false;
            send(torque(counter.get()));
        }
    }
}

impl Station for Cycle {
    fn ids(&self) -> AxisIds {
        ids()
    }

    fn boot(&mut self, _send: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        match protocol::message::decode(ids(), frame) {
            Ok(protocol::message::Decoded::Message(Message::Sync(counter))) => {
                self.begin(now_us, counter);
            }
            Ok(protocol::message::Decoded::Message(Message::PlantHeartbeat(_))) => self.close(send),
            _ => {}
        }
    }

    fn time(&mut self, _now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        let Some((began_us, counter)) = self.began else {
            return;
        };
        self.by_deadline += 1;
        if self.open {
            self.close(send);
        } else {
            self.begin(began_us + PERIOD_US, counter.next());
        }
    }

    fn wake_at_us(&self) -> Option<u64> {
        let wait = if self.open {
            DEADLINE_US
        } else {
            PERIOD_US + OWN_TIMER_US
        };
        self.began.map(|(began_us, _)| began_us + wait)
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.began.map(|(began_us, _)| began_us + PERIOD_US)
    }
}

/// Runs cycles with a plant that answers SYNC; when in each cycle the torque came, and the cycles
/// that were begun or closed by time.
fn torques(plan: FaultPlan, cycles: u8) -> (Vec<Option<u64>>, u32) {
    let mut bus = InProcessBus::new();
    let servo = bus::Shared::new(Cycle::default());
    let place = bus.add(Box::new(servo.clone()));
    bus.inject(place, 1, plan);
    let times = (1..=cycles).map(|count| {
        bus.pass(PERIOD_US);
        let start_us = bus.now_us();
        bus.send(sync(count));
        bus.send(heartbeat());
        let came = std::iter::from_fn(|| bus.receive_until(start_us + PERIOD_US))
            .any(|frame| frame == torque(count));
        came.then(|| bus.now_us() - start_us)
    });
    let times = times.collect();
    let by_deadline = servo.borrow().by_deadline;
    (times, by_deadline)
}

#[test]
fn a_run_without_losses_reaches_no_deadline() {
    assert_eq!(torques(FaultPlan::default(), 200), (vec![Some(0); 200], 0));
}

#[test]
fn a_cycle_whose_frame_is_lost_closes_at_its_deadline_and_the_next_begins_on_the_grid() {
    let once = Some((FrameKind::PlantHeartbeat, 3, Damage::Lost));
    let (times, by_deadline) = torques(
        FaultPlan {
            once,
            ..FaultPlan::default()
        },
        5,
    );
    assert_eq!(times, [Some(0), Some(0), Some(600), Some(0), Some(0)]);
    assert_eq!(by_deadline, 1);
}

#[test]
fn a_node_that_misses_sync_begins_and_closes_the_cycle_by_its_own_timer() {
    let once = Some((FrameKind::Sync, 3, Damage::Lost));
    let (times, by_deadline) = torques(
        FaultPlan {
            once,
            ..FaultPlan::default()
        },
        5,
    );
    // The heartbeat came before the cycle was begun, so this small node closes it by time, too.
    assert_eq!(times, [Some(0), Some(0), Some(600), Some(0), Some(0)]);
    assert_eq!(by_deadline, 2);
}
