//! Slips of the pen in `dataset.toml`: keys that are nearly one that we know would be ignored
//! without a word.

use std::path::Path;

use super::{NUMBERS, section};

/// Keys that mean something and are no numbers, by section.
const OTHER_KEYS: [(&str, &[&str]); 4] = [
    (
        "",
        &[
            "name",
            "effort_hold",
            "time_from",
            "columns",
            "bus",
            "axis",
            "controller",
            "declared",
        ],
    ),
    ("axis", &["kind"]),
    ("controller", &["position_sensor", "velocity_sensor"]),
    ("declared", &["effects"]),
];
/// Most edits (Damerau–Levenshtein) between a key and one that was meant.
const TYPO: usize = 2;
/// The shortest key that is asked: short words are near each other (`note` and `name`).
const SHORTEST_KEY: usize = 7;

/// One note for each slip.
#[must_use]
pub(crate) fn notes(path: &Path, text: &str, table: &toml::Table) -> Vec<String> {
    let mut notes = Vec::new();
    for (name, others) in OTHER_KEYS {
        let known = known_keys(name, others);
        let keys = section(table, name)
            .into_iter()
            .flat_map(|part| part.keys());
        for key in keys {
            if let Some(meant) = meant(key, &known) {
                let line = line_of(text, key);
                notes.push(format!(
                    "{}:{line}: key {key} is not known and was ignored; did you mean {meant}?",
                    path.display()
                ));
            }
        }
    }
    notes
}

fn known_keys(section: &str, others: &[&'static str]) -> Vec<&'static str> {
    let numbers = NUMBERS.iter().filter(|number| number.section == section);
    others
        .iter()
        .copied()
        .chain(numbers.map(|number| number.key))
        .collect()
}

/// The known key that an unknown one is near to.
fn meant(key: &str, known: &[&'static str]) -> Option<&'static str> {
    if known.contains(&key) || key.len() < SHORTEST_KEY {
        return None;
    }
    let near = |known: &&str| strsim::damerau_levenshtein(key, known) <= TYPO;
    known.iter().copied().find(near)
}

fn line_of(text: &str, key: &str) -> usize {
    text.lines()
        .position(|line| line.trim_start().starts_with(key))
        .map_or(0, |at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn notes_of(text: &str) -> Vec<String> {
        notes(Path::new("dataset.toml"), text, &text.parse().unwrap())
    }

    #[test]
    fn a_key_within_two_edits_is_a_slip_and_three_are_another_word() {
        let slip = notes_of("licence = \"\"\nsample_perid_s = 1e-3\n");
        assert_eq!(slip.len(), 1);
        assert!(
            slip[0].starts_with("dataset.toml:2: key sample_perid_s"),
            "{slip:?}"
        );
        assert!(
            slip[0].ends_with("did you mean sample_period_s?"),
            "{slip:?}"
        );
        assert!(notes_of("sample_peri_m = 1e-3\n").is_empty());
    }

    #[test]
    fn a_section_knows_its_own_keys_only() {
        assert_eq!(notes_of("[controller]\nintegral_pers = 1\n").len(), 1);
        assert!(notes_of("[axis]\nintegral_per_s = 1\n").is_empty());
    }

    #[test]
    fn short_words_are_not_asked() {
        assert!(notes_of("note = \"name\"\ndeclard = 1\n").len() == 1);
    }
}
