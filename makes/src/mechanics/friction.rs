//! Friction of a surface: a law, and what scales its level.
//!
//! - rigid: Fc(v)·sign v, holds at rest. Coulomb; Stribeck's fall with an exponent:
//!   Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30, 1994.
//! - smooth: Fc·tanh(v/knee), a regularised sign, which creeps at rest.
//! - Dahl: dz = dx·(1 − z·sign(dx)/z_max). Dahl, Aerospace report TOR-158, 1968.
//! - LuGre: dz/dt = v − σ₀|v|z/g(v), F = σ₀z + σ₁(v)·dz/dt. Canudas de Wit et al., IEEE TAC 40,
//!   1995; σ₁ that fades with velocity: Olsson, thesis, Lund 1996.
//! - Maxwell slip: elastoplastic elements side by side. Lampaert, Swevers and Al-Bender, IEEE TAC
//!   47, 2002.
//! - generalised Maxwell slip: the same with a Stribeck curve that friction lags behind; see
//!   [`gms`].
//! - Bouc–Wen: dz = dx·(1 − ½(1 + sign(dx z))·|z|ⁿ). Wen, ASCE J. Eng. Mech. 102, 1976.
//! - thixotropic: Fc·(1 + surplus·λ), dλ/dt = (1 − λ)/τ − |v|·λ/way: sludge and cold grease set at
//!   rest and are stirred thin. Moore, Trans. British Ceramic Society 58, 1959.
//! - brake: a level that is there for a time after every start, from when it has stood for another
//!   time: a holding brake that opens late.
//!
//! A rigid law gives a *level*, not a force: at rest it is whatever holds, and the step of the
//! train finds it. The others give a force and keep a state. Bristles of Dahl and LuGre are stepped
//! in closed form over the way dx, so that they cannot overshoot.

pub mod gms;

use crate::mechanics::friction::gms::{GeneralisedMaxwellSlip, STATES_OF_ONE};

/// Fall of friction with velocity: Fc·(1 + excess·exp(−(|v|/velocity)^exponent)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck {
    /// Breakaway beyond the sliding level, as a share of it.
    pub excess: f64,
    /// Velocity at which 1/e of the excess is left.
    pub velocity: f64,
    /// 2 with Stribeck and Gauss, 1 with Tustin, ½ with Bo and Pavelescu.
    pub exponent: f64,
}

impl Stribeck {
    fn factor(&self, velocity: f64) -> f64 {
        let power = libm::pow(velocity.abs() / self.velocity, self.exponent);
        1.0 + self.excess * libm::exp(-power)
    }
}

/// A spring that slips at its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Stiffness.
    pub stiffness: f64,
    /// Limit.
    pub limit: f64,
}

/// A law of friction; levels in N or N m.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// Coulomb friction that holds at rest, perhaps with a fall at low velocity.
    Rigid {
        /// Sliding level.
        coulomb: f64,
        /// Fall.
        stribeck: Option<Stribeck>,
    },
    /// Coulomb friction with a steep tanh.
    Smooth {
        /// Sliding level.
        coulomb: f64,
        /// Velocity of the knee.
        knee: f64,
    },
    /// Dahl's law with exponent one.
    Dahl {
        /// Sliding level.
        coulomb: f64,
        /// Stiffness at reversal.
        stiffness: f64,
    },
    /// LuGre.
    LuGre {
        /// Sliding level.
        coulomb: f64,
        /// Fall.
        stribeck: Option<Stribeck>,
        /// σ₀.
        stiffness: f64,
        /// σ₁ at rest.
        micro_damping: f64,
        /// Velocity at which σ₁ has faded to 1/e.
        fade_velocity: f64,
    },
    /// Elements side by side.
    MaxwellSlip {
        /// The elements.
        elements: Vec<Element>,
    },
    /// Elements side by side that follow a curve with a lag.
    GeneralisedMaxwellSlip(GeneralisedMaxwellSlip),
    /// Bouc–Wen with β = γ.
    BoucWen {
        /// Sliding level.
        coulomb: f64,
        /// Stiffness at zero force.
        stiffness: f64,
        /// n.
        exponent: f64,
    },
    /// What sets at rest and is stirred thin.
    Thixotropic {
        /// Level where it is stirred thin.
        coulomb: f64,
        /// What comes on top where it has set, as a share.
        surplus: f64,
        /// Time in which 63 % of it comes back at rest, s.
        sets_in_s: f64,
        /// Way over which 63 % of it goes.
        way: f64,
    },
    /// A holding brake.
    Brake {
        /// Level while it is closed.
        holds: f64,
        /// Time after a start until it opens, s.
        opens_in_s: f64,
        /// Time at rest until it closes, s.
        closes_in_s: f64,
    },
}

impl Law {
    /// Coulomb friction without a fall.
    #[must_use]
    pub fn coulomb(coulomb: f64) -> Self {
        Self::Rigid {
            coulomb,
            stribeck: None,
        }
    }

    /// Maxwell slip of so many elements that share a level; they slip one after the other, evenly
    /// up to a deflection.
    #[must_use]
    pub fn maxwell_slip(coulomb: f64, deflection: f64, count: usize) -> Self {
        let limit = coulomb / count as f64;
        let way = |i: usize| deflection * (i + 1) as f64 / count as f64;
        let element = |i: usize| Element {
            stiffness: limit / way(i),
            limit,
        };
        Self::MaxwellSlip {
            elements: (0..count).map(element).collect(),
        }
    }

    /// The level while it slides.
    #[must_use]
    pub fn level(&self) -> f64 {
        match self {
            Self::Rigid { coulomb, .. }
            | Self::Smooth { coulomb, .. }
            | Self::Dahl { coulomb, .. }
            | Self::LuGre { coulomb, .. }
            | Self::BoucWen { coulomb, .. }
            | Self::Thixotropic { coulomb, .. } => *coulomb,
            Self::Brake { .. } => 0.0,
            Self::MaxwellSlip { elements } => elements.iter().map(|e| e.limit).sum(),
            Self::GeneralisedMaxwellSlip(law) => law.coulomb,
        }
    }

    /// Level over stiffness at a reversal; zero where it is rigid.
    #[must_use]
    pub fn deflection(&self) -> f64 {
        match self {
            Self::Rigid { .. }
            | Self::Smooth { .. }
            | Self::Thixotropic { .. }
            | Self::Brake { .. } => 0.0,
            Self::Dahl { coulomb, stiffness }
            | Self::LuGre {
                coulomb, stiffness, ..
            }
            | Self::BoucWen {
                coulomb, stiffness, ..
            } => coulomb / stiffness,
            Self::MaxwellSlip { elements } => {
                self.level() / elements.iter().map(|e| e.stiffness).sum::<f64>()
            }
            Self::GeneralisedMaxwellSlip(law) => law.coulomb / law.stiffness(),
        }
    }

    /// The same law with its level times a factor; stiffness stays.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        match &mut self {
            Self::Rigid { coulomb, .. }
            | Self::Smooth { coulomb, .. }
            | Self::Dahl { coulomb, .. }
            | Self::LuGre { coulomb, .. }
            | Self::BoucWen { coulomb, .. }
            | Self::Thixotropic { coulomb, .. } => *coulomb *= factor,
            Self::Brake { holds, .. } => *holds *= factor,
            Self::MaxwellSlip { elements } => elements.iter_mut().for_each(|e| e.limit *= factor),
            Self::GeneralisedMaxwellSlip(law) => law.coulomb *= factor,
        }
        self
    }

    /// How many numbers its state has.
    #[must_use]
    pub fn states(&self) -> usize {
        match self {
            Self::Rigid { .. } | Self::Smooth { .. } => 0,
            Self::Dahl { .. }
            | Self::LuGre { .. }
            | Self::BoucWen { .. }
            | Self::Thixotropic { .. } => 1,
            Self::Brake { .. } => 2,
            Self::MaxwellSlip { elements } => elements.len(),
            Self::GeneralisedMaxwellSlip(law) => STATES_OF_ONE * law.elements.len(),
        }
    }

    /// What it does over a way, with its state moved on.
    fn slide(&self, state: &mut [f64], velocity: f64, step_s: f64) -> Reaction {
        let way = velocity * step_s;
        match self {
            Self::Rigid { coulomb, stribeck } => {
                Reaction::level(coulomb * fall(*stribeck, velocity))
            }
            Self::Smooth { coulomb, knee } => {
                Reaction::force(coulomb * libm::tanh(velocity / knee))
            }
            Self::Dahl { coulomb, stiffness } => {
                Reaction::force(stiffness * bristle(&mut state[0], way, coulomb / stiffness))
            }
            Self::LuGre {
                coulomb,
                stribeck,
                stiffness,
                micro_damping,
                fade_velocity,
            } => {
                let before = state[0];
                let longest = coulomb * fall(*stribeck, velocity) / stiffness;
                let after = bristle(&mut state[0], way, longest);
                let fade = libm::exp(-(velocity / fade_velocity) * (velocity / fade_velocity));
                let rate = (after - before) / step_s;
                Reaction::force(stiffness * after + micro_damping * fade * rate)
            }
            Self::MaxwellSlip { elements } => {
                let mut total = 0.0;
                for (force, element) in state.iter_mut().zip(elements) {
                    *force =
                        (*force + element.stiffness * way).clamp(-element.limit, element.limit);
                    total += *force;
                }
                Reaction::force(total)
            }
            Self::GeneralisedMaxwellSlip(law) => {
                Reaction::force(law.slide(state, velocity, step_s))
            }
            Self::BoucWen {
                coulomb,
                stiffness,
                exponent,
            } => {
                let z = &mut state[0];
                let against = 0.5 * (1.0 + sign(way * *z)) * libm::pow(z.abs(), *exponent);
                *z = (*z + way * stiffness / coulomb * (1.0 - against)).clamp(-1.0, 1.0);
                Reaction::force(coulomb * *z)
            }
            Self::Thixotropic {
                coulomb,
                surplus,
                sets_in_s,
                way: thins_over,
            } => {
                // The state is what is stirred, so that it has set at the start.
                let rates = [1.0 / sets_in_s, velocity.abs() / thins_over];
                let sum = rates[0] + rates[1];
                let end = rates[1] / sum;
                state[0] = end + (state[0] - end) * libm::exp(-sum * step_s);
                Reaction::level(coulomb * (1.0 + surplus * (1.0 - state[0])))
            }
            Self::Brake {
                holds,
                opens_in_s,
                closes_in_s,
            } => {
                let [stood_s, moved_s] = [state[0], state[1]];
                if velocity == 0.0 {
                    state[0] += step_s;
                    if stood_s >= *closes_in_s {
                        state[1] = 0.0;
                    }
                } else {
                    state[0] = 0.0;
                    state[1] += step_s;
                }
                Reaction::level(if moved_s < *opens_in_s { *holds } else { 0.0 })
            }
        }
    }
}

fn fall(stribeck: Option<Stribeck>, velocity: f64) -> f64 {
    stribeck.map_or(1.0, |law| law.factor(velocity))
}

/// dz = dx·(1 − z·sign(dx)/longest) in closed form.
fn bristle(z: &mut f64, way: f64, longest: f64) -> f64 {
    let end = longest * sign(way);
    *z = end + (*z - end) * libm::exp(-way.abs() / longest);
    *z
}

/// Sign with sign(0) = 0.
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// What changes the level of a surface: factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// 1 + share · x.
    Slope(f64),
    /// 1 + share · x²: guides that bind toward both ends.
    Bowl(f64),
    /// 1 + share · exp(−((x − centre)/width)²): a worn or dirty place.
    Bump {
        /// Centre.
        centre: f64,
        /// Half width at 1/e.
        width: f64,
        /// Height.
        share: f64,
    },
    /// 1 + share · cos(waves · x + phase): a disc or a roller that is out of round.
    Wavy {
        /// Share.
        share: f64,
        /// Wave number, rad per unit of position.
        waves: f64,
        /// Phase at position zero, rad.
        phase: f64,
    },
    /// 1 + surplus · exp(−t/τ): warms up from the start of the record.
    WarmUp {
        /// Surplus at the start.
        surplus: f64,
        /// Time constant, s.
        time_constant_s: f64,
    },
    /// 1 + excess/(1 + (v/velocity)²): a film that builds up with speed (Hess and Soom, ASME J.
    /// Tribology 112, 1990). Slower to fall than Stribeck's: a tenth is left at three times the
    /// velocity.
    Film(f64, f64),
    /// 1 + share · |transmitted effort|: worm, trapezoidal nut, gib.
    Load(f64),
    /// 1 + share · direction.
    Direction(f64),
    /// 1 + share · x · direction: a cable chain that is rolled up one way and laid down the other.
    Chain(f64),
    /// 1 + share from a time to another, s: a brake that drags.
    During(f64, f64, f64),
    /// 1 + share in the first part of every period: ultrasound that is switched on and off.
    Pulsed {
        /// Share.
        share: f64,
        /// How long it is there, s.
        lasts_s: f64,
        /// From one time to the next, s.
        period_s: f64,
    },
    /// 1 + share · what has gone of every period: a lubricator gives oil at its start.
    Oiled {
        /// Share at the end of a period.
        share: f64,
        /// From one shot of oil to the next, s.
        period_s: f64,
    },
}

/// Where and how a surface slides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Direction of motion, or that in which it would move.
    pub direction: f64,
    /// Effort that is transmitted to this body.
    pub transmitted: f64,
    /// Time, s.
    pub time_s: f64,
}

impl Scale {
    /// The factor of a curve over the travel in its middle; of anything else, one.
    #[must_use]
    pub fn amid(&self) -> f64 {
        match self {
            Self::Slope(_) | Self::Bowl(_) | Self::Bump { .. } => self.factor(&Contact::default()),
            _ => 1.0,
        }
    }

    /// The factor.
    #[must_use]
    pub fn factor(&self, at: &Contact) -> f64 {
        let change = match *self {
            Self::Slope(share) => share * at.position,
            Self::Bowl(share) => share * at.position * at.position,
            Self::Bump {
                centre,
                width,
                share,
            } => {
                let s = (at.position - centre) / width;
                share * libm::exp(-s * s)
            }
            Self::Wavy {
                share,
                waves,
                phase,
            } => share * libm::cos(waves * at.position + phase),
            Self::WarmUp {
                surplus,
                time_constant_s,
            } => surplus * libm::exp(-at.time_s / time_constant_s),
            Self::Film(excess, velocity) => {
                let ratio = at.velocity / velocity;
                excess / (1.0 + ratio * ratio)
            }
            Self::Load(share) => share * at.transmitted.abs(),
            Self::Direction(share) => share * at.direction,
            Self::Chain(share) => share * at.position * at.direction,
            Self::During(share, from_s, to_s) => {
                if (from_s..to_s).contains(&at.time_s) {
                    share
                } else {
                    0.0
                }
            }
            Self::Pulsed {
                share,
                lasts_s,
                period_s,
            } => {
                let is_there = at.time_s.rem_euclid(period_s) < lasts_s;
                if is_there { share } else { 0.0 }
            }
            Self::Oiled { share, period_s } => share * at.time_s.rem_euclid(period_s) / period_s,
        };
        (1.0 + change).max(0.0)
    }
}

/// A surface of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Which body.
    pub body: usize,
    /// Its law.
    pub law: Law,
    /// What scales its level.
    pub scales: Vec<Scale>,
}

/// What a surface does: a force that is known, and a level that may hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction {
    /// Force against positive motion.
    pub force: f64,
    /// Largest force that opposes motion, or holds.
    pub level: f64,
}

impl Reaction {
    fn force(force: f64) -> Self {
        Self { force, level: 0.0 }
    }

    fn level(level: f64) -> Self {
        Self { force: 0.0, level }
    }
}

impl Surface {
    /// A surface whose level nothing scales.
    #[must_use]
    pub fn new(body: usize, law: Law) -> Self {
        Self {
            body,
            law,
            scales: Vec::new(),
        }
    }

    /// With one more scale.
    #[must_use]
    pub fn with(mut self, scale: Scale) -> Self {
        self.scales.push(scale);
        self
    }

    /// What it does in a step; moves its state on.
    pub fn react(&self, state: &mut [f64], contact: &Contact, step_s: f64) -> Reaction {
        let factor: f64 = self.scales.iter().map(|s| s.factor(contact)).product();
        let reaction = self.law.slide(state, contact.velocity, step_s);
        Reaction {
            force: factor * reaction.force,
            level: factor * reaction.level,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force of a law along a way at constant speed.
    fn along(law: &Law, state: &mut [f64], way: f64) -> f64 {
        let mut force = 0.0;
        for _ in 0..10_000 {
            force = law
                .slide(state, way.signum() * 1.0, way.abs() * 1.0e-4)
                .force;
        }
        force
    }

    fn hysteretic() -> [Law; 5] {
        let lugre = Law::LuGre {
            coulomb: 10.0,
            stribeck: None,
            stiffness: 1.0e6,
            micro_damping: 0.0,
            fade_velocity: 1.0,
        };
        let bouc_wen = Law::BoucWen {
            coulomb: 10.0,
            stiffness: 1.0e6,
            exponent: 1.5,
        };
        let dahl = Law::Dahl {
            coulomb: 10.0,
            stiffness: 1.0e6,
        };
        let maxwell_slip = Law::maxwell_slip(10.0, 2.0e-5, 8);
        let general = Law::generalised_maxwell_slip(10.0, None, 5.0e-3, 2.0e-5, 8);
        [dahl, lugre, bouc_wen, maxwell_slip, general]
    }

    #[test]
    fn far_from_a_reversal_every_law_has_its_level() {
        for law in hysteretic() {
            let mut state = vec![0.0; law.states()];
            assert!(
                (along(&law, &mut state, 1.0e-3) - 10.0).abs() < 1.0e-3,
                "{law:?}"
            );
            assert!(
                (along(&law, &mut state, -1.0e-3) + 10.0).abs() < 1.0e-3,
                "{law:?}"
            );
        }
    }

    #[test]
    fn presliding_is_stiff_first_and_soft_later() {
        for law in hysteretic() {
            let mut state = vec![0.0; law.states()];
            let first = along(&law, &mut state, 1.0e-6);
            let more = along(&law, &mut state, 9.0e-6);
            assert!(
                first > 0.4 && more < 10.0 * first && more > first,
                "{law:?}"
            );
        }
    }

    #[test]
    fn a_deflection_is_the_level_over_the_stiffness_at_a_reversal() {
        for law in hysteretic() {
            let mut state = vec![0.0; law.states()];
            let way = 1.0e-4 * law.deflection();
            let share = along(&law, &mut state, way) / law.level();
            assert!((share / 1.0e-4 - 1.0).abs() < 1.0e-3, "{law:?}: {share}");
        }
        assert_eq!(Law::coulomb(10.0).deflection(), 0.0);
        // 10 µm over 1 + 1/2 + 1/3 + 1/4 of a quarter each.
        let four = Law::maxwell_slip(10.0, 1.0e-5, 4).deflection();
        assert!((four - 4.8e-6).abs() < 1.0e-12, "{four}");
    }

    /// Masing: the branch after a reversal is the virgin curve, twice as large; and a small loop
    /// closes where it began (Al-Bender and Swevers, IEEE Control Systems 28, 2008).
    #[test]
    fn loops_of_maxwell_slip_close_by_masings_rules() {
        let law = Law::maxwell_slip(10.0, 2.0e-5, 8);
        let mut state = vec![0.0; 8];
        let virgin = along(&law, &mut state, 6.0e-6);
        let mut branch = vec![0.0; 8];
        let top = along(&law, &mut branch, 1.5e-5);
        let after = along(&law, &mut branch, -1.2e-5);
        assert!((top - after - 2.0 * virgin).abs() < 1.0e-9);
        let closed = along(&law, &mut branch, 1.2e-5);
        assert!((closed - top).abs() < 1.0e-9);
    }

    #[test]
    fn a_small_loop_of_dahl_drifts_as_it_is_known_to() {
        let law = Law::Dahl {
            coulomb: 10.0,
            stiffness: 1.0e6,
        };
        let mut state = vec![0.0];
        let top = along(&law, &mut state, 1.5e-5);
        along(&law, &mut state, -5.0e-6);
        assert!(along(&law, &mut state, 5.0e-6) < top - 0.01);
    }

    #[test]
    fn sliding_takes_energy_and_never_gives_it() {
        for law in hysteretic() {
            let mut state = vec![0.0; law.states()];
            let mut work = 0.0;
            for k in 0..40_000 {
                let velocity = libm::cos(f64::from(k) * 1.0e-3);
                work += law.slide(&mut state, velocity, 1.0e-8).force * velocity * 1.0e-8;
            }
            assert!(work > 0.0, "{law:?}");
        }
    }

    #[test]
    fn the_fall_has_its_exponent() {
        for exponent in [0.5, 1.0, 2.0] {
            let law = Stribeck {
                excess: 0.5,
                velocity: 0.01,
                exponent,
            };
            assert!((law.factor(0.01) - 1.0 - 0.5 / std::f64::consts::E).abs() < 1.0e-12);
            let power = libm::pow(4.0, exponent);
            assert!((law.factor(-0.04) - 1.0 - 0.5 * libm::exp(-power)).abs() < 1.0e-12);
        }
    }

    #[test]
    fn micro_damping_fades_with_velocity() {
        let law = Law::LuGre {
            coulomb: 10.0,
            stribeck: None,
            stiffness: 1.0e6,
            micro_damping: 100.0,
            fade_velocity: 0.01,
        };
        let at = |velocity: f64| law.slide(&mut [0.0], velocity, 1.0e-9).force / velocity;
        assert!((at(1.0e-4) - 100.0).abs() < 0.1);
        assert!((at(0.01) - 100.0 / std::f64::consts::E).abs() < 0.1);
    }

    const CONTACT: Contact = Contact {
        position: 0.2,
        velocity: -0.1,
        direction: -1.0,
        transmitted: -50.0,
        time_s: 10.0,
    };

    #[test]
    fn scales_are_what_they_say() {
        let warm = Scale::WarmUp {
            surplus: 0.4,
            time_constant_s: 10.0,
        };
        let bump = Scale::Bump {
            centre: 0.1,
            width: 0.1,
            share: 0.4,
        };
        let pulsed = |lasts_s| Scale::Pulsed {
            share: -0.3,
            lasts_s,
            period_s: 4.0,
        };
        let oiled = Scale::Oiled {
            share: 0.6,
            period_s: 4.0,
        };
        let table = [
            (pulsed(2.5), 0.7),
            (pulsed(1.5), 1.0),
            (Scale::Slope(0.5), 1.1),
            (Scale::Bowl(2.5), 1.1),
            (bump, 1.0 + 0.4 / std::f64::consts::E),
            (warm, 1.0 + 0.4 / std::f64::consts::E),
            (Scale::Film(0.5, 0.1), 1.25),
            (Scale::Film(0.5, 0.05), 1.1),
            (Scale::Load(0.002), 1.1),
            (Scale::Direction(0.1), 0.9),
            (Scale::Chain(0.5), 0.9),
            (Scale::During(0.3, 9.0, 11.0), 1.3),
            (Scale::During(0.3, 11.0, 12.0), 1.0),
            (oiled, 1.3),
        ];
        for (scale, factor) in table {
            assert!(
                (scale.factor(&CONTACT) - factor).abs() < 1.0e-12,
                "{scale:?}"
            );
        }
    }

    /// Level of a law after a time at constant speed.
    fn level_after(law: &Law, state: &mut [f64], velocity: f64, time_s: f64) -> f64 {
        let mut level = 0.0;
        for _ in 0..10_000 {
            level = law.slide(state, velocity, time_s * 1.0e-4).level;
        }
        level
    }

    #[test]
    fn sludge_is_thin_once_it_is_stirred_and_sets_at_rest() {
        let sludge = Law::Thixotropic {
            coulomb: 10.0,
            surplus: 0.8,
            sets_in_s: 2.0,
            way: 0.5,
        };
        let mut state = [0.0];
        // Stirred at 1 m/s it comes to rates of ½ and 2 per second: a fifth of the surplus.
        let stirred = level_after(&sludge, &mut state, 1.0, 10.0);
        assert!((stirred - 11.6).abs() < 1.0e-6, "{stirred}");
        let set = level_after(&sludge, &mut state, 0.0, 2.0);
        // 0.2 and 63.2 % of the rest of 0.8
        assert!(
            (set - (18.0 - 8.0 * 0.8 * 0.367_879)).abs() < 1.0e-2,
            "{set}"
        );
        assert_eq!(sludge.level(), 10.0);
    }

    #[test]
    fn a_brake_that_opens_late_holds_for_its_time_after_a_start_and_again_after_a_rest() {
        let brake = Law::Brake {
            holds: 40.0,
            opens_in_s: 0.1,
            closes_in_s: 0.3,
        };
        let mut state = [0.0; 2];
        assert_eq!(level_after(&brake, &mut state, 0.2, 0.09), 40.0);
        assert_eq!(level_after(&brake, &mut state, 0.2, 0.02), 0.0);
        assert_eq!(level_after(&brake, &mut state, 0.0, 0.2), 0.0);
        assert_eq!(level_after(&brake, &mut state, 0.2, 0.2), 0.0);
        assert_eq!(level_after(&brake, &mut state, 0.0, 0.4), 40.0);
        assert_eq!(brake.level(), 0.0);
    }

    #[test]
    fn what_is_out_of_round_rubs_most_once_a_turn() {
        let felt = Scale::Wavy {
            share: 0.4,
            waves: 1.0,
            phase: 0.0,
        };
        let factor = |position| {
            let at = Contact {
                position,
                velocity: 1.0,
                direction: 1.0,
                transmitted: 0.0,
                time_s: 0.0,
            };
            felt.factor(&at)
        };
        assert!((factor(0.0) - 1.4).abs() < 1.0e-12);
        assert!((factor(std::f64::consts::PI) - 0.6).abs() < 1.0e-12);
    }
}
