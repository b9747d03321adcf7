//! The drive node in the loop of a board's leaf with an ideal clock: nothing is late, whatever the
//! bus does. (What a real clock makes of it, no test here knows.)

use board_timing::contract::{Contract, Due, LONGEST_SLEEP_US};
use protocol::message::{Message, NmtCommand};
use protocol::sdo::{Expedited, Request};
use protocol::{AxisIds, SyncCounter};
use servo::Servo;
use servo::objects::{COMMIT, COMMIT_KEY, Parameter, TABLE};

/// A board whose processor takes no time.
struct Board {
    servo: Servo,
    contract: Contract,
    due: Due,
    now_us: u64,
    counter: SyncCounter,
}

impl Board {
    fn new() -> Self {
        let mut board = Self {
            servo: Servo::new(AxisIds::of_axis(0).unwrap()),
            contract: Contract::default(),
            due: Due::default(),
            now_us: 0,
            counter: SyncCounter::FIRST,
        };
        let _ = board.servo.boot();
        let _ = board.servo.on_time(0);
        board
    }

    /// Time passes, without a frame.
    fn pass(&mut self, us: u64) {
        let end_us = self.now_us + us;
        while self.now_us < end_us {
            self.due.says(self.servo.wake_at_us(), self.now_us);
            if let Some(since_us) = self.due.since_us(self.now_us) {
                let _ = self.servo.on_time(self.now_us);
                let has_torque = self.servo.drive().is_energised();
                self.contract.done(since_us, self.now_us, has_torque);
                continue;
            }
            let until_us = self.due.until_us(self.now_us, LONGEST_SLEEP_US);
            self.now_us = until_us.min(end_us);
        }
    }

    fn hear(&mut self, message: Message) {
        let frame = message.encode(self.servo.ids());
        let _ = self.servo.on_frame(&frame, self.now_us);
    }

    fn cycles(&mut self, cycles: u32, period_us: u64) {
        for _ in 0..cycles {
            self.hear(Message::Sync(self.counter));
            self.counter = self.counter.next();
            self.pass(period_us);
        }
    }

    fn set_period(&mut self, period_us: i32) {
        let entry = TABLE.iter().find(|e| e.parameter == Parameter::CyclePeriod);
        let period = Expedited::i32(period_us);
        let write = Request::Download(entry.unwrap().address, period);
        self.hear(Message::SdoRequest(write));
        let commit = Request::Download(COMMIT, Expedited::u32(COMMIT_KEY));
        self.hear(Message::SdoRequest(commit));
    }
}

#[test]
fn nothing_is_late_on_an_ideal_board_whatever_the_bus_does() {
    let mut board = Board::new();
    board.pass(300_000);
    board.hear(Message::Nmt(NmtCommand::StartRemoteNode, None));
    // SYNC stops at every phase of the heartbeat, and comes again.
    for cycles in 1..230 {
        board.cycles(cycles, 1000);
        board.pass(20_000);
    }
    for period_us in [20_000, 1000, 8000, 500, 20_000, 1000] {
        board.cycles(7, 1000);
        board.set_period(period_us);
        board.pass(50_000);
    }
    board.cycles(50, 1000);
    board.hear(Message::Nmt(NmtCommand::EnterPreOperational, None));
    board.pass(500_000);
    assert!(board.now_us > 30_000_000);
    assert_eq!(
        (board.contract.missed(), board.contract.latest_us()),
        (0, 0)
    );
}
