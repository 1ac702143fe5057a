//! Services of a desktop. Files are in the current folder.

use super::{CELLS, Dropped, File, Handover};
use crate::message::message;
use anyhow::{Context as _, Result, bail};
use eframe::egui::DroppedFileHandle;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Default columns and rows if light is computed on the CPU.
pub const CELLS_ON_CPU: [u32; 2] = CELLS;

/// True if a scene finds its images beside it.
pub const HAS_FOLDERS: bool = true;

/// The flag of a window that continues another one.
const CONTINUED: &str = "--continued";
/// If a continued window loses its GPU within this time, the GPU is gone for good.
const SOON: Duration = Duration::from_secs(10);

/// The time at which this window was opened, if it continues another one.
static BEGUN: OnceLock<Option<Instant>> = OnceLock::new();

/// Remembers whether this window continues another one. Only the first call counts.
pub fn set_is_continued(is_continued: bool) {
    let _ = BEGUN.set(is_continued.then(Instant::now));
}

/// Hands a dropped file to the window, which reads it.
pub fn read_dropped(file: DroppedFileHandle, is_layer: bool, to: Sender<Result<Dropped>>) {
    // The window that receives it may be closed.
    let _ = to.send(Ok(Dropped { path: file.path().to_owned(), bytes: None, is_layer }));
}

/// Writes files and returns a message with their location.
pub fn save(files: &[File]) -> Result<String> {
    write_all(Path::new(""), files)?;
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let folder = std::env::current_dir()
        .map_or_else(|_| "this folder".to_owned(), |at| at.display().to_string());
    Ok(format!("saved {} in {folder}", names.join(", ")))
}

/// Writes files into a folder. Each is written beside its place first, so that the former files stay whole if one of
/// them cannot be written, as on a full disk.
fn write_all(folder: &Path, files: &[File]) -> Result<()> {
    let beside = |name: &str| folder.join(format!("{name}.part"));
    let done = (|| {
        for (name, bytes) in files {
            std::fs::write(beside(name), bytes).with_context(|| format!("cannot write {name}"))?;
        }
        for (name, _) in files {
            std::fs::rename(beside(name), folder.join(name))
                .with_context(|| format!("cannot write {name}"))?;
        }
        Ok(())
    })();
    if done.is_err() {
        // Those that were not written or are in their place are not there.
        files.iter().for_each(|(name, _)| drop(std::fs::remove_file(beside(name))));
    }
    done
}

/// Opens another window in another process, and ends this one, which cannot be drawn any more. If that
/// fails, saves the canvas here and prints the error.
pub fn hand_over(next: &Handover, closes: bool) -> Result<()> {
    let Err(why) = open_another(next, closes) else { std::process::exit(0) };
    eprintln!("error: the GPU was lost, and no other window can be opened: {}", message(&why));
    if !next.files.is_empty() {
        match save(&next.files) {
            Ok(said) => eprintln!("what was painted: {said}"),
            Err(why) => eprintln!("what was painted is lost: {}", message(&why)),
        }
    }
    std::process::exit(1)
}

/// Fails also if this window itself continues one whose GPU was lost a moment ago.
fn open_another(next: &Handover, closes: bool) -> Result<()> {
    if BEGUN.get().copied().flatten().is_some_and(|begun| begun.elapsed() < SOON) {
        bail!("it was lost repeatedly");
    }
    let folder = std::env::temp_dir().join(format!("lamplight-sandbox-{}", std::process::id()));
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make {}", folder.display()))?;
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        Ok::<_, anyhow::Error>(path)
    };
    let paths: Vec<PathBuf> =
        next.files.iter().map(|(name, bytes)| put(name, bytes)).collect::<Result<_>>()?;
    let opened = paths.first().map(|scene| format!("drop {}\n", scene.display()));
    let script = opened.unwrap_or_default() + &next.lines.join("\n");
    let script = put("script.txt", script.as_bytes())?;
    let mut window = Command::new(std::env::current_exe()?);
    window.args(&next.arguments).arg(CONTINUED);
    window.arg(if closes { "--script" } else { "--begin" }).arg(script);
    window.spawn()?;
    Ok(())
}

/// Prints a line for the person who runs the script.
pub fn say(word: &str) {
    println!("{word}");
}

/// The next script; on a desktop there is none.
pub fn next_script() -> Option<String> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_leaves_the_former_files() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| (name.to_owned(), text.as_bytes().to_vec());
        write_all(folder.path(), &[file("a.toml", "before"), file("a.png", "before")]).unwrap();
        // No file system takes a name as long as this.
        let long = "a".repeat(5000);
        let why = write_all(folder.path(), &[file("a.toml", "after"), file(&long, "after")]);
        assert!(why.unwrap_err().to_string().starts_with("cannot write a"));
        assert_eq!(std::fs::read_to_string(folder.path().join("a.toml")).unwrap(), "before");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "parts are left");
        write_all(folder.path(), &[file("a.toml", "after")]).unwrap();
        assert_eq!(std::fs::read_to_string(folder.path().join("a.toml")).unwrap(), "after");
    }
}
