//! A classic CAN frame as the nodes see it, before it is decoded.

use embedded_can::{Frame, Id};

/// A classic CAN frame: identifier, at most 8 data bytes, or a remote request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanFrame {
    id: Id,
    remote: bool,
    len: u8,
    data: [u8; 8],
}

impl CanFrame {
    /// A data frame with all 8 bytes.
    #[must_use]
    pub fn full(id: impl Into<Id>, data: [u8; 8]) -> Self {
        Self {
            id: id.into(),
            remote: false,
            len: 8,
            data,
        }
    }

    /// A data frame of the first `LEN` bytes; `LEN` is checked when the program is compiled.
    #[must_use]
    pub fn of<const LEN: usize>(id: impl Into<Id>, payload: [u8; LEN]) -> Self {
        const { assert!(LEN <= 8, "a classic CAN frame carries at most 8 bytes") };
        let mut data = [0; 8];
        for (to, from) in data.iter_mut().zip(payload) {
            *to = from;
        }
        #[expect(
            clippy::as_conversions,
            clippy::cast_possible_truncation,
            reason = "LEN is at most 8, asserted above"
        )]
        let len = LEN as u8;
        Self {
            id: id.into(),
            remote: false,
            len,
            data,
        }
    }

    /// The data bytes; empty for a remote frame.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        if self.remote {
            &[]
        } else {
            self.data.get(..usize::from(self.len)).unwrap_or(&[])
        }
    }
}

impl Frame for CanFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            remote: false,
            len: u8::try_from(data.len()).ok()?,
            data: bytes,
        })
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        let len = u8::try_from(dlc).ok().filter(|len| *len <= 8)?;
        Some(Self {
            id: id.into(),
            remote: true,
            len,
            data: [0; 8],
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        usize::from(self.len)
    }

    fn data(&self) -> &[u8] {
        self.payload()
    }
}
