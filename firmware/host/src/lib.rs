//! A node as a host program: the same sans-I/O station as on the board, on embassy-executor, over
//! SocketCAN or an in-process bus.
//!
//! One task drives the station (`leaf`): frames as they come, and the time. Servo and plant run
//! through the same code.
//!
//! ```text
//! CAN port ─▶ (faults, in tests) ─▶ station ─▶ CAN port
//!    ▲ ppoll                          ▲ bus time, or the clock
//! ```

pub mod idle;
mod leaf;
pub mod port;
pub mod termination;

use std::cell::RefCell;
use std::io;
use std::os::fd::AsRawFd;
use std::rc::Rc;
use std::time::Duration;

use bus::FaultyPort;
use embassy_executor::raw::Executor;
use protocol::Station;
use static_cell::StaticCell;

use leaf::Leaf;
use port::Port;

/// Who beats the time of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The frames: bus time. A cycle whose frames stay away for the deadline closes without them.
    Lockstep {
        /// Patience without any frame, by the clock.
        deadline: Duration,
    },
    /// The clock.
    Clock,
}

/// Why the driver ended; nothing while it runs.
type End = Rc<RefCell<Option<io::Error>>>;

/// Runs a station on a port until the port fails or `stop` becomes readable; once per process,
/// because the executor is static.
///
/// # Errors
/// Where the port fails.
pub fn run(
    station: Box<dyn Station>,
    port: Port,
    faults: Option<FaultyPort>,
    pace: Pace,
    stop: &impl AsRawFd,
) -> io::Result<()> {
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    let mut leaf = Leaf::new(station, port, faults);
    leaf.boot()?;
    let executor: &'static Executor = EXECUTOR.init(Executor::new(std::ptr::null_mut()));
    let end = End::default();
    let task = drive(leaf, pace, Rc::clone(&end));
    let no_room = |_| io::Error::other("the executor has no room for the node's task");
    executor.spawner().spawn(task.map_err(no_room)?);
    idle::run(executor, stop, || end.borrow().is_some())?;
    end.take().map_or(Ok(()), Err)
}

#[embassy_executor::task]
async fn drive(mut leaf: Leaf, pace: Pace, end: End) {
    let Err(error) = match pace {
        Pace::Lockstep { deadline } => leaf.in_step(deadline).await,
        Pace::Clock => leaf.by_the_clock().await,
    };
    end.replace(Some(error));
}
