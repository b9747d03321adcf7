//! The SDO server: expedited transfers, range checks before acknowledgement, an atomic commit.
//!
//! It keeps two parameter sets. Downloads go into the *staged* one; a commit has it converted
//! ([`crate::commit`]) and then makes it the *active* one. Uploads read the one that
//! [`objects::SET_READ`] names. A commit that is refused leaves both as they are, and says in 2F02h
//! which parameter to look at.

use protocol::leaf::{LeafReport, LeafTimes, Timed};
use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};
use protocol::table::HEARTBEAT_EVERY_CYCLES;

use crate::objects::{self, Entry, Misfit, Parameter};
use crate::parameters::{ParameterSet, SetError};
use crate::watchdog::Counts;

/// A count by its subindex; subindex 0 tells how many there are.
fn number(numbers: &[u32], subindex: u8) -> Option<Expedited> {
    match usize::from(subindex).checked_sub(1) {
        None => u8::try_from(numbers.len()).ok().map(Expedited::u8),
        Some(place) => numbers.get(place).copied().map(Expedited::u32),
    }
}

/// Values that a client may read but not write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Readings {
    /// Error register, object 1001h.
    pub error_register: u8,
    /// Code of the last EMCY, object 603Fh.
    pub emergency_code: u16,
    /// What else is known about the last fault, object 2202h.
    pub fault_detail: u32,
    /// Status word.
    pub status_word: u16,
    /// Actual position of the encoder that closes the loop, 10 nm.
    pub position: i32,
    /// Motor encoder as a position at the table, 10 nm.
    pub motor_position: i32,
    /// Load scale, 10 nm.
    pub load_position: i32,
    /// Following error, 10 nm.
    pub following_error: i32,
    /// Refined factor on the levels of friction, 1e-6.
    pub refined_level: i32,
    /// Counts since reset.
    pub counts: Counts,
    /// What the leaf reports of itself, objects 2203h.
    pub leaf: LeafReport,
    /// What it has timed.
    pub times: LeafTimes,
}

/// Which set an upload reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum SetRead {
    #[default]
    Staged,
    Active,
}

/// Staged and active parameters, and what is written beside them.
#[derive(Clone, Debug, Default)]
pub struct SdoServer {
    staged: ParameterSet,
    active: ParameterSet,
    set_read: SetRead,
    commits: u32,
    refused: Option<SetError>,
    declared_period_us: u32,
    /// A commit waits for the conversion of the staged set, which stays as it is meanwhile.
    is_committing: bool,
}

/// What a request did, apart from the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing that the drive has to know.
    None,
    /// What the leaf timed begins anew.
    Clear(Timed),
    /// The staged set is to be converted; the answer waits for it ([`SdoServer::end_commit`]).
    Convert,
}

impl SdoServer {
    /// The set that is written.
    #[must_use]
    pub const fn staged(&self) -> &ParameterSet {
        &self.staged
    }

    /// The SYNC period that the master declares (object 2102h); `None` where it does not.
    #[must_use]
    pub const fn declared_period_us(&self) -> Option<u32> {
        match self.declared_period_us {
            0 => None,
            period_us => Some(period_us),
        }
    }

    /// Answers a request. `has_torque`: the loop is closed, so that encoders and cycle time must
    /// stay.
    pub fn handle(
        &mut self,
        request: Request,
        readings: &Readings,
        has_torque: bool,
    ) -> (Option<Response>, Effect) {
        match request {
            Request::Upload(address) => (Some(self.upload(address, readings)), Effect::None),
            Request::Download(objects::COMMIT, data) => self.commit(data, has_torque),
            Request::Download(address, data) => match objects::cleared(address) {
                Some(timed) => (Some(Response::Downloaded(address)), Effect::Clear(timed)),
                None => (Some(self.download(address, data)), Effect::None),
            },
            Request::Unsupported(address) => (
                Some(aborted(address, AbortCode::CommandUnknown)),
                Effect::None,
            ),
            Request::Abort(_) => (None, Effect::None),
        }
    }

    fn upload(&self, address: Address, readings: &Readings) -> Response {
        let value = self
            .own(address)
            .or_else(|| reading(address, readings))
            .or_else(|| self.parameter(address));
        match value {
            Some(value) => Response::Uploaded(address, value),
            None => aborted(address, missing(address)),
        }
    }

    /// Objects of the server itself.
    fn own(&self, address: Address) -> Option<Expedited> {
        let row = self.refused.map_or(0, |error| row(error.parameter()));
        Some(match address {
            objects::COMMIT => Expedited::u32(self.commits),
            objects::SET_READ => Expedited::u8(u8::from(self.set_read == SetRead::Active)),
            objects::REFUSED_ROW => Expedited::u32(row),
            objects::REFUSED_REASON => {
                Expedited::u32(self.refused.map_or(0, |error| u32::from(error.code())))
            }
            objects::DECLARED_PERIOD => Expedited::u32(self.declared_period_us),
            objects::HEARTBEAT_PERIOD => {
                Expedited::u16(heartbeat_ms(self.active.get(Parameter::CyclePeriod)))
            }
            _ => return None,
        })
    }

    fn parameter(&self, address: Address) -> Option<Expedited> {
        let set = match self.set_read {
            SetRead::Staged => &self.staged,
            SetRead::Active => &self.active,
        };
        objects::find(address).map(|entry| Expedited::i32(set.get(entry.parameter)))
    }

    fn download(&mut self, address: Address, data: Expedited) -> Response {
        let written = match address {
            objects::SET_READ => self.choose_set(data),
            objects::DECLARED_PERIOD => self.declare_period(data),
            _ => self.download_parameter(address, data),
        };
        match written {
            Ok(()) => Response::Downloaded(address),
            Err(code) => aborted(address, code),
        }
    }

    fn choose_set(&mut self, data: Expedited) -> Result<(), AbortCode> {
        self.set_read = match data.to_u32() {
            0 => SetRead::Staged,
            1 => SetRead::Active,
            _ => return Err(AbortCode::ValueTooHigh),
        };
        Ok(())
    }

    fn declare_period(&mut self, data: Expedited) -> Result<(), AbortCode> {
        if data.len() < 4 {
            return Err(AbortCode::LengthTooLow);
        }
        let (shortest, longest) = objects::PERIOD_US;
        self.declared_period_us = match data.to_u32() {
            period_us if period_us > longest.unsigned_abs() => return Err(AbortCode::ValueTooHigh),
            period_us if period_us > 0 && period_us < shortest.unsigned_abs() => {
                return Err(AbortCode::ValueTooLow);
            }
            period_us => period_us,
        };
        Ok(())
    }

    fn download_parameter(&mut self, address: Address, data: Expedited) -> Result<(), AbortCode> {
        let Some(entry) = objects::find(address) else {
            let is_known = objects::READINGS.iter().any(|(known, _)| *known == address)
                || objects::is_timed(address);
            return Err(if is_known {
                AbortCode::ReadOnly
            } else {
                missing(address)
            });
        };
        let value = checked(entry, data)?;
        if self.is_committing {
            return Err(AbortCode::DeviceState);
        }
        self.staged.set(entry.parameter, value);
        Ok(())
    }

    fn commit(&mut self, data: Expedited, has_torque: bool) -> (Option<Response>, Effect) {
        match self.may_commit(data, has_torque) {
            Ok(()) => {
                self.is_committing = true;
                (None, Effect::Convert)
            }
            Err(code) => (Some(aborted(objects::COMMIT, code)), Effect::None),
        }
    }

    fn may_commit(&self, data: Expedited, has_torque: bool) -> Result<(), AbortCode> {
        if data.len() < 4 {
            return Err(AbortCode::LengthTooLow);
        }
        if data.to_u32() != objects::COMMIT_KEY {
            return Err(AbortCode::ValueInvalid);
        }
        if self.is_committing || !self.may_become_active(has_torque) {
            return Err(AbortCode::DeviceState);
        }
        Ok(())
    }

    fn may_become_active(&self, has_torque: bool) -> bool {
        !has_torque || self.staged.measures_like(&self.active)
    }

    /// The staged set was converted, or does not go together: makes it the active one for uploads,
    /// or refuses. Torque may have come meanwhile.
    pub fn end_commit(&mut self, fit: Result<(), SetError>, has_torque: bool) -> Response {
        self.is_committing = false;
        if !self.may_become_active(has_torque) {
            return aborted(objects::COMMIT, AbortCode::DeviceState);
        }
        self.refused = fit.err();
        if fit.is_err() {
            return aborted(objects::COMMIT, AbortCode::ParameterIncompatible);
        }
        self.active = self.staged.clone();
        self.commits = self.commits.wrapping_add(1);
        Response::Downloaded(objects::COMMIT)
    }
}

/// Objects of the drive.
fn reading(address: Address, readings: &Readings) -> Option<Expedited> {
    Some(match address {
        objects::DEVICE_TYPE => Expedited::u32(objects::DEVICE_TYPE_VALUE),
        objects::ERROR_REGISTER => Expedited::u8(readings.error_register),
        objects::ERROR_CODE => Expedited::u16(readings.emergency_code),
        objects::FAULT_DETAIL => Expedited::u32(readings.fault_detail),
        objects::STATUS_WORD => Expedited::u16(readings.status_word),
        objects::MODE_DISPLAY => Expedited::u8(8),
        objects::POSITION_ACTUAL => Expedited::i32(readings.position),
        objects::MOTOR_POSITION => Expedited::i32(readings.motor_position),
        objects::LOAD_POSITION => Expedited::i32(readings.load_position),
        objects::FOLLOWING_ERROR => Expedited::i32(readings.following_error),
        objects::STARTED_BY => Expedited::u8(readings.leaf.started_by.code()),
        objects::MISSED_DEADLINES => Expedited::u32(readings.leaf.missed_deadlines),
        objects::LATEST => Expedited::u32(readings.leaf.latest_us),
        objects::REFINED_LEVEL => Expedited::i32(readings.refined_level),
        Address {
            index: objects::DIAGNOSTICS_INDEX,
            subindex,
        } => return number(&readings.counts.in_order(), subindex),
        Address { index, subindex } => {
            let numbers = readings.times.of(objects::timed(index)?).in_order();
            return number(&numbers, subindex);
        }
    })
}

fn checked(entry: &Entry, data: Expedited) -> Result<i32, AbortCode> {
    if data.len() < 4 {
        return Err(AbortCode::LengthTooLow);
    }
    let value = data.to_i32();
    entry
        .check(value)
        .map(|()| value)
        .map_err(|misfit| match misfit {
            Misfit::TooLow => AbortCode::ValueTooLow,
            Misfit::TooHigh => AbortCode::ValueTooHigh,
            Misfit::Unsupported => AbortCode::ValueInvalid,
        })
}

/// The row of a parameter in `docs/objects.md`, from 1.
#[expect(
    clippy::as_conversions,
    reason = "repr(usize): the discriminant is the place, far below 2^32"
)]
const fn row(parameter: Parameter) -> u32 {
    (parameter as u32).saturating_add(1)
}

/// The heartbeat's period in whole ms: a tenth of the cycle time in µs.
const fn heartbeat_ms(period_us: i32) -> u16 {
    const PER_MS: u16 = 1000 / HEARTBEAT_EVERY_CYCLES;
    saturated(period_us).wrapping_div(PER_MS)
}

/// A cycle time is at most 20 000 µs.
#[expect(clippy::as_conversions, reason = "cut to the range of the type")]
const fn saturated(period_us: i32) -> u16 {
    if period_us > 65_535 {
        u16::MAX
    } else {
        period_us.unsigned_abs() as u16
    }
}

fn missing(address: Address) -> AbortCode {
    if objects::index_exists(address.index) {
        AbortCode::SubindexMissing
    } else {
        AbortCode::ObjectMissing
    }
}

fn aborted(address: Address, code: AbortCode) -> Response {
    Response::Aborted(address, code.value())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A request, and the conversion that it may ask for.
    fn asked(
        server: &mut SdoServer,
        request: Request,
        has_torque: bool,
    ) -> (Option<Response>, Effect) {
        let (answer, effect) = server.handle(request, &Readings::default(), has_torque);
        if effect != Effect::Convert {
            return (answer, effect);
        }
        let fit = server.staged.settings().map(|_| ());
        (Some(server.end_commit(fit, has_torque)), Effect::None)
    }

    fn ask(server: &mut SdoServer, request: Request) -> (Option<Response>, Effect) {
        asked(server, request, false)
    }

    const COMMITTED: (Option<Response>, Effect) =
        (Some(Response::Downloaded(objects::COMMIT)), Effect::None);

    fn write(index: u16, subindex: u8, value: i32) -> Request {
        Request::Download(Address::new(index, subindex), Expedited::i32(value))
    }

    fn read(server: &mut SdoServer, address: Address) -> i32 {
        match ask(server, Request::Upload(address)) {
            (Some(Response::Uploaded(_, value)), Effect::None) => value.to_i32(),
            other => panic!("expected a value, got {other:?}"),
        }
    }

    fn code(answer: (Option<Response>, Effect)) -> u32 {
        match answer {
            (Some(Response::Aborted(_, code)), Effect::None) => code,
            other => panic!("expected an abort, got {other:?}"),
        }
    }

    const COMMIT: Request = Request::Download(objects::COMMIT, Expedited::u32(objects::COMMIT_KEY));

    #[test]
    fn a_value_out_of_range_is_refused_before_it_is_acknowledged() {
        let mut server = SdoServer::default();
        assert_eq!(
            code(ask(&mut server, write(0x2110, 3, 1_000_001))),
            AbortCode::ValueTooHigh.value()
        );
        assert_eq!(
            code(ask(&mut server, write(0x2100, 3, -1))),
            AbortCode::ValueTooLow.value()
        );
        assert_eq!(
            code(ask(&mut server, write(0x605A, 0, 3))),
            AbortCode::ValueInvalid.value()
        );
        assert_eq!(
            code(ask(&mut server, write(0x2100, 9, 0))),
            AbortCode::SubindexMissing.value()
        );
        assert_eq!(
            code(ask(&mut server, write(0x3000, 0, 0))),
            AbortCode::ObjectMissing.value()
        );
        let short = Request::Download(Address::new(0x2100, 3), Expedited::u16(1));
        assert_eq!(
            code(ask(&mut server, short)),
            AbortCode::LengthTooLow.value()
        );
        let segmented = Request::Unsupported(Address::new(0x2100, 3));
        assert_eq!(
            code(ask(&mut server, segmented)),
            AbortCode::CommandUnknown.value()
        );
        assert_eq!(server.staged, ParameterSet::default());
    }

    #[test]
    fn what_can_only_be_read_is_read_and_not_written() {
        let writable = [objects::COMMIT, objects::SET_READ, objects::DECLARED_PERIOD];
        let mut server = SdoServer::default();
        for (address, name) in objects::READINGS {
            read(&mut server, address);
            if !writable.contains(&address) && objects::cleared(address).is_none() {
                let answer = ask(&mut server, Request::Download(address, Expedited::u32(0)));
                assert_eq!(code(answer), AbortCode::ReadOnly.value(), "{name}");
            }
        }
    }

    #[test]
    fn nothing_is_active_before_the_commit_and_everything_after_it() {
        let (mut server, delay) = (SdoServer::default(), Address::new(0x2110, 3));
        let (answer, effect) = ask(&mut server, write(0x2110, 3, 7000));
        assert_eq!(
            (answer, effect),
            (Some(Response::Downloaded(delay)), Effect::None)
        );
        let choose = |set| Request::Download(objects::SET_READ, Expedited::u8(set));
        assert_eq!(read(&mut server, delay), 7000, "staged");
        ask(&mut server, choose(1));
        assert_eq!(read(&mut server, delay), 0, "active");
        assert_eq!(ask(&mut server, COMMIT), COMMITTED);
        assert_eq!(server.active.get(Parameter::PulseStartDelay), 7000);
        assert_eq!(
            (read(&mut server, delay), read(&mut server, objects::COMMIT)),
            (7000, 1)
        );
        assert_eq!(
            code(ask(&mut server, choose(2))),
            AbortCode::ValueTooHigh.value()
        );
    }

    #[test]
    fn a_set_that_does_not_go_together_is_not_committed_and_says_where() {
        let mut server = SdoServer::default();
        ask(&mut server, write(0x2111, 0, 2560));
        assert_eq!(
            code(ask(&mut server, COMMIT)),
            AbortCode::ParameterIncompatible.value()
        );
        let row = usize::try_from(read(&mut server, objects::REFUSED_ROW)).unwrap();
        assert_eq!(objects::TABLE[row - 1].parameter, Parameter::VelocityLimit);
        let reason = SetError::WithoutLimit(Parameter::VelocityLimit).code();
        assert_eq!(
            read(&mut server, objects::REFUSED_REASON),
            i32::from(reason)
        );
        assert_eq!(server.active, ParameterSet::default());
        let wrong_key = Request::Download(objects::COMMIT, Expedited::u32(1));
        assert_eq!(
            code(ask(&mut server, wrong_key)),
            AbortCode::ValueInvalid.value()
        );
        ask(&mut server, write(0x2111, 0, 0));
        assert_eq!(ask(&mut server, COMMIT), COMMITTED);
        assert_eq!(read(&mut server, objects::REFUSED_ROW), 0);
    }

    #[test]
    fn encoders_and_cycle_time_stay_while_there_is_torque() {
        for parameter in crate::parameters::ONLY_WITHOUT_TORQUE {
            let mut server = SdoServer::default();
            let entry = objects::TABLE
                .iter()
                .find(|entry| entry.parameter == parameter)
                .unwrap();
            let other = if entry.default() == entry.max {
                entry.min
            } else {
                entry.default() + 1
            };
            server.staged.set(parameter, other);
            assert_eq!(
                code(asked(&mut server, COMMIT, true)),
                AbortCode::DeviceState.value(),
                "{parameter:?}"
            );
        }
        let mut server = SdoServer::default();
        server.staged.set(Parameter::PulseStartDelay, 7000);
        assert_eq!(asked(&mut server, COMMIT, true), COMMITTED);
    }

    #[test]
    fn a_set_that_is_converted_stays_as_it_is_until_the_answer() {
        let (mut server, readings) = (SdoServer::default(), Readings::default());
        ask(&mut server, write(0x2110, 3, 7000));
        let begun = server.handle(COMMIT, &readings, false);
        assert_eq!(begun, (None, Effect::Convert), "the answer comes later");
        for request in [write(0x2110, 3, 8000), COMMIT] {
            let refused = server.handle(request, &readings, false);
            assert_eq!(code(refused), AbortCode::DeviceState.value());
        }
        assert_eq!(read(&mut server, Address::new(0x2110, 3)), 7000);
        assert_eq!(read(&mut server, objects::COMMIT), 0);
        let answer = server.end_commit(Ok(()), false);
        assert_eq!(answer, Response::Downloaded(objects::COMMIT));
        assert_eq!(server.active.get(Parameter::PulseStartDelay), 7000);
        assert_eq!(
            ask(&mut server, write(0x2110, 3, 8000)).0,
            Some(Response::Downloaded(Address::new(0x2110, 3)))
        );
    }

    #[test]
    fn torque_that_comes_while_a_set_is_converted_refuses_other_encoders() {
        let mut server = SdoServer::default();
        server.staged.set(Parameter::CyclePeriod, 2000);
        let (_, effect) = server.handle(COMMIT, &Readings::default(), false);
        assert_eq!(effect, Effect::Convert);
        let refused = server.end_commit(Ok(()), true);
        let code = AbortCode::DeviceState.value();
        assert_eq!(refused, Response::Aborted(objects::COMMIT, code));
        assert_eq!(server.active, ParameterSet::default());
    }

    #[test]
    fn the_declared_period_is_known_at_once_and_is_no_part_of_the_set() {
        let mut server = SdoServer::default();
        assert_eq!(server.declared_period_us(), None);
        let declare = |us| Request::Download(objects::DECLARED_PERIOD, Expedited::u32(us));
        ask(&mut server, declare(2000));
        assert_eq!(
            (
                server.declared_period_us(),
                read(&mut server, objects::DECLARED_PERIOD)
            ),
            (Some(2000), 2000)
        );
        assert_eq!(
            code(ask(&mut server, declare(99))),
            AbortCode::ValueTooLow.value()
        );
        assert_eq!(
            code(ask(&mut server, declare(20_001))),
            AbortCode::ValueTooHigh.value()
        );
        assert_eq!(server.staged, ParameterSet::default());
    }

    #[test]
    fn the_heartbeat_s_period_is_a_hundred_cycles() {
        let mut server = SdoServer::default();
        assert_eq!(read(&mut server, objects::HEARTBEAT_PERIOD), 100);
        ask(&mut server, write(0x1006, 0, 20_000));
        ask(&mut server, COMMIT);
        assert_eq!(read(&mut server, objects::HEARTBEAT_PERIOD), 2000);
    }

    proptest! {
        #[test]
        fn any_request_is_answered_and_whatever_is_staged_is_in_range(requests in proptest::collection::vec(any::<[u8; 8]>(), 0..50)) {
            let mut server = SdoServer::default();
            for payload in requests {
                let request = Request::decode(payload);
                let (response, _) = ask(&mut server, request);
                prop_assert_eq!(response.is_none(), matches!(request, Request::Abort(_)));
            }
            prop_assert!(fits(&server.staged) && fits(&server.active));
        }

        #[test]
        fn any_value_written_to_any_row_is_taken_in_range_or_refused(
            writes in proptest::collection::vec((0..objects::PARAMETERS, prop_oneof![any::<i32>(), -3..2000_i32], any::<bool>()), 0..80),
        ) {
            let mut server = SdoServer::default();
            for (place, value, commit) in writes {
                let entry = &objects::TABLE[place];
                let (response, _) = ask(&mut server, Request::Download(entry.address, Expedited::i32(value)));
                let taken = response == Some(Response::Downloaded(entry.address));
                prop_assert_eq!(taken, entry.check(value).is_ok());
                if commit {
                    let _ = ask(&mut server, COMMIT);
                }
                prop_assert!(fits(&server.staged) && fits(&server.active));
                prop_assert!(server.active.settings().is_ok(), "only a set that goes together becomes active");
            }
        }
    }

    fn fits(set: &ParameterSet) -> bool {
        objects::TABLE
            .iter()
            .all(|entry| entry.check(set.get(entry.parameter)).is_ok())
    }
}
