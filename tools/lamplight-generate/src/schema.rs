//! Scene files for editors and readers: the JSON Schema, which `lamplight schema` prints, as a file, and the
//! table of materials in `docs/scene-file.md`.

use crate::generated::{self, Mode};
use anyhow::{Context, Result};
use lamplight::scene::Material;
use lamplight::{Matter, Rgb, Scene};
use serde_json::Value;
use std::fmt::Write;

pub fn run(mode: Mode) -> Result<()> {
    let schema = Scene::schema();
    let text = serde_json::to_string_pretty(&schema)? + "\n";
    generated::bytes(mode, "docs/scene.schema.json", text.as_bytes(), "schema")?;
    generated::block(mode, "docs/scene-file.md", "materials", &materials(&schema)?, "schema")
}

/// All materials with the values that differ from those of a shape without one.
fn materials(schema: &Value) -> Result<String> {
    let mut table = String::from("| material | what it is | values |\n| --- | --- | --- |\n");
    for &material in Material::ALL {
        let name = material.name();
        let all = schema["$defs"]["Material"]["oneOf"].as_array();
        let description = all
            .into_iter()
            .flatten()
            .find(|one| one["const"] == name)
            .and_then(|one| one["description"].as_str())
            .with_context(|| format!("the schema describes {name}"))?;
        let description = description.split_whitespace().collect::<Vec<_>>().join(" ");
        writeln!(table, "| `{name}` | {description} | {} |", values(material))?;
    }
    Ok(table)
}

fn values(material: Material) -> String {
    let Matter { emission, glow, opacity, tint, albedo } = material.matter();
    let color = |name: &str, value: Rgb, default: Rgb| {
        (value != default).then(|| format!("{name} {value:?}"))
    };
    let values = [
        color("emission", emission, [0.0; 3]),
        color("glow", glow, [0.0; 3]),
        (opacity != 1.0).then(|| format!("opacity {opacity}")),
        color("tint", tint, [1.0; 3]),
        color("albedo", albedo, [0.0; 3]),
        material.color().map(|color| format!("color {color:?}")),
    ];
    values.into_iter().flatten().collect::<Vec<_>>().join("; ")
}
