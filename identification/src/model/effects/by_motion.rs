//! The effort that the motion predicts: that of the usual four columns beside another effect's own.
//!
//! An effect that is a factor of the effort (friction per force, a torque constant that ripples)
//! must not have the recorded effort in its columns: they would hold the noise of the target, and
//! the fit would explain noise by itself. So the effort is computed from the motion. The few
//! coefficients for that are fitted to the record beside the effect's columns, and both are made to
//! agree by a few rounds. A handful of numbers from thousands of rows hold no noise of a row.
//!
//! What else the model has ([`Others`]) is a part of the effort as it was fitted last: a payload is
//! carried, and friction that grows with the load grows with it. Where the drive saturates, it is
//! the effort that the drive delivers.

use nalgebra::DMatrix;

use axis_model::EffectName;

use crate::model::effects::torque_saturation::Saturation;
use crate::model::name::Called;
use crate::motion::dot::dot;
use crate::motion::kinematics::Kinematics;

/// Number of the usual columns.
const USUAL: usize = 4;

/// Acceleration, velocity, direction, one.
pub(crate) type Usual = [f64; USUAL];

/// What the other effects of a model did in an earlier fit; row by row, empty where there are none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Others {
    /// Coefficients of the usual effects, where they are known.
    pub usual: Option<Usual>,
    /// Coefficient of the effect itself, where it has one and that is known.
    pub ratio: f64,
    /// Force by what else acts on the load.
    pub load: Vec<f64>,
    /// Force by what else acts on the motor and its screw.
    pub motor: Vec<f64>,
    /// Friction level beside Coulomb's, as far as it is a matter of the surface.
    pub level: Vec<f64>,
    /// What the drive makes of its effort.
    pub drive: Saturation,
}

impl Others {
    /// Force on the load at a row.
    #[inline]
    #[must_use]
    pub(crate) fn load(&self, row: usize) -> f64 {
        at(&self.load, row)
    }

    /// Friction level beside Coulomb's at a row.
    #[inline]
    #[must_use]
    pub(crate) fn level(&self, row: usize) -> f64 {
        at(&self.level, row)
    }

    /// Force on both at a row.
    #[inline]
    #[must_use]
    pub(crate) fn all(&self, row: usize) -> f64 {
        self.load(row) + at(&self.motor, row)
    }

    fn has_forces(&self) -> bool {
        !(self.load.is_empty() && self.motor.is_empty())
    }
}

fn at(values: &[f64], row: usize) -> f64 {
    values.get(row).copied().unwrap_or(0.0)
}

/// Place among the usual four, which are fitted beside another's own columns.
#[must_use]
pub(crate) fn place_among_usual(called: Called) -> Option<usize> {
    use EffectName::{Coulomb, Inertia, Offset, Viscous};
    let mut usual = [Inertia, Viscous, Coulomb, Offset].into_iter();
    usual.position(|name| called == name)
}

/// What the usual effort is made of, row by row and low-passed.
pub(crate) struct ByMotion<'a> {
    motion: &'a Kinematics,
    /// The fitted rows.
    places: Vec<usize>,
    /// What a fitted row has of each, low-passed, and its effort.
    rows: Vec<Row>,
    /// Sums over those rows of the products of each with each.
    products: [Row; USUAL + 1],
}

/// What a row has of each, and its effort.
type Row = [f64; USUAL + 1];

impl<'a> ByMotion<'a> {
    /// Of a motion.
    #[must_use]
    pub(crate) fn of(motion: &'a Kinematics) -> Self {
        Self::beside(motion, &Others::default())
    }

    /// Of a motion, beside the other effects of a model: their force is taken off the effort.
    #[must_use]
    pub(crate) fn beside(motion: &'a Kinematics, others: &Others) -> Self {
        let acceleration = motion.low_passed(&motion.acceleration);
        let direction = motion.low_passed(&motion.direction);
        let places: Vec<usize> = (0..motion.len())
            .filter(|row| motion.fitted[*row])
            .collect();
        let delivered = others.drive.delivered_lp(motion);
        let others = if others.has_forces() {
            let all: Vec<f64> = (0..motion.len()).map(|row| others.all(row)).collect();
            motion.low_passed(&all)
        } else {
            vec![0.0; motion.len()]
        };
        let row = |row: &usize| {
            let velocity = motion.velocity_lp[*row];
            let effort = delivered[*row] - others[*row];
            [acceleration[*row], velocity, direction[*row], 1.0, effort]
        };
        let rows: Vec<Row> = places.iter().map(row).collect();
        Self {
            motion,
            products: [0, 1, 2, 3, 4].map(|place| {
                let column: Vec<f64> = rows.iter().map(|row| row[place]).collect();
                with_rows(&column, &rows)
            }),
            rows,
            places,
        }
    }

    /// What a row has of each.
    #[inline]
    #[must_use]
    pub(crate) fn at(&self, row: usize) -> Usual {
        [
            self.motion.acceleration_lp[row],
            self.motion.velocity_lp[row],
            self.motion.direction[row],
            1.0,
        ]
    }

    /// Effort of a row with the coefficients of a fit.
    #[inline]
    #[must_use]
    pub(crate) fn effort(&self, usual: Usual, row: usize) -> f64 {
        let pairs = usual.into_iter().zip(self.at(row));
        pairs.map(|(coefficient, value)| coefficient * value).sum()
    }

    /// Efforts of all rows by the usual columns alone.
    #[must_use]
    pub(crate) fn efforts(&self) -> Vec<f64> {
        let (usual, _) = self.fit(&[]);
        let rows = 0..self.motion.len();
        rows.map(|row| self.effort(usual, row)).collect()
    }

    /// Coefficients of the usual columns and of others beside them, by least squares over the
    /// fitted samples.
    #[must_use]
    pub(crate) fn fit(&self, beside: &[Vec<f64>]) -> (Usual, Vec<f64>) {
        let low_passed = self.motion.all_low_passed(beside).into_iter();
        let fitted = |own: Vec<f64>| self.places.iter().map(|row| own[*row]).collect();
        let beside: Vec<Vec<f64>> = low_passed.map(fitted).collect();
        let solution = self.least_squares(&beside);
        let (usual, own) = solution.split_at(USUAL);
        ([usual[0], usual[1], usual[2], usual[3]], own.to_vec())
    }

    /// A column of zeros, or one that repeats others, gets no coefficient.
    fn least_squares(&self, beside: &[Vec<f64>]) -> Vec<f64> {
        let size = USUAL + beside.len();
        // The last row and column are the products with the effort.
        let mut products = DMatrix::zeros(size + 1, size + 1);
        let mut put = |i: usize, j: usize, sum: f64| {
            products[(i, j)] = sum;
            products[(j, i)] = sum;
        };
        let place = |usual: usize| if usual < USUAL { usual } else { size };
        for (i, usual) in self.products.iter().enumerate() {
            (0..=USUAL).for_each(|j| put(place(i), place(j), usual[j]));
        }
        for (i, own) in beside.iter().enumerate() {
            let usual = with_rows(own, &self.rows);
            (0..=USUAL).for_each(|j| put(USUAL + i, place(j), usual[j]));
            let others = beside[..=i].iter().enumerate();
            others.for_each(|(j, other)| put(USUAL + i, USUAL + j, dot(own, other)));
        }
        let gram = products.view((0, 0), (size, size)).into_owned();
        let right = products.view((0, size), (size, 1)).column(0).into_owned();
        let smallest = SINGULAR * gram.norm();
        let solution = gram.svd(true, true).solve(&right, smallest);
        solution.map_or_else(|_| vec![0.0; size], |solution| solution.as_slice().to_vec())
    }
}

/// Sums of the products of a column with each of the rows' values.
fn with_rows(column: &[f64], rows: &[Row]) -> Row {
    let mut sums = Row::default();
    for (value, row) in column.iter().zip(rows) {
        let pairs = sums.iter_mut().zip(row);
        pairs.for_each(|(sum, other)| *sum += value * other);
    }
    sums
}

/// Singular values below this share of the largest are none: rounding of a sum over 10⁵ rows.
const SINGULAR: f64 = 1.0e-12;
