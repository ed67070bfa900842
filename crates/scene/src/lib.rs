//! Compiles a description into a scene: arenas, two-level acceleration, light picker, ray queries.
