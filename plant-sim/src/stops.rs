//! End stops: what the table runs into when nobody stops it.
//!
//! ```text
//! F = −(K·depth + C·ẋ), never pulling            at ±position, on the table
//! ```
//!
//! Units: m, N. The stop is a stiff spring with damping on one side only, taken explicitly in the
//! middle of the drift of [`crate::mechanics`], so it takes energy out as long as the sub-step
//! resolves it; the machine file's ranges see to that.

use crate::ranges::ranged;

/// A pair of end stops, symmetrical about position zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops {
    /// Where they stand, m to either side of zero.
    pub position_m: f64,
    /// Stiffness K.
    pub stiffness_n_per_m: f64,
    /// Damping C.
    pub damping_n_s_per_m: f64,
}

ranged! {
    /// `[axis.stops]` of a machine file. An empty table gives all defaults, no table no stops. What
    /// the sub-step resolves is less than these ranges on a light table.
    #[derive(Clone, Copy, Debug)]
    pub struct StopsForm {
        /// Where they stand; [`MARGIN_M`] behind the travel where it is not given.
        pub stop_m: Option<f64> [0.0 => 10.1],
        /// Stiffness.
        #[serde(default = "stiffness")]
        pub stop_stiffness_n_per_m: f64 [1.0e3 => 1.0e12],
        /// Damping.
        #[serde(default = "damping")]
        pub stop_damping_n_s_per_m: f64 [0.0 => 1.0e12],
    }
}

/// Way from the end of the travel to the stop.
pub const MARGIN_M: f64 = 0.005;
/// Takes up the 75 J of the reference axis (931 kg at 0.4 m/s) within 4 mm: ½·K·x².
const STIFFNESS_N_PER_M: f64 = 1.0e7;
/// About half of what is critical for the same 931 kg: 2·√(K·M) = 1.9e5.
const DAMPING_N_S_PER_M: f64 = 1.0e5;

fn stiffness() -> f64 {
    STIFFNESS_N_PER_M
}

fn damping() -> f64 {
    DAMPING_N_S_PER_M
}

impl StopsForm {
    /// Where the stops stand on an axis of this travel, m.
    #[must_use]
    pub fn position_m(&self, travel_m: f64) -> f64 {
        self.stop_m.unwrap_or(travel_m + MARGIN_M)
    }

    /// The stops of an axis of this travel.
    #[must_use]
    pub fn stops(&self, travel_m: f64) -> Stops {
        Stops {
            position_m: self.position_m(travel_m),
            stiffness_n_per_m: self.stop_stiffness_n_per_m,
            damping_n_s_per_m: self.stop_damping_n_s_per_m,
        }
    }
}

impl Stops {
    /// Force on a table at a position and velocity, N.
    #[must_use]
    pub fn force_n(&self, table_m: f64, table_m_per_s: f64) -> f64 {
        let depth = table_m - table_m.clamp(-self.position_m, self.position_m);
        if depth == 0.0 {
            return 0.0;
        }
        let push = -(self.stiffness_n_per_m * depth + self.damping_n_s_per_m * table_m_per_s);
        if push * depth > 0.0 { 0.0 } else { push }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_pushes_back_and_never_pulls() {
        let stops = Stops {
            position_m: 0.1,
            stiffness_n_per_m: 1.0e7,
            damping_n_s_per_m: 1.0e5,
        };
        assert_eq!(stops.force_n(0.1, 0.4), 0.0);
        assert!((stops.force_n(0.101, 0.0) + 10_000.0).abs() < 1.0e-6);
        assert!((stops.force_n(-0.101, -0.1) - 20_000.0).abs() < 1.0e-6);
        assert_eq!(
            stops.force_n(0.101, -0.4),
            0.0,
            "the table leaves it faster than its spring follows"
        );
    }
}
