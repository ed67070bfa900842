//! The tables of a measured reflectance.

use std::f32::consts::PI;
use std::sync::Arc;

use aureole_desc::{Params, SceneError};
use aureole_math::Vector3;
use aureole_spectrum::{SpectrumRole, SpectrumSource, Tabulated};

use super::warp::{Table, Warp};

/// Everything that was measured.
#[derive(Debug)]
pub(super) struct MeasuredData {
    pub phi: Arc<[f32]>,
    pub theta: Arc<[f32]>,
    pub ndf: Table,
    pub sigma: Table,
    pub vndf: Warp,
    pub luminance: Warp,
    pub rgb: [Table; 3],
    pub has_jacobian: bool,
    /// How many quarters or halves of the circle of azimuths were left out because they are mirror images: 1, 2 or 4.
    symmetry: u32,
}

/// Takes numbers that must be there.
fn floats(params: &mut Params, name: &str) -> Result<Arc<[f32]>, SceneError> {
    let found = params.try_floats(name)?;
    found.ok_or_else(|| SceneError::invalid(format!("`measured` needs `{name}`"), params.span(name)))
}

/// Takes rows and columns.
fn size(params: &mut Params, name: &str) -> Result<[usize; 2], SceneError> {
    let name = format!("{name}_size");
    let found = params.try_ints(&name)?;
    let found = found.as_deref().and_then(|ints| <[i32; 2]>::try_from(ints).ok());
    let at = params.span(&name);
    let found = found.filter(|size| size.iter().all(|&n| n > 0));
    found
        .map(|size| size.map(|n| n as usize))
        .ok_or_else(|| SceneError::invalid(format!("`measured` needs `{name}`: rows and columns"), at))
}

impl MeasuredData {
    pub(super) fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        let (phi, theta) = (floats(params, "phi_i")?, floats(params, "theta_i")?);
        let slices = phi.len() * theta.len();
        let broken = |params: &Params, name: &str| {
            let message = format!("the table `{name}` is not of the size that is said, or not positive");
            SceneError::invalid(message, params.span(name))
        };
        let mut table = |name: &str| -> Result<Table, SceneError> {
            let (values, size) = (floats(params, name)?, size(params, name)?);
            Table::new(size, 1, &values).ok_or_else(|| broken(params, name))
        };
        let (ndf, sigma) = (table("ndf")?, table("sigma")?);
        let mut warp = |name: &str| -> Result<Warp, SceneError> {
            let (values, size) = (floats(params, name)?, size(params, name)?);
            Warp::new(size, slices, &values).ok_or_else(|| broken(params, name))
        };
        let (vndf, luminance) = (warp("vndf")?, warp("luminance")?);
        let resolution = size(params, "luminance")?;
        let (name, values, columns) = colours(params)?;
        let rgb = by_channel(&values, slices, resolution, &columns)
            .and_then(|[r, g, b]| {
                let table = |values: Vec<f32>| Table::new(resolution, slices, &values);
                Some([table(r)?, table(g)?, table(b)?])
            })
            .ok_or_else(|| broken(params, name))?;
        let symmetry = match (phi.first(), phi.last()) {
            (Some(first), Some(last)) if phi.len() > 2 => (2.0 * PI / (last - first).max(0.1)).round() as u32,
            _ => 1,
        };
        let has_jacobian = params.bool("jacobian", true)?;
        Ok(Self { phi, theta, ndf, sigma, vndf, luminance, rgb, has_jacobian, symmetry })
    }

    /// Whether only the difference of azimuths matters.
    pub(super) fn is_isotropic(&self) -> bool {
        self.phi.len() <= 2
    }

    /// Both directions mirrored into the measured part of the circle, as `wo` asks for.
    pub(super) fn unmirrored(&self, wo: Vector3, wi: Vector3) -> [Vector3; 2] {
        if self.is_isotropic() || self.symmetry < 2 {
            return [wo, wi];
        }
        let flips = |x: f32| if x.is_sign_positive() { -1.0 } else { 1.0 };
        let y = flips(wo.y);
        let x = if self.symmetry == 4 { flips(wo.x) } else { y };
        [wo, wi].map(|w| Vector3::new(w.x * x, w.y * y, w.z))
    }

    /// The inverse: `wi` of the measured part as seen from where `wo` is.
    pub(super) fn mirrored(&self, wo: Vector3, wi: Vector3) -> [Vector3; 2] {
        self.unmirrored(wo, wi)
    }
}

/// What each of a table's spectral columns adds to red, green and blue.
type Columns = Vec<[f32; 3]>;

/// The colours: given as such, or as spectra.
fn colours(params: &mut Params) -> Result<(&'static str, Arc<[f32]>, Columns), SceneError> {
    if let Some(rgb) = params.try_floats("rgb")? {
        return Ok(("rgb", rgb, vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
    }
    let (spectra, wavelengths) = (floats(params, "spectra")?, floats(params, "wavelengths")?);
    // The map from spectra to colours is linear: a hat over each wavelength gives its column.
    let column = |i: usize| {
        let mut values = vec![0.0; wavelengths.len()];
        values[i] = 1.0;
        let hat = Tabulated { lambda: wavelengths.to_vec(), values };
        SpectrumSource::Tabulated(Arc::new(hat)).to_rgb(SpectrumRole::Unbounded)
    };
    let columns = (0..wavelengths.len()).map(column).collect();
    Ok(("spectra", spectra, columns))
}

/// Tables of red, green and blue from tables by incidence and spectral column.
fn by_channel(
    values: &[f32],
    slices: usize,
    [height, width]: [usize; 2],
    columns: &Columns,
) -> Option<[Vec<f32>; 3]> {
    let size = height.checked_mul(width)?;
    let per_slice = size.checked_mul(columns.len())?;
    if per_slice == 0 || per_slice.checked_mul(slices)? != values.len() {
        return None;
    }
    Some([0, 1, 2].map(|channel| {
        let mut out = vec![0.0; size * slices];
        for (out, slice) in out.chunks_exact_mut(size).zip(values.chunks_exact(per_slice)) {
            for (column, table) in columns.iter().zip(slice.chunks_exact(size)) {
                out.iter_mut().zip(table).for_each(|(out, value)| *out += column[channel] * value);
            }
        }
        out
    }))
}
