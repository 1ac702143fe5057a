//! Sources of a scene's images.

use std::path::{Path, PathBuf};

/// The bytes of a named file, where there is one.
pub(crate) type Given<'a> = &'a dyn Fn(&Path) -> Option<&'a [u8]>;

/// A folder on disk, or files given as bytes.
#[derive(Clone, Copy)]
pub(crate) enum Source<'a> {
    /// Relative paths start here.
    Folder(&'a Path),
    /// Nothing is read from disk.
    Given(Given<'a>),
}

impl Source<'_> {
    /// The path by which an image is opened, and named in errors.
    pub fn place(&self, path: &Path) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.join(path),
            Self::Given(_) => path.to_owned(),
        }
    }

    /// Returns whether there is something at a path. Where that cannot be found out, opening it will say why.
    pub fn has(&self, path: &Path) -> bool {
        match self {
            Self::Folder(_) => path.try_exists().unwrap_or(true),
            Self::Given(files) => files(path).is_some(),
        }
    }
}
