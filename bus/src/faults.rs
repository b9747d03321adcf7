//! Faults on the bus, injected in the receiving port. They are silent: a frame comes or it does
//! not.
//!
//! What happens to a frame is a hash of seed, identifier, cycle and receiver, never the order of
//! random calls: the same run has the same faults however its processes are scheduled. The cycle is
//! counted by the SYNC frames that reach the port, before the port loses any of them. Only cyclic
//! frames are touched; NMT, SDO and EMCY pass.
//!
//! *Lost*: nothing. *Doubled*: the frame twice. *Late*: the frame after the next SYNC. *Corrupted*
//! is what gets past CAN's CRC in practice: a wrong length, a remote frame, an extended identifier,
//! a stale counter, an implausible jump. Small flips of the payload cannot be detected by anybody.
//! Their effect is bounded by the limits of the drive instead, and [`Damage::Setpoint`] measures
//! it.

use embedded_can::{ExtendedId, Frame, Id};
use protocol::cob::{AxisIds, FrameKind};
use protocol::table::{FRAMES, Rate};
use protocol::weight::SetpointFine;
use protocol::{CanFrame, Message, message};

/// How many frames in a thousand suffer each fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultPlan {
    /// Seed of all decisions.
    pub seed: u64,
    /// Frames lost.
    pub lost_per_mille: u16,
    /// Frames doubled.
    pub doubled_per_mille: u16,
    /// Frames one cycle late.
    pub late_per_mille: u16,
    /// Frames corrupted.
    pub corrupted_per_mille: u16,
    /// One kind of frame that never arrives from a cycle on: a cut wire in the payload's path.
    pub cut: Option<(FrameKind, u32)>,
    /// One kind of frame that is damaged in one cycle, and never again. Cycle 1 begins with the
    /// first SYNC that reaches the port.
    pub once: Option<(FrameKind, u32, Damage)>,
    /// The first cycle in which the shares above count.
    pub from_cycle: u32,
}

/// What can happen to a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// It does not come.
    Lost,
    /// It comes twice.
    Doubled,
    /// It comes after the next SYNC.
    Late,
    /// It comes as something else that CAN's CRC lets pass.
    Corrupted(Corruption),
    /// A setpoint that is wrong by so many fine counts (2⁻⁸ of 10 nm), which no receiver can tell
    /// from a right one; other frames come as they are.
    Setpoint(i64),
}

/// What a corrupted frame comes as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corruption {
    /// Half its bytes.
    WrongLength,
    /// A remote frame.
    Remote,
    /// A frame with an extended identifier that begins with its own: other people's traffic.
    Extended,
    /// A counter so many cycles old.
    Stale(u8),
    /// A position that the axis cannot have reached: one high bit is wrong.
    Jump,
}

/// A receiving port with faults.
#[derive(Clone, Debug)]
pub struct FaultyPort {
    plan: FaultPlan,
    ids: AxisIds,
    receiver: u8,
    cycle: u32,
    late: Vec<CanFrame>,
    /// Faults so far.
    pub injected: u32,
}

impl FaultyPort {
    /// A port of a receiver; `receiver` is its node id, or 0 for the workbench.
    #[must_use]
    pub const fn new(plan: FaultPlan, ids: AxisIds, receiver: u8) -> Self {
        Self {
            plan,
            ids,
            receiver,
            cycle: 0,
            late: Vec::new(),
            injected: 0,
        }
    }

    /// What the node gets when a frame arrives at its port.
    pub fn receive(&mut self, frame: CanFrame, out: &mut Vec<CanFrame>) {
        let Some(kind) = self.cyclic_kind(&frame) else {
            out.push(frame);
            return;
        };
        let mut late = Vec::new();
        if kind == FrameKind::Sync {
            self.cycle += 1;
            late = std::mem::take(&mut self.late);
        }
        match self.damage(kind, &frame) {
            None => out.push(frame),
            Some(damage) => self.inflict(damage, kind, frame, out),
        }
        out.append(&mut late);
    }

    fn inflict(
        &mut self,
        damage: Damage,
        kind: FrameKind,
        frame: CanFrame,
        out: &mut Vec<CanFrame>,
    ) {
        self.injected += 1;
        match damage {
            Damage::Lost => {}
            Damage::Doubled => out.extend([frame; 2]),
            Damage::Late => self.late.push(frame),
            Damage::Corrupted(how) => out.push(corrupted(&frame, kind, how)),
            Damage::Setpoint(by) => out.push(self.misplaced(&frame, by)),
        }
    }

    fn cyclic_kind(&self, frame: &CanFrame) -> Option<FrameKind> {
        let Id::Standard(id) = frame.id() else {
            return None;
        };
        let kind = self.ids.classify(id)?;
        FRAMES
            .iter()
            .any(|spec| spec.kind == kind && matches!(spec.rate, Rate::EveryCycles(_)))
            .then_some(kind)
    }

    fn damage(&mut self, kind: FrameKind, frame: &CanFrame) -> Option<Damage> {
        if self
            .plan
            .cut
            .is_some_and(|(cut, from)| cut == kind && self.cycle >= from)
        {
            return Some(Damage::Lost);
        }
        if let Some((_, _, damage)) = self
            .plan
            .once
            .take_if(|(once, cycle, _)| *once == kind && *cycle == self.cycle)
        {
            return Some(damage);
        }
        if self.cycle < self.plan.from_cycle {
            return None;
        }
        let Id::Standard(id) = frame.id() else {
            return None;
        };
        let place =
            u64::from(id.as_raw()) << 40 | u64::from(self.cycle) << 8 | u64::from(self.receiver);
        self.plan.drawn(kind, mix(self.plan.seed ^ mix(place)))
    }

    /// The setpoint, wrong by so many fine counts.
    fn misplaced(&self, frame: &CanFrame, by: i64) -> CanFrame {
        match message::decode_as(FrameKind::Setpoint, frame) {
            Ok(Message::Setpoint(mut setpoint)) => {
                setpoint.position =
                    SetpointFine::saturating(setpoint.position.counts().saturating_add(by));
                Message::Setpoint(setpoint).encode(self.ids)
            }
            _ => *frame,
        }
    }
}

impl FaultPlan {
    /// What a hash says about a frame of a kind: its low digits whether and what, its high half
    /// how.
    fn drawn(&self, kind: FrameKind, hash: u64) -> Option<Damage> {
        let (mut left, how) = (hash % 1000, hash >> 32);
        let damages = [
            (self.lost_per_mille, Damage::Lost),
            (self.doubled_per_mille, Damage::Doubled),
            (self.late_per_mille, Damage::Late),
            (
                self.corrupted_per_mille,
                Damage::Corrupted(corruption(kind, how)),
            ),
        ];
        for (share, damage) in damages {
            match left.checked_sub(u64::from(share)) {
                None => return Some(damage),
                Some(rest) => left = rest,
            }
        }
        None
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): one round of mixing.
const fn mix(value: u64) -> u64 {
    let z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// One of the corruptions that a kind of frame can suffer.
fn corruption(kind: FrameKind, how: u64) -> Corruption {
    // Three to ten cycles: two old would pass for a late frame.
    let age = 3 + u8::try_from(how / 8 % 8).unwrap_or(0);
    let all = [
        Corruption::WrongLength,
        Corruption::Remote,
        Corruption::Extended,
        Corruption::Stale(age),
        Corruption::Jump,
    ];
    let possible: u64 = match (counter_at(kind), jump_at(kind)) {
        (None, _) => 3,
        (Some(_), None) => 4,
        (Some(_), Some(_)) => 5,
    };
    usize::try_from(how / 64 % possible)
        .ok()
        .and_then(|at| all.get(at).copied())
        .unwrap_or(Corruption::WrongLength)
}

/// The byte of the SYNC counter.
const fn counter_at(kind: FrameKind) -> Option<usize> {
    match kind {
        FrameKind::Sync => Some(0),
        FrameKind::Feedback => Some(7),
        FrameKind::Torque => Some(6),
        FrameKind::Setpoint => Some(2),
        FrameKind::Nmt
        | FrameKind::PlantStatus
        | FrameKind::Status
        | FrameKind::ServoHeartbeat
        | FrameKind::PlantHeartbeat
        | FrameKind::ServoEmergency
        | FrameKind::PlantEmergency
        | FrameKind::SdoRequest
        | FrameKind::SdoResponse => None,
    }
}

/// The highest byte of a position: of the motor encoder in a feedback, of INTEGER40 in a setpoint.
/// A torque has no value that a plant can refuse.
const fn jump_at(kind: FrameKind) -> Option<usize> {
    match kind {
        FrameKind::Feedback => Some(3),
        FrameKind::Setpoint => Some(7),
        _ => None,
    }
}

/// The frame as it comes; one that cannot suffer this has half its bytes.
fn corrupted(frame: &CanFrame, kind: FrameKind, how: Corruption) -> CanFrame {
    let made = match how {
        Corruption::WrongLength => None,
        Corruption::Remote => CanFrame::new_remote(frame.id(), frame.payload().len()),
        Corruption::Extended => extended(frame),
        Corruption::Stale(age) => {
            counter_at(kind).and_then(|at| with_byte(frame, at, |counter| aged(counter, age)))
        }
        Corruption::Jump => jump_at(kind).and_then(|at| with_byte(frame, at, |byte| byte ^ 0x40)),
    };
    made.or_else(|| CanFrame::new(frame.id(), &frame.payload()[..frame.payload().len() / 2]))
        .unwrap_or(*frame)
}

/// The same data with the identifier as the first 11 of 29 bits.
fn extended(frame: &CanFrame) -> Option<CanFrame> {
    let Id::Standard(id) = frame.id() else {
        return None;
    };
    CanFrame::new(
        ExtendedId::new(u32::from(id.as_raw()) << 18)?,
        frame.payload(),
    )
}

fn with_byte(frame: &CanFrame, at: usize, change: impl Fn(u8) -> u8) -> Option<CanFrame> {
    let mut data = frame.payload().to_vec();
    let byte = data.get_mut(at)?;
    *byte = change(*byte);
    CanFrame::new(frame.id(), &data)
}

/// A counter some cycles older, modulo 240.
fn aged(counter: u8, age: u8) -> u8 {
    u8::try_from((u16::from(counter) + 239 - u16::from(age)) % 240 + 1).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::SyncCounter;
    use protocol::message::{Decoded, Feedback, Setpoint, decode};
    use protocol::states::ControlWord;
    use protocol::weight::{LoadIncrements24, MotorIncrements};

    fn ids() -> AxisIds {
        AxisIds::of_axis(0).unwrap()
    }

    /// What a receiver gets of every SYNC, setpoint and feedback, frame by frame.
    fn received(
        plan: FaultPlan,
        receiver: u8,
        cycles: u32,
    ) -> Vec<(FrameKind, CanFrame, Vec<CanFrame>)> {
        let mut port = FaultyPort::new(plan, ids(), receiver);
        let mut counter = SyncCounter::FIRST;
        let mut all = Vec::new();
        for cycle in 0..cycles {
            for message in traffic(counter, i64::from(cycle)) {
                let (frame, mut out) = (message.encode(ids()), Vec::new());
                port.receive(frame, &mut out);
                all.push((message.kind(), frame, out));
            }
            counter = counter.next();
        }
        all
    }

    fn traffic(counter: SyncCounter, at: i64) -> [Message; 3] {
        let position = SetpointFine::saturating(256 * at);
        let setpoint = Setpoint {
            control: ControlWord::default(),
            counter: counter.next(),
            position,
        };
        let feedback = Feedback {
            motor: MotorIncrements(5),
            load: LoadIncrements24::from_counts(at),
            counter,
        };
        [
            Message::Sync(counter),
            Message::Setpoint(setpoint),
            Message::Feedback(feedback),
        ]
    }

    fn of_kind(kind: FrameKind, plan: FaultPlan) -> Vec<(CanFrame, Vec<CanFrame>)> {
        let all = received(plan, 1, 10_000).into_iter();
        all.filter(|(found, ..)| *found == kind)
            .map(|(_, sent, out)| (sent, out))
            .collect()
    }

    #[test]
    fn each_share_of_a_plan_is_what_happens_to_each_kind_of_frame() {
        let plan = FaultPlan {
            seed: 3,
            lost_per_mille: 50,
            doubled_per_mille: 30,
            ..FaultPlan::default()
        };
        for kind in [FrameKind::Sync, FrameKind::Setpoint, FrameKind::Feedback] {
            let frames = of_kind(kind, plan);
            let lost = frames.iter().filter(|(_, out)| out.is_empty()).count();
            let doubled = frames
                .iter()
                .filter(|(sent, out)| out[..] == [*sent; 2])
                .count();
            assert!(
                (430..570).contains(&lost) && (230..370).contains(&doubled),
                "{kind:?}: {lost}, {doubled}"
            );
            assert_eq!(
                frames
                    .iter()
                    .filter(|(sent, out)| out[..] == [*sent])
                    .count(),
                10_000 - lost - doubled
            );
        }
    }

    #[test]
    fn the_same_plan_damages_the_same_frames_every_time_and_others_at_another_receiver() {
        let each = FaultPlan {
            lost_per_mille: 50,
            doubled_per_mille: 50,
            ..FaultPlan::default()
        };
        let plan = FaultPlan {
            late_per_mille: 50,
            corrupted_per_mille: 50,
            ..each
        };
        assert_eq!(received(plan, 1, 2000), received(plan, 1, 2000));
        assert_ne!(received(plan, 1, 2000), received(plan, 2, 2000));
        assert_ne!(
            received(plan, 1, 2000),
            received(FaultPlan { seed: 1, ..plan }, 1, 2000)
        );
    }

    #[test]
    fn a_late_frame_comes_after_the_next_sync_and_before_what_follows_it() {
        let once = Some((FrameKind::Setpoint, 2, Damage::Late));
        let all = received(
            FaultPlan {
                once,
                ..FaultPlan::default()
            },
            1,
            3,
        );
        let (late, sync) = (all[4].1, all[6].1);
        assert_eq!(all[4], (FrameKind::Setpoint, late, vec![]));
        assert_eq!(all[6], (FrameKind::Sync, sync, vec![sync, late]));
        assert!(
            all.iter()
                .enumerate()
                .all(|(at, (_, sent, out))| at == 4 || at == 6 || out[..] == [*sent])
        );
    }

    #[test]
    fn late_frames_come_in_their_order_even_where_the_sync_is_late_itself() {
        let all = received(
            FaultPlan {
                late_per_mille: 1000,
                ..FaultPlan::default()
            },
            1,
            3,
        );
        let sent: Vec<CanFrame> = all.iter().map(|(_, sent, _)| *sent).collect();
        assert_eq!(
            all[3].2,
            sent[..3],
            "SYNC 2 brings the three frames of cycle 1 and is late itself"
        );
        assert_eq!(all[6].2, sent[3..6]);
    }

    #[test]
    fn one_frame_can_be_damaged_in_one_cycle_and_no_other() {
        for kind in [FrameKind::Sync, FrameKind::Setpoint, FrameKind::Feedback] {
            let once = Some((kind, 700, Damage::Lost));
            let all = received(
                FaultPlan {
                    once,
                    ..FaultPlan::default()
                },
                1,
                1000,
            );
            let lost: Vec<usize> = all
                .iter()
                .enumerate()
                .filter(|(_, (.., out))| out.is_empty())
                .map(|(at, _)| at)
                .collect();
            assert_eq!(lost.len(), 1, "{kind:?}");
            assert_eq!(
                (lost[0] / 3, all[lost[0]].0),
                (699, kind),
                "cycle 1 begins with the first SYNC"
            );
        }
    }

    #[test]
    fn a_setpoint_can_be_wrong_by_a_number_of_fine_counts() {
        let once = Some((FrameKind::Setpoint, 5, Damage::Setpoint(-256_000)));
        let all = received(
            FaultPlan {
                once,
                ..FaultPlan::default()
            },
            1,
            10,
        );
        let position = |frame: &CanFrame| match decode(ids(), frame) {
            Ok(Decoded::Message(Message::Setpoint(setpoint))) => setpoint.position.counts(),
            other => panic!("{other:?}"),
        };
        for (cycle, (_, sent, out)) in all
            .iter()
            .filter(|(kind, ..)| *kind == FrameKind::Setpoint)
            .enumerate()
        {
            let wanted = if cycle == 4 { -256_000 } else { 0 };
            assert_eq!(
                position(&out[0]) - position(sent),
                wanted,
                "cycle {}",
                cycle + 1
            );
        }
    }

    #[test]
    fn a_corrupted_frame_comes_in_every_way_that_its_kind_can_suffer() {
        let plan = FaultPlan {
            corrupted_per_mille: 1000,
            ..FaultPlan::default()
        };
        for (kind, ways) in [
            (FrameKind::Sync, 4),
            (FrameKind::Setpoint, 5),
            (FrameKind::Feedback, 5),
        ] {
            let mut seen = [0; 5];
            for (sent, out) in of_kind(kind, plan) {
                let [came] = out[..] else { panic!("{out:?}") };
                let way = match decode(ids(), &came) {
                    Err(error) => usize::from(error.field == "RTR"),
                    Ok(Decoded::Foreign) => 2,
                    Ok(Decoded::Message(_)) => {
                        3 + usize::from(kind != FrameKind::Sync && jumped(kind, &sent, &came))
                    }
                };
                seen[way] += 1;
            }
            let fair = 10_000 / ways;
            assert!(
                seen[..ways]
                    .iter()
                    .all(|count| (fair * 9 / 10..fair * 11 / 10).contains(count)),
                "{kind:?}: {seen:?}"
            );
        }
    }

    fn jumped(kind: FrameKind, sent: &CanFrame, came: &CanFrame) -> bool {
        let at = jump_at(kind).unwrap();
        sent.payload()[at] ^ 0x40 == came.payload()[at]
    }

    #[test]
    fn a_stale_counter_is_three_to_ten_cycles_old() {
        let plan = FaultPlan {
            corrupted_per_mille: 1000,
            ..FaultPlan::default()
        };
        let mut ages = [0; 16];
        for (sent, out) in of_kind(FrameKind::Sync, plan) {
            if let Ok(Decoded::Message(Message::Sync(came))) = decode(ids(), &out[0]) {
                let now = SyncCounter::new(sent.payload()[0]).unwrap();
                ages[usize::from(now.cycles_since(came))] += 1;
            }
        }
        assert!((3..=10).all(|age| ages[age] > 200), "{ages:?}");
        assert_eq!(ages.iter().sum::<u32>(), ages[3..=10].iter().sum());
    }

    #[test]
    fn events_pass_whatever_the_plan_says() {
        let plan = FaultPlan {
            lost_per_mille: 1000,
            ..FaultPlan::default()
        };
        let mut port = FaultyPort::new(plan, ids(), 1);
        let start = Message::Nmt(message::NmtCommand::StartRemoteNode, None).encode(ids());
        let mut out = Vec::new();
        port.receive(start, &mut out);
        assert_eq!((out, port.injected), (vec![start], 0));
    }
}
