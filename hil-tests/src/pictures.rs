//! Pictures of the README: written by the commands under them, and compared with what these write.

use std::path::Path;

/// A hundredth of a pixel more or less is the same picture.
const SAME_PX: f64 = 0.051;

/// Compares a picture with the one in `docs/`; with `QUADRANT_BLESS=1` it takes its place.
///
/// # Panics
/// Where they differ.
pub fn check(name: &str, svg: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name);
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(&path, svg).expect("docs can be written");
        return;
    }
    let kept = std::fs::read_to_string(&path).expect("the picture is in docs; bless it");
    let (words, numbers) = parts(svg);
    let (kept_words, kept_numbers) = parts(&kept);
    assert!(
        words == kept_words && numbers.len() == kept_numbers.len(),
        "docs/{name} is another picture: bless it and look at it"
    );
    let apart = numbers.iter().zip(&kept_numbers);
    let apart = apart
        .map(|(one, other)| (one - other).abs())
        .fold(0.0, f64::max);
    assert!(
        apart < SAME_PX,
        "docs/{name} is {apart} px from what the command writes"
    );
}

/// Places of a path of relative steps, px.
///
/// # Panics
/// Where it is none.
#[must_use]
pub fn places(path: &str) -> Vec<(f64, f64)> {
    let mut at = (0.0, 0.0);
    let step = |step: &str| {
        let (x, y) = step.split_once(' ').expect("two numbers");
        let [x, y] = [x, y].map(|text| text.parse::<f64>().expect("a number"));
        at = (at.0 + x, at.1 + y);
        at
    };
    path.trim_start_matches('M').split('l').map(step).collect()
}

/// How far a place is from the straight way between two others, px.
#[must_use]
pub fn off_px(from: (f64, f64), to: (f64, f64), at: (f64, f64)) -> f64 {
    let way = (to.0 - from.0, to.1 - from.1);
    let own = (at.0 - from.0, at.1 - from.1);
    let square = way.0 * way.0 + way.1 * way.1;
    let along = ((own.0 * way.0 + own.1 * way.1) / square.max(1.0e-12)).clamp(0.0, 1.0);
    (own.0 - along * way.0).hypot(own.1 - along * way.1)
}

/// A text without its numbers, and these.
fn parts(text: &str) -> (String, Vec<f64>) {
    let is_of_number = |letter: char| letter.is_ascii_digit() || letter == '.' || letter == '-';
    let (mut words, mut numbers, mut number) = (String::new(), Vec::new(), String::new());
    for letter in text.chars().chain([' ']) {
        if is_of_number(letter) {
            number.push(letter);
            continue;
        }
        if let Ok(value) = number.parse::<f64>() {
            numbers.push(value);
        } else {
            words.push_str(&number);
        }
        number.clear();
        words.push(letter);
    }
    (words, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_a_path_are_sums_of_its_steps_and_a_place_beside_it_is_as_far_off() {
        let path = places("M1 2l3 0l0 -4.5");
        assert_eq!(path, [(1.0, 2.0), (4.0, 2.0), (4.0, -2.5)]);
        assert_eq!(off_px(path[0], path[1], (2.0, 5.0)), 3.0);
        assert_eq!(off_px(path[0], path[1], (7.0, 6.0)), 5.0);
    }

    #[test]
    fn numbers_are_taken_out_of_a_text_and_nothing_else() {
        let (words, numbers) = parts("M1.5 -2l0.25 3 a-b");
        assert_eq!(words, "M l  a-b ");
        assert_eq!(numbers, [1.5, -2.0, 0.25, 3.0]);
    }
}
