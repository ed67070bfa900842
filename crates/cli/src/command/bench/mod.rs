//! `aureole bench`: how fast rays are, beside other libraries.

mod clock;
mod lecture;
mod ray_file;
mod rays;

use clap::{Args, Subcommand};

use crate::exit::Failure;

/// What to measure, and how.
#[derive(Args, Clone, Debug)]
pub(crate) struct BenchArgs {
    #[command(subcommand)]
    pub bench: Bench,
}

/// What can be measured.
#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Bench {
    /// Rays of a file against a mesh of a file
    Rays(rays::RaysArgs),
    /// The frame of which a lecture says that it takes 109 hours
    Lecture(lecture::LectureArgs),
}

/// Measures.
pub(crate) fn run(args: &BenchArgs) -> Result<(), Failure> {
    match &args.bench {
        Bench::Rays(args) => rays::run(args),
        Bench::Lecture(args) => lecture::run(args),
    }
}
