//! The drive node on ST's B-G431B-ESC1 (STM32G431CB).
//!
//! The same sans-I/O node as on the host, at clock pace: frames from FDCAN1 (PA11 receive, PB9
//! transmit) and the time go in, what it says goes out.
//!
//! ```text
//! FDCAN interrupt ─▶ queue of 32 ─▶ control executor ─▶ torque ────────▶ mailbox
//!   (priority 1)                    (priority 2)    └─▶ others, in line ─▶ two of three mailboxes
//! hardware timer (priority 0) ──────────┘           └─▶ watchdog, while the contract is kept
//! thread: log
//! ```
//!
//! **Contract** ([`board_timing::contract`]). The node runs in an interrupt executor of its own, so
//! that nothing but the interrupts of CAN and of the timer comes before it. Frames wait in a queue
//! that the interrupt fills, however long a commit of parameters takes. Nothing in the control path
//! awaits a transmission: all other frames leave one of the three mailboxes to the torque, an older
//! torque that is still there is cancelled, and the mailboxes go by identifier. What is due is
//! looked at before the queue, so that a busy bus does not put it off. What is late is counted;
//! beyond contract the watchdog is not fed any more.
//!
//! **Bus-off**: the interrupt begins the recovery (128 times 11 recessive bits) at once and for
//! ever. Frames in the mailboxes stay there; what waits in line beyond its room is dropped, the
//! newest first. The drive meanwhile does what it does about frames that do not come.
//!
//! **End** ([`last_words`]): panic, processor fault and low voltage.
//!
//! **Node ids** are those of axis 0, or of the environment when the image is built:
//! `SERVO_NODE=2 PLANT_NODE=18 cargo fw`.
//!
//! Not proven here: that the board boots and keeps this contract. The image is linked and its
//! budgets are checked. The node reads its position from the bus, from the plant, as in
//! hardware-in-the-loop tests; there is no inverter control in it.
#![no_std]
#![no_main]

mod last_words;

use core::num::{NonZeroU8, NonZeroU16};

use board_timing::contract::{
    Contract, Due, LONGEST_SLEEP_US, LONGEST_WAIT_US, WATCHDOG_US, has_room_beside_torque,
};
use board_timing::{BitTiming, HSE_HZ, ONE_MEGABIT, PLL_M, PLL_N, PLL_Q, PLL_R};
use defmt::{error, info, unwrap, warn};
use defmt_rtt as _;
use embassy_executor::{InterruptExecutor, Spawner};
use embassy_futures::select::{Either, select};
use embassy_stm32::can::config::{
    FrameTransmissionConfig, GlobalFilter, NominalBitTiming, TxBufferMode,
};
use embassy_stm32::can::filter::{Action, FilterType, StandardFilter, StandardFilterSlot};
use embassy_stm32::can::{
    self, BufferedCan, BufferedCanReceiver, BufferedCanSender, CanConfigurator, Frame,
    OperatingMode, RxBuf, TxBuf,
};
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::peripherals::{FDCAN1, IWDG};
use embassy_stm32::rcc::{
    Hse, HseMode, Pll, PllMul, PllPreDiv, PllQDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, pac};
use embassy_time::{Duration, Instant, Timer};
use embedded_can::{Frame as _, StandardId};
use heapless::Deque;
use protocol::cob::{AxisIds, FrameKind, HEARD_BY_SERVO, NodeId};
use protocol::{CanFrame, Station};
use servo::Servo;
use servo::leaf::{LeafReport, StartedBy};
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    FDCAN1_IT0 => can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
});

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

/// Node ids of this board; another axis gets others.
const SERVO_NODE: u8 = node(option_env!("SERVO_NODE"), 0x01);
const PLANT_NODE: u8 = node(option_env!("PLANT_NODE"), 0x11);

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

/// The board's 120 Ω across the bus: on where the board ends it.
const TERMINATION: Level = Level::Low;
/// Frames other than torque that wait for a mailbox: those of one event, doubled.
type Line = Deque<CanFrame, 16>;

/// Received frames that wait for the control executor: those of ten cycles.
const HEARD: usize = 32;
static RECEIVED: StaticCell<RxBuf<HEARD>> = StaticCell::new();
/// A frame on its way into a mailbox; the interrupt takes it at once.
const SENDING: usize = 1;
static SENT: StaticCell<TxBuf<SENDING>> = StaticCell::new();

// Register codes, held to the plain numbers that the host checks.
const M: PllPreDiv = PllPreDiv::DIV2;
const N: PllMul = PllMul::MUL85;
const R: PllRDiv = PllRDiv::DIV2;
const Q: PllQDiv = PllQDiv::DIV2;
const _: () = {
    assert!(M.to_bits() as u32 + 1 == PLL_M);
    assert!(N.to_bits() as u32 == PLL_N);
    assert!((R.to_bits() as u32 + 1) * 2 == PLL_R);
    assert!((Q.to_bits() as u32 + 1) * 2 == PLL_Q);
};

/// Crystal → PLL → 170 MHz for the core and, from Q, for FDCAN. The default leaves the FDCAN
/// multiplexer on a crystal that is off.
fn clock_tree() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse {
        freq: Hertz(HSE_HZ),
        mode: HseMode::Oscillator,
    });
    config.rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: M,
        mul: N,
        divp: None,
        divq: Some(Q),
        divr: Some(R),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    config.rcc.boost = true; // range 1 boost mode, needed above 150 MHz (RM0440 §6.1.5)
    config.rcc.mux.fdcansel = mux::Fdcansel::PLL1_Q;
    config
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

const fn ids() -> AxisIds {
    match (NodeId::new(SERVO_NODE), NodeId::new(PLANT_NODE)) {
        (Some(servo), Some(plant)) => AxisIds { servo, plant },
        _ => panic!("node ids are 1 to 127"),
    }
}

const IDS: AxisIds = ids();

/// The identifiers that reach the node, two to a filter; everything else is rejected by the
/// peripheral.
fn listen(can: &CanConfigurator<'_>) {
    for (slot, pair) in (0_u8..).zip(HEARD_BY_SERVO.chunks(2)) {
        let (Some(first), Some(second)) = (pair.first(), pair.last()) else {
            continue;
        };
        let filter = FilterType::DedicatedDual(IDS.identifier(*first), IDS.identifier(*second));
        let filter = StandardFilter {
            filter,
            action: Action::StoreInFifo0,
        };
        can.properties()
            .set_standard_filter(StandardFilterSlot::from(slot), filter);
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let peripherals = embassy_stm32::init(clock_tree());
    let started_by = last_words::started_by();
    last_words::watch_supply();
    let mut dog = IndependentWatchdog::new(peripherals.IWDG, WATCHDOG_US);
    dog.unleash();
    // CAN_SHDN low switches the transceiver on.
    let switches = [
        Output::new(peripherals.PC11, Level::Low, Speed::Low),
        Output::new(peripherals.PC14, TERMINATION, Speed::Low),
    ];

    let mut can = CanConfigurator::new(
        peripherals.FDCAN1,
        peripherals.PA11,
        peripherals.PB9,
        Interrupts,
    );
    // Mailboxes go by identifier, lowest first.
    can.set_config(
        can.config()
            .set_nominal_bit_timing(NOMINAL)
            .set_frame_transmit(FrameTransmissionConfig::ClassicCanOnly)
            .set_tx_buffer_mode(TxBufferMode::Priority)
            .set_global_filter(GlobalFilter::reject_all())
            .set_automatic_bus_off_recovery(true),
    );
    listen(&can);
    interrupt::FDCAN1_IT0.set_priority(Priority::P1);
    let can = can.start(OperatingMode::NormalOperationMode);
    let can = can.buffered(SENT.init(TxBuf::new()), RECEIVED.init(RxBuf::new()));
    interrupt::USART3.set_priority(Priority::P2);
    let control = unwrap!(control(can.writer(), can.reader(), dog, started_by));
    CONTROL.start(interrupt::USART3).spawn(control);
    info!(
        "servo {} for plant {} on FDCAN1, started by {}",
        SERVO_NODE,
        PLANT_NODE,
        started_by.code()
    );
    spawner.spawn(unwrap!(log(can, switches)));
}

/// Says now and then how the bus is. It keeps peripheral and pins, which end with their values.
#[embassy_executor::task]
async fn log(can: BufferedCan<'static, SENDING, HEARD>, switches: [Output<'static>; 2]) {
    let _kept = switches;
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

#[embassy_executor::task]
async fn control(
    transmit: BufferedCanSender,
    receive: BufferedCanReceiver,
    mut dog: IndependentWatchdog<'static, IWDG>,
    started_by: StartedBy,
) {
    let mut node = Node {
        servo: Servo::new(IDS),
        contract: Contract::default(),
        transmit,
        line: Line::new(),
        torques: 0,
    };
    let mut due = Due::default();
    Station::boot(&mut node.servo, &mut |frame| wait(&mut node.line, frame));
    // Heartbeats begin with the first event.
    let now_us = Instant::now().as_micros();
    node.time(now_us, now_us);
    loop {
        node.send_others();
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
        match select(receive.receive(), wake).await {
            Either::First(Ok(envelope)) => node.take(&envelope.frame, envelope.ts),
            Either::First(Err(bus)) => warn!("bus: {}", bus),
            Either::Second(()) => {}
        }
    }
}

/// The drive node, its contract, and what it has to say.
struct Node {
    servo: Servo,
    contract: Contract,
    transmit: BufferedCanSender,
    line: Line,
    /// Mailboxes that the last torque took, a bit each.
    torques: u32,
}

impl Node {
    /// Something has been due since a time.
    fn time(&mut self, since_us: u64, now_us: u64) {
        let has_torque = self.servo.drive().is_energised();
        let Self {
            servo,
            transmit,
            line,
            torques,
            ..
        } = self;
        servo.time(now_us, &mut |frame| post(transmit, line, torques, frame));
        let now_us = Instant::now().as_micros();
        self.contract.done(since_us, now_us, has_torque);
    }

    /// A frame came; `at` is when the interrupt took it.
    fn take(&mut self, frame: &Frame, at: Instant) {
        let Some(frame) = frame_of(frame) else {
            return;
        };
        let has_torque = self.servo.drive().is_energised();
        let Self {
            servo,
            transmit,
            line,
            torques,
            ..
        } = self;
        let now_us = Instant::now().as_micros();
        servo.take(&frame, now_us, &mut |frame| {
            post(transmit, line, torques, frame);
        });
        let now_us = Instant::now().as_micros();
        self.contract.done(at.as_micros(), now_us, has_torque);
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

/// Mailboxes that are taken, a bit each: requested, or about to be.
fn taken() -> u32 {
    pac::FDCAN1.txbrp().read().0 | pac::FDCAN1.txbar().read().0
}

/// A torque takes its mailbox at once, everything else waits for one.
fn post(sender: &mut BufferedCanSender, line: &mut Line, torques: &mut u32, frame: CanFrame) {
    let torque = IDS.identifier(FrameKind::Torque);
    if frame.id() != embedded_can::Id::Standard(torque) {
        wait(line, frame);
        return;
    }
    // An older torque that has not gone out is worth nothing any more.
    let older = *torques & taken();
    pac::FDCAN1.txbcr().write(|w| w.0 = older);
    let before = taken();
    transmit(sender, &frame);
    *torques = older | (taken() & !before);
}

fn wait(line: &mut Line, frame: CanFrame) {
    if line.push_back(frame).is_err() {
        error!("a frame was dropped: more wait for a mailbox than the line holds");
    }
}

/// The interrupt, which comes before this executor, takes the frame into a mailbox at once. Where
/// none is free the frame is dropped: on a bus that nobody acknowledges on.
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
