//! Crystal → PLL → 170 MHz for the core and, from Q, for FDCAN.

use board_timing::{B_G431B_ESC1, ClockTree, NUCLEO_G474RE};
use embassy_stm32::Config;
use embassy_stm32::rcc::{
    Hse, HseMode, Pll, PllMul, PllPreDiv, PllQDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;

// Register codes, held to the plain numbers that the host checks.
const N: PllMul = PllMul::MUL85;
const R: PllRDiv = PllRDiv::DIV2;
const Q: PllQDiv = PllQDiv::DIV2;

const fn holds(tree: ClockTree) -> bool {
    N.to_bits() as u32 == tree.pll_n
        && (R.to_bits() as u32 + 1) * 2 == tree.pll_r
        && (Q.to_bits() as u32 + 1) * 2 == tree.pll_q
}

const _: () = {
    assert!(holds(B_G431B_ESC1));
    assert!(holds(NUCLEO_G474RE));
};

/// The configuration of a clock tree. The HAL's default leaves the FDCAN multiplexer on a crystal
/// that is off.
#[must_use]
pub fn config(tree: ClockTree) -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse {
        freq: Hertz(tree.crystal_hz),
        mode: HseMode::Oscillator,
    });
    config.rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::from_bits((tree.pll_m - 1) as u8),
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
