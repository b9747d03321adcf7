//! The plant as a station of a bus.

use protocol::cob::AxisIds;
use protocol::{CanFrame, Station};

use crate::PlantNode;

impl Station for PlantNode {
    fn ids(&self) -> AxisIds {
        Self::ids(self)
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        Self::boot(self).into_iter().for_each(send);
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.on_frame(frame, now_us).into_iter().for_each(send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.on_time(now_us).into_iter().for_each(send);
    }

    /// The SYNC timeout, while it matters.
    fn wake_at_us(&self) -> Option<u64> {
        self.sync_gone_at_us()
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }
}
