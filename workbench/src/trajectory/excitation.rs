//! What `commission` moves to record an axis: sines from slow to fast at several places of the
//! travel, those that tell most in the time ([`design`]).

mod design;
mod information;

use plant_sim::machine::MachineAxis;

use super::Move;
use super::windowed_sine::WindowedSine;
use design::Menu;

/// Both records together take a minute of the machine at most.
const TRAINING: Menu = Menu {
    velocity: 1.0,
    acceleration: 1.0,
    centres: &[0.0, 0.3, 0.6, -0.3, -0.6],
    time_s: 37.0,
};
/// The validation record moves otherwise: another share of everything.
const VALIDATION: Menu = Menu {
    velocity: 0.8,
    acceleration: 0.65,
    centres: &[-0.1, 0.2, 0.5, -0.45],
    time_s: 23.0,
};
/// Shares of the limits with which an axis goes from centre to centre, at most.
const WAY: f64 = 0.6;
/// Share of what friction alone would slow the load of a usual axis down with. A load that is
/// slowed down harder runs across a gap ahead of its motor, though that does not reverse.
const WAY_OF_FRICTION: f64 = 0.5;
/// The most of a record's time that is spent on ways.
const ON_THE_WAY: f64 = 0.3;
/// Rest before each motion and after the last one.
const REST_S: f64 = 0.3;

/// The setpoint of a record as a function of time: from rest at zero to rest at zero.
#[derive(Clone, Debug)]
pub struct Excitation {
    parts: Vec<Part>,
    duration_s: f64,
}

#[derive(Clone, Debug)]
struct Part {
    begin_s: f64,
    motion: Motion,
}

#[derive(Clone, Debug)]
enum Motion {
    Rest(f64),
    Way(Move),
    Sine(WindowedSine),
}

impl Excitation {
    /// Of an axis whose loop has a period: of the training record, or of the validation record.
    #[must_use]
    pub fn of(axis: &MachineAxis, period_s: f64, is_validation: bool) -> Self {
        let menu = if is_validation { VALIDATION } else { TRAINING };
        let axis = within_reach(axis, &menu);
        let left_s = menu.time_s - ways_s(&axis, menu.centres);
        let sines = design::design(&axis, period_s, &menu, left_s);
        let mut all = Self {
            parts: Vec::new(),
            duration_s: 0.0,
        };
        let mut at_m = 0.0;
        for sine in sines {
            all.add_way(&axis, at_m, sine.centre_m);
            all.add(Motion::Sine(sine), sine.duration_s());
            at_m = sine.centre_m;
        }
        all.add_way(&axis, at_m, 0.0);
        all
    }

    /// A rest, the way to another place, and a rest.
    fn add_way(&mut self, axis: &MachineAxis, from_m: f64, to_m: f64) {
        self.add(Motion::Rest(from_m), REST_S);
        if from_m != to_m {
            let way = way(axis, from_m, to_m);
            let duration_s = way.duration_s();
            self.add(Motion::Way(way), duration_s);
            self.add(Motion::Rest(to_m), REST_S);
        }
    }

    fn add(&mut self, motion: Motion, duration_s: f64) {
        let begin_s = self.duration_s;
        self.parts.push(Part { begin_s, motion });
        self.duration_s += duration_s;
    }

    /// Of the record, s.
    #[must_use]
    pub const fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Setpoint at a time, m; at rest before and after.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        if time_s >= self.duration_s {
            return 0.0;
        }
        let after = self.parts.partition_point(|part| part.begin_s <= time_s);
        let part = after.checked_sub(1).map(|place| &self.parts[place]);
        part.map_or(0.0, |part| part.motion.at(time_s - part.begin_s))
    }
}

/// The axis with the part of its travel that it can reach in a share of the time.
fn within_reach(axis: &MachineAxis, menu: &Menu) -> MachineAxis {
    let mut axis = axis.clone();
    while ways_s(&axis, menu.centres) > ON_THE_WAY * menu.time_s {
        axis.limits.travel_m *= 0.5;
    }
    axis
}

fn way(axis: &MachineAxis, from_m: f64, to_m: f64) -> Move {
    let limits = axis.limits;
    let gentle = WAY_OF_FRICTION * design::coasting_m_per_s2(axis);
    let hardest = f64::min(WAY * limits.acceleration_m_per_s2, gentle);
    Move::new(&[from_m], &[to_m], WAY * limits.velocity_m_per_s, hardest)
}

/// How long all ways and their rests take: from zero through all centres and back.
fn ways_s(axis: &MachineAxis, centres: &[f64]) -> f64 {
    let places = centres.iter().map(|share| share * axis.limits.travel_m);
    let places: Vec<f64> = [0.0].into_iter().chain(places).chain([0.0]).collect();
    let of_way = |ends: &[f64]| way(axis, ends[0], ends[1]).duration_s() + REST_S;
    REST_S + places.windows(2).map(of_way).sum::<f64>()
}

impl Motion {
    fn at(&self, time_s: f64) -> f64 {
        match self {
            Self::Rest(place_m) => *place_m,
            Self::Way(way) => way.at(time_s)[0],
            Self::Sine(sine) => sine.at(time_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant_sim::Machine;

    /// The reference axis, and one of a desktop stage.
    fn axes() -> [MachineAxis; 2] {
        let axis = Machine::reference().axes.swap_remove(0);
        let mut small = axis.clone();
        small.limits.velocity_m_per_s = 0.05;
        small.limits.acceleration_m_per_s2 = 1.0;
        small.limits.travel_m = 0.05;
        small.actual.force_limit_n = 200.0;
        small.actual.mechanics.motor_inertia_kg = 8.0;
        small.actual.mechanics.table_mass_kg = 2.0;
        small.actual.lead_m_per_rev = 0.002;
        [axis, small]
    }

    fn both(axis: &MachineAxis) -> [Excitation; 2] {
        [false, true].map(|is_validation| Excitation::of(axis, 1.0e-3, is_validation))
    }

    #[test]
    fn both_records_take_a_minute_of_the_machine_at_most() {
        for axis in axes() {
            let [train_s, validate_s] = both(&axis).map(|own| own.duration_s());
            assert!(train_s + validate_s <= 60.0, "{train_s} + {validate_s}");
            assert!(
                train_s > 30.0 && validate_s > 18.0,
                "{train_s} {validate_s}"
            );
        }
    }

    #[test]
    fn no_record_passes_the_limits_of_its_axis_and_each_ends_where_it_began() {
        for axis in axes() {
            let limits = axis.limits;
            for excitation in both(&axis) {
                let (dt, mut fastest, mut hardest) = (1.0e-3, 0.0_f64, 0.0_f64);
                let rows = (excitation.duration_s() / dt) as usize + 2;
                for row in 1..rows {
                    let t = dt * row as f64;
                    let [a, b, c] = [t - dt, t, t + dt].map(|t| excitation.at(t));
                    fastest = fastest.max(((c - a) / (2.0 * dt)).abs());
                    hardest = hardest.max(((c - 2.0 * b + a) / (dt * dt)).abs());
                    assert!(b.abs() < limits.travel_m);
                }
                assert!(fastest < limits.velocity_m_per_s, "{fastest}");
                assert!(hardest < limits.acceleration_m_per_s2, "{hardest}");
                assert_eq!(
                    (excitation.at(0.0), excitation.at(dt * rows as f64)),
                    (0.0, 0.0)
                );
            }
        }
    }

    /// `| mm | mm/s | m/s² | mm | Hz | s |` for each sine.
    fn rows(excitation: &Excitation) -> Vec<String> {
        let row = |part: &Part| match &part.motion {
            Motion::Sine(sine) => Some(format!(
                "| {:.0} | {:.1} | {:.3} | {:.2} | {:.2} | {:.1} |",
                1.0e3 * sine.centre_m,
                1.0e3 * sine.velocity_m_per_s,
                sine.acceleration_m_per_s2,
                1.0e3 * sine.amplitude_m(),
                sine.period_s().recip(),
                sine.duration_s()
            )),
            Motion::Rest(_) | Motion::Way(_) => None,
        };
        excitation.parts.iter().filter_map(row).collect()
    }

    #[test]
    fn the_page_has_the_sines_of_the_reference_axis() {
        let page = include_str!("../../../docs/excitation.md");
        let [axis, _] = axes();
        for (excitation, title) in both(&axis).iter().zip(["Training", "Validation"]) {
            let rows = rows(excitation).join("\n");
            let title = format!("{title}, {:.1} s", excitation.duration_s());
            println!("{title}\n{rows}");
            assert!(
                page.contains(&title) && page.contains(&rows),
                "{title}\n{rows}"
            );
        }
    }

    #[test]
    fn slow_axes_with_long_travel_and_quick_ones_with_a_short_one_move_in_the_time_too() {
        for (velocity, acceleration, travel) in [
            (0.02, 0.2, 2.0),
            (0.02, 5.0, 0.01),
            (0.1, 0.5, 0.5),
            (3.0, 50.0, 1.0),
            (1.0, 100.0, 0.02),
        ] {
            let [mut axis, _] = axes();
            axis.limits.velocity_m_per_s = velocity;
            axis.limits.acceleration_m_per_s2 = acceleration;
            axis.limits.travel_m = travel;
            let all = both(&axis);
            let durations_s = all.each_ref().map(Excitation::duration_s);
            assert!(durations_s.iter().sum::<f64>() <= 60.0, "{durations_s:?}");
            for own in all {
                let is_sine = |part: &&Part| matches!(part.motion, Motion::Sine(_));
                let sines = own.parts.iter().filter(is_sine).count();
                assert!(sines >= 4, "{velocity} {acceleration} {travel}: {sines}");
            }
        }
    }

    #[test]
    fn each_record_goes_slowly_and_fast_at_several_places_of_the_travel() {
        for axis in axes() {
            for menu in [TRAINING, VALIDATION] {
                let sines = design::design(&axis, 1.0e-3, &menu, menu.time_s);
                let share =
                    |sine: &WindowedSine| sine.velocity_m_per_s / axis.limits.velocity_m_per_s;
                assert!(sines.iter().any(|sine| share(sine) < 0.06));
                assert!(sines.iter().any(|sine| share(sine) > 0.3));
                let places = sines.iter().map(|sine| sine.centre_m);
                let (low, high) = places.fold((0.0_f64, 0.0_f64), |(low, high), x| {
                    (low.min(x), high.max(x))
                });
                assert!(high - low > 0.5 * axis.limits.travel_m, "{low} {high}");
            }
        }
    }
}
