//! What the documents point to is there. The design history is left out: it is about what is not
//! there any more.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// README and the documents.
fn documents() -> Vec<PathBuf> {
    let docs = std::fs::read_dir(root().join("docs")).unwrap();
    let pages = docs.map(|entry| entry.unwrap().path());
    let pages = pages.filter(|path| path.extension().is_some_and(|end| end == "md"));
    let living = pages.filter(|path| !path.ends_with("design-history.md"));
    living.chain([root().join("README.md")]).collect()
}

/// What stands between backquotes, is one word and starts with a folder of the repository.
fn paths(text: &str) -> Vec<String> {
    let quoted = text.split('`').skip(1).step_by(2);
    let words = quoted.filter(|word| word.contains('/') && !word.contains([' ', '*', '…', '<']));
    let ours = words.filter(|word| {
        let folder = word.split('/').next().unwrap_or_default();
        !matches!(folder, "" | "target") && root().join(folder).is_dir()
    });
    ours.map(str::to_owned).collect()
}

/// Links of Markdown to files beside the document.
fn links(text: &str) -> Vec<String> {
    let targets = text.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split([')', '#']).next());
    let local = targets.filter(|target| !target.is_empty() && !target.contains("://"));
    local.map(str::to_owned).collect()
}

#[test]
fn every_path_and_link_in_the_documents_leads_somewhere() {
    let mut dead = Vec::new();
    let mut seen = 0;
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap();
        let beside = document.parent().unwrap();
        let of_root = paths(&text).into_iter().map(|path| root().join(path));
        let of_links = links(&text).into_iter().map(|link| beside.join(link));
        for target in of_root.chain(of_links) {
            seen += 1;
            if !target.exists() {
                dead.push(format!("{}: {}", document.display(), target.display()));
            }
        }
    }
    assert!(seen > 50, "only {seen} pointers were read");
    assert!(dead.is_empty(), "{}", dead.join("\n"));
}

#[test]
fn a_path_is_told_from_a_command_and_from_a_fraction() {
    let text = "`servo/src` `cargo run` `m/s` `no-such/folder` `hil-tests/golden` [a](b.md#c)";
    assert_eq!(paths(text), ["hil-tests/golden"]);
    assert_eq!(links(text), ["b.md"]);
}
