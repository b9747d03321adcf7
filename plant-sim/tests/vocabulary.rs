//! `docs/machine-files.md` has the vocabulary of effects as the crate has it.

use axis_model::{EffectName, Parameter};

fn parameter(parameter: &Parameter) -> String {
    let key = parameter.key();
    if parameter.optional {
        format!("*`{key}`*")
    } else {
        format!("`{key}`")
    }
}

fn row(name: EffectName) -> String {
    let parameters: Vec<String> = name.parameters().iter().map(parameter).collect();
    format!(
        "| `{name}` | {} | {} |",
        name.words(),
        parameters.join(", ")
    )
}

#[test]
fn the_document_has_a_line_for_each_effect_with_its_keys() {
    let document = include_str!("../../docs/machine-files.md");
    let rows: Vec<String> = EffectName::ALL.iter().copied().map(row).collect();
    for row in &rows {
        assert!(
            document.contains(row),
            "docs/machine-files.md wants:\n{}",
            rows.join("\n")
        );
    }
    let is_row = |line: &&str| {
        let name = line
            .strip_prefix("| `")
            .and_then(|rest| rest.split('`').next());
        name.is_some_and(|name| name.parse::<EffectName>().is_ok())
    };
    let written = document.lines().filter(is_row).count();
    assert_eq!(written, rows.len(), "a line for an effect that is none");
}
