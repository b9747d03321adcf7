//! How long functions are, and how much of a crate is tests.
//!
//! A function reaches from the line of its `fn` to that of its closing brace, as rustfmt leaves it
//! at 100 columns; comments inside count. Functions of tests are not counted. Lines of tests are
//! those of `cfg(test)` items below `src`, and all of `tests/`.

use std::io;
use std::path::Path;

use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Block, ImplItemFn, Item, ItemFn, Signature, TraitItemFn};

use super::mentions::is_for_tests;
use super::sources::{Sources, rust_files};

/// A function outside tests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// File below `src` and line.
    pub place: String,
    /// Its name.
    pub name: String,
    /// From `fn` to the closing brace.
    pub lines: usize,
}

/// What a crate looks like.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// Files below `src`.
    pub files: usize,
    /// Lines below `src` and `tests`.
    pub lines: usize,
    /// Those of tests.
    pub test_lines: usize,
    /// Sorted by length, longest last.
    pub functions: Vec<Function>,
}

impl Shape {
    /// Looks at the crate in a folder.
    ///
    /// # Errors
    /// Where a file cannot be read or is no Rust.
    pub fn of(folder: &Path) -> io::Result<Self> {
        let mut shape = Self::of_sources(&Sources::read(folder)?);
        let tests = folder.join("tests");
        let files = if tests.is_dir() {
            rust_files(&tests)?
        } else {
            Vec::new()
        };
        for file in files {
            let lines = std::fs::read_to_string(file)?.lines().count();
            shape.lines += lines;
            shape.test_lines += lines;
        }
        Ok(shape)
    }

    /// Looks at what stands below `src`.
    #[must_use]
    pub fn of_sources(sources: &Sources) -> Self {
        let mut shape = Self::default();
        for file in &sources.files {
            let mut ruler = Ruler {
                file: &file.path,
                shape: &mut shape,
            };
            ruler.visit_file(&file.syntax);
            shape.files += 1;
            shape.lines += file.text.lines().count();
        }
        shape.functions.sort_by_key(|function| function.lines);
        shape
    }

    /// The length that a share of the functions does not exceed (nearest rank).
    #[must_use]
    pub fn length_at(&self, share: f64) -> usize {
        let rank = (share * self.functions.len() as f64).ceil() as usize;
        let function = self.functions.get(rank.saturating_sub(1));
        function.map_or(0, |function| function.lines)
    }

    /// The longest function.
    #[must_use]
    pub fn longest(&self) -> Option<&Function> {
        self.functions.last()
    }

    /// Lines of tests, percent.
    #[must_use]
    pub fn test_percent(&self) -> f64 {
        100.0 * self.test_lines as f64 / self.lines.max(1) as f64
    }
}

struct Ruler<'a> {
    file: &'a str,
    shape: &'a mut Shape,
}

impl Ruler<'_> {
    fn take(&mut self, signature: &Signature, body: &Block) {
        let first = signature.fn_token.span().start().line;
        self.shape.functions.push(Function {
            place: format!("{}:{first}", self.file),
            name: signature.ident.to_string(),
            lines: body.span().end().line - first + 1,
        });
    }
}

impl<'ast> Visit<'ast> for Ruler<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_for_tests(super::mentions::attributes(item)) {
            let span = item.span();
            self.shape.test_lines += span.end().line - span.start().line + 1;
        } else {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        self.take(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.take(&function.sig, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast TraitItemFn) {
        if let Some(body) = &function.default {
            self.take(&function.sig, body);
        }
        visit::visit_trait_item_fn(self, function);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(text: &str) -> Shape {
        let texts = vec![("lib.rs".to_owned(), text.to_owned())];
        Shape::of_sources(&Sources::parse("made_up", texts).unwrap())
    }

    #[test]
    fn a_function_is_as_long_as_from_its_fn_to_its_brace() {
        let text = "/// Doc.\n#[inline]\nfn f(\n    x: u8,\n) {\n    // why\n}\n\nimpl A {\n    fn g() {}\n}\n\
                    trait T {\n    fn h();\n    fn i() {\n    }\n}\n";
        let shape = shape(text);
        let lengths: Vec<(&str, usize)> = shape
            .functions
            .iter()
            .map(|function| (&*function.name, function.lines))
            .collect();
        assert_eq!(lengths, [("g", 1), ("i", 2), ("f", 5)]);
        assert_eq!(shape.longest().unwrap().place, "lib.rs:3");
    }

    #[test]
    fn lines_of_tests_are_those_of_the_module_with_its_attribute() {
        let shape =
            shape("fn f() {}\n\n#[cfg(test)]\nmod tests {\n    #[test]\n    fn g() {}\n}\n");
        assert_eq!((shape.lines, shape.test_lines), (7, 5));
        assert_eq!(shape.functions.len(), 1);
        assert!((shape.test_percent() - 71.4).abs() < 0.1);
    }

    #[test]
    fn of_twenty_functions_the_nineteenth_is_the_length_that_95_percent_do_not_exceed() {
        let functions = (1..=20).map(|lines| Function {
            place: String::new(),
            name: String::new(),
            lines,
        });
        let shape = Shape {
            functions: functions.collect(),
            ..Shape::default()
        };
        assert_eq!(shape.length_at(0.5), 10);
        assert_eq!(shape.length_at(0.95), 19);
        assert_eq!(Shape::default().length_at(0.95), 0);
    }
}
