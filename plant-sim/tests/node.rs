//! The plant node at the bench: SYNC and torque in, frames out, time passing. Cycle k begins at k
//! ms.

use embedded_can::Frame;
use plant_sim::axis::Mounting;
use plant_sim::brake::BrakeParameters;
use plant_sim::mechanics::Motion;
use plant_sim::node::{TorqueDrive, Truth};
use plant_sim::{AxisParameters, Machine, PlantNode};
use proptest::prelude::*;
use protocol::message::{Decoded, Feedback, NmtCommand, NmtState, PlantStatus, Torque, decode};
use protocol::states::{BrakeState, ControlWord, DriveState};
use protocol::weight::TorqueMicroNm;
use protocol::{AxisIds, CanFrame, Fault, Message, NodeId, Station, SyncCounter};

const PERIOD_US: u64 = 1000;
/// When in its cycle the servo answers.
const ANSWER_US: u64 = 400;
const RUN: ControlWord = ControlWord::ENABLE_OPERATION;
const BRAKE: BrakeParameters = BrakeParameters {
    rated_force_n: 4000.0,
    open_s: 0.030,
    close_s: 0.040,
    rise_s: 0.0,
};

struct Bench {
    node: PlantNode,
    ids: AxisIds,
    now_us: u64,
    counter: SyncCounter,
    newton_per_micro_nm: f64,
    sent: Vec<(u64, Message)>,
}

impl Bench {
    fn new(mounting: Mounting, noise_n: f64) -> Self {
        let reference = Machine::reference().axes[0].actual.clone();
        let parameters = AxisParameters {
            force_noise_n: noise_n,
            mounting,
            ..reference
        };
        let ids = AxisIds::of_axis(0).unwrap();
        let newton_per_micro_nm = parameters.newton_per_micro_nm();
        let node = PlantNode::new(ids, parameters, 1.0e-3, 7);
        let counter = SyncCounter::new(240).unwrap();
        Self {
            node,
            ids,
            now_us: 0,
            counter,
            newton_per_micro_nm,
            sent: Vec::new(),
        }
    }

    /// In NMT operational, its power stage enabled by cycle 2.
    fn enabled(mounting: Mounting) -> Self {
        let mut bench = Self::new(mounting, 0.0);
        bench.nmt(NmtCommand::StartRemoteNode);
        for control in [ControlWord::SHUTDOWN, ControlWord::SWITCH_ON, RUN] {
            bench.cycle(0.0, control);
        }
        assert_eq!(bench.node.drive(), TorqueDrive::OperationEnabled);
        bench.sent.clear();
        bench
    }

    fn take(&mut self, frame: CanFrame) {
        let Self {
            node,
            ids,
            now_us,
            sent,
            ..
        } = self;
        node.take(&frame, *now_us, &mut |frame| {
            sent.push((*now_us, message(*ids, &frame)));
        });
    }

    /// Time passes; the node is called when it wants to be.
    fn pass_to(&mut self, until_us: u64) {
        while let Some(wake) = self.node.wake_at_us().filter(|wake| *wake <= until_us) {
            self.now_us = self.now_us.max(wake);
            let Self {
                node,
                ids,
                now_us,
                sent,
                ..
            } = self;
            node.time(*now_us, &mut |frame| {
                sent.push((*now_us, message(*ids, &frame)));
            });
        }
        self.now_us = until_us;
    }

    /// The next cycle's SYNC time comes, its SYNC frame perhaps not.
    fn sync_lost(&mut self) {
        self.counter = self.counter.next();
        let begin_us = (self.now_us / PERIOD_US + 1) * PERIOD_US;
        self.pass_to(begin_us);
    }

    fn sync(&mut self) {
        self.sync_unless(false);
    }

    fn sync_unless(&mut self, lost: bool) {
        self.sync_lost();
        if !lost {
            self.sync_frame(self.counter);
        }
    }

    fn sync_frame(&mut self, counter: SyncCounter) {
        self.take(Message::Sync(counter).encode(self.ids));
    }

    fn torque(&mut self, force_n: f64, control: ControlWord, counter: SyncCounter) {
        self.pass_to(self.now_us / PERIOD_US * PERIOD_US + ANSWER_US);
        let torque = TorqueMicroNm((force_n / self.newton_per_micro_nm).round() as i32);
        self.take(
            Message::Torque(Torque {
                torque,
                control,
                counter,
            })
            .encode(self.ids),
        );
    }

    fn cycle(&mut self, force_n: f64, control: ControlWord) {
        self.sync();
        self.torque(force_n, control, self.counter);
    }

    fn nmt(&mut self, command: NmtCommand) {
        self.take(Message::Nmt(command, None).encode(self.ids));
    }

    fn truth(&self) -> Truth {
        self.node.truth()
    }

    /// Times and counters of the feedback frames.
    fn feedbacks(&self) -> Vec<(u64, u8)> {
        let of = |(at, message): &(u64, Message)| match message {
            Message::Feedback(feedback) => Some((*at, feedback.counter.get())),
            _ => None,
        };
        self.sent.iter().filter_map(of).collect()
    }

    fn last_feedback(&self) -> Feedback {
        let of = |(_, message): &(u64, Message)| match message {
            Message::Feedback(feedback) => Some(*feedback),
            _ => None,
        };
        self.sent.iter().rev().find_map(of).unwrap()
    }

    fn statuses(&self) -> Vec<(u64, PlantStatus)> {
        let of = |(at, message): &(u64, Message)| match message {
            Message::PlantStatus(status) => Some((*at, *status)),
            _ => None,
        };
        self.sent.iter().filter_map(of).collect()
    }

    fn heartbeats(&self) -> Vec<(u64, NmtState)> {
        let of = |(at, message): &(u64, Message)| match message {
            Message::PlantHeartbeat(state) => Some((*at, *state)),
            _ => None,
        };
        self.sent.iter().filter_map(of).collect()
    }

    fn emergencies(&self) -> Vec<u16> {
        let of = |(_, message): &(u64, Message)| match message {
            Message::PlantEmergency(emergency) => Some(emergency.error_code),
            _ => None,
        };
        self.sent.iter().filter_map(of).collect()
    }
}

fn message(ids: AxisIds, frame: &CanFrame) -> Message {
    match decode(ids, frame) {
        Ok(Decoded::Message(message)) => message,
        other => panic!("the plant sent {frame:?}: {other:?}"),
    }
}

fn count(value: u8) -> SyncCounter {
    SyncCounter::new(value).unwrap()
}

#[test]
fn without_losses_every_cycle_is_computed_and_none_begins_by_the_timer() {
    let mut bench = Bench::enabled(Mounting::default());
    (0..1000).for_each(|_| bench.cycle(300.0, RUN));
    let counters = bench.node.counters();
    assert_eq!(
        (counters.cycles, counters.computed, counters.by_deadline),
        (1002, 1002, 0),
        "cycle 1003 is still on"
    );
    assert_eq!((counters.bridged, counters.refused), (0, 0));
    assert_eq!(bench.feedbacks().len(), 1000);
    assert!(
        bench.feedbacks().iter().all(|(at, _)| at % PERIOD_US == 0),
        "each with its SYNC"
    );
}

#[test]
fn torque_acts_from_the_next_sync_on() {
    let mut bench = Bench::enabled(Mounting::default());
    bench.cycle(500.0, RUN);
    assert_eq!(bench.node.commanded_n(), 0.0);
    bench.sync();
    assert!((bench.node.commanded_n() - 500.0).abs() < 1.0e-3);
}

#[test]
fn where_sync_is_lost_feedback_comes_by_the_timer_and_the_phase_stays() {
    let mut bench = Bench::enabled(Mounting::default());
    for lost in [false, true, true, false, false] {
        bench.sync_unless(lost);
        let counter = bench.counter;
        bench.torque(300.0, RUN, counter);
    }
    // Cycles 4 to 8; the timer is 300 µs late, the servo's torque comes at 400 µs.
    let wanted = [(4000, 4), (5300, 5), (6300, 6), (7000, 7), (8000, 8)];
    assert_eq!(bench.feedbacks(), wanted);
    assert_eq!(
        (
            bench.node.counters().by_deadline,
            bench.node.counters().computed
        ),
        (2, 7)
    );
}

#[test]
fn an_axis_moves_the_same_way_whether_its_syncs_come_or_not() {
    let run = |lost: &dyn Fn(u32) -> bool| {
        let mut bench = Bench::enabled(Mounting::default());
        for cycle in 0..200 {
            bench.sync_unless(lost(cycle));
            let counter = bench.counter;
            bench.torque(2000.0, RUN, counter);
        }
        bench.sync();
        (bench.truth(), bench.last_feedback())
    };
    assert_eq!(
        run(&|_| false),
        run(&|cycle| cycle % 7 == 3 || cycle % 50 == 4)
    );
}

#[test]
fn a_torque_frame_one_ahead_shows_that_the_next_cycle_is_on() {
    let mut bench = Bench::enabled(Mounting::default());
    bench.cycle(300.0, RUN);
    // In lock-step no time passes where SYNC is lost.
    let next = bench.counter.next();
    bench.torque(400.0, RUN, next);
    assert_eq!(
        bench
            .feedbacks()
            .iter()
            .map(|(_, counter)| *counter)
            .collect::<Vec<_>>(),
        [4, 5]
    );
    assert_eq!(
        bench.node.sync_due_us(),
        Some(6000),
        "cycle 5 counts from when its SYNC was due"
    );
    bench.sync_lost();
    bench.sync();
    assert!((bench.node.commanded_n() - 400.0).abs() < 1.0e-3);
    assert_eq!(bench.feedbacks().len(), 3);
}

#[test]
fn a_late_sync_begins_nothing_and_sets_the_phase_anew() {
    let mut bench = Bench::enabled(Mounting::default());
    bench.sync_lost();
    bench.pass_to(4450);
    let counter = bench.counter;
    bench.sync_frame(counter);
    assert_eq!(bench.feedbacks(), [(4300, 4)]);
    assert_eq!(
        bench.node.sync_due_us(),
        Some(5450),
        "450 µs are less than half a period"
    );
    bench.sync_frame(counter);
    assert_eq!(
        (bench.feedbacks().len(), bench.node.sync_due_us()),
        (1, Some(5450)),
        "a double does not"
    );
    bench.torque(300.0, RUN, counter);
    bench.sync();
    assert_eq!(
        bench.feedbacks(),
        [(4300, 4), (5000, 5)],
        "a master that is in time again is followed at once"
    );
}

#[test]
fn a_stale_torque_is_refused_and_the_last_one_is_held() {
    let mut bench = Bench::enabled(Mounting::default());
    bench.cycle(300.0, RUN);
    bench.sync();
    let stale = count(bench.counter.get() + 235);
    bench.torque(9000.0, RUN, stale);
    bench.sync();
    assert!((bench.node.commanded_n() - 300.0).abs() < 1.0e-3);
    assert_eq!(
        (bench.node.counters().refused, bench.node.bridged()),
        (1, 1)
    );
    let short = CanFrame::of(bench.ids.identifier(protocol::FrameKind::Torque), [1, 2, 3]);
    bench.take(short);
    bench.sync();
    assert_eq!(
        (bench.node.counters().refused, bench.node.bridged()),
        (2, 2)
    );
}

#[test]
fn three_torques_in_a_row_are_bridged_and_the_fourth_ends_torque_and_closes_the_brake() {
    let mut bench = Bench::enabled(Mounting {
        brake: Some(BRAKE),
        ..Mounting::default()
    });
    (0..40).for_each(|_| bench.cycle(300.0, RUN.with(ControlWord::RELEASE_BRAKE)));
    assert_eq!(bench.truth().brake, BrakeState::Open);
    let last_good_us = bench.now_us;
    for bridged in 0..=3 {
        bench.sync();
        assert_eq!(bench.node.bridged(), bridged);
        assert!((bench.node.commanded_n() - 300.0).abs() < 1.0e-3);
    }
    bench.sync();
    assert_eq!(
        (bench.node.commanded_n(), bench.node.fault()),
        (0.0, Some(Fault::TorqueMissing))
    );
    assert!(bench.now_us - last_good_us <= 5 * PERIOD_US);
    assert_eq!(
        (bench.truth().brake, bench.emergencies()),
        (BrakeState::Moving, vec![0x8250])
    );
    let (at, status) = *bench.statuses().last().unwrap();
    assert_eq!(
        (at, status.status.state(), status.fault),
        (48_000, Some(DriveState::Fault), Some(Fault::TorqueMissing))
    );
}

#[test]
fn a_vertical_axis_whose_servo_dies_drops_no_farther_than_its_brake_makes_it() {
    for (open_s, close_s, most_m) in [
        (0.0, 0.0, 1.0e-6),
        (0.008, 0.010, 0.3e-3),
        (0.030, 0.040, 4.0e-3),
    ] {
        let brake = BrakeParameters {
            open_s,
            close_s,
            ..BRAKE
        };
        let mut bench = Bench::enabled(Mounting {
            gravity_n: -2500.0,
            brake: Some(brake),
            ..Mounting::default()
        });
        (0..60).for_each(|_| bench.cycle(2500.0, RUN.with(ControlWord::RELEASE_BRAKE)));
        while bench.node.fault().is_none() {
            bench.sync();
        }
        let mut alone = bench.node.axis().clone();
        alone.command_brake(false);
        let before = bench.truth().table_m;
        bench.pass_to(bench.now_us + 300_400);
        (0..300).for_each(|_| alone.advance(0.0, 1.0e-3));
        // The timer stops once the axis is slower than 1 mm/s: its last ringing is below 1.3 µm.
        let (drop, wanted) = (
            before - bench.truth().table_m,
            before - alone.motion().table_m,
        );
        assert!(
            (drop - wanted).abs() < 1.3e-6,
            "brake of {close_s} s: {drop} m, {wanted} m with torque zero and brake at once"
        );
        assert!(
            drop < most_m && drop >= 0.3 * most_m - 1.0e-6,
            "brake of {close_s} s: {drop} m"
        );
    }
}

#[test]
fn while_sync_alone_is_gone_the_servo_may_ramp_down() {
    let mut bench = Bench::enabled(Mounting::default());
    for _ in 0..80 {
        bench.sync_lost();
        let counter = bench.counter;
        bench.torque(-3000.0, RUN, counter);
    }
    assert_eq!(
        (bench.node.drive(), bench.feedbacks().len()),
        (TorqueDrive::OperationEnabled, 80)
    );
    // The servo's ramp is over. The axis coasts; when it stands, the timer stops.
    bench.sync_lost();
    let counter = bench.counter;
    bench.torque(0.0, ControlWord::DISABLE_VOLTAGE, counter);
    bench.pass_to(10_000_000);
    assert_eq!(
        (bench.node.drive(), bench.node.fault()),
        (TorqueDrive::SwitchOnDisabled, None)
    );
    let feedbacks = bench.feedbacks().len();
    assert!(
        (100..1000).contains(&feedbacks),
        "{feedbacks} feedbacks while it coasts"
    );
    assert!(bench.truth().motor_m_per_s.abs() < 1.1e-3);
    // The master is back, with a counter of its own.
    bench.sync_frame(count(200));
    assert_eq!(bench.feedbacks().last(), Some(&(10_000_000, 200)));
}

#[test]
fn where_sync_and_torque_are_gone_torque_ends_within_five_periods_and_sync_is_named() {
    let mut bench = Bench::enabled(Mounting::default());
    bench.cycle(300.0, RUN);
    let last_us = bench.now_us;
    let mut held_us = last_us;
    while bench.node.fault().is_none() && held_us < last_us + 20 * PERIOD_US {
        held_us += 100;
        bench.pass_to(held_us);
    }
    assert_eq!(bench.node.fault(), Some(Fault::SyncMissing));
    assert_eq!(
        (held_us, bench.node.sync_due_us()),
        (9300, Some(10_000)),
        "noticed by the timer, as of 9 ms"
    );
    assert_eq!(bench.emergencies(), [0x8700]);
}

#[test]
fn nmt_stop_waits_until_the_servo_has_let_go() {
    let commands = [
        NmtCommand::StopRemoteNode,
        NmtCommand::EnterPreOperational,
        NmtCommand::ResetNode,
    ];
    for (command, after) in commands.into_iter().zip([
        NmtState::Stopped,
        NmtState::PreOperational,
        NmtState::PreOperational,
    ]) {
        let mut bench = Bench::enabled(Mounting::default());
        bench.cycle(300.0, RUN);
        bench.nmt(command);
        for _ in 0..50 {
            bench.cycle(300.0, RUN);
            assert!((bench.node.commanded_n() - 300.0).abs() < 1.0e-3);
        }
        bench.cycle(0.0, ControlWord::DISABLE_VOLTAGE);
        assert_eq!(
            (bench.node.nmt(), bench.node.drive()),
            (after, TorqueDrive::SwitchOnDisabled),
            "{command:?}"
        );
        let feedbacks = bench.feedbacks().len();
        bench.cycle(300.0, RUN);
        assert_eq!(
            bench.feedbacks().len(),
            feedbacks,
            "no process data any more"
        );
    }
}

#[test]
fn a_start_takes_a_waiting_stop_back_and_another_node_is_not_meant() {
    let mut bench = Bench::enabled(Mounting::default());
    bench.nmt(NmtCommand::StopRemoteNode);
    bench.nmt(NmtCommand::StartRemoteNode);
    bench.cycle(0.0, ControlWord::SHUTDOWN);
    assert_eq!(bench.node.nmt(), NmtState::Operational);
    bench.take(Message::Nmt(NmtCommand::StopRemoteNode, NodeId::new(0x12)).encode(bench.ids));
    assert_eq!(bench.node.nmt(), NmtState::Operational);
}

#[test]
fn a_reset_in_motion_resets_the_node_and_not_the_machine() {
    let mut bench = Bench::enabled(Mounting {
        brake: Some(BRAKE),
        ..Mounting::default()
    });
    (0..40).for_each(|_| bench.cycle(0.0, RUN.with(ControlWord::RELEASE_BRAKE)));
    let m_per_s = 0.4;
    bench.node.place(Motion {
        motor_m: 0.1,
        table_m: 0.1,
        motor_m_per_s: m_per_s,
        table_m_per_s: m_per_s,
    });
    bench.nmt(NmtCommand::ResetNode);
    bench.cycle(0.0, RUN.with(ControlWord::RELEASE_BRAKE));
    assert_eq!(
        bench.node.nmt(),
        NmtState::Operational,
        "as long as torque acts"
    );
    bench.cycle(0.0, ControlWord::DISABLE_VOLTAGE);
    assert_eq!(
        (bench.node.nmt(), bench.truth().brake),
        (NmtState::PreOperational, BrakeState::Moving)
    );
    // 40 ms until the brake bites, and ½·m·v² over brake and friction; nobody sends SYNC.
    bench.pass_to(bench.now_us + 300_000);
    let way = bench.truth().table_m - 0.1;
    assert!((0.025..0.040).contains(&way), "{way} m");
    assert_eq!(
        (bench.truth().motor_m_per_s, bench.truth().brake),
        (0.0, BrakeState::Closed)
    );
    bench.nmt(NmtCommand::StartRemoteNode);
    bench.sync();
    let increments = f64::from(bench.last_feedback().motor.0);
    assert!(
        (increments / 1_048_576.0 * 0.010 - bench.truth().motor_m).abs() < 1.0e-8,
        "encoders went on"
    );
}

#[test]
fn a_reset_that_waited_for_the_servo_leaves_the_axis_where_it_stopped() {
    let mut bench = Bench::enabled(Mounting {
        load_zero_m: 0.02,
        ..Mounting::default()
    });
    bench.node.place(Motion {
        motor_m: 0.1,
        table_m: 0.1,
        ..Motion::default()
    });
    bench.nmt(NmtCommand::ResetNode);
    bench.cycle(0.0, ControlWord::SHUTDOWN);
    assert_eq!(
        (bench.node.nmt(), bench.truth().table_m),
        (NmtState::PreOperational, 0.1)
    );
    bench.nmt(NmtCommand::ResetNode);
    assert_eq!(
        bench.truth().table_m,
        0.0,
        "the next one finds it standing without torque and starts over"
    );
}

#[test]
fn a_run_that_begins_with_a_reset_at_rest_is_the_same_run_every_time() {
    let mut bench = Bench::new(Mounting::default(), 4.5);
    let mut run = |pause_us: u64| {
        bench.pass_to(bench.now_us + pause_us);
        bench.nmt(NmtCommand::ResetCommunication);
        bench.nmt(NmtCommand::StartRemoteNode);
        bench.sent.clear();
        for control in [ControlWord::SHUTDOWN, ControlWord::SWITCH_ON] {
            bench.cycle(0.0, control);
        }
        (0..150).for_each(|cycle| bench.cycle(600.0 * (f64::from(cycle) / 20.0).sin(), RUN));
        bench.sync();
        bench.torque(0.0, ControlWord::DISABLE_VOLTAGE, bench.counter);
        (0..300).for_each(|_| bench.cycle(0.0, ControlWord::DISABLE_VOLTAGE));
        bench.counter = count(240);
        bench
            .sent
            .iter()
            .map(|(_, message)| *message)
            .collect::<Vec<_>>()
    };
    let first = run(0);
    assert_eq!(
        first.len(),
        453 + 46 + 5 + 4,
        "feedback, status, heartbeats, changes of state"
    );
    for pause_us in [1_000_000, 123_456] {
        assert!(run(pause_us) == first, "after a pause of {pause_us} µs");
    }
}

#[test]
fn the_brake_opens_only_with_torque_and_closes_with_it() {
    let mut bench = Bench::enabled(Mounting {
        brake: Some(BRAKE),
        gravity_n: -2500.0,
        ..Mounting::default()
    });
    let start = bench.truth().table_m;
    (0..30).for_each(|_| bench.cycle(2500.0, RUN));
    assert_eq!(
        bench.truth().brake,
        BrakeState::Closed,
        "nobody released it"
    );
    bench.cycle(2500.0, RUN.with(ControlWord::RELEASE_BRAKE));
    let told_us = bench.now_us;
    (0..60).for_each(|_| bench.cycle(2500.0, RUN.with(ControlWord::RELEASE_BRAKE)));
    let open = *bench
        .statuses()
        .iter()
        .find(|(_, status)| status.brake == BrakeState::Open)
        .unwrap();
    assert!(
        (29 * PERIOD_US..=31 * PERIOD_US).contains(&(open.0 - told_us)),
        "open after {} µs",
        open.0 - told_us
    );
    assert!(
        (bench.truth().table_m - start).abs() < 2.0e-6,
        "the motor carries it"
    );
    bench.cycle(2500.0, RUN);
    (0..45).for_each(|_| bench.cycle(2500.0, RUN));
    assert_eq!(
        bench.truth().brake,
        BrakeState::Closed,
        "told by the bit alone, while torque holds"
    );
    bench.cycle(0.0, ControlWord::SHUTDOWN);
    (0..45).for_each(|_| bench.cycle(0.0, ControlWord::SHUTDOWN));
    assert!(
        (bench.truth().table_m - start).abs() < 2.0e-6,
        "{}",
        bench.truth().table_m - start
    );
}

#[test]
fn the_plant_status_comes_on_change_and_every_tenth_cycle() {
    let mut bench = Bench::new(Mounting::default(), 0.0);
    bench.nmt(NmtCommand::StartRemoteNode);
    for control in [ControlWord::SHUTDOWN, RUN] {
        bench.cycle(0.0, control);
    }
    (0..40).for_each(|_| bench.cycle(0.0, RUN));
    let told: Vec<_> = bench
        .statuses()
        .iter()
        .map(|(at, status)| (*at, status.status.state().unwrap()))
        .collect();
    let wanted = [
        (0, DriveState::SwitchOnDisabled),
        (1000, DriveState::SwitchOnDisabled),
        (1400, DriveState::ReadyToSwitchOn),
        (2400, DriveState::OperationEnabled),
        (11_000, DriveState::OperationEnabled),
        (21_000, DriveState::OperationEnabled),
        (31_000, DriveState::OperationEnabled),
        (41_000, DriveState::OperationEnabled),
    ];
    assert_eq!(told, wanted);
    assert!(
        bench
            .statuses()
            .iter()
            .all(|(_, status)| status.brake == BrakeState::NotFitted)
    );
}

#[test]
fn a_power_stage_that_refuses_stays_switched_on_and_gives_no_torque() {
    let mut bench = Bench::new(Mounting::default(), 0.0);
    bench.node.refuse_enable(true);
    bench.nmt(NmtCommand::StartRemoteNode);
    bench.cycle(0.0, ControlWord::SHUTDOWN);
    for _ in 0..10 {
        bench.cycle(3000.0, RUN);
        assert_eq!(
            (bench.node.commanded_n(), bench.node.drive()),
            (0.0, TorqueDrive::SwitchedOn)
        );
    }
    bench.node.refuse_enable(false);
    bench.cycle(3000.0, RUN);
    assert_eq!(bench.node.drive(), TorqueDrive::OperationEnabled);
}

#[test]
fn a_power_stage_that_drops_out_says_so_within_a_cycle_and_needs_a_reset() {
    let mut bench = Bench::enabled(Mounting::default());
    (0..3).for_each(|_| bench.cycle(3000.0, RUN));
    bench.node.drop_out();
    assert_eq!(bench.node.commanded_n(), 0.0);
    bench.cycle(3000.0, RUN);
    assert_eq!(
        (bench.node.fault(), bench.emergencies()),
        (Some(Fault::StageLost), vec![0x5410])
    );
    assert_eq!(
        bench.statuses().last().unwrap().1.status.state(),
        Some(DriveState::Fault)
    );
    bench.node.restore_supply();
    bench.cycle(3000.0, RUN);
    assert_eq!(
        (bench.node.fault(), bench.node.commanded_n()),
        (Some(Fault::StageLost), 0.0)
    );
    bench.cycle(0.0, ControlWord::FAULT_RESET);
    assert_eq!(
        (bench.node.drive(), bench.emergencies()),
        (TorqueDrive::SwitchOnDisabled, vec![0x5410, 0])
    );
}

#[test]
fn heartbeats_come_in_every_nmt_state() {
    let mut bench = Bench::new(Mounting::default(), 0.0);
    bench.pass_to(250_000);
    bench.nmt(NmtCommand::StopRemoteNode);
    bench.pass_to(350_000);
    bench.nmt(NmtCommand::StartRemoteNode);
    bench.pass_to(550_000);
    let states = [
        (0, NmtState::PreOperational),
        (100_000, NmtState::PreOperational),
        (200_000, NmtState::PreOperational),
    ];
    assert_eq!(bench.heartbeats()[..3], states);
    let later = [
        (300_000, NmtState::Stopped),
        (400_000, NmtState::Operational),
        (500_000, NmtState::Operational),
    ];
    assert_eq!(bench.heartbeats()[3..], later);
}

#[test]
fn computed_bridged_and_refused_are_all_cycles_whatever_the_bus_does() {
    let mut bench = Bench::enabled(Mounting::default());
    // A linear congruential generator (Knuth, MMIX) is random enough to lose frames.
    let mut state = 1_u64;
    let mut chance = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        state >> 58
    };
    let cycles = 20_000;
    for _ in 0..cycles {
        let (sync, torque) = (chance(), chance());
        bench.sync_unless(sync < 4);
        let counter = bench.counter;
        match torque {
            0..4 => {}
            4..6 => bench.torque(
                300.0,
                RUN,
                count(u8::try_from((u16::from(counter.get()) + 230) % 240 + 1).unwrap()),
            ),
            6..8 => (0..2).for_each(|_| bench.torque(300.0, RUN, counter)),
            _ => bench.torque(300.0, RUN, counter),
        }
        if bench.node.fault().is_some() {
            bench.torque(0.0, ControlWord::SHUTDOWN, counter);
        }
    }
    bench.sync();
    let counters = bench.node.counters();
    assert_eq!(
        counters.computed + counters.bridged + counters.refused,
        counters.cycles
    );
    assert_eq!(counters.cycles, cycles + 3, "{counters:?}");
    for share in [counters.bridged, counters.refused, counters.by_deadline] {
        assert!((400..2000).contains(&share), "{counters:?}");
    }
}

#[test]
fn the_feedback_wraps_at_32_bits_and_goes_on() {
    let mut bench = Bench::enabled(Mounting::default());
    let m_per_s = 0.4;
    bench.node.place(Motion {
        motor_m: 20.479,
        table_m: 20.479,
        motor_m_per_s: m_per_s,
        table_m_per_s: m_per_s,
    });
    let (mut before, mut way) = (None, 0_i64);
    for _ in 0..20 {
        bench.cycle(1200.0, RUN);
        let now = bench.last_feedback().motor.0;
        way += i64::from(now.wrapping_sub(before.replace(now).unwrap_or(now)));
    }
    let wraps = bench.sent.windows(2).count() > 0 && before.unwrap() < 0;
    assert!(wraps, "2048 revolutions of 2^20 increments are 2^31");
    assert!(
        (way as f64 / 1_048_576.0 * 0.010 - 19.0 * 0.4e-3).abs() < 2.0e-4,
        "{way} increments"
    );
}

/// What a bad bus and a bad master may do in a cycle.
#[derive(Clone, Copy, Debug)]
enum Event {
    Sync {
        lost: bool,
    },
    Stray(u8),
    Torque {
        force_n: f64,
        control: u16,
        behind: u8,
    },
    Nmt(NmtCommand),
    Pause {
        us: u64,
    },
    DropOut,
    Restore,
}

fn event() -> impl Strategy<Value = Event> {
    let control = prop_oneof![
        Just(0_u16),
        Just(2),
        Just(6),
        Just(7),
        Just(15),
        Just(0x80),
        Just(0x80F),
        Just(0x80F),
        0..=u16::MAX
    ];
    let behind = prop_oneof![8 => Just(0_u8), 1 => 0..240_u8];
    let nmt = prop_oneof![
        6 => Just(NmtCommand::StartRemoteNode),
        1 => Just(NmtCommand::StopRemoteNode),
        1 => Just(NmtCommand::EnterPreOperational),
        1 => Just(NmtCommand::ResetNode),
    ];
    prop_oneof![
        30 => prop::bool::weighted(0.1).prop_map(|lost| Event::Sync { lost }),
        1 => (1..=240_u8).prop_map(Event::Stray),
        30 => (-9000.0..9000.0, control, behind)
            .prop_map(|(force_n, control, behind)| Event::Torque { force_n, control, behind }),
        3 => nmt.prop_map(Event::Nmt),
        1 => (0..20_000_u64).prop_map(|us| Event::Pause { us }),
        1 => Just(Event::DropOut),
        2 => Just(Event::Restore),
    ]
}

fn happen(bench: &mut Bench, event: Event) {
    match event {
        Event::Sync { lost } => bench.sync_unless(lost),
        Event::Stray(counter) => bench.sync_frame(count(counter)),
        Event::Torque {
            force_n,
            control,
            behind,
        } => {
            let counter =
                u8::try_from((u16::from(bench.counter.get()) + 239 - u16::from(behind)) % 240 + 1)
                    .unwrap();
            bench.torque(force_n, ControlWord(control), count(counter));
        }
        Event::Nmt(command) => bench.nmt(command),
        Event::Pause { us } => bench.pass_to(bench.now_us + us),
        Event::DropOut => bench.node.drop_out(),
        Event::Restore => bench.node.restore_supply(),
    }
}

proptest! {
    #[test]
    fn no_sequence_of_frames_commands_and_pauses_leaves_torque_or_an_open_brake_without_an_enabled_stage(
        events in prop::collection::vec(event(), 1..400)
    ) {
        let brake = BrakeParameters { open_s: 0.0, close_s: 0.0, ..BRAKE };
        let mut bench = Bench::new(Mounting { brake: Some(brake), ..Mounting::default() }, 4.5);
        bench.nmt(NmtCommand::StartRemoteNode);
        for event in events {
            happen(&mut bench, event);
            let enabled =
                bench.node.drive() == TorqueDrive::OperationEnabled && bench.node.nmt() == NmtState::Operational;
            prop_assert!(enabled || bench.node.commanded_n() == 0.0, "{event:?}: torque in {:?}", bench.node.drive());
            prop_assert!(enabled || bench.truth().brake == BrakeState::Closed, "{event:?}: {:?}", bench.truth().brake);
            prop_assert!(bench.node.bridged() <= 3);
            let counters = bench.node.counters();
            prop_assert_eq!(counters.computed + counters.bridged + counters.refused, counters.cycles);
        }
    }
}

#[test]
fn frames_of_others_and_broken_syncs_change_nothing() {
    let mut bench = Bench::enabled(Mounting::default());
    let sync = bench.ids.identifier(protocol::FrameKind::Sync);
    let extended = embedded_can::ExtendedId::new(0x80).unwrap();
    for frame in [
        CanFrame::of(sync, [1, 2, 3]),
        CanFrame::of(sync, [0]),
        CanFrame::new_remote(sync, 1).unwrap(),
        CanFrame::of(extended, [4]),
        CanFrame::of(bench.ids.identifier(protocol::FrameKind::Setpoint), [0; 3]),
    ] {
        bench.take(frame);
    }
    assert!(bench.sent.is_empty());
    assert_eq!(bench.node.sync_due_us(), Some(4000));
}
