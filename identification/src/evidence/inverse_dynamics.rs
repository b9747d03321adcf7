//! The inverse dynamics of one structure, fitted: what the declared and the extended model become.
//!
//! A structure is a list of parts ([`Model`]), and a choice of what stands where friction has its
//! sign: the sign of the velocity, or Dahl's bristle of some deflection. The bristle changes the
//! columns, not the list of parts. So a fitted structure sees every record through
//! [`InverseDynamics::motion`].

use crate::evidence::difference::Known;
use crate::evidence::fast_motion;
use crate::evidence::forms;
use crate::evidence::reversal::bristle::Bristle;
use crate::evidence::reversal::{self, Slipping};
use crate::evidence::thresholds::METHOD;
use crate::evidence::which_wave;
use crate::fit::bench::Bench;
use crate::fit::fitted::{Estimate, Fitted};
use crate::fit::tuning::Pair;
use crate::model::effects::by_motion::place_among_usual;
use crate::model::effects::{delay, logged_late};
use crate::model::inverse::{Model, Part};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Step of the derivative by a deflection, as a share of it.
const DEFLECTION_STEP: f64 = 0.02;
/// As far as a deflection is moved to see what becomes of the coefficients, as a share of it.
const MOST_OF_A_DEFLECTION: f64 = 0.5;
/// Step of a delay that nobody asked for, as a share of a row.
const DELAY_STEP: f64 = 0.1;

/// One quantity of the declared model beside that of the extended model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Compared<T> {
    /// With the effects that the axis is said to have.
    pub declared: T,
    /// With the effects that were found besides.
    pub extended: T,
}

impl<T> Compared<T> {
    /// The same question to both.
    pub(crate) fn each<'a, U>(&'a self, question: impl Fn(&'a T) -> U) -> Compared<U> {
        Compared {
            declared: question(&self.declared),
            extended: question(&self.extended),
        }
    }
}

/// A structure with its coefficients.
pub(crate) struct InverseDynamics {
    /// The parts with their coefficients.
    pub fitted: Fitted,
    /// The bristle, where there is one in place of the sign.
    pub bristle: Option<Bristle>,
    /// Deflection of the load's friction, where its own motion told the law.
    pub by_the_load: Option<Known>,
    /// Deflection of Maxwell slip, where that leaves no more than Dahl's bristle, and not so
    /// clearly less of both records that it stands there.
    pub slips_at: Option<f64>,
}

/// What a structure leaves of one record.
pub(crate) struct Judgement {
    /// Force error over moving samples, percent of the effort.
    pub force_percent: f64,
    /// Rms of the effort about reversals that is not explained; zero where there are none.
    pub reversal_rms: f64,
    /// Effort − prediction, low-passed.
    pub residual: Vec<f64>,
    /// Predicted effort, not low-passed.
    pub prediction: Vec<f64>,
}

impl InverseDynamics {
    /// A model fitted to moving samples; its sign columns follow the bristle, where there is one.
    /// Nonlinear parameters and forms are asked for once more then: they were found with the sign,
    /// and a fall that lags is hidden behind a bristle that bends far.
    pub(crate) fn fitted(pair: Pair<'_>, model: Model, bristle: Option<Bristle>) -> Self {
        let Some(own) = &bristle else {
            let fitted = pair
                .bench
                .fit(&which_wave::settled(pair, &model).unwrap_or(model));
            return Self {
                fitted,
                bristle,
                by_the_load: None,
                slips_at: None,
            };
        };
        let dataset = pair.bench.dataset;
        let [motion, slow] = [pair.bench, pair.low].map(|bench| own.motion(bench.motion));
        let (bench, low) = (Bench::new(dataset, &motion), Bench::new(dataset, &slow));
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        let model = forms::refined(pair, model);
        let moved = which_wave::settled(pair, &model);
        let model = moved.map_or(model, |moved| forms::refined(pair, moved));
        let fitted = bench.fit(&model);
        Self {
            fitted,
            bristle,
            by_the_load: None,
            slips_at: None,
        }
    }

    /// The same with Maxwell slip in place of Dahl's bristle, where that is what both records show.
    /// What the elements are is asked once more of the coefficients that they give.
    pub(crate) fn or_slipping(self, pair: Pair<'_>, other: &Bench<'_>) -> Self {
        let Some(about) = self.bristle.as_ref().map(Bristle::deflection) else {
            return self;
        };
        let asked = |before: &Self| {
            let elsewhere = before.refitted(other.dataset, other.motion).fitted;
            let records = [(pair.bench, &before.fitted), (other, &elsewhere)];
            reversal::slip(records, about)
        };
        let slipping = |before: &Self, own: Slipping| {
            let model = before.fitted.model().clone();
            Self::fitted(pair, model, Some(Bristle::Slip(own.elements)))
        };
        let Some(first) = asked(&self) else {
            return self;
        };
        let again = if first.is_clear {
            let once = slipping(&self, first);
            match asked(&once) {
                Some(again) if again.is_clear => return slipping(&once, again),
                again => again,
            }
        } else {
            Some(first)
        };
        let slips_at = again.map(|own| own.elements.deflection());
        Self { slips_at, ..self }
    }

    /// The same structure with the coefficients of another record.
    pub(crate) fn refitted(&self, dataset: &Dataset, motion: &Kinematics) -> Self {
        let seen = self.motion(motion);
        Self {
            fitted: Bench::new(dataset, &seen).fit(self.fitted.model()),
            bristle: self.bristle.clone(),
            by_the_load: self.by_the_load,
            slips_at: self.slips_at,
        }
    }

    /// The motion as this structure sees it.
    pub(crate) fn motion(&self, motion: &Kinematics) -> Kinematics {
        let bristle = self.bristle.as_ref();
        bristle.map_or_else(|| motion.clone(), |bristle| bristle.motion(motion))
    }

    /// The deflection with its interval: as moving samples and those about reversals tell it.
    pub(crate) fn known_deflection(&self, dataset: &Dataset, motion: &Kinematics) -> Option<Known> {
        if self.by_the_load.is_some() {
            return self.by_the_load;
        }
        let bristle = self.bristle.as_ref()?;
        if let Bristle::Slip(elements) = bristle {
            return Some(elements.known_deflection());
        }
        let deflection = bristle.deflection();
        let [below, above] = [1.0 - DEFLECTION_STEP, 1.0 + DEFLECTION_STEP].map(|factor| {
            let seen = bristle.scaled(factor).motion(motion);
            Bench::new(dataset, &seen).predict_lp(&self.fitted)
        });
        let step = DEFLECTION_STEP * deflection;
        let pairs = below.iter().zip(&above);
        let slope = pairs.map(|(below, above)| (above - below) / (2.0 * step));
        let seen = self.motion(motion);
        let both = seen.fitted.iter().zip(&seen.slow);
        let mask: Vec<bool> = both.map(|(fitted, slow)| *fitted || *slow).collect();
        let bench = Bench::new(dataset, &seen);
        let half_width = bench.half_width_by(&self.fitted, slope.collect(), &mask);
        Some(Known::new(deflection, half_width))
    }

    /// What was fitted with half widths of 95 % intervals, of a motion at both cut-offs. What the
    /// deflection leaves open by its own law is in them. Noise of the positions that comes back
    /// through the controller biases mass and friction, and much less at the lower cut-off: as far
    /// as they differ there, they are uncertain too. No coefficient is known better than
    /// [`METHOD`].
    pub(crate) fn estimates(
        &self,
        dataset: &Dataset,
        [motion, low]: [&Kinematics; 2],
    ) -> Vec<Estimate> {
        let of = |motion: &Kinematics| Bench::new(dataset, motion).fit(self.fitted.model());
        let seen = self.motion(motion);
        let bench = Bench::new(dataset, &seen);
        let mut estimates = bench.estimates(&self.fitted);
        for (place, estimate) in estimates.iter_mut().enumerate() {
            let open = which_wave::half_width(&bench, self.fitted.model(), place);
            estimate.parameter_half_width = estimate.parameter_half_width.map(|own| own.max(open));
        }
        let others = [
            Some(of(&self.motion(low))),
            self.sharpened(dataset, motion),
            self.delayed(dataset, [motion, low]),
        ];
        for other in others.iter().flatten() {
            for (estimate, term) in estimates.iter_mut().zip(other.terms()) {
                if place_among_usual(term.part.called()).is_some() {
                    let (value, half) = &mut estimate.own[0];
                    *half = half.hypot(term.own[0] - *value);
                }
            }
        }
        let known = self.known_deflection(dataset, motion);
        if let Some((bristle, known)) = self.bristle.as_ref().zip(known) {
            let share = (known.half_width / known.value).min(MOST_OF_A_DEFLECTION);
            let ends = [1.0 - share, 1.0 + share];
            let [low, high] = ends.map(|factor| of(&bristle.scaled(factor).motion(motion)));
            let pairs = low.terms().zip(high.terms());
            for (estimate, (low, high)) in estimates.iter_mut().zip(pairs) {
                let ends = low.own.iter().zip(high.own);
                for ((_, half), (low, high)) in estimate.own.iter_mut().zip(ends) {
                    *half = half.hypot(0.5 * (high - low));
                }
            }
        }
        for (value, half) in estimates.iter_mut().flat_map(|estimate| &mut estimate.own) {
            *half = half.hypot(METHOD * *value);
        }
        estimates
    }

    /// The same structure fitted to the sharpened motion, where the plain one was taken: what that
    /// lacks of fast motion is uncertain.
    fn sharpened(&self, dataset: &Dataset, motion: &Kinematics) -> Option<Fitted> {
        let sharpened = fast_motion::sharpened(dataset)?;
        let mut seen = Kinematics::new(&sharpened, &sharpened.train)?;
        seen.fitted.clone_from(&motion.fitted);
        let seen = self.motion(&seen);
        Some(Bench::new(&sharpened, &seen).fit(self.fitted.model()))
    }

    /// The same structure beside the small delay that leaves the least of slow motion, where it has
    /// none. A current loop lags by microseconds, which nothing asks for, and they are a viscous
    /// friction of the mass times the square of a frequency times that.
    fn delayed(&self, dataset: &Dataset, [motion, low]: [&Kinematics; 2]) -> Option<Fitted> {
        let model = self.fitted.model();
        if !model.is_open_to(&delay::Delay) {
            return None;
        }
        let at = |delay_s: f64| model.with(Part::found(&delay::Delay, delay_s));
        let seen = self.motion(low);
        let bench = Bench::new(dataset, &seen);
        let step = DELAY_STEP * motion.period_s;
        let [early, none, late] = [-step, 0.0, step].map(|delay_s| bench.sse(&at(delay_s)));
        let bend = early + late - 2.0 * none;
        let least = 0.5 * step * (early - late) / bend;
        let least = least.clamp(-logged_late::SHORTEST_S, delay::SHORTEST_S);
        let seen = self.motion(motion);
        (bend > 0.0).then(|| Bench::new(dataset, &seen).fit(&at(least)))
    }

    /// Force error over the moving samples of a record, percent.
    pub(crate) fn force_error_percent(&self, dataset: &Dataset, motion: &Kinematics) -> f64 {
        let seen = self.motion(motion);
        Bench::new(dataset, &seen).force_error_percent(&self.fitted)
    }

    /// What it leaves of a record.
    pub(crate) fn on(&self, dataset: &Dataset, motion: &Kinematics) -> Judgement {
        let plain = Bench::new(dataset, motion);
        let reversal_rms = reversal::error_rms(&plain, &self.fitted, self.bristle.as_ref());
        let seen = self.motion(motion);
        let bench = Bench::new(dataset, &seen);
        Judgement {
            force_percent: bench.force_error_percent(&self.fitted),
            reversal_rms: reversal_rms.unwrap_or(0.0),
            residual: bench.residual(&self.fitted),
            prediction: bench.predict(&self.fitted),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use axis_model::EffectName::{Coulomb, Inertia, Stribeck, Viscous};

    use super::*;
    use crate::evidence::force_noise::tests::noise;
    use crate::evidence::reversal::slip;
    use crate::model::effects::stribeck;
    use crate::record::samples::Record;
    use crate::simulate::made;

    pub(crate) const DEFLECTION_M: f64 = 2.0e-4;

    /// 700 kg, 900 N·s/m and 300 N of friction, whose direction is the sign or Dahl's bristle.
    pub(crate) fn record(deflection: Option<f64>) -> Record {
        record_with(deflection.map(Bristle::Dahl).as_ref())
    }

    pub(crate) fn record_with(bristle: Option<&Bristle>) -> Record {
        let bare = made::record(1.0e-3, made::two_sines(3000));
        let motion = Kinematics::new(&declared(bare.clone()), &bare).unwrap();
        let seen = bristle.map(|bristle| bristle.motion(&motion));
        let direction = seen.map_or_else(|| motion.direction.clone(), |seen| seen.direction);
        let effort = |row: usize| {
            700.0 * motion.acceleration[row] + 900.0 * motion.velocity[row] + 300.0 * direction[row]
        };
        Record {
            effort: (0..bare.len()).map(effort).collect(),
            ..bare
        }
    }

    pub(crate) fn declared(record: Record) -> Dataset {
        Dataset {
            declared: vec![Inertia, Viscous, Coulomb],
            ..made::dataset(record, None)
        }
    }

    fn fitted(dataset: &Dataset, motion: &Kinematics, deflection: Option<f64>) -> InverseDynamics {
        let bench = Bench::new(dataset, motion);
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        InverseDynamics::fitted(
            pair,
            Model::declared(dataset),
            deflection.map(Bristle::Dahl),
        )
    }

    fn assert_near(value: f64, wanted: f64, share: f64) {
        assert!(
            (value / wanted - 1.0).abs() < share,
            "{value}, wanted {wanted}"
        );
    }

    #[test]
    fn each_friction_is_explained_by_its_own_structure_and_not_by_the_other() {
        for of_the_record in [None, Some(DEFLECTION_M)] {
            let dataset = declared(record(of_the_record));
            let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
            for of_the_model in [None, Some(DEFLECTION_M)] {
                let model = fitted(&dataset, &motion, of_the_model);
                let left = model.on(&dataset, &motion);
                let is_right = of_the_record == of_the_model;
                let case = format!("{of_the_record:?} {of_the_model:?}");
                assert_eq!(
                    left.force_percent < 1.0e-6,
                    is_right,
                    "{case}: {}",
                    left.force_percent
                );
                // Below 0.01 N of 300 N about reversals, or some newtons.
                let (rms, right) = (left.reversal_rms, is_right);
                assert!(if right { rms < 0.01 } else { rms > 3.0 }, "{case}: {rms}");
                let again = model.force_error_percent(&dataset, &motion);
                assert_eq!(again, left.force_percent, "{case}");
                if is_right {
                    assert_near(model.fitted.of(Coulomb).unwrap()[0], 300.0, 1.0e-6);
                }
            }
        }
    }

    #[test]
    fn elements_that_slip_are_told_as_such_and_dahls_bristle_stays_one() {
        let four = [(0.2, 0.25), (0.5, 0.25), (0.8, 0.25), (1.5, 0.25)];
        let elements = Bristle::Slip(slip::tests::elements(DEFLECTION_M, &four));
        for of_the_record in [Bristle::Dahl(DEFLECTION_M), elements] {
            let dataset = declared(record_with(Some(&of_the_record)));
            let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
            let bench = Bench::new(&dataset, &motion);
            let pair = Pair {
                bench: &bench,
                low: &bench,
            };
            let dahl = fitted(&dataset, &motion, Some(0.7 * DEFLECTION_M));
            let left = |model: &InverseDynamics| model.on(&dataset, &motion).reversal_rms;
            let before = left(&dahl);
            let found = dahl.or_slipping(pair, &bench);
            let is_slip = |bristle: &Bristle| matches!(bristle, Bristle::Slip(_));
            let own = found.bristle.as_ref().unwrap();
            assert_eq!(is_slip(own), is_slip(&of_the_record));
            assert_eq!(found.slips_at, None);
            if is_slip(own) {
                assert!(left(&found) < 0.1 * before, "{} {before}", left(&found));
                assert_near(own.deflection(), of_the_record.deflection(), 0.05);
                let known = found.known_deflection(&dataset, &motion).unwrap();
                assert_eq!(known.value, own.deflection());
            }
        }
    }

    #[test]
    fn a_delay_of_microseconds_that_nobody_asks_for_is_in_the_interval_of_viscous_friction() {
        let mut record = record(None);
        let motion = Kinematics::new(&declared(record.clone()), &record).unwrap();
        let late_s = 5.0e-5;
        for (row, effort) in record.effort.iter_mut().enumerate().skip(1) {
            let later = motion.acceleration[row] - motion.acceleration[row - 1];
            *effort += 700.0 * later * late_s / record.period_s;
        }
        let dataset = declared(record);
        let motions = [100.0, 30.0]
            .map(|cutoff_hz| Kinematics::with_cutoff(&dataset, &dataset.train, cutoff_hz).unwrap());
        let model = fitted(&dataset, &motions[0], None);
        let estimates = model.estimates(&dataset, motions.each_ref());
        let viscous = estimates.iter().find(|own| own.part.is(Viscous)).unwrap();
        let (value, half_width) = viscous.own[0];
        let off = (value - 900.0).abs();
        assert!(
            off > 3.0 && off < half_width && half_width < 3.0 * off,
            "{value} {half_width}"
        );
    }

    #[test]
    fn where_noise_hides_which_law_it_is_the_deflection_of_the_other_one_is_kept() {
        let two = [(0.2, 0.3), (1.2, 0.7)];
        let elements = Bristle::Slip(slip::tests::elements(DEFLECTION_M, &two));
        let mut record = record_with(Some(&elements));
        let mut noise = noise();
        let efforts = record.effort.iter_mut();
        efforts.for_each(|effort| *effort += 200.0 * noise());
        let dataset = declared(record);
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let found = fitted(&dataset, &motion, Some(DEFLECTION_M)).or_slipping(pair, &bench);
        assert!(matches!(found.bristle, Some(Bristle::Dahl(_))));
        assert_near(found.slips_at.unwrap(), elements.deflection(), 0.3);
    }

    /// Lag of the fall of [`lagging`].
    pub(crate) const LAG_S: f64 = 0.015;

    /// 200 N of a fall over 10 mm/s that lags, behind Dahl's bristle; all is declared but that.
    pub(crate) fn lagging() -> Dataset {
        let fall = stribeck::nearest(2.0, LAG_S);
        let bristle = Bristle::Dahl(DEFLECTION_M);
        let dataset = declared(record(None));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let seen = bristle.motion(&motion);
        let excess = &fall.columns(&seen, &dataset, 0.01)[0];
        let mut lagging = dataset.train.clone();
        for (row, effort) in lagging.effort.iter_mut().enumerate() {
            *effort += 300.0 * (seen.direction[row] - motion.direction[row]) + 200.0 * excess[row];
        }
        Dataset {
            declared: vec![Inertia, Viscous, Coulomb, Stribeck],
            ..made::dataset(lagging, None)
        }
    }

    #[test]
    fn a_fall_that_lags_is_found_behind_a_bristle() {
        let (dataset, bristle) = (lagging(), Bristle::Dahl(DEFLECTION_M));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let model = Model::declared(&dataset).with_parameter(3, 0.012);
        let found = InverseDynamics::fitted(pair, model, Some(bristle));
        let part = found.fitted.terms().last().unwrap();
        assert_near(part.part.effect.lag_s(), LAG_S, 0.1);
        assert_near(part.own[0], 200.0, 0.01);
        assert_near(found.fitted.of(Coulomb).unwrap()[0], 300.0, 0.01);
    }

    #[test]
    fn without_coulomb_friction_nothing_is_left_about_reversals() {
        let dataset = declared(record(None));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let model = InverseDynamics {
            fitted: Bench::new(&dataset, &motion).fit(&crate::fit::made::model(&[Inertia])),
            bristle: None,
            by_the_load: None,
            slips_at: None,
        };
        assert_eq!(model.on(&dataset, &motion).reversal_rms, 0.0);
    }

    #[test]
    fn a_structure_takes_the_coefficients_of_another_record_and_keeps_its_bristle() {
        let dataset = declared(record(Some(DEFLECTION_M)));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let model = fitted(&dataset, &motion, Some(DEFLECTION_M));
        let mut stronger = dataset.train.clone();
        stronger.effort.iter_mut().for_each(|effort| *effort *= 2.0);
        let motion = Kinematics::new(&dataset, &stronger).unwrap();
        assert_near(model.force_error_percent(&dataset, &motion), 50.0, 1.0e-6);
        let refitted = model.refitted(&dataset, &motion);
        assert_eq!(refitted.bristle, Some(Bristle::Dahl(DEFLECTION_M)));
        assert_near(refitted.fitted.of(Inertia).unwrap()[0], 1400.0, 1.0e-6);
        assert!(refitted.force_error_percent(&dataset, &motion) < 1.0e-6);
    }

    #[test]
    fn residual_and_prediction_are_in_the_unit_of_the_effort_and_add_up() {
        let dataset = declared(record(None));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let model = fitted(&dataset, &motion, None);
        let mut pushed = dataset.train.clone();
        pushed.effort.iter_mut().for_each(|effort| *effort += 7.0);
        let motion = Kinematics::new(&dataset, &pushed).unwrap();
        let left = model.on(&dataset, &motion);
        let middle = motion.len() / 2;
        assert_near(left.residual[middle], 7.0, 1.0e-6);
        assert_near(motion.effort[middle] - left.prediction[middle], 7.0, 1.0e-6);
    }

    #[test]
    fn a_deflection_that_is_off_has_an_interval_that_tells_it() {
        let dataset = declared(record(Some(DEFLECTION_M)));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let known = |deflection: f64| {
            let model = fitted(&dataset, &motion, Some(deflection));
            let mass = model.estimates(&dataset, [&motion; 2])[0].own[0];
            (model.known_deflection(&dataset, &motion).unwrap(), mass)
        };
        let (right, (mass, half)) = known(DEFLECTION_M);
        assert_eq!(right.value, DEFLECTION_M);
        assert!(right.half_width < 1.0e-3 * DEFLECTION_M, "{right:?}");
        assert!((mass - 700.0).abs() < 0.01, "{mass}");
        assert_near(half, METHOD * 700.0, 1.0e-3);
        for off in [0.85, 1.15] {
            let (known, (mass, half)) = known(off * DEFLECTION_M);
            let error = (known.value - DEFLECTION_M).abs();
            assert!(error < 1.2 * known.half_width && known.half_width < 3.0 * error);
            assert!((mass - 700.0).abs() < half, "{mass} {half}");
        }
        assert_eq!(
            fitted(&dataset, &motion, None).known_deflection(&dataset, &motion),
            None
        );
    }
}
