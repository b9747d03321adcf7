//! The first page: what an engineer prints and signs.

use maud::{Markup, PreEscaped, html};

use super::page::{SIMULATION, table};
use super::result_tables::TextTable;

/// A pass or a fail against a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// What circular deviation G of both directions may be, µm.
    pub tolerance_um: f64,
    /// What it is, µm.
    pub is_um: f64,
    /// Whether a simulator has stood in for the machine.
    pub is_simulated: bool,
}

impl Judged {
    /// Whether the tolerance is kept.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.is_um <= self.tolerance_um
    }

    /// The verdict with its figures.
    #[must_use]
    pub fn sentence(&self) -> String {
        let (verdict, against) = if self.passes() {
            ("PASS", "within")
        } else {
            ("FAIL", "beyond")
        };
        let of = if self.is_simulated {
            " (simulated machine, nothing was measured)"
        } else {
            ""
        };
        format!(
            "{verdict}{of}: circular deviation G of both directions {:.3}\u{a0}µm, {against} the tolerance of {}\u{a0}µm, at this radius and feed",
            self.is_um, self.tolerance_um
        )
    }
}

/// Everything that stands on it.
pub struct Certificate<'a> {
    /// Machine.
    pub machine: &'a str,
    /// Whether a simulator has stood in for it.
    pub is_simulation: bool,
    /// The verdict, and whether it is a good one, where a tolerance was given.
    pub verdict: Option<(String, bool)>,
    /// The sentence that matters.
    pub sentence: &'a str,
    /// Date, program, test block: name and words.
    pub facts: &'a [(&'static str, String)],
    /// The circle.
    pub circle: &'a str,
    /// Figures by ISO 230-4.
    pub figures: &'a TextTable,
    /// Causes.
    pub causes: &'a TextTable,
    /// Burst and G against feed.
    pub feeds: &'a TextTable,
    /// What the drives have got: parameters, and a column for each axis.
    pub downloaded: &'a TextTable,
    /// By what the figures were measured, and how they are defined.
    pub notes: &'a [String],
}

/// What the program cannot know, to be filled in by hand.
const BLANKS: [&str; 8] = [
    "machine type and serial number",
    "instrument and its calibration",
    "temperature, °C; warm-up",
    "centre of the circle, other axes at",
    "tolerance agreed with",
    "tested by",
    "date",
    "signature",
];

impl Certificate<'_> {
    /// The page.
    #[must_use]
    pub fn markup(&self) -> Markup {
        html! {
            section.certificate {
                header { h1 { "Circular test and reversal compensation" } div { "machine " b { (self.machine) } } }
                @if self.is_simulation { div.simulation { (SIMULATION) } }
                @if let Some((verdict, is_good)) = &self.verdict {
                    p class={ "verdict " @if *is_good { "pass" } @else { "fail" } } { (verdict) }
                }
                p.key { b { (self.sentence) } }
                div.facts { @for (name, words) in self.facts { div { span.dt { (name) } span { (words) } } } }
                div.columns {
                    figure { (PreEscaped(self.circle)) }
                    div { h3 { "Circular deviation" } (table(self.figures)) h3 { "Against feed" } div.small { (table(self.feeds)) } }
                }
                div.columns {
                    div { h3 { "Causes, ranked by what they cost" } (table(self.causes)) }
                    div { h3 { "Downloaded to the drives" } div.small { (table(self.downloaded)) } }
                }
                ul.notes { @for note in self.notes { li { (note) } } }
                div.signature { @for blank in BLANKS { div { (blank) } } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deviation_at_the_tolerance_passes_and_one_beyond_it_fails() {
        for (is_um, passes, word) in [(5.0, true, "PASS"), (5.01, false, "FAIL")] {
            let judged = Judged {
                tolerance_um: 5.0,
                is_um,
                is_simulated: false,
            };
            assert_eq!(judged.passes(), passes);
            assert!(judged.sentence().starts_with(word));
        }
        let nothing = Judged {
            tolerance_um: 5.0,
            is_um: f64::NAN,
            is_simulated: true,
        };
        assert!(!nothing.passes());
    }
}
