//! Wavelengths, spectra, CIE data, colour spaces, up-sampling.
//!
//! Radiance travels through the renderer as a [`Spectrum`]: four lanes that mean R, G, B and a spare in RGB mode, or
//! the values at four hero wavelengths in spectral mode. Which of the two is a run-time choice ([`ColorMode`]).
//!
//! ```
//! use aureole_spectrum::{Spectrum, SpectrumRole, SpectrumSource, Wavelengths};
//!
//! let albedo = SpectrumSource::Rgb([0.8, 0.4, 0.2]).prepare(SpectrumRole::Albedo);
//! let lanes: Spectrum = albedo.eval(&Wavelengths::RGB);
//! assert_eq!(lanes.rgb(), [0.8, 0.4, 0.2]);
//! ```

mod color;
mod data;
mod illuminant;
mod primaries;
mod source;
mod spectrum;
mod wavelengths;

pub use color::{luminance, srgb_from_linear, srgb_from_xyz, srgb_to_linear, xyz_from_srgb};
pub use data::{
    Metal, Scattering, blackbody, dielectric_ior, dielectrics, glass, metal, metals, named_spectrum,
    scattering_substances, spectrum_names,
};
pub use primaries::{Primaries, WhitePoint};
pub use source::{PreparedSpectrum, SpectrumRole, SpectrumSource, Tabulated};
pub use spectrum::Spectrum;
pub use wavelengths::{ColorMode, Wavelengths};
