//! SDO client: one expedited request at a time to the servo of an axis, and the parameter sets that
//! go that way.
//!
//! A set is staged object by object and becomes active as a whole with the commit object; nothing
//! of it acts before.

use plant_sim::Machine;
use protocol::Message;
use protocol::message::{Decoded, decode};
use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};
use servo::objects;
use servo::parameters::SetError;

use super::{ANSWER, AnswerPatience, Master};
use crate::compensation::AxisCompensation;
use crate::drive_parameters;
use crate::error::{Failure, Outcome};
use crate::network::link::Link;

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
    /// Where a value does not fit, or the drive refuses it or the whole set: with its parameter and
    /// reason.
    pub fn configure(
        &mut self,
        machine: &Machine,
        compensation: &[AxisCompensation],
    ) -> Outcome<()> {
        let period_us = u32::try_from(self.period.as_micros()).unwrap_or(u32::MAX);
        for (index, axis) in machine.axes.iter().enumerate() {
            self.download(index, objects::DECLARED_PERIOD, Expedited::u32(period_us))?;
            let own = compensation.get(index).cloned().unwrap_or_default();
            let parameters = drive_parameters::parameters(axis, machine.period_s, &own);
            let of_axis = |why| Failure::new(format!("axis {}: {why}", axis.name));
            for (entry, value) in parameters.map_err(of_axis)? {
                self.download(index, entry.address, Expedited::i32(value))?;
            }
            self.commit(index)?;
        }
        Ok(())
    }

    /// Makes the staged set active. A set that does not go together is refused as a whole, and
    /// 2F02h says why.
    fn commit(&mut self, index: usize) -> Outcome<()> {
        let request = Request::Download(objects::COMMIT, Expedited::u32(objects::COMMIT_KEY));
        match self.ask(index, request)? {
            Response::Downloaded(_) => Ok(()),
            Response::Aborted(_, code) if code == AbortCode::ParameterIncompatible.value() => {
                let row = self.upload(index, objects::REFUSED_ROW)?.to_u32();
                let reason = self.upload(index, objects::REFUSED_REASON)?.to_u32();
                let (name, why) = (&self.axes[index].name, refusal(row, reason));
                Err(Failure::new(format!(
                    "axis {name}: the drive refuses the parameter set: {why}"
                )))
            }
            other => Err(self.refused(index, objects::COMMIT, other)),
        }
    }

    /// An answer about another object is a late one, to a request that was given up.
    fn ask(&mut self, index: usize, request: Request) -> Outcome<Response> {
        self.keep_pace()?;
        self.send(index, Message::SdoRequest(request))?;
        let (bus, ids) = (self.axes[index].bus, self.axes[index].ids);
        let mut patience = AnswerPatience::begin();
        while patience.lasts() {
            let Some(frame) = self.link.receive(bus, ANSWER)? else {
                break;
            };
            if let Ok(Decoded::Message(Message::SdoResponse(response))) = decode(ids, &frame)
                && response.is_about(request.address())
            {
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
        let Address {
            index: object,
            subindex,
        } = address;
        Failure::new(format!(
            "axis {}: object {object:04X}h:{subindex}: {why}",
            self.axes[index].name
        ))
    }
}

/// The parameter and the reason of a refused commit, in words: rows of `docs/objects.md` count from
/// 1, reasons are those of [`SetError`].
fn refusal(row: u32, reason: u32) -> String {
    let place = usize::try_from(row).ok().and_then(|row| row.checked_sub(1));
    let parameter = place
        .and_then(|place| objects::TABLE.get(place))
        .map_or_else(
            || format!("row {row} of its object table"),
            |entry| {
                let address = entry.address;
                format!(
                    "object {:04X}h:{} ({})",
                    address.index,
                    address.subindex,
                    entry.name()
                )
            },
        );
    let text = SetError::REASONS
        .iter()
        .find(|(code, _)| u32::from(*code) == reason);
    let text = text.map_or_else(
        || format!("reason {reason}"),
        |(_, text)| (*text).to_owned(),
    );
    format!("{parameter}: {text}")
}
