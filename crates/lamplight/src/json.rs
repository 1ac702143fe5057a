//! JSON, with errors that name line, key and value.

use crate::explain::explain_in;
use crate::keyed::Keyed;
use crate::{Error, Result};
use serde::de::DeserializeOwned;

/// Reads a text; errors call its outermost table `root`.
pub(crate) fn read<T: DeserializeOwned>(text: &str, root: &str) -> Result<T> {
    let mut document = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(Keyed(&mut document)).map_err(|e| {
        let key = e.path().to_string();
        let error = e.into_inner();
        if error.is_data() {
            let source = Box::new(explain_in(root, &key, &without_place(&error)));
            Error::AtLine { line: error.line(), source }
        } else {
            syntax(&error)
        }
    })?;
    document.end().map_err(|e| syntax(&e))?;
    Ok(value)
}

fn syntax(error: &serde_json::Error) -> Error {
    let (line, column) = (error.line(), error.column());
    Error::Syntax { line, column, problem: without_place(error) }
}

/// The message of an error of serde_json, without the position at its end.
fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    message.strip_suffix(&place).unwrap_or(&message).to_owned()
}
