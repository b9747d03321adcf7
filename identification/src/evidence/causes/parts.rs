//! Two parts that do not belong together: the halves of a record, or the two records.
//!
//! Each part is fitted alone. Inertia and Coulomb friction tell what happened: both by one factor
//! is a unit or a sign of the effort, inertia alone is a unit of the position (friction does not
//! know it), friction alone with its sign turned is a file that runs backwards.

use std::f64::consts::TAU;

use crate::evidence::causes::rigid::{Rigid, RigidFit};
use crate::evidence::causes::worth::{LARGEST_REST, WORTH_A_CAUSE, explains};
use crate::record::dataset::Dataset;

/// Places at which a record is split.
const PLACES: usize = 40;
/// Rows so near to a split are in neither part, s: the low-pass mixes them.
const GUARD_S: f64 = 0.05;
/// Factors within this share of each other are one. Coulomb friction changes by 15 % from day to
/// day.
const ALIKE: f64 = 0.25;
/// Factors inside this range are another day's, another load's or another amplifier's.
const USUAL: std::ops::Range<f64> = 0.7..1.4;
/// Inertia does not change from day to day: beyond this share it is another axis or another load.
const SAME_INERTIA: f64 = 0.05;

/// Inertia and Coulomb friction of one part over those of another.
#[derive(Clone, Copy, Debug)]
struct Ratio {
    inertia: f64,
    coulomb: f64,
}

impl Ratio {
    fn of(one: &RigidFit, other: &RigidFit) -> Self {
        let ratio = |place: usize| other.coefficients[place] / one.coefficients[place];
        Self {
            inertia: ratio(0),
            coulomb: ratio(2),
        }
    }

    /// The factor of the effort, where both have it and it is none that an axis makes.
    fn of_effort(self) -> Option<f64> {
        let is_one = (self.coulomb / self.inertia - 1.0).abs() < ALIKE;
        (is_one && !USUAL.contains(&self.inertia)).then_some(self.inertia)
    }

    /// The factor of the positions, where inertia alone has one.
    fn of_position(self) -> Option<f64> {
        let is_position = USUAL.contains(&self.coulomb) && !USUAL.contains(&self.inertia);
        (is_position && self.inertia > 0.0).then(|| 1.0 / self.inertia)
    }

    fn is_backwards(self) -> bool {
        USUAL.contains(&self.inertia) && USUAL.contains(&-self.coulomb)
    }
}

/// What two parts of a record show.
pub(crate) fn within(rigid: &Rigid, left: f64, column: &str) -> Option<String> {
    let split = Split::best(rigid)?;
    if !explains(left, split.left) {
        return None;
    }
    let (ratio, from_s) = (split.ratio, rigid.period_s * split.row as f64);
    if ratio.is_backwards() {
        return Some(format!(
            "from about {from_s:.1} s on the record runs backwards in time: friction has the other sign there"
        ));
    }
    let factor = ratio.of_effort()?;
    Some(format!(
        "from about {from_s:.1} s on {column} is {}; did its unit change?",
        times(factor)
    ))
}

/// Two parts, each fitted alone.
struct Split {
    row: usize,
    ratio: Ratio,
    /// The share of both that is left.
    left: f64,
}

impl Split {
    /// The split that leaves least: from place to place, and then about the best of them.
    fn best(rigid: &Rigid) -> Option<Self> {
        let step = rigid.len() / PLACES;
        let coarse = Self::best_of(rigid, (1..PLACES).map(|place| place * step))?;
        let from = coarse.row.saturating_sub(step);
        let fine = (0..2 * PLACES).map(|place| from + place * step / PLACES);
        Self::best_of(rigid, fine)
    }

    fn best_of(rigid: &Rigid, rows: impl Iterator<Item = usize>) -> Option<Self> {
        let splits = rows.filter_map(|row| Self::at(rigid, row));
        splits.min_by(|one, other| one.left.total_cmp(&other.left))
    }

    fn at(rigid: &Rigid, row: usize) -> Option<Self> {
        let guard = (GUARD_S / rigid.period_s).round() as usize;
        let one = rigid.fit_part(0..row.saturating_sub(guard))?;
        let other = rigid.fit_part(row + guard..rigid.len())?;
        let left = one.left * one.scatter + other.left * other.scatter;
        Some(Self {
            row,
            ratio: Ratio::of(&one, &other),
            left: left / (one.scatter + other.scatter),
        })
    }
}

/// What the validation record shows beside the training record.
pub(crate) fn of_validation(dataset: &Dataset, train: &Rigid, other: &Rigid) -> Option<String> {
    let (one, own) = (train.fit()?, other.fit()?);
    let by_train = other.left_by(one.coefficients);
    let fits_alone = one.left.max(own.left) <= LARGEST_REST * by_train;
    if by_train < WORTH_A_CAUSE || !fits_alone {
        return None;
    }
    let (ratio, column) = (Ratio::of(&one, &own), dataset.effort.column());
    let said = if let Some(factor) = ratio.of_effort() {
        format!(
            "{column} of the validation record is {}; check its unit",
            times(factor)
        )
    } else if let Some(factor) = ratio.of_position() {
        format!(
            "the positions of the validation record are {}; check their unit, lead or gear ratio",
            times(factor)
        )
    } else if (ratio.inertia - 1.0).abs() > SAME_INERTIA {
        format!(
            "the validation record has {:.2} times the inertia of the training record; is it of another axis, or with another load?",
            ratio.inertia
        )
    } else {
        return None;
    };
    Some(said)
}

/// Factors that have a name.
const NAMED: [(f64, &str); 3] = [
    (1000.0, "a thousand"),
    (TAU, "2 pi, as between radians and turns"),
    (360.0 / TAU, "180 / pi, as between degrees and radians"),
];

/// A factor in words.
fn times(factor: f64) -> String {
    let sign = if factor < 0.0 {
        ", with the other sign"
    } else {
        ""
    };
    let size = factor.abs();
    let is = |named: f64| (size / named - 1.0).abs() < 0.05 || (size * named - 1.0).abs() < 0.05;
    let named = NAMED.iter().find(|(named, _)| is(*named));
    let name = named.map_or(String::new(), |(_, name)| format!(" (a factor of {name})"));
    format!("{size:.3} times as large{name}{sign}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, USUAL as PARAMETERS, axis, usual};
    use crate::motion::kinematics::Kinematics;

    fn rigid(axis: &Axis) -> Rigid {
        Rigid::of(&axis.dataset, &axis.motion)
    }

    fn said_within(law: impl Fn(&Kinematics, usize) -> f64) -> String {
        let rigid = rigid(&axis(law));
        let left = rigid.fit().unwrap().left;
        within(&rigid, left, "force_n").unwrap_or_default()
    }

    /// The usual axis with factors of its inertia, and of both frictions.
    fn scaled(inertia: f64, viscous: f64, coulomb: f64) -> Axis {
        let [mass, b, c, offset] = PARAMETERS;
        axis(move |motion, row| {
            inertia * mass * motion.acceleration[row]
                + viscous * b * motion.velocity[row]
                + coulomb * c * motion.direction[row]
                + offset
        })
    }

    fn said_of(other: &Axis) -> String {
        let train = axis(usual);
        let said = of_validation(&train.dataset, &rigid(&train), &rigid(other));
        said.unwrap_or_default()
    }

    #[test]
    fn a_unit_that_changes_in_mid_record_is_told_with_its_factor_and_time() {
        let said = said_within(|motion, row| {
            let factor = if row < 3000 { 1.0 } else { 0.01 };
            factor * usual(motion, row)
        });
        assert!(
            said.starts_with("from about 3.0 s on force_n is 0.010 times"),
            "{said}"
        );
    }

    #[test]
    fn friction_that_turns_over_is_a_file_that_runs_backwards() {
        let [mass, b, c, _] = PARAMETERS;
        let said = said_within(|motion, row| {
            let sign = if row < 3000 { 1.0 } else { -1.0 };
            let friction = b * motion.velocity[row] + 4.0 * c * motion.direction[row];
            mass * motion.acceleration[row] + sign * friction
        });
        assert!(said.contains("runs backwards in time"), "{said}");
    }

    #[test]
    fn another_day_is_no_cause() {
        assert_eq!(said_of(&scaled(1.0, 0.9, 1.15)), "");
        assert_eq!(said_of(&scaled(1.0, 1.0, 1.0)), "");
    }

    #[test]
    fn a_validation_record_in_another_unit_or_of_another_axis_is_told() {
        for (factors, words) in [
            ([1000.0, 1000.0, 1000.0], "a factor of a thousand"),
            ([TAU, TAU, TAU], "2 pi"),
            ([-1.0, -1.0, -1.0], "with the other sign"),
            (
                [0.2, 0.2, 1.0],
                "positions of the validation record are 5.0",
            ),
            ([1.3, 1.0, 1.0], "another axis"),
            ([0.8, 1.0, 1.0], "another axis"),
        ] {
            let said = said_of(&scaled(factors[0], factors[1], factors[2]));
            assert!(said.contains(words), "{factors:?}: {said}");
        }
    }

    #[test]
    fn a_factor_has_its_name_either_way() {
        assert!(times(1.0e-3).ends_with("(a factor of a thousand)"));
        assert!(times(-1.0).ends_with("with the other sign"));
        assert_eq!(times(5.0), "5.000 times as large");
    }
}
