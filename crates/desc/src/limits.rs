//! What a file may ask for.

/// Limits that readers check before they allocate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file after decompression.
    pub max_file_bytes: u64,
    /// Nested includes.
    pub max_include_depth: usize,
    /// Nested objects or attribute blocks.
    pub max_nesting: usize,
    /// Vertices or triangles of one mesh.
    pub max_mesh_elements: u64,
    /// Pixels of an image, rendered or read.
    pub max_pixels: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_file_bytes: 4 << 30,
            max_include_depth: 64,
            max_nesting: 256,
            max_mesh_elements: 1 << 28,
            max_pixels: 1 << 28,
        }
    }
}
