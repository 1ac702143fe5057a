//! Errors from messages of serde: they name the key, the value and the correct form.

use crate::{Error, mask};

/// The longest piece of a user's text that a message repeats, in characters.
const LONGEST: usize = 80;
/// The similarity from which on an unknown key is taken for a misspelt one: of three letters, one is wrong, missing or
/// too many.
const ALIKE: f64 = 2.0 / 3.0;
/// The fewest bytes that are taken for the beginning of a key.
const SHORTEST_START: usize = 3;

/// A description of whole numbers.
const WHOLE: &str = "a whole number of 0 or more";

/// The error for a message of serde about the value under `path` (serde_path_to_error's) in a scene.
pub(crate) fn explain(path: &str, message: &str) -> Error {
    explain_in("scene", path, message)
}

/// The error for a message of serde about the value under `path` in the table `root`.
pub(crate) fn explain_in(root: &str, path: &str, message: &str) -> Error {
    let path = shortened(if path == "." { "" } else { path });
    let inside = |name: &str| match path.as_str() {
        "" => shortened(name),
        path if path == name || path.ends_with(&format!(".{name}")) => path.to_owned(),
        path => format!("{path}.{}", shortened(name)),
    };
    if let Some(name) = message.strip_prefix("missing field ").map(unquoted) {
        return Error::Key { key: inside(name), problem: "is missing".into() };
    }
    if let Some(name) = message.strip_prefix("duplicate field ").map(unquoted) {
        return Error::Key { key: inside(name), problem: "is there twice".into() };
    }
    if let Some((name, known)) = message
        .strip_prefix("unknown field ")
        .and_then(|rest| rest.split_once(", expected ").or(Some((rest, ""))))
    {
        let name = unquoted(name);
        return Error::Key { key: inside(name), problem: unknown(name, known) };
    }
    let value_error = ["invalid type: ", "invalid value: ", "invalid length ", "unknown variant "]
        .into_iter()
        .find_map(|kind| Some((kind, message.strip_prefix(kind)?)));
    let key = if path.is_empty() { root.to_owned() } else { path.clone() };
    match value_error.and_then(|(kind, rest)| Some((kind, rest.rsplit_once(", expected ")?))) {
        Some(("unknown variant ", (found, expected))) => {
            let name = unquoted(found);
            let hint = likely(name, expected).map(|known| format!("; did you mean \"{known}\"?"));
            let expected = plain(expected) + &hint.unwrap_or_default();
            Error::value(key, shortened(&format!("\"{name}\"")), expected)
        }
        Some((kind, (found, expected))) => {
            let found = match kind {
                "invalid length " => format!("a list of {found}"),
                // NaN and infinity arrive as null, too.
                _ if found == "null" && plain(expected).contains("number") => {
                    "null, NaN or infinite".into()
                }
                _ => plain_value(found),
            };
            let is_large = plain(expected) == WHOLE && found.parse::<u128>().is_ok();
            let expected = if is_large { "smaller".into() } else { plain(expected) };
            Error::value(key, shortened(&found), expected)
        }
        // The reader of TOML expects this of an enum.
        None if message == "wanted string or table" => {
            Error::Key { key, problem: "is not a text in quotes".into() }
        }
        None => Error::Key { key, problem: format!("is not understood: {}", shortened(message)) },
    }
}

fn unknown(name: &str, known: &str) -> String {
    let names: Vec<&str> = in_backticks(known).collect();
    let hint = match likely(name, known) {
        Some(known) => format!("; did you mean `{known}`?"),
        // Presets belong to methods.
        None if name == "preset" && names.contains(&"holographic") => {
            "; did you mean `holographic.preset`?".into()
        }
        None => String::new(),
    };
    format!("is not a known key{hint} (known here: {})", names.join(", "))
}

/// The name among those in backticks that a misspelt one is most like, or else the first that begins with it.
fn likely<'a>(name: &str, known: &'a str) -> Option<&'a str> {
    // The time of a comparison grows with the length, and such a one is like none.
    if name.len() > LONGEST {
        return None;
    }
    let misspelt = in_backticks(known)
        .map(|known| (strsim::normalized_damerau_levenshtein(name, known), known))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .map(|(_, known)| known);
    let begins = |known: &&str| name.len() >= SHORTEST_START && known.starts_with(name);
    misspelt.or_else(|| in_backticks(known).find(begins))
}

fn in_backticks(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The name of a Rust type for people who write files.
fn plain(expected: &str) -> String {
    let words = match expected {
        "f32" | "f64" => "a number",
        // The only bytes are masks.
        "u8" => mask::EXPECTED,
        "u32" | "u64" | "usize" => WHOLE,
        "i64" => "a whole number",
        "i32" => return format!("a whole number from {} to {}", i32::MIN, i32::MAX),
        "a boolean" => "true or false",
        "path string" | "a string" => "a text in quotes",
        "a sequence" => "a list",
        "a map" => "a table",
        other if other.starts_with("struct ") => "a table",
        other if other.starts_with("one of ") || other.starts_with('`') => {
            return other.replace('`', "");
        }
        other => match other.strip_prefix("an array of length ") {
            Some(length) => return format!("a list of {length} numbers"),
            None => other,
        },
    };
    words.to_owned()
}

/// A value without the name of its type.
fn plain_value(found: &str) -> String {
    match found {
        "map" => "a table".into(),
        "sequence" => "a list".into(),
        _ => ["integer ", "floating point ", "string ", "boolean "]
            .into_iter()
            .find_map(|kind| found.strip_prefix(kind))
            .unwrap_or(found)
            // The type of whole numbers that no other holds.
            .replace(" as i128", "")
            .replace('`', ""),
    }
}

fn unquoted(text: &str) -> &str {
    text.trim_matches('`')
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
