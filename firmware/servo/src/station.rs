//! The drive node as a station of a bus.

use protocol::cob::AxisIds;
use protocol::{CanFrame, Station};

use crate::Servo;

impl Station for Servo {
    fn ids(&self) -> AxisIds {
        Self::ids(self)
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

    /// The SYNC timeout, while it matters.
    fn wake_at_us(&self) -> Option<u64> {
        let limits = &self.active.as_ref().filter(|_| self.drive.is_energised())?.limits;
        let gone = self.watchdog.last_sync_us()?.saturating_add(limits.sync_timeout_us).saturating_add(1);
        self.drive.fault().is_none().then_some(gone)
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }
}
