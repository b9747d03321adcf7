//! Payload: from a time t0 on there is more inertia, or less, with the Coulomb friction and the
//! weight that come with it: `(Δm a + Δf sign(v) + w) · 1[t > t0]`.
//!
//! What makes it a payload is the inertia. A part on a vertical axis brings its weight too, a part
//! on a slide presses on the guide. But friction or a force that change at a time without inertia
//! are something else (a brake that drags, an axis that tilts), so the three columns must beat the
//! two without inertia ([`StepOfForce`]). A drive that delivers more or less from a time on is no
//! payload either: it changes the whole effort by a share, friction too ([`StrongerDrive`]). And a
//! payload comes at once: what changes little by little is a warm-up ([`GradualChange`]).
//!
//! Time counts from the start of a record, as with `friction_drift`.

use axis_model::EffectName;

use super::by_motion::ByMotion;
use super::{Action, Against, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// (Δm a + Δf sign(v) + w) from a time on.
pub(crate) struct Payload;

/// The same without inertia.
pub(crate) struct StepOfForce;

/// A share of the effort that the motion predicts, from a time on.
pub(crate) struct StrongerDrive;

/// Inertia, friction and a force that change little by little, as parabolas of the time.
pub(crate) struct GradualChange;

/// Times that are tried, over the duration: every fiftieth part, as long as a twentieth of the
/// record is left on both sides.
const TRIED: u32 = 50;
const BOUNDS: (f64, f64) = (0.05, 0.95);
/// Two payloads come at least so far apart, s: a block of the evidence.
const LEAST_DISTANCE_S: f64 = 1.0;

fn is_there(time_s: f64, from_s: f64) -> f64 {
    f64::from(u8::from(time_s > from_s))
}

/// A column from a time on.
fn from_then_on(motion: &Kinematics, from_s: f64, what: impl Fn(usize) -> f64) -> Vec<f64> {
    let times = motion.time_s.iter().enumerate();
    times
        .map(|(row, t)| is_there(*t, from_s) * what(row))
        .collect()
}

/// Friction and force from a time on.
fn friction_and_force(motion: &Kinematics, from_s: f64) -> [Vec<f64>; 2] {
    [
        from_then_on(motion, from_s, |row| motion.direction[row]),
        from_then_on(motion, from_s, |_| 1.0),
    ]
}

impl Effect for Payload {
    fn called(&self) -> Called {
        EffectName::Payload.into()
    }

    fn equation(&self) -> &'static str {
        "dm a + df sign(v) + w, from a time on"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, from_s: f64) -> Vec<Vec<f64>> {
        let mass = from_then_on(motion, from_s, |row| motion.acceleration[row]);
        let [friction, force] = friction_and_force(motion, from_s);
        vec![mass, friction, force]
    }

    fn width(&self, _: f64) -> usize {
        3
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_nearest_outsider(&self) -> bool {
        true
    }

    fn is_level(&self, column: usize) -> bool {
        column == 1
    }

    fn look_alikes(&self) -> &'static [&'static dyn Effect] {
        &[&StepOfForce, &StrongerDrive, &GradualChange]
    }

    fn repeats(&self) -> bool {
        true
    }

    fn least_distance(&self, _: &Kinematics) -> f64 {
        LEAST_DISTANCE_S
    }

    fn comes_and_goes(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn action(&self, at: &Instant, from_s: f64, own: &[f64]) -> Action {
        let there = is_there(at.time_s, from_s);
        Action {
            mass: there * own[0],
            level: there * own[1],
            force: there * own[2],
        }
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        0.5 * dataset.train.duration_s()
    }

    fn grid(&self, motion: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        let part = |i: u32| motion.duration_s() * f64::from(i) / f64::from(TRIED);
        (1..TRIED).map(part).collect()
    }

    fn first_step(&self, motion: &Kinematics, _: f64) -> f64 {
        0.5 * motion.duration_s() / f64::from(TRIED)
    }

    /// A step of a time that is not smooth: it must pass over many rows.
    fn derivative_step(&self, _: f64) -> f64 {
        0.05
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        let duration_s = motion.duration_s();
        (BOUNDS.0 * duration_s, BOUNDS.1 * duration_s)
    }

    /// With the payload put down there is an axis left.
    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        let change = fitted.own.first();
        change.is_some_and(|change| fitted.inertia > 0.0 && fitted.inertia + change > 0.0)
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let inertia = naming.effort_unit(&format!(" s2/{}", naming.length()));
        vec![
            naming.coefficient("payload", 0, inertia),
            naming.coefficient("payload_friction", 1, naming.effort_unit("")),
            naming.coefficient("payload_weight", 2, naming.effort_unit("")),
            naming.nonlinear("payload_time", naming.parameter, "s".into()),
        ]
    }
}

impl Effect for StepOfForce {
    fn called(&self) -> Called {
        Called::Structure("force from a time on")
    }

    fn equation(&self) -> &'static str {
        "df sign(v) + w, from a time on"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, from_s: f64) -> Vec<Vec<f64>> {
        friction_and_force(motion, from_s).into()
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

impl Effect for StrongerDrive {
    fn called(&self) -> Called {
        Called::Structure("share of the effort from a time on")
    }

    fn equation(&self) -> &'static str {
        "c u, from a time on, u = effort by motion"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, from_s: f64) -> Vec<Vec<f64>> {
        let efforts = ByMotion::of(motion).efforts();
        vec![from_then_on(motion, from_s, |row| efforts[row])]
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

impl Effect for GradualChange {
    fn called(&self) -> Called {
        Called::Structure("change over the record")
    }

    fn equation(&self) -> &'static str {
        "(dm a + df sign(v) + w) s, and s^2; s = time over the record"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        let duration_s = motion.duration_s();
        let over_time = |power: i32, what: &dyn Fn(usize) -> f64| {
            let times = motion.time_s.iter().enumerate();
            let column = times.map(|(row, t)| (t / duration_s).powi(power) * what(row));
            column.collect()
        };
        let parabolas = [1, 2].into_iter().flat_map(|power| {
            [
                over_time(power, &|row| motion.acceleration[row]),
                over_time(power, &|row| motion.direction[row]),
                over_time(power, &|_| 1.0),
            ]
        });
        parabolas.collect()
    }

    fn width(&self, _: f64) -> usize {
        6
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, found, model, usual};
    use EffectName::{Coulomb, Inertia, Offset, Viscous};

    const FROM_S: f64 = 2.5;

    /// 30 kg more, with 6 N of friction and 40 N of weight.
    fn loaded(motion: &Kinematics, row: usize) -> f64 {
        let brings = 30.0 * motion.acceleration[row] + 6.0 * motion.direction[row] + 40.0;
        usual(motion, row) + is_there(motion.time_s[row], FROM_S) * brings
    }

    #[test]
    fn mass_friction_and_weight_come_back_beside_the_usual_coefficients() {
        let axis = axis(loaded);
        let part = found(EffectName::Payload, FROM_S);
        let model = model(&[Inertia, Viscous, Coulomb, Offset]).with(part);
        let fitted = axis.bench().fit(&model);
        let own = fitted.of(EffectName::Payload).unwrap();
        for (own, wanted) in own.iter().zip([30.0, 6.0, 40.0]) {
            assert!((own / wanted - 1.0).abs() < 0.02, "{own} {wanted}");
        }
        let mass = fitted.of(Inertia).unwrap()[0];
        assert!((mass / USUAL[0] - 1.0).abs() < 0.01, "{mass}");
    }

    #[test]
    fn the_time_has_an_interval_although_only_one_block_knows_it() {
        let axis = axis(loaded);
        let part = found(EffectName::Payload, FROM_S);
        let model = model(&[Inertia, Viscous, Coulomb, Offset]).with(part);
        let bench = axis.bench();
        let estimates = bench.estimates(&bench.fit(&model));
        let half_width_s = estimates[4].parameter_half_width.unwrap();
        assert!((1.0e-6..0.1).contains(&half_width_s), "{half_width_s}");
    }

    #[test]
    fn an_axis_cannot_put_down_more_than_it_has() {
        let physical = |change: f64| {
            Payload.is_physical(&Fitted {
                parameter: FROM_S,
                own: &[change, 0.0, 0.0],
                inertia: 90.0,
                coulomb: 25.0,
                viscous: 200.0,
            })
        };
        assert!(physical(-89.0) && physical(400.0) && !physical(-91.0));
    }
}
