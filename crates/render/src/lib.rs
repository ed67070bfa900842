//! Integrators, film, passes, progress.
