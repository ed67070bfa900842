//! Measured reflectances: files into the parameters of `measured` and `merl`.

mod merl;
mod tensor;

use std::path::Path;
use std::sync::Arc;

use aureole_desc::{Limits, Params, SceneError, Span, Value};

use crate::file;
use crate::mesh::MeshError;
use tensor::Tensor;

/// Reads a measured reflectance: RGL's tensor files (`.bsdf`) or MERL's (`.binary`).
///
/// # Returns
/// The element's kind and its parameters.
///
/// # Errors
/// A file that cannot be read, or is neither.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<(&'static str, Params), SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&bytes, limits).map_err(|error| error.in_file(path, at))
}

/// Reads a measured reflectance from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], limits: &Limits) -> Result<(&'static str, Params), MeshError> {
    if tensor::is_tensor_file(bytes) {
        tensor::decode(bytes, limits).and_then(|tensors| Ok(("measured", rgl(&tensors)?)))
    } else {
        merl::decode(bytes, limits).map(|params| ("merl", params))
    }
}

/// The parameters that RGL's fields stand for.
fn rgl(tensors: &[(String, Tensor)]) -> Result<Params, MeshError> {
    let find = |name: &str| tensors.iter().find(|(known, _)| known == name).map(|(_, tensor)| tensor);
    let need = |name: &str| find(name).ok_or_else(|| MeshError::content(format!("no field `{name}`")));
    let mut params = Params::new();
    let mut put = |name: &str, tensor: &Tensor| {
        params.push(name, Value::Floats(Arc::clone(&tensor.values)), Span::NONE);
        if let [.., rows, columns] = tensor.shape[..] {
            let size = [rows, columns].map(|n| i32::try_from(n).unwrap_or(i32::MAX));
            params.push(format!("{name}_size"), Value::Ints(size.into()), Span::NONE);
        }
    };
    for name in ["phi_i", "theta_i", "ndf", "sigma", "vndf", "luminance"] {
        put(name, need(name)?);
    }
    // Files for RGB renderers have colours, others spectra; some have both.
    let colours = if find("rgb").is_some() { &["rgb"][..] } else { &["spectra", "wavelengths"] };
    for name in colours {
        params.push(*name, Value::Floats(Arc::clone(&need(name)?.values)), Span::NONE);
    }
    let jacobian = find("jacobian").and_then(|tensor| tensor.values.first().copied());
    params.push("jacobian", Value::Bool(jacobian.is_none_or(|x| x != 0.0)), Span::NONE);
    // The parameters that only repeat a shape are of no use to the element.
    for name in ["phi_i", "theta_i"] {
        params.remove(&format!("{name}_size"));
    }
    Ok(params)
}
