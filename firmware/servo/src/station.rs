//! The node as a station of a bus.

use protocol::cob::AxisIds;
use protocol::leaf::{LeafReport, Timed};
use protocol::{CanFrame, Station};

use crate::Servo;

impl Station for Servo {
    fn ids(&self) -> AxisIds {
        self.ids
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        Self::boot(self).iter().copied().for_each(send);
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.on_frame(frame, now_us).iter().copied().for_each(send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.on_time(now_us).iter().copied().for_each(send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        Self::wake_at_us(self)
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.timing.sync_due_us()
    }

    fn report(&mut self, leaf: LeafReport) {
        self.leaf = leaf;
    }

    fn took(&mut self, timed: Timed, ns: u32) {
        self.times.of_mut(timed).took(ns);
    }
}
