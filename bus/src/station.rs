//! What every sans-I/O node looks like from the bus.

use protocol::CanFrame;
use protocol::cob::{AxisIds, FrameKind};

/// What a receiving port gives a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// A frame.
    Frame(CanFrame),
    /// A frame that was sent and that this port lost; it closes the cycle, so that lock-step cannot stand still.
    Lost(FrameKind),
}

/// A node: frames, tokens and time in, frames out.
pub trait Station {
    /// Node ids of its axis.
    fn ids(&self) -> AxisIds;
    /// The boot-up message.
    fn boot(&mut self, out: &mut Vec<CanFrame>);
    /// Takes what its port received.
    fn take(&mut self, received: Received, now_us: u64, out: &mut Vec<CanFrame>);
    /// Lets time pass.
    fn tick(&mut self, now_us: u64, out: &mut Vec<CanFrame>);
}

impl Station for servo::Servo {
    fn ids(&self) -> AxisIds {
        self.ids()
    }

    fn boot(&mut self, out: &mut Vec<CanFrame>) {
        out.extend(servo::Servo::boot(self));
    }

    fn take(&mut self, received: Received, now_us: u64, out: &mut Vec<CanFrame>) {
        match received {
            Received::Frame(frame) => out.extend(self.on_frame(&frame, now_us)),
            Received::Lost(kind) => out.extend(self.on_lost(kind)),
        }
    }

    fn tick(&mut self, now_us: u64, out: &mut Vec<CanFrame>) {
        out.extend(self.on_time(now_us));
    }
}

impl Station for plant_sim::PlantNode {
    fn ids(&self) -> AxisIds {
        protocol::Station::ids(self)
    }

    fn boot(&mut self, out: &mut Vec<CanFrame>) {
        protocol::Station::boot(self, &mut |frame| out.push(frame));
    }

    fn take(&mut self, received: Received, now_us: u64, out: &mut Vec<CanFrame>) {
        if let Received::Frame(frame) = received {
            protocol::Station::take(self, &frame, now_us, &mut |frame| out.push(frame));
        }
    }

    fn tick(&mut self, now_us: u64, out: &mut Vec<CanFrame>) {
        while protocol::Station::wake_at_us(self).is_some_and(|wake| wake <= now_us) {
            protocol::Station::time(self, now_us, &mut |frame| out.push(frame));
        }
    }
}

/// A node that others can still look at while it is on the bus (a ballbar at the machine, a test at the drive).
impl<S: Station> Station for std::rc::Rc<std::cell::RefCell<S>> {
    fn ids(&self) -> AxisIds {
        self.borrow().ids()
    }

    fn boot(&mut self, out: &mut Vec<CanFrame>) {
        self.borrow_mut().boot(out);
    }

    fn take(&mut self, received: Received, now_us: u64, out: &mut Vec<CanFrame>) {
        self.borrow_mut().take(received, now_us, out);
    }

    fn tick(&mut self, now_us: u64, out: &mut Vec<CanFrame>) {
        self.borrow_mut().tick(now_us, out);
    }
}
