//! Records of real axes and of a foreign simulator, which may not be redistributed with the
//! project: run with `QUADRANT_DATA=FOLDER cargo test -p identification --test measured --
//! --ignored`, where FOLDER holds `emps` and `blind`.

use std::path::PathBuf;

use identification::{Dataset, Identification, identify};

fn run(name: &str) -> Identification {
    let folder =
        std::env::var_os("QUADRANT_DATA").expect("QUADRANT_DATA says where the records are");
    let dataset = Dataset::read(&PathBuf::from(folder).join(name), None, None).unwrap();
    identify(&dataset, &mut |_| ()).unwrap()
}

#[test]
#[ignore = "needs records that are not part of the project: see the head of this file"]
fn emps_is_fitted_as_published_and_better_with_what_its_model_lacks() {
    let report = run("emps").report;
    println!(
        "{:?}\n{:?}\n{:?}\n{:?}",
        report.found, report.whole, report.train, report.validate
    );
    let whole = report.whole.unwrap();
    assert!(
        (3.9..4.2).contains(&whole.force_error_before_percent),
        "{whole:?}"
    );
    assert!(
        whole.force_error_after_percent <= 2.6 && whole.force_error_after_percent > 1.5,
        "{whole:?}"
    );
    assert!((4.2..4.6).contains(&report.validate.force_error_before_percent));
    assert!(
        report.validate.force_error_after_percent <= 2.1,
        "{:?}",
        report.validate
    );
    for protocol in &report.protocols {
        println!(
            "| {} | {:.2} | {:.2} |",
            protocol.definition, protocol.declared_percent, protocol.extended_percent
        );
    }
    let free_run = report.free_run.unwrap();
    println!("{:?}\n{:?}", free_run.train, free_run.validate);
    assert_eq!(free_run.controller, "known");
    let (before, after) = (
        free_run.validate.position_error_um_before,
        free_run.validate.position_error_um_after,
    );
    assert!(
        (1.5..1.9).contains(&before) && after < 0.75 * before,
        "{before} {after}"
    );
    for effect in ["viscous_asymmetry", "delay", "torque_ripple"] {
        assert!(
            report.found.iter().any(|found| found == effect),
            "{:?}",
            report.found
        );
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
        assert_eq!(
            report.verdict, "explained",
            "{name}: {}",
            report.residual.looks_like
        );
    }
}

#[test]
#[ignore = "needs records that are not part of the project: see the head of this file"]
fn errors_on_blind_records_are_near_those_of_the_true_structure() {
    let base = ["inertia", "viscous", "coulomb", "offset"]
        .map(String::from)
        .to_vec();
    for (name, truth) in [
        ("a01", vec!["stribeck"]),
        ("a02", vec!["torque_ripple"]),
        ("a03", vec!["backlash"]),
        ("a04", vec![]),
        ("a05", vec!["friction_drift", "viscous_asymmetry"]),
        ("a06", vec![]),
    ] {
        let declared = [base.clone(), truth.into_iter().map(String::from).collect()].concat();
        let folder =
            std::env::var_os("QUADRANT_DATA").expect("QUADRANT_DATA says where the records are");
        let dataset = Dataset::read(
            &PathBuf::from(folder).join("blind").join(name),
            None,
            Some(declared),
        )
        .unwrap();
        let told = identify(&dataset, &mut |_| ()).unwrap().report.validate;
        let found = run(&format!("blind/{name}")).report.validate;
        let (told_um, found_um) = (
            told.position_difference_error_um_before,
            found.position_difference_error_um_after,
        );
        println!(
            "{name}: force {:.3} / {:.3} %, difference {told_um:?} / {found_um:?} µm",
            told.force_error_before_percent, found.force_error_after_percent
        );
        assert!(
            found.force_error_after_percent <= 1.1 * told.force_error_before_percent,
            "{name}"
        );
        assert!(
            found_um
                .zip(told_um)
                .is_none_or(|(found, told)| found <= 1.1 * told),
            "{name}"
        );
    }
}

#[test]
#[ignore = "needs records that are not part of the project: see the head of this file"]
fn cogging_of_a_small_motor_is_named_by_its_orders() {
    let report = run("bldc_cogging").report;
    let ripple = report.slow_ripple.unwrap();
    println!("{ripple:?}");
    assert_eq!(report.found, ["torque_ripple"]);
    // 24 magnets over 18 slots: the cogging order is their least common multiple, and the slots
    // show beside it.
    let orders: Vec<u32> = ripple.orders.iter().map(|order| order.per_rev).collect();
    assert_eq!(orders[..2], [72, 18]);
    assert!(
        ripple.validate_force_error_after_percent
            < 0.6 * ripple.validate_force_error_before_percent
    );
}
