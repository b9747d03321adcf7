//! Writes every record: `cargo run -p makes --example makes -- DIR [SEED]`.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use makes::entry::Entry;

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        eprintln!("usage: makes DIR [SEED]");
        std::process::exit(2);
    };
    let seed = arguments.next().and_then(|text| text.parse().ok());
    write(&folder, &makes::recipes(seed.unwrap_or(1)))
}

/// Records do not depend on each other: every processor takes the next one that is left.
fn write(folder: &Path, recipes: &[makes::Recipe]) -> std::io::Result<()> {
    let next = AtomicUsize::new(0);
    let work = || -> std::io::Result<()> {
        while let Some(recipe) = recipes.get(next.fetch_add(1, Ordering::Relaxed)) {
            let entry: Entry = (recipe.make)();
            entry.write(&folder.join(recipe.table))?;
            println!("{}/{}", recipe.table, entry.name);
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
