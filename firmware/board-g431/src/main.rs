//! The drive node on ST's B-G431B-ESC1 (STM32G431CB): FDCAN1 on PA11 (receive) and PB9 (transmit),
//! with the board's own transceiver. Everything else is [`drive_board`].
//!
//! Node ids are those of axis 0, or of the environment when the image is built:
//! `SERVO_NODE=2 PLANT_NODE=18 cargo fw`.
#![no_std]
#![no_main]

use board_timing::B_G431B_ESC1;
use drive_board::{Pins, clock};
use embassy_executor::Spawner;
use embassy_stm32::bind_interrupts;
use embassy_stm32::can::{self, CanConfigurator};
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::peripherals::FDCAN1;
use protocol::AxisIds;

bind_interrupts!(struct Interrupts {
    FDCAN1_IT0 => can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
});

const IDS: AxisIds = drive_board::ids(option_env!("SERVO_NODE"), option_env!("PLANT_NODE"));
/// The board's 120 Ω across the bus: on where the board ends it.
const TERMINATION: Level = Level::Low;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = embassy_stm32::init(clock::config(B_G431B_ESC1));
    // CAN_SHDN low switches the transceiver on.
    let pins = Pins::from_iter([
        Output::new(board.PC11, Level::Low, Speed::Low),
        Output::new(board.PC14, TERMINATION, Speed::Low),
    ]);
    let can = CanConfigurator::new(board.FDCAN1, board.PA11, board.PB9, Interrupts);
    drive_board::start(spawner, can, board.IWDG, IDS, pins);
}
