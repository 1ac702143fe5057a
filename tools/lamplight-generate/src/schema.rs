//! The JSON Schema of scene files, for editors: what `lamplight schema` prints, as a file.

use crate::generated::{self, Mode};
use anyhow::Result;
use lamplight::Scene;

pub fn run(mode: Mode) -> Result<()> {
    let text = serde_json::to_string_pretty(&Scene::schema())? + "\n";
    generated::bytes(mode, "docs/scene.schema.json", text.as_bytes(), "schema")
}
