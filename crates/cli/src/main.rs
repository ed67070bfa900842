//! The program `aureole`.

fn main() {}
