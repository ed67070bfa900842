//! One file a command.

pub(crate) mod diff;
pub(crate) mod gallery;
pub(crate) mod info;
pub(crate) mod list;
pub(crate) mod render;
