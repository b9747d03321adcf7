//! The drive node on ST's NUCLEO-G474RE (STM32G474RE): FDCAN1 on PA11 (receive) and PA12
//! (transmit), pins 14 and 12 of CN10, to a transceiver of your own. Everything else is
//! [`drive_board`].
//!
//! The image is linked into the flash and memory of the smaller board: the addresses are the same,
//! 124 of 512 KiB and 22 of 96 KiB. Node ids as on the other board.
#![no_std]
#![no_main]

use board_timing::NUCLEO_G474RE;
use drive_board::{Pins, clock};
use embassy_executor::Spawner;
use embassy_stm32::bind_interrupts;
use embassy_stm32::can::{self, CanConfigurator};
use embassy_stm32::peripherals::FDCAN1;
use protocol::AxisIds;

bind_interrupts!(struct Interrupts {
    FDCAN1_IT0 => can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
});

const IDS: AxisIds = drive_board::ids(option_env!("SERVO_NODE"), option_env!("PLANT_NODE"));

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = embassy_stm32::init(clock::config(NUCLEO_G474RE));
    let can = CanConfigurator::new(board.FDCAN1, board.PA11, board.PA12, Interrupts);
    drive_board::start(spawner, can, board.IWDG, IDS, Pins::new());
}
