//! Circles at other feeds, without and with what was taken: a compensation is worth what it is at
//! every feed.

use serde::Serialize;

use crate::circle_test::{self, CircleRun};
use crate::compensation::AxisCompensation;
use crate::error::Outcome;
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
    /// Circular deviation G without compensation, µm.
    pub circular_deviation_g_before_um: f64,
    /// Circular deviation G with it, µm.
    pub circular_deviation_g_after_um: f64,
}

impl AtFeed {
    fn of([before, after]: [&CircleRun; 2]) -> Self {
        let [one, other] = [&before.report.figures, &after.report.figures];
        Self {
            feed_mm_min: before.report.feed_mm_min,
            burst_before_um: one.peak_max_um,
            burst_after_um: other.peak_max_um,
            circular_deviation_g_before_um: one.circular_deviation_g_um,
            circular_deviation_g_after_um: other.circular_deviation_g_um,
        }
    }

    /// How much smaller the burst is, percent.
    #[must_use]
    pub fn reduction_percent(&self) -> f64 {
        less_percent(self.burst_before_um, self.burst_after_um)
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
}

/// The circle that was run, and those at other feeds within the limits of the machine. One that
/// breaks off, where a motor is too weak for its limits, is told.
///
/// # Errors
/// Where the operator interrupts.
pub fn run(
    stand: &Stand<'_>,
    known: [&CircleRun; 2],
    circle: &Circle,
    compensation: &[AxisCompensation],
) -> Outcome<Feeds> {
    let mut feeds = vec![AtFeed::of(known)];
    let mut broke_off = Vec::new();
    let others = OTHERS.into_iter();
    for other in others.filter_map(|share| at_share_of_feed(stand.machine, circle, share)) {
        let run = |own: &[AxisCompensation]| circle_test::run(stand, &other, own, None);
        let pair = run(&stand.uncompensated())
            .map_err(|why| ("without compensation", why))
            .and_then(|before| {
                let after = run(compensation).map_err(|why| ("with the compensation", why))?;
                Ok(AtFeed::of([&before, &after]))
            });
        stand.interrupt.check()?;
        match pair {
            Ok(at) => feeds.push(at),
            Err((which, why)) => broke_off.push(format!(
                "F {:.0} mm/min: the circle {which} broke off: {why}",
                6.0e4 * other.feed_m_per_s
            )),
        }
    }
    feeds.sort_by(|one, other| one.feed_mm_min.total_cmp(&other.feed_mm_min));
    Ok(Feeds {
        run: feeds,
        broke_off,
    })
}

/// Prints the circles at several feeds.
pub fn print(feeds: &Feeds) {
    println!("feed, mm/min   burst before, µm   after, µm   less, %   G before, µm   after, µm");
    for at in &feeds.run {
        println!(
            "{:>12.0} {:>18.2} {:>11.2} {:>9.1} {:>14.2} {:>11.2}",
            at.feed_mm_min,
            at.burst_before_um,
            at.burst_after_um,
            at.reduction_percent(),
            at.circular_deviation_g_before_um,
            at.circular_deviation_g_after_um
        );
    }
    for sentence in &feeds.broke_off {
        println!("{sentence}");
    }
}
