//! SDO client: one expedited request at a time to the servo of an axis, and the parameter sets that go that way.
//!
//! A set is staged object by object and becomes active as a whole with the commit object; nothing of it acts before.

use plant_sim::Machine;
use protocol::Message;
use protocol::message::{Decoded, decode};
use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};
use servo::objects;

use super::{ANSWER, Master, Patience};
use crate::compensation::AxisCompensation;
use crate::drive;
use crate::error::{Failure, Outcome};
use crate::link::Link;

/// The SYNC period that the master declares, µs. It is refused by nobody, the drive compares it with the cycle time of the parameter set (1006h)
/// when it is enabled.
const DECLARED_PERIOD_US: Address = Address::new(0x2102, 0);

impl<L: Link> Master<L> {
    /// Reads an object of the servo.
    ///
    /// # Errors
    /// No answer, or an abort with its text.
    pub fn upload(&mut self, index: usize, address: Address) -> Outcome<Expedited> {
        match self.ask(index, Request::Upload(address))? {
            Response::Uploaded(_, data) => Ok(data),
            other => Err(self.refused(index, address, other)),
        }
    }

    /// Writes an object of the servo.
    ///
    /// # Errors
    /// No answer, or an abort with its text.
    pub fn download(&mut self, index: usize, address: Address, data: Expedited) -> Outcome<()> {
        match self.ask(index, Request::Download(address, data))? {
            Response::Downloaded(_) => Ok(()),
            other => Err(self.refused(index, address, other)),
        }
    }

    /// Downloads the parameters of all axes and makes each set active as a whole.
    ///
    /// # Errors
    /// Where a value does not fit or the drive refuses it.
    pub fn configure(&mut self, machine: &Machine, compensation: &[AxisCompensation]) -> Outcome<()> {
        for (index, axis) in machine.axes.iter().enumerate() {
            self.declare_period(index)?;
            let own = compensation.get(index).copied().unwrap_or_default();
            for (entry, value) in drive::parameters(axis, machine.period_s, &own)? {
                self.download(index, entry.address, Expedited::i32(value))?;
            }
            self.download(index, objects::COMMIT, Expedited::u32(objects::COMMIT_KEY))?;
        }
        Ok(())
    }

    /// A drive without the object has nothing to compare with: that it is missing is no error.
    fn declare_period(&mut self, index: usize) -> Outcome<()> {
        let period_us = u32::try_from(self.period.as_micros()).unwrap_or(u32::MAX);
        match self.ask(index, Request::Download(DECLARED_PERIOD_US, Expedited::u32(period_us)))? {
            Response::Downloaded(_) => Ok(()),
            Response::Aborted(_, code) if code == AbortCode::ObjectMissing.value() => Ok(()),
            other => Err(self.refused(index, DECLARED_PERIOD_US, other)),
        }
    }

    fn ask(&mut self, index: usize, request: Request) -> Outcome<Response> {
        self.send(index, Message::SdoRequest(request))?;
        let (bus, ids) = (self.axes[index].bus, self.axes[index].ids);
        let mut patience = Patience::begin();
        while patience.lasts() {
            let Some(frame) = self.link.receive(bus, ANSWER)? else { break };
            if let Ok(Decoded::Message(Message::SdoResponse(response))) = decode(ids, &frame) {
                return Ok(response);
            }
        }
        Err(self.no_answer(index))
    }

    fn no_answer(&self, index: usize) -> Failure {
        let (name, ids) = (&self.axes[index].name, self.axes[index].ids);
        let (servo, plant) = (ids.servo.get(), ids.plant.get());
        Failure::new(format!(
            "axis {name}: the servo (node {servo}) does not answer; is `quadrant servo --node {servo} --plant-node {plant}` running on this interface?"
        ))
    }

    fn refused(&self, index: usize, address: Address, response: Response) -> Failure {
        let why = match response {
            Response::Aborted(_, code) => format!("{} (abort {code:#010x})", AbortCode::text(code)),
            other => format!("unexpected answer {other:?}"),
        };
        let Address { index: object, subindex } = address;
        Failure::new(format!("axis {}: object {object:04X}h:{subindex}: {why}", self.axes[index].name))
    }
}
