//! What instructions of Thumb-2 say about the stack and about calls (Armv7-M Architecture Reference
//! Manual, A5.2, A5.3 and A7.7; the encoding is named with each).

/// What an instruction does, as far as the stack is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Does {
    /// Takes so many bytes of stack.
    Takes(u32),
    /// Calls a function.
    Calls(u64),
    /// Jumps to an address, and may leave the function by it.
    Goes(u64),
    /// Calls what a register or a word of memory holds, or goes there for good.
    GoesAnywhere,
    /// Sets the stack pointer to what nobody knows here.
    SetsStack,
    /// Nothing of that.
    Else,
}

/// Length of the instruction that begins with a halfword, bytes.
pub(super) const fn length(first: u16) -> u64 {
    if first >> 11 >= 0b11101 { 4 } else { 2 }
}

/// An instruction at an address; `second` is the halfword after the first.
pub(super) fn decode(address: u64, first: u16, second: u16) -> Does {
    if length(first) == 2 {
        narrow(address, first)
    } else {
        wide(address, first, second)
    }
}

fn narrow(address: u64, code: u16) -> Does {
    match code {
        // PUSH T1
        _ if code & 0xFE00 == 0xB400 => Does::Takes((code & 0x1FF).count_ones() * 4),
        // SUB (SP minus immediate) T1
        _ if code & 0xFF80 == 0xB080 => Does::Takes(u32::from(code & 0x7F) * 4),
        // B T1 (its last two conditions are other instructions) and T2
        _ if code & 0xF000 == 0xD000 && code >> 9 & 7 != 7 => {
            Does::Goes(relative(address, u32::from(code & 0xFF) << 1, 9))
        }
        _ if code & 0xF800 == 0xE000 => {
            Does::Goes(relative(address, u32::from(code & 0x7FF) << 1, 12))
        }
        // BLX (register) T1; BX T1 but for the link register
        _ if code & 0xFF87 == 0x4780 => Does::GoesAnywhere,
        _ if code & 0xFF87 == 0x4700 && code != 0x4770 => Does::GoesAnywhere,
        // MOV (register) T1 and ADD (register) T2 into the program counter and the stack pointer
        _ if code & 0xFF87 == 0x4687 || code & 0xFF87 == 0x4487 => Does::GoesAnywhere,
        _ if code & 0xFF87 == 0x4685 || code & 0xFF87 == 0x4485 => Does::SetsStack,
        _ => Does::Else,
    }
}

fn wide(address: u64, first: u16, second: u16) -> Does {
    let low = u32::from(second);
    let branches = first & 0xF800 == 0xF000 && second >> 15 == 1;
    let loads = first & 0xFF70 == 0xF850;
    match first {
        // STMDB with write-back, PUSH T2; STR and STRD with write-back, PUSH T3
        0xE92D => Does::Takes(low.count_ones() * 4),
        0xF84D if second & 0x0F00 == 0x0D00 => Does::Takes(low & 0xFF),
        0xE96D => Does::Takes((low & 0xFF) * 4),
        // VPUSH T1 and T2
        0xED2D | 0xED6D if second & 0x0E00 == 0x0A00 => Does::Takes((low & 0xFF) * 4),
        // SUB (SP minus immediate) T2 and T3, (SP minus register) T1
        _ if first & 0xFBEF == 0xF1AD && second & 0x8F00 == 0x0D00 => {
            Does::Takes(expanded(immediate(first, second)))
        }
        _ if first & 0xFBFF == 0xF2AD && second & 0x8F00 == 0x0D00 => {
            Does::Takes(immediate(first, second))
        }
        0xEBAD if second & 0x0F00 == 0x0D00 => Does::SetsStack,
        // MSR into MSP or PSP; LDR (immediate, literal, register) into the stack pointer
        _ if first & 0xFFF0 == 0xF380 && matches!(second, 0x8808 | 0x8809) => Does::SetsStack,
        _ if loads && second >> 12 == 13 => Does::SetsStack,
        // The same into the program counter, but for a return by the stack
        _ if loads && second >> 12 == 15 && first & 0xF != 13 => Does::GoesAnywhere,
        // BL T1; B T4 and T3
        _ if branches && second & 0x5000 == 0x5000 => Does::Calls(long(address, first, second)),
        _ if branches && second & 0x1000 != 0 => Does::Goes(long(address, first, second)),
        _ if branches && second & 0x5000 == 0 && first >> 7 & 7 != 7 => {
            Does::Goes(conditional(address, first, second))
        }
        _ => Does::Else,
    }
}

/// i:imm3:imm8.
fn immediate(first: u16, second: u16) -> u32 {
    u32::from(first >> 10 & 1) << 11 | u32::from(second >> 12 & 7) << 8 | u32::from(second & 0xFF)
}

/// ThumbExpandImm.
fn expanded(immediate: u32) -> u32 {
    let byte = immediate & 0xFF;
    match immediate >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (immediate & 0x7F | 0x80).rotate_right(immediate >> 7),
    }
}

fn long(address: u64, first: u16, second: u16) -> u64 {
    let sign = first >> 10 & 1;
    let bit = |shift: u16| u32::from(1 ^ (second >> shift & 1) ^ sign);
    let offset = u32::from(sign) << 24
        | bit(13) << 23
        | bit(11) << 22
        | u32::from(first & 0x3FF) << 12
        | u32::from(second & 0x7FF) << 1;
    relative(address, offset, 25)
}

fn conditional(address: u64, first: u16, second: u16) -> u64 {
    let offset = u32::from(first >> 10 & 1) << 20
        | u32::from(second >> 11 & 1) << 19
        | u32::from(second >> 13 & 1) << 18
        | u32::from(first & 0x3F) << 12
        | u32::from(second & 0x7FF) << 1;
    relative(address, offset, 21)
}

/// The place that an offset of so many bits leads to: the counter is four bytes ahead.
fn relative(address: u64, offset: u32, bits: u32) -> u64 {
    let offset = (offset << (32 - bits)).cast_signed() >> (32 - bits);
    address.wrapping_add(4).wrapping_add_signed(offset.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `arm-none-eabi-as -mcpu=cortex-m4` encodes them.
    #[test]
    fn instructions_that_take_stack_say_how_much() {
        for (first, second, bytes) in [
            (0xB5F0, 0, 20),        // push {r4, r5, r6, r7, lr}
            (0xB094, 0, 80),        // sub sp, #80
            (0xE92D, 0x4FF0, 36),   // push.w {r4, …, fp, lr}
            (0xF84D, 0x8D04, 4),    // str.w r8, [sp, #-4]!
            (0xF5AD, 0x7D28, 672),  // sub.w sp, sp, #672
            (0xF6AD, 0x0D0C, 2060), // subw sp, sp, #2060
            (0xED2D, 0x8B04, 16),   // vpush {d8, d9}
        ] {
            assert_eq!(decode(0, first, second), Does::Takes(bytes), "{first:04x}");
        }
        assert_eq!(decode(0, 0xB004, 0), Does::Else, "add sp, #16");
    }

    #[test]
    fn branches_and_calls_say_where_they_go() {
        // bl, b.w, beq.w and b.n to 0x0800_0100 and back to 0x0800_0000
        let at = 0x0800_0000;
        assert_eq!(decode(at, 0xF000, 0xF87E), Does::Calls(at + 0x100));
        assert_eq!(decode(at, 0xF000, 0xB87E), Does::Goes(at + 0x100));
        assert_eq!(decode(at, 0xF000, 0x807E), Does::Goes(at + 0x100));
        assert_eq!(decode(at, 0xE07E, 0), Does::Goes(at + 0x100));
        assert_eq!(decode(at + 0x100, 0xF7FF, 0xFF7E), Does::Calls(at));
        assert_eq!(decode(at, 0x4798, 0), Does::GoesAnywhere, "blx r3");
        assert_eq!(decode(at, 0x4770, 0), Does::Else, "bx lr");
        assert_eq!(
            decode(at, 0xF8D0, 0xF000),
            Does::GoesAnywhere,
            "ldr.w pc, [r0]"
        );
        assert_eq!(decode(at, 0xF85D, 0xFB04), Does::Else, "ldr.w pc, [sp], #4");
    }

    #[test]
    fn a_stack_pointer_from_elsewhere_is_told() {
        // mov sp, r4; msr msp, r0; sub.w sp, sp, r4; ldr.w sp, [r0]
        for (first, second) in [
            (0x46A5, 0),
            (0xF380, 0x8808),
            (0xEBAD, 0x0D04),
            (0xF8D0, 0xD000),
        ] {
            assert_eq!(decode(0, first, second), Does::SetsStack, "{first:04x}");
        }
    }
}
