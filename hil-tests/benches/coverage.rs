//! Whether intervals hold the truth: `cargo bench -p hil-tests --bench coverage [-- DRAWS [NAME]]`.
//!
//! Records of unlike make whose structure is declared, so that nothing is searched. A draw is a
//! machine, its motion and its noise. Each parameter has so many draws (200), spread over the makes
//! that have it; NAME takes the makes with that in their name.
//!
//! What the table says: [`hil_tests::intervals`].

use std::collections::BTreeMap;

use axis_model::{Effect, EffectName, Estimate};
use hil_tests::intervals::{self, Draw};
use hil_tests::on_all_cores;
use identification::{Dataset, fit_declared};
use makes::Recipe;
use makes::make::Form;
use makes::truth::Known;

/// Draws of each parameter.
const DRAWS: usize = 200;
/// The first seed; the records of the golden pages have other ones.
const FIRST_SEED: u64 = 1001;

/// Makes whose load is taken up and put down again: a dataset declares a payload once.
const TWICE: [&str; 3] = ["gripper-belt", "theatre-fly", "tray-shuttle"];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let draws = arguments.next().and_then(|text| text.parse().ok());
    let part = arguments.next().unwrap_or_default();
    let plan = plan(draws.unwrap_or(DRAWS), &part);
    eprintln!("{} records", plan.len());
    let drawn: Vec<Draw> = on_all_cores(&plan, drawn).into_iter().flatten().collect();
    intervals::print(&drawn);
}

/// The declared records of a seed whose name has a part in it.
fn declared(seed: u64, part: &str) -> Vec<Recipe> {
    let mut recipes = makes::recipes(seed);
    let form = format!("-{}", Form::Declared.word());
    let is_twice = |recipe: &Recipe| TWICE.iter().any(|make| recipe.name.starts_with(make));
    recipes.retain(|recipe| recipe.name.ends_with(&form) && recipe.name.contains(part));
    recipes.retain(|recipe| !is_twice(recipe));
    recipes
}

/// Makes with their seeds: the rarest parameters first, each shared out over its makes.
fn plan(draws: usize, part: &str) -> Vec<(String, u64)> {
    let known = on_all_cores(&declared(FIRST_SEED, part), |recipe| {
        let parameters = recipe.entry().truth.parameters;
        let names: Vec<&str> = parameters.iter().map(|known| known.name).collect();
        (recipe.name.clone(), names)
    });
    let mut makes_of: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (make, names) in &known {
        for name in names {
            makes_of.entry(name).or_default().push(make);
        }
    }
    let mut by_rarity: Vec<&Vec<&str>> = makes_of.values().collect();
    by_rarity.sort_by_key(|makes| makes.len());
    let mut seeds: BTreeMap<&str, usize> = BTreeMap::new();
    for makes in by_rarity {
        let planned = |seeds: &BTreeMap<&str, usize>| -> usize {
            makes.iter().filter_map(|make| seeds.get(make)).sum()
        };
        let mut next = makes.iter().cycle();
        while planned(&seeds) < draws {
            let Some(make) = next.next() else { break };
            *seeds.entry(make).or_default() += 1;
        }
    }
    let of_make = |(make, count): (&str, usize)| {
        let name = make.to_owned();
        (0..count as u64).map(move |place| (name.clone(), FIRST_SEED + place))
    };
    seeds.into_iter().flat_map(of_make).collect()
}

fn drawn((make, seed): &(String, u64)) -> Vec<Draw> {
    let mut recipes = declared(*seed, make);
    recipes.retain(|recipe| recipe.name == *make);
    let entry = recipes.remove(0).entry();
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    entry
        .write(folder.path())
        .expect("the folder can be written");
    let dataset = Dataset::read(&folder.path().join(&entry.name), None, None);
    let fitted = dataset.and_then(|dataset| fit_declared(&dataset, &mut |_| ()));
    let said = match fitted {
        Ok(fitted) => Said {
            stated: fitted.effects.iter().rev().flat_map(named).collect(),
            fitted: fitted.report.parameters,
        },
        Err(why) => {
            eprintln!("{make} {seed}: {why}");
            Said::default()
        }
    };
    let of_parameter = |known: &Known| Draw {
        make: make.clone(),
        name: known.name,
        truth: known.value,
        said: said.of(known).map(|said| (said.value, said.half_width())),
    };
    entry.truth.parameters.iter().map(of_parameter).collect()
}

/// What was said of a draw, as the vocabulary has it and as it was fitted.
#[derive(Default)]
struct Said {
    stated: BTreeMap<String, Estimate>,
    fitted: BTreeMap<String, Estimate>,
}

impl Said {
    /// What was said of a parameter: a share where a share is true, else an effort. Friction that
    /// differs by direction is the force of an offset, and told as one.
    fn of(&self, known: &Known) -> Option<&Estimate> {
        let is_like = |said: &&Estimate| said.unit.is_empty() == known.unit.is_empty();
        let told = |name: &str| {
            let mut both = [&self.stated, &self.fitted].into_iter();
            both.find_map(|said| said.get(name).filter(is_like))
        };
        let same_force = known.name == EffectName::CoulombAsymmetry.as_str();
        told(known.name).or_else(|| told(EffectName::Offset.as_str()).filter(|_| same_force))
    }
}

/// The parameters of an effect, named as reports name them.
fn named(effect: &Effect<Estimate>) -> Vec<(String, Estimate)> {
    let parts = effect.parts().into_iter();
    parts
        .map(|(row, estimate)| (row.report_name(), estimate.clone()))
        .collect()
}
