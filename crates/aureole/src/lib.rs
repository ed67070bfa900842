//! A physically based ray tracer: the facade that Rust users depend on.
