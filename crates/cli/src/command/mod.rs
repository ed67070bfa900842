//! One file a command.

pub(crate) mod bench;
mod debug_pixel;
pub(crate) mod diff;
pub(crate) mod gallery;
pub(crate) mod info;
pub(crate) mod list;
pub(crate) mod merge;
pub(crate) mod render;

use serde::Serialize;

use crate::exit::{Exit, Failure};

/// A value as one line of JSON.
fn json_line(value: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string(value)
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot write JSON: {error}")))?;
    Ok(text + "\n")
}
