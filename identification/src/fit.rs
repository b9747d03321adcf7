//! Least squares of a model on a record: columns, blocks, one-dimensional searches.

pub(crate) mod bench;
pub(crate) mod blocks;
pub(crate) mod fitted;
#[cfg(test)]
pub(crate) mod made;
pub(crate) mod non_negative;
pub(crate) mod plain;
pub(crate) mod primes;
pub(crate) mod rows;
pub(crate) mod search;
pub(crate) mod side_by_side;
pub(crate) mod span;
pub(crate) mod told;
pub(crate) mod tuning;
