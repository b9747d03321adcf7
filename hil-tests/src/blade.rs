//! Contours of a turbine blade as dense points: what a machining centre would be given.
//!
//! **Section**, with quarter circles that lead in and out on the suction side:
//!
//! ```text
//! x = c/2 cos φ    y = h sin² φ − h/2 + T/2 sin φ (1 + k cos φ)
//! ```
//!
//! a parabola as mean line, a thickness that is a half ellipse and falls towards the trailing edge,
//! with radii down to half a millimetre there. X turns round twice and Y three times.
//!
//! **Root**, a fir tree with lobes on half an ellipse, one flank down and the other up; X turns
//! round eight times and Y eleven:
//!
//! ```text
//! x = W cos θ (1 + a cos 2nθ)    y = −H sin θ (1 + a cos 2nθ)
//! ```

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;

/// Chord c, rise of the mean line h, thickness T, mm, and k.
const CHORD_MM: f64 = 60.0;
const RISE_MM: f64 = 8.0;
const THICKNESS_MM: f64 = 10.0;
const TAPER: f64 = 0.1;
/// Radius of the quarter circles that lead in and out.
const LEAD_MM: f64 = 10.0;
/// Half axes W and H of the root, mm, lobes on it, and how far they stand out.
const ROOT_MM: [f64; 2] = [14.0, 28.0];
const LOBES: f64 = 9.0;
const LOBE: f64 = 0.06;
/// Points are this far apart.
const APART_MM: f64 = 0.1;
/// Steps in which ways are added up.
const STEPS: u32 = 100_000;

fn section_mm(phi: f64) -> [f64; 2] {
    let thickness = 0.5 * THICKNESS_MM * phi.sin() * (1.0 + TAPER * phi.cos());
    [
        0.5 * CHORD_MM * phi.cos(),
        RISE_MM * phi.sin().powi(2) - 0.5 * RISE_MM + thickness,
    ]
}

/// Where the suction side is level: the quarter circles touch it there. Newton's method on dy/dφ,
/// from the angle without taper.
fn level() -> f64 {
    let slope = |phi: f64| {
        let of_thickness = phi.cos() + TAPER * (2.0 * phi).cos();
        RISE_MM * (2.0 * phi).sin() + 0.5 * THICKNESS_MM * of_thickness
    };
    (0..20).fold(FRAC_PI_2, |phi, _| {
        phi - 2.0e-6 * slope(phi) / (slope(phi + 1.0e-6) - slope(phi - 1.0e-6))
    })
}

/// A quarter circle about a point over the suction side, which it touches there; from an angle on,
/// clockwise.
fn lead_mm([x, y]: [f64; 2], from: f64, share: f64) -> [f64; 2] {
    let angle = from - FRAC_PI_2 * share;
    [x + LEAD_MM * angle.cos(), y + LEAD_MM * (1.0 + angle.sin())]
}

/// Points along a curve over 0 to 1, so far apart, from its begin to before its end.
fn along(curve: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    let at = |step: u32| curve(f64::from(step) / f64::from(STEPS));
    let way = |step: u32| {
        let ([x, y], [to_x, to_y]) = (at(step), at(step + 1));
        (to_x - x).hypot(to_y - y)
    };
    let length: f64 = (0..STEPS).map(way).sum();
    let apart = length / (length / APART_MM).round();
    let (mut points, mut gone) = (vec![at(0)], 0.0);
    for step in 0..STEPS {
        gone += way(step);
        if gone >= points.len() as f64 * apart && gone < length - 0.5 * apart {
            points.push(at(step + 1));
        }
    }
    points
}

fn root_mm(theta: f64) -> [f64; 2] {
    let out = 1.0 + LOBE * (2.0 * LOBES * theta).cos();
    let [x, y] = ROOT_MM;
    [x * theta.cos() * out, -y * theta.sin() * out]
}

/// The section with what leads in and out, mm.
#[must_use]
pub fn section() -> Vec<[f64; 2]> {
    let begin = level();
    let touch = section_mm(begin);
    let lead_in = along(|share| lead_mm(touch, 0.0, share));
    let around = along(|share| section_mm(begin + TAU * share));
    let lead_out = along(|share| lead_mm(touch, -FRAC_PI_2, share));
    let end = lead_mm(touch, -FRAC_PI_2, 1.0);
    [lead_in, around, lead_out, vec![end]].concat()
}

/// The root, mm.
#[must_use]
pub fn root() -> Vec<[f64; 2]> {
    let flanks = along(|share| root_mm(PI * share));
    [flanks, vec![root_mm(PI)]].concat()
}

/// Points as a file.
#[must_use]
pub fn csv(points_mm: &[[f64; 2]]) -> String {
    let mut text =
        String::from("# Written by hil-tests/src/blade.rs, which says how.\nx_mm,y_mm\n");
    for [x, y] in points_mm {
        let _ = writeln!(text, "{x:.5},{y:.5}");
    }
    text
}
