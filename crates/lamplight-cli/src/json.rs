//! Values as JSON, for `--json`.

use crate::error::{CliError, Result};
use serde_json::Value;

/// A value as JSON.
pub fn to_json(value: &impl serde::Serialize) -> Result<Value> {
    serde_json::to_value(value).map_err(CliError::failed)
}
