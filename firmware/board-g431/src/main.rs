//! The drive node on ST's B-G431B-ESC1 (STM32G431CB).
//!
//! The same sans-I/O node as on the host, at clock pace: frames from FDCAN1 (PA11 receive, PB9
//! transmit) and the time go in, what it says goes out. One task waits for a frame or for the time
//! when the node is due ([`Station::wake_at_us`]: the deadline of a cycle, its own SYNC timer, a
//! heartbeat). That time is absolute, so a busy bus does not put it off. Contract: from the arrival
//! of the frame that completes a cycle to the torque frame in the transmit FIFO there is no waiting
//! but for a free FIFO slot; the computation is bounded because the node has no loop over anything
//! but its own tables.
//!
//! Not proven here: that the board boots and keeps this contract. The image is linked and its
//! budgets are checked; timing on the target is a later issue. The node reads its position from the
//! bus, from the plant, as in hardware-in-the-loop tests; there is no inverter control in it.
#![no_std]
#![no_main]

use core::num::{NonZeroU8, NonZeroU16};

use board_timing::{BitTiming, HSE_HZ, ONE_MEGABIT, PLL_M, PLL_N, PLL_Q, PLL_R};
use defmt::{error, info, unwrap, warn};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_futures::select::{Either, select};
use embassy_stm32::can::config::{
    FrameTransmissionConfig, GlobalFilter, NominalBitTiming, TxBufferMode,
};
use embassy_stm32::can::filter::{Action, FilterType, StandardFilter, StandardFilterSlot};
use embassy_stm32::can::{self, CanConfigurator, CanRx, CanTx, Frame, OperatingMode};
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::peripherals::FDCAN1;
use embassy_stm32::rcc::{
    Hse, HseMode, Pll, PllMul, PllPreDiv, PllQDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, bind_interrupts};
use embassy_time::{Duration, Instant, Timer};
use embedded_can::{Frame as _, StandardId};
use heapless::Vec;
use panic_probe as _;
use protocol::cob::{AxisIds, HEARD_BY_SERVO, NodeId};
use protocol::{CanFrame, Station};
use servo::Servo;

bind_interrupts!(struct Interrupts {
    FDCAN1_IT0 => can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
});

/// Node ids of this board; another axis gets others.
const SERVO_NODE: u8 = 0x01;
const PLANT_NODE: u8 = 0x11;
/// The board's 120 Ω across the bus: on where the board ends it.
const TERMINATION: Level = Level::Low;
/// Frames that one event can cause: what was due (EMCY, torque, status, heartbeat) and then as many
/// for the frame that came, doubled.
type Outbox = Vec<CanFrame, 16>;

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
    // Kept alive: dropping an output disconnects its pin. CAN_SHDN low switches the transceiver on.
    let _transceiver_on = Output::new(peripherals.PC11, Level::Low, Speed::Low);
    let _termination = Output::new(peripherals.PC14, TERMINATION, Speed::Low);

    let mut can = CanConfigurator::new(
        peripherals.FDCAN1,
        peripherals.PA11,
        peripherals.PB9,
        Interrupts,
    );
    // Transmit as a FIFO: in priority mode a full mailbox aborts the pending frame with the lower
    // identifier.
    can.set_config(
        can.config()
            .set_nominal_bit_timing(NOMINAL)
            .set_frame_transmit(FrameTransmissionConfig::ClassicCanOnly)
            .set_tx_buffer_mode(TxBufferMode::Fifo)
            .set_global_filter(GlobalFilter::reject_all())
            .set_automatic_bus_off_recovery(true),
    );
    listen(&can);
    let (transmit, receive, properties) = can.start(OperatingMode::NormalOperationMode).split();
    spawner.spawn(unwrap!(node(transmit, receive)));
    info!("servo {} for plant {} on FDCAN1", SERVO_NODE, PLANT_NODE);
    loop {
        Timer::after(Duration::from_secs(10)).await;
        info!(
            "transmit errors {}, receive errors {}",
            properties.tx_error_count(),
            properties.rx_error_count()
        );
    }
}

#[embassy_executor::task]
async fn node(mut transmit: CanTx<'static>, mut receive: CanRx<'static>) {
    let mut servo = Servo::new(IDS);
    let mut out = Outbox::new();
    Station::boot(&mut servo, &mut |frame| post(&mut out, frame));
    loop {
        send(&mut transmit, &mut out).await;
        let due = servo
            .wake_at_us()
            .map_or(Instant::MAX, Instant::from_micros);
        match select(receive.read(), Timer::at(due)).await {
            Either::First(Ok(envelope)) => {
                if let Some(frame) = frame_of(&envelope.frame) {
                    servo.take(&frame, Instant::now().as_micros(), &mut |frame| {
                        post(&mut out, frame);
                    });
                }
            }
            Either::First(Err(bus)) => warn!("bus: {}", bus),
            Either::Second(()) => servo.time(Instant::now().as_micros(), &mut |frame| {
                post(&mut out, frame);
            }),
        }
    }
}

fn post(out: &mut Outbox, frame: CanFrame) {
    if out.push(frame).is_err() {
        error!("the node said more in one event than its outbox holds");
    }
}

fn frame_of(frame: &Frame) -> Option<CanFrame> {
    if frame.is_remote_frame() {
        return CanFrame::new_remote(*frame.id(), frame.dlc());
    }
    CanFrame::new(*frame.id(), frame.data())
}

async fn send(transmit: &mut CanTx<'static>, out: &mut Outbox) {
    for frame in &*out {
        let id = match frame.id() {
            embedded_can::Id::Standard(id) => id,
            embedded_can::Id::Extended(_) => StandardId::MAX,
        };
        match Frame::new_data(id, frame.payload()) {
            Ok(frame) => {
                transmit.write(&frame).await;
            }
            Err(_) => error!("a frame of the node does not fit the peripheral"),
        }
    }
    out.clear();
}
