//! A cloud of samples as cells: the darker the more samples are in them.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::svg::px;

/// Edge of a cell, px.
const CELL_PX: f64 = 3.0;
/// Darknesses.
const LEVELS: usize = 4;

/// The path of each darkness, the faintest first.
pub(super) fn cells(places: impl IntoIterator<Item = (f64, f64)>) -> [String; LEVELS] {
    let mut counts: BTreeMap<(i32, i32), u32> = BTreeMap::new();
    for (x, y) in places {
        let [column, row] = [x, y].map(|value| (value / CELL_PX).floor() as i32);
        *counts.entry((row, column)).or_default() += 1;
    }
    let steps = darknesses(&counts);
    let mut paths: [String; LEVELS] = Default::default();
    let mut cells = counts
        .into_iter()
        .map(|(at, count)| (at, level(count, &steps)))
        .peekable();
    while let Some(((row, column), own)) = cells.next() {
        let mut wide = 1;
        while cells.next_if_eq(&((row, column + wide), own)).is_some() {
            wide += 1;
        }
        add_run(&mut paths[own], row, column, wide);
    }
    paths
}

/// Counts from which a cell is of the second, third and fourth darkness: quartiles of what is
/// there.
fn darknesses(counts: &BTreeMap<(i32, i32), u32>) -> [u32; LEVELS - 1] {
    let mut sizes: Vec<u32> = counts.values().copied().collect();
    sizes.sort_unstable();
    let at = |share: usize| {
        sizes
            .get(sizes.len() * share / LEVELS)
            .copied()
            .unwrap_or(1)
    };
    [at(1), at(2), at(3)].map(|size| size.max(2))
}

fn level(count: u32, steps: &[u32; LEVELS - 1]) -> usize {
    steps.iter().filter(|step| count >= **step).count()
}

fn add_run(path: &mut String, row: i32, column: i32, wide: i32) {
    let [x, y] = [column, row].map(|number| px(CELL_PX * f64::from(number)));
    let wide = px(CELL_PX * f64::from(wide));
    let edge = px(CELL_PX);
    let _ = write!(path, "M{x} {y}h{wide}v{edge}h-{wide}z");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_in_a_cell_and_crowded_cells_are_darker() {
        let lone = (0..10).map(|i| (30.0 * f64::from(i), 5.0));
        let crowd = (0..100).map(|i| (1.5 + 0.01 * f64::from(i), 50.0));
        let paths = cells(lone.chain(crowd));
        assert_eq!(paths[0].matches('M').count(), 10);
        assert_eq!(paths[3], "M0 48h3v3h-3z");
    }

    #[test]
    fn neighbours_of_one_darkness_are_one_run() {
        let row = (0..30).map(|i| (f64::from(i), 0.0));
        assert!(cells(row).concat().matches('M').count() == 1);
    }
}
