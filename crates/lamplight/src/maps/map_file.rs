//! The text of a map's file.

use crate::{Error, Result};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Longest file of a map, bytes.
const MAX_BYTES: u64 = 512 << 20;

/// Reads a file as text.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let unread = |source| Error::Read { path: path.to_owned(), source };
    let wrong = |problem: String| Error::Format { path: path.to_owned(), problem };
    let file = File::open(path).map_err(unread)?;
    if file.metadata().map_err(unread)?.is_dir() {
        return Err(wrong("it is a folder; a map (.tmx, .world or .ldtk) is needed".into()));
    }
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unread)?;
    if bytes.len() as u64 > MAX_BYTES {
        let most = MAX_BYTES >> 20;
        return Err(wrong(format!("it is longer than {most} MiB, the most a map may be")));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        wrong(format!("it is not text in UTF-8 (byte {})", e.utf8_error().valid_up_to()))
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Returns the path of a file that another one names.
pub(super) fn beside(file: &Path, name: &str) -> PathBuf {
    // Editors write `/` on every platform.
    file.parent().unwrap_or(Path::new("")).join(name)
}
