//! What the identification says of axes of unlike make (crate `makes`), and whether it is right.
//!
//! ```text
//! choice  which records a scope runs            ┐
//! truth   what was said, beside what is true    ├─▶ page    the golden page, row by row
//! causes  words that name what a bad record has ┘   counts  what the rows come to
//!                                                   claims  what they have to come to
//! ```
//!
//! The identification is run by the test; nothing here calls it. `golden/makes.md` is the page.

pub mod causes;
pub mod choice;
pub mod claims;
pub mod counts;
pub mod page;
pub mod truth;
