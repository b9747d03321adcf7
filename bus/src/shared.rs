//! A station that others can look at while it is on the bus: a ballbar at the machine, a test at
//! the drive.

use std::cell::{Ref, RefCell, RefMut};
use std::rc::Rc;

use protocol::cob::AxisIds;
use protocol::{CanFrame, Station};

/// One station, held by the bus and by whoever looks at it.
///
/// ```
/// # use bus::Shared;
/// let seen = Shared::new(7);
/// let on_the_bus = seen.clone();
/// *seen.borrow_mut() = 8;
/// assert_eq!(*on_the_bus.borrow(), 8);
/// ```
#[derive(Debug)]
pub struct Shared<S>(Rc<RefCell<S>>);

impl<S> Shared<S> {
    /// Makes a station one that can be shared.
    #[must_use]
    pub fn new(station: S) -> Self {
        Self(Rc::new(RefCell::new(station)))
    }

    /// Looks at it, between two calls of the bus.
    #[must_use]
    pub fn borrow(&self) -> Ref<'_, S> {
        self.0.borrow()
    }

    /// Changes it, between two calls of the bus.
    #[must_use]
    pub fn borrow_mut(&self) -> RefMut<'_, S> {
        self.0.borrow_mut()
    }
}

impl<S> Clone for Shared<S> {
    fn clone(&self) -> Self {
        Self(Rc::clone(&self.0))
    }
}

impl<S: Station> Station for Shared<S> {
    fn ids(&self) -> AxisIds {
        self.borrow().ids()
    }

    fn boot(&mut self, send: &mut dyn FnMut(CanFrame)) {
        self.borrow_mut().boot(send);
    }

    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.borrow_mut().take(frame, now_us, send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.borrow_mut().time(now_us, send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.borrow().wake_at_us()
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.borrow().sync_due_us()
    }
}
