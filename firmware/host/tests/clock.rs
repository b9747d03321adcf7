//! At clock pace a station wakes when it is due, however busy its bus is.

mod probe;

use std::time::Duration;

use probe::{Running, ids};
use protocol::Message;
use protocol::message::NmtCommand;
use quadrant_host::Pace;

/// What a busy machine may add.
const LATE: Duration = Duration::from_millis(80);

#[test]
fn alarms_ring_by_the_clock_on_a_quiet_bus_and_under_a_flood_of_frames() {
    let running = Running::start(vec![50_000, 100_000, 400_000, 500_000], None, Pace::Clock);
    for due_ms in [50, 100] {
        on_time(due_ms, running.rang(Duration::from_secs(2)));
    }
    for due_ms in [400, 500] {
        let flood = Message::Nmt(NmtCommand::StartRemoteNode, None).encode(ids());
        let rang = std::iter::from_fn(|| {
            // A full socket is part of a flood.
            let _ = running.port.send(&flood);
            Some(running.rang(Duration::from_micros(300)))
        });
        on_time(due_ms, rang.take(20_000).flatten().next());
    }
    running.stop();
}

fn on_time(due_ms: u64, rang: Option<Duration>) {
    let (due, rang) = (Duration::from_millis(due_ms), rang.expect("it rings"));
    assert!(
        (due..due + LATE).contains(&rang),
        "due {due:?}, rang {rang:?}"
    );
}
