//! Records of real axes and of a foreign simulator, which may not be redistributed with the project: run with
//! `QUADRANT_DATA=FOLDER cargo test -p identification --test measured -- --ignored`, where FOLDER holds `emps` and `blind`.

use std::path::PathBuf;

use identification::{Dataset, Identification, identify};

fn run(name: &str) -> Identification {
    let folder = std::env::var_os("QUADRANT_DATA").expect("QUADRANT_DATA says where the records are");
    let dataset = Dataset::read(&PathBuf::from(folder).join(name), None, None).unwrap();
    identify(&dataset, &mut |_| ()).unwrap()
}

#[test]
#[ignore = "needs records that are not part of the project: see the head of this file"]
fn emps_is_fitted_as_published_and_better_with_what_its_model_lacks() {
    let report = run("emps").report;
    println!("{:?}\n{:?}\n{:?}\n{:?}", report.found, report.whole, report.train, report.validate);
    let whole = report.whole.unwrap();
    assert!((3.9..4.2).contains(&whole.force_error_before_percent), "{whole:?}");
    assert!(whole.force_error_after_percent <= 2.6 && whole.force_error_after_percent > 1.5, "{whole:?}");
    assert!((4.2..4.6).contains(&report.validate.force_error_before_percent));
    assert!(report.validate.force_error_after_percent <= 2.6, "{:?}", report.validate);
    for effect in ["viscous_asymmetry", "delay", "torque_ripple"] {
        assert!(report.found.iter().any(|found| found == effect), "{:?}", report.found);
    }
}

#[test]
#[ignore = "needs records that are not part of the project: see the head of this file"]
fn blind_records_give_exactly_what_they_lack() {
    for (name, wanted) in [
        ("a01", vec!["stribeck"]),
        ("a02", vec!["torque_ripple"]),
        ("a03", vec!["backlash"]),
        ("a04", vec![]),
        ("a05", vec!["friction_drift", "viscous_asymmetry"]),
        ("a06", vec![]),
    ] {
        let report = run(&format!("blind/{name}")).report;
        assert_eq!(report.found, wanted, "{name}");
        assert_eq!(report.verdict, "explained", "{name}: {}", report.residual.looks_like);
    }
}
