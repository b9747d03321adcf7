//! What is drawn over an axis: lines, clouds of samples, bands of uncertainty.

/// What a curve means, and so its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Without what was found or downloaded.
    Before,
    /// With it.
    After,
    /// What was recorded.
    Recorded,
    /// Anything else.
    Other(usize),
}

impl Ink {
    /// Its class in the style sheet.
    pub(super) const fn class(self) -> &'static str {
        match self {
            Self::Before => "before",
            Self::After => "after",
            Self::Recorded => "recorded",
            Self::Other(number) => match number % 6 {
                0 => "before",
                1 => "after",
                2 => "other3",
                3 => "other4",
                4 => "other5",
                _ => "recorded",
            },
        }
    }
}

/// How points are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Form {
    /// As a line through them.
    Line(Vec<(f64, f64)>),
    /// As a cloud: the darker the more of them.
    Cloud(Vec<(f64, f64)>),
    /// As a band from the second to the third.
    Band(Vec<[f64; 3]>),
}

/// A named curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pub(super) name: String,
    pub(super) ink: Ink,
    pub(super) form: Form,
}

impl Curve {
    /// A line through points.
    pub fn line(name: &str, ink: Ink, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self::new(name, ink, Form::Line(points.into_iter().collect()))
    }

    /// A cloud of points.
    pub fn cloud(name: &str, ink: Ink, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self::new(name, ink, Form::Cloud(points.into_iter().collect()))
    }

    /// A band: place, low, high.
    pub fn band(name: &str, ink: Ink, points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        Self::new(name, ink, Form::Band(points.into_iter().collect()))
    }

    fn new(name: &str, ink: Ink, form: Form) -> Self {
        Self {
            name: name.to_owned(),
            ink,
            form,
        }
    }

    /// All finite places that it reaches.
    pub(super) fn reach(&self) -> Vec<(f64, f64)> {
        let both = |band: &[[f64; 3]]| {
            band.iter()
                .flat_map(|[x, a, b]| [(*x, *a), (*x, *b)])
                .collect()
        };
        let mut points: Vec<(f64, f64)> = match &self.form {
            Form::Line(points) | Form::Cloud(points) => points.clone(),
            Form::Band(band) => both(band),
        };
        points.retain(|(x, y)| x.is_finite() && y.is_finite());
        points
    }
}
