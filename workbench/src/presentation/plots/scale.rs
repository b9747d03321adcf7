//! From values to pixels, and the values that stand at an axis.

/// A linear or logarithmic axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    from_px: f64,
    to_px: f64,
    is_logarithmic: bool,
}

impl Scale {
    /// An axis from `low` at `from_px` to `high` at `to_px`.
    pub(super) const fn linear((low, high): (f64, f64), (from_px, to_px): (f64, f64)) -> Self {
        Self {
            low,
            high,
            from_px,
            to_px,
            is_logarithmic: false,
        }
    }

    /// The same over the logarithm of values above zero.
    pub(super) const fn logarithmic(values: (f64, f64), places: (f64, f64)) -> Self {
        Self {
            is_logarithmic: true,
            ..Self::linear(values, places)
        }
    }

    /// The place of a value, px.
    pub(super) fn px(&self, value: f64) -> f64 {
        let share = if self.high <= self.low {
            0.5
        } else if self.is_logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.from_px + share * (self.to_px - self.from_px)
    }

    /// Whether a value is on the axis.
    pub(super) fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Round values on the axis with their words, about so many of them.
    pub(super) fn ticks(&self, about: f64) -> Vec<(f64, String)> {
        if self.is_logarithmic {
            return self.powers();
        }
        let step = nice_step((self.high - self.low) / about);
        let first = (self.low / step - 1.0e-9).ceil() * step;
        // An axis of one value has steps that it does not feel.
        let most = (about + 2.0) as u32 * 3;
        let values = (0..most).map(|number| first + f64::from(number) * step);
        let shown = values.take_while(|value| *value <= self.high + 1.0e-9 * step);
        shown.map(|value| (value, tick(value, step))).collect()
    }

    /// 1, 2 and 5 of every power of ten; 1 alone where those are many.
    fn powers(&self) -> Vec<(f64, String)> {
        let (first, last) = (self.low.log10().floor(), self.high.log10().ceil());
        let of_power: &[f64] = if last - first > 3.0 {
            &[1.0]
        } else {
            &[1.0, 2.0, 5.0]
        };
        let mut ticks = Vec::new();
        let mut power = first;
        while power <= last {
            let values = of_power.iter().map(|m| m * 10.0_f64.powf(power));
            ticks.extend(
                values
                    .filter(|value| self.holds(*value))
                    .map(|value| (value, tick(value, value))),
            );
            power += 1.0;
        }
        ticks
    }
}

/// A value whose neighbours are a step away, without digits that say nothing.
fn tick(value: f64, step: f64) -> String {
    let decimals = (-step.log10() + 1.0e-9).ceil().clamp(0.0, 15.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    match text.strip_prefix('-') {
        Some("0") => "0".into(),
        Some(size) => format!("−{size}"),
        None => text.into(),
    }
}

/// 1, 2 or 5 times a power of ten, at least `value`.
pub(super) fn nice_step(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.max(1.0e-12).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|step| *step >= value * (1.0 - 1.0e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_1_2_or_5_times_a_power_of_ten_and_never_less_than_asked_for() {
        for (value, step) in [
            (0.3, 0.5),
            (1.0, 1.0),
            (1.1, 2.0),
            (4.0, 5.0),
            (51.0, 100.0),
        ] {
            let got = nice_step(value);
            assert!((got / step - 1.0).abs() < 1.0e-9, "{value}: {got}");
        }
    }

    #[test]
    fn an_axis_of_one_value_has_an_end() {
        for value in [0.0, 1000.0, 1.0e6, -1.0e12] {
            let scale = Scale::linear((value, value), (0.0, 100.0));
            assert!(scale.ticks(5.0).len() < 30);
            assert_eq!(scale.px(value), 50.0);
        }
        assert_eq!(Scale::logarithmic((2.0, 2.0), (0.0, 100.0)).px(2.0), 50.0);
    }

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        let words = |scale: &Scale| -> Vec<String> {
            let ticks = scale.ticks(5.0).into_iter();
            ticks.map(|(_, word)| word).collect()
        };
        let scale = Scale::linear((-0.3, 0.3), (0.0, 100.0));
        assert_eq!(words(&scale), ["−0.2", "0", "0.2"]);
        let scale = Scale::linear((0.0, 100_000.0), (0.0, 100.0));
        assert_eq!(words(&scale)[5], "100000");
        let scale = Scale::logarithmic((0.3, 30.0), (0.0, 100.0));
        assert_eq!(words(&scale), ["0.5", "1", "2", "5", "10", "20"]);
        assert!((scale.px(3.0) - 50.0).abs() < 1.0e-9);
        let scale = Scale::logarithmic((0.01, 1.0e4), (0.0, 100.0));
        assert_eq!(words(&scale)[..3], ["0.01", "0.1", "1"]);
    }
}
