//! The paths that a file writes down: in `use`, in code, in types, and in the tokens of macros.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemMod, ItemUse, Macro, UseTree, Visibility};

/// A path of names, as in `crate::fit::bench`.
pub type Names = Vec<String>;

/// A path and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mention {
    /// The module in which it stands, inline modules included.
    pub scope: Names,
    /// As it is written: `["super", "bench", "Bench"]`.
    pub path: Names,
    /// Line in the file.
    pub line: usize,
}

/// Everything a file writes down, `cfg(test)` left out.
#[derive(Debug, Default)]
pub struct Written {
    /// All paths of at least two names, and all of `use`.
    pub mentions: Vec<Mention>,
    /// What a name means in a scope because a `use` says so.
    pub imports: BTreeMap<(Names, String), Names>,
    /// `use path::*` by scope.
    pub globs: Vec<(Names, Names)>,
    /// Names of modules that are declared in a scope.
    pub modules: BTreeSet<Names>,
    /// Names that are defined in a scope.
    pub items: BTreeSet<(Names, String)>,
    /// Modules that exist for tests only.
    pub test_modules: Vec<Names>,
}

/// Collects what a file of a module writes down.
#[must_use]
pub fn written(module: &[String], syntax: &syn::File) -> Written {
    let mut collector = Collector {
        scope: module.to_vec(),
        written: Written::default(),
    };
    collector.visit_file(syntax);
    collector.written
}

/// Whether an item is compiled for tests only: `#[cfg(test)]`, `#[cfg(all(test, …))]`, `#[test]`.
#[must_use]
pub fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let path = attribute.path();
        path.is_ident("test") || path.is_ident("cfg") && asks_for_test(attribute)
    })
}

fn asks_for_test(attribute: &Attribute) -> bool {
    let Ok(list) = attribute.meta.require_list() else {
        return false;
    };
    let tokens = list.tokens.clone().into_iter();
    let words: Vec<String> = tokens.map(|token| token.to_string()).collect();
    match &words[..] {
        [only] => only == "test",
        [all, inside] => all == "all" && inside.trim_matches(['(', ')']).starts_with("test"),
        _ => false,
    }
}

struct Collector {
    scope: Names,
    written: Written,
}

impl Collector {
    fn mention(&mut self, path: Names, line: usize) {
        self.written.mentions.push(Mention {
            scope: self.scope.clone(),
            path,
            line,
        });
    }

    /// A tree of `use`: `a::{b, c as d, e::*}` gives three paths.
    fn take_use(&mut self, tree: &UseTree, mut before: Names) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.take_use(&path.tree, before);
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.take_use(tree, before.clone());
                }
            }
            UseTree::Name(name) if name.ident == "self" => {
                let known_as = before.last().cloned().unwrap_or_default();
                self.import(known_as, before, name.span());
            }
            UseTree::Name(name) => {
                before.push(name.ident.to_string());
                self.import(name.ident.to_string(), before, name.span());
            }
            UseTree::Rename(rename) => {
                before.push(rename.ident.to_string());
                self.import(rename.rename.to_string(), before, rename.span());
            }
            UseTree::Glob(glob) => {
                self.written
                    .globs
                    .push((self.scope.clone(), before.clone()));
                self.mention(before, glob.span().start().line);
            }
        }
    }

    fn import(&mut self, known_as: String, path: Names, span: proc_macro2::Span) {
        let key = (self.scope.clone(), known_as);
        self.written.imports.insert(key, path.clone());
        self.mention(path, span.start().line);
    }

    /// Paths in tokens that nobody has parsed: the arguments of a macro.
    fn take_tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut colons, mut line) = (Names::new(), 0, 0);
        for token in tokens {
            match token {
                TokenTree::Ident(name) => {
                    if colons != 2 {
                        self.take_path(std::mem::take(&mut path), line);
                        line = name.span().start().line;
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => {
                    self.take_path(std::mem::take(&mut path), line);
                    self.take_tokens(group.stream());
                    colons = 0;
                }
                _ => {
                    self.take_path(std::mem::take(&mut path), line);
                    colons = 0;
                }
            }
        }
        self.take_path(path, line);
    }

    fn take_path(&mut self, path: Names, line: usize) {
        if path.len() > 1 {
            self.mention(path, line);
        }
    }
}

impl<'ast> Visit<'ast> for Collector {
    fn visit_item(&mut self, item: &'ast Item) {
        if let Some(name) = name(item) {
            self.written.items.insert((self.scope.clone(), name));
        }
        if !is_for_tests(attributes(item)) {
            visit::visit_item(self, item);
        } else if let Item::Mod(module) = item {
            let module = [self.scope.clone(), vec![module.ident.to_string()]].concat();
            self.written.test_modules.push(module);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        self.scope.push(module.ident.to_string());
        self.written.modules.insert(self.scope.clone());
        visit::visit_item_mod(self, module);
        self.scope.pop();
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if item.leading_colon.is_none() {
            self.take_use(&item.tree, Names::new());
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names = path.segments.iter().map(|name| name.ident.to_string());
        self.take_path(names.collect(), path.span().start().line);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.take_tokens(call.tokens.clone());
        visit::visit_macro(self, call);
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

pub(super) fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The name under which others find an item.
fn name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Mod(item) => &item.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paths that a text writes down, in its order.
    fn paths(text: &str) -> Vec<String> {
        let syntax = syn::parse_file(text).unwrap();
        let written = written(&["here".to_owned()], &syntax);
        let mentions = written.mentions.iter();
        mentions.map(|mention| mention.path.join("::")).collect()
    }

    #[test]
    fn paths_are_found_in_use_in_code_in_types_and_in_macros() {
        for (text, wanted) in [
            (
                "use crate::a::{self, B, c::D as E};",
                "crate::a crate::a::B crate::a::c::D",
            ),
            ("use super::a::*;", "super::a"),
            ("fn f() { super::a::g(); }", "super::a::g"),
            (
                "fn f(x: &crate::a::T) -> crate::b::U<crate::c::V> { g() }",
                "crate::a::T crate::b::U crate::c::V",
            ),
            (
                "fn f() { println!(\"{}\", crate::a::g(b::c(1))); }",
                "crate::a::g b::c",
            ),
            ("impl crate::a::T for super::S {}", "crate::a::T super::S"),
        ] {
            assert_eq!(paths(text).join(" "), wanted, "{text}");
        }
    }

    #[test]
    fn what_stands_under_a_test_attribute_or_in_a_visibility_is_not_a_mention() {
        for text in [
            "#[cfg(test)] mod tests { use crate::a::B; }",
            "#[cfg(all(test, unix))] use crate::a::B;",
            "#[cfg(test)] fn f() { crate::a::g(); }",
            "#[test] fn f() { crate::a::g(); }",
            "pub(in crate::a) fn f() {}",
        ] {
            assert_eq!(paths(text), Vec::<String>::new(), "{text}");
        }
        assert_eq!(paths("#[cfg(not(test))] use crate::a::B;"), ["crate::a::B"]);
    }

    #[test]
    fn a_mention_knows_its_line_and_the_inline_module_in_which_it_stands() {
        let syntax = syn::parse_file("mod inner {\n  use super::a::B;\n}").unwrap();
        let written = written(&["here".to_owned()], &syntax);
        let [mention] = &written.mentions[..] else {
            panic!("{written:?}");
        };
        assert_eq!(mention.scope, ["here", "inner"]);
        assert_eq!(mention.line, 2);
    }
}
