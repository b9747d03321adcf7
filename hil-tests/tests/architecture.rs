//! Arrows point one way: no circle between files, crates or folders.
//!
//! `cargo run -q -p hil-tests --example circles` prints what there is, `--example shape` the length
//! of functions.

use hil_tests::architecture::crates::{self, Member};
use hil_tests::architecture::shape::Shape;
use hil_tests::architecture::{Graph, Sources, rooms, workspace};

fn members() -> Vec<Member> {
    crates::members(&workspace()).unwrap()
}

fn sources(member: &Member) -> Sources {
    Sources::read(&workspace().join(&member.folder)).unwrap()
}

fn assert_no_circle(what: &str, graph: &Graph) {
    let circles = graph
        .circles()
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>();
    assert!(circles.is_empty(), "{what}:\n{}", circles.join("\n"));
}

#[test]
fn no_crate_and_no_folder_uses_one_that_uses_it() {
    let members = members();
    assert_no_circle("crates", &crates::between_crates(&members));
    assert_no_circle("folders", &crates::between_folders(&members));
}

#[test]
fn no_file_uses_one_that_uses_it() {
    for member in members() {
        assert_no_circle(&member.name, &sources(&member).uses());
    }
}

#[test]
fn no_room_uses_a_later_one() {
    for (name, order) in [
        ("identification", &rooms::IDENTIFICATION[..]),
        ("workbench", &rooms::WORKBENCH),
    ] {
        let members = members();
        let member = members.iter().find(|member| member.name == name);
        let wrong = rooms::against_the_order(&sources(member.unwrap()), order);
        assert!(wrong.is_empty(), "{name}:\n{}", wrong.join("\n"));
    }
}

/// A search that finds no file or no use would find no circle either.
#[test]
fn the_search_sees_the_files_and_their_uses() {
    let members = members();
    let uses = |name: &str| {
        let member = members.iter().find(|member| member.name == name).unwrap();
        sources(member).uses().edges().count()
    };
    assert!(uses("identification") > 100, "{}", uses("identification"));
    assert!(uses("workbench") > 60, "{}", uses("workbench"));
    assert!(uses("plant-sim") > 10, "{}", uses("plant-sim"));
    assert!(crates::between_crates(&members).edges().count() > 20);
}

/// Lines of a function that 95 % do not exceed, and that none does.
const LENGTH: [usize; 2] = [30, 60];
/// Share of the lines of `identification` that are tests, percent.
const TESTS_PERCENT: f64 = 25.0;

#[test]
fn functions_fit_a_screen() {
    for name in ["identification", "workbench"] {
        let shape = Shape::of(&workspace().join(name)).unwrap();
        assert!(
            shape.functions.len() > 300,
            "{name}: {}",
            shape.functions.len()
        );
        let p95 = shape.length_at(0.95);
        assert!(
            p95 <= LENGTH[0],
            "{name}: {p95} lines at the 95th percentile"
        );
        let longest = shape.longest().unwrap();
        assert!(longest.lines <= LENGTH[1], "{name}: {longest:?}");
    }
}

#[test]
fn a_quarter_of_the_identification_is_tests() {
    let shape = Shape::of(&workspace().join("identification")).unwrap();
    let share = shape.test_percent();
    assert!((TESTS_PERCENT..60.0).contains(&share), "{share:.1} %");
}

/// A file that cargo leaves out and that stands in no program would be run by nobody, one that
/// stands there and is not left out would be run twice.
#[test]
fn what_cargo_leaves_out_is_the_program_of_all() {
    let read = |file: &str| std::fs::read_to_string(workspace().join("hil-tests").join(file));
    let manifest: toml::Table = read("Cargo.toml").unwrap().parse().unwrap();
    let of_all = read("tests/scenarios.rs").unwrap();
    let targets = manifest["test"].as_array().unwrap();
    let left_out = targets
        .iter()
        .filter(|target| target["test"].as_bool() == Some(false));
    let modules = left_out.map(|own| {
        let name = own["name"].as_str().unwrap();
        format!("#[path = \"{name}.rs\"]\nmod {name};\n")
    });
    let (_, own) = of_all.split_once("\n\n").unwrap();
    assert_eq!(own, modules.collect::<String>());
}
