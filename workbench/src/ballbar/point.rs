//! One sample of a circle, and its distance from the nominal path.

/// One sample of a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Angle travelled, rad, from X = 0, Y = −R.
    pub angle_rad: f64,
    /// Table, m.
    pub table_m: [f64; 2],
    /// Motors at the table, m.
    pub motor_m: [f64; 2],
    /// Setpoint, m.
    pub reference_m: [f64; 2],
}

/// Radial deviation of a point, µm.
#[must_use]
pub fn radial_um(point: &Point, radius_m: f64) -> f64 {
    (point.table_m[0].hypot(point.table_m[1]) - radius_m) * 1.0e6
}
