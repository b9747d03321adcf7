//! Circles at other feeds, without and with what is tried: a compensation is worth what it is at
//! every feed.

use identification::figures;
use serde::Serialize;

use crate::circle_test::{self, CircleRun};
use crate::compensation::AxisCompensation;
use crate::console::print_table;
use crate::error::{Failure, Outcome};
use crate::presentation::plots::{Curve, Ink, Plot, curves};
use crate::presentation::result_tables::{TextTable, head};
use crate::say;
use crate::session::Stand;
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::at_share_of_feed;

/// Feeds beside that of the circle, as shares of it.
const OTHERS: [f64; 2] = [0.25, 4.0];

/// A feed, and the circle at it.
#[derive(Clone, Debug, Serialize)]
pub struct AtFeed {
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// Largest burst without compensation, µm.
    pub burst_before_um: f64,
    /// Largest burst with it, µm.
    pub burst_after_um: f64,
    /// Largest spike of both directions without compensation, µm.
    pub spike_before_um: f64,
    /// Largest spike with it, µm.
    pub spike_after_um: f64,
    /// Circular deviation G of both directions without compensation, µm.
    pub circular_deviation_g_before_um: f64,
    /// Circular deviation G of both directions with it, µm.
    pub circular_deviation_g_after_um: f64,
}

impl AtFeed {
    fn of([before, after]: [&CircleRun; 2]) -> Self {
        let [one, other] = [&before.report.figures, &after.report.figures];
        Self {
            feed_mm_min: before.report.feed_mm_min,
            burst_before_um: one.peak_max_um,
            burst_after_um: other.peak_max_um,
            spike_before_um: before.report.spike_um(),
            spike_after_um: after.report.spike_um(),
            circular_deviation_g_before_um: before.report.roundness.circular_deviation_g_both_um,
            circular_deviation_g_after_um: after.report.roundness.circular_deviation_g_both_um,
        }
    }

    /// How much smaller the spike is, percent.
    #[must_use]
    pub fn reduction_percent(&self) -> f64 {
        less_percent(self.spike_before_um, self.spike_after_um)
    }
}

/// How much less is left of something, percent.
#[must_use]
pub fn less_percent(before: f64, after: f64) -> f64 {
    100.0 * (1.0 - after / before)
}

/// Circles at several feeds.
#[derive(Clone, Debug, Default)]
pub struct Feeds {
    /// By feed.
    pub run: Vec<AtFeed>,
    /// A sentence on each feed at which a circle broke off.
    pub broke_off: Vec<String>,
    /// That of the first one that broke off with the compensation and not without it.
    breaks_off: Option<String>,
}

/// Circles at other feeds than one, within the limits of the machine, without compensation.
pub struct OtherFeeds<'a> {
    stand: &'a Stand<'a>,
    before: Vec<(Circle, Outcome<CircleRun>)>,
}

impl<'a> OtherFeeds<'a> {
    /// Runs them. One that breaks off, where a motor is too weak for its limits, is told.
    ///
    /// # Errors
    /// Where the operator interrupts.
    pub fn run(stand: &'a Stand<'a>, circle: &Circle) -> Outcome<Self> {
        let others = OTHERS.into_iter();
        let others = others.filter_map(|share| at_share_of_feed(stand.machine, circle, share));
        let mut before = Vec::new();
        for other in others {
            let run = circle_test::run(stand, &other, &stand.uncompensated(), None);
            stand.interrupt.check()?;
            before.push((other, run));
        }
        Ok(Self { stand, before })
    }

    /// The same with a compensation.
    ///
    /// # Errors
    /// Where the operator interrupts.
    pub fn with(&self, compensation: &[AxisCompensation]) -> Outcome<Feeds> {
        let mut feeds = Feeds::default();
        for (circle, before) in &self.before {
            let broke_off = |which: &str, why: &Failure| {
                let feed_mm_min = 6.0e4 * circle.feed_m_per_s;
                format!("F {feed_mm_min:.0} mm/min: the circle {which} broke off: {why}")
            };
            let before = match before {
                Ok(before) => before,
                Err(why) => {
                    feeds.broke_off.push(broke_off("without compensation", why));
                    continue;
                }
            };
            let after = circle_test::run(self.stand, circle, compensation, None);
            self.stand.interrupt.check()?;
            match after {
                Ok(after) => feeds.run.push(AtFeed::of([before, &after])),
                Err(why) => {
                    let sentence = broke_off("with the compensation", &why);
                    feeds.breaks_off.get_or_insert_with(|| sentence.clone());
                    feeds.broke_off.push(sentence);
                }
            }
        }
        Ok(feeds)
    }
}

/// A circle becomes worse with a compensation where spike or circular deviation grow by more than
/// this share of them and this much, µm: noise alone does as much.
const WORSE: (f64, f64) = (0.1, 0.2);

impl Feeds {
    /// The same with the circle itself, without and with it.
    #[must_use]
    pub fn and(mut self, known: [&CircleRun; 2]) -> Self {
        self.run.push(AtFeed::of(known));
        let feed = |at: &AtFeed| at.feed_mm_min;
        self.run
            .sort_by(|one, other| feed(one).total_cmp(&feed(other)));
        self
    }

    /// In a sentence at which feed a circle is worse than without; `None` where none is.
    #[must_use]
    pub fn harm(&self) -> Option<String> {
        let worse = || self.run.iter().find_map(AtFeed::harm);
        self.breaks_off.clone().or_else(worse)
    }
}

impl AtFeed {
    fn harm(&self) -> Option<String> {
        // What is lost, where it was there without, may be anything.
        let is_worse = |before: f64, after: f64| {
            let is_lost = after.is_nan() && !before.is_nan();
            is_lost || after > (1.0 + WORSE.0) * before + WORSE.1
        };
        let both = [
            ("reversal spike", self.spike_before_um, self.spike_after_um),
            (
                "circular deviation G",
                self.circular_deviation_g_before_um,
                self.circular_deviation_g_after_um,
            ),
        ];
        let mut both = both.into_iter();
        let (what, before, after) = both.find(|(_, before, after)| is_worse(*before, *after))?;
        let feed = format!("at F {:.0} mm/min the {what}", self.feed_mm_min);
        let before = figures::error(before);
        if after.is_nan() {
            return Some(format!("{feed} is lost, {before} µm without"));
        }
        let after = figures::error(after);
        Some(format!("{feed} would be {after} instead of {before} µm"))
    }
}

/// Circles at several feeds.
#[must_use]
pub fn table(feeds: &Feeds) -> TextTable {
    let of_feed = |at: &AtFeed| {
        let mut cells = vec![format!("{:.0}", at.feed_mm_min)];
        cells.extend(
            [
                at.spike_before_um,
                at.spike_after_um,
                at.reduction_percent(),
                at.circular_deviation_g_before_um,
                at.circular_deviation_g_after_um,
            ]
            .map(figures::error),
        );
        cells
    };
    let mut rows = vec![head([
        "feed, mm/min",
        "spike before, µm",
        "spike after, µm",
        "less, %",
        "G before, µm",
        "G after, µm",
    ])];
    rows.extend(feeds.run.iter().map(of_feed));
    rows
}

/// Burst and circular deviation against feed, before and after.
#[must_use]
pub fn picture(feeds: &Feeds) -> String {
    let over_feed = |name: &str, ink: Ink, value: fn(&AtFeed) -> f64| {
        let points = feeds.run.iter().map(|at| (at.feed_mm_min, value(at)));
        Curve::line(name, ink, points)
    };
    let list = [
        over_feed("spike before", Ink::Before, |at| at.spike_before_um),
        over_feed("spike after", Ink::After, |at| at.spike_after_um),
        over_feed("G before", Ink::Other(2), |at| {
            at.circular_deviation_g_before_um
        }),
        over_feed("G after", Ink::Other(3), |at| {
            at.circular_deviation_g_after_um
        }),
    ];
    let plot = Plot {
        is_logarithmic: true,
        ..Plot::new(
            "Reversal spike and circular deviation G against feed",
            "feed, mm/min",
            "µm",
            (540.0, 270.0),
        )
    };
    curves(&plot, &list)
}

/// Prints the circles at several feeds.
pub fn print(feeds: &Feeds) {
    print_table(&table(feeds));
    for sentence in &feeds.broke_off {
        say!("{sentence}");
    }
}

#[cfg(test)]
impl Feeds {
    /// One feed, with such a spike without and with a compensation, µm.
    pub(super) fn with_spike([spike_before_um, spike_after_um]: [f64; 2]) -> Self {
        let at = AtFeed {
            feed_mm_min: 500.0,
            burst_before_um: spike_before_um,
            burst_after_um: spike_after_um,
            spike_before_um,
            spike_after_um,
            circular_deviation_g_before_um: 10.0,
            circular_deviation_g_after_um: 11.0,
        };
        Self {
            run: vec![at],
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_that_is_worse_or_lost_is_harm_and_one_that_was_lost_before_is_not() {
        let said = |spikes_um| Feeds::with_spike(spikes_um).harm();
        for harmless in [[8.0, 8.9], [0.1, 0.3], [8.0, 0.2], [f64::NAN, 9.0]] {
            assert_eq!(said(harmless), None);
        }
        for (harmful, told) in [
            ([8.0, 9.1], "would be 9.10 instead of 8.00 µm"),
            ([0.1, 0.4], "would be 0.400 instead of 0.100 µm"),
            ([8.0, f64::NAN], "is lost, 8.00 µm without"),
        ] {
            let wanted = format!("at F 500 mm/min the reversal spike {told}");
            assert_eq!(said(harmful), Some(wanted));
        }
    }

    #[test]
    fn a_circle_that_breaks_off_with_a_compensation_alone_is_harm() {
        let own = "F 500 mm/min: the circle with the compensation broke off";
        let other = "F 8000 mm/min: the circle without compensation broke off";
        let feeds = Feeds {
            broke_off: vec![own.into(), other.into()],
            breaks_off: Some(own.into()),
            ..Feeds::default()
        };
        assert_eq!(feeds.harm().as_deref(), Some(own));
        let feeds = Feeds {
            broke_off: vec![other.into()],
            ..Feeds::default()
        };
        assert_eq!(feeds.harm(), None);
    }
}
