//! The chapters of a page about one identification: the verdict, the table that it follows from,
//! pictures of what was found.

use identification::{Identification, figures};

use super::page::Page;
use super::result_pictures::{
    effect_pictures, free_run_picture, presliding_picture, residual_pictures, time_picture,
};
use super::result_tables::{
    candidate_table, error_table, free_run_sentence, free_run_table, parameter_table,
    protocol_table, reversal_shape_table, sentence, shown_table, slow_ripple_table,
};

/// The chapters of an identification.
pub fn add_identification(page: &mut Page, title: &str, result: &Identification) {
    let report = &result.report;
    page.heading(title);
    page.key(&sentence(report));
    page.table(&error_table(result));
    if !report.shown.is_empty() {
        page.paragraph("Where each effect shows that was found, on the training record:");
        page.table(&shown_table(report));
    }
    let mut pictures = effect_pictures(result);
    pictures.extend(presliding_picture(result));
    pictures.extend(residual_pictures(result));
    page.pictures(&pictures);
    page.pictures(&[time_picture(result)]);
    page.paragraph("At standstill friction is whatever holds: there the models only say between which limits, and the noise of the speed picks one of them.");
    free_run(page, result);
    slow_ripple(page, result);
    page.paragraph(
        "Parameters of the extended model, with 95 % intervals (jackknife over blocks of 1 s, nonlinear ones linearised); model.toml carries the same:",
    );
    page.table(&parameter_table(report));
    for warning in &report.warnings {
        page.paragraph(&format!("Note: {warning}."));
    }
    page.details(
        "Candidates, by the share of the held-out error that they remove (blocks of 1 s left out of the fit)",
        &candidate_table(report),
    );
    page.details(
        "The force error by the protocols that papers use",
        &protocol_table(report),
    );
}

/// Free-run simulation: errors, shapes at reversals, picture.
fn free_run(page: &mut Page, result: &Identification) {
    let Some(free_run) = &result.report.free_run else {
        return;
    };
    page.paragraph(&free_run_sentence(free_run));
    page.table(&free_run_table(result));
    page.pictures(&[free_run_picture(result)]);
    page.details(
        "What each shape of friction leaves at reversals, of the simulated position (blocks that were not fitted) and of the effort",
        &reversal_shape_table(result),
    );
}

/// Ripple that was found about the reversals of an axis that is never slow for long.
fn slow_ripple(page: &mut Page, result: &Identification) {
    let Some(ripple) = &result.report.slow_ripple else {
        return;
    };
    page.paragraph(&format!(
        "Torque ripple about the reversals (samples up to {} {}/s, low-pass {} Hz): force error {} → {} % on the training record, {} → {} % on the validation record:",
        figures::error(ripple.fastest),
        result.position_unit,
        ripple.cutoff_hz,
        figures::error(ripple.train_force_error_before_percent),
        figures::error(ripple.train_force_error_after_percent),
        figures::error(ripple.validate_force_error_before_percent),
        figures::error(ripple.validate_force_error_after_percent)
    ));
    page.table(&slow_ripple_table(result));
}
