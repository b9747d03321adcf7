//! The reader of records takes anything without a panic: an error that names the file, or a
//! dataset.

use std::path::Path;

use identification::Dataset;
use proptest::prelude::*;

fn read(csv: &[u8], toml: &[u8], log: &[u8], dbc: &[u8]) -> Result<Dataset, String> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("train.csv", csv);
    write("dataset.toml", toml);
    write("train.log", log);
    write("a.dbc", dbc);
    Dataset::read(Path::new(folder.path()), None, None).map_err(|error| error.to_string())
}

/// Text that is nearly a record.
fn nearly_csv() -> impl Strategy<Value = String> {
    let cell = prop_oneof![
        8 => (-10.0..10.0_f64).prop_map(|value| value.to_string()),
        1 => Just("NaN".to_owned()),
        1 => Just(String::new()),
        1 => Just("1e999".to_owned()),
        1 => "[ -~]{0,6}",
    ];
    let row = prop::collection::vec(cell, 1..6).prop_map(|cells| cells.join(","));
    let header = prop_oneof![
        4 => Just("time_s,position_m,force_n".to_owned()),
        1 => Just("time_s,position_m,force_n,current_a".to_owned()),
        1 => "[a-z_,]{0,30}",
    ];
    (header, prop::collection::vec(row, 0..40))
        .prop_map(|(header, rows)| format!("{header}\n{}", rows.join("\n")))
}

/// Text that is nearly a log.
fn nearly_log() -> impl Strategy<Value = String> {
    let line = (any::<f64>(), "[0-9A-F]{0,9}", "[#0-9A-FR]{0,20}")
        .prop_map(|(time, id, data)| format!("({time}) can0 {id}#{data}"));
    prop::collection::vec(prop_oneof![4 => line, 1 => "[ -~]{0,40}"], 0..60)
        .prop_map(|lines| lines.join("\n"))
}

const BUS: &str = "sample_period_s = 0.001\n[bus]\ndbc = \"a.dbc\"\n[columns]\nposition_m = { name = \"F.X\", wraps_at = 16.0 }\nforce_n = \"F.Y\"\n";
const DBC: &str = "VERSION \"\"\nNS_ :\nBS_:\nBU_: A\nBO_ 401 F: 8 A\n SG_ X : 0|32@1- (1,0) [0|0] \"m\" A\n SG_ Y : 7|64@0+ (1,0) [0|0] \"m\" A\n";

proptest! {
    #[test]
    fn any_csv_is_read_or_refused(csv in nearly_csv(), toml in prop_oneof![Just(String::new()), "[ -~\n]{0,80}"]) {
        if let Err(error) = read(csv.as_bytes(), toml.as_bytes(), b"", b"") {
            prop_assert!(error.contains(".csv") || error.contains(".toml") || error.contains("declared"), "{error}");
            prop_assert_eq!(error.lines().count(), 1, "{}", error);
        }
    }

    #[test]
    fn any_log_is_read_or_refused(log in nearly_log(), dbc in prop_oneof![3 => Just(DBC.to_owned()), 1 => "[ -~\n]{0,60}"]) {
        let error = read(b"", BUS.as_bytes(), log.as_bytes(), dbc.as_bytes()).err();
        prop_assert!(error.is_some_and(|error| error.contains("train.log") || error.contains("a.dbc")));
    }

    #[test]
    fn any_bytes_are_read_or_refused(csv: Vec<u8>, toml: Vec<u8>, log: Vec<u8>) {
        prop_assert!(read(&csv, &toml, &log, DBC.as_bytes()).is_err());
    }
}
