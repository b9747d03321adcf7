//! Which records of unlike make a scope runs.
//!
//! `certify` runs all of them, `test` one of every third make with the forms in rotation and some
//! of the other tables, `quick` a handful. One of every make would take a minute more on two cores,
//! and `cargo test` has none to spare. Records that are held back are in none of these lists.

use makes::Recipe;
use makes::make::Form;
use scope::Scope;

/// Seed of the records of the golden page.
pub const SEED: u64 = 1;
/// The tables of the golden page, in its order.
pub const TABLES: [&str; 4] = ["makes", "clean", "outside", "spoilt"];
/// The tables that were held back until their pages were made: since then they find bugs as the
/// others do.
pub const ONCE_HELD_BACK: [&str; 6] = [
    "held-back",
    "unseen",
    "untried",
    "unmet",
    "unforeseen",
    "unexpected",
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
    let (quick, test) = match table {
        "makes" => (2, all.len() / Form::ALL.len() / 3),
        "clean" => (1, 2),
        "outside" => (1, 3),
        once if ONCE_HELD_BACK.contains(&once) => (1, 2),
        _ => (2, 6),
    };
    let count = Scope::now().pick(quick, test, all.len());
    println!(
        "{table}: {count} of {} records (scope {:?})",
        all.len(),
        Scope::now()
    );
    let places: Vec<usize> = (0..count)
        .map(|row| place(table, row, count, all.len()))
        .collect();
    let chosen = all.into_iter().enumerate();
    chosen
        .filter(|(place, _)| places.contains(place))
        .map(|(_, recipe)| recipe)
        .collect()
}

/// Place of the row-th of `count` records that are spread over a table. The forms of a make stand
/// together, so that one more for each row makes them rotate.
fn place(table: &str, row: usize, count: usize, all: usize) -> usize {
    let spread = row * all / count;
    let is_one_of_forms = table == "makes" && count < all;
    spread
        + if is_one_of_forms {
            row % Form::ALL.len()
        } else {
            0
        }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_record_of_every_third_make_with_the_forms_in_rotation_covers_makes_and_forms() {
        let all = of_table("makes");
        let makes = all.len() / 4 / 3;
        let places: BTreeSet<usize> = (0..makes)
            .map(|row| place("makes", row, makes, all.len()))
            .collect();
        assert_eq!(places.len(), makes);
        assert_eq!(
            places
                .iter()
                .map(|place| place / 4)
                .collect::<BTreeSet<_>>()
                .len(),
            makes
        );
        assert_eq!(
            places
                .iter()
                .map(|place| place % 4)
                .collect::<BTreeSet<_>>()
                .len(),
            4
        );
    }

    #[test]
    fn the_whole_table_is_in_its_order() {
        for table in TABLES {
            let places: Vec<usize> = (0..9).map(|row| place(table, row, 9, 9)).collect();
            assert_eq!(places, (0..9).collect::<Vec<_>>());
        }
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
