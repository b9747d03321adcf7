//! The file in which a path ends.
//!
//! `crate`, `self` and `super` are followed, then names that a `use` has brought into scope, then
//! re-exports: `crate::motion::Kinematics` leads to `motion/kinematics.rs` where `motion.rs` says
//! `pub use kinematics::Kinematics`. A circle cannot hide behind a shorter name.

use super::graph::Graph;
use super::mentions::{Mention, Names};
use super::sources::Sources;

/// More re-exports in a row than any crate has; a path that names itself ends here.
const LONGEST_CHAIN: usize = 16;

impl Sources {
    /// Which file uses which: parents left out.
    #[must_use]
    pub fn uses(&self) -> Graph {
        let mut graph = Graph::new(self.files.iter().map(|file| file.path.clone()));
        for (from, file) in self.files.iter().enumerate() {
            for mention in &file.written.mentions {
                let Some(to) = self.file_meant(from, mention) else {
                    continue;
                };
                let is_parent = file.module.starts_with(&self.files[to].module);
                if !is_parent {
                    let path = mention.path.join("::");
                    graph.connect(from, to, format!("line {}: {path}", mention.line));
                }
            }
        }
        graph
    }

    /// The file of this crate that a mention leads to.
    fn file_meant(&self, from: usize, mention: &Mention) -> Option<usize> {
        let path = self.absolute(from, &mention.scope, &mention.path, LONGEST_CHAIN)?;
        self.definition(&path, LONGEST_CHAIN)
    }

    /// A path from the root of the crate; `None` where it leads out of it.
    fn absolute(
        &self,
        file: usize,
        scope: &[String],
        path: &[String],
        chain: usize,
    ) -> Option<Names> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([scope, rest].concat()),
            "super" => self.absolute_above(file, scope, rest, chain),
            own if own == self.name => Some(rest.to_vec()),
            _ => self.absolute_by_name(file, scope, path, chain),
        }
    }

    /// The rest of a path after `super`, which may begin with `super` again.
    fn absolute_above(
        &self,
        file: usize,
        scope: &[String],
        rest: &[String],
        chain: usize,
    ) -> Option<Names> {
        let (_, above) = scope.split_last()?;
        match rest.first().map(String::as_str) {
            Some("super") => self.absolute(file, above, rest, chain),
            _ => Some([above, rest].concat()),
        }
    }

    /// A path that begins with a name: a module of the scope, or something that a `use` brought in.
    fn absolute_by_name(
        &self,
        file: usize,
        scope: &[String],
        path: &[String],
        chain: usize,
    ) -> Option<Names> {
        let (first, rest) = path.split_first()?;
        let module = [scope, std::slice::from_ref(first)].concat();
        let written = &self.files[file].written;
        if written.modules.contains(&module) {
            return Some([module, rest.to_vec()].concat());
        }
        let imported = written.imports.get(&(scope.to_vec(), first.clone()))?;
        if chain == 0 || imported == path {
            return None;
        }
        let import = self.absolute(file, scope, imported, chain - 1)?;
        Some([import, rest.to_vec()].concat())
    }

    /// The file that defines what an absolute path names, re-exports followed.
    fn definition(&self, path: &[String], chain: usize) -> Option<usize> {
        let file = self.file_above(path)?;
        let module = &self.files[file].module;
        let rest = &path[module.len()..];
        let Some((name, after)) = rest.split_first().filter(|_| chain > 0) else {
            return Some(file);
        };
        let exported = self.exported(file, module, name);
        exported.map_or(Some(file), |export| {
            self.definition(&[export, after.to_vec()].concat(), chain - 1)
        })
    }

    /// Where a name of a module comes from, if it is not defined there.
    fn exported(&self, file: usize, module: &[String], name: &str) -> Option<Names> {
        let written = &self.files[file].written;
        let key = (module.to_vec(), name.to_owned());
        if written.items.contains(&key) {
            return None;
        }
        if let Some(import) = written.imports.get(&key) {
            return self.absolute(file, module, import, LONGEST_CHAIN);
        }
        let globs = written.globs.iter().filter(|(scope, _)| scope == module);
        globs
            .filter_map(|(_, path)| self.absolute(file, module, path, LONGEST_CHAIN))
            .find(|path| self.defines(path, name))
            .map(|path| [path, vec![name.to_owned()]].concat())
    }

    fn defines(&self, module: &[String], name: &str) -> bool {
        let key = (module.to_vec(), name.to_owned());
        self.file_above(module)
            .is_some_and(|file| self.files[file].written.items.contains(&key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crate_of(texts: &[(&str, &str)]) -> Sources {
        let texts = texts
            .iter()
            .map(|(path, text)| ((*path).into(), (*text).into()));
        Sources::parse("made_up", texts.collect()).unwrap()
    }

    fn edges(texts: &[(&str, &str)]) -> Vec<String> {
        let graph = crate_of(texts).uses();
        let edges = graph.edges();
        edges
            .map(|(from, to, _)| format!("{from} -> {to}"))
            .collect()
    }

    #[test]
    fn a_path_leads_to_the_file_in_which_its_name_is_defined() {
        let rooms = [
            ("lib.rs", "mod a; mod b; mod c;"),
            (
                "a.rs",
                "pub mod deep; pub use deep::Deep; pub use crate::b::*; pub struct Own;",
            ),
            ("a/deep.rs", "pub struct Deep;"),
            ("b.rs", "pub struct Wide;"),
        ];
        for (text, wanted) in [
            ("use crate::a::Own;", "c.rs -> a.rs"),
            ("use crate::a::Deep;", "c.rs -> a/deep.rs"),
            ("use super::a::deep::Deep;", "c.rs -> a/deep.rs"),
            ("use crate::a::Wide;", "c.rs -> b.rs"),
            ("fn f() { made_up::b::g() }", "c.rs -> b.rs"),
            (
                "use crate::a as x; fn f(_: x::Deep) {}",
                "c.rs -> a.rs c.rs -> a/deep.rs",
            ),
            ("use std::fmt; use other::a::Own;", ""),
        ] {
            let texts = [&rooms[..], &[("c.rs", text)]].concat();
            let from_c = edges(&texts)
                .into_iter()
                .filter(|edge| edge.starts_with('c'));
            assert_eq!(from_c.collect::<Vec<_>>().join(" "), wanted, "{text}");
        }
    }

    #[test]
    fn a_file_may_use_its_parents_and_they_may_use_it() {
        let texts = [
            ("lib.rs", "mod a; pub use a::f;"),
            (
                "a.rs",
                "mod part; pub fn f() { part::g() } pub struct Shared;",
            ),
            (
                "a/part.rs",
                "use super::Shared; use crate::f; pub fn g() { crate::a::f() }",
            ),
        ];
        assert_eq!(crate_of(&texts).uses().circles(), []);
    }

    #[test]
    fn a_circle_behind_a_re_export_is_found() {
        let texts = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "mod part; pub use part::Part;"),
            ("a/part.rs", "use crate::b::B; pub struct Part;"),
            ("b.rs", "use crate::a::Part; pub struct B;"),
        ];
        let circles = crate_of(&texts).uses().circles();
        let [circle] = &circles[..] else {
            panic!("{circles:?}");
        };
        assert_eq!(
            circle.to_string(),
            "a/part.rs -> b.rs (line 1: crate::b::B)\nb.rs -> a/part.rs (line 1: crate::a::Part)\n"
        );
    }

    #[test]
    fn a_circle_that_only_tests_close_is_none() {
        let texts = [
            ("lib.rs", "mod a; mod b;"),
            (
                "a.rs",
                "pub struct A; #[cfg(test)] mod tests { use crate::b::B; }",
            ),
            ("b.rs", "use crate::a::A; pub struct B;"),
        ];
        assert_eq!(edges(&texts), ["b.rs -> a.rs"]);
    }

    #[test]
    fn a_name_that_imports_itself_ends_the_search() {
        let texts = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "pub use crate::b::X;"),
            ("b.rs", "pub use crate::a::X;"),
        ];
        assert!(!crate_of(&texts).uses().circles().is_empty());
    }
}
