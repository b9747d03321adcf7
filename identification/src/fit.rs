//! Least squares of a model on a record: columns, blocks, one-dimensional searches.

pub(crate) mod bench;
pub(crate) mod blocks;
pub(crate) mod search;
