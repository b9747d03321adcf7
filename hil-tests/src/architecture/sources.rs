//! The files of a crate, parsed.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use super::mentions::{Names, Written, written};

/// A file of a crate.
pub struct Source {
    /// Below `src`, as in `fit/bench.rs`.
    pub path: String,
    /// Its module, as in `["fit", "bench"]`; empty for `lib.rs`.
    pub module: Names,
    /// Its text.
    pub text: String,
    /// What it parses to.
    pub syntax: syn::File,
    /// The paths it writes down.
    pub written: Written,
}

/// The files below `src` of a crate, those of `cfg(test)` modules left out.
pub struct Sources {
    /// Name of the crate as paths spell it, with underscores.
    pub name: String,
    /// In the order of their paths.
    pub files: Vec<Source>,
}

impl Sources {
    /// Reads the crate in a folder.
    ///
    /// # Errors
    /// Where a file cannot be read or is no Rust.
    pub fn read(folder: &Path) -> io::Result<Self> {
        let src = folder.join("src");
        let mut texts = Vec::new();
        for path in rust_files(&src)? {
            let below = path.strip_prefix(&src).map_err(io::Error::other)?;
            texts.push((below.display().to_string(), std::fs::read_to_string(&path)?));
        }
        let name = super::crates::package_name(folder)?;
        Self::parse(&name.replace('-', "_"), texts)
    }

    /// Parses a crate from paths below `src` and texts.
    ///
    /// # Errors
    /// Where a text is no Rust.
    pub fn parse(name: &str, texts: Vec<(String, String)>) -> io::Result<Self> {
        let mut files = texts
            .into_iter()
            .map(|(path, text)| source(path, text))
            .collect::<io::Result<Vec<_>>>()?;
        let tests = test_modules(&files);
        files.retain(|file| !tests.iter().any(|test| file.module.starts_with(test)));
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Self {
            name: name.to_owned(),
            files,
        })
    }

    /// The file of a module, or the nearest one above it.
    #[must_use]
    pub fn file_above(&self, module: &[String]) -> Option<usize> {
        let lengths = (0..=module.len()).rev();
        lengths
            .map(|length| self.file_of(&module[..length]))
            .find_map(|file| file)
    }

    /// The file of a module.
    #[must_use]
    pub fn file_of(&self, module: &[String]) -> Option<usize> {
        self.files.iter().position(|file| file.module == module)
    }
}

fn source(path: String, text: String) -> io::Result<Source> {
    let syntax = syn::parse_file(&text).map_err(|error| {
        let line = error.span().start().line;
        io::Error::other(format!("{path}:{line}: {error}"))
    })?;
    let module = module(&path);
    Ok(Source {
        written: written(&module, &syntax),
        path,
        module,
        text,
        syntax,
    })
}

/// `fit/bench.rs` is `fit::bench`, `fit/mod.rs` is `fit`, `lib.rs` is the crate itself.
fn module(path: &str) -> Names {
    let stem = path.trim_end_matches(".rs");
    let names = stem.split('/').map(str::to_owned);
    names
        .filter(|name| name != "mod" && name != "lib")
        .collect()
}

/// Modules in files of their own that are compiled for tests only.
fn test_modules(files: &[Source]) -> BTreeSet<Names> {
    files
        .iter()
        .flat_map(|file| file.written.test_modules.iter().cloned())
        .collect()
}

/// All `.rs` files below a folder, sorted.
///
/// # Errors
/// Where a folder cannot be read.
pub fn rust_files(folder: &Path) -> io::Result<Vec<std::path::PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|end| end == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_the_module_that_its_path_spells() {
        for (path, wanted) in [
            ("lib.rs", ""),
            ("fit.rs", "fit"),
            ("fit/mod.rs", "fit"),
            ("fit/bench.rs", "fit::bench"),
            ("main.rs", "main"),
        ] {
            assert_eq!(module(path).join("::"), wanted, "{path}");
        }
    }

    #[test]
    fn a_module_for_tests_in_a_file_of_its_own_is_left_out() {
        let texts = [
            (
                "lib.rs",
                "mod a; #[cfg(test)] mod rig; #[cfg(not(test))] mod b;",
            ),
            ("a.rs", ""),
            ("b.rs", ""),
            ("rig.rs", "use crate::a;"),
        ];
        let texts = texts.map(|(path, text)| (path.to_owned(), text.to_owned()));
        let sources = Sources::parse("made_up", texts.into()).unwrap();
        let paths: Vec<&str> = sources.files.iter().map(|file| &*file.path).collect();
        assert_eq!(paths, ["a.rs", "b.rs", "lib.rs"]);
    }
}
