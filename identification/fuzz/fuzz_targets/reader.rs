//! Any bytes as a record, `dataset.toml`, bus log and DBC: read or refused, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|parts: (&[u8], &[u8], &[u8], &[u8])| {
    let Ok(folder) = tempfile::tempdir() else { return };
    let (csv, toml, log, dbc) = parts;
    for (name, bytes) in [("train.csv", csv), ("dataset.toml", toml), ("train.log", log), ("a.dbc", dbc)] {
        if std::fs::write(folder.path().join(name), bytes).is_err() {
            return;
        }
    }
    let _ = identification::Dataset::read(folder.path(), None, None);
});
