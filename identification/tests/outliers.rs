//! A few bad rows do not change what is found.

use std::fmt::Write;

use axis_model::EffectName;
use identification::{Dataset, Report, identify};

const ROWS: usize = 20_000;

/// Path, m: slow and fast, so that a Stribeck fall and the mass show.
fn path(t: f64) -> f64 {
    0.03 * (0.7 * t).sin() + 0.004 * (7.3 * t).sin()
}

/// 50 kg, 200 N s/m and 40 N of friction, at breakaway 30 N more, which fall over 8 mm/s.
fn effort(t: f64, noise: f64) -> f64 {
    let step = 1.0e-4;
    let velocity = (path(t + step) - path(t - step)) / (2.0 * step);
    let acceleration = (path(t + step) - 2.0 * path(t) + path(t - step)) / step.powi(2);
    let fall = 30.0 * (-(velocity / 8.0e-3).powi(2)).exp();
    50.0 * acceleration + 200.0 * velocity + (40.0 + fall) * velocity.signum() + noise
}

/// The report of a record with bad rows, each with what is added to its effort and its position.
fn report(bad: &[(usize, f64, f64)]) -> Report {
    let folder = tempfile::tempdir().unwrap();
    let form = "[axis]\nencoder_resolution_m = 1e-7\n";
    std::fs::write(folder.path().join("dataset.toml"), form).unwrap();
    let mut text = String::from("time_s,position_m,force_n\n");
    for row in 0..ROWS {
        let t = 1.0e-3 * row as f64;
        let noise = 0.3 * (1.0e4 * (row as f64 * 12.9898).sin()).fract();
        let added = bad.iter().find(|(at, ..)| *at == row);
        let (more_n, more_m) = added.map_or((0.0, 0.0), |(_, force, way)| (*force, *way));
        let position = 1.0e-7 * ((path(t) + more_m) / 1.0e-7).round();
        writeln!(text, "{t},{position:.7},{:.4}", effort(t, noise) + more_n).unwrap();
    }
    std::fs::write(folder.path().join("train.csv"), text).unwrap();
    let dataset = Dataset::read(folder.path(), None, None).unwrap();
    identify(&dataset, &mut |_| ()).unwrap().report
}

#[test]
fn eight_spikes_of_the_effort_and_two_of_the_position_change_no_name_and_hardly_the_error() {
    let clean = report(&[]);
    assert_eq!(clean.found, [EffectName::Stribeck.as_str()]);
    let spikes = [1103, 2441, 4017, 5333, 6871, 8209, 9907, 12_345];
    let mut bad: Vec<(usize, f64, f64)> = spikes.map(|row| (row, 2500.0, 0.0)).to_vec();
    bad.extend([(3203, 0.0, 1.0e-3), (16_001, 0.0, -2.0e-4)]);
    let spoilt = report(&bad);
    assert_eq!(spoilt.found, clean.found);
    assert_eq!(spoilt.verdict, clean.verdict);
    for (spoilt, clean) in [
        (&spoilt.train, &clean.train),
        (&spoilt.validate, &clean.validate),
    ] {
        let ratio = spoilt.force_error_after_percent / clean.force_error_after_percent;
        assert!((0.98..1.02).contains(&ratio), "{ratio}");
    }
    let said = |words: &str| {
        spoilt
            .warnings
            .iter()
            .any(|warning| warning.starts_with(words))
    };
    assert!(
        said("8 outliers in the effort left out"),
        "{:?}",
        spoilt.warnings
    );
    assert!(
        said("2 outliers in the position left out"),
        "{:?}",
        spoilt.warnings
    );
    assert!(
        !clean
            .warnings
            .iter()
            .any(|warning| warning.contains("outlier"))
    );
}
