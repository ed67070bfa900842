//! Interference in a thin transparent film: soap bubbles, oil on water, anodised metal.
//!
//! # References
//! [Belcour and Barla 2017] "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence": the
//! series of reflections in the film, integrated over the eye's sensitivities in closed form.

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Id;
use aureole_spectrum::{Spectrum, srgb_from_xyz};

use crate::{Resolver, Texture, TextureContext, float_texture};

/// Documentation of the parameters of films.
pub(super) const FILM_PARAMS: [ParamDoc; 2] = [
    ParamDoc {
        name: "film_thickness",
        ty: "texture",
        default: "0",
        doc: "thickness of a film on the surface, in nanometres",
    },
    ParamDoc { name: "film_ior", ty: "float", default: "1.33", doc: "index of the film over that outside" },
];

/// A film as a material describes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilmTexture {
    thickness: Id<Texture>,
    eta: f32,
}

impl FilmTexture {
    /// Reads the film's parameters; none if there is no film.
    pub(super) fn from_params(
        params: &mut Params,
        resolver: &mut dyn Resolver,
    ) -> Result<Option<Self>, SceneError> {
        let eta = params.float_in("film_ior", 1.33, 1.0, 4.0)?;
        if !params.has("film_thickness") {
            return Ok(None);
        }
        Ok(Some(Self { thickness: float_texture(params, resolver, "film_thickness", 0.0)?, eta }))
    }

    /// The film at a point; none where it has no thickness.
    #[inline]
    pub(super) fn at(&self, at: &TextureContext<'_>) -> Option<Film> {
        let thickness = at.float(self.thickness);
        (thickness > 0.0).then_some(Film { eta: self.eta, thickness, weight: 1.0 })
    }
}

/// A film on a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Index of the film over that outside.
    pub eta: f32,
    /// Thickness in nanometres.
    pub thickness: f32,
    /// How much of the surface it covers.
    pub weight: f32,
}

/// A complex number.
#[derive(Clone, Copy)]
struct Complex {
    re: f32,
    im: f32,
}

impl Complex {
    fn of(re: f32, im: f32) -> Self {
        Self { re, im }
    }
    fn add(self, b: Self) -> Self {
        Self::of(self.re + b.re, self.im + b.im)
    }
    fn sub(self, b: Self) -> Self {
        Self::of(self.re - b.re, self.im - b.im)
    }
    fn mul(self, b: Self) -> Self {
        Self::of(self.re * b.re - self.im * b.im, self.re * b.im + self.im * b.re)
    }
    fn norm2(self) -> f32 {
        self.re * self.re + self.im * self.im
    }
    fn div(self, b: Self) -> Self {
        let n = b.norm2().max(1e-20);
        Self::of((self.re * b.re + self.im * b.im) / n, (self.im * b.re - self.re * b.im) / n)
    }
    /// The root in the right half plane.
    fn sqrt(self) -> Self {
        let r = self.norm2().sqrt();
        let (re, im) = ((0.5 * (r + self.re)).max(0.0).sqrt(), (0.5 * (r - self.re)).max(0.0).sqrt());
        Self::of(re, if self.im < 0.0 { -im } else { im })
    }
    fn arg(self) -> f32 {
        self.im.atan2(self.re)
    }
}

/// The colour of `cos(2π opd / λ + shift)` under even light, where white is one: fits of Gaussians to the CIE's colour
/// matching functions in the domain of frequencies [Belcour and Barla 2017, supplement].
fn sensitivity(opd: f32, shift: [f32; 3]) -> [f32; 3] {
    const WEIGHT: [f32; 3] = [5.4856e-13, 4.4201e-13, 5.2481e-13];
    const CENTRE: [f32; 3] = [1.6810e6, 1.7953e6, 2.2084e6];
    const VARIANCE: [f32; 3] = [4.3278e9, 9.3046e9, 6.6121e9];
    const NORMALIZATION: f32 = 1.0685e-7;
    let phase = 2.0 * PI * opd * 1e-9;
    let lobe = |weight: f32, centre: f32, variance: f32, shift: f32| {
        weight
            * (2.0 * PI * variance).sqrt()
            * (centre * phase + shift).cos()
            * (-variance * phase * phase).exp()
    };
    let mut xyz = std::array::from_fn(|i| lobe(WEIGHT[i], CENTRE[i], VARIANCE[i], shift[i]));
    // The red curve has a second hill in the blue.
    xyz[0] += lobe(9.7470e-14, 2.2399e6, 4.5282e9, shift[0]);
    // Even light of the curves' white is to be white.
    let white = srgb_from_xyz([1.0; 3]);
    let rgb = srgb_from_xyz(xyz.map(|x| x / NORMALIZATION));
    std::array::from_fn(|i| rgb[i] / white[i])
}

/// One polarisation of the light: amplitudes at the film's two faces.
struct Faces {
    /// Reflectance of the upper face.
    r12: f32,
    /// The phase that reflection from within at the upper face adds.
    phase21: f32,
    /// Reflectance of the lower face and the phase that it adds, for each of three colours.
    r23: [f32; 3],
    phase23: [f32; 3],
}

impl Film {
    /// Reflectance of the film on a base of index `eta + i k` relative to the outside, where light comes from.
    pub fn reflectance(&self, cos: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
        let cos = cos.abs().min(1.0);
        let sin2 = 1.0 - cos * cos;
        let cos2_film = 1.0 - sin2 / (self.eta * self.eta);
        if cos2_film <= 0.0 {
            return Spectrum::ONE;
        }
        let cos_film = cos2_film.sqrt();
        let path = 2.0 * self.eta * self.thickness * cos_film;
        let faces = [true, false].map(|is_s| self.faces(cos, cos_film, sin2, eta, k, is_s));
        let [s, p] = faces.map(|faces| series(&faces, path));
        Spectrum::from_rgb(std::array::from_fn(|i| (0.5 * (s[i] + p[i])).clamp(0.0, 1.0)))
    }

    fn faces(&self, cos: f32, cos_film: f32, sin2: f32, eta: Spectrum, k: Spectrum, is_s: bool) -> Faces {
        let amplitude = |n1: f32, c1: f32, n2: f32, c2: f32| {
            if is_s {
                (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2)
            } else {
                (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2)
            }
        };
        let r12 = amplitude(1.0, cos, self.eta, cos_film);
        let (eta, k) = (eta.rgb(), k.rgb());
        let lower: [Complex; 3] = std::array::from_fn(|i| {
            let (film, base) = (Complex::of(self.eta, 0.0), Complex::of(eta[i], k[i]));
            // cos of the refracted wave: √(1 - sin² / n²).
            let cos_base = Complex::of(1.0, 0.0).sub(Complex::of(sin2, 0.0).div(base.mul(base))).sqrt();
            let c = Complex::of(cos_film, 0.0);
            let (a, b) =
                if is_s { (film.mul(c), base.mul(cos_base)) } else { (base.mul(c), film.mul(cos_base)) };
            a.sub(b).div(a.add(b))
        });
        Faces {
            r12: r12 * r12,
            // Seen from within, the amplitude has the other sign.
            phase21: if r12 > 0.0 { PI } else { 0.0 },
            r23: lower.map(|r| r.norm2().min(1.0)),
            phase23: lower.map(Complex::arg),
        }
    }
}

/// The sum over reflections in the film; terms beyond the third are too fine for the eye.
fn series(faces: &Faces, path: f32) -> [f32; 3] {
    let t121 = 1.0 - faces.r12;
    let mut rgb = [0.0; 3];
    let mut term = [0.0; 3];
    let mut damping = [0.0; 3];
    for i in 0..3 {
        let r123 = (faces.r12 * faces.r23[i]).clamp(1e-5, 0.9999);
        let rest = t121 * t121 * faces.r23[i] / (1.0 - r123);
        rgb[i] = faces.r12 + rest;
        term[i] = rest - t121;
        damping[i] = r123.sqrt();
    }
    for m in 1..=3 {
        let m = m as f32;
        let waves = sensitivity(m * path, faces.phase23.map(|phase| m * (phase + faces.phase21)));
        for i in 0..3 {
            term[i] *= damping[i];
            rgb[i] += 2.0 * term[i] * waves[i];
        }
    }
    rgb
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use aureole_spectrum::{SpectrumRole, SpectrumSource, Tabulated};

    use super::super::fresnel;
    use super::*;

    /// The exact reflectance of a film on a dielectric at a wavelength, for light from straight above: Airy's formula.
    fn airy(film: &Film, eta: f32, lambda: f32) -> f32 {
        let (r12, r23) = ((1.0 - film.eta) / (1.0 + film.eta), (film.eta - eta) / (film.eta + eta));
        let phase = 4.0 * PI * film.eta * film.thickness / lambda;
        let cross = 2.0 * r12 * r23 * phase.cos();
        (r12 * r12 + r23 * r23 + cross) / (1.0 + r12 * r12 * r23 * r23 + cross)
    }

    #[test]
    fn colours_are_those_of_airy_s_formula() {
        for thickness in [150.0_f32, 300.0, 450.0, 700.0] {
            let (film, eta) = (Film { eta: 1.33, thickness, weight: 1.0 }, 1.8);
            let lambda: Vec<f32> = (0..95).map(|i| 360.0 + 5.0 * i as f32).collect();
            let values = lambda.iter().map(|&l| airy(&film, eta, l)).collect();
            let exact = SpectrumSource::Tabulated(Arc::new(Tabulated { lambda, values }));
            let exact = exact.to_rgb(SpectrumRole::Index);
            let found = film.reflectance(1.0, Spectrum::splat(eta), Spectrum::ZERO).rgb();
            for i in 0..3 {
                assert!((found[i] - exact[i]).abs() < 0.02, "{thickness}: {found:?} {exact:?}");
            }
        }
    }

    #[test]
    fn a_film_of_the_base_s_index_is_not_seen() {
        let film = Film { eta: 1.5, thickness: 400.0, weight: 1.0 };
        for cos in [0.2_f32, 0.6, 1.0] {
            let found = film.reflectance(cos, Spectrum::splat(1.5), Spectrum::ZERO)[1];
            let bare = fresnel::dielectric(cos, 1.5).reflectance;
            assert!((found - bare).abs() < 0.01, "{cos}: {found} {bare}");
        }
    }
}
