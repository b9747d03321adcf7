//! Motions as trades have them: strokes, indexing, tracking, weaving, a ladder of speeds.
//!
//! The cycloid is the law of cams without a step of acceleration at its ends (Rothbart, Cams,
//! 1956). Sines whose phases fall as the square of their number have a low crest (Schroeder, IEEE
//! Trans. Inf. Theory 16, 1970).

use std::f64::consts::{PI, TAU};

use crate::draw::Draw;
use crate::motion::{Pace, Path, Room, Shape};

/// s − sin(2πs)/2π and its derivatives.
pub(super) fn cycloid(s: f64) -> [f64; 3] {
    let angle = TAU * s;
    let position = s - libm::sin(angle) / TAU;
    [position, 1.0 - libm::cos(angle), TAU * libm::sin(angle)]
}

/// Σ sin(k·angle − πk(k − 1)/n)·√(2/n), k = 1…n: deviation one.
pub(super) fn schroeder(angle: f64, lines: u32) -> f64 {
    let count = f64::from(lines);
    let line = |k: u32| {
        let k = f64::from(k);
        libm::sin(k * angle - PI * k * (k - 1.0) / count)
    };
    (1..=lines).map(line).sum::<f64>() * (2.0 / count).sqrt()
}

impl Path {
    /// By a cycloid: peak velocity 2·way/time, peak acceleration 2π·way/time².
    #[must_use]
    pub fn cycloid(self, to: f64, pace: Pace) -> Self {
        let way = (to - self.end()).abs();
        let by_acceleration = (TAU * way / pace.acceleration).sqrt();
        let duration_s = (2.0 * way / pace.velocity).max(by_acceleration);
        self.leg(to, duration_s, Shape::Cycloid)
    }

    /// With least jerk and a sine on top, as a welder weaves: way and sine have half of the pace
    /// each, and the sine is amplitude·(1 − cos), which does not leave the way backward.
    #[must_use]
    pub fn weave(self, to: f64, pace: Pace, amplitude: f64) -> Self {
        let half = Pace {
            velocity: 0.5 * pace.velocity,
            acceleration: 0.5 * pace.acceleration,
        };
        let by_velocity = half.velocity / amplitude;
        let by_acceleration = (half.acceleration / amplitude).sqrt();
        let cycle_s = TAU / by_velocity.min(by_acceleration);
        let here = self.end();
        let way_s = Path::from(here).least_jerk(to, half).end_s();
        let cycles = (way_s / cycle_s).ceil().max(1.0);
        self.leg(to, cycles * cycle_s, Shape::Weave(amplitude, cycles))
    }
}

impl Room {
    /// Up and down without a rest, four strokes of one reach and pace at a time; slow ones are
    /// short.
    #[must_use]
    pub fn strokes(&self, draw: &mut Draw) -> Path {
        let middle = 0.5 * (self.low + self.high);
        let mut reach = 0.0;
        let mut pace = self.pace;
        self.filled(|path, turn| {
            if turn % 4 == 0 {
                let share = draw.between(0.1, 1.0);
                pace = self.pace.times(share);
                reach = (self.high - middle) * share * draw.between(0.2, 1.0);
            }
            let side = if turn % 2 == 0 { reach } else { -reach };
            path.cycloid(middle + side, pace)
        })
    }

    /// Steps of one pitch with short rests, and a long way back from the end.
    #[must_use]
    pub fn index(&self, draw: &mut Draw) -> Path {
        let pitch = (self.high - self.low) * draw.between(0.08, 0.14);
        self.filled(|path, _| {
            let next = path.end() + pitch;
            if next > self.high {
                let to = self.low + pitch * draw.between(0.0, 1.0);
                path.cycloid(to, self.pace.times(0.6)).rest(0.3)
            } else {
                let pace = self.pace.times(draw.between(0.2, 1.0));
                path.cycloid(next, pace).rest(draw.between(0.03, 0.15))
            }
        })
    }

    /// A target is followed slowly, one way and the other, and the next one is turned to quickly.
    #[must_use]
    pub fn tracking(&self, draw: &mut Draw) -> Path {
        self.filled(|path, turn| {
            if turn % 3 == 0 {
                return path.trapezoid(self.place(draw), self.pace);
            }
            let pace = self.pace.times(draw.between(0.01, 0.12));
            let middle = 0.5 * (self.low + self.high);
            let inward = (middle - path.end()).signum();
            let there = path.end() + inward * pace.velocity * draw.between(0.4, 1.6);
            let back = path.end() + (there - path.end()) * draw.between(0.1, 0.8);
            path.trapezoid(there, pace).trapezoid(back, pace)
        })
    }

    /// To drawn places with a sine on top.
    #[must_use]
    pub fn weaving(&self, draw: &mut Draw) -> Path {
        let width = self.high - self.low;
        self.filled(|path, turn| {
            let amplitude = width * draw.between(0.01, 0.08);
            let to = self.low + draw.between(0.0, 0.8) * width;
            let path = path.weave(to, self.pace.times(draw.between(0.2, 1.0)), amplitude);
            if turn % 3 == 2 { path.rest(0.2) } else { path }
        })
    }

    /// There and back at the pace, at half of it, and so on down to a sixty-fourth: what a curve
    /// of friction is taken from.
    #[must_use]
    pub fn ladder(&self, draw: &mut Draw) -> Path {
        let mut rung = 0;
        self.filled(|path, turn| {
            if turn % 2 == 0 {
                rung = (turn / 2) % 7;
            }
            let velocity = self.pace.velocity * libm::exp2(-(rung as f64));
            let pace = Pace {
                velocity,
                ..self.pace
            };
            let reach = (0.8 * velocity).min(0.45 * (self.high - self.low));
            let middle = 0.5 * (self.low + self.high);
            let side = if turn % 2 == 0 { 1.0 } else { -1.0 };
            path.trapezoid(middle + side * reach * draw.between(0.6, 1.0), pace)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{ROOM, assert_keeps_to_its_room, turns, worst};
    use super::*;

    fn programmes() -> [Path; 5] {
        let mut draw = Draw::of("trades", 1);
        [
            ROOM.strokes(&mut draw),
            ROOM.index(&mut draw),
            ROOM.tracking(&mut draw),
            ROOM.weaving(&mut draw),
            ROOM.ladder(&mut draw),
        ]
    }

    #[test]
    fn a_motion_keeps_to_its_room_and_its_pace_and_lasts() {
        assert_keeps_to_its_room(&programmes());
    }

    #[test]
    fn velocity_is_the_derivative_of_position_and_acceleration_that_of_velocity() {
        for (n, path) in programmes().iter().enumerate() {
            let (velocity, _, kinks) = worst(path);
            assert!(velocity < 3.0e-5 && kinks < 0.01, "{n}: {velocity} {kinks}");
        }
    }

    #[test]
    fn every_motion_turns_round_often() {
        for (n, path) in programmes().iter().enumerate() {
            // An indexer goes one way until its end.
            let least = if n == 1 { 2 } else { 8 };
            let (turns, _) = turns(path);
            assert!(turns >= least, "{n}: {turns}");
        }
    }

    #[test]
    fn sines_of_schroeders_phases_have_deviation_one_and_a_low_crest() {
        let values: Vec<f64> = (0..10_000)
            .map(|k| schroeder(TAU * f64::from(k) * 1.0e-4, 24))
            .collect();
        let rms = (values.iter().map(|v| v * v).sum::<f64>() / 1.0e4).sqrt();
        let most = values.iter().fold(0.0_f64, |m, v| v.abs().max(m));
        assert!((rms - 1.0).abs() < 1.0e-9 && most < 2.0, "{rms} {most}");
    }
}
