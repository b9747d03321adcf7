//! How much stack a call takes: it is painted, and looked at afterwards.

/// Painted below the caller, bytes.
const PAINTED: usize = 16 * 1024;
/// Left as it is below the stack pointer, for this function and what it calls to paint.
const OWN: usize = 256;
const PAINT: u32 = 0x5AFE_57AC;

/// Bytes of stack that a call takes; more than [`PAINTED`] look like that.
#[inline(never)]
#[expect(unsafe_code, reason = "nobody has a reference to the stack below")]
pub(crate) fn taken_by(call: impl FnOnce()) -> usize {
    let top = cortex_m::register::msp::read() as usize - OWN;
    let bottom = top - PAINTED;
    for address in (bottom..top).step_by(4) {
        let place = core::ptr::with_exposed_provenance_mut::<u32>(address);
        // SAFETY: memory below the stack pointer, within the RAM of the machine.
        unsafe { place.write_volatile(PAINT) };
    }
    call();
    let is_paint = |address: &usize| {
        let place = core::ptr::with_exposed_provenance::<u32>(*address);
        // SAFETY: as above.
        unsafe { place.read_volatile() == PAINT }
    };
    let painted = (bottom..top).step_by(4).take_while(is_paint).count();
    OWN + PAINTED - 4 * painted
}
