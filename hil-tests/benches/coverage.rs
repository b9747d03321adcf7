//! Whether intervals hold the truth: `cargo bench -p hil-tests --bench coverage [-- DRAWS [NAME]]`.
//!
//! Records of unlike make. In the first table their structure is declared, so that nothing is
//! searched; in the second what is not declared is hidden, and was selected before it had an
//! interval. A draw is a machine, its motion and its noise. Each parameter has so many draws (200),
//! spread over the makes that have it; NAME takes the makes with that in their name.
//!
//! The draws that miss are told on standard error. What a table says: [`hil_tests::intervals`].

use std::collections::BTreeMap;

use axis_model::{Effect, EffectName, Estimate};
use hil_tests::intervals::{self, Draw, Said};
use hil_tests::on_all_cores;
use identification::{Dataset, Identification, fit_declared, identify};
use makes::Recipe;
use makes::make::Form;
use makes::truth::Known;

/// Draws of each parameter.
const DRAWS: usize = 200;
/// The first seed; the records of the golden pages have other ones.
const FIRST_SEED: u64 = 1001;

/// Makes that have something twice, which a dataset can declare once: a load that is taken up and
/// put down again, ripples of two orders.
const TWICE: [&str; 5] = [
    "film-scanner",
    "gripper-belt",
    "pinning-drum",
    "theatre-fly",
    "tray-shuttle",
];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let draws = arguments.next().and_then(|text| text.parse().ok());
    let part = arguments.next().unwrap_or_default();
    for (title, form) in [
        ("The structure declared", Form::Declared),
        ("After selection", Form::Hidden),
    ] {
        let plan = plan(form, draws.unwrap_or(DRAWS), &part);
        eprintln!("{} records", plan.len());
        let drawn = on_all_cores(&plan, |(make, seed)| drawn(form, make, *seed));
        let drawn: Vec<Draw> = drawn.into_iter().flatten().collect();
        println!("{title}:\n");
        intervals::print(&drawn);
        for miss in intervals::missed(&drawn) {
            eprintln!("{miss}");
        }
        println!();
    }
}

/// The records of a form and a seed whose name has a part in it.
fn recipes(form: Form, seed: u64, part: &str) -> Vec<Recipe> {
    let mut recipes = makes::recipes(seed);
    let end = format!("-{}", form.word());
    let is_twice = |recipe: &Recipe| TWICE.iter().any(|make| recipe.name.starts_with(make));
    recipes.retain(|recipe| recipe.name.ends_with(&end) && recipe.name.contains(part));
    recipes.retain(|recipe| !is_twice(recipe));
    recipes
}

/// Makes with their seeds: the rarest parameters first, each shared out over its makes.
fn plan(form: Form, draws: usize, part: &str) -> Vec<(String, u64)> {
    let known = on_all_cores(&recipes(form, FIRST_SEED, part), |recipe| {
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

fn drawn(form: Form, make: &str, seed: u64) -> Vec<Draw> {
    let mut recipes = recipes(form, seed, make);
    recipes.retain(|recipe| recipe.name == make);
    let entry = recipes.remove(0).entry();
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    entry
        .write(folder.path())
        .expect("the folder can be written");
    let dataset = Dataset::read(&folder.path().join(&entry.name), None, None);
    let result = dataset.and_then(|dataset| match form {
        Form::Declared => fit_declared(&dataset, &mut |_| ()),
        _ => identify(&dataset, &mut |_| ()),
    });
    if let Err(why) = &result {
        eprintln!("{make} {seed}: {why}");
    }
    let of_parameter = |known: &Known| Draw {
        make: make.to_owned(),
        seed,
        name: known.name,
        truth: known.value,
        said: result
            .as_ref()
            .map_or(Said::Nothing, |result| said_of(result, known)),
    };
    entry.truth.parameters.iter().map(of_parameter).collect()
}

/// What is said of a parameter, as the vocabulary has it, else as it was fitted. Friction that
/// differs by direction is the force of an offset, and told as one.
fn said_of(result: &Identification, known: &Known) -> Said {
    let same_force = known.name == EffectName::CoulombAsymmetry.as_str();
    let offset = same_force.then_some(EffectName::Offset.as_str());
    let mut names = [known.name].into_iter().chain(offset);
    let told = names.find_map(|name| told(result, name, known.unit.is_empty()));
    let unknown = &result.report.parameters.unknown;
    Said::in_table(told.as_ref(), unknown.contains_key(known.name))
}

/// A known parameter: a share where a share is true, else an effort.
fn told(result: &Identification, name: &str, is_share: bool) -> Option<Estimate> {
    let is_like = |said: &Estimate| said.unit.is_empty() == is_share;
    let parts = result.effects.iter().flat_map(Effect::parts);
    let mut stated = parts.filter(|(row, _)| row.report_name() == name);
    let stated = stated.find_map(|(_, own)| Some(own.clone()).filter(is_like));
    let fitted = || result.report.parameters.get(name).cloned();
    stated.or_else(|| fitted().filter(is_like))
}
