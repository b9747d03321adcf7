//! The SDO server: expedited transfers, range checks before acknowledgement, an atomic commit.

use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};

use crate::objects::{self, Entry, Parameter};
use crate::parameters::{ParameterSet, Settings};

/// Values that a client may read but not write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Readings {
    /// Error register, object 1001h.
    pub error_register: u8,
    /// Status word.
    pub status_word: u16,
    /// Actual position, 10 nm.
    pub position: i32,
    /// Following error, 10 nm.
    pub following_error: i32,
    /// Lost, stale, malformed, implausible, doubled.
    pub diagnostics: [u32; 5],
}

/// Staged parameters and the count of commits.
#[derive(Clone, Debug, Default)]
pub struct SdoServer {
    staged: ParameterSet,
    commits: u32,
}

/// What a request did, apart from the answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Nothing that the drive has to know.
    None,
    /// A new set becomes active at the next cycle.
    Commit(Settings),
}

impl SdoServer {
    /// Stages a value that the node itself chooses (what a command line says at start); out of range it is left out.
    pub fn stage(&mut self, parameter: Parameter, value: i32) {
        let fits = |entry: &&Entry| entry.parameter == parameter && (entry.min..=entry.max).contains(&value);
        if objects::TABLE.iter().find(fits).is_some() {
            self.staged.set(parameter, value);
        }
    }

    /// The settings of the staged set; `None` where it does not go together.
    #[must_use]
    pub fn staged_settings(&self) -> Option<Settings> {
        self.staged.settings().ok()
    }

    /// Answers a request. `may_change_encoders` is false while the loop is closed.
    pub fn handle(
        &mut self,
        request: Request,
        readings: &Readings,
        active: &Settings,
        may_change_encoders: bool,
    ) -> (Option<Response>, Effect) {
        match request {
            Request::Upload(address) => (Some(self.upload(address, readings)), Effect::None),
            Request::Download(objects::COMMIT, data) => self.commit(data, active, may_change_encoders),
            Request::Download(address, data) => (Some(self.download(address, data)), Effect::None),
            Request::Unsupported(address) => (Some(aborted(address, AbortCode::CommandUnknown)), Effect::None),
            Request::Abort(_) => (None, Effect::None),
        }
    }

    fn upload(&self, address: Address, readings: &Readings) -> Response {
        let value = match address {
            objects::DEVICE_TYPE => Expedited::u32(objects::DEVICE_TYPE_VALUE),
            objects::ERROR_REGISTER => Expedited::u8(readings.error_register),
            objects::COMMIT => Expedited::u32(self.commits),
            objects::STATUS_WORD => Expedited::u16(readings.status_word),
            objects::MODE_DISPLAY => Expedited::u8(8),
            objects::POSITION_ACTUAL => Expedited::i32(readings.position),
            objects::FOLLOWING_ERROR => Expedited::i32(readings.following_error),
            Address { index: objects::DIAGNOSTICS_INDEX, subindex } => match diagnostic(readings, subindex) {
                Some(count) => Expedited::u32(count),
                None => return aborted(address, AbortCode::SubindexMissing),
            },
            _ => match objects::find(address) {
                Some(entry) => Expedited::i32(self.staged.get(entry.parameter)),
                None => return aborted(address, missing(address)),
            },
        };
        Response::Uploaded(address, value)
    }

    fn download(&mut self, address: Address, data: Expedited) -> Response {
        let Some(entry) = objects::find(address) else {
            let known = self.upload_exists(address);
            return aborted(address, if known { AbortCode::ReadOnly } else { missing(address) });
        };
        match checked(entry, data) {
            Ok(value) => {
                self.staged.set(entry.parameter, value);
                Response::Downloaded(address)
            }
            Err(code) => aborted(address, code),
        }
    }

    fn upload_exists(&self, address: Address) -> bool {
        matches!(self.upload(address, &Readings::default()), Response::Uploaded(..))
    }

    fn commit(&mut self, data: Expedited, active: &Settings, may_change_encoders: bool) -> (Option<Response>, Effect) {
        let address = objects::COMMIT;
        if data.len() < 4 {
            return (Some(aborted(address, AbortCode::LengthTooLow)), Effect::None);
        }
        if data.to_u32() != objects::COMMIT_KEY {
            return (Some(aborted(address, AbortCode::ValueTooHigh)), Effect::None);
        }
        let Ok(settings) = self.staged.settings() else {
            return (Some(aborted(address, AbortCode::ParameterIncompatible)), Effect::None);
        };
        let encoders_stay =
            settings.way == active.way && settings.config.position_source == active.config.position_source;
        if !encoders_stay && !may_change_encoders {
            return (Some(aborted(address, AbortCode::DeviceState)), Effect::None);
        }
        self.commits = self.commits.wrapping_add(1);
        (Some(Response::Downloaded(address)), Effect::Commit(settings))
    }
}

fn checked(entry: &Entry, data: Expedited) -> Result<i32, AbortCode> {
    if data.len() < 4 {
        return Err(AbortCode::LengthTooLow);
    }
    match data.to_i32() {
        value if value < entry.min => Err(AbortCode::ValueTooLow),
        value if value > entry.max => Err(AbortCode::ValueTooHigh),
        value => Ok(value),
    }
}

fn diagnostic(readings: &Readings, subindex: u8) -> Option<u32> {
    let place = usize::from(subindex).checked_sub(1)?;
    readings.diagnostics.get(place).copied()
}

fn missing(address: Address) -> AbortCode {
    if objects::index_exists(address.index) { AbortCode::SubindexMissing } else { AbortCode::ObjectMissing }
}

fn aborted(address: Address, code: AbortCode) -> Response {
    Response::Aborted(address, code.value())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ask(server: &mut SdoServer, request: Request) -> (Option<Response>, Effect) {
        let active = ParameterSet::default().settings().unwrap();
        server.handle(request, &Readings::default(), &active, true)
    }

    fn write(index: u16, subindex: u8, value: i32) -> Request {
        Request::Download(Address::new(index, subindex), Expedited::i32(value))
    }

    fn code(answer: (Option<Response>, Effect)) -> u32 {
        match answer {
            (Some(Response::Aborted(_, code)), Effect::None) => code,
            other => panic!("expected an abort, got {other:?}"),
        }
    }

    #[test]
    fn a_value_out_of_range_is_refused_before_it_is_acknowledged() {
        let mut server = SdoServer::default();
        assert_eq!(code(ask(&mut server, write(0x2110, 3, 10_001))), AbortCode::ValueTooHigh.value());
        assert_eq!(code(ask(&mut server, write(0x2100, 3, -1))), AbortCode::ValueTooLow.value());
        assert_eq!(code(ask(&mut server, write(0x2100, 9, 0))), AbortCode::SubindexMissing.value());
        assert_eq!(code(ask(&mut server, write(0x3000, 0, 0))), AbortCode::ObjectMissing.value());
        assert_eq!(code(ask(&mut server, write(0x6064, 0, 0))), AbortCode::ReadOnly.value());
        let short = Request::Download(Address::new(0x2100, 3), Expedited::u16(1));
        assert_eq!(code(ask(&mut server, short)), AbortCode::LengthTooLow.value());
        let segmented = Request::Unsupported(Address::new(0x2100, 3));
        assert_eq!(code(ask(&mut server, segmented)), AbortCode::CommandUnknown.value());
        assert_eq!(server.staged, ParameterSet::default());
    }

    #[test]
    fn nothing_is_active_before_the_commit_and_everything_after_it() {
        let mut server = SdoServer::default();
        let (answer, effect) = ask(&mut server, write(0x2110, 3, 7));
        assert_eq!((answer, effect), (Some(Response::Downloaded(Address::new(0x2110, 3))), Effect::None));
        let commit = Request::Download(objects::COMMIT, Expedited::u32(objects::COMMIT_KEY));
        let (_, Effect::Commit(settings)) = ask(&mut server, commit) else { panic!("no commit") };
        assert_eq!(settings.config.pulse.start_delay_cycles, 7);
    }

    #[test]
    fn a_set_that_does_not_go_together_is_not_committed() {
        let mut server = SdoServer::default();
        ask(&mut server, write(0x2111, 1, 256));
        let commit = Request::Download(objects::COMMIT, Expedited::u32(objects::COMMIT_KEY));
        assert_eq!(code(ask(&mut server, commit)), AbortCode::ParameterIncompatible.value());
        let wrong_key = Request::Download(objects::COMMIT, Expedited::u32(1));
        assert_eq!(code(ask(&mut server, wrong_key)), AbortCode::ValueTooHigh.value());
    }

    proptest! {
        #[test]
        fn any_request_is_answered_and_whatever_is_staged_is_in_range(requests in proptest::collection::vec(any::<[u8; 8]>(), 0..50)) {
            let mut server = SdoServer::default();
            for payload in requests {
                let _ = ask(&mut server, Request::decode(payload));
            }
            for entry in &objects::TABLE {
                let value = server.staged.get(entry.parameter);
                prop_assert!(entry.min <= value && value <= entry.max);
            }
        }
    }
}
