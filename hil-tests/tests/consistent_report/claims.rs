//! The claims of a report that must agree, each with the cases in which it does not.

use identification::{Identification, Report};
use serde_json::Value;
use workbench::presentation::result_tables::{sentence, shown_table};

use super::written::{Table, Written};

/// A claim: what holds, and what contradicts it.
pub(crate) struct Claim {
    /// What holds.
    pub sentence: &'static str,
    /// The cases in which it does not.
    pub broken: fn(&Identification, &Written) -> Vec<String>,
}

/// All of them.
pub(crate) const ALL: [Claim; 10] = [
    Claim {
        sentence: "what was found are the accepted candidates",
        broken: found_are_accepted,
    },
    Claim {
        sentence: "each effect that was found has a row whose error falls",
        broken: found_show,
    },
    Claim {
        sentence: "an unexplained record says what is left",
        broken: unexplained_says_what,
    },
    Claim {
        sentence: "figures of a sentence stand in the report",
        broken: sentences_quote,
    },
    Claim {
        sentence: "a parameter has one value, and its output",
        broken: parameters_once,
    },
    Claim {
        sentence: "an interval holds its value",
        broken: intervals_hold,
    },
    Claim {
        sentence: "the model has the values of the report",
        broken: model_is_the_same,
    },
    Claim {
        sentence: "an error has at most three digits",
        broken: few_digits,
    },
    Claim {
        sentence: "a parameter has no digit that its interval does not bear",
        broken: digits_of_intervals,
    },
    Claim {
        sentence: "a table has a cell for each column, and a figure has no unit of its own",
        broken: tables_are_whole,
    },
];

fn found_are_accepted(result: &Identification, _: &Written) -> Vec<String> {
    let report = &result.report;
    let accepted = report.candidates.iter().filter(|one| one.accepted);
    let mut accepted: Vec<&String> = accepted.map(|one| &one.effect).collect();
    let mut found: Vec<&String> = report.found.iter().collect();
    accepted.sort();
    found.sort();
    let differ = accepted != found;
    differ
        .then(|| format!("{found:?}, {accepted:?}"))
        .into_iter()
        .collect()
}

fn found_show(result: &Identification, written: &Written) -> Vec<String> {
    let report = &result.report;
    let falls = |effect: &String| {
        let mut rows = report.shown.iter().filter(|row| row.effect == *effect);
        rows.any(|row| row.with < row.without)
    };
    let hidden = report.found.iter().filter(|effect| !falls(effect)).cloned();
    let table = written.table("effect").map(|table| table[1..].to_vec());
    let on_page = report.shown.is_empty() || table == Some(shown_table(report)[1..].to_vec());
    hidden
        .chain((!on_page).then(|| "the page has other rows".to_owned()))
        .collect()
}

fn unexplained_says_what(result: &Identification, written: &Written) -> Vec<String> {
    let report = &result.report;
    let says = !report.residual.looks_like.is_empty();
    let sentence = sentence(report);
    let on_page = written.paragraphs.contains(&sentence);
    let mut broken = Vec::new();
    if report.verdict == "unexplained" && !(says && sentence.contains("unexplained")) {
        broken.push(sentence.clone());
    }
    if !on_page {
        broken.push(format!("not on the page: {sentence}"));
    }
    broken
}

/// The numbers of a text, as it has them. A number that is part of a name or a unit does not count.
fn numbers(text: &str) -> Vec<String> {
    let words = text.split(|letter: char| letter.is_whitespace() || "(),;:".contains(letter));
    let is_number = |word: &&str| word.parse::<f64>().is_ok();
    words.filter(is_number).map(String::from).collect()
}

/// All numbers of the JSON form, and shares as percent and metres as micrometres.
fn figures(value: &Value, list: &mut Vec<f64>) {
    match value {
        Value::Number(number) => {
            let number = number.as_f64().unwrap_or(f64::NAN).abs();
            list.extend([1.0, 100.0, 1.0e6].map(|factor| factor * number));
        }
        Value::Array(values) => values.iter().for_each(|one| figures(one, list)),
        Value::Object(entries) => entries.values().for_each(|one| figures(one, list)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// Whether a number, rounded as the text has it, is one of a list.
fn stands(text: &str, list: &[f64]) -> bool {
    let number: f64 = text.parse::<f64>().unwrap_or(f64::NAN).abs();
    let digits = text
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    // Half a unit of the last place; a whole number may be rounded to three digits.
    let place = 0.5 * 10.0_f64.powi(-i32::try_from(digits).unwrap_or(0));
    let within = if digits == 0 {
        place.max(0.005 * number.abs())
    } else {
        place
    };
    list.iter()
        .any(|one| (one - number).abs() <= 1.001 * within)
}

/// Sentences that say why: the verdict's, and the remarks on reversals.
fn sentences_quote(result: &Identification, written: &Written) -> Vec<String> {
    let report = &result.report;
    let mut list = Vec::new();
    figures(&written.json, &mut list);
    let remarks = report.warnings.iter();
    let why = |text: &&String| {
        [
            "presliding: ",
            "backlash: ",
            "reversals: ",
            "presliding and",
        ]
        .iter()
        .any(|begin| text.starts_with(begin))
    };
    let texts = remarks.filter(why).chain([&report.residual.looks_like]);
    let texts: Vec<&String> = texts.collect();
    let strange = texts.iter().flat_map(|text| {
        let strange = numbers(text).into_iter().filter(|one| !stands(one, &list));
        strange.map(move |one| format!("{one} in: {text}"))
    });
    strange.collect()
}

/// Where the JSON form has a value with an interval.
fn estimates(path: &str, value: &Value, list: &mut Vec<String>) {
    let Some(entries) = value.as_object() else {
        return;
    };
    for (key, entry) in entries {
        if entry.get("low").is_some() && entry.get("high").is_some() {
            list.push(format!("{path}/{key}"));
        }
        estimates(&format!("{path}/{key}"), entry, list);
    }
}

fn parameters_once(result: &Identification, written: &Written) -> Vec<String> {
    let mut list = Vec::new();
    estimates("", &written.json, &mut list);
    let elsewhere = list
        .into_iter()
        .filter(|path| !path.starts_with("/parameters/"));
    let report = &result.report;
    let homeless = report.parameters.names();
    let homeless = homeless.filter(|name| !report.parameters_from.contains_key(*name));
    elsewhere.chain(homeless.cloned()).collect()
}

fn intervals_hold(result: &Identification, _: &Written) -> Vec<String> {
    let table = &result.report.parameters;
    let known = table.known.iter();
    let outside = known.filter(|(_, one)| !(one.low <= one.value && one.value <= one.high));
    let outside = outside.map(|(name, one)| format!("{name} {one:?}"));
    let unknown = table.unknown.iter();
    let turned = unknown.filter(|(_, one)| !(one.unknown && one.low <= one.high));
    outside
        .chain(turned.map(|(name, one)| format!("{name} {one:?}")))
        .collect()
}

fn model_is_the_same(result: &Identification, written: &Written) -> Vec<String> {
    let of_model = written.identified();
    let table = &result.report.parameters;
    let said_unknown = |name: &String| of_model.get(name)?.get("unknown")?.as_bool();
    let unknown = table.unknown.keys();
    let not_said = unknown.filter(|name| said_unknown(name) != Some(true));
    let rows = table.known.iter();
    let other = rows.filter(|(name, one)| {
        let number = |key: &str| of_model.get(*name)?.get(key)?.as_float();
        [("value", one.value), ("low", one.low), ("high", one.high)]
            .iter()
            .any(|(key, wanted)| number(key) != Some(*wanted))
    });
    other
        .map(|(name, _)| name)
        .chain(not_said)
        .cloned()
        .collect()
}

/// Digits of a number that mean something.
fn digits(text: &str) -> usize {
    let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
    let digits = mantissa
        .chars()
        .filter(char::is_ascii_digit)
        .collect::<String>();
    let digits = digits.trim_start_matches('0');
    if mantissa.contains('.') {
        digits.len()
    } else {
        digits.trim_end_matches('0').len()
    }
}

/// The tables of errors: all but those that have digits by their intervals.
fn errors(written: &Written) -> impl Iterator<Item = &Table> {
    let by_interval = |table: &&Table| !table[0].iter().any(|cell| cell == "low");
    written.tables.iter().filter(by_interval)
}

fn few_digits(_: &Identification, written: &Written) -> Vec<String> {
    let cells = errors(written).flat_map(|table| table[1..].iter().flatten());
    let long = cells.filter(|cell| cell.parse::<f64>().is_ok() && digits(cell) > 3);
    long.cloned().collect()
}

fn digits_of_intervals(result: &Identification, written: &Written) -> Vec<String> {
    let Some(table) = written.table("parameter") else {
        return vec!["no table of parameters".into()];
    };
    let known = table[1..].iter().filter(|row| row[1] != "unknown");
    let rows = known.filter(|row| !is_borne(row));
    let missing = (table.len() - 1 != result.report.parameters.names().count())
        .then(|| "the table has other rows".to_owned());
    rows.map(|row| row.join(" ")).chain(missing).collect()
}

/// Whether the half width of an interval has at most three digits to the last place of the value,
/// or a value without an interval has at most three digits.
fn is_borne(row: &[String]) -> bool {
    let numbers: Vec<f64> = row[1..4]
        .iter()
        .filter_map(|cell| cell.parse().ok())
        .collect();
    let [_, low, high] = numbers[..] else {
        return digits(&row[1]) <= 3;
    };
    let places = row[1..4].iter().map(|cell| last_place(cell));
    0.5 * (high - low) < 1000.0 * places.fold(f64::INFINITY, f64::min)
}

/// Worth of the last digit of a number that means something.
fn last_place(text: &str) -> f64 {
    let (mantissa, power) = text.split_once('e').unwrap_or((text, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    let zeros = mantissa.len() - mantissa.trim_end_matches('0').len();
    let place = match mantissa.split_once('.') {
        Some((_, decimals)) => -i32::try_from(decimals.len()).unwrap_or(0),
        None => i32::try_from(zeros).unwrap_or(0),
    };
    10.0_f64.powi(power + place)
}

fn tables_are_whole(_: &Identification, written: &Written) -> Vec<String> {
    let ragged = |table: &&Table| table.iter().any(|row| row.len() != table[0].len());
    let ragged = written
        .tables
        .iter()
        .filter(ragged)
        .map(|table| format!("{:?}", table[0]));
    let cells = written
        .tables
        .iter()
        .flat_map(|table| table[1..].iter().flatten());
    let strange = |cell: &&String| {
        ["NaN", "inf"].contains(&cell.as_str())
            || cell
                .split_once(' ')
                .is_some_and(|(number, _)| number.parse::<f64>().is_ok())
    };
    ragged.chain(cells.filter(strange).cloned()).collect()
}

#[test]
fn digits_are_those_that_mean_something() {
    for (text, wanted) in [
        ("0.00123", 3),
        ("1230", 3),
        ("1.230", 4),
        ("1.2e-5", 2),
        ("0", 0),
    ] {
        assert_eq!(digits(text), wanted, "{text}");
    }
}

#[test]
fn a_figure_stands_in_a_list_as_it_was_rounded() {
    let list = [5.547, 1234.0];
    assert!(stands("5.55", &list) && stands("1230", &list) && stands("6", &list));
    assert!(!stands("5.56", &list) && !stands("1250", &list));
    assert_eq!(
        numbers("a gap 5.55, a bristle (12 %) over x2"),
        ["5.55", "12"]
    );
}

#[test]
fn a_row_with_more_digits_than_its_interval_is_found() {
    let row = |cells: [&str; 4]| cells.map(String::from).to_vec();
    assert!(is_borne(&row(["coulomb", "182.6", "181.5", "183.7"])));
    assert!(!is_borne(&row([
        "coulomb", "182.6123", "181.5012", "183.7234"
    ])));
    assert!(is_borne(&row(["gap", "1.80e-5", "–", "–"])));
    assert!(!is_borne(&row(["gap", "1.8043e-5", "–", "–"])));
}

/// A report whose claims contradict each other.
#[test]
fn a_contradiction_is_seen() {
    let result = Identification {
        report: Report {
            found: vec!["stribeck".into()],
            ..Report::default()
        },
        ..Identification::default()
    };
    let written = Written {
        tables: Vec::new(),
        paragraphs: Vec::new(),
        model: toml::Table::new(),
        json: Value::Null,
    };
    assert_eq!(found_are_accepted(&result, &written).len(), 1);
    assert_eq!(found_show(&result, &written), ["stribeck"]);
    assert_eq!(unexplained_says_what(&result, &written).len(), 1);
}
