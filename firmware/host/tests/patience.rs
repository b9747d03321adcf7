//! Lock-step waits longer for a SYNC than for a frame of the present cycle. A file of its own: a
//! process has one executor.

mod probe;

use std::time::Duration;

use probe::Running;
use quadrant_host::Pace;

const DEADLINE: Duration = Duration::from_millis(100);

#[test]
fn what_is_due_after_the_next_sync_has_two_deadlines_to_wait() {
    // The deadline of a cycle, then the own timer: SYNC was due between them.
    let running = Running::start(
        vec![600, 1300],
        Some(1000),
        Pace::Lockstep { deadline: DEADLINE },
    );
    let cycle = running
        .rang(4 * DEADLINE)
        .expect("the deadline of the cycle");
    let timer = running.rang(4 * DEADLINE).expect("the own timer");
    assert!(
        cycle >= DEADLINE * 9 / 10 && timer >= cycle + 2 * DEADLINE * 9 / 10,
        "{cycle:?}, {timer:?}"
    );
    running.stop();
}
