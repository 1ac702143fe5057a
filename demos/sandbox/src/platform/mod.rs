//! The services of a desktop or a web page. Both modules offer the same functions.

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub use native::*;
#[cfg(target_arch = "wasm32")]
pub use web::*;

use std::path::PathBuf;

/// Default columns and rows.
pub const CELLS: [u32; 2] = [320, 180];

/// The name and the content of a file.
pub type File = (String, Vec<u8>);

/// A file that was dropped on the window.
pub struct Dropped {
    /// Its path; on a web page only its name.
    pub path: PathBuf,
    /// Its content, on a web page. Elsewhere it is read from its path.
    pub bytes: Option<Vec<u8>>,
    /// True if it belongs to a scene that was dropped with it.
    pub is_layer: bool,
}

/// The state with which another window continues.
pub struct Handover {
    /// Its arguments.
    pub arguments: Vec<String>,
    /// A canvas as a scene, which comes first, and its images; for worlds, which restart, the one from before them.
    pub files: Vec<File>,
    /// Lines of a script that it runs first.
    pub lines: Vec<String>,
}
