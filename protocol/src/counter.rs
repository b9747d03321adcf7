//! The SYNC counter, 1…240 (object 1019h, CiA 301 §7.5.2.22), compared modulo 240.

/// Value of the SYNC counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SyncCounter(u8);

/// The counter runs from 1 to this value and starts again at 1.
pub const SYNC_OVERFLOW: u8 = 240;

impl SyncCounter {
    /// The first value after NMT start.
    pub const FIRST: Self = Self(1);

    /// A counter, or `None` outside 1…240.
    #[must_use]
    pub const fn new(value: u8) -> Option<Self> {
        if value >= 1 && value <= SYNC_OVERFLOW {
            Some(Self(value))
        } else {
            None
        }
    }

    /// The value on the wire.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }

    /// The counter of the cycle after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        if self.0 >= SYNC_OVERFLOW {
            Self(1)
        } else {
            Self(self.0.saturating_add(1))
        }
    }

    /// Cycles from `earlier` to `self`, modulo 240: 0…239.
    ///
    /// ```
    /// use protocol::SyncCounter;
    /// let (old, new) = (SyncCounter::new(239).unwrap(), SyncCounter::new(2).unwrap());
    /// assert_eq!(new.cycles_since(old), 3);
    /// ```
    #[must_use]
    pub const fn cycles_since(self, earlier: Self) -> u8 {
        if self.0 >= earlier.0 {
            self.0.saturating_sub(earlier.0)
        } else {
            SYNC_OVERFLOW
                .saturating_sub(earlier.0)
                .saturating_add(self.0)
        }
    }
}
