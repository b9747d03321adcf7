//! Records and datasets made for tests.

use axis_model::EffectName;

use crate::fit::fitted::Fitted;
use crate::model::effects::find;
use crate::model::inverse::{Model, Part};
use crate::record::dataset::Dataset;
use crate::record::form::ControllerForm;
use crate::record::samples::Record;
use crate::record::units::{AxisKind, Effort, EffortHold};

/// A record of positions alone, on time from zero.
pub(crate) fn record(period_s: f64, position: Vec<f64>) -> Record {
    let rows = position.len();
    Record {
        period_s,
        position,
        load: None,
        velocity: None,
        reference: None,
        effort: vec![0.0; rows],
        time_s: (0..rows).map(|row| period_s * row as f64).collect(),
        rows: Vec::new(),
        jittered: false,
        interpolated: vec![false; rows],
        joints: Vec::new(),
    }
}

/// A linear axis with nothing declared, in forces that are held from row to row.
pub(crate) fn dataset(train: Record, controller: Option<ControllerForm>) -> Dataset {
    Dataset {
        name: "made".into(),
        kind: AxisKind::Linear,
        moving_velocity: 1.0e-3,
        effort: Effort::Force,
        hold: EffortHold::ZeroOrder,
        effort_lag_s: 0.0,
        lead_m_per_rev: None,
        resolution: 1.0e-9,
        load_resolution: 0.0,
        effort_limit: None,
        controller,
        declared: Vec::new(),
        validate: train.clone(),
        train,
        held_back: false,
        full_band: false,
        is_sharpened: false,
        scale_errors: Vec::new(),
        notes: Vec::new(),
    }
}

/// Two sines of 20 mm and 4 mm, in rows of 1 ms.
pub(crate) fn two_sines(rows: u32) -> Vec<f64> {
    let path = |t: f64| 0.02 * (3.0 * t).sin() + 0.004 * (11.0 * t).sin();
    (0..rows).map(|row| path(1.0e-3 * f64::from(row))).collect()
}

/// A fitted model: effects with their nonlinear parameters and coefficients.
pub(crate) fn fitted(parts: &[(EffectName, f64, &[f64])]) -> Fitted {
    let part = |(name, parameter, _): &(EffectName, f64, &[f64])| {
        Part::declared(find(*name).unwrap(), *parameter)
    };
    let model = Model {
        parts: parts.iter().map(part).collect(),
    };
    let coefficients: Vec<f64> = parts.iter().flat_map(|(_, _, own)| own.to_vec()).collect();
    Fitted::new(model, &coefficients)
}
