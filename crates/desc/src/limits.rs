//! What a file may ask for.

use crate::{SceneError, Span};

/// Limits that readers check before they allocate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file after decompression.
    pub max_file_bytes: u64,
    /// Files that a scene's text is spread over, each counted as often as it is included.
    pub max_files: u64,
    /// Nested includes.
    pub max_include_depth: usize,
    /// Nested objects or attribute blocks.
    pub max_nesting: usize,
    /// Parameters of one element.
    pub max_params: usize,
    /// Textures or materials that one of them asks when it is evaluated, each counted as often as it is asked.
    pub max_evaluations: u64,
    /// Vertices or triangles of one mesh.
    pub max_mesh_elements: u64,
    /// Pixels of an image, rendered or read.
    pub max_pixels: u64,
    /// Bytes that one packed byte may unpack to, once there are more than [`UNPACK_FREELY`](Self::UNPACK_FREELY) of them.
    pub max_unpack_ratio: u64,
}

impl Limits {
    /// Checks the number of parameters of an element that is being read.
    ///
    /// # Errors
    /// [`SceneError::Limit`].
    pub fn check_params(&self, found: usize, at: Span) -> Result<(), SceneError> {
        if found <= self.max_params {
            return Ok(());
        }
        let what = "the number of parameters of an element".to_owned();
        Err(SceneError::Limit {
            what,
            found: found as u64,
            limit: self.max_params as u64,
            name: Some("max-params"),
            at,
        })
    }

    /// Bytes that any packed file may unpack to: it is the large ones that hurt.
    pub const UNPACK_FREELY: u64 = 16 << 20;

    /// Bytes of text that including a few files again and again may make: as much as two million instances of something.
    pub const INCLUDE_FREELY: u64 = 256 << 20;

    /// Bytes of text that so many bytes of different files may make when they include each other.
    pub fn max_included(&self, distinct: u64) -> u64 {
        let by_ratio = distinct.saturating_mul(self.max_unpack_ratio);
        by_ratio.max(Self::INCLUDE_FREELY).min(self.max_file_bytes)
    }

    /// Bytes that so many packed bytes may unpack to.
    pub fn max_unpacked(&self, packed: usize) -> u64 {
        let by_ratio = (packed as u64).saturating_mul(self.max_unpack_ratio);
        by_ratio.max(Self::UNPACK_FREELY).min(self.max_file_bytes)
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_file_bytes: 4 << 30,
            max_files: 1 << 15,
            max_include_depth: 64,
            max_nesting: 256,
            max_params: 256,
            max_evaluations: 1 << 14,
            max_mesh_elements: 1 << 28,
            max_pixels: 1 << 28,
            // Scenes pack ten to one, the emptiest meshes fifty to one; a bomb packs a thousand to one.
            max_unpack_ratio: 100,
        }
    }
}
