//! The way up and down against a scripted drive: every step is confirmed, and a refusal is told in
//! the drive's own words.

use std::collections::VecDeque;
use std::time::Duration;

use plant_sim::Machine;
use plant_sim::node::Truth;
use protocol::cob::AxisIds;
use protocol::message::{
    self, Decoded, EmergencyMessage, ErrorRegister, Feedback, NmtCommand, NmtState, Status,
};
use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};
use protocol::states::{Command, ControlWord, DriveState, StatusWord};
use protocol::weight::{
    FollowingError24, LoadIncrements24, MotorIncrements, TorqueMicroNm, TorquePerMille,
};
use protocol::{CanFrame, Fault, Message, SyncCounter};
use servo::objects::{self, Parameter};
use servo::parameters::SetError;
use workbench::error::Outcome;
use workbench::interrupt::Interrupt;
use workbench::network::link::{Link, axis_ids};
use workbench::network::master::Master;

/// A drive that needs `delay` cycles to enable and to disable operation, and refuses to enable with
/// `refusal`.
struct Drive {
    ids: AxisIds,
    state: DriveState,
    delay: u32,
    waited: u32,
    refusal: Option<Fault>,
    has_refused: bool,
    commands: Vec<ControlWord>,
    written: Vec<(Address, u32)>,
    /// The object that it does not take, and why.
    aborts: Option<(Address, AbortCode)>,
    /// What 2F02h:1 and :2 say.
    refused: (u32, u32),
    out: VecDeque<CanFrame>,
    /// The servo is dead; its plant goes on by its own timer, and its heartbeats never end.
    is_dead: bool,
    received: u32,
}

impl Drive {
    fn new(delay: u32, refusal: Option<Fault>) -> Self {
        Self {
            ids: axis_ids(0).unwrap(),
            state: DriveState::SwitchOnDisabled,
            delay,
            waited: 0,
            refusal,
            has_refused: false,
            commands: Vec::new(),
            written: Vec::new(),
            aborts: None,
            refused: (0, 0),
            out: VecDeque::new(),
            is_dead: false,
            received: 0,
        }
    }

    fn say(&mut self, message: Message) {
        self.out.push_back(message.encode(self.ids));
    }

    fn cycle(&mut self, counter: SyncCounter) {
        let (motor, load) = (MotorIncrements(0), LoadIncrements24::from_counts(0));
        self.say(Message::Feedback(Feedback {
            motor,
            load,
            counter,
        }));
        if self.is_dead {
            self.say(Message::PlantHeartbeat(NmtState::Operational));
            return self.say(Message::Feedback(Feedback {
                motor,
                load,
                counter: counter.next(),
            }));
        }
        let (torque, control) = (TorqueMicroNm(0), ControlWord::DISABLE_VOLTAGE);
        let following_error = FollowingError24::saturating(0);
        let status = StatusWord::of(self.state);
        self.say(Message::Status(Status {
            status,
            following_error,
            torque: TorquePerMille(0),
            fault: None,
        }));
        self.say(Message::Torque(message::Torque {
            torque,
            control,
            counter,
        }));
    }

    fn follow(&mut self, control: ControlWord) {
        if self.commands.last() != Some(&control) {
            self.commands.push(control);
            self.waited = 0;
        }
        self.waited += 1;
        self.state = match (self.state, control.command()) {
            (DriveState::SwitchedOn, Some(Command::EnableOperation)) => self.enabled(),
            (DriveState::OperationEnabled, Some(Command::SwitchOn))
                if self.waited <= self.delay =>
            {
                self.state
            }
            (DriveState::SwitchOnDisabled | DriveState::SwitchedOn, Some(Command::Shutdown)) => {
                DriveState::ReadyToSwitchOn
            }
            (
                DriveState::ReadyToSwitchOn | DriveState::OperationEnabled,
                Some(Command::SwitchOn),
            ) => DriveState::SwitchedOn,
            (_, Some(Command::DisableVoltage)) => DriveState::SwitchOnDisabled,
            (state, _) => state,
        };
    }

    fn enabled(&mut self) -> DriveState {
        match self.refusal {
            Some(fault) => {
                if !self.has_refused {
                    let register = ErrorRegister(ErrorRegister::GENERIC);
                    let emergency = EmergencyMessage::new(
                        fault.emergency_code(),
                        register,
                        [fault.code(), 0, 0, 0, 0],
                    );
                    self.say(Message::ServoEmergency(emergency));
                }
                self.has_refused = true;
                self.state
            }
            None if self.waited <= self.delay => self.state,
            None => DriveState::OperationEnabled,
        }
    }

    fn answer(&mut self, request: Request) {
        if self.is_dead {
            return;
        }
        let response = match request {
            Request::Download(address, data) => {
                self.written.push((address, data.to_u32()));
                match self.aborts {
                    Some((object, code)) if object == address => {
                        Response::Aborted(address, code.value())
                    }
                    _ => Response::Downloaded(address),
                }
            }
            Request::Upload(objects::REFUSED_ROW) => {
                Response::Uploaded(objects::REFUSED_ROW, Expedited::u32(self.refused.0))
            }
            Request::Upload(objects::REFUSED_REASON) => {
                Response::Uploaded(objects::REFUSED_REASON, Expedited::u32(self.refused.1))
            }
            Request::Upload(address) => Response::Uploaded(address, Expedited::u32(0)),
            other => panic!("{other:?}"),
        };
        self.say(Message::SdoResponse(response));
    }
}

impl Link for Drive {
    fn buses(&self) -> usize {
        1
    }

    fn bus_of(&self, _axis: usize) -> usize {
        0
    }

    fn send(&mut self, _bus: usize, frame: CanFrame) -> Outcome<()> {
        match message::decode(self.ids, &frame) {
            Ok(Decoded::Message(Message::Nmt(NmtCommand::ResetCommunication, _))) => {
                self.say(Message::PlantHeartbeat(NmtState::Initialising));
                self.say(Message::ServoHeartbeat(NmtState::Initialising));
            }
            Ok(Decoded::Message(Message::Sync(counter))) => self.cycle(counter),
            Ok(Decoded::Message(Message::Setpoint(setpoint))) => self.follow(setpoint.control),
            Ok(Decoded::Message(Message::SdoRequest(request))) => self.answer(request),
            _ => {}
        }
        Ok(())
    }

    fn receive(&mut self, _bus: usize, _timeout: Duration) -> Outcome<Option<CanFrame>> {
        self.received += 1;
        if self.is_dead && self.out.is_empty() {
            self.say(Message::PlantHeartbeat(NmtState::Operational));
        }
        Ok(self.out.pop_front())
    }

    fn receive_in_cycle(
        &mut self,
        bus: usize,
        _most: Option<Duration>,
    ) -> Outcome<Option<CanFrame>> {
        self.receive(bus, Duration::ZERO)
    }

    fn pass(&mut self, _cycle: Duration) -> u32 {
        0
    }

    fn truth(&self, _axis: usize) -> Option<Truth> {
        None
    }

    fn start_log(&mut self) {}

    fn take_logs(&mut self) -> Vec<bus::BusLog> {
        Vec::new()
    }
}

fn one_axis() -> Machine {
    let mut machine = Machine::reference();
    machine.axes.truncate(1);
    machine
}

const UP: [ControlWord; 4] = [
    ControlWord::DISABLE_VOLTAGE,
    ControlWord::SHUTDOWN,
    ControlWord::SWITCH_ON,
    ControlWord::ENABLE_OPERATION,
];
const DOWN: [ControlWord; 3] = [
    ControlWord::SWITCH_ON,
    ControlWord::SHUTDOWN,
    ControlWord::DISABLE_VOLTAGE,
];

#[test]
fn a_refusal_names_axis_state_fault_and_what_to_do() {
    for fault in [
        Fault::ReferenceTooFar,
        Fault::CycleTimeMismatch,
        Fault::EncoderRelation,
    ] {
        let mut master = Master::start(Drive::new(0, Some(fault)), &one_axis()).unwrap();
        let text = master.enable().unwrap_err().to_string();
        let wanted = format!(
            "axis X: the drive is not enabled; it did not reach OperationEnabled (SwitchedOn; {fault:?}: {})",
            fault.text()
        );
        assert_eq!(text, wanted);
        assert!(
            master.cycles() < 20,
            "an EMCY is an answer, not a reason to wait: {} cycles",
            master.cycles()
        );
        assert_eq!(
            master.state(0),
            Some(DriveState::SwitchOnDisabled),
            "it goes down again"
        );
    }
}

#[test]
fn a_brake_of_half_a_second_is_waited_for_on_the_way_up_and_down() {
    let mut master = Master::start(Drive::new(500, None), &one_axis()).unwrap();
    master.enable().unwrap();
    assert!((500..520).contains(&master.cycles()), "{}", master.cycles());
    master.disable().unwrap();
    assert!(
        (1000..1040).contains(&master.cycles()),
        "{}",
        master.cycles()
    );
    assert_eq!(master.state(0), Some(DriveState::SwitchOnDisabled));
    assert_eq!(master.into_link().commands, [&UP[..], &DOWN[..]].concat());
}

#[test]
fn a_drive_that_never_answers_a_step_is_given_up_after_a_second_and_told() {
    let mut master = Master::start(Drive::new(u32::MAX, None), &one_axis()).unwrap();
    let text = master.enable().unwrap_err().to_string();
    assert!(
        text.contains("did not reach OperationEnabled (SwitchedOn; no fault reported)"),
        "{text}"
    );
    assert!(
        (1000..1040).contains(&master.cycles()),
        "{}",
        master.cycles()
    );
}

#[test]
fn an_interruption_on_the_way_up_takes_the_drive_down() {
    let interrupt = Interrupt::never();
    let mut master = Master::start(Drive::new(500, None), &one_axis())
        .unwrap()
        .until(interrupt.clone());
    interrupt.raise(libc::SIGINT);
    let text = master.enable().unwrap_err().to_string();
    assert_eq!(text, "interrupted by SIGINT; the drives were not enabled");
    assert_eq!(master.state(0), Some(DriveState::SwitchOnDisabled));
    assert!(
        !master
            .into_link()
            .commands
            .contains(&ControlWord::ENABLE_OPERATION)
    );
}

#[test]
fn the_sync_period_is_declared_before_the_set() {
    let machine = one_axis();
    let mut master = Master::start(Drive::new(0, None), &machine).unwrap();
    master.configure(&machine, &[]).unwrap();
    let written = master.into_link().written;
    assert_eq!(written[0], (objects::DECLARED_PERIOD, 1000));
    assert_eq!(written.last().unwrap().0, objects::COMMIT);
    assert!(written.len() > 10);
}

#[test]
fn a_drive_that_takes_no_declared_period_is_not_configured() {
    let machine = one_axis();
    let mut drive = Drive::new(0, None);
    drive.aborts = Some((objects::DECLARED_PERIOD, AbortCode::ObjectMissing));
    let mut master = Master::start(drive, &machine).unwrap();
    let text = master.configure(&machine, &[]).unwrap_err().to_string();
    assert!(text.starts_with("axis X: object 2102h:0: "), "{text}");
    assert_eq!(master.into_link().written.len(), 1);
}

#[test]
fn a_refused_set_names_parameter_and_reason_also_where_they_are_unknown() {
    let machine = one_axis();
    let row = |parameter: Parameter| u32::try_from(parameter as usize + 1).unwrap();
    let brakes_hard =
        u32::from(SetError::BeyondAcceleration(Parameter::QuickStopDeceleration).code());
    for (refused, wanted) in [
        (
            (row(Parameter::QuickStopDeceleration), brakes_hard),
            "object 6085h:0 (deceleration of the quick-stop ramp): a ramp brakes harder than the axis' acceleration limit",
        ),
        ((999, 200), "row 999 of its object table: reason 200"),
    ] {
        let mut drive = Drive::new(0, None);
        drive.aborts = Some((objects::COMMIT, AbortCode::ParameterIncompatible));
        drive.refused = refused;
        let mut master = Master::start(drive, &machine).unwrap();
        let text = master.configure(&machine, &[]).unwrap_err().to_string();
        assert_eq!(
            text,
            format!("axis X: the drive refuses the parameter set: {wanted}")
        );
    }
}

#[test]
fn a_plant_that_has_begun_the_next_cycle_by_itself_ends_the_waiting_for_a_dead_servo() {
    let mut master = Master::start(Drive::new(0, None), &one_axis()).unwrap();
    master.enable().unwrap();
    master.link_mut().is_dead = true;
    for _ in 0..3 {
        master.link_mut().received = 0;
        master.cycle(&[0.0]).unwrap();
        assert_eq!(
            master.link_mut().received,
            3,
            "feedback k, a heartbeat, feedback k + 1"
        );
    }
    assert_eq!(master.missed(), 3);
    assert!(master.has_lost_a_servo());
}

#[test]
fn a_servo_that_does_not_answer_is_given_up_although_its_plant_goes_on_talking() {
    let mut drive = Drive::new(0, None);
    drive.is_dead = true;
    let text = Master::start(drive, &one_axis()).err().unwrap().to_string();
    assert!(
        text.contains("the servo (node 1) does not answer"),
        "{text}"
    );
}
