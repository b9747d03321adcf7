//! A commit beside the cycle: the node hands the staged set out to where there is time for it, and
//! takes settings back.
//!
//! ```text
//! SDO: commit ─▶ Commit ─▶ convert, for longer than a cycle may take ─▶ Commit ─▶ SDO: answer
//!                                                                        └─▶ the next cycle's set
//! ```
//!
//! Meanwhile cycles go on with the active set. Values may be read; the staged set stays as it was
//! handed out: a write to it, or another commit, is refused with abort code 0800 0022h.

use crate::parameters::{ParameterSet, SetError};
use crate::settings::Settings;

/// A staged set that is to become settings, and what became of it: 1.5 KB, so that it is handed on
/// by reference.
#[derive(Clone, Debug, Default)]
pub struct Commit {
    number: u32,
    set: ParameterSet,
    settings: Option<Result<Settings, SetError>>,
}

impl Commit {
    /// Makes settings of the set: some ten thousand instructions, which may be interrupted at any
    /// of them.
    // Apart: it is in an image once, whoever converts.
    #[inline(never)]
    pub fn convert(&mut self) {
        self.settings = Some(self.set.settings());
    }

    /// What became of the set, once it was converted.
    pub(crate) const fn settings(&self) -> Option<&Result<Settings, SetError>> {
        self.settings.as_ref()
    }
}

/// Commits that a node has asked for. A node that is reset counts on, so that it does not take
/// settings that were asked for before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Commits {
    number: u32,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    #[default]
    Idle,
    Wanted,
    HandedOut,
}

impl Commits {
    pub(crate) const fn ask(&mut self) {
        self.number = self.number.wrapping_add(1);
        self.stage = Stage::Wanted;
    }

    pub(crate) fn is_wanted(self) -> bool {
        self.stage == Stage::Wanted
    }

    /// Hands out what was asked for, once; tells whether there was something.
    pub(crate) fn hand_out(&mut self, staged: &ParameterSet, commit: &mut Commit) -> bool {
        let is_wanted = self.is_wanted();
        if is_wanted {
            self.stage = Stage::HandedOut;
            commit.number = self.number;
            commit.set.clone_from(staged);
            commit.settings = None;
        }
        is_wanted
    }

    /// Whether this is what was handed out last; nothing is asked for any more then.
    pub(crate) fn take_back(&mut self, commit: &Commit) -> bool {
        let is_awaited = self.stage == Stage::HandedOut && commit.number == self.number;
        if is_awaited {
            self.stage = Stage::Idle;
        }
        is_awaited
    }

    /// The same count, with nothing asked for.
    pub(crate) const fn forget(&mut self) {
        self.stage = Stage::Idle;
    }
}
