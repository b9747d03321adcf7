//! Records from the bus: a log of `candump -l` and the DBC of its nodes.
//!
//! A row is made with every frame of the message that carries the position (or of `row`, if that is
//! given), from the values that were last seen. Time is that of the stamps; in lock-step, where
//! stamps say nothing, it is the count of a message that comes once a cycle (`cycle`).

use std::collections::HashMap;
use std::path::Path;

use can_dbc::{ByteOrder, Dbc, Signal, ValueType};
use serde::Deserialize;

use crate::error::IdentificationError;
use crate::record::source::{Mapping, SourceForm};
use crate::record::table::Table;

type Outcome<T> = Result<T, IdentificationError>;

/// `[bus]` in `dataset.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BusForm {
    /// File of the DBC, beside the log.
    dbc: String,
    /// Message that makes a row.
    row: Option<String>,
    /// Message that comes once a cycle, where its count and `sample_period_s` are the time.
    cycle: Option<String>,
    /// Interface, where the log has several.
    interface: Option<String>,
}

/// A column that is filled from a signal.
struct Column {
    name: String,
    message: u32,
    signal: Signal,
    form: SourceForm,
    last: Option<f64>,
    turns: f64,
}

/// Reads a log.
pub(crate) fn read(
    path: &Path,
    bus: &BusForm,
    mapping: &Mapping,
    period_s: Option<f64>,
) -> Outcome<Table> {
    let dbc_path = path.with_file_name(&bus.dbc);
    let shown = dbc_path.display().to_string();
    let dbc = Dbc::try_from(text(&dbc_path)?.as_str()).map_err(|error| {
        IdentificationError::new(format!(
            "{shown}: not a DBC: {}",
            one_line(&error.to_string())
        ))
    })?;
    let messages: HashMap<&str, u32> = dbc
        .messages
        .iter()
        .map(|message| (message.name.as_str(), message.id.raw()))
        .collect();
    let message = |name: &str| {
        messages
            .get(name)
            .copied()
            .ok_or_else(|| IdentificationError::new(format!("{shown}: no message {name}")))
    };
    let mut columns = Vec::new();
    for (name, source) in mapping {
        columns.push(column(&dbc, &shown, name, source.form())?);
    }
    let row = match &bus.row {
        Some(name) => message(name)?,
        None => columns
            .iter()
            .find(|c| c.name.starts_with("position_"))
            .map(|c| c.message)
            .ok_or_else(|| {
                IdentificationError::new(format!(
                    "{}: [columns] has no position_m or position_rad",
                    path.display()
                ))
            })?,
    };
    let cycle = bus.cycle.as_deref().map(message).transpose()?;
    if cycle.is_some() && period_s.is_none() {
        return Err(IdentificationError::new(format!(
            "{}: [bus] cycle counts cycles; sample_period_s must say how long one is",
            path.display()
        )));
    }
    fill(path, bus, columns, row, cycle, period_s.unwrap_or(0.0))
}

fn text(path: &Path) -> Outcome<String> {
    std::fs::read_to_string(path)
        .map_err(|error| IdentificationError::new(format!("{}: {error}", path.display())))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn column(dbc: &Dbc, shown: &str, name: &str, form: SourceForm) -> Outcome<Column> {
    let wanted = form.name.clone();
    let (message, signal) = wanted.split_once('.').ok_or_else(|| {
        IdentificationError::new(format!(
            "{name}: \"{wanted}\" is not of the form Message.Signal"
        ))
    })?;
    let found = dbc.messages.iter().find(|known| known.name == message);
    let signal = found.and_then(|known| {
        known
            .signals
            .iter()
            .find(|known| known.name == signal)
            .cloned()
    });
    match (found, signal) {
        (Some(message), Some(signal)) => Ok(Column {
            name: name.into(),
            message: message.id.raw(),
            signal,
            form,
            last: None,
            turns: 0.0,
        }),
        _ => Err(IdentificationError::new(format!(
            "{shown}: no signal {wanted}, which [columns] {name} asks for"
        ))),
    }
}

fn fill(
    path: &Path,
    bus: &BusForm,
    mut columns: Vec<Column>,
    row: u32,
    cycle: Option<u32>,
    period_s: f64,
) -> Outcome<Table> {
    let mut header = vec!["time_s".to_owned()];
    header.extend(columns.iter().map(|column| column.name.clone()));
    let mut table = Table {
        path: path.display().to_string(),
        columns: vec![Vec::new(); header.len()],
        header,
    };
    let mut cycles = 0.0;
    for (index, line) in text(path)?
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty())
    {
        let frame = Frame::parse(line).ok_or_else(|| {
            IdentificationError::new(format!(
                "{}:{}: \"{}\" is not a line of candump -l: (seconds) interface identifier#data",
                path.display(),
                index + 1,
                line.chars().take(60).collect::<String>()
            ))
        })?;
        if bus
            .interface
            .as_ref()
            .is_some_and(|wanted| wanted != frame.interface)
        {
            continue;
        }
        if cycle == Some(frame.id) {
            cycles += 1.0;
        }
        for column in columns
            .iter_mut()
            .filter(|column| column.message == frame.id)
        {
            column.take(&frame.data);
        }
        let values: Option<Vec<f64>> = columns.iter().map(Column::value).collect();
        if let (true, Some(values)) = (frame.id == row, values) {
            table.columns[0].push(if cycle.is_some() {
                cycles * period_s
            } else {
                frame.time_s
            });
            table.columns[1..]
                .iter_mut()
                .zip(values)
                .for_each(|(column, value)| column.push(value));
        }
    }
    Ok(table)
}

impl Column {
    fn take(&mut self, data: &[u8]) {
        let Some(raw) = raw(&self.signal, data) else {
            return;
        };
        let value = raw * self.signal.factor + self.signal.offset;
        if let (Some(range), Some(last)) = (self.form.wraps_at, self.last) {
            let step = value - last;
            self.turns -= f64::from(i8::from(step > 0.5 * range) - i8::from(step < -0.5 * range));
        }
        self.last = Some(value);
    }

    fn value(&self) -> Option<f64> {
        let unwrapped = self.last? + self.turns * self.form.wraps_at.unwrap_or(0.0);
        Some(self.form.scale * unwrapped + self.form.offset)
    }
}

/// The raw value of a signal; `None` where the frame is too short for it.
fn raw(signal: &Signal, data: &[u8]) -> Option<f64> {
    let size = signal.size;
    let bits = data.len() as u64 * 8;
    if size == 0 || size > 64 {
        return None;
    }
    let bit = |at: u64| {
        data.get((at / 8) as usize)
            .map(|byte| u64::from(byte >> (at % 8) & 1))
    };
    let mut value = 0_u64;
    match signal.byte_order {
        ByteOrder::LittleEndian => {
            if signal.start_bit.checked_add(size)? > bits {
                return None;
            }
            for at in (0..size).rev() {
                value = value << 1 | bit(signal.start_bit + at)?;
            }
        }
        ByteOrder::BigEndian => {
            let mut at = signal.start_bit;
            for _ in 0..size {
                value = value << 1 | bit(at)?;
                at = if at.is_multiple_of(8) {
                    at + 15
                } else {
                    at - 1
                };
            }
        }
    }
    let negative = signal.value_type == ValueType::Signed && value >> (size - 1) & 1 == 1;
    let range = if size == 64 {
        2.0_f64.powi(64)
    } else {
        (1_u64 << size) as f64
    };
    Some(if negative {
        value as f64 - range
    } else {
        value as f64
    })
}

/// A line of `candump -l`.
#[derive(Debug, PartialEq)]
struct Frame<'a> {
    time_s: f64,
    interface: &'a str,
    id: u32,
    data: Vec<u8>,
}

/// Set in a raw DBC identifier of an extended frame.
const EXTENDED: u32 = 1 << 31;

impl<'a> Frame<'a> {
    fn parse(line: &'a str) -> Option<Self> {
        let mut words = line.split_whitespace();
        let time_s = words
            .next()?
            .strip_prefix('(')?
            .strip_suffix(')')?
            .parse::<f64>()
            .ok()?;
        let interface = words.next()?;
        let (id, data) = words.next()?.split_once('#')?;
        let extended = if id.len() > 3 { EXTENDED } else { 0 };
        let id = u32::from_str_radix(id, 16).ok()? | extended;
        // A remote frame has no data; one of CAN FD has a second # and its flags.
        let data = match data.strip_prefix('#') {
            Some(fd) => fd.get(1..)?,
            None if data.starts_with('R') => "",
            None => data,
        };
        if !data.is_ascii() || data.len() % 2 != 0 {
            return None;
        }
        let bytes = (0..data.len())
            .step_by(2)
            .map(|at| u8::from_str_radix(&data[at..at + 2], 16).ok());
        Some(Self {
            time_s: Some(time_s).filter(|t| t.is_finite())?,
            interface,
            id,
            data: bytes.collect::<Option<_>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DBC: &str = "VERSION \"\"\nNS_ :\nBS_:\nBU_: A\nBO_ 128 Sync: 1 A\n SG_ Counter : 0|8@1+ (1,0) [0|0] \"\" A\n\
        BO_ 401 Feedback: 8 A\n SG_ Position : 0|16@1- (0.5,1) [0|0] \"m\" A\n SG_ Low : 16|8@1+ (1,0) [0|0] \"m\" A\n\
        BO_ 529 Torque: 2 A\n SG_ Command : 7|16@0- (1,0) [0|0] \"Nm\" A\n";

    fn form(name: &str, wraps_at: Option<f64>) -> crate::record::source::Source {
        crate::record::source::Source::Form(SourceForm {
            name: name.into(),
            scale: 2.0,
            offset: 0.0,
            wraps_at,
        })
    }

    fn table(log: &str) -> Outcome<Table> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.dbc"), DBC).unwrap();
        let path = folder.path().join("train.log");
        std::fs::write(&path, log).unwrap();
        let bus = BusForm {
            dbc: "a.dbc".into(),
            row: None,
            cycle: Some("Sync".into()),
            interface: None,
        };
        let mapping = Mapping::from([
            ("position_m".into(), form("Feedback.Position", None)),
            ("load_position_m".into(), form("Feedback.Low", Some(256.0))),
            ("force_n".into(), form("Torque.Command", None)),
        ]);
        read(&path, &bus, &mapping, Some(0.5))
    }

    #[test]
    fn signals_are_scaled_signed_unwrapped_and_held() {
        let log = "(1.0) can0 080#01\n(1.0) can0 211#FFFE\n(1.0) can0 191#FEFFFA0000\n(1.1) can0 080#02\n(1.1) can0 191#0400020000\n";
        let table = table(log).unwrap();
        let column = |name: &str| table.column(name).unwrap();
        assert_eq!(column("time_s"), [0.5, 1.0]);
        assert_eq!(column("position_m"), [0.0, 6.0]);
        assert_eq!(column("load_position_m"), [500.0, 516.0]);
        assert_eq!(column("force_n"), [-4.0, -4.0]);
    }

    #[test]
    fn what_is_no_frame_is_named_with_its_line() {
        let error = table("(1.0) can0 080#01\n(1.0) can0 19#0G\n")
            .unwrap_err()
            .to_string();
        assert!(error.contains("train.log:2:"), "{error}");
    }

    #[test]
    fn short_frames_change_nothing() {
        assert_eq!(table("(1.0) can0 191#FE\n").unwrap().columns[0].len(), 0);
    }
}
