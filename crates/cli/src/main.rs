//! The program `aureole`.

#![forbid(unsafe_code)]

mod args;
mod checkpoint;
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

use crate::args::{Cli, Command, Loudness};
use crate::diagnostics::Painter;
use crate::exit::Failure;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let (loudness, json) = match &cli.command {
        Command::Render(args) => (args.loudness, args.json),
        Command::Info(args) => (args.loudness, false),
        Command::Gallery(args) => (args.loudness, false),
        Command::List(_) | Command::Merge(_) | Command::Diff(_) | Command::Bench(_) => {
            (Loudness::default(), false)
        }
    };
    log::start(loudness, json);
    let painter = if json { Painter::Json } else { Painter::for_terminal() };
    let result = match &cli.command {
        Command::Render(args) => command::render::run(args, &painter),
        Command::Info(args) => command::info::run(args, &painter),
        Command::List(args) => command::list::run(args),
        Command::Merge(args) => command::merge::run(args),
        Command::Diff(args) => command::diff::run(args),
        Command::Gallery(args) => command::gallery::run(args, &painter),
        Command::Bench(args) => command::bench::run(args).map(|()| exit::Exit::Done),
    };
    let exit = result.unwrap_or_else(|failure| {
        if let Failure::Plain { message, help, .. } = &failure {
            painter.error(message, help.as_deref());
        }
        failure.exit()
    });
    exit.into()
}
