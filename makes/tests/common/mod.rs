//! As many rows of all tables as the scope runs.

use makes::make::{Make, all};
use makes::outside::Outside;
use makes::written_apart;
use scope::Scope;

/// As many makes of a kind as the scope runs, of each table.
pub(crate) fn some_of(kind: impl Fn(&Make) -> bool) -> Vec<Make> {
    let some = |table: &str, mut makes: Vec<Make>, quick: usize, test: usize| {
        makes.retain(|make| kind(make));
        Scope::now().rows(table, &makes, quick, test).to_vec()
    };
    let apart = written_apart().into_iter();
    let apart = apart.flat_map(|apart| some(apart.table, apart.makes, 1, 2));
    some("makes", all(), 4, 6)
        .into_iter()
        .chain(apart)
        .collect()
}

/// As many disturbances as the scope runs of each table that was written apart.
pub(crate) fn some_outside() -> Vec<Outside> {
    let some = |table: &str, rows: &[Outside]| {
        let test = rows.len().min(2);
        Scope::now().rows(table, rows, 1, test).to_vec()
    };
    let apart = written_apart().into_iter();
    apart
        .filter(|apart| !apart.outside.is_empty())
        .flat_map(|apart| some(&format!("disturbances {}", apart.table), apart.outside))
        .collect()
}
