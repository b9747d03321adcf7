//! A contour of dense points at a constant feed, with a smooth start and stop.
//!
//! A natural cubic spline over the chords leads through the points, so that velocity and
//! acceleration of both axes are continuous; where points are dense the sum of chords is the way
//! along it (a chord of 0.1 mm on a radius of 1 mm is 0.04 % short).

use std::path::Path;

use super::smoothstep::smoothstep_area;
use crate::error::{Failure, Outcome};

/// A contour in X and Y.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Way along the chords to each point, m.
    ways_m: Vec<f64>,
    points_m: Vec<[f64; 2]>,
    /// Second derivatives over the way there, 1/m.
    bends_per_m: Vec<[f64; 2]>,
    feed_m_per_s: f64,
    ramp_s: f64,
}

/// Where the contour is at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// X and Y, m.
    pub at_m: [f64; 2],
    /// Unit vector along it.
    pub along: [f64; 2],
}

/// The smooth start takes this long, and so does the stop; shorter where a contour is.
const RAMP_S: f64 = 0.2;
/// Start and stop take at most this share of the contour each.
const RAMP_SHARE: f64 = 0.25;
/// How far neighbours may be apart: nearer ones are one point, written twice.
const NEAREST_M: f64 = 1.0e-9;
const FARTHEST_M: f64 = 100.0;
/// Fewer are no contour.
const FEWEST: usize = 4;

impl Contour {
    /// A contour through points, in the order in which they are given.
    ///
    /// # Errors
    /// Too few of them, two neighbours at one place, or a number that is none.
    pub fn through(points_m: Vec<[f64; 2]>, feed_m_per_s: f64) -> Outcome<Self> {
        if points_m.len() < FEWEST {
            return Err(Failure::new(format!(
                "a contour needs at least {FEWEST} points, not {}",
                points_m.len()
            )));
        }
        let mut ways_m = vec![0.0];
        for (place, pair) in points_m.windows(2).enumerate() {
            let chord_m = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            if !(NEAREST_M..FARTHEST_M).contains(&chord_m) {
                return Err(Failure::new(format!(
                    "points {} and {}: two neighbours must be {} nm to {} m apart",
                    place + 1,
                    place + 2,
                    1.0e9 * NEAREST_M,
                    FARTHEST_M
                )));
            }
            ways_m.push(ways_m[place] + chord_m);
        }
        let length_m = ways_m[ways_m.len() - 1];
        let bends = [0, 1].map(|axis| bends(&ways_m, &points_m, axis));
        // A ramp takes half the way that the same time takes at full speed.
        let longest_s = 2.0 * RAMP_SHARE * length_m / feed_m_per_s;
        Ok(Self {
            bends_per_m: bends[0]
                .iter()
                .zip(&bends[1])
                .map(|(x, y)| [*x, *y])
                .collect(),
            ways_m,
            points_m,
            feed_m_per_s,
            ramp_s: RAMP_S.min(longest_s),
        })
    }

    /// Reads a CSV file with the columns `x_mm` and `y_mm`; other columns are left alone.
    ///
    /// # Errors
    /// What is wrong, and in which line.
    pub fn read(path: &Path, feed_m_per_s: f64) -> Outcome<Self> {
        let of_file = |text: String| Failure::new(format!("{}: {text}", path.display()));
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(|error| of_file(format!("{error}; check the path and its permissions")))?;
        let points = reader.deserialize::<Row>().map(|row| {
            let row = row.map_err(|error| {
                of_file(format!(
                    "{error}; wanted are numbers in the columns x_mm and y_mm"
                ))
            })?;
            Ok([1.0e-3 * row.x_mm, 1.0e-3 * row.y_mm])
        });
        let points: Vec<[f64; 2]> = points.collect::<Outcome<_>>()?;
        Self::through(points, feed_m_per_s).map_err(|Failure(text)| of_file(text))
    }

    /// Length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.ways_m[self.ways_m.len() - 1]
    }

    /// Points that it leads through.
    #[must_use]
    pub const fn points_m(&self) -> &[[f64; 2]] {
        self.points_m.as_slice()
    }

    /// Feed, m/s.
    #[must_use]
    pub const fn feed_m_per_s(&self) -> f64 {
        self.feed_m_per_s
    }

    /// Duration, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.length_m() / self.feed_m_per_s + self.ramp_s
    }

    /// When it is at its feed, s.
    #[must_use]
    pub fn at_feed_s(&self) -> std::ops::Range<f64> {
        self.ramp_s..self.duration_s() - self.ramp_s
    }

    /// Where it is at a time.
    #[must_use]
    pub fn place(&self, time_s: f64) -> Place {
        let way_m = self.way_m(time_s);
        let next = self.ways_m.partition_point(|way| *way <= way_m);
        let from = next.clamp(1, self.ways_m.len() - 1) - 1;
        let span_m = self.ways_m[from + 1] - self.ways_m[from];
        let b = (way_m - self.ways_m[from]) / span_m;
        let [at_m, slope] = [0, 1].map(|order| [0, 1].map(|axis| self.piece(from, axis, b, order)));
        let size = slope[0].hypot(slope[1]);
        Place {
            at_m,
            along: slope.map(|part| part / size),
        }
    }

    /// Position or slope of an axis between two points, at a share of the way from one to the
    /// other (de Boor, "A Practical Guide to Splines", chapter IV, by second derivatives).
    fn piece(&self, from: usize, axis: usize, b: f64, order: usize) -> f64 {
        let [p, q] = [from, from + 1].map(|place| self.points_m[place][axis]);
        let [k, l] = [from, from + 1].map(|place| self.bends_per_m[place][axis]);
        let span_m = self.ways_m[from + 1] - self.ways_m[from];
        let a = 1.0 - b;
        if order == 0 {
            let bent = (a * a * a - a) * k + (b * b * b - b) * l;
            a * p + b * q + span_m * span_m / 6.0 * bent
        } else {
            let bent = (3.0 * b * b - 1.0) * l - (3.0 * a * a - 1.0) * k;
            (q - p) / span_m + span_m / 6.0 * bent
        }
    }

    fn way_m(&self, time_s: f64) -> f64 {
        let ramp = |since_s: f64| {
            let share = (since_s / self.ramp_s).clamp(0.0, 1.0);
            self.feed_m_per_s * self.ramp_s * smoothstep_area(share)
        };
        let left_s = self.duration_s() - time_s;
        if time_s <= self.ramp_s {
            ramp(time_s)
        } else if left_s <= self.ramp_s {
            self.length_m() - ramp(left_s)
        } else {
            self.feed_m_per_s * (time_s - 0.5 * self.ramp_s)
        }
    }
}

#[derive(serde::Deserialize)]
struct Row {
    x_mm: f64,
    y_mm: f64,
}

/// Second derivatives of the natural spline of an axis: the tridiagonal equations of its continuous
/// slopes, eliminated forward and solved backward.
fn bends(ways_m: &[f64], points_m: &[[f64; 2]], axis: usize) -> Vec<f64> {
    let last = ways_m.len() - 1;
    let span = |place: usize| ways_m[place + 1] - ways_m[place];
    let slope = |place: usize| (points_m[place + 1][axis] - points_m[place][axis]) / span(place);
    let (mut upper, mut right) = (vec![0.0; last + 1], vec![0.0; last + 1]);
    for place in 1..last {
        let [before, after] = [span(place - 1), span(place)];
        let diagonal = 2.0 * (before + after) - before * upper[place - 1];
        upper[place] = after / diagonal;
        let turn = 6.0 * (slope(place) - slope(place - 1));
        right[place] = (turn - before * right[place - 1]) / diagonal;
    }
    let mut bends = vec![0.0; last + 1];
    for place in (1..last).rev() {
        bends[place] = right[place] - upper[place] * bends[place + 1];
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three quarters of a circle of 10 mm in steps of 0.1 mm.
    fn arc() -> Vec<[f64; 2]> {
        (0..=471)
            .map(|step| {
                let angle = 0.01 * f64::from(step);
                [0.01 * angle.cos(), 0.01 * angle.sin()]
            })
            .collect()
    }

    #[test]
    fn it_leads_through_its_points_from_rest_to_rest_at_its_feed() {
        let contour = Contour::through(arc(), 0.01).unwrap();
        let end = contour.duration_s();
        assert!((contour.length_m() - 0.0471).abs() < 1.0e-6);
        let off = |place: Place, point: [f64; 2]| {
            (place.at_m[0] - point[0]).hypot(place.at_m[1] - point[1])
        };
        assert!(off(contour.place(0.0), arc()[0]) < 1.0e-12);
        assert!(off(contour.place(end), arc()[471]) < 1.0e-12);
        for time_s in [0.5, 1.7, 2.9] {
            let [before, here, after] = [-1.0e-4, 0.0, 1.0e-4].map(|by| contour.place(time_s + by));
            assert!((here.at_m[0].hypot(here.at_m[1]) - 0.01).abs() < 2.0e-12);
            let way = [0, 1].map(|axis| (after.at_m[axis] - before.at_m[axis]) / 2.0e-4);
            assert!((way[0].hypot(way[1]) / 0.01 - 1.0).abs() < 1.0e-4);
            let along = here.along[0] * way[0] + here.along[1] * way[1];
            assert!((along / 0.01 - 1.0).abs() < 1.0e-4);
        }
        let start = contour.place(1.0e-3);
        assert!(off(start, arc()[0]) < 1.0e-9, "from rest");
    }

    #[test]
    fn what_is_no_contour_is_refused_with_the_place() {
        let refused = |points: Vec<[f64; 2]>| Contour::through(points, 0.01).unwrap_err().0;
        assert!(refused(arc()[..3].to_vec()).contains("at least 4 points, not 3"));
        let mut twice = arc();
        twice[7] = twice[6];
        assert!(refused(twice).starts_with("points 7 and 8"));
        let mut joined = arc();
        joined[7] = [joined[6][0], joined[6][1] + 1.0e-17];
        assert!(refused(joined).starts_with("points 7 and 8"));
        let mut gone = arc();
        gone[3][1] = f64::NAN;
        assert!(refused(gone).starts_with("points 3 and 4"));
    }

    #[test]
    fn a_file_is_read_and_what_is_wrong_in_it_named_by_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("contour.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Contour::read(&path, 0.01)
        };
        let good = "# a section\nx_mm, y_mm\n0,0\n1,0\n2,0.5\n3,1\n";
        assert_eq!(read(good).unwrap().points_m()[2], [0.002, 0.0005]);
        let Failure(text) = read(&good.replace("2,0.5", "2,half")).unwrap_err();
        assert!(
            text.contains("line: 5") && text.contains("x_mm and y_mm"),
            "{text}"
        );
        let Failure(text) = read("a,b\n0,0\n").unwrap_err();
        assert!(text.contains("x_mm"), "{text}");
        let Failure(text) = Contour::read(&folder.path().join("none.csv"), 0.01).unwrap_err();
        assert!(text.contains("none.csv"), "{text}");
    }
}
