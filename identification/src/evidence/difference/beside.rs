//! A wind-up by the load's motion beside other ways, while its friction is searched.
//!
//! A search tries tens of frictions. The load's motion, the other ways and the products of all that
//! with each other are the same every time: they are made once.

use super::columns::{Apart, Way};
use super::load::{Carried, LoadMotion};
use super::rubbing::LoadFriction;
use crate::fit::blocks::Blocks;
use crate::fit::rows::Rows;
use crate::motion::kinematics::Kinematics;

/// What does not depend on the parameters of the friction.
pub(super) struct Beside<'a> {
    motion: &'a Kinematics,
    /// The wind-up, with the friction that it came with.
    carried: Carried,
    load: LoadMotion,
    /// The load's own columns, then those of the other ways.
    rows: Rows,
    /// The other ways.
    others: Vec<Way>,
}

/// The same with a friction.
pub(super) struct Rubbed {
    /// The wind-up.
    pub carried: Carried,
    columns: Vec<Vec<f64>>,
    /// Sum of squares left.
    pub left: f64,
    /// Coefficients of the wind-up's columns.
    own: Vec<f64>,
}

impl<'a> Beside<'a> {
    /// The load's own columns.
    const PLAIN: usize = Carried::FRICTION;

    /// Of the wind-up at a place of such ways; `None` where there is another one.
    pub(super) fn of(apart: &Apart<'a>, ways: &[Way], place: usize) -> Option<Self> {
        let Some(Way::Carried(carried)) = ways.get(place).copied() else {
            return None;
        };
        let mut others = ways.to_vec();
        others.remove(place);
        let load = carried.load(apart.motion, apart.path.position, apart.raw);
        let columns = load.plain().into_iter().chain(apart.design(&others));
        Some(Self {
            motion: apart.motion,
            carried,
            load,
            rows: apart.rows_of(&columns.collect::<Vec<_>>()),
            others,
        })
    }

    /// With the friction that it came with.
    pub(super) fn as_it_was(&self) -> Rubbed {
        self.with(self.carried)
    }

    /// With the friction of another wind-up that differs in nothing else.
    pub(super) fn with(&self, carried: Carried) -> Rubbed {
        let columns = carried.rubbed(self.motion, &self.load);
        let fit = Blocks::with(&self.rows, &columns).fit();
        let mut own = self.in_order(fit.coefficients);
        own.truncate(carried.width());
        Rubbed {
            carried,
            columns,
            left: fit.sse,
            own,
        }
    }

    /// Gram matrices of all columns of a friction and more of them; by [`Self::in_order`] their
    /// coefficients are those of the wind-up, those of the further ones, those of the other ways.
    pub(super) fn and(&self, rubbed: &Rubbed, more: &[Vec<f64>]) -> Blocks {
        Blocks::with(&self.rows, &[&rubbed.columns, more].concat())
    }

    /// Coefficients with those of the other ways last.
    pub(super) fn in_order(&self, mut coefficients: Vec<f64>) -> Vec<f64> {
        let others = self.rows.width() - 1 - Self::PLAIN;
        coefficients[Self::PLAIN..].rotate_left(others);
        coefficients
    }

    /// The same, by elements of a grid instead of the bend: how many columns are free beside these,
    /// and the Gram matrices of those and of the elements.
    pub(super) fn slipped(&self, grid: &[f64]) -> (usize, Blocks) {
        let friction = self.carried.friction;
        let mut columns = self.carried.rubbed(self.motion, &self.load);
        columns.remove(0);
        let free = self.rows.width() - 1 + columns.len();
        columns.extend(self.load.slipped(self.motion, friction, grid));
        (free, Blocks::with(&self.rows, &columns))
    }

    /// How motor − load changes with what is searched of a friction, each by its own size: between
    /// steps of such a part to both sides.
    pub(super) fn derivatives(&self, about: &Rubbed, step: f64) -> Vec<Vec<f64>> {
        let carried = about.carried;
        let fallen = self.load.fallen(carried.friction);
        let at = |parameter: usize, by: f64| {
            let mut factors = [1.0; LoadFriction::MOST_SEARCHED];
            factors[parameter] += by;
            carried.friction.scaled(factors)
        };
        let of = |parameter: usize| {
            let both = [at(parameter, step), at(parameter, -step)];
            let apart = self.load.rubbed_apart(self.motion, both, &fallen);
            let mut change = carried.changed(self.motion, apart, &about.own);
            for change in &mut change {
                *change /= 2.0 * step;
            }
            change
        };
        carried.friction.searched().into_iter().map(of).collect()
    }

    /// The other ways.
    pub(super) fn others(&self) -> &[Way] {
        &self.others
    }
}
