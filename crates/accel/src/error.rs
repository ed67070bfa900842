//! What cannot be accelerated.

/// Geometry that cannot be built upon.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AccelError {
    /// Vertices that are NaN or infinite.
    #[error("{count} vertices of geometry {geometry} are not finite")]
    NonFinite {
        /// The geometry's index.
        geometry: usize,
        /// How many vertices or boxes.
        count: usize,
    },
    /// An index beyond the vertices.
    #[error("triangle {triangle} of geometry {geometry} names vertex {index}, but there are {vertices}")]
    BadIndex {
        /// The geometry's index.
        geometry: usize,
        /// The triangle's index.
        triangle: usize,
        /// The vertex that is named.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Moving vertices need two keys or more, each with the same number of vertices.
    #[error("geometry {geometry} moves by {keys} keys; it takes at least two of the same length")]
    BadKeys {
        /// The geometry's index.
        geometry: usize,
        /// How many keys there are.
        keys: usize,
    },
    /// A refit takes the geometries of the build, with as many primitives.
    #[error("geometry {geometry} has changed its kind or its number of primitives")]
    Changed {
        /// The geometry's index.
        geometry: usize,
    },
    /// 2²⁷ primitives or more in one level.
    #[error("{0} primitives are too many")]
    TooMany(u64),
}
