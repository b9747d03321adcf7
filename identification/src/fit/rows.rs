//! The rows of a record that are fitted, gathered block by block, and their Gram matrices.
//!
//! A search tries hundreds of columns beside the same others. Their products with each other are
//! the same every time, so they are summed once; a column that is tried only needs those with
//! itself. Every entry of a Gram matrix is the dot product of two columns, with or without company:
//! it does not depend on what was gathered and what is tried.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::motion::dot::dot;

/// Length of a block, s.
const BLOCK_S: f64 = 1.0;
/// Samples this near to a block's end are not used, s.
const GUARD_S: f64 = 0.020;
/// Folds of the cross-validation: a short record still has one block a fold.
pub(crate) const FOLDS: usize = 10;

/// The rows of some columns and a target.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    /// `[columns, target]` at the gathered rows.
    columns: Vec<Vec<f64>>,
    /// Where the gathered rows stand in the record.
    places: Vec<usize>,
    /// The gathered rows of each block that has any.
    blocks: Vec<Range<usize>>,
    /// Gram matrices of `[columns, target]`, one per block.
    grams: Vec<DMatrix<f64>>,
    /// So many samples each gathered row stands for.
    weight: f64,
}

impl Rows {
    /// The samples of a mask, without those near the ends of a block.
    #[must_use]
    pub(crate) fn new(columns: &[&[f64]], target: &[f64], mask: &[bool], period_s: f64) -> Self {
        Self::thinned(columns, target, mask, (period_s, 1))
    }

    /// The same with one of so many samples, which stands for all of them: for columns and a target
    /// that a low-pass has left nothing between them.
    #[must_use]
    pub(crate) fn thinned(
        columns: &[&[f64]],
        target: &[f64],
        mask: &[bool],
        (period_s, every): (f64, usize),
    ) -> Self {
        let (places, blocks) = places(mask, period_s, every);
        let all: Vec<&[f64]> = columns.iter().copied().chain([target]).collect();
        let columns = gathered(&all, &places);
        let weight = every as f64;
        let gram = |block: &Range<usize>| products(&columns, &columns, block, weight);
        Self {
            grams: blocks.iter().map(gram).collect(),
            columns,
            places,
            blocks,
            weight,
        }
    }

    /// Number of columns, the target included.
    #[must_use]
    pub(crate) const fn width(&self) -> usize {
        self.columns.len()
    }

    /// Gram matrices of `[columns, target]`, one per block.
    #[must_use]
    pub(crate) fn grams(&self) -> Vec<DMatrix<f64>> {
        self.grams.clone()
    }

    /// Gram matrices of `[columns, more columns, target]`, one per block.
    #[must_use]
    pub(crate) fn grams_with(&self, more: &[Vec<f64>]) -> Vec<DMatrix<f64>> {
        let more: Vec<&[f64]> = more.iter().map(Vec::as_slice).collect();
        let more = gathered(&more, &self.places);
        let pairs = self.blocks.iter().zip(&self.grams);
        pairs
            .map(|(block, gram)| {
                let beside = products(&more, &self.columns, block, self.weight);
                let among = products(&more, &more, block, self.weight);
                inserted(gram, &beside, &among)
            })
            .collect()
    }

    /// Gram matrices of the columns and another target, one per block.
    #[must_use]
    pub(crate) fn grams_toward(&self, target: &[f64]) -> Vec<DMatrix<f64>> {
        let last = self.columns.len() - 1;
        let target = gathered(&[target], &self.places);
        let pairs = self.blocks.iter().zip(&self.grams);
        pairs
            .map(|(block, gram)| {
                let beside = products(&target, &self.columns[..last], block, self.weight);
                let own = products(&target, &target, block, self.weight);
                DMatrix::from_fn(last + 1, last + 1, |i, j| match (i == last, j == last) {
                    (false, false) => gram[(i, j)],
                    (true, true) => own[(0, 0)],
                    _ => beside[(0, i.min(j))],
                })
            })
            .collect()
    }
}

/// The rows that are fitted, of those in a row one of so many, and which are those of each block.
fn places(mask: &[bool], period_s: f64, every: usize) -> (Vec<usize>, Vec<Range<usize>>) {
    let per_block = ((BLOCK_S / period_s).round() as usize)
        .min(mask.len() / FOLDS)
        .max(1);
    let guard = ((GUARD_S / period_s).round() as usize).min(per_block / 10);
    let (mut places, mut blocks) = (Vec::new(), Vec::new());
    for (block, inside) in mask.chunks(per_block).enumerate() {
        let from = places.len();
        let within = guard..inside.len().min(per_block - guard);
        let fitted = within.step_by(every).filter(|row| inside[*row]);
        places.extend(fitted.map(|row| block * per_block + row));
        blocks.extend((places.len() > from).then_some(from..places.len()));
    }
    (places, blocks)
}

/// The values of columns at some places.
fn gathered(columns: &[&[f64]], places: &[usize]) -> Vec<Vec<f64>> {
    let at_places = |column: &&[f64]| places.iter().map(|place| column[*place]).collect();
    columns.iter().map(at_places).collect()
}

/// Dot products, over the rows of a block of such a weight, of each column of one table with each
/// of another.
fn products(
    one: &[Vec<f64>],
    other: &[Vec<f64>],
    block: &Range<usize>,
    weight: f64,
) -> DMatrix<f64> {
    DMatrix::from_fn(one.len(), other.len(), |i, j| {
        weight * dot(&one[i][block.clone()], &other[j][block.clone()])
    })
}

/// A Gram matrix with more columns before its last one, by their products with what is there and
/// with each other.
fn inserted(gram: &DMatrix<f64>, beside: &DMatrix<f64>, among: &DMatrix<f64>) -> DMatrix<f64> {
    let (last, more) = (gram.nrows() - 1, among.nrows());
    // Where a column stood before, or which of the new ones it is.
    let before = |place: usize| match place {
        _ if place < last => Ok(place),
        _ if place < last + more => Err(place - last),
        _ => Ok(last),
    };
    DMatrix::from_fn(last + 1 + more, last + 1 + more, |i, j| {
        match (before(i), before(j)) {
            (Ok(i), Ok(j)) => gram[(i, j)],
            (Err(i), Ok(j)) | (Ok(j), Err(i)) => beside[(i, j)],
            (Err(i), Err(j)) => among[(i, j)],
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_the_same_products_whether_it_was_gathered_or_is_tried() {
        let wave = |k: f64| -> Vec<f64> { (0..3000).map(|i| (k * f64::from(i)).sin()).collect() };
        let [a, b, c, target] = [0.011, 0.023, 0.7, 1.3].map(wave);
        let mask: Vec<bool> = (0..3000).map(|row| row % 7 != 0).collect();
        let all = Rows::new(&[&a, &b, &c], &target, &mask, 1.0e-3);
        let some = Rows::new(&[&a], &target, &mask, 1.0e-3);
        let astray = Rows::new(&[&a, &b, &c], &a, &mask, 1.0e-3);
        assert_eq!(astray.grams_toward(&target), all.grams());
        assert_eq!(some.grams_with(&[b, c]), all.grams());
        assert_eq!(some.grams_with(&[]), some.grams());
        // By hand: the first block without 20 rows at each end.
        let rows = (20..280).filter(|row| row % 7 != 0);
        let sum: f64 = rows.map(|row| a[row] * target[row]).sum();
        assert_eq!(all.grams().len(), 10);
        assert!((all.grams()[0][(0, 3)] - sum).abs() < 1.0e-12);
    }

    #[test]
    fn one_of_two_samples_stands_for_both_where_a_low_pass_left_nothing_between_them() {
        // 30 and 41 Hz at 1 kHz.
        let wave = |hz: f64| -> Vec<f64> {
            (0..4000)
                .map(|i| (6.283e-3 * hz * f64::from(i)).sin())
                .collect()
        };
        let (column, target, mask) = (wave(30.0), wave(41.0), vec![true; 4000]);
        let of = |every| Rows::thinned(&[&column], &target, &mask, (1.0e-3, every)).grams();
        let (all, half) = (of(1), of(2));
        assert_eq!(all.len(), half.len());
        for (all, half) in all.iter().zip(&half) {
            let apart = (all - half).norm() / all.norm();
            assert!(apart < 5.0e-3, "{apart}");
        }
    }

    #[test]
    fn a_block_without_a_fitted_row_is_no_block() {
        let (ones, mut mask) = (vec![1.0; 1000], vec![true; 1000]);
        mask[300..400].fill(false);
        let rows = Rows::new(&[&ones], &ones, &mask, 1.0e-3);
        assert_eq!(rows.grams().len(), 9);
        assert!(Rows::new(&[], &[], &[], 1.0e-3).grams().is_empty());
    }
}
