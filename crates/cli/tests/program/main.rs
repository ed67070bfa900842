//! The program as people and scripts meet it: arguments, files, messages, exit codes.

mod commands;
mod errors;
#[expect(clippy::unwrap_used, reason = "a test without its files cannot go on")]
mod fixture;
mod hostile;
mod long;
mod render;
mod trust;
