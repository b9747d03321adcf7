//! How much of a table a test runs, and the cores that run it.
//!
//! Commands run the same tests over more or less of their tables (aliases in
//! `.cargo/config.toml`):
//!
//! | command | scope | what runs |
//! |---|---|---|
//! | `cargo quick` | [`Scope::Quick`] | one row, seed or record of each table: the everyday loop |
//! | `cargo test` | [`Scope::Test`] | every claim, with at least one row, seed or machine of each |
//! | with `QUADRANT_SCOPE=landing` | [`Scope::Landing`] | more of what is longest, for CI |
//! | `cargo certify` | [`Scope::Certify`] | everything: all rows, all seeds, millions of ticks |
//!
//! The alias sets `PROPTEST_CASES` (32 and 10 000 random cases; without it proptest takes its own
//! 256) and `QUADRANT_SCOPE`. Tests ask [`Scope::now`] when they run, so nothing is compiled twice.
//! A test says what each scope runs in one line:
//!
//! ```
//! use scope::Scope;
//! let ticks: u32 = Scope::now().pick(1_000, 20_000, 1_000_000);
//! let seeds: Vec<u64> = (1..=10).collect();
//! for seed in Scope::now().rows("seeds", &seeds, 1, 2) {
//!     assert!(*seed > 0 && ticks >= 1_000);
//! }
//! ```
//!
//! Nothing is left out in silence: [`Scope::rows`] prints how many rows of how many run, and
//! `certify` always gets them all. The crate depends on nothing, so that the cores can use it in
//! their tests without a circle.

mod cores;

pub use cores::on_all_cores;

/// How much of a table a test runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// `cargo quick`: one row, seed or record of each table.
    Quick,
    /// `cargo test`: every claim, with at least one row, seed or machine of each.
    Test,
    /// As [`Self::Test`], but for what is longest: other rows of tables, whole runs; for what runs
    /// both.
    Landing,
    /// `cargo certify`: the full tables.
    Certify,
}

impl Scope {
    /// The environment variable that the aliases set.
    pub const VARIABLE: &str = "QUADRANT_SCOPE";

    /// The scope of the command that runs this test.
    ///
    /// # Panics
    /// When `QUADRANT_SCOPE` is set to something that is not a scope: a typing error must not run
    /// less than was asked for.
    pub fn now() -> Self {
        let value =
            std::env::var_os(Self::VARIABLE).map(|value| value.to_string_lossy().into_owned());
        Self::named(value.as_deref()).unwrap_or_else(|wrong| panic!("{wrong}"))
    }

    /// The scope of a value of `QUADRANT_SCOPE`; unset is `test`.
    ///
    /// # Errors
    /// With the value and what it may be.
    pub fn named(value: Option<&str>) -> Result<Self, String> {
        match value {
            Some("quick") => Ok(Self::Quick),
            None | Some("test") => Ok(Self::Test),
            Some("landing") => Ok(Self::Landing),
            Some("certify") => Ok(Self::Certify),
            Some(wrong) => Err(format!(
                "{} is `{wrong}`: wanted quick, test, landing or certify",
                Self::VARIABLE
            )),
        }
    }

    /// The value of this scope; that of `test` for [`Self::Landing`].
    pub fn pick<T>(self, quick: T, test: T, certify: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Test | Self::Landing => test,
            Self::Certify => certify,
        }
    }

    /// The first `quick`, the first `test` or all rows of a table; prints how many of how many.
    ///
    /// Put the rows that say most at the front.
    ///
    /// # Panics
    /// When a scope would run no row, or more than there are: then the claim is not tested.
    pub fn rows<'a, T>(self, table: &str, rows: &'a [T], quick: usize, test: usize) -> &'a [T] {
        let some = rows
            .get(..self.pick(quick, test, rows.len()))
            .unwrap_or(&[]);
        assert!(
            !some.is_empty(),
            "{table}: scope {self:?} runs none of {} rows",
            rows.len()
        );
        println!(
            "{table}: {} of {} rows (scope {self:?})",
            some.len(),
            rows.len()
        );
        some
    }

    /// Rows spread evenly over a table, the first one included; prints how many of how many.
    ///
    /// For tables whose neighbours are alike, where the first rows would be one group only.
    ///
    /// # Panics
    /// When a scope would run no row, or more than there are.
    pub fn spread<'a, T>(
        self,
        table: &str,
        rows: &'a [T],
        quick: usize,
        test: usize,
    ) -> Vec<&'a T> {
        let wanted = self.pick(quick, test, rows.len());
        assert!(
            (1..=rows.len()).contains(&wanted),
            "{table}: scope {self:?} runs {wanted} of {} rows",
            rows.len()
        );
        println!("{table}: {wanted} of {} rows (scope {self:?})", rows.len());
        (0..wanted)
            .filter_map(|place| rows.get(place * rows.len() / wanted))
            .collect()
    }

    /// Whether this is `quick` and another test has this table's row already; prints which.
    pub fn leaves_row_to(self, other: &str) -> bool {
        if self == Self::Quick {
            println!("nothing here (scope {self:?}): the row of this table runs in {other}");
        }
        self == Self::Quick
    }

    /// Whether this scope runs everything.
    pub fn is_complete(self) -> bool {
        self == Self::Certify
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scope_runs_at_least_what_the_smaller_one_runs_and_certify_runs_everything() {
        let rows: Vec<u32> = (0..65).collect();
        let count = |scope: Scope| {
            (
                scope.rows("rows", &rows, 1, 9).len(),
                scope.spread("rows", &rows, 1, 9).len(),
            )
        };
        assert_eq!(
            [Scope::Quick, Scope::Test, Scope::Landing, Scope::Certify].map(count),
            [(1, 1), (9, 9), (9, 9), (65, 65)]
        );
        assert_eq!(
            Scope::Certify.spread("rows", &rows, 1, 9),
            rows.iter().collect::<Vec<_>>()
        );
        assert_eq!(Scope::Test.spread("rows", &rows, 1, 4), [&0, &16, &32, &48]);
    }

    #[test]
    fn without_the_variable_it_is_the_scope_of_cargo_test_and_a_typing_error_is_refused() {
        assert_eq!(Scope::named(None), Ok(Scope::Test));
        assert_eq!(Scope::named(Some("certify")), Ok(Scope::Certify));
        assert!(Scope::named(Some("cerify")).unwrap_err().contains("cerify"));
    }

    #[test]
    #[should_panic(expected = "runs none")]
    fn a_scope_that_would_run_no_row_is_refused() {
        let _ = Scope::Quick.rows("rows", &[1, 2, 3], 0, 1);
    }
}
