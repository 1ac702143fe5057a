//! The weight of a web page, compressed as servers send it.

use anyhow::{Result, ensure};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Prints the bytes of every file of a page; an error if they are more than `limit`.
pub fn run(page: &Path, limit: usize) -> Result<()> {
    let mut total = 0;
    for (name, bytes) in files(page)? {
        let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
        gzip.write_all(&bytes)?;
        let compressed = gzip.finish()?.len();
        total += compressed;
        let kilobytes = |bytes: usize| bytes as f64 / 1e3;
        println!(
            "{:>8.1} kB, compressed {:>8.1} kB: {name}",
            kilobytes(bytes.len()),
            kilobytes(compressed)
        );
    }
    let megabytes = |bytes: usize| bytes as f64 / 1e6;
    println!(
        "{:.2} MB compressed, of {:.2} at most: {}",
        megabytes(total),
        megabytes(limit),
        page.display()
    );
    ensure!(total <= limit, "the page is heavier than {:.2} MB", megabytes(limit));
    Ok(())
}

/// All files under a folder, by their paths from there.
fn files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(here) = folders.pop() {
        for entry in fs::read_dir(here)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder)?.display().to_string();
                found.push((name, fs::read(&path)?));
            }
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_heavier_than_its_limit_is_refused() {
        let folder = std::env::temp_dir().join(format!("lamplight-page-{}", std::process::id()));
        fs::create_dir_all(folder.join("inside")).unwrap();
        fs::write(folder.join("inside/page.html"), "light ".repeat(1000)).unwrap();
        // What is repeated is nearly nothing when compressed, but not nothing.
        assert!(run(&folder, 1000).is_ok());
        assert!(run(&folder, 10).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
