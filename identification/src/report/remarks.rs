//! Remarks: what stands behind a decision, and what the record or its description cannot give.

use std::collections::BTreeMap;

use crate::evidence::another_day::Change;
use crate::evidence::difference::Difference;
use crate::evidence::findings::Findings;
use crate::evidence::free_run::{Judged, Reversals};
use crate::evidence::reversal::Presliding;
use crate::evidence::reversal::bristle::Bristle;
use crate::evidence::reversal::gap::SeenGap;
use crate::evidence::reversal_stage::ReversalStage;
use crate::motion::excitation;
use crate::report::figures;
use crate::report::forms::{ParameterTable, UnknownParameter};
use crate::report::parameters::{COULOMB_ASYMMETRY, DEFLECTION};
use crate::report::ranking;
use crate::simulate::controller::known::{Controller, LARGEST_MISFIT};

mod beyond;
mod directions;

/// All remarks, the strongest first; each parameter is from an output.
pub(crate) fn remarks(
    findings: &Findings<'_>,
    parameters: &ParameterTable,
    from: &BTreeMap<String, &'static str>,
) -> Vec<String> {
    let (dataset, stage) = (findings.dataset, &findings.stages.reversals);
    let free_run = stage.free_run.as_ref();
    let mut list: Vec<String> = free_run
        .and_then(|run| about(run.controller))
        .into_iter()
        .collect();
    list.extend(
        free_run
            .filter(|run| run.rigid.ran_away)
            .map(|_| RAN_AWAY.to_owned()),
    );
    let said = Said {
        stage,
        effort: dataset.effort.unit(),
        length: dataset.kind.millionths(),
    };
    list.extend(said.sentence());
    list.extend(of_slip(findings));
    list.extend(of_two_laws(findings.models.extended.slips_at, from));
    list.extend(of_another_day(&findings.on_both.changes()));
    let model = findings.models.extended.fitted.model();
    list.extend(beyond::beyond_the_travel(dataset, model));
    let difference = findings.stages.difference.as_ref();
    let is_vague = difference.is_some_and(Difference::hardly_knows_the_stiffness);
    list.extend(is_vague.then(|| VAGUE_STIFFNESS.to_owned()));
    let fitted = &findings.models.extended.fitted;
    let found = findings.found.names();
    let by_the_load = parameters.get(COULOMB_ASYMMETRY).map(|own| own.value);
    list.extend(directions::of_an_offset(
        dataset,
        found,
        fitted,
        by_the_load,
    ));
    list.extend(parameters.unknown.iter().map(of_an_unknown));
    list.extend(excitation::warnings(dataset, findings.motion));
    list
}

fn of_an_unknown((name, own): (&String, &UnknownParameter)) -> String {
    format!(
        "unknown: {name}, somewhere between {} and {} {}; to know it, record {}",
        figures::error(own.low),
        figures::error(own.high),
        own.unit,
        own.record
    )
}

const VAGUE_STIFFNESS: &str = "compliance: while the motor moves the effort goes so closely with the motion that the record does not tell the motor's mass and friction from the load's; the stiffness may be anything up to twice that of the table: record faster accelerations";

const RAN_AWAY: &str = "the simulated axis ran away (an error beyond its travel): the loop of the \
                        identified model is not stable, and no free run was used as evidence";

/// That Maxwell slip stands in the place of Dahl's bristle, and what each leaves.
fn of_slip(findings: &Findings<'_>) -> Option<String> {
    let Some(Bristle::Slip(elements)) = &findings.models.extended.bristle else {
        return None;
    };
    let dahl = findings.stages.reversals.inverse?.dahl;
    Some(format!(
        "presliding: {} elements that slip one after the other leave {} {} rms about reversals, one bristle by Dahl's law {}",
        elements.elements().len(),
        figures::error(findings.train.extended.reversal_rms),
        findings.dataset.effort.unit(),
        figures::error(dahl)
    ))
}

/// That a deflection is as open as two laws leave it, where it is not by the load's own motion.
fn of_two_laws(slips_at: Option<f64>, from: &BTreeMap<String, &'static str>) -> Option<String> {
    let output = from.get(DEFLECTION)?;
    (slips_at.is_some() && *output != ranking::DIFFERENCE).then(|| {
        "presliding: elements that slip one after the other leave no more about reversals than one bristle by Dahl's law, so the deflection is no nearer known than the two agree".into()
    })
}

/// Coefficients that the validation record has in another size.
fn of_another_day(changes: &[Change]) -> Option<String> {
    let each = changes.iter().map(|change| {
        let Change {
            effect,
            share,
            half_width,
        } = change;
        let (percent, half) = (100.0 * share, 100.0 * half_width);
        format!("{} {percent:+.0} ± {half:.0} %", effect.as_str())
    });
    let list = each.collect::<Vec<String>>().join(", ");
    (!changes.is_empty()).then(|| {
        format!(
            "the validation record has the same structure in another size ({list}): the errors on it hold this difference too; another day or temperature does that"
        )
    })
}

/// What is to be said of a controller that was described.
fn about(controller: Controller) -> Option<String> {
    let percent = |share: f64| figures::error(100.0 * share);
    match controller {
        Controller::Known(_) | Controller::NotDescribed => None,
        Controller::Hidden(share) => Some(format!(
            "the [controller] of dataset.toml leaves {} % of the recorded effort, most of it noise from row to row: it counts as not known",
            percent(share)
        )),
        Controller::Refuted(share) => Some(format!(
            "the [controller] of dataset.toml does not give the recorded effort: it leaves {} % of it, and {} % is the most that noise excuses; check its gains and their units, position_sensor, the reference column (the setpoint that the loop followed) and whether the loop runs faster than the record; no free run was used as evidence",
            percent(share),
            100.0 * LARGEST_MISFIT
        )),
    }
}

/// Whether a free run is believed about a bristle, and saw one: a simulation that follows the
/// record is tied to it too closely.
fn shows_a_bristle(run: &Reversals) -> bool {
    matches!(run.controller, Controller::Known(_)) && run.alone.presliding
}

/// What the witnesses said of reversals, in units.
struct Said<'a> {
    stage: &'a ReversalStage,
    effort: &'static str,
    length: &'static str,
}

impl Said<'_> {
    /// Why what acts at reversals was decided so; `None` where nothing acts and nobody was in
    /// doubt.
    fn sentence(&self) -> Option<String> {
        if let Some(gap) = self.stage.gap_by_effort() {
            return Some(self.before_a_bristle(&gap));
        }
        let decided = self.stage.decided;
        let run = self.stage.free_run_alone();
        let torn = run.filter(|run| run.alone.undecided);
        match (decided.presliding, decided.backlash, torn) {
            (true, false, Some(run)) => Some(format!(
                "presliding: {}; {} breaks the tie",
                self.tie(run),
                self.on_effort()?
            )),
            (false, true, Some(run)) => Some(format!(
                "backlash: {}; {} breaks the tie, for the gap leaves less",
                self.tie(run),
                self.on_effort()?
            )),
            (false, false, Some(run)) => Some(self.undecided(run)),
            (true, false, None) if run.is_some_and(|run| run.alone.backlash) => Some(format!(
                "presliding: {} is clear; the simulated position alone would have a gap ({}), but a gap hardly changes that effort",
                self.on_effort()?,
                self.figures(run?)
            )),
            (true, false, None) if !run.is_some_and(shows_a_bristle) => {
                Some(format!("presliding: {}", self.on_effort()?))
            }
            (false, false, None) => None,
            _ => run.map(|run| self.by_free_run(run)),
        }
    }

    fn before_a_bristle(&self, gap: &SeenGap) -> String {
        format!(
            "presliding and backlash: the effort about reversals (a bristle leaves {}, one behind a gap {} {} rms); over {} {} after a reversal the motor feels neither friction nor mass of its load",
            figures::error(gap.bristle),
            figures::error(gap.left),
            self.effort,
            figures::error(1.0e6 * gap.width),
            self.length
        )
    }

    fn undecided(&self, run: &Reversals) -> String {
        let end = if self.stage.decided.unexplained {
            "something acts at reversals, and the record does not say which: record the load's position too"
        } else {
            "rigid friction leaves hardly more than the rounding of the encoder, so nothing is named"
        };
        format!("reversals: {}; {end}", self.tie(run))
    }

    /// The figures of a bristle and a gap that leave about the same.
    fn tie(&self, run: &Reversals) -> String {
        format!(
            "the simulated position cannot tell a bristle from a gap ({})",
            self.figures(run)
        )
    }

    fn by_free_run(&self, run: &Reversals) -> String {
        let name = match (run.accepted.presliding, run.accepted.backlash) {
            (true, true) => "presliding and backlash",
            (true, false) => "presliding",
            _ => "backlash",
        };
        format!("{name}: by the simulated position ({})", self.figures(run))
    }

    fn figures(&self, run: &Reversals) -> String {
        let left = |name: &str, judged: &Judged| {
            format!("{name} {}", figures::error(1.0e6 * judged.told()))
        };
        let gap = run.gap.iter().map(|gap| left("a gap", gap));
        let both = run.both.iter().map(|both| left("both", both));
        let first = [
            left("rigid friction", &run.rigid),
            left("a bristle", &run.bristle),
        ];
        let all: Vec<String> = first.into_iter().chain(gap).chain(both).collect();
        format!(
            "{} {} rms on blocks that were not fitted",
            all.join(", "),
            self.length
        )
    }

    fn on_effort(&self) -> Option<String> {
        let Presliding { rigid, dahl, .. } = self.stage.inverse?;
        Some(format!(
            "the effort about reversals (rigid friction leaves {}, a bristle {} {} rms)",
            figures::error(rigid),
            figures::error(dahl),
            self.effort
        ))
    }
}

#[cfg(test)]
mod tests {
    use axis_model::EffectName::{Coulomb, Viscous};

    use super::*;

    #[test]
    fn two_laws_of_a_deflection_are_told_where_the_load_does_not_tell_it() {
        let from = |output| BTreeMap::from([(DEFLECTION.to_owned(), output)]);
        let told = |slips_at, output| of_two_laws(slips_at, &from(output)).is_some();
        assert!(told(Some(1.0e-6), ranking::FREE_RUN));
        assert!(!told(Some(1.0e-6), ranking::DIFFERENCE));
        assert!(!told(None, ranking::FREE_RUN));
        assert!(of_two_laws(Some(1.0e-6), &BTreeMap::new()).is_none());
    }

    #[test]
    fn another_day_is_told_with_every_change_and_its_interval() {
        let change = |effect, share, half_width| Change {
            effect,
            share,
            half_width,
        };
        assert_eq!(of_another_day(&[]), None);
        let changes = [
            change(Coulomb.into(), 0.149, 0.021),
            change(Viscous.into(), -0.1, 0.034),
        ];
        let said = of_another_day(&changes).unwrap();
        assert!(
            said.contains("(coulomb +15 ± 2 %, viscous -10 ± 3 %)"),
            "{said}"
        );
    }
}
