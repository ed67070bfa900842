//! Facts that travel with an image.

use std::collections::BTreeMap;

/// Facts about an image by name, in order of the names so that files come out the same each time.
pub type Metadata = BTreeMap<String, Attribute>;

/// The value of one fact.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Attribute {
    /// A text.
    Text(String),
    /// A whole number.
    Int(i32),
    /// A number.
    Float(f32),
    /// A 4x4 matrix by rows, such as `worldToCamera`.
    Matrix([f32; 16]),
}

impl From<&str> for Attribute {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Attribute {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f32> for Attribute {
    fn from(number: f32) -> Self {
        Self::Float(number)
    }
}

impl From<i32> for Attribute {
    fn from(number: i32) -> Self {
        Self::Int(number)
    }
}

impl From<[f32; 16]> for Attribute {
    fn from(rows: [f32; 16]) -> Self {
        Self::Matrix(rows)
    }
}
