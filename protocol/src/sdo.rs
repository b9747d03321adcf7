//! SDO, expedited transfers only (CiA 301 §7.2.4.3): requests and responses as values.
//!
//! `canopen-rs` serves for NMT and EMCY; its SDO side lacks a decoder of requests and the abort
//! codes of range checks and device state, and its encoder keeps a panic path, so the expedited
//! layout is here.

/// Object index and subindex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    /// 16-bit index.
    pub index: u16,
    /// 8-bit subindex.
    pub subindex: u8,
}

impl Address {
    /// An address from its two parts.
    #[must_use]
    pub const fn new(index: u16, subindex: u8) -> Self {
        Self { index, subindex }
    }

    /// A transfer: command specifier, address, four data bytes.
    const fn transfer(self, command: u8, [a, b, c, d]: [u8; 4]) -> [u8; 8] {
        let [low, high] = self.index.to_le_bytes();
        [command, low, high, self.subindex, a, b, c, d]
    }
}

/// Data of an expedited transfer: 1 to 4 bytes, little endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expedited {
    bytes: [u8; 4],
    len: u8,
}

impl Expedited {
    /// One byte.
    #[must_use]
    pub const fn u8(value: u8) -> Self {
        Self {
            bytes: [value, 0, 0, 0],
            len: 1,
        }
    }

    /// Two bytes.
    #[must_use]
    pub const fn u16(value: u16) -> Self {
        let [a, b] = value.to_le_bytes();
        Self {
            bytes: [a, b, 0, 0],
            len: 2,
        }
    }

    /// Four bytes.
    #[must_use]
    pub const fn u32(value: u32) -> Self {
        Self {
            bytes: value.to_le_bytes(),
            len: 4,
        }
    }

    /// Four bytes, signed.
    #[must_use]
    pub const fn i32(value: i32) -> Self {
        Self {
            bytes: value.to_le_bytes(),
            len: 4,
        }
    }

    /// The first bytes of a transfer's data, 1 to 4; what lies beyond them is no part of the value.
    const fn first(len: u8, [a, b, c, d]: [u8; 4]) -> Self {
        let bytes = match len {
            1 => [a, 0, 0, 0],
            2 => [a, b, 0, 0],
            3 => [a, b, c, 0],
            _ => [a, b, c, d],
        };
        Self { bytes, len }
    }

    /// The value as the 4 bytes say it; bytes beyond the length are zero.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        u32::from_le_bytes(self.bytes)
    }

    /// The value with the sign of its own length.
    #[must_use]
    pub const fn to_i32(self) -> i32 {
        let [a, b, c, _] = self.bytes;
        match self.len {
            1 => i32::from_le_bytes([a, fill(a), fill(a), fill(a)]),
            2 => i32::from_le_bytes([a, b, fill(b), fill(b)]),
            3 => i32::from_le_bytes([a, b, c, fill(c)]),
            _ => i32::from_le_bytes(self.bytes),
        }
    }

    /// Length in bytes, 1…4.
    #[must_use]
    #[expect(
        clippy::len_without_is_empty,
        reason = "an expedited transfer is never empty"
    )]
    pub const fn len(self) -> u8 {
        self.len
    }

    /// Command specifier of an expedited transfer with its size: bits 2 and 3 count the bytes
    /// without data.
    const fn command(self, request_or_response: u8) -> u8 {
        let unused = 4_u8.saturating_sub(self.len) & 3;
        request_or_response | unused.wrapping_shl(2) | 0x03
    }
}

const fn fill(high: u8) -> u8 {
    if high & 0x80 == 0 { 0x00 } else { 0xFF }
}

/// What a client asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Read an object.
    Upload(Address),
    /// Write an object; where the client does not say the size, all 4 bytes count.
    Download(Address, Expedited),
    /// Anything else: segmented or block transfers, unknown command specifiers.
    Unsupported(Address),
    /// The client gives up.
    Abort(Address),
}

impl Request {
    /// The object that it is about.
    #[must_use]
    pub const fn address(self) -> Address {
        match self {
            Self::Upload(address)
            | Self::Download(address, _)
            | Self::Unsupported(address)
            | Self::Abort(address) => address,
        }
    }

    /// Decodes the 8 bytes of a request; total.
    #[must_use]
    pub const fn decode(payload: [u8; 8]) -> Self {
        let [command, low, high, subindex, data @ ..] = payload;
        let address = Address::new(u16::from_le_bytes([low, high]), subindex);
        match command {
            0x40 => Self::Upload(address),
            0x80 => Self::Abort(address),
            0x22 | 0x23 => Self::Download(address, Expedited::first(4, data)),
            0x27 => Self::Download(address, Expedited::first(3, data)),
            0x2B => Self::Download(address, Expedited::first(2, data)),
            0x2F => Self::Download(address, Expedited::first(1, data)),
            _ => Self::Unsupported(address),
        }
    }

    /// The 8 bytes of a request. `Unsupported` is encoded as an abort: it has no bytes of its own.
    #[must_use]
    pub const fn encode(self) -> [u8; 8] {
        match self {
            Self::Upload(address) => address.transfer(0x40, [0; 4]),
            Self::Download(address, data) => address.transfer(data.command(0x20), data.bytes),
            Self::Unsupported(address) | Self::Abort(address) => {
                abort(address, AbortCode::GeneralError.value())
            }
        }
    }
}

/// What the server answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// The object's value.
    Uploaded(Address, Expedited),
    /// The write was checked and taken.
    Downloaded(Address),
    /// Nothing was changed.
    Aborted(Address, u32),
    /// Not a response that this client knows.
    Unknown,
}

impl Response {
    /// Whether it answers a request about an object, as far as it says.
    #[must_use]
    pub fn is_about(self, object: Address) -> bool {
        match self {
            Self::Uploaded(address, _) | Self::Downloaded(address) | Self::Aborted(address, _) => {
                address == object
            }
            Self::Unknown => true,
        }
    }

    /// Decodes the 8 bytes of a response; total.
    #[must_use]
    pub const fn decode(payload: [u8; 8]) -> Self {
        let [command, low, high, subindex, data @ ..] = payload;
        let address = Address::new(u16::from_le_bytes([low, high]), subindex);
        match command {
            0x60 => Self::Downloaded(address),
            0x80 => Self::Aborted(address, u32::from_le_bytes(data)),
            0x43 => Self::Uploaded(address, Expedited::first(4, data)),
            0x47 => Self::Uploaded(address, Expedited::first(3, data)),
            0x4B => Self::Uploaded(address, Expedited::first(2, data)),
            0x4F => Self::Uploaded(address, Expedited::first(1, data)),
            _ => Self::Unknown,
        }
    }

    /// The 8 bytes of a response.
    #[must_use]
    pub const fn encode(self) -> [u8; 8] {
        match self {
            Self::Uploaded(address, data) => address.transfer(data.command(0x40), data.bytes),
            Self::Downloaded(address) => address.transfer(0x60, [0; 4]),
            Self::Aborted(address, code) => abort(address, code),
            Self::Unknown => abort(Address::new(0, 0), AbortCode::GeneralError.value()),
        }
    }
}

const fn abort(address: Address, code: u32) -> [u8; 8] {
    address.transfer(0x80, code.to_le_bytes())
}

/// Abort codes, CiA 301 table 22.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum AbortCode {
    /// Command specifier not valid or unknown.
    CommandUnknown = 0x0504_0001,
    /// Attempt to read a write-only object.
    WriteOnly = 0x0601_0001,
    /// Attempt to write a read-only object.
    ReadOnly = 0x0601_0002,
    /// Object does not exist.
    ObjectMissing = 0x0602_0000,
    /// General parameter incompatibility: the set as a whole is not valid.
    ParameterIncompatible = 0x0604_0043,
    /// Length too high.
    LengthTooHigh = 0x0607_0012,
    /// Length too low.
    LengthTooLow = 0x0607_0013,
    /// Subindex does not exist.
    SubindexMissing = 0x0609_0011,
    /// Value within its range, but not valid.
    ValueInvalid = 0x0609_0030,
    /// Value above its range.
    ValueTooHigh = 0x0609_0031,
    /// Value below its range.
    ValueTooLow = 0x0609_0032,
    /// General error.
    GeneralError = 0x0800_0000,
    /// Not possible in the present device state.
    DeviceState = 0x0800_0022,
}

impl AbortCode {
    /// All codes that the servo sends.
    pub const ALL: [Self; 13] = [
        Self::CommandUnknown,
        Self::WriteOnly,
        Self::ReadOnly,
        Self::ObjectMissing,
        Self::ParameterIncompatible,
        Self::LengthTooHigh,
        Self::LengthTooLow,
        Self::SubindexMissing,
        Self::ValueInvalid,
        Self::ValueTooHigh,
        Self::ValueTooLow,
        Self::GeneralError,
        Self::DeviceState,
    ];

    /// The 32-bit code on the wire.
    #[must_use]
    #[expect(
        clippy::as_conversions,
        reason = "repr(u32): the discriminant is the code"
    )]
    pub const fn value(self) -> u32 {
        self as u32
    }

    /// What a code says, for people.
    #[must_use]
    pub fn text(code: u32) -> &'static str {
        match Self::ALL.into_iter().find(|known| known.value() == code) {
            Some(Self::CommandUnknown) => "command not supported (only expedited transfers are)",
            Some(Self::WriteOnly) => "object is write-only",
            Some(Self::ReadOnly) => "object is read-only",
            Some(Self::ObjectMissing) => "object does not exist",
            Some(Self::ParameterIncompatible) => "the parameter set as a whole is not valid",
            Some(Self::LengthTooHigh) => "value has too many bytes",
            Some(Self::LengthTooLow) => "value has too few bytes",
            Some(Self::SubindexMissing) => "subindex does not exist",
            Some(Self::ValueInvalid) => "value not supported",
            Some(Self::ValueTooHigh) => "value above its range",
            Some(Self::ValueTooLow) => "value below its range",
            Some(Self::GeneralError) => "general error",
            Some(Self::DeviceState) => "not possible in the present drive state",
            None => "unknown abort code",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_eight_bytes_decode_and_what_we_encode_comes_back(payload in any::<[u8; 8]>()) {
            match Request::decode(payload) {
                Request::Unsupported(_) | Request::Abort(_) => {}
                request => prop_assert_eq!(Request::decode(request.encode()).encode(), request.encode()),
            }
            match Response::decode(payload) {
                Response::Unknown => {}
                response => prop_assert_eq!(Response::decode(response.encode()).encode(), response.encode()),
            }
        }
    }

    #[test]
    fn expedited_transfers_have_the_bytes_of_cia_301() {
        let at = Address::new(0x6065, 0x02);
        assert_eq!(
            Request::Upload(at).encode(),
            [0x40, 0x65, 0x60, 0x02, 0, 0, 0, 0]
        );
        assert_eq!(
            Request::Download(at, Expedited::u8(7)).encode(),
            [0x2F, 0x65, 0x60, 0x02, 7, 0, 0, 0]
        );
        assert_eq!(
            Request::Download(at, Expedited::u16(0x1234)).encode(),
            [0x2B, 0x65, 0x60, 0x02, 0x34, 0x12, 0, 0]
        );
        assert_eq!(
            Response::Uploaded(at, Expedited::i32(-2)).encode(),
            [0x43, 0x65, 0x60, 0x02, 0xFE, 0xFF, 0xFF, 0xFF]
        );
        assert_eq!(
            Response::Downloaded(at).encode(),
            [0x60, 0x65, 0x60, 0x02, 0, 0, 0, 0]
        );
    }

    #[test]
    fn abort_codes_have_a_text() {
        for code in AbortCode::ALL {
            assert_ne!(AbortCode::text(code.value()), "unknown abort code");
        }
    }
}
