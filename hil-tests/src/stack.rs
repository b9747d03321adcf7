//! How much stack an image can take: the frames of its functions, summed along the deepest chain of
//! calls.
//!
//! Read from the linked image, so that it is the stack of the program that runs. A function takes
//! what its instructions take from the stack pointer, all of them together: at least as much as it
//! has at any time. Where a register is called, the rules say which functions that can be for all
//! such calls of a function ([`Rule`]); a caller without a rule, a rule without a function, a call
//! to where none begins and a circle of calls are errors.
//!
//! Blind to: what begins at a panic ([`ENDS`]; the node is silent then, and the board resets), and
//! a debugger.

mod thumb;

use std::collections::BTreeMap;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};
use thumb::Does;

/// What comes after these is not counted: a panic and its text.
pub const ENDS: [&str; 6] = [
    "core::panicking",
    "core::fmt",
    "unwrap_failed",
    "expect_failed",
    "slice_index_fail",
    "_default_panic",
];

/// Where functions whose name holds one of these call a register, it holds a function whose name
/// holds one of those. The first rule that fits a caller counts.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Callers.
    pub of: &'static [&'static str],
    /// What they can call.
    pub calls: &'static [&'static str],
    /// But for what calls a function whose name holds one of these.
    pub but_for_callers_of: &'static [&'static str],
}

/// The deepest chain from a function on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chain {
    /// All frames together.
    pub bytes: u32,
    /// The functions with their frames, the deepest one last.
    pub frames: Vec<(String, u32)>,
}

/// The functions of an image.
#[derive(Clone, Debug, Default)]
pub struct Functions {
    by_address: BTreeMap<u64, Function>,
}

#[derive(Clone, Debug, Default)]
struct Function {
    /// One name, or several where functions of equal code are one.
    names: Vec<String>,
    bytes: u32,
    /// Addresses of functions that it calls or goes to.
    calls: Vec<u64>,
    calls_a_register: bool,
    /// Its stack pointer comes from somewhere.
    sets_stack: bool,
}

impl Function {
    fn name(&self) -> &str {
        self.names.first().map_or("", |name| name)
    }

    fn holds(&self, parts: &[&str]) -> bool {
        let holds = |name: &String| parts.iter().any(|part| name.contains(part));
        self.names.iter().any(holds)
    }

    /// Functions of equal code are one: it ends there only where all of them do.
    fn is_end(&self, ends: &[&str]) -> bool {
        let ends = |name: &String| ends.iter().any(|end| name.contains(end));
        self.names.iter().all(ends)
    }
}

/// Bit 0 of an address says Thumb.
const fn even(address: u64) -> u64 {
    address & !1
}

impl Functions {
    /// Reads an image with symbols.
    ///
    /// # Errors
    /// Where it is no ELF image, or has no code.
    pub fn of(image: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(image).map_err(|error| error.to_string())?;
        let is_code = |section: &object::Section<'_, '_>| section.kind() == SectionKind::Text;
        let ranges = ranges(&file);
        let mut found = Self::default();
        for section in file.sections().filter(is_code) {
            let bytes = section.data().map_err(|error| error.to_string())?;
            let begin = section.address();
            for (at, range) in &ranges {
                let within = at.checked_sub(begin).and_then(|from| {
                    let from = usize::try_from(from).ok()?;
                    bytes.get(from..from.checked_add(range.length)?)
                });
                if let Some(code) = within {
                    let function = read(*at, code, range, &ranges)?;
                    found.by_address.insert(*at, function);
                }
            }
        }
        if found.by_address.is_empty() {
            return Err("no code".into());
        }
        Ok(found)
    }

    fn named<'a>(&'a self, parts: &'a [&str]) -> impl Iterator<Item = u64> + 'a {
        let fits = move |(at, function): (&u64, &Function)| function.holds(parts).then_some(*at);
        self.by_address.iter().filter_map(fits)
    }

    /// Whether a function calls one of these itself.
    fn calls(&self, at: u64, parts: &[&str]) -> bool {
        let called = self.by_address[&at].calls.iter();
        called
            .into_iter()
            .any(|to| self.by_address[to].holds(parts))
    }

    /// The deepest chain that begins with a function of one of these names. What holds one of
    /// `ends` in its name is left out with all that it calls, as panics are.
    ///
    /// # Errors
    /// Where there is none of that name, calls go in a circle, or a register is called without a
    /// rule.
    pub fn deepest(&self, roots: &[&str], rules: &[Rule], ends: &[&str]) -> Result<Chain, String> {
        let mut walk = Walk {
            functions: self,
            rules,
            ends,
            known: BTreeMap::new(),
        };
        let is_root = |f: &Function| f.names.iter().any(|name| roots.contains(&name.as_str()));
        let begin = self.by_address.iter().filter(|(_, f)| is_root(f));
        let chains: Vec<Chain> = begin
            .map(|(at, _)| walk.from(*at))
            .collect::<Result<_, _>>()?;
        chains
            .into_iter()
            .max_by_key(|chain| chain.bytes)
            .ok_or_else(|| format!("no function {roots:?}"))
    }
}

/// A search from calls to calls, which remembers what it has found.
struct Walk<'a> {
    functions: &'a Functions,
    rules: &'a [Rule],
    ends: &'a [&'a str],
    /// `None` while it is being looked at.
    known: BTreeMap<u64, Option<Chain>>,
}

impl Walk<'_> {
    fn from(&mut self, at: u64) -> Result<Chain, String> {
        let function = &self.functions.by_address[&at];
        match self.known.get(&at) {
            Some(Some(chain)) => return Ok(chain.clone()),
            Some(None) => return Err(format!("calls in a circle: {}", function.name())),
            None => {}
        }
        if function.is_end(&ENDS) || function.is_end(self.ends) {
            return Ok(Chain::default());
        }
        if function.sets_stack {
            return Err(format!("{} sets its stack pointer", function.name()));
        }
        self.known.insert(at, None);
        let mut deepest = Chain::default();
        for call in self.calls(function)? {
            let chain = self.from(call)?;
            if chain.bytes > deepest.bytes || deepest.frames.is_empty() {
                deepest = chain;
            }
        }
        deepest.bytes += function.bytes;
        deepest
            .frames
            .insert(0, (function.name().to_owned(), function.bytes));
        self.known.insert(at, Some(deepest.clone()));
        Ok(deepest)
    }

    fn calls(&self, function: &Function) -> Result<Vec<u64>, String> {
        let mut calls = function.calls.clone();
        if function.calls_a_register {
            let fits = |rule: &&Rule| function.holds(rule.of);
            let Some(rule) = self.rules.iter().find(fits) else {
                return Err(format!("no rule for what {} calls", function.name()));
            };
            let is_meant = |at: &u64| !self.functions.calls(*at, rule.but_for_callers_of);
            let meant: Vec<u64> = self.functions.named(rule.calls).filter(is_meant).collect();
            if meant.is_empty() {
                return Err(format!("no function for {rule:?}"));
            }
            calls.extend(meant);
        }
        Ok(calls)
    }
}

/// Code of a function.
struct Range {
    names: Vec<String>,
    length: usize,
    /// Where data begins within it, and where code goes on.
    marks: Vec<(u64, bool)>,
}

impl Range {
    fn is_code(&self, address: u64) -> bool {
        let before = self.marks.iter().rfind(|(mark, _)| *mark <= address);
        before.is_none_or(|(_, is_code)| *is_code)
    }
}

/// The functions by their symbols, with the mapping symbols of the ABI ($t code, $d data: ELF for
/// the Arm Architecture, 5.5.5).
fn ranges(file: &object::File<'_>) -> BTreeMap<u64, Range> {
    let mut marks: Vec<(u64, bool)> = Vec::new();
    let mut found: BTreeMap<u64, Range> = BTreeMap::new();
    for symbol in file.symbols() {
        let (name, at) = (symbol.name().unwrap_or_default(), even(symbol.address()));
        if name.starts_with("$t") || name.starts_with("$d") {
            marks.push((at, name.starts_with("$t")));
        } else if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
            let name = format!("{:#}", rustc_demangle::demangle(name));
            let length = usize::try_from(symbol.size()).unwrap_or_default();
            let range = found.entry(at).or_insert_with(|| Range {
                names: Vec::new(),
                length,
                marks: Vec::new(),
            });
            range.names.push(name);
        }
    }
    marks.sort_unstable();
    for (at, range) in &mut found {
        let end = at.saturating_add(range.length as u64);
        let within = |(mark, _): &&(u64, bool)| (*at..end).contains(mark);
        range.marks = marks.iter().filter(within).copied().collect();
    }
    found
}

fn read(
    at: u64,
    code: &[u8],
    range: &Range,
    functions: &BTreeMap<u64, Range>,
) -> Result<Function, String> {
    let mut function = Function {
        names: range.names.clone(),
        ..Function::default()
    };
    let half = |place: usize| {
        let bytes = code.get(place..place + 2);
        bytes.map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]))
    };
    let own = at..at.saturating_add(code.len() as u64);
    let mut place = 0;
    while place < code.len() {
        let address = at + place as u64;
        if !range.is_code(address) {
            place += 2;
            continue;
        }
        let (first, second) = (half(place), half(place + 2));
        match thumb::decode(address, first, second) {
            Does::Takes(bytes) => function.bytes += bytes,
            Does::Goes(to) if own.contains(&to) => {}
            Does::Calls(to) | Does::Goes(to) if functions.contains_key(&to) => {
                function.calls.push(to);
            }
            Does::Calls(to) | Does::Goes(to) => {
                let name = function.name();
                return Err(format!("{name} goes to {to:#x}, where no function begins"));
            }
            Does::GoesAnywhere => function.calls_a_register = true,
            Does::SetsStack => function.sets_stack = true,
            Does::Else => {}
        }
        place += if thumb::length(first) == 4 { 4 } else { 2 };
    }
    function.calls.sort_unstable();
    function.calls.dedup();
    Ok(function)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Functions by their frames, what they call, and whether they call a register.
    fn functions(of: &[(&str, u32, &[u64], bool)]) -> Functions {
        let function = |(place, (name, bytes, calls, calls_a_register)): (
            usize,
            &(&str, u32, &[u64], bool),
        )| {
            let function = Function {
                names: vec![(*name).to_owned()],
                bytes: *bytes,
                calls: calls.to_vec(),
                calls_a_register: *calls_a_register,
                sets_stack: false,
            };
            (place as u64, function)
        };
        Functions {
            by_address: of.iter().enumerate().map(function).collect(),
        }
    }

    const RULE: [Rule; 1] = [Rule {
        of: &["executor"],
        calls: &["task"],
        but_for_callers_of: &["secret"],
    }];

    #[test]
    fn the_deepest_chain_is_summed_and_a_panic_is_not() {
        let of = functions(&[
            ("main", 8, &[1, 2, 3], false),
            ("low", 40, &[], false),
            ("high", 16, &[4], false),
            ("core::panicking::panic", 900, &[], false),
            ("deep", 32, &[], false),
        ]);
        let chain = of.deepest(&["main"], &[], &[]).unwrap();
        assert_eq!(chain.bytes, 56);
        let names: Vec<&str> = chain.frames.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["main", "high", "deep"]);
        assert_eq!(of.deepest(&["main"], &[], &["high"]).unwrap().bytes, 48);
        assert!(of.deepest(&["other"], &[], &[]).is_err());
    }

    #[test]
    fn a_pointer_is_what_its_rule_says_and_without_one_an_error() {
        let of = functions(&[
            ("executor", 8, &[], true),
            ("task one", 40, &[], false),
            ("task two", 80, &[3], false),
            ("secret", 0, &[], false),
        ]);
        assert_eq!(of.deepest(&["executor"], &RULE, &[]).unwrap().bytes, 48);
        assert!(
            of.deepest(&["executor"], &[], &[])
                .unwrap_err()
                .contains("no rule")
        );
        let none = functions(&[("executor", 8, &[], true)]);
        let error = none.deepest(&["executor"], &RULE, &[]).unwrap_err();
        assert!(error.contains("no function for"), "{error}");
    }

    #[test]
    fn a_circle_and_a_function_that_calls_itself_have_no_bound() {
        let of = functions(&[("main", 8, &[1], false), ("again", 8, &[1], false)]);
        assert!(
            of.deepest(&["main"], &[], &[])
                .unwrap_err()
                .contains("circle")
        );
        let of = functions(&[("main", 8, &[1], false), ("back", 8, &[0], false)]);
        assert!(
            of.deepest(&["main"], &[], &[])
                .unwrap_err()
                .contains("circle")
        );
    }
}
