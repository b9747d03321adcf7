//! Writes every record: `cargo run -p makes --example makes -- DIR [SEED [NAME]]`, or
//! those whose name has NAME in it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        eprintln!("usage: makes DIR [SEED [NAME]]");
        std::process::exit(2);
    };
    let seed = arguments.next().and_then(|text| text.parse().ok());
    let part = arguments.next().unwrap_or_default();
    let mut recipes = makes::recipes(seed.unwrap_or(1));
    recipes.retain(|recipe| recipe.name.contains(&part));
    write(&folder, &recipes)
}

/// Records do not depend on each other: every processor takes the next one that is left.
fn write(folder: &Path, recipes: &[makes::Recipe]) -> std::io::Result<()> {
    let next = AtomicUsize::new(0);
    let work = || -> std::io::Result<()> {
        while let Some(recipe) = recipes.get(next.fetch_add(1, Ordering::Relaxed)) {
            recipe.entry().write(&folder.join(recipe.table))?;
            println!("{}/{}", recipe.table, recipe.name);
        }
        Ok(())
    };
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..processors).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().expect("a worker panicked"))
    })
}
