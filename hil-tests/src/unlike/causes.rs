//! What a sentence about a bad record has to say: one of the words that name what happened to it.

/// Bad records, and words of which one must be in the sentence.
#[rustfmt::skip] // One line for each record: the list is read across.
pub const CAUSES: &[(&str, &[&str])] = &[
    ("swap-reference-position", &["swapped"]),
    ("swap-position-load", &["swapped"]),
    ("swap-reference-load", &["swapped"]),
    ("swap-position-effort", &["swapped", "millimetres"]),
    ("swap-reference-effort", &["swapped", "another axis"]),
    ("effort-late-1", &["late"]),
    ("effort-early-1", &["early"]),
    ("effort-late-5", &["late"]),
    ("effort-late-50", &["late"]),
    ("load-late-5", &["late"]),
    ("effort-clock-fast", &["clock"]),
    ("effort-clock-slow", &["clock"]),
    ("time-in-milliseconds", &["another unit"]),
    ("time-doubled", &["time_s steps"]),
    ("load-clock-slow", &["clock"]),
    ("two-axes", &["several runs"]),
    ("two-axes-linear", &["several runs"]),
    ("two-runs", &["several runs", "stand in it twice"]),
    ("forty-runs", &["several runs", "stand in it twice"]),
    ("backwards", &["backwards", "several runs"]),
    ("position-in-millimetres", &["millimetres"]),
    ("load-in-millimetres", &["off by a thousand"]),
    ("position-in-turns", &["turns"]),
    ("position-by-lead", &["radians", "millimetres", "unit"]),
    ("load-by-gear", &["needs a scale", "gear"]),
    ("validation-effort-kilo", &["thousand"]),
    ("validation-effort-by-2pi", &["2 pi"]),
    ("half-effort-by-lead", &["unit"]),
    ("validation-position-by-gear", &["gear"]),
    ("effort-negative", &["other sign"]),
    ("position-negative", &["sign is swapped"]),
    ("load-negative", &["sign is swapped"]),
    ("reference-negative", &["sign is swapped"]),
    ("validation-effort-negative", &["other sign"]),
    ("effort-clipped", &["cut off"]),
    ("effort-rectified", &["cut off"]),
    ("position-clipped", &["cut off"]),
    ("position-wrapped", &["wraps", "jumps"]),
    ("effort-held", &["held"]),
    ("position-held", &["held"]),
    ("position-lines", &["interpolated"]),
    ("effort-averaged", &["mean", "late"]),
    ("load-held", &["held"]),
    ("rows-twice", &["doubles", "twice"]),
    ("tenth-row-twice", &["twice"]),
    ("block-twice", &["twice"]),
    ("rows-missing", &["missing"]),
    ("other-reference", &["another axis"]),
    ("other-position", &["another axis"]),
    ("other-load", &["another axis"]),
    ("other-effort", &["another axis"]),
    ("other-validation", &["another axis"]),
    ("effort-frozen", &["stands still"]),
    ("position-frozen", &["stands still"]),
    ("load-frozen", &["stands still"]),
];

/// The words of a bad record; none for a record that is not in the list.
#[must_use]
pub fn cause_words(record: &str) -> &'static [&'static str] {
    let row = CAUSES.iter().find(|(name, _)| *name == record);
    row.map_or(&[], |(_, words)| words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use makes::spoilt::SPOILT;

    #[test]
    fn every_bad_record_has_its_words_and_nothing_else_has() {
        let made: Vec<&str> = SPOILT.iter().map(|bad| bad.name).collect();
        let told: Vec<&str> = CAUSES.iter().map(|(name, _)| *name).collect();
        assert_eq!(told, made);
        assert!(CAUSES.iter().all(|(_, words)| !words.is_empty()));
    }
}
