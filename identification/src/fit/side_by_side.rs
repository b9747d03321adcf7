//! Independent work on all cores, with results in the order of the items: no number depends on how
//! many cores there are.
//!
//! Plain scoped threads that take the next item from a counter. An item is a fit or a simulation
//! (milliseconds), a thread costs some ten microseconds. Work within such work stays on its thread:
//! there are never more threads than cores.

use std::cell::Cell;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

thread_local! {
    /// Whether this thread does an item of such work already.
    static BUSY: Cell<bool> = const { Cell::new(false) };
}

/// What `work` makes of each item, in order.
pub(crate) fn side_by_side<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    on_threads(cores.min(items.len()), items, work)
}

fn on_threads<T: Sync, R: Send>(
    threads: usize,
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    if threads < 2 || BUSY.get() {
        return items.iter().map(work).collect();
    }
    let next = AtomicUsize::new(0);
    let some = || share(items, &next, &work);
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(some)).collect();
        let mut done = some();
        for other in others {
            done.extend(
                other
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            );
        }
        done
    });
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

/// The items that one thread comes to do, with their places.
fn share<T, R>(items: &[T], next: &AtomicUsize, work: impl Fn(&T) -> R) -> Vec<(usize, R)> {
    BUSY.set(true);
    let mut done = Vec::new();
    loop {
        let place = next.fetch_add(1, Ordering::Relaxed);
        let Some(item) = items.get(place) else {
            BUSY.set(false);
            return done;
        };
        done.push((place, work(item)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::sync::Mutex;
    use std::time::Duration;

    #[test]
    fn results_stand_in_the_order_of_their_items() {
        let items: Vec<u64> = (0..40).collect();
        let squares = on_threads(4, &items, |item| {
            // Early items take longer.
            thread::sleep(Duration::from_micros(40 * (40 - item)));
            item * item
        });
        assert_eq!(
            squares,
            items.iter().map(|item| item * item).collect::<Vec<_>>()
        );
    }

    #[test]
    fn there_are_never_more_threads_than_asked_for() {
        let seen = Mutex::new(HashSet::new());
        on_threads(3, &[(); 6], |()| {
            on_threads(3, &[(); 4], |()| {
                seen.lock().unwrap().insert(thread::current().id());
                thread::sleep(Duration::from_millis(1));
            })
        });
        assert!((2..=3).contains(&seen.lock().unwrap().len()));
    }

    #[test]
    fn a_panic_is_heard() {
        let outcome = std::panic::catch_unwind(|| {
            on_threads(2, &[1, 2, 3], |item| assert!(*item < 3));
        });
        assert!(outcome.is_err());
    }
}
