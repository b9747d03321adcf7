//! Who uses whom between the crates of the workspace, and between its top-level folders.
//!
//! What a crate uses is what its manifest lists. `[dev-dependencies]` are for tests and stay apart,
//! as `cfg(test)` does between files.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use toml::Table;

use super::graph::Graph;

/// A crate of the workspace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Its name.
    pub name: String,
    /// Its folder below the workspace's.
    pub folder: String,
    /// What it is built from.
    pub dependencies: Vec<String>,
}

/// The crates that a workspace lists.
///
/// # Errors
/// Where a manifest cannot be read.
pub fn members(workspace: &Path) -> io::Result<Vec<Member>> {
    let root = manifest(&workspace.join("Cargo.toml"))?;
    let list = root["workspace"]["members"].as_array();
    let folders = list.into_iter().flatten().filter_map(|name| name.as_str());
    folders
        .map(|folder| {
            let path = workspace.join(folder);
            let manifest = manifest(&path.join("Cargo.toml"))?;
            member(folder, &manifest).ok_or_else(|| nameless(&path))
        })
        .collect()
}

/// The name that the manifest in a folder gives its crate.
///
/// # Errors
/// Where it cannot be read or gives none.
pub fn package_name(folder: &Path) -> io::Result<String> {
    let member = member("", &manifest(&folder.join("Cargo.toml"))?);
    member.map_or_else(|| Err(nameless(folder)), |member| Ok(member.name))
}

fn nameless(folder: &Path) -> io::Error {
    io::Error::other(format!("{}: no name", folder.display()))
}

fn manifest(path: &Path) -> io::Result<Table> {
    std::fs::read_to_string(path)?
        .parse()
        .map_err(io::Error::other)
}

fn member(folder: &str, manifest: &Table) -> Option<Member> {
    let tables = ["dependencies", "build-dependencies"];
    let listed = tables
        .iter()
        .filter_map(|name| manifest.get(*name)?.as_table());
    Some(Member {
        name: manifest.get("package")?.get("name")?.as_str()?.to_owned(),
        folder: folder.to_owned(),
        dependencies: listed.flat_map(|table| table.keys().cloned()).collect(),
    })
}

/// Uses between crates.
#[must_use]
pub fn between_crates(members: &[Member]) -> Graph {
    between(members, |member| &member.name)
}

/// Uses between the folders at the top of the workspace: `firmware` is one.
#[must_use]
pub fn between_folders(members: &[Member]) -> Graph {
    between(members, |member| {
        member.folder.split('/').next().unwrap_or_default()
    })
}

fn between(members: &[Member], group: impl Fn(&Member) -> &str) -> Graph {
    let groups: BTreeSet<&str> = members.iter().map(&group).collect();
    let groups: Vec<&str> = groups.into_iter().collect();
    let place = |member: &Member| groups.binary_search(&group(member)).unwrap_or_default();
    let mut graph = Graph::new(groups.iter().map(|name| (*name).to_owned()));
    for (from, to) in uses(members) {
        let because = format!("{} uses {}", from.name, to.name);
        graph.connect(place(from), place(to), because);
    }
    graph
}

fn uses(members: &[Member]) -> impl Iterator<Item = (&Member, &Member)> {
    members.iter().flat_map(move |from| {
        let used = members
            .iter()
            .filter(|to| from.dependencies.contains(&to.name));
        used.map(move |to| (from, to))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crate_in(folder: &str, name: &str, dependencies: &[&str]) -> Member {
        Member {
            name: name.into(),
            folder: folder.into(),
            dependencies: dependencies.iter().map(|name| (*name).into()).collect(),
        }
    }

    #[test]
    fn folders_can_make_a_circle_where_their_crates_make_none() {
        let members = [
            crate_in("firmware/board", "board", &["bus"]),
            crate_in("bus", "bus", &["core"]),
            crate_in("firmware/core", "core", &["fixed"]),
        ];
        assert_eq!(between_crates(&members).circles(), []);
        let circles = between_folders(&members).circles();
        assert_eq!(
            circles[0].to_string(),
            "bus -> firmware (bus uses core)\nfirmware -> bus (board uses bus)\n"
        );
    }

    #[test]
    fn a_dependency_of_tests_is_no_use() {
        let manifest =
            "[package]\nname = \"a\"\n[dependencies]\nb = \"1\"\n[dev-dependencies]\nc = \"1\"";
        let member = member("a", &manifest.parse().unwrap()).unwrap();
        assert_eq!(member, crate_in("a", "a", &["b"]));
    }
}
