//! Files that commands leave behind: looked at before anything moves; those written at once are
//! whole or not there at all.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::os::unix::fs::FileTypeExt as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{Failure, Outcome};

/// Results in a folder with this file in it are ours: they may be overwritten.
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

/// Makes a folder for the results of a command, `names` of files below it; another run of the same
/// command may overwrite them.
///
/// # Errors
/// Where one of them is somebody else's, or nothing can be written there.
pub fn claim_folder(path: &Path, command: &str, names: &[String]) -> Outcome<()> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::new(format!(
            "{}: is a file; name a folder",
            path.display()
        )));
    }
    make_folder(path)?;
    let marker = path.join(MARKER);
    let is_ours = fs::read_to_string(&marker).is_ok_and(|text| text == marked_by(command));
    let has_content = |path: &PathBuf| fs::metadata(path).is_ok_and(|found| found.len() > 0);
    let strange = names.iter().map(|name| path.join(name)).find(has_content);
    if let Some(strange) = strange.filter(|_| !is_ours) {
        return Err(Failure::new(format!(
            "{}: is there and not a result of quadrant {command} (no {MARKER} beside it says so); name another folder",
            strange.display()
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
    fn a_file_of_others_is_not_overwritten_and_one_of_ours_is() {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("out");
        let names = ["summary.json", "gone.svg"].map(String::from);
        // What stands beside our files is nobody's business: a log of this very run, say.
        make_folder(&own).unwrap();
        fs::write(own.join("notes.txt"), "{}").unwrap();
        claim_folder(&own, "commission", &names).unwrap();
        fs::write(own.join("summary.json"), "{}").unwrap();
        assert_eq!(claim_folder(&own, "commission", &names), Ok(()));
        let refusal = claim_folder(&own, "identify", &names).unwrap_err();
        assert!(
            refusal.to_string().contains("summary.json: is there"),
            "{refusal}"
        );
        remove_stale(&own, &names).unwrap();
        assert!(!own.join("summary.json").exists() && own.join("notes.txt").exists());
        assert_eq!(claim_folder(&own, "identify", &names), Ok(()));
        let file = claim_folder(&own.join("notes.txt"), "identify", &names).unwrap_err();
        assert!(file.to_string().contains("is a file"), "{file}");
    }
}
