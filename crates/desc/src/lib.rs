//! The scene description: a generic tree of nodes with spans, known to no element.
