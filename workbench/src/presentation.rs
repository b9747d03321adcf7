//! What people look at: pages, tables and plots.

pub mod certificate;
pub mod circle_pictures;
pub mod circle_tables;
pub mod compensation_words;
pub mod page;
pub mod plots;
pub mod result_chapters;
pub mod result_pictures;
pub mod result_tables;
