//! What people look at: pages, tables and plots.

pub mod page;
pub mod plots;
pub mod result_chapters;
pub mod result_pictures;
pub mod result_tables;
