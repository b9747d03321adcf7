//! The range of a quantity stands beside its field.
//!
//! ```text
//! ranged! {
//!     pub struct Limits {
//!         /// Velocity, m/s.
//!         pub velocity_m_per_s: f64 [1.0e-4 => 5.0],
//!     }
//! }
//! ```
//!
//! makes a struct that a machine file can be read into, without unknown keys, and a list of what
//! was read with its ranges, for [`crate::machine`] to refuse by key and line.

/// A quantity as it was read, with its key and what it may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quantity {
    /// Key of the machine file.
    pub key: &'static str,
    /// What was read.
    pub value: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

impl Quantity {
    /// A quantity of a key within a range.
    #[must_use]
    pub(crate) const fn new(key: &'static str, value: f64, (min, max): (f64, f64)) -> Self {
        Self {
            key,
            value,
            min,
            max,
        }
    }

    /// Whether it is within its range; what is not a number is not.
    #[must_use]
    pub(crate) fn fits(&self) -> bool {
        self.value >= self.min && self.value <= self.max
    }
}

/// A table of a machine file whose quantities have ranges.
pub(crate) trait Ranged {
    /// Its quantities as they were read.
    fn quantities(&self) -> Vec<Quantity>;
}

/// A field's value as a number; `None` where it was not given.
pub(crate) trait Number {
    /// The number.
    fn number(&self) -> Option<f64>;
}

impl Number for f64 {
    fn number(&self) -> Option<f64> {
        Some(*self)
    }
}

impl Number for u32 {
    fn number(&self) -> Option<f64> {
        Some(f64::from(*self))
    }
}

impl Number for Option<f64> {
    fn number(&self) -> Option<f64> {
        *self
    }
}

/// Defines a table of a machine file with the ranges of its quantities.
macro_rules! ranged {
    (
        $(#[$meta:meta])*
        $access:vis struct $name:ident {
            $(
                $(#[$field_meta:meta])*
                $field_access:vis $field:ident: $kind:ty $([$min:expr => $max:expr])?,
            )*
        }
    ) => {
        $(#[$meta])*
        #[derive(serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $access struct $name {
            $(
                $(#[$field_meta])*
                $field_access $field: $kind,
            )*
        }

        impl $crate::ranges::Ranged for $name {
            fn quantities(&self) -> Vec<$crate::ranges::Quantity> {
                let read = [
                    $($(
                        $crate::ranges::Number::number(&self.$field).map(|value| {
                            let range = ($min, $max);
                            $crate::ranges::Quantity::new(stringify!($field), value, range)
                        }),
                    )?)*
                ];
                read.into_iter().flatten().collect()
            }
        }
    };
}

pub(crate) use ranged;

#[cfg(test)]
mod tests {
    use super::*;

    ranged! {
        #[derive(Debug)]
        struct Table {
            mass_kg: f64 [1.0 => 2.0],
            counts: u32 [10.0 => 20.0],
            #[serde(default)]
            stop_m: Option<f64> [0.0 => 1.0],
            name: String,
        }
    }

    #[test]
    fn a_table_lists_what_was_read_with_its_ranges() {
        let table: Table = toml::from_str("mass_kg = 1.5\ncounts = 21\nname = \"a\"").unwrap();
        let read = table.quantities();
        assert_eq!(read.len(), 2, "stop_m was not given, a name has no range");
        assert_eq!(read[0], Quantity::new("mass_kg", 1.5, (1.0, 2.0)));
        assert!(read[0].fits() && !read[1].fits());
        assert_eq!((table.name.as_str(), table.stop_m), ("a", None));
    }

    #[test]
    fn a_range_takes_its_ends_and_nothing_beyond_them() {
        let fits = |value| Quantity::new("x", value, (-1.0, 2.0)).fits();
        assert!(fits(-1.0) && fits(2.0));
        assert!(!fits(-1.000_001) && !fits(2.000_001) && !fits(f64::NAN));
    }
}
