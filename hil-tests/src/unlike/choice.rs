//! Which records of unlike make a scope runs.
//!
//! `certify` runs all of them, `test` the hidden record of every eighth make with one of its other
//! forms in turn (empty, declared, validation from another day) and some of the other tables,
//! `landing` the same of the other makes and more of the tables, `quick` a handful. Records
//! that are held back are in none of these lists.

use makes::Recipe;
use makes::make::Form;
use scope::Scope;

/// Seed of the records of the golden page.
pub const SEED: u64 = 1;
/// The tables of the golden page, in its order.
pub const TABLES: [&str; 4] = ["makes", "clean", "outside", "spoilt"];
/// The tables that were held back until their pages were made: since then they find bugs as the
/// others do.
pub const ONCE_HELD_BACK: [&str; 7] = [
    "held-back",
    "unseen",
    "untried",
    "unmet",
    "unforeseen",
    "unexpected",
    "families",
];
/// The table that is run once, at the end.
pub const HELD_BACK: &str = "unsought";

/// The records of a table.
#[must_use]
pub fn of_table(table: &str) -> Vec<Recipe> {
    let mut recipes = makes::recipes(SEED);
    recipes.retain(|recipe| recipe.table == table);
    recipes
}

/// The records of the scope; prints how many of how many.
#[must_use]
pub fn chosen() -> Vec<Recipe> {
    TABLES.into_iter().flat_map(chosen_of).collect()
}

/// The records of a table in the scope; prints how many of how many.
#[must_use]
pub fn chosen_of(table: &str) -> Vec<Recipe> {
    let all = of_table(table);
    let places = places(table, Scope::now(), all.len());
    println!(
        "{table}: {} of {} records (scope {:?})",
        places.len(),
        all.len(),
        Scope::now()
    );
    let chosen = all.into_iter().enumerate();
    chosen
        .filter(|(place, _)| places.contains(place))
        .map(|(_, recipe)| recipe)
        .collect()
}

/// Which of so many records of a table a scope runs: their places.
fn places(table: &str, scope: Scope, all: usize) -> Vec<usize> {
    if scope == Scope::Certify {
        return (0..all).collect();
    }
    if table == "makes" && scope != Scope::Quick {
        let wanted = |place: &usize| is_run(*place) && is_of_test(*place) == (scope == Scope::Test);
        return (0..all).filter(wanted).collect();
    }
    // Of those that are spread over the table `landing` runs what the others do not.
    let (first, spread) = match table {
        "makes" => (2, 2),
        "clean" => (1, 2),
        "outside" => (1, 3),
        _ if ONCE_HELD_BACK.contains(&table) => (1, 2),
        _ => (2, 6),
    };
    let places = (0..spread).map(|row| row * all / spread);
    match scope {
        Scope::Landing => places.skip(first).collect(),
        _ => places.take(first).collect(),
    }
}

/// Where a record of a make stands: its make and its form. The forms of a make stand together, the
/// hidden one first.
const fn at(place: usize) -> (usize, usize) {
    (place / Form::ALL.len(), place % Form::ALL.len())
}

/// The hidden one of every make, and each other form of every third make.
const fn is_run(place: usize) -> bool {
    let (make, form) = at(place);
    form == 0 || make % OTHERS == form % OTHERS
}

/// Of every eighth make.
const fn is_of_test(place: usize) -> bool {
    is_run(place) && at(place).0.is_multiple_of(8)
}

/// Forms beside the hidden one.
const OTHERS: usize = Form::ALL.len() - 1;

#[cfg(test)]
mod tests {
    use super::*;
    use makes::make;

    #[test]
    fn test_and_landing_run_the_hidden_record_of_every_make_and_one_of_its_other_forms_in_turn() {
        let all = of_table("makes");
        let of = |scope| places("makes", scope, all.len());
        let (of_test, more) = (of(Scope::Test), of(Scope::Landing));
        assert!(of_test.len() == 10 && more.len() == 68);
        let mut chosen = [of_test, more].concat();
        chosen.sort_unstable();
        let chosen = chosen.into_iter().map(|place| all[place].name.clone());
        let others = [Form::AnotherDay, Form::Empty, Form::Declared];
        let makes = make::all().into_iter().zip(others.into_iter().cycle());
        let wanted = makes
            .flat_map(|(make, other)| [Form::Hidden, other].map(|form| make.record_name(form)));
        assert_eq!(chosen.collect::<Vec<_>>(), wanted.collect::<Vec<_>>());
    }

    #[test]
    fn a_table_is_whole_where_everything_is_certified_and_spread_where_it_is_not() {
        for table in TABLES {
            let whole: Vec<usize> = (0..40).collect();
            assert_eq!(places(table, Scope::Certify, 40), whole);
            assert_eq!(places(table, Scope::Quick, 40)[0], 0);
        }
        assert_eq!(places("clean", Scope::Test, 40), [0]);
        assert_eq!(places("clean", Scope::Landing, 40), [20]);
        assert_eq!(places("spoilt", Scope::Test, 60), [0, 10]);
        assert_eq!(places("spoilt", Scope::Landing, 60), [20, 30, 40, 50]);
    }

    #[test]
    fn no_record_that_is_held_back_is_in_a_table_of_the_page() {
        for table in ONCE_HELD_BACK.into_iter().chain([HELD_BACK]) {
            assert!(!TABLES.contains(&table));
            assert!(!of_table(table).is_empty());
            assert!(chosen().iter().all(|recipe| recipe.table != table));
        }
    }
}
