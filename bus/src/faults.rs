//! Faults on the bus, injected in the receiving port.
//!
//! The decision about a frame is a hash of seed, identifier, cycle and receiver, never the order of random calls: the same run has the same
//! faults however its processes are scheduled. Only cyclic frames are touched; NMT, SDO and EMCY pass.
//!
//! *Lost*: a token instead of the frame. *Doubled*: the frame twice. *Late*: a token now, the frame after the next SYNC. *Corrupted* is what
//! gets past CAN's CRC in practice: a wrong length, a remote frame, a stale counter, an implausible jump. Small flips of the payload
//! cannot be detected by anybody; their effect is bounded by the limits of the drive instead.

use embedded_can::{Frame, Id};
use protocol::CanFrame;
use protocol::cob::{AxisIds, FrameKind};
use protocol::table::{FRAMES, Rate};

use crate::station::Received;

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
    /// The first cycle in which anything happens.
    pub from_cycle: u32,
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

#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Delivered,
    Lost,
    Doubled,
    Late,
    Corrupted(u8),
}

impl FaultyPort {
    /// A port of a receiver; `receiver` is its node id, or 0 for the workbench.
    #[must_use]
    pub const fn new(plan: FaultPlan, ids: AxisIds, receiver: u8) -> Self {
        Self { plan, ids, receiver, cycle: 0, late: Vec::new(), injected: 0 }
    }

    /// What the node gets when a frame arrives at its port.
    pub fn receive(&mut self, frame: CanFrame, out: &mut Vec<Received>) {
        let Some(kind) = self.cyclic_kind(&frame) else {
            out.push(Received::Frame(frame));
            return;
        };
        if kind == FrameKind::Sync {
            self.cycle += 1;
        }
        let late = if kind == FrameKind::Sync { std::mem::take(&mut self.late) } else { Vec::new() };
        let fate = self.fate(kind, &frame);
        self.injected += u32::from(fate != Fate::Delivered);
        match fate {
            Fate::Delivered => out.push(Received::Frame(frame)),
            Fate::Lost => out.push(Received::Lost(kind)),
            Fate::Doubled => out.extend([Received::Frame(frame); 2]),
            Fate::Late => {
                out.push(Received::Lost(kind));
                self.late.push(frame);
            }
            Fate::Corrupted(how) => out.push(Received::Frame(corrupted(&frame, kind, how))),
        }
        out.extend(late.into_iter().map(Received::Frame));
    }

    fn cyclic_kind(&self, frame: &CanFrame) -> Option<FrameKind> {
        let Id::Standard(id) = frame.id() else { return None };
        let kind = self.ids.classify(id)?;
        let cyclic =
            |spec: &&protocol::table::FrameSpec| spec.kind == kind && matches!(spec.rate, Rate::EveryCycles(_));
        FRAMES.iter().find(cyclic).map(|_| kind)
    }

    fn fate(&self, kind: FrameKind, frame: &CanFrame) -> Fate {
        if self.plan.cut.is_some_and(|(cut, from)| cut == kind && self.cycle >= from) {
            return Fate::Lost;
        }
        if self.cycle < self.plan.from_cycle {
            return Fate::Delivered;
        }
        let Id::Standard(id) = frame.id() else { return Fate::Delivered };
        let hash =
            mix(self.plan.seed
                ^ mix(u64::from(id.as_raw()) << 40 | u64::from(self.cycle) << 8 | u64::from(self.receiver)));
        let mut left = hash % 1000;
        let how = u8::try_from(hash >> 32 & 0xFF).unwrap_or(0);
        let fates = [
            (self.plan.lost_per_mille, Fate::Lost),
            (self.plan.doubled_per_mille, Fate::Doubled),
            (self.plan.late_per_mille, Fate::Late),
            (self.plan.corrupted_per_mille, Fate::Corrupted(how)),
        ];
        for (share, fate) in fates {
            match left.checked_sub(u64::from(share)) {
                None => return fate,
                Some(rest) => left = rest,
            }
        }
        Fate::Delivered
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): one round of mixing.
const fn mix(value: u64) -> u64 {
    let z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

fn corrupted(frame: &CanFrame, kind: FrameKind, how: u8) -> CanFrame {
    let payload = frame.payload();
    let counter_at = match kind {
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
    };
    let mut data = payload.to_vec();
    match (how % 4, counter_at) {
        (0, _) => shortened(frame, payload),
        (1, _) => CanFrame::new_remote(frame.id(), payload.len()).unwrap_or(*frame),
        (2, Some(at)) => {
            // Three to ten cycles old: two would pass for the late frame of a cycle that was closed by its token.
            let back = 3 + u16::from(how) / 4 % 8;
            data[at] = u8::try_from((u16::from(data[at]) + 239 - back) % 240 + 1).unwrap_or(1);
            CanFrame::new(frame.id(), &data).unwrap_or(*frame)
        }
        (3, _) if kind == FrameKind::Feedback => {
            // Half the range of the encoder away.
            data[3] ^= 0x40;
            CanFrame::new(frame.id(), &data).unwrap_or(*frame)
        }
        _ => shortened(frame, payload),
    }
}

fn shortened(frame: &CanFrame, payload: &[u8]) -> CanFrame {
    CanFrame::new(frame.id(), &payload[..payload.len() / 2]).unwrap_or(*frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::{Message, SyncCounter};

    fn ids() -> AxisIds {
        AxisIds::of_axis(0).unwrap()
    }

    fn fates(plan: FaultPlan, receiver: u8, cycles: u32) -> Vec<Vec<Received>> {
        let mut port = FaultyPort::new(plan, ids(), receiver);
        let mut counter = SyncCounter::FIRST;
        (0..cycles)
            .map(|_| {
                counter = counter.next();
                let mut out = Vec::new();
                port.receive(Message::Sync(counter).encode(ids()), &mut out);
                out
            })
            .collect()
    }

    #[test]
    fn a_twentieth_of_the_frames_is_lost_and_the_same_ones_every_time() {
        let plan = FaultPlan { seed: 3, lost_per_mille: 50, ..FaultPlan::default() };
        let first = fates(plan, 1, 10_000);
        let lost = first.iter().filter(|out| out[0] == Received::Lost(FrameKind::Sync)).count();
        assert!((430..570).contains(&lost), "{lost}");
        assert_eq!(first, fates(plan, 1, 10_000));
        assert_ne!(first, fates(plan, 2, 10_000), "another receiver loses other frames");
    }

    #[test]
    fn a_late_frame_comes_after_the_next_sync() {
        let plan = FaultPlan { late_per_mille: 1000, ..FaultPlan::default() };
        let out = fates(plan, 1, 3);
        assert_eq!(out[0], [Received::Lost(FrameKind::Sync)]);
        assert!(matches!(out[1][..], [Received::Lost(_), Received::Frame(_)]));
    }
}
