//! Whether intervals hold the truth: what draws of records say of parameters whose truth is given.
//!
//! Per parameter: the share of the intervals that hold the truth; how far the median estimate is
//! off, alone and over the half of the central 95 % of the errors; the median half width, alone and
//! over the same; how many are not reported, how many are said not to be known, and how many have
//! no interval.

use std::collections::BTreeMap;

use axis_model::Estimate;

/// What a draw says of a parameter whose true size is given.
pub struct Draw {
    /// The machine.
    pub make: String,
    /// Of its motion and its noise.
    pub seed: u64,
    /// The parameter.
    pub name: &'static str,
    /// Its true size.
    pub truth: f64,
    /// What is said.
    pub said: Said,
}

/// What is said of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Said {
    /// Value, and the half width of its interval.
    Known(f64, f64),
    /// That the record does not know it.
    Unknown,
    /// Nothing.
    Nothing,
}

impl Said {
    /// What a table of parameters says of one.
    #[must_use]
    pub fn in_table(known: Option<&Estimate>, is_unknown: bool) -> Self {
        if is_unknown {
            return Self::Unknown;
        }
        known.map_or(Self::Nothing, Self::of)
    }

    /// An estimate.
    #[must_use]
    pub const fn of(estimate: &Estimate) -> Self {
        Self::Known(estimate.value, estimate.half_width())
    }
}

/// What was said of a parameter, beside its truth.
struct Beside {
    /// Estimate − truth.
    off: f64,
    /// Half width of the interval.
    half: f64,
    truth: f64,
}

impl Draw {
    /// What was said of it, where that is a value.
    fn beside(&self) -> Option<Beside> {
        let truth = self.truth;
        match self.said {
            Said::Known(value, half) => Some(Beside {
                off: value - truth,
                half,
                truth,
            }),
            Said::Unknown | Said::Nothing => None,
        }
    }
}

impl Beside {
    /// Whether it has an interval.
    fn has_interval(&self) -> bool {
        self.half > 0.0
    }

    /// Whether its interval holds the truth.
    fn holds(&self) -> bool {
        self.off.abs() <= self.half
    }
}

/// The draws whose interval does not hold the truth, with how many half widths they are off.
pub fn missed(drawn: &[Draw]) -> impl Iterator<Item = String> {
    drawn.iter().filter_map(|draw| {
        let beside = draw.beside()?;
        let Beside { off, half, truth } = beside;
        let (make, seed, name) = (&draw.make, draw.seed, draw.name);
        (beside.has_interval() && !beside.holds()).then(|| {
            let (value, off) = (truth + off, off.abs() / half);
            format!("{make} {seed}: {name} {value:.5e} ± {half:.2e} for {truth:.5e}, {off:.1} off")
        })
    })
}

/// Prints the table: each parameter over all machines, on each of them, and all together.
pub fn print(drawn: &[Draw]) {
    println!(
        "| parameter | draws | held, % | off | half width | not reported | unknown | no interval |\n|---|---|---|---|---|---|---|---|"
    );
    let mut of_name: BTreeMap<(&str, &str), Vec<&Draw>> = BTreeMap::new();
    for draw in drawn {
        for make in ["all", &draw.make] {
            of_name.entry((draw.name, make)).or_default().push(draw);
        }
    }
    for ((name, make), draws) in of_name {
        println!("{}", row(&format!("{name} {make}"), &draws));
    }
    let all: Vec<&Draw> = drawn.iter().collect();
    println!("{}", row("all", &all));
}

fn row(name: &str, draws: &[&Draw]) -> String {
    let are = |said: Said| draws.iter().filter(|draw| draw.said == said).count();
    let all: Vec<Beside> = draws.iter().filter_map(|draw| draw.beside()).collect();
    let with: Vec<&Beside> = all.iter().filter(|one| one.has_interval()).collect();
    let held = with.iter().filter(|one| one.holds()).count();
    // A parameter whose truth is zero has no share of it: in its own unit, times a hundred.
    let share = |size: f64, truth: f64| size / if truth == 0.0 { 1.0 } else { truth.abs() };
    let off = sorted(with.iter().map(|one| share(one.off, one.truth)));
    let half = sorted(with.iter().map(|one| share(one.half, one.truth)));
    let range = 0.5 * (at(&off, 0.975) - at(&off, 0.025));
    format!(
        "| {name} | {} | {:.1} | {:+.3}% {:.2} | {:.3}% {:.2} | {} | {} | {} |",
        draws.len(),
        100.0 * held as f64 / with.len().max(1) as f64,
        100.0 * at(&off, 0.5),
        at(&off, 0.5) / range,
        100.0 * at(&half, 0.5),
        at(&half, 0.5) / range,
        are(Said::Nothing),
        are(Said::Unknown),
        all.len() - with.len()
    )
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The value below which a part of them lies.
fn at(sorted: &[f64], part: f64) -> f64 {
    let place = part * (sorted.len().max(1) - 1) as f64;
    let value = sorted.get(place.round() as usize);
    value.copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_table_calls_unknown_is_not_known_for_a_value_elsewhere() {
        let own = Estimate::about(2.0, 1.5, "m");
        assert_eq!(Said::in_table(Some(&own), true), Said::Unknown);
        assert_eq!(Said::in_table(Some(&own), false), Said::Known(2.0, 1.5));
        assert_eq!(Said::in_table(None, false), Said::Nothing);
    }

    #[test]
    fn a_row_counts_what_holds_what_is_not_said_and_what_has_no_interval() {
        let said = [
            Said::Known(101.0, 2.0),
            Said::Known(103.0, 2.0),
            Said::Known(99.0, 2.0),
            Said::Known(100.0, 0.0),
            Said::Nothing,
            Said::Unknown,
        ];
        let draws = said.map(|said| Draw {
            make: "a".into(),
            seed: 1,
            name: "inertia",
            truth: 100.0,
            said,
        });
        let missed: Vec<String> = missed(&draws).collect();
        assert_eq!(
            missed,
            ["a 1: inertia 1.03000e2 ± 2.00e0 for 1.00000e2, 1.5 off"]
        );
        let draws: Vec<&Draw> = draws.iter().collect();
        // Errors −1, 1 and 3 %: the half of their range is 2 %.
        let wanted = "| inertia | 6 | 66.7 | +1.000% 0.50 | 2.000% 1.00 | 1 | 1 | 1 |";
        assert_eq!(row("inertia", &draws), wanted);
    }
}
