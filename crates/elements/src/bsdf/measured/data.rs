//! The tables of a measured reflectance.

use std::f32::consts::PI;
use std::sync::Arc;

use aureole_desc::{Params, SceneError};
use aureole_math::Vector3;
use aureole_spectrum::{Tabulated, srgb_from_xyz};

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
    let columns = (0..wavelengths.len()).map(|i| hat(&wavelengths, i)).collect();
    Ok(("spectra", spectra, columns))
}

/// What the value at one of several wavelengths adds to a colour under D65. The map from spectra to colours is linear, so a
/// hat over the wavelength tells; it is far out of gamut, and only the sum of all is a colour. Beyond the first and the last
/// wavelength their values go on.
fn hat(wavelengths: &[f32], i: usize) -> [f32; 3] {
    /// Beyond what is seen.
    const ENDS: [f32; 2] = [1.0, 1e4];
    let is = |end: usize| if i == end { 1.0 } else { 0.0 };
    let last = wavelengths.len() - 1;
    let lambda = [&ENDS[..1], wavelengths, &ENDS[1..]].concat();
    let values = std::iter::once(is(0)).chain((0..=last).map(is)).chain([is(last)]).collect();
    srgb_from_xyz(Tabulated { lambda, values }.to_xyz(true))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What is the same at all wavelengths is grey, however many there are and wherever they end.
    #[test]
    fn even_spectra_are_grey() {
        for [first, last, count] in
            [[360.0, 830.0, 4.0], [400.0, 700.0, 31.0], [398.4, 999.9, 195.0], [550.0, 551.0, 2.0]]
        {
            let count = count as usize;
            let step = (last - first) / (count - 1) as f32;
            let wavelengths: Vec<f32> = (0..count).map(|i| first + step * i as f32).collect();
            let mut sum = [0.0_f32; 3];
            for i in 0..count {
                sum.iter_mut().zip(hat(&wavelengths, i)).for_each(|(sum, x)| *sum += x);
            }
            assert!(sum.iter().all(|x| (x - 1.0).abs() < 2e-3), "{first} to {last} by {count}: {sum:?}");
        }
    }

    /// One wavelength alone has the colour of its light: green is more than red and blue at 530 nm, and red at 620 nm.
    #[test]
    fn a_hat_has_the_colour_of_its_wavelength() {
        let wavelengths: Vec<f32> = (0..32).map(|i| 400.0 + 10.0 * i as f32).collect();
        let [green, red] = [hat(&wavelengths, 13), hat(&wavelengths, 22)];
        assert!(green[1] > 0.02 && green[0] < 0.0 && green[2] < green[1], "{green:?}");
        assert!(red[0] > 0.02 && red[1] < 0.3 * red[0] && red[2] < 0.1 * red[0], "{red:?}");
    }
}
