//! Mesh files: bytes to [`Mesh`](aureole_desc::Mesh). No count in a file is believed before it is held against the bytes that are left.

pub mod curves;
pub(crate) mod error;
pub mod ies;
pub mod obj;
pub mod ply;
pub mod serialized;
pub mod vol;

pub use error::MeshError;
