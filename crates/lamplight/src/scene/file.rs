//! Scene files: reading, writing, and errors with positions.

use super::Scene;
use crate::explain::explain;
use crate::keyed::Keyed;
use crate::{Error, Result, json};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Longest scene file, bytes.
const MAX_BYTES: u64 = 16 << 20;

impl Scene {
    /// Reads a scene file, TOML or JSON by its ending, else by its first character.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        Self::load_checked(path.as_ref(), Self::check)
    }

    /// Reads a scene file that may be larger than a grid, for [`SceneWorld`](super::SceneWorld).
    pub fn load_world(path: impl AsRef<Path>) -> Result<Self> {
        Self::load_checked(path.as_ref(), Self::check_world)
    }

    fn load_checked(path: &Path, check: fn(&Self) -> Result<()>) -> Result<Self> {
        let text = read(path)?;
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        let json = match ending.to_ascii_lowercase().as_str() {
            "json" => true,
            "toml" => false,
            _ => text.trim_start().starts_with('{'),
        };
        let parse = if json { Self::json_checked } else { Self::toml_checked };
        let scene = parse(&text, check);
        let mut scene = scene.map_err(|e| e.in_file(path))?;
        scene.file = path.to_owned();
        Ok(scene)
    }

    /// Reads a scene in TOML. Relative paths in it start at the current folder.
    pub fn from_toml(text: &str) -> Result<Self> {
        Self::toml_checked(text, Self::check)
    }

    fn toml_checked(text: &str, check: fn(&Self) -> Result<()>) -> Result<Self> {
        let syntax = |e: toml::de::Error| {
            let (line, column) = place(text, e.span().map_or(0, |span| span.start));
            Error::Syntax { line, column, problem: e.message().to_owned() }
        };
        let document = DeTable::parse(text).map_err(syntax)?;
        if let Some(light) = document.get_ref().get("light") {
            finite("light", light, text)?;
        }
        let document = toml::Deserializer::from(document);
        let scene: Self = serde_path_to_error::deserialize(Keyed(document)).map_err(|e| {
            let key = e.path().to_string();
            let error = e.into_inner();
            let (line, _) = place(text, error.span().map_or(0, |span| span.start));
            Error::AtLine { line, source: Box::new(explain(&key, error.message())) }
        })?;
        check(&scene).map_err(|e| at_its_line(e, text))?;
        Ok(scene)
    }

    /// Reads a scene in JSON. Relative paths in it start at the current folder.
    pub fn from_json(text: &str) -> Result<Self> {
        Self::json_checked(text, Self::check)
    }

    fn json_checked(text: &str, check: fn(&Self) -> Result<()>) -> Result<Self> {
        let scene: Self = json::read(text, "scene")?;
        check(&scene)?;
        Ok(scene)
    }

    /// Writes the scene as TOML.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string(self).map_err(|e| Error::value("scene", e, "possible to write"))
    }

    /// Writes the scene as JSON.
    pub fn to_json(&self) -> Result<String> {
        serde_json::to_string_pretty(self)
            .map_err(|e| Error::value("scene", e, "possible to write"))
    }

    /// An error with the file that this scene came from, if it came from one, and the line of its key.
    pub(super) fn in_its_file(&self, error: Error) -> Error {
        if self.file.as_os_str().is_empty() {
            return error;
        }
        // The text is not kept, because errors after parsing are rare. A pipe cannot be read twice.
        let text = if self.file.is_file() { read(&self.file).ok() } else { None };
        match text {
            Some(text) => at_its_line(error, &text).in_file(&self.file),
            None => error.in_file(&self.file),
        }
    }
}

fn read(path: &Path) -> Result<String> {
    let unread = |source| Error::Read { path: path.to_owned(), source };
    let wrong = |problem: String| Error::Format { path: path.to_owned(), problem };
    let file = File::open(path).map_err(unread)?;
    if file.metadata().map_err(unread)?.is_dir() {
        return Err(wrong("it is a folder; a scene file (TOML or JSON) is needed".into()));
    }
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unread)?;
    if bytes.len() as u64 > MAX_BYTES {
        let most = MAX_BYTES >> 20;
        return Err(wrong(format!("it is longer than {most} MiB, the most a scene file may be")));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        wrong(format!("it is not text in UTF-8 (byte {at}); a scene is TOML or JSON"))
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(text) => text.to_owned(),
        None => text,
    })
}

/// The line and column of a byte of a text, both from 1.
fn place(text: &str, byte: usize) -> (usize, usize) {
    let before = &text.as_bytes()[..byte.min(text.len())];
    let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
    let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
    (line, String::from_utf8_lossy(&before[start..]).chars().count() + 1)
}

/// Refuses `nan` and `inf` in settings, which are kept as JSON, where no such numbers exist.
fn finite(key: &str, value: &Spanned<DeValue>, text: &str) -> Result<()> {
    match value.get_ref() {
        DeValue::Table(table) => table.iter().try_for_each(|(name, value)| {
            finite(&format!("{key}.{}", name.get_ref()), value, text)
        }),
        DeValue::Float(number) if !number.as_str().parse().is_ok_and(f64::is_finite) => {
            let error = Error::value(key, number.as_str(), "a finite number");
            let line = place(text, value.span().start).0;
            Err(Error::AtLine { line, source: Box::new(error) })
        }
        _ => Ok(()),
    }
}

/// Adds the line of its key in a TOML text to an error.
fn at_its_line(error: Error, text: &str) -> Error {
    let line = match &error {
        Error::Value { key, .. } | Error::Key { key, .. } | Error::Under { key, .. } => {
            line_of(text, key)
        }
        Error::Size { .. } => line_of(text, "size"),
        _ => None,
    };
    match line {
        Some(line) => Error::AtLine { line, source: Box::new(error) },
        None => error,
    }
}

/// The line of a key such as `shape[2].circle.radius`, or of the deepest part of it that exists.
fn line_of(text: &str, key: &str) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let mut value = &DeValue::Table(table.into_inner());
    let mut span = None;
    for name in key.split(['.', '[', ']']).filter(|name| !name.is_empty()) {
        let next = match value {
            DeValue::Array(array) => name.parse().ok().and_then(|i: usize| array.get(i)),
            DeValue::Table(table) => table.get(name),
            _ => None,
        };
        let Some(next) = next else { break };
        span = Some(next.span().start);
        value = next.get_ref();
    }
    span.map(|byte| place(text, byte).0)
}
