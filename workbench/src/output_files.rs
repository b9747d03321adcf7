//! Files that commands leave behind: looked at before anything moves; those written at once are
//! whole or not there at all.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::os::unix::fs::FileTypeExt as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{Failure, Outcome};

/// A folder with this file in it is ours: its files may be overwritten.
const MARKER: &str = ".quadrant";

/// What stands in it.
fn marked_by(command: &str) -> String {
    format!("Results of quadrant {command}: another run into this folder overwrites them.\n")
}

/// Writes a file: into another one beside it, which then takes its name, so that a full disk leaves
/// the old one as it was.
///
/// # Errors
/// Where it cannot be written.
pub fn write(path: &Path, text: &str) -> Outcome<()> {
    let failed = |error: std::io::Error| Failure::file(path, &error);
    if !takes_a_new_name(path) {
        return fs::write(path, text).map_err(failed);
    }
    let part = beside(path);
    fs::write(&part, text)
        .and_then(|()| fs::rename(&part, path))
        .map_err(|error| {
            // What is half there is of no use to anybody.
            let _ = fs::remove_file(&part);
            failed(error)
        })
}

/// A pipe or a device has no place beside it, and a link would be replaced instead of what it leads
/// to.
fn takes_a_new_name(path: &Path) -> bool {
    fs::symlink_metadata(path).map_or(true, |found| found.is_file())
}

/// The name of a file while it is being written.
fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".quadrant-part");
    path.with_file_name(name)
}

/// Looks whether files can be written, before a machine moves for what they are to hold.
///
/// # Errors
/// The first one that cannot.
pub fn check<'a>(paths: impl IntoIterator<Item = Option<&'a PathBuf>>) -> Outcome<()> {
    paths
        .into_iter()
        .flatten()
        .try_for_each(|path| check_one(path))
}

fn check_one(path: &Path) -> Outcome<()> {
    let failed = |error: std::io::Error| Failure::file(path, &error);
    if path.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a folder; name a file",
            path.display()
        )));
    }
    // Whoever reads from a pipe would take this for the end.
    if fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo()) {
        return Ok(());
    }
    if !takes_a_new_name(path) {
        return fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .map(drop)
            .map_err(failed);
    }
    let part = beside(path);
    fs::write(&part, "")
        .and_then(|()| fs::remove_file(&part))
        .map_err(failed)
}

/// Makes a folder, and those above it.
///
/// # Errors
/// Where it cannot be made.
pub fn make_folder(path: &Path) -> Outcome<()> {
    fs::create_dir_all(path).map_err(|error| Failure::file(path, &error))
}

/// Makes a folder for the results of a command, or takes one that is empty or of an earlier run of
/// it.
///
/// # Errors
/// Where somebody else's files are in it, or nothing can be written there.
pub fn claim_folder(path: &Path, command: &str) -> Outcome<()> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a file; name a folder",
            path.display()
        )));
    }
    make_folder(path)?;
    let failed = |error: std::io::Error| Failure::file(path, &error);
    let is_empty = fs::read_dir(path).map_err(failed)?.next().is_none();
    let marker = path.join(MARKER);
    let is_ours = fs::read_to_string(&marker).is_ok_and(|text| text == marked_by(command));
    if !is_empty && !is_ours {
        return Err(Failure::new(format!(
            "{}: holds files that are not results of quadrant {command} (no {MARKER} that says so); name another folder or an empty one",
            path.display()
        )));
    }
    write(&marker, &marked_by(command))
}

/// Removes files of an earlier run, so that none lies beside new ones.
///
/// # Errors
/// Where one of them cannot be removed.
pub fn remove_stale(folder: &Path, names: &[String]) -> Outcome<()> {
    for path in names.iter().map(|name| folder.join(name)) {
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(Failure::file(&path, &error));
            }
            _ => {}
        }
    }
    Ok(())
}

/// The JSON text of a result.
///
/// # Errors
/// Never in practice: results are plain data.
pub fn json(result: &impl Serialize) -> Outcome<String> {
    serde_json::to_string_pretty(result)
        .map(|text| text + "\n")
        .map_err(|error| Failure::new(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_stays_as_it_was_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        write(&path, "old").unwrap();
        // A folder in the place of the file that is written first.
        fs::create_dir(beside(&path)).unwrap();
        let refusal = write(&path, "new").unwrap_err().to_string();
        assert!(refusal.contains("result.json"), "{refusal}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    }

    #[test]
    fn a_full_device_is_told_by_its_name() {
        let refusal = write(Path::new("/dev/full"), "text")
            .unwrap_err()
            .to_string();
        assert!(
            refusal.contains("/dev/full: No space left on device"),
            "{refusal}"
        );
    }

    #[test]
    fn what_cannot_be_written_is_refused_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let good = folder.path().join("a.json");
        let wrong = folder.path().join("missing").join("b.svg");
        assert_eq!(check([Some(&good), None]), Ok(()));
        assert!(!good.exists());
        let refusal = check([Some(&good), Some(&wrong)]).unwrap_err().to_string();
        assert!(refusal.contains("b.svg: No such file"), "{refusal}");
        assert!(check([Some(&folder.path().to_path_buf())]).is_err());
    }

    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link] = ["target", "link"].map(|name| folder.path().join(name));
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        check([Some(&link)]).unwrap();
        write(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    }

    #[test]
    fn a_folder_with_files_of_others_is_refused_and_one_of_ours_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("out");
        claim_folder(&own, "commission").unwrap();
        for name in ["summary.json", "notes.txt"] {
            fs::write(own.join(name), "{}").unwrap();
        }
        let stale = ["summary.json", "gone.svg"].map(String::from);
        assert_eq!(claim_folder(&own, "commission"), Ok(()));
        remove_stale(&own, &stale).unwrap();
        assert!(!own.join("summary.json").exists() && own.join("notes.txt").exists());
        let refusal = claim_folder(&own, "identify").unwrap_err().to_string();
        assert!(
            refusal.contains("not results of quadrant identify"),
            "{refusal}"
        );
        let file = claim_folder(&own.join("notes.txt"), "identify").unwrap_err();
        assert!(file.to_string().contains("is a file"), "{file}");
    }
}
