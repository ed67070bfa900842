//! The program `aureole`.

#![forbid(unsafe_code)]

mod args;
mod checkpoint;
mod claim;
mod command;
mod diagnostics;
mod exit;
mod log;
mod memory;
mod output;
mod progress;
mod session;
mod signals;
mod window;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::diagnostics::Painter;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    let (loudness, json) = (cli.command.loudness(), cli.command.json());
    log::start(loudness, json);
    let painter = if json { Painter::Json } else { Painter::for_terminal() };
    let result = match &cli.command {
        Command::Render(args) => command::render::run(args, &painter),
        Command::Info(args) => command::info::run(args, &painter),
        Command::List(args) => command::list::run(args),
        Command::Merge(args) => command::merge::run(args, &painter),
        Command::Diff(args) => command::diff::run(args),
        Command::Gallery(args) => command::gallery::run(args, &painter),
        Command::Bench(args) => command::bench::run(args).map(|()| exit::Exit::Done),
    };
    let exit = result.unwrap_or_else(|failure| {
        painter.failure(&failure);
        failure.exit()
    });
    exit.into()
}

/// Tells what is wrong with the command line; to programs as they want it.
fn refuse(error: &clap::Error) -> ExitCode {
    let is_for_programs = std::env::args_os().any(|arg| arg == "--json");
    if !(error.use_stderr() && is_for_programs) {
        error.exit();
    }
    let text = error.to_string();
    let (message, rest) = text.trim().split_once('\n').unwrap_or((text.trim(), ""));
    let help = Some(rest.trim()).filter(|help| !help.is_empty());
    Painter::Json.error(message.trim_start_matches("error: "), help);
    exit::Exit::Usage.into()
}
