//! What was said of a record, beside what is true of it: a row of the golden page.
//!
//! Rules of judgement:
//!
//! | table | right is |
//! |---|---|
//! | makes, clean | the names exactly, and the verdict |
//! | outside | `unexplained`, or exactly the effect's own name |
//! | spoilt | refused or `unexplained`, with the cause in the sentence; or a name that says it |
//!
//! Two names of one force count as one. Where a make's effect has another shape than the equation
//! of its name, `unexplained` is right beside it.

use makes::truth::{Effect, Truth, Verdict};

use crate::confusion::Names;
use crate::unlike::causes::cause_words;

/// The word of a record that was not taken.
pub const REFUSED: &str = "refused";
const EXPLAINED: &str = "explained";
const UNEXPLAINED: &str = "unexplained";

/// What was said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// Names.
    pub named: Names,
    /// `explained`, `unexplained` or `refused`.
    pub verdict: String,
    /// Force error of the extended model on the training record, percent.
    pub left_percent: Option<f64>,
    /// What the rest looks like, or why it was refused.
    pub words: String,
}

/// How the names are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// What is true and nothing else.
    Exact,
    /// Something that is not true.
    False,
    /// Nothing that is not true, and not all that is.
    Missed,
}

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Table.
    pub table: String,
    /// Record.
    pub record: String,
    /// Form of a make's record.
    pub form: String,
    /// What is true.
    pub hidden: Names,
    /// What was said.
    pub said: Said,
    /// How the names are.
    pub naming: Naming,
    /// Whether the verdict is right.
    pub verdict_is_right: bool,
    /// Whether the whole is right.
    pub is_right: bool,
}

impl Row {
    /// Judges what was said.
    #[must_use]
    pub fn of(table: &str, record: &str, truth: &Truth, said: Said) -> Self {
        let hidden: Names = truth.effects.iter().map(|effect| effect.name()).collect();
        let naming = naming(truth, &hidden, &said.named);
        let verdict_is_right = verdict_is_right(truth, naming, &said);
        let is_right = match table {
            "outside" => verdict_is_right,
            "spoilt" => verdict_is_right && cause_is_named(record, naming, &said),
            _ => verdict_is_right && naming == Naming::Exact,
        };
        Self {
            table: table.into(),
            record: record.into(),
            form: truth.form.clone(),
            hidden,
            said,
            naming,
            verdict_is_right,
            is_right,
        }
    }
}

fn naming(truth: &Truth, hidden: &Names, named: &Names) -> Naming {
    let one_name = |names: &Names| -> Names {
        let same = |name: &String| {
            let pair = truth.same_force.iter().find(|(one, _)| one.name() == *name);
            pair.map_or_else(
                || name.clone(),
                |(_, other): &(Effect, Effect)| other.name(),
            )
        };
        names.iter().map(same).collect()
    };
    let (hidden, named) = (one_name(hidden), one_name(named));
    match (hidden == named, named.is_subset(&hidden)) {
        (true, _) => Naming::Exact,
        (_, true) => Naming::Missed,
        _ => Naming::False,
    }
}

fn verdict_is_right(truth: &Truth, naming: Naming, said: &Said) -> bool {
    let own_name = naming == Naming::Exact && !truth.effects.is_empty();
    match truth.verdict {
        Verdict::Explained => {
            said.verdict == EXPLAINED || truth.or_unexplained && said.verdict == UNEXPLAINED
        }
        Verdict::Unexplained | Verdict::RefusedOrUnexplained => {
            own_name || said.verdict != EXPLAINED
        }
    }
}

/// Whether a sentence, or the effect's own name, says what happened to a bad record.
fn cause_is_named(record: &str, naming: Naming, said: &Said) -> bool {
    let is_name = naming == Naming::Exact && !said.named.is_empty();
    is_name
        || cause_words(record)
            .iter()
            .any(|word| said.words.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unlike::causes::CAUSES;

    fn truth(effects: &[Effect], verdict: Verdict) -> Truth {
        Truth {
            make: "a".into(),
            form: "hidden".into(),
            effects: effects.to_vec(),
            verdict,
            or_unexplained: false,
            same_force: vec![(Effect::Offset, Effect::CoulombAsymmetry)],
            declared: Vec::new(),
            oracle: Vec::new(),
            parameters: Vec::new(),
            cause: String::new(),
        }
    }

    fn said(named: &[&str], verdict: &str, words: &str) -> Said {
        Said {
            named: named.iter().map(|name| (*name).to_owned()).collect(),
            verdict: verdict.into(),
            left_percent: Some(1.0),
            words: words.into(),
        }
    }

    fn is_right(table: &str, truth: &Truth, said: Said) -> bool {
        Row::of(table, "a", truth, said).is_right
    }

    #[test]
    fn of_a_make_the_names_and_the_verdict_are_asked() {
        let one = truth(&[Effect::Delay], Verdict::Explained);
        assert!(is_right("makes", &one, said(&["delay"], "explained", "")));
        assert!(!is_right(
            "makes",
            &one,
            said(&["delay"], "unexplained", "")
        ));
        assert!(!is_right("makes", &one, said(&[], "explained", "")));
        assert!(!is_right(
            "makes",
            &one,
            said(&["delay", "stribeck"], "explained", "")
        ));
        let loose = Truth {
            or_unexplained: true,
            ..one
        };
        assert!(is_right(
            "makes",
            &loose,
            said(&["delay"], "unexplained", "")
        ));
        assert!(!is_right("makes", &loose, said(&["delay"], "refused", "")));
    }

    #[test]
    fn names_are_exact_missed_or_false_and_one_force_has_two_names() {
        let one = truth(
            &[Effect::CoulombAsymmetry, Effect::Delay],
            Verdict::Explained,
        );
        let naming =
            |named: &[&str]| Row::of("makes", "a", &one, said(named, "explained", "")).naming;
        assert_eq!(naming(&["offset", "delay"]), Naming::Exact);
        assert_eq!(naming(&["delay"]), Naming::Missed);
        assert_eq!(naming(&["delay", "hum"]), Naming::False);
    }

    #[test]
    fn a_disturbance_outside_the_list_is_unexplained_or_has_its_own_name() {
        let payload = truth(&[Effect::Payload], Verdict::Unexplained);
        assert!(is_right("outside", &payload, said(&[], "unexplained", "")));
        assert!(is_right(
            "outside",
            &payload,
            said(&["stribeck"], "unexplained", "")
        ));
        assert!(is_right(
            "outside",
            &payload,
            said(&["payload"], "explained", "")
        ));
        assert!(!is_right(
            "outside",
            &payload,
            said(&["stribeck"], "explained", "")
        ));
        let nameless = truth(&[], Verdict::Unexplained);
        assert!(!is_right("outside", &nameless, said(&[], "explained", "")));
    }

    #[test]
    fn of_a_bad_record_the_cause_is_asked() {
        let (record, words) = CAUSES[0];
        let bad = truth(&[], Verdict::RefusedOrUnexplained);
        let right = |said: Said| Row::of("spoilt", record, &bad, said).is_right;
        assert!(right(said(&[], "refused", words[0])));
        assert!(right(said(&["delay"], "unexplained", words[0])));
        assert!(!right(said(&[], "refused", "no")));
        assert!(!right(said(&[], "explained", words[0])));
    }
}
