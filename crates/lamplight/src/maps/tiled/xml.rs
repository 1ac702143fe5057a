//! Elements and attributes of XML, with the line in errors.

use crate::Rgb;
use crate::maps::map_file::read_text;
use crate::maps::properties::Properties;
use crate::{Error, Result, notation};
use roxmltree::{Document, Node, ParsingOptions};
use serde_json::{Map, Value};
use std::path::Path;
use std::str::FromStr;

/// Reads a file whose outermost element is `root`, and makes something of it. Errors name the file.
pub(super) fn with_root<T>(
    path: &Path,
    root: &str,
    make: impl FnOnce(Node) -> Result<T>,
) -> Result<T> {
    let text = read_text(path)?;
    // Files of old versions name a document type, which is not read.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options).map_err(|e| Error::Format {
        path: path.to_owned(),
        problem: format!("it is not XML that can be read: {e}"),
    })?;
    let found = document.root_element();
    if !found.has_tag_name(root) {
        let problem =
            format!("its outermost element is <{}>, but must be <{root}>", found.tag_name().name());
        return Err(Error::Format { path: path.to_owned(), problem });
    }
    make(found).map_err(|e| e.in_file(path))
}

/// Adds the line of an element to an error.
pub(super) fn at_line(node: Node, error: Error) -> Error {
    if matches!(error, Error::AtLine { .. } | Error::InFile { .. }) {
        return error;
    }
    let line = node.document().text_pos_at(node.range().start).row as usize;
    Error::AtLine { line, source: Box::new(error) }
}

/// Reads an attribute.
pub(super) fn attribute<T: FromStr>(node: Node, name: &str) -> Result<Option<T>> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    match text.trim().parse() {
        Ok(value) => Ok(Some(value)),
        Err(_) => {
            let key = format!("{}.{name}", node.tag_name().name());
            let shown: String = text.chars().take(40).collect();
            Err(at_line(node, Error::value(key, format!("\"{shown}\""), expected::<T>())))
        }
    }
}

/// Reads an attribute that has to be there.
pub(super) fn required<T: FromStr>(node: Node, name: &str) -> Result<T> {
    attribute(node, name)?.ok_or_else(|| {
        let key = format!("{}.{name}", node.tag_name().name());
        at_line(node, Error::Key { key, problem: "is missing".into() })
    })
}

/// A description of the values of a type.
fn expected<T>() -> &'static str {
    match std::any::type_name::<T>() {
        "u32" | "u64" | "usize" => "a whole number of 0 or more",
        "i32" | "i64" => "a whole number",
        "f32" | "f64" => "a number",
        _ => "something else",
    }
}

/// Reads a finite number.
pub(super) fn number(node: Node, name: &str) -> Result<Option<f32>> {
    let found: Option<f32> = attribute(node, name)?;
    match found {
        Some(value) if !value.is_finite() => {
            let key = format!("{}.{name}", node.tag_name().name());
            Err(at_line(node, Error::value(key, value, "a finite number")))
        }
        found => Ok(found),
    }
}

/// Reads a length, px, and rounds it.
pub(super) fn pixels(node: Node, name: &str) -> Result<i32> {
    Ok(number(node, name)?.unwrap_or(0.0).round() as i32)
}

/// Reads a colour, which may have its alpha in front.
pub(super) fn color(node: Node, name: &str) -> Result<Option<Rgb>> {
    let Some(text) = node.attribute(name).filter(|text| !text.is_empty()) else { return Ok(None) };
    let digits = text.trim_start_matches('#');
    let opaque = if digits.len() == 8 && digits.is_ascii() { &digits[2..] } else { digits };
    let found = notation::hex(&format!("#{opaque}"));
    found.map(Some).ok_or_else(|| {
        let key = format!("{}.{name}", node.tag_name().name());
        at_line(node, Error::value(key, format!("\"{text}\""), "a colour such as \"#ff8800\""))
    })
}

/// Returns the children of a name.
pub(super) fn children<'a, 'i: 'a>(
    node: Node<'a, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.has_tag_name(name))
}

/// Returns the first child of a name.
pub(super) fn child<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    children(node, name).next()
}

/// Returns the class of an object or a tile.
pub(super) fn class(node: Node) -> Option<String> {
    // Tiled 1.9 called it `class`.
    let class = node.attribute("type").or(node.attribute("class"));
    class.filter(|class| !class.is_empty()).map(str::to_owned)
}

/// Reads the custom properties of an element that are meant for lamplight.
pub(super) fn properties(node: Node) -> Properties {
    let mut properties = Properties::default();
    for (name, value) in values(node, 0) {
        properties.set(&name, value);
    }
    properties.for_lamplight()
}

/// The deepest nesting of classes.
const DEEPEST: u32 = 16;

/// Returns the custom properties of an element, or of a class that is a property.
fn values(node: Node, depth: u32) -> Map<String, Value> {
    let mut found = Map::new();
    for property in children(node, "properties").flat_map(|all| children(all, "property")) {
        let Some(name) = property.attribute("name") else { continue };
        // A text of several lines is not in the attribute.
        let text = property.attribute("value").or(property.text()).unwrap_or_default();
        let value = match property.attribute("type") {
            Some("class") if depth < DEEPEST => values(property, depth + 1).into(),
            Some("bool") => Value::Bool(text == "true"),
            Some("int" | "float") => serde_json::from_str(text).unwrap_or_else(|_| text.into()),
            _ => text.into(),
        };
        found.insert(name.to_owned(), value);
    }
    found
}
