//! Statistical tests over closures: chi-square, z-test, furnace, moments, finite differences.
