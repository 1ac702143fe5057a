//! The script through which a page runs a program, and the program as the script expects it.

use anyhow::{Context, Result};
use std::path::Path;
use wasm_bindgen_cli_support::Bindgen;

/// Writes both into a folder, under one name. `program`: as compiled for `wasm32-unknown-unknown`, with the release of
/// wasm-bindgen that is locked for this package too.
pub fn write(program: &Path, name: &str, folder: &Path) -> Result<()> {
    let mut bindgen = Bindgen::new();
    bindgen.web(true)?.typescript(false).remove_name_section(true).remove_producers_section(true);
    // Else the page would have to say where the program is.
    bindgen.omit_default_module_path(false);
    bindgen.input_path(program).out_name(name);
    bindgen.generate(folder).with_context(|| program.display().to_string())
}
