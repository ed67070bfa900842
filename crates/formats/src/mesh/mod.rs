//! Mesh files: bytes to [`Mesh`](aureole_desc::Mesh). No count in a file is believed before it is held against the bytes that are left.

pub(crate) mod colors;
pub mod curves;
pub(crate) mod error;
pub mod ies;
pub(crate) mod lines;
pub mod obj;
pub mod ply;
pub mod serialized;
pub mod vol;

pub use error::MeshError;

/// A mesh, and what there is to say about its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// The mesh.
    pub mesh: aureole_desc::Mesh,
    /// What is left out, in sentences that name their place in the file.
    pub notes: Vec<String>,
}
