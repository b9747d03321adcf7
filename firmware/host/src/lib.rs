//! The drive node as a host program: the same sans-I/O node as on the board, on embassy-executor, over SocketCAN or an in-process bus.
//!
//! Two tasks: one takes frames as they come, one lets the node notice every few milliseconds that time passes. Effects that the node returns are performed
//! here: frames are sent.

pub mod idle;
pub mod port;

use std::cell::RefCell;
use std::io;
use std::rc::Rc;

use bus::{FaultPlan, FaultyPort, Received};
use embassy_executor::raw::Executor;
use embassy_time::{Duration, Instant, Timer};
use embedded_can::StandardId;
use protocol::CanFrame;
use protocol::cob::{AxisIds, FrameKind};
use servo::Servo;
use static_cell::StaticCell;

use port::Port;

/// The node notices time this often.
const TICK: Duration = Duration::from_millis(5);

struct Node {
    servo: Servo,
    faults: Option<FaultyPort>,
    failure: Option<io::Error>,
    stop: bool,
    /// Time of the last tick, µs: good enough for a SYNC timeout, and cheaper than reading the clock for every frame.
    now_us: u64,
}

type Shared = Rc<RefCell<Node>>;

/// What the servo of an axis wants to hear.
#[must_use]
pub fn accepted(ids: AxisIds) -> [StandardId; 7] {
    [
        FrameKind::Nmt,
        FrameKind::Sync,
        FrameKind::Feedback,
        FrameKind::Setpoint,
        FrameKind::SdoRequest,
        FrameKind::PlantHeartbeat,
        FrameKind::PlantEmergency,
    ]
    .map(|kind| ids.identifier(kind))
}

/// Runs the node on a port until the port fails or `stop` says so (asked at every tick); once per process, because the executor is static.
///
/// # Errors
/// Where the port fails.
pub fn run(servo: Servo, port: Port, faults: Option<FaultPlan>, stop: fn() -> bool) -> io::Result<()> {
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    let faults = faults.map(|plan| FaultyPort::new(plan, servo.ids(), servo.ids().servo.get()));
    for frame in servo.boot() {
        port.send(&frame)?;
    }
    let shared: Shared = Rc::new(RefCell::new(Node { servo, faults, failure: None, stop: false, now_us: 0 }));
    let port = Rc::new(port);
    let executor: &'static Executor = EXECUTOR.init(Executor::new(std::ptr::null_mut()));
    let spawner = executor.spawner();
    let spawn_failed = |_| io::Error::other("the executor has no room for the node's tasks");
    spawner.spawn(listen(Rc::clone(&shared), Rc::clone(&port)).map_err(spawn_failed)?);
    spawner.spawn(watch(Rc::clone(&shared), port, stop).map_err(spawn_failed)?);
    let ended = Rc::clone(&shared);
    idle::run(executor, move || ended.borrow().stop || ended.borrow().failure.is_some())?;
    let failure = shared.borrow_mut().failure.take();
    failure.map_or(Ok(()), Err)
}

#[embassy_executor::task]
async fn listen(node: Shared, port: Rc<Port>) {
    let mut received = Vec::new();
    loop {
        match port.receive().await {
            Ok(frame) => node.borrow_mut().take(frame, &mut received, &port),
            Err(error) => {
                node.borrow_mut().failure = Some(error);
                return;
            }
        }
    }
}

#[embassy_executor::task]
async fn watch(node: Shared, port: Rc<Port>, stop: fn() -> bool) {
    loop {
        Timer::after(TICK).await;
        let mut node = node.borrow_mut();
        node.now_us = Instant::now().as_micros();
        let now_us = node.now_us;
        let out = node.servo.on_time(now_us);
        node.send(&out, &port);
        node.stop |= stop();
    }
}

impl Node {
    fn take(&mut self, frame: CanFrame, received: &mut Vec<Received>, port: &Port) {
        match &mut self.faults {
            None => received.push(Received::Frame(frame)),
            Some(faults) => faults.receive(frame, received),
        }
        for received in received.drain(..) {
            let out = match received {
                Received::Frame(frame) => self.servo.on_frame(&frame, self.now_us),
                Received::Lost(kind) => self.servo.on_lost(kind),
            };
            self.send(&out, port);
        }
    }

    fn send(&mut self, out: &[CanFrame], port: &Port) {
        for frame in out {
            if let Err(error) = port.send(frame) {
                self.failure = Some(error);
            }
        }
    }
}
