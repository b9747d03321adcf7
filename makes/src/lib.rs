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
//! | [`mod@make::held_back`], [`outside::held_back`] | those written apart, to be run once |
//! | [`mod@make::unseen`], [`outside::unseen`] | those written after them, to be run once |
//! | [`mod@make::untried`], [`outside::untried`] | those written after these, to be run once |
//! | [`mod@make::unmet`], [`outside::unmet`] | those written after them, to be run once |
//! | [`mod@make::unforeseen`], [`outside::unforeseen`] | those written after them too |
//! | [`mod@make::unexpected`], [`outside::unexpected`] | those written after all of these |
//! | [`mod@make::unsought`], [`outside::unsought`] | those written after them |
//! | [`mod@make::families`] | those by families of friction, waves and masses, written last |
//! | [`clean`] | records that must stay explained |
//! | [`outside`] | disturbances outside the list |
//! | [`spoilt`] | bad records |
//! | [`entry`], [`truth`] | the folder that is written, and `truth.json` |
//!
//! `cargo run -p makes --example makes -- DIR` writes all of them; a seed and a part of
//! a name may follow.

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
    /// Which table it is a row of: `makes`, `held-back`, `unseen`, `untried`, `unmet`,
    /// `unforeseen`, `unexpected`, `unsought`, `families`, `clean`, `outside` or `spoilt`.
    pub table: &'static str,
    /// Name of the record.
    pub name: String,
    make: Box<dyn Fn() -> entry::Entry + Send + Sync>,
}

impl Recipe {
    fn of(
        table: &'static str,
        name: impl Into<String>,
        make: impl Fn() -> entry::Entry + Send + Sync + 'static,
    ) -> Self {
        Self {
            table,
            name: name.into(),
            make: Box::new(make),
        }
    }

    /// Makes the record.
    #[must_use]
    pub fn entry(&self) -> entry::Entry {
        (self.make)()
    }
}

/// Makes and disturbances that were written apart, to be run once.
pub struct Apart {
    /// Which table its records are rows of.
    pub table: &'static str,
    /// Its makes.
    pub makes: Vec<make::Make>,
    /// Its disturbances, on machines of their own.
    pub outside: &'static [outside::Outside],
}

/// What was written apart, in the order in which it was.
#[must_use]
pub fn written_apart() -> [Apart; 8] {
    [
        Apart {
            table: "held-back",
            makes: make::held_back(),
            outside: outside::held_back::HELD_BACK,
        },
        Apart {
            table: "unseen",
            makes: make::unseen(),
            outside: outside::unseen::UNSEEN,
        },
        Apart {
            table: "untried",
            makes: make::untried(),
            outside: outside::untried::UNTRIED,
        },
        Apart {
            table: "unmet",
            makes: make::unmet(),
            outside: outside::unmet::UNMET,
        },
        Apart {
            table: "unforeseen",
            makes: make::unforeseen(),
            outside: outside::unforeseen::UNFORESEEN,
        },
        Apart {
            table: "unexpected",
            makes: make::unexpected(),
            outside: outside::unexpected::UNEXPECTED,
        },
        Apart {
            table: "unsought",
            makes: make::unsought(),
            outside: outside::unsought::UNSOUGHT,
        },
        Apart {
            table: "families",
            makes: make::families(),
            outside: &[],
        },
    ]
}

/// Every record, for a seed.
#[must_use]
pub fn recipes(seed: u64) -> Vec<Recipe> {
    let mut all = of_makes("makes", &make::all(), seed);
    for apart in written_apart() {
        all.extend(of_makes(apart.table, &apart.makes, seed));
        all.extend(with_their_empty(apart.table, apart.outside, seed));
    }
    let clean = clean::CLEAN.iter();
    all.extend(clean.map(|row| Recipe::of("clean", row.name, move || row.entry(seed))));
    let outside = outside::OUTSIDE.iter();
    all.extend(outside.map(|row| Recipe::of("outside", row.name, move || row.entry(seed))));
    let spoilt = spoilt::SPOILT.iter();
    all.extend(spoilt.map(|row| Recipe::of("spoilt", row.name, move || row.entry(seed))));
    all
}

/// Disturbances on machines of their own, and these machines without them.
fn with_their_empty(
    table: &'static str,
    rows: &'static [outside::Outside],
    seed: u64,
) -> impl Iterator<Item = Recipe> {
    rows.iter().flat_map(move |row| {
        [
            Recipe::of(table, row.name, move || row.entry(seed)),
            Recipe::of(table, row.empty_name(), move || row.empty_entry(seed)),
        ]
    })
}

fn of_makes(table: &'static str, makes: &[make::Make], seed: u64) -> Vec<Recipe> {
    let forms = |make: make::Make| {
        let recipe = move |form: make::Form| {
            Recipe::of(table, make.record_name(form), move || {
                make.entry(form, seed)
            })
        };
        make::Form::ALL.map(recipe)
    };
    makes.iter().copied().flat_map(forms).collect()
}
