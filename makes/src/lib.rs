//! Records of axes of unlike make, to judge the identification on.
//!
//! It shares nothing with the plant simulator and nothing with the fit: mechanics, friction,
//! drives, controllers and encoders are written a second time, from the literature, and put
//! together in other ways. What is found on these records was therefore not put into both sides by
//! one hand.
//!
//! | module | what |
//! |---|---|
//! | [`mechanics`] | bodies, joints, friction, fields, and their step |
//! | [`drive`], [`control`], [`motion`] | current loop, controllers, setpoints |
//! | [`sensing`] | encoders, the log of the effort, time stamps |
//! | [`rig`] | all of it put together and run |
//! | [`make`] | the makes: hidden, empty, declared, another day |
//! | [`clean`] | records that must stay explained |
//! | [`outside`] | disturbances outside the list |
//! | [`spoilt`] | bad records |
//! | [`entry`], [`truth`] | the folder that is written, and `truth.json` |
//!
//! `cargo run -p makes --example makes -- DIR` writes all of them.

mod bench;
pub mod clean;
pub mod control;
pub mod draw;
pub mod drive;
pub mod entry;
pub mod make;
pub mod mechanics;
pub mod motion;
pub mod outside;
pub mod rig;
pub mod sensing;
pub mod spoilt;
pub mod table;
pub mod truth;

/// How one record is made, without making it.
pub struct Recipe {
    /// Which table it is a row of: `makes`, `clean`, `outside` or `spoilt`.
    pub table: &'static str,
    /// Makes it.
    pub make: Box<dyn Fn() -> entry::Entry + Send + Sync>,
}

/// Every record, for a seed.
#[must_use]
pub fn recipes(seed: u64) -> Vec<Recipe> {
    let mut all = Vec::new();
    for make in make::all() {
        for form in make::Form::ALL {
            all.push(Recipe {
                table: "makes",
                make: Box::new(move || make.entry(form, seed)),
            });
        }
    }
    let row = |table, make: Box<dyn Fn() -> entry::Entry + Send + Sync>| Recipe { table, make };
    all.extend(
        clean::CLEAN
            .iter()
            .map(|c| row("clean", Box::new(move || c.entry(seed)))),
    );
    all.extend(
        outside::OUTSIDE
            .iter()
            .map(|o| row("outside", Box::new(move || o.entry(seed)))),
    );
    all.extend(
        spoilt::SPOILT
            .iter()
            .map(|s| row("spoilt", Box::new(move || s.entry(seed)))),
    );
    all
}
