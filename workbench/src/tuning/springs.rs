//! Springs that slip, of both sides of a screw, as the elements of the drive.
//!
//! ```text
//! V(x) = Vt(x) + Vm(x + Vt(x) / K)
//! ```
//!
//! Friction of the table winds the screw up, and the motor goes that way in addition to the
//! table's. So friction of the motor's own side turns over within a shorter way of the table than
//! of the motor. Vt and Vm are curves of force over the way from rest, concave, and so is V: it is
//! that of elements, which slip where V bends. After a reversal all ways and forces are twice as
//! large (Masing), in V as in what it is made of.

use crate::compensation::ELEMENTS;
use crate::model_file::MotorSide;

/// A spring that slips: its level, N, and the way from rest after which it does, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Level.
    pub level_n: f64,
    /// Way from rest.
    pub way_m: f64,
}

impl Spring {
    fn stiffness_n_per_m(self) -> f64 {
        self.level_n / self.way_m
    }
}

/// Springs of either side of the screw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Springs {
    /// Those of the table, over its way.
    pub table: Vec<Spring>,
    /// Those of the motor's own side, over the way of the motor.
    pub motor: Vec<Spring>,
    /// Share of friction that is a bristle's at the table, which comes to another level within its
    /// deflection; of the fall, where that of either side is known.
    pub bristle_share: f64,
}

/// An element of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Element {
    /// Its level.
    pub level_n: f64,
    /// What of it is the motor's.
    pub motor_n: f64,
    /// Way of the table from rest after which it slips.
    pub slip_m: f64,
}

/// Pieces of a bristle.
const PIECES: usize = 100;

/// A bristle of such a level and deflection as springs. It comes off its level within its
/// deflection δ after a reversal, so from rest its curve is `V(x) = F (1 − exp(−2 x / δ))`. Those
/// that slip between a and b carry `[V − x V']` from a to b and have the stiffness `V'(a) − V'(b)`.
/// The cuts are where `V'` has come down to (1 − i / n)² of its begin: the tail is as long as the
/// begin is steep.
#[must_use]
pub fn of_bristle(level_n: f64, deflection_m: f64) -> Vec<Spring> {
    let scale_m = 0.5 * deflection_m;
    // With e = exp(−x / scale), V' is e level / scale and V − x V' is level (1 − e (1 − ln e)).
    let carried = |e: f64| 1.0 - if e > 0.0 { e * (1.0 - e.ln()) } else { 0.0 };
    let cut = |place: usize| (1.0 - place as f64 / PIECES as f64).powi(2);
    let spring = |place: usize| {
        let (from, to) = (cut(place), cut(place + 1));
        let level = carried(to) - carried(from);
        Spring {
            level_n: level_n * level,
            way_m: scale_m * level / (from - to),
        }
    };
    (0..PIECES).map(spring).collect()
}

impl Springs {
    /// Those of an axis whose sides have such a level together; `of_side` has the springs of a
    /// level whose deflection is so many times that of the table.
    pub(super) fn of_sides(
        level_n: f64,
        motor: Option<MotorSide>,
        of_side: impl Fn(f64, f64) -> Vec<Spring>,
    ) -> Self {
        let share = motor.map_or(0.0, |motor| motor.share);
        let of_motor = |motor: MotorSide| of_side(share * level_n, motor.deflection);
        Self {
            table: of_side((1.0 - share) * level_n, 1.0),
            motor: motor.map_or_else(Vec::new, of_motor),
            bristle_share: 0.0,
        }
    }

    /// As many elements as the drive has, at most, where the screw has such a stiffness.
    pub(super) fn elements(self, screw_n_per_m: f64) -> Vec<Element> {
        few(&self.sorted().over_the_tables_way(screw_n_per_m))
    }

    /// Elements over the way of the table, one for each bend of V.
    fn over_the_tables_way(&self, screw_n_per_m: f64) -> Vec<Element> {
        let [mut table, mut motor] = [&self.table, &self.motor].map(|own| own.iter().peekable());
        let stiffness = |springs: &[Spring]| -> f64 {
            let each = springs.iter().map(|own| own.stiffness_n_per_m());
            each.sum()
        };
        let [mut of_table, mut of_motor] = [&self.table, &self.motor].map(|own| stiffness(own));
        let (mut x, mut wound_m) = (0.0_f64, 0.0_f64);
        let mut elements = Vec::new();
        loop {
            // The motor goes so much farther than the table.
            let ratio = 1.0 + of_table / screw_n_per_m;
            let at_table = table.peek().map_or(f64::INFINITY, |own| own.way_m);
            let at_motor = motor.peek().map_or(f64::INFINITY, |own| {
                x + ((own.way_m - x - wound_m) / ratio).max(0.0)
            });
            let there = at_table.min(at_motor);
            if there == f64::INFINITY {
                return elements;
            }
            wound_m += (there - x) * of_table / screw_n_per_m;
            x = there;
            let before = (of_table, ratio * of_motor);
            if at_table <= at_motor {
                of_table -= table.next().map_or(0.0, |own| own.stiffness_n_per_m());
            } else {
                of_motor -= motor.next().map_or(0.0, |own| own.stiffness_n_per_m());
            }
            let after = (1.0 + of_table / screw_n_per_m) * of_motor;
            let motor_n = x * (before.1 - after);
            elements.push(Element {
                level_n: motor_n + x * (before.0 - of_table),
                motor_n,
                slip_m: x,
            });
        }
    }

    /// The same, each side in the order in which its springs slip.
    fn sorted(mut self) -> Self {
        for side in [&mut self.table, &mut self.motor] {
            side.retain(|own| own.level_n > 0.0);
            side.sort_by(|one, other| one.way_m.total_cmp(&other.way_m));
        }
        self
    }
}

/// As many elements as the drive has, at most: neighbours become one, as stiff and as strong, so
/// that the force is nowhere off by more than it has to be.
fn few(elements: &[Element]) -> Vec<Element> {
    let (mut too_little_n, mut enough_n) = (0.0, elements.iter().map(|own| own.level_n).sum());
    if elements.len() <= ELEMENTS {
        return elements.to_vec();
    }
    for _ in 0..HALVINGS {
        let off_n = 0.5 * (too_little_n + enough_n);
        if joined(elements, off_n).len() <= ELEMENTS {
            enough_n = off_n;
        } else {
            too_little_n = off_n;
        }
    }
    joined(elements, enough_n)
}

/// Halvings in which the force that joined elements are off by is found.
const HALVINGS: u32 = 40;

/// Neighbours joined for as long as that puts the force off by no more than this.
fn joined(elements: &[Element], off_n: f64) -> Vec<Element> {
    let mut all = Vec::new();
    let mut rest = elements;
    while !rest.is_empty() {
        let fits = |count: &usize| off_by(&rest[..*count]) <= off_n;
        let count = (2..=rest.len()).take_while(fits).last().unwrap_or(1);
        let (together, after) = rest.split_at(count);
        all.push(one_of(together));
        rest = after;
    }
    all
}

fn one_of(elements: &[Element]) -> Element {
    let sum = |of: fn(&Element) -> f64| -> f64 { elements.iter().map(of).sum() };
    let level_n = sum(|own| own.level_n);
    Element {
        level_n,
        motor_n: sum(|own| own.motor_n),
        slip_m: level_n / sum(|own| own.level_n / own.slip_m),
    }
}

/// By how much one element in the place of some is off at most, which is where it slips.
fn off_by(elements: &[Element]) -> f64 {
    let one = one_of(elements);
    let there = |own: &Element| own.level_n * (one.slip_m / own.slip_m).min(1.0);
    one.level_n - elements.iter().map(there).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force of all elements after a way from rest, and what of it is the motor's.
    fn force(elements: &[Element], way_m: f64) -> [f64; 2] {
        let share = |own: &Element| (way_m / own.slip_m).min(1.0);
        let all = elements.iter().map(|own| own.level_n * share(own)).sum();
        let motor = elements.iter().map(|own| own.motor_n * share(own)).sum();
        [all, motor]
    }

    fn bristle(level_n: f64, deflection_m: f64, way_m: f64) -> f64 {
        level_n * (1.0 - (-2.0 * way_m / deflection_m).exp())
    }

    #[test]
    fn elements_of_a_bristle_follow_its_curve_to_a_hundredth_of_the_level() {
        let springs = Springs {
            table: of_bristle(400.0, 1.0e-5),
            motor: Vec::new(),
            ..Springs::default()
        };
        let elements = springs.elements(1.2e8);
        assert_eq!(elements.len(), ELEMENTS);
        let [whole, of_motor] = force(&elements, 1.0);
        assert!((whole - 400.0).abs() < 1.0e-9 && of_motor == 0.0, "{whole}");
        for place in 0..400 {
            let way_m = 1.0e-7 * f64::from(place);
            let off = force(&elements, way_m)[0] - bristle(400.0, 1.0e-5, way_m);
            assert!(off.abs() < 4.0, "{off} N at {way_m} m");
        }
    }

    #[test]
    fn a_motor_goes_farther_than_its_table_by_what_that_winds_up() {
        let (screw, table, motor) = (4.0e7, (300.0, 1.2e-5), (150.0, 1.6e-5));
        let springs = Springs {
            table: of_bristle(table.0, table.1),
            motor: of_bristle(motor.0, motor.1),
            ..Springs::default()
        };
        for (elements, most_n) in [
            (springs.over_the_tables_way(screw), 0.1),
            (springs.clone().elements(screw), 6.0),
        ] {
            for place in 0..400 {
                let way_m = 1.0e-7 * f64::from(place);
                let of_table = bristle(table.0, table.1, way_m);
                let of_motor = bristle(motor.0, motor.1, way_m + of_table / screw);
                let [all, own] = force(&elements, way_m);
                let off = (all - of_table - of_motor).abs();
                assert!(off < most_n, "{off} N at {way_m} m");
                assert!((own - of_motor).abs() < most_n, "{own} N at {way_m} m");
            }
        }
    }

    #[test]
    fn springs_that_slip_are_elements_as_they_are_and_too_many_fewer() {
        let many = |count: u32| -> Vec<Spring> {
            let spring = |place: u32| Spring {
                level_n: 10.0 * f64::from(1 + place % 4),
                way_m: 1.0e-6 * f64::from(1 + place),
            };
            (0..count).map(spring).collect()
        };
        let springs = Springs {
            table: many(5),
            motor: many(4),
            ..Springs::default()
        };
        // A rigid screw: both sides go the same way.
        let elements = springs.clone().elements(f64::INFINITY);
        assert_eq!(elements.len(), 9);
        for (place, spring) in springs.motor.iter().enumerate() {
            let [table, motor] = [elements[2 * place], elements[2 * place + 1]];
            assert!((motor.slip_m - spring.way_m).abs() < 1.0e-15);
            assert!((motor.motor_n - spring.level_n).abs() < 1.0e-9);
            assert!((table.level_n - spring.level_n).abs() < 1.0e-9, "{table:?}");
            assert_eq!(table.motor_n, 0.0);
        }
        let springs = Springs {
            table: many(14),
            motor: Vec::new(),
            ..Springs::default()
        };
        let (fine, fewer) = (springs.over_the_tables_way(1.0e8), springs.elements(1.0e8));
        assert!(fewer.len() <= ELEMENTS, "{}", fewer.len());
        for way_m in [1.0e-9, 1.0] {
            let [one, other] = [&fine, &fewer].map(|own| force(own, way_m)[0]);
            assert!((one / other - 1.0).abs() < 1.0e-9);
        }
    }
}
