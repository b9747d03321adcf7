//! A table over all cores: each row runs once, the results come in the order of the rows.
//!
//! Rows differ in length (a record with a gap takes five times as long as an empty one), so every
//! thread takes the next row when it is done with one.

use std::num::NonZero;
use std::sync::Mutex;
use std::thread;

/// Runs a function over the rows on all cores that this process may use; the results in the order
/// of the rows.
///
/// # Panics
/// When the function panics on a row: the other rows are run first, then the panic goes on.
pub fn on_all_cores<A: Sync, B: Send>(rows: &[A], run: impl Fn(&A) -> B + Sync) -> Vec<B> {
    let threads = thread::available_parallelism()
        .map_or(1, NonZero::get)
        .min(rows.len());
    let next = Mutex::new(rows.iter().enumerate());
    let take_next = || next.lock().expect("taking a row does not panic").next();
    let work = || {
        std::iter::from_fn(take_next)
            .map(|(place, row)| (place, run(row)))
            .collect::<Vec<_>>()
    };
    let mut done: Vec<(usize, B)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| {
                worker
                    .join()
                    .unwrap_or_else(|why| std::panic::resume_unwind(why))
            })
            .collect()
    });
    done.sort_unstable_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_runs_once_and_the_order_stays() {
        let rows: Vec<u64> = (0..1000).collect();
        assert_eq!(
            on_all_cores(&rows, |row| row * 3),
            rows.iter().map(|row| row * 3).collect::<Vec<_>>()
        );
        assert_eq!(on_all_cores(&[] as &[u64], |row| *row), []);
    }

    #[test]
    #[should_panic(expected = "row 7")]
    fn a_panic_on_one_row_fails_the_test() {
        on_all_cores(&(0..20).collect::<Vec<u32>>(), |row| {
            assert!(*row != 7, "row {row}");
        });
    }
}
