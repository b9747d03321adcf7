//! In lock-step the clock only tells that a partner is gone.

mod probe;

use std::time::Duration;

use probe::{Running, ids};
use protocol::message::NmtCommand;
use protocol::{CanFrame, Message};
use quadrant_host::Pace;

const DEADLINE: Duration = Duration::from_millis(200);
const HOUR_US: u64 = 3_600_000_000;

fn a_frame() -> CanFrame {
    Message::Nmt(NmtCommand::StartRemoteNode, None).encode(ids())
}

#[test]
fn what_is_due_happens_after_a_deadline_without_frames_three_times_and_then_by_the_clock() {
    // An hour apart in bus time: by the clock none of them would ring within this test.
    let alarms = (1..=6).map(|alarm| alarm * HOUR_US).collect();
    let running = Running::start(alarms, None, Pace::Lockstep { deadline: DEADLINE });

    // Frames, however late each, keep the deadline away.
    while running.elapsed() < 5 * DEADLINE {
        running.port.send(&a_frame()).unwrap();
        assert_eq!(
            running.rang(DEADLINE / 20),
            None,
            "a frame came within the deadline"
        );
    }
    let quiet_since = running.elapsed();
    for deadlines in 1..=3 {
        let rang = running
            .rang(4 * DEADLINE)
            .expect("a deadline without frames");
        let earliest = quiet_since + deadlines * DEADLINE * 9 / 10;
        assert!(
            rang >= earliest,
            "{deadlines}: {rang:?}, at least {earliest:?}"
        );
    }
    assert_eq!(
        running.rang(4 * DEADLINE),
        None,
        "alone, time follows the clock"
    );

    running.port.send(&a_frame()).unwrap();
    assert!(
        running.rang(4 * DEADLINE).is_some(),
        "a frame brings lock-step back, and its deadline"
    );
    running.stop();
}
