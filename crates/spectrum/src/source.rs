//! Spectra as scene files give them, and as the renderer evaluates them.

use std::sync::Arc;

use crate::data::cie;
use crate::{Spectrum, Wavelengths, srgb_from_xyz};

/// A spectrum given as samples over wavelength, linear in between, zero outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// Wavelengths in nanometres, ascending.
    pub lambda: Vec<f32>,
    /// One value per wavelength.
    pub values: Vec<f32>,
}

/// A spectrum as a scene file names it.
#[derive(Clone, Debug, PartialEq)]
pub enum SpectrumSource {
    /// The same value at every wavelength.
    Uniform(f32),
    /// Linear Rec. 709.
    Rgb([f32; 3]),
    /// Samples over wavelength.
    Tabulated(Arc<Tabulated>),
}

/// What a spectrum is used for; it decides how samples over wavelength become RGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpectrumRole {
    /// A reflectance or transmittance in `[0, 1]`: seen under D65, clamped.
    Albedo,
    /// An emission: integrated as it is.
    Illuminant,
    /// A material constant such as an index of refraction: seen under D65, not clamped.
    Unbounded,
    /// A measured index of refraction, by name: weighted evenly, not clamped.
    Index,
}

/// A spectrum ready for evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedSpectrum {
    lanes: Spectrum,
}

impl SpectrumSource {
    /// The linear Rec. 709 colour of this spectrum in its role.
    pub fn to_rgb(&self, role: SpectrumRole) -> [f32; 3] {
        match self {
            Self::Uniform(value) => [*value; 3],
            Self::Rgb(rgb) => *rgb,
            Self::Tabulated(table) => table.to_rgb(role),
        }
    }

    /// Prepares the spectrum for evaluation in its role.
    pub fn prepare(&self, role: SpectrumRole) -> PreparedSpectrum {
        PreparedSpectrum { lanes: Spectrum::from_rgb(self.to_rgb(role)) }
    }
}

impl Tabulated {
    /// Interpolated value at a wavelength (nm); zero outside the table.
    pub fn eval(&self, lambda: f32) -> f32 {
        let i = self.lambda.partition_point(|&l| l <= lambda);
        if i == 0 || self.lambda.is_empty() {
            return 0.0;
        }
        if i == self.lambda.len() {
            return if lambda == self.lambda[i - 1] { self.values[i - 1] } else { 0.0 };
        }
        let (l0, l1) = (self.lambda[i - 1], self.lambda[i]);
        let t = (lambda - l0) / (l1 - l0);
        self.values[i - 1] * (1.0 - t) + self.values[i] * t
    }

    /// CIE XYZ: the integral against the colour matching functions, over that of ȳ; under D65 when `lit`.
    pub fn to_xyz(&self, lit: bool) -> [f32; 3] {
        let (mut xyz, mut norm) = ([0.0_f64; 3], 0.0_f64);
        for pair in cie().windows(2) {
            // A midpoint every nanometre: tables may be finer than the CIE's.
            for step in 0..5 {
                let t = (step as f32 + 0.5) / 5.0;
                let lerp = |a: f32, b: f32| a + (b - a) * t;
                let light = if lit { lerp(pair[0].d65, pair[1].d65) } else { 1.0 };
                let value = self.eval(lerp(pair[0].lambda, pair[1].lambda)) * light;
                let matching: [f32; 3] = std::array::from_fn(|c| lerp(pair[0].xyz[c], pair[1].xyz[c]));
                for (sum, weight) in xyz.iter_mut().zip(matching) {
                    *sum += f64::from(weight * value);
                }
                norm += f64::from(matching[1] * light);
            }
        }
        xyz.map(|x| (x / norm) as f32)
    }

    /// The linear Rec. 709 colour of the table in its role.
    pub fn to_rgb(&self, role: SpectrumRole) -> [f32; 3] {
        let rgb = srgb_from_xyz(self.to_xyz(matches!(role, SpectrumRole::Albedo | SpectrumRole::Unbounded)));
        match role {
            SpectrumRole::Albedo => rgb.map(|x| x.clamp(0.0, 1.0)),
            _ => rgb.map(|x| x.max(0.0)),
        }
    }
}

impl PreparedSpectrum {
    /// The same value in every lane.
    pub const fn splat(value: f32) -> Self {
        Self { lanes: Spectrum::splat(value) }
    }

    /// The four lanes at these wavelengths.
    #[inline]
    pub fn eval(&self, _wavelengths: &Wavelengths) -> Spectrum {
        self.lanes
    }
}
