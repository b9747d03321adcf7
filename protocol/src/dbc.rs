//! `quadrant.dbc` from the frame table, for the node ids of a machine.
//!
//! With one axis the messages have the names of the table; with more, each carries the axis index
//! (`Feedback_0`).

use core::fmt::{self, Write};

use embedded_can::StandardId;

use crate::cob::{AxisIds, FrameKind};
use crate::table::{FRAMES, FrameSpec, Sender, Signal};

/// Writes the DBC of a machine's axes.
///
/// # Errors
/// Only those of the writer.
pub fn write(out: &mut impl Write, axes: &[AxisIds]) -> fmt::Result {
    head(out, axes)?;
    for (index, ids) in axes.iter().enumerate() {
        for frame in FRAMES
            .iter()
            .filter(|frame| index == 0 || !is_broadcast(frame.kind))
        {
            message(out, *ids, axis_suffix(axes, index, frame.kind), frame)?;
        }
    }
    for (index, ids) in axes.iter().enumerate() {
        for frame in FRAMES
            .iter()
            .filter(|frame| index == 0 || !is_broadcast(frame.kind))
        {
            comments(out, *ids, frame)?;
        }
    }
    Ok(())
}

const fn is_broadcast(kind: FrameKind) -> bool {
    matches!(kind, FrameKind::Nmt | FrameKind::Sync)
}

fn axis_suffix(axes: &[AxisIds], index: usize, kind: FrameKind) -> Option<usize> {
    (axes.len() > 1 && !is_broadcast(kind)).then_some(index)
}

fn head(out: &mut impl Write, axes: &[AxisIds]) -> fmt::Result {
    write!(out, "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: Workbench")?;
    for ids in axes {
        write!(out, " Servo_{} Plant_{}", ids.servo.get(), ids.plant.get())?;
    }
    write!(out, "\n\n")
}

fn message(
    out: &mut impl Write,
    ids: AxisIds,
    suffix: Option<usize>,
    frame: &FrameSpec,
) -> fmt::Result {
    write!(out, "BO_ {} {}", raw(ids, frame.kind), frame.name)?;
    if let Some(index) = suffix {
        write!(out, "_{index}")?;
    }
    write!(out, ": {} ", frame.length)?;
    node(out, ids, frame.sender)?;
    writeln!(out)?;
    for signal in frame.signals {
        self::signal(out, ids, frame.sender, signal)?;
    }
    writeln!(out)
}

fn signal(out: &mut impl Write, ids: AxisIds, sender: Sender, signal: &Signal) -> fmt::Result {
    let sign = if signal.signed { '-' } else { '+' };
    let Signal {
        name,
        start,
        length,
        weight,
        ..
    } = signal;
    write!(
        out,
        " SG_ {name} : {start}|{length}@1{sign} ({weight},0) [0|0] \"{}\" ",
        weight.unit
    )?;
    match sender {
        Sender::Workbench => write!(out, "Servo_{},Plant_{}", ids.servo.get(), ids.plant.get())?,
        Sender::Servo => write!(out, "Workbench,Plant_{}", ids.plant.get())?,
        Sender::Plant => write!(out, "Workbench,Servo_{}", ids.servo.get())?,
    }
    writeln!(out)
}

fn node(out: &mut impl Write, ids: AxisIds, sender: Sender) -> fmt::Result {
    match sender {
        Sender::Workbench => write!(out, "Workbench"),
        Sender::Servo => write!(out, "Servo_{}", ids.servo.get()),
        Sender::Plant => write!(out, "Plant_{}", ids.plant.get()),
    }
}

fn comments(out: &mut impl Write, ids: AxisIds, frame: &FrameSpec) -> fmt::Result {
    for signal in frame.signals {
        writeln!(
            out,
            "CM_ SG_ {} {} \"{}\";",
            raw(ids, frame.kind),
            signal.name,
            signal.text
        )?;
    }
    Ok(())
}

fn raw(ids: AxisIds, kind: FrameKind) -> u16 {
    StandardId::as_raw(&ids.identifier(kind))
}
