//! Communication object identifiers (COB-ID) after CANopen's predefined connection set, CiA 301
//! §7.3.5.
//!
//! Every role has its own node id: axis `a` has its servo at `0x01 + a` and its plant at `0x11 +
//! a`. A node therefore has to know both ids of its axis to tell a setpoint (`0x200 + servo`) from
//! a torque command (`0x200 + plant`); [`AxisIds::classify`] is that one place.

use embedded_can::StandardId;

/// A CANopen node id, 1…127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(u8);

impl NodeId {
    /// A node id, or `None` outside 1…127.
    #[must_use]
    pub const fn new(id: u8) -> Option<Self> {
        if id >= 1 && id <= 127 {
            Some(Self(id))
        } else {
            None
        }
    }

    /// The id as it stands on the bus.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }
}

/// Function codes of the predefined connection set that Quadrant uses (CiA 301 tables 38 and 39).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u16)]
pub enum FunctionCode {
    /// Network management, one identifier for all nodes.
    Nmt = 0x000,
    /// SYNC as a broadcast (node part 0), EMCY with a node id.
    SyncOrEmergency = 0x080,
    /// First transmit PDO.
    Tpdo1 = 0x180,
    /// First receive PDO.
    Rpdo1 = 0x200,
    /// Second transmit PDO.
    Tpdo2 = 0x280,
    /// Third transmit PDO.
    Tpdo3 = 0x380,
    /// SDO, server to client.
    SdoResponse = 0x580,
    /// SDO, client to server.
    SdoRequest = 0x600,
    /// NMT error control: heartbeat and boot-up.
    Heartbeat = 0x700,
}

impl FunctionCode {
    /// The identifier of this function at a node.
    ///
    /// ```
    /// use embedded_can::StandardId;
    /// use protocol::cob::{FunctionCode, NodeId};
    /// let servo = NodeId::new(1).unwrap();
    /// assert_eq!(FunctionCode::Tpdo3.at(servo), StandardId::new(0x381).unwrap());
    /// ```
    #[must_use]
    pub const fn at(self, node: NodeId) -> StandardId {
        self.with_low_bits(node.0)
    }

    /// The identifier with no node in it: NMT and SYNC.
    #[must_use]
    pub const fn broadcast(self) -> StandardId {
        self.with_low_bits(0)
    }

    #[expect(
        clippy::as_conversions,
        reason = "repr(u16) code and u8 to u16: both lossless; From is not const"
    )]
    const fn with_low_bits(self, low: u8) -> StandardId {
        // The largest code is 0x700 and `low` is below 0x80, so the value always fits 11 bits;
        // `MAX` is never taken.
        match StandardId::new(self as u16 | (low & 0x7F) as u16) {
            Some(id) => id,
            None => StandardId::MAX,
        }
    }
}

/// What a frame is, seen from one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FrameKind {
    /// NMT command, workbench → nodes.
    Nmt,
    /// SYNC with counter, workbench → nodes.
    Sync,
    /// Encoder positions, plant → servo.
    Feedback,
    /// Torque command, servo → plant.
    Torque,
    /// Position setpoint, workbench → servo.
    Setpoint,
    /// State of power stage and brake, plant → servo.
    PlantStatus,
    /// Drive status, servo → workbench.
    Status,
    /// Heartbeat or boot-up of the servo.
    ServoHeartbeat,
    /// Heartbeat or boot-up of the plant.
    PlantHeartbeat,
    /// Emergency of the servo.
    ServoEmergency,
    /// Emergency of the plant.
    PlantEmergency,
    /// SDO request, workbench → servo.
    SdoRequest,
    /// SDO response, servo → workbench.
    SdoResponse,
}

impl FrameKind {
    /// All kinds, in the order of [`crate::table::FRAMES`].
    pub const ALL: [Self; 13] = [
        Self::Nmt,
        Self::Sync,
        Self::ServoEmergency,
        Self::PlantEmergency,
        Self::Feedback,
        Self::Setpoint,
        Self::Torque,
        Self::PlantStatus,
        Self::Status,
        Self::SdoResponse,
        Self::SdoRequest,
        Self::ServoHeartbeat,
        Self::PlantHeartbeat,
    ];
}

/// The two node ids of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisIds {
    /// Node id of the servo (drive).
    pub servo: NodeId,
    /// Node id of the plant.
    pub plant: NodeId,
}

impl AxisIds {
    /// The default ids of axis `index`: servo at `0x01 + index`, plant at `0x11 + index`; `None`
    /// beyond 16 axes.
    #[must_use]
    pub const fn of_axis(index: u8) -> Option<Self> {
        if index > 15 {
            return None;
        }
        match (
            NodeId::new(index.saturating_add(0x01)),
            NodeId::new(index.saturating_add(0x11)),
        ) {
            (Some(servo), Some(plant)) => Some(Self { servo, plant }),
            _ => None,
        }
    }

    /// The identifier that a kind of frame has on this axis.
    #[must_use]
    pub const fn identifier(self, kind: FrameKind) -> StandardId {
        match kind {
            FrameKind::Nmt => FunctionCode::Nmt.broadcast(),
            FrameKind::Sync => FunctionCode::SyncOrEmergency.broadcast(),
            FrameKind::Feedback => FunctionCode::Tpdo1.at(self.plant),
            FrameKind::Torque => FunctionCode::Rpdo1.at(self.plant),
            FrameKind::Setpoint => FunctionCode::Rpdo1.at(self.servo),
            FrameKind::PlantStatus => FunctionCode::Tpdo2.at(self.plant),
            FrameKind::Status => FunctionCode::Tpdo3.at(self.servo),
            FrameKind::ServoHeartbeat => FunctionCode::Heartbeat.at(self.servo),
            FrameKind::PlantHeartbeat => FunctionCode::Heartbeat.at(self.plant),
            FrameKind::ServoEmergency => FunctionCode::SyncOrEmergency.at(self.servo),
            FrameKind::PlantEmergency => FunctionCode::SyncOrEmergency.at(self.plant),
            FrameKind::SdoRequest => FunctionCode::SdoRequest.at(self.servo),
            FrameKind::SdoResponse => FunctionCode::SdoResponse.at(self.servo),
        }
    }

    /// What an identifier means on this axis; `None` for other people's traffic.
    #[must_use]
    pub fn classify(self, id: StandardId) -> Option<FrameKind> {
        let raw = id.as_raw();
        // What comes in every cycle first.
        if raw == 0x080 {
            return Some(FrameKind::Sync);
        }
        if raw == 0x180 | node_bits(self.plant) {
            return Some(FrameKind::Feedback);
        }
        if raw == 0x200 | node_bits(self.servo) {
            return Some(FrameKind::Setpoint);
        }
        self.classify_other(raw)
    }

    #[inline(never)]
    fn classify_other(self, raw: u16) -> Option<FrameKind> {
        let (code, node) = (raw & FUNCTION_BITS, raw & NODE_BITS);
        let (servo, plant) = (node == node_bits(self.servo), node == node_bits(self.plant));
        match code {
            0x000 if node == 0 => Some(FrameKind::Nmt),
            0x080 if servo => Some(FrameKind::ServoEmergency),
            0x080 if plant => Some(FrameKind::PlantEmergency),
            0x200 if plant => Some(FrameKind::Torque),
            0x280 if plant => Some(FrameKind::PlantStatus),
            0x380 if servo => Some(FrameKind::Status),
            0x580 if servo => Some(FrameKind::SdoResponse),
            0x600 if servo => Some(FrameKind::SdoRequest),
            0x700 if servo => Some(FrameKind::ServoHeartbeat),
            0x700 if plant => Some(FrameKind::PlantHeartbeat),
            _ => None,
        }
    }
}

/// The four bits of an identifier that tell the function (CiA 301 §7.3.5).
const FUNCTION_BITS: u16 = 0x780;
/// The seven that tell the node.
const NODE_BITS: u16 = 0x07F;

#[expect(
    clippy::as_conversions,
    reason = "u8 to u16 is lossless; From is not const"
)]
const fn node_bits(node: NodeId) -> u16 {
    node.0 as u16
}

/// What a servo listens to; every leaf sets its filters from this list.
pub const HEARD_BY_SERVO: [FrameKind; 8] = [
    FrameKind::Nmt,
    FrameKind::Sync,
    FrameKind::Feedback,
    FrameKind::Setpoint,
    FrameKind::PlantStatus,
    FrameKind::SdoRequest,
    FrameKind::PlantHeartbeat,
    FrameKind::PlantEmergency,
];

/// What a plant listens to.
pub const HEARD_BY_PLANT: [FrameKind; 3] = [FrameKind::Nmt, FrameKind::Sync, FrameKind::Torque];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_identifier_is_classified_as_the_kind_that_has_it_or_is_foreign() {
        for index in 0..16 {
            let ids = AxisIds::of_axis(index).unwrap();
            for raw in 0..=0x7FF {
                let id = StandardId::new(raw).unwrap();
                let wanted = FrameKind::ALL
                    .into_iter()
                    .find(|kind| ids.identifier(*kind) == id);
                assert_eq!(ids.classify(id), wanted, "{raw:#05x} on axis {index}");
            }
        }
    }
}
