//! One file of a dataset, CSV or bus log, read into a record.

use std::path::Path;

use crate::error::IdentificationError;
use crate::record::bus_log;
use crate::record::checks::{self, Purpose};
use crate::record::form::{DatasetForm, TimeFrom};
use crate::record::outliers::{self, Outliers};
use crate::record::samples::Record;
use crate::record::table::Table;
use crate::record::time_base::{Clock, Rows, uniform};
use crate::record::units::{AxisKind, Effort};

type Outcome<T> = Result<T, IdentificationError>;

/// What was read of a file.
pub(crate) struct Reading {
    /// Its record.
    pub record: Record,
    /// Which effort it has.
    pub effort: Effort,
    /// What was left out of it.
    pub outliers: Vec<Outliers>,
}

/// Reads a file.
pub(crate) fn read(path: &Path, form: &DatasetForm, purpose: Purpose) -> Outcome<Reading> {
    let mut table = table(path, form)?;
    let unit = form.axis.kind.position_unit();
    let time_s = table.take_required("time_s")?;
    checks::length(&table.path, &time_s, purpose)?;
    checks::time(&table.path, &time_s)?;
    checks::period(&table.path, &time_s, form.sample_period_s)?;
    let which = which_effort(&table)?;
    let mut rows = Rows {
        left_out: vec![false; time_s.len()],
        time_s,
        effort: table.take_required(which.column())?,
        position: table.take_required(&format!("position_{unit}"))?,
        load: table.take(&format!("load_position_{unit}")),
        velocity: velocity(&mut table, form.axis.kind)?,
        reference: table.take(&format!("reference_{unit}")),
    };
    checks::effort(&table.path, which, &rows.effort)?;
    let clock = Clock {
        period_s: form.sample_period_s,
        origin_s: match form.time_from {
            TimeFrom::Record => rows.time_s[0],
            TimeFrom::PowerOn => 0.0,
        },
    };
    // The other columns of the file are not needed while the record is made.
    drop(table);
    let as_recorded = rows.stamped();
    let outliers = outliers::leave_out(&mut rows, form.axis.moving_velocity());
    let record = Record {
        rows: as_recorded,
        ..uniform(rows, clock)
    };
    Ok(Reading {
        record,
        effort: which,
        outliers,
    })
}

fn table(path: &Path, form: &DatasetForm) -> Outcome<Table> {
    let is_log = path.extension().is_some_and(|extension| extension == "log");
    match &form.bus {
        Some(bus) if is_log => bus_log::read(path, bus, &form.columns, form.sample_period_s),
        _ => Table::read(path)?.mapped(&form.columns),
    }
}

/// The drive's velocity, where it was recorded, under either of its names.
fn velocity(table: &mut Table, kind: AxisKind) -> Outcome<Option<Vec<f64>>> {
    let names = kind.velocity_columns();
    match names.map(|name| table.take(name)) {
        [Some(_), Some(_)] => Err(IdentificationError::new(format!(
            "{}:1: more than one velocity column; keep one of {}",
            table.path,
            names.join(", ")
        ))),
        [one, other] => Ok(one.or(other)),
    }
}

fn which_effort(table: &Table) -> Outcome<Effort> {
    let is_there = |effort: &Effort| table.header.iter().any(|name| name == effort.column());
    let present: Vec<Effort> = Effort::ALL.into_iter().filter(is_there).collect();
    let refused = |why: String| Err(IdentificationError::new(format!("{}:1: {why}", table.path)));
    match present[..] {
        [effort] => Ok(effort),
        [] => refused(format!(
            "no effort column; give force_n, torque_nm or current_a (the header has {})",
            table.header.join(", ")
        )),
        _ => {
            refused("more than one effort column; keep one of force_n, torque_nm, current_a".into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_header(header: &str, form: &DatasetForm) -> Outcome<Reading> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("train.csv");
        let columns = header.split(',').count();
        let mut text = format!("{header}\n");
        for row in 0..2000 {
            let time = 5.0 + 1.0e-3 * f64::from(row);
            let rest = (1..columns).map(|column| format!(",{}", row * column as i32));
            text.push_str(&format!("{time}{}\n", rest.collect::<String>()));
        }
        std::fs::write(&path, text).unwrap();
        read(&path, form, Purpose::Training)
    }

    #[test]
    fn columns_of_the_axis_are_taken_and_others_are_left() {
        let header = "time_s,position_m,other,reference_m,current_a";
        let Reading { record, effort, .. } = read_header(header, &DatasetForm::default()).unwrap();
        assert_eq!(effort, Effort::Current);
        assert_eq!(
            (record.len(), record.position[10], record.effort[10]),
            (2000, 10.0, 40.0)
        );
        assert_eq!(record.reference.unwrap()[10], 30.0);
        assert_eq!((record.load, record.time_s[0]), (None, 0.0));
    }

    #[test]
    fn a_velocity_is_taken_under_either_name_in_the_unit_of_the_axis() {
        let velocity = |column: &str| {
            let header = format!("time_s,position_m,{column},force_n");
            let reading = read_header(&header, &DatasetForm::default());
            reading.map(|reading| reading.record.velocity.map(|own| own[10]))
        };
        assert_eq!(velocity("velocity_m_s").unwrap(), Some(20.0));
        assert_eq!(velocity("velocity_m_per_s").unwrap(), Some(20.0));
        assert_eq!(velocity("velocity_rad_s").unwrap(), None);
        let both = velocity("velocity_m_s,velocity_m_per_s").unwrap_err();
        let both = both.to_string();
        assert!(
            both.contains("train.csv:1: more than one velocity column"),
            "{both}"
        );
    }

    #[test]
    fn time_counts_from_power_on_where_the_form_says_so() {
        let form = DatasetForm {
            time_from: TimeFrom::PowerOn,
            ..DatasetForm::default()
        };
        let reading = read_header("time_s,position_m,force_n", &form).unwrap();
        assert_eq!(reading.record.time_s[0], 5.0);
    }

    #[test]
    fn one_effort_is_wanted_no_more_and_no_less() {
        let error = |header: &str| {
            let reading = read_header(header, &DatasetForm::default());
            reading
                .err()
                .map_or(String::new(), |error| error.to_string())
        };
        let none = error("time_s,position_m");
        assert!(none.contains("no effort column") && none.contains("time_s, position_m"));
        assert!(error("time_s,position_m,force_n,current_a").contains("more than one effort"));
    }
}
