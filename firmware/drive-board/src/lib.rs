//! The drive node on an STM32G4 with FDCAN: everything of a board but its clock, its pins and its
//! ids.
//!
//! ```text
//! FDCAN interrupt ─▶ queue of 32 ─▶ control executor ─▶ torque ────────▶ mailbox
//!   (priority 1)                    (priority 2)    └─▶ others, in line ─▶ two of three mailboxes
//! hardware timer (priority 0) ──────────┘           └─▶ watchdog, while the contract is kept
//! thread: commits of parameters, log
//! ```
//!
//! **Contract** ([`board_timing::contract`]). The node runs in an interrupt executor of its own, so
//! that nothing but the interrupts of CAN and of the timer comes before it. Frames wait in a queue
//! that the interrupt fills. What takes longer than a cycle may, the conversion of parameters at a
//! commit, is done in thread mode, from where everything else interrupts it. Nothing in the control
//! path awaits a transmission: all other frames leave one of the three mailboxes to the torque, an
//! older torque that is still there is cancelled, and the mailboxes go by identifier. What is due
//! is looked at before the queue, so that a busy bus does not put it off. What is late is counted;
//! beyond contract the watchdog is not fed any more.
//!
//! **Bus-off**: the interrupt begins the recovery (128 times 11 recessive bits) at once and for
//! ever. Frames in the mailboxes stay there; what waits in line beyond its room is dropped, the
//! newest first. The drive meanwhile does what it does about frames that do not come.
//!
//! **End** ([`last_words`]): panic, processor fault and low voltage.
//!
//! The same sans-I/O node as on the host, at clock pace. Not proven here: that a board boots and
//! keeps this contract. Images are linked and their budgets are checked. The node reads its
//! position from the bus, from the plant, as in hardware-in-the-loop tests; there is no inverter
//! control in it.
#![no_std]

pub mod clock;
mod last_words;

use core::num::{NonZeroU8, NonZeroU16};

use board_timing::contract::{
    Contract, Due, LONGEST_SLEEP_US, LONGEST_WAIT_US, WATCHDOG_US, has_room_beside_torque,
};
use board_timing::{BitTiming, ONE_MEGABIT};
use defmt::{error, info, unwrap, warn};
use defmt_rtt as _;
use embassy_executor::{InterruptExecutor, Spawner};
use embassy_futures::select::{Either3, select3};
use embassy_stm32::can::config::{
    FrameTransmissionConfig, GlobalFilter, NominalBitTiming, TxBufferMode,
};
use embassy_stm32::can::filter::{Action, FilterType, StandardFilter, StandardFilterSlot};
use embassy_stm32::can::{
    BufferedCan, BufferedCanReceiver, BufferedCanSender, CanConfigurator, Frame, OperatingMode,
    RxBuf, TxBuf,
};
use embassy_stm32::gpio::Output;
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peri, pac};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer};
use embedded_can::{Frame as _, StandardId};
use heapless::{Deque, Vec};
use protocol::cob::{AxisIds, FrameKind, HEARD_BY_SERVO, NodeId};
use protocol::leaf::{LeafReport, StartedBy, Timed};
use protocol::{CanFrame, Station};
use servo::Servo;
use servo::commit::Commit;
use static_cell::StaticCell;

/// Pins that a board has to keep as they are.
pub type Pins = Vec<Output<'static>, 4>;

/// The executor of the node runs in the interrupt of a peripheral that nobody uses.
static CONTROL: InterruptExecutor = InterruptExecutor::new();

#[allow(unsafe_code, reason = "embassy's handlers are unsafe to call")]
#[embassy_stm32::interrupt]
unsafe fn USART3() {
    // SAFETY: called here only, and the interrupt is unmasked by the executor's start.
    unsafe {
        CONTROL.on_interrupt();
    }
}

/// Frames other than torque that wait for a mailbox: those of one event, doubled.
type Line = Deque<CanFrame, 16>;

/// A commit on its way to thread mode, and back: there is one, and who has it may write to it.
static TO_CONVERT: Signal<CriticalSectionRawMutex, &'static mut Commit> = Signal::new();
static CONVERTED: Signal<CriticalSectionRawMutex, &'static mut Commit> = Signal::new();
static COMMIT: StaticCell<Commit> = StaticCell::new();
static SERVO: StaticCell<Servo> = StaticCell::new();

/// Apart, so that its 3 KB are on the stack before the node runs and never again.
#[inline(never)]
fn servo(ids: AxisIds) -> &'static mut Servo {
    SERVO.init_with(|| Servo::new(ids))
}

/// Received frames that wait for the control executor: those of ten cycles.
const HEARD: usize = 32;
static RECEIVED: StaticCell<RxBuf<HEARD>> = StaticCell::new();
/// A frame on its way into a mailbox; the interrupt takes it at once.
const SENDING: usize = 1;
static SENT: StaticCell<TxBuf<SENDING>> = StaticCell::new();

/// The node ids that the environment says when a leaf is built; those of axis 0 where it says
/// none. Called in a constant, so that a wrong one is an error of the build.
///
/// # Panics
/// Where one is no decimal number from 1 to 127.
#[must_use]
pub const fn ids(servo: Option<&str>, plant: Option<&str>) -> AxisIds {
    match (
        NodeId::new(node(servo, 0x01)),
        NodeId::new(node(plant, 0x11)),
    ) {
        (Some(servo), Some(plant)) => AxisIds { servo, plant },
        _ => panic!("node ids are 1 to 127"),
    }
}

/// A decimal number.
const fn node(text: Option<&str>, default: u8) -> u8 {
    let Some(text) = text else {
        return default;
    };
    match u8::from_str_radix(text, 10) {
        Ok(node) => node,
        Err(_) => panic!("SERVO_NODE and PLANT_NODE are decimal numbers from 1 to 127"),
    }
}

const fn nominal(timing: BitTiming) -> NominalBitTiming {
    match (
        NonZeroU16::new(timing.prescaler),
        NonZeroU8::new(timing.segment_1),
        NonZeroU8::new(timing.segment_2),
        NonZeroU8::new(timing.jump_width),
    ) {
        (Some(prescaler), Some(seg1), Some(seg2), Some(sync_jump_width)) => NominalBitTiming {
            prescaler,
            seg1,
            seg2,
            sync_jump_width,
        },
        _ => panic!("a bit segment is zero"),
    }
}

const NOMINAL: NominalBitTiming = nominal(ONE_MEGABIT);

/// The identifiers that reach the node, two to a filter; everything else is rejected by the
/// peripheral.
fn listen(can: &CanConfigurator<'_>, ids: AxisIds) {
    for (slot, pair) in (0_u8..).zip(HEARD_BY_SERVO.chunks(2)) {
        let (Some(first), Some(second)) = (pair.first(), pair.last()) else {
            continue;
        };
        let filter = FilterType::DedicatedDual(ids.identifier(*first), ids.identifier(*second));
        let filter = StandardFilter {
            filter,
            action: Action::StoreInFifo0,
        };
        can.properties()
            .set_standard_filter(StandardFilterSlot::from(slot), filter);
    }
}

/// Starts the node; `init` of the HAL and the configurator with its pins are behind the leaf.
pub fn start(
    spawner: Spawner,
    mut can: CanConfigurator<'static>,
    watchdog: Peri<'static, IWDG>,
    ids: AxisIds,
    pins: Pins,
) {
    let started_by = last_words::started_by();
    last_words::watch_supply();
    let mut dog = IndependentWatchdog::new(watchdog, WATCHDOG_US);
    dog.unleash();
    // Mailboxes go by identifier, lowest first.
    can.set_config(
        can.config()
            .set_nominal_bit_timing(NOMINAL)
            .set_frame_transmit(FrameTransmissionConfig::ClassicCanOnly)
            .set_tx_buffer_mode(TxBufferMode::Priority)
            .set_global_filter(GlobalFilter::reject_all())
            .set_automatic_bus_off_recovery(true),
    );
    listen(&can, ids);
    interrupt::FDCAN1_IT0.set_priority(Priority::P1);
    let can = can.start(OperatingMode::NormalOperationMode);
    let can = can.buffered(SENT.init(TxBuf::new()), RECEIVED.init(RxBuf::new()));
    interrupt::USART3.set_priority(Priority::P2);
    let leaf = Leaf {
        servo: servo(ids),
        commit: COMMIT.init_with(Commit::default),
        started_by,
    };
    let control = unwrap!(control(can.writer(), can.reader(), dog, leaf));
    CONTROL.start(interrupt::USART3).spawn(control);
    info!(
        "servo {} for plant {} on FDCAN1, started by {}",
        ids.servo.get(),
        ids.plant.get(),
        started_by.code()
    );
    spawner.spawn(unwrap!(log(can, pins)));
    spawner.spawn(unwrap!(convert()));
}

/// Converts what the node wants converted, while nothing else wants the processor.
#[embassy_executor::task]
async fn convert() {
    loop {
        let commit = TO_CONVERT.wait().await;
        commit.convert();
        CONVERTED.signal(commit);
    }
}

/// Says now and then how the bus is. It keeps peripheral and pins, which end with their values.
#[embassy_executor::task]
async fn log(can: BufferedCan<'static, SENDING, HEARD>, pins: Pins) {
    let _kept = pins;
    loop {
        Timer::after(Duration::from_secs(10)).await;
        let properties = can.properties();
        info!(
            "transmit errors {}, receive errors {}",
            properties.tx_error_count(),
            properties.rx_error_count()
        );
    }
}

/// What the control executor has to know of its leaf.
struct Leaf {
    servo: &'static mut Servo,
    commit: &'static mut Commit,
    started_by: StartedBy,
}

#[embassy_executor::task]
async fn control(
    transmit: BufferedCanSender,
    receive: BufferedCanReceiver,
    mut dog: IndependentWatchdog<'static, IWDG>,
    leaf: Leaf,
) {
    let Leaf {
        servo,
        commit,
        started_by,
    } = leaf;
    let mut node = Node {
        servo,
        contract: Contract::default(),
        transmit,
        line: Line::new(),
        torques: 0,
        commit: Some(commit),
    };
    let mut due = Due::default();
    Station::boot(node.servo, &mut |frame| wait(&mut node.line, frame));
    // Heartbeats begin with the first event.
    let now_us = Instant::now().as_micros();
    node.time(now_us, now_us);
    loop {
        node.send_others();
        node.send_commit();
        node.servo.report(LeafReport {
            started_by,
            missed_deadlines: node.contract.missed(),
            latest_us: node.contract.latest_us(),
        });
        if node.contract.is_kept() {
            dog.pet();
        }
        let now_us = Instant::now().as_micros();
        due.says(node.servo.wake_at_us(), now_us);
        // What is due goes before what has come.
        if let Some(since_us) = due.since_us(now_us) {
            node.time(since_us, now_us);
            continue;
        }
        let longest_us = if node.line.is_empty() {
            LONGEST_SLEEP_US
        } else {
            LONGEST_WAIT_US
        };
        let wake = Timer::at(Instant::from_micros(due.until_us(now_us, longest_us)));
        match select3(receive.receive(), wake, CONVERTED.wait()).await {
            Either3::First(Ok(envelope)) => node.take(&envelope.frame, envelope.ts),
            Either3::First(Err(bus)) => warn!("bus: {}", bus),
            Either3::Second(()) => {}
            Either3::Third(commit) => node.converted(commit),
        }
    }
}

/// The drive node, its contract, and what it has to say.
struct Node {
    servo: &'static mut Servo,
    contract: Contract,
    transmit: BufferedCanSender,
    line: Line,
    /// Mailboxes that the last torque took, a bit each.
    torques: u32,
    /// Where thread mode does not have it.
    commit: Option<&'static mut Commit>,
}

impl Node {
    /// Something has been due since a time.
    fn time(&mut self, since_us: u64, now_us: u64) {
        let _is_no_frame = self.happens([since_us, now_us], |servo, send| servo.time(now_us, send));
    }

    /// A commit comes back from thread mode.
    fn converted(&mut self, commit: &'static mut Commit) {
        let now_us = Instant::now().as_micros();
        let _is_no_frame = self.happens([now_us, now_us], |servo, send| {
            servo.end_commit(commit).iter().copied().for_each(send);
        });
        self.commit = Some(commit);
    }

    /// A commit that somebody asked for goes to thread mode, once it is back from there.
    fn send_commit(&mut self) {
        if let Some(commit) = self.commit.take() {
            if self.servo.begin_commit(commit) {
                TO_CONVERT.signal(commit);
            } else {
                self.commit = Some(commit);
            }
        }
    }

    /// A frame came; `at` is when the interrupt took it.
    fn take(&mut self, frame: &Frame, at: Instant) {
        let Some(frame) = frame_of(frame) else {
            return;
        };
        let now_us = Instant::now().as_micros();
        let at_us = at.as_micros();
        if self.happens([at_us, now_us], |servo, send| {
            servo.hear(&frame, now_us).iter().copied().for_each(send);
        }) {
            self.servo.took(Timed::ReceiveToTorque, ns_since(at_us));
        }
    }

    /// An event that waits since a time, and begins at another: what it makes the node say goes
    /// out. Tells whether that was a torque.
    fn happens(
        &mut self,
        [since_us, begun_us]: [u64; 2],
        event: impl FnOnce(&mut Servo, &mut dyn FnMut(CanFrame)),
    ) -> bool {
        let Self {
            servo,
            contract,
            transmit,
            line,
            torques,
            commit: _,
        } = self;
        let has_torque = servo.drive().is_energised();
        let torque = embedded_can::Id::from(servo.ids().identifier(FrameKind::Torque));
        let mut torque_ns = None;
        event(servo, &mut |frame| {
            if frame.id() == torque {
                torque_ns = Some(ns_since(begun_us));
                post(transmit, torques, &frame);
            } else {
                wait(line, frame);
            }
        });
        contract.done(since_us, Instant::now().as_micros(), has_torque);
        if let Some(ns) = torque_ns {
            servo.took(Timed::ControlCycle, ns);
        }
        torque_ns.is_some()
    }

    /// Frames that are no torque take their mailboxes.
    fn send_others(&mut self) {
        while has_room_beside_torque(taken().count_ones()) {
            let Some(frame) = self.line.pop_front() else {
                return;
            };
            transmit(&mut self.transmit, &frame);
        }
    }
}

/// The board's clock counts microseconds.
fn ns_since(begun_us: u64) -> u32 {
    let us = Instant::now().as_micros().saturating_sub(begun_us);
    u32::try_from(us.saturating_mul(1000)).unwrap_or(u32::MAX)
}

/// Mailboxes that are taken, a bit each: requested, or about to be.
fn taken() -> u32 {
    pac::FDCAN1.txbrp().read().0 | pac::FDCAN1.txbar().read().0
}

/// A torque takes its mailbox at once.
fn post(sender: &mut BufferedCanSender, torques: &mut u32, torque: &CanFrame) {
    // An older torque that has not gone out is worth nothing any more.
    let older = *torques & taken();
    pac::FDCAN1.txbcr().write(|w| w.0 = older);
    let before = taken();
    transmit(sender, torque);
    *torques = older | (taken() & !before);
}

/// Everything else waits for one.
// Apart, as what sends: inlined into every event they take 2 KB of flash.
#[inline(never)]
fn wait(line: &mut Line, frame: CanFrame) {
    if line.push_back(frame).is_err() {
        error!("a frame was dropped: more wait for a mailbox than the line holds");
    }
}

/// The interrupt, which comes before this executor, takes the frame into a mailbox at once. Where
/// none is free the frame is dropped: on a bus that nobody acknowledges on.
#[inline(never)]
fn transmit(sender: &mut BufferedCanSender, frame: &CanFrame) {
    let id = match frame.id() {
        embedded_can::Id::Standard(id) => id,
        embedded_can::Id::Extended(_) => StandardId::MAX,
    };
    let has_room = !pac::FDCAN1.txfqs().read().tfqf();
    let frame = Frame::new_data(id, frame.payload());
    let sent = has_room && frame.is_ok_and(|frame| sender.try_write(frame).is_ok());
    // The interrupt is behind us when the mailboxes are looked at next.
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    if !sent {
        error!("a frame was dropped: no mailbox is free");
    }
}

fn frame_of(frame: &Frame) -> Option<CanFrame> {
    if frame.is_remote_frame() {
        return CanFrame::new_remote(*frame.id(), frame.dlc());
    }
    CanFrame::new(*frame.id(), frame.data())
}
