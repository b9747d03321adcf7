//! What people look at: pages and plots.

pub mod page;
pub mod plots;
