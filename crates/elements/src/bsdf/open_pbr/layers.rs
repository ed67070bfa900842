//! The layers of an OpenPBR surface at a point, as weighted lobes.

use aureole_math::{Frame, Vector3};
use aureole_spectrum::Spectrum;

use super::super::conductor::{Metal, Response};
use super::super::dielectric::Glass;
use super::super::microfacet::{Distribution, Microfacet};
use super::super::subsurface::looks_like;
use super::super::{
    Bsdf, ConductorLobe, DielectricLobe, DiffuseTransmissionLobe, EmissionContext, Film, GlossLobe, Interior,
    Lobe, LobeOps, MaterialContext, NullLobe, PrismLobe, RoughConductorLobe, RoughDielectricLobe,
    RoughDiffuseLobe, RoughPrismLobe, SheenLobe, SubsurfaceLobe, ThinDielectricLobe, fresnel,
};
use super::{Finish, OpenPbr};
use crate::TextureContext;

/// The facets of a roughness; none if it is smooth [specification, "Microfacet model"].
fn facets(roughness: f32, anisotropy: f32) -> Option<Microfacet> {
    let alpha = roughness * roughness;
    let narrow = 1.0 - anisotropy;
    let alpha_u = alpha * (2.0 / (1.0 + narrow * narrow)).sqrt();
    (alpha_u > 1e-3).then(|| Microfacet::new(Distribution::Ggx, alpha_u, narrow * alpha_u))
}

/// The index that reflects `weight` times as much at normal incidence as `ior` does.
fn modulated(ior: f32, weight: f32) -> f32 {
    let r = weight.max(0.0).sqrt() * (ior - 1.0) / (ior + 1.0);
    (1.0 + r.min(0.99)) / (1.0 - r.min(0.99))
}

/// What the layers above leave to those below.
struct Light {
    /// Share, for choosing lobes.
    weight: f32,
    /// Colour, at most one.
    tint: Spectrum,
}

/// Adds all lobes.
pub(super) fn evaluate(m: &OpenPbr, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
    let opacity = at.texture.float(m.opacity).clamp(0.0, 1.0);
    out.push(NullLobe::CLEAR, weight * (1.0 - opacity), at.frame, at.frame.n);
    let mut light = Light { weight: weight * opacity, tint: Spectrum::ONE };
    let (first, n) = (out.len(), at.frame.n);
    let at_base = m.base_bearing.at(at);
    let cos = at.wo.dot(at_base.frame.n);
    if cos > 0.0 {
        let at_coat = m.coat_bearing.at(at);
        fuzz(m, &between(m, &at_base, &at_coat), &mut light, out);
        let coated = coat(m, &at_coat, &mut light, out);
        base(m, &at_base, cos, &light, coated, out);
    } else {
        from_inside(m, &at_base, &light, out);
    }
    if m.base_bearing.is_turned() || m.coat_bearing.is_turned() {
        out.rebase(first, n, true);
    }
}

/// Where fuzz lies: on coat where there is some, and on the base elsewhere [specification, "Fuzz"].
fn between<'a>(
    m: &OpenPbr,
    at_base: &MaterialContext<'a>,
    at_coat: &MaterialContext<'a>,
) -> MaterialContext<'a> {
    if !m.base_bearing.is_turned() && !m.coat_bearing.is_turned() {
        return *at_base;
    }
    let n = at_base.frame.n.lerp(at_coat.frame.n, m.coat.weight_at(&at_base.texture));
    let n = n.try_normalized().unwrap_or(at_base.frame.n);
    MaterialContext { frame: Frame::from_normal_and_tangent(n, at_base.frame.s), ..*at_base }
}

/// The light that the base sends out, less what fuzz and coat keep [specification, "Emission"]. Angles are those to the
/// surface itself, whatever the normals of the layers.
pub(super) fn emitted(m: &OpenPbr, at: &EmissionContext<'_>) -> Spectrum {
    let (texture, cos) = (&at.texture, if m.is_thin_walled { at.cos.abs() } else { at.cos });
    if cos <= 0.0 {
        return Spectrum::ZERO;
    }
    let opacity = texture.float(m.opacity).clamp(0.0, 1.0);
    let radiance = texture.spectrum(m.emission.color).max_zero() * texture.float(m.emission.weight).max(0.0);
    let coat_weight = m.coat.weight_at(texture);
    // The way out alone.
    let color = m.coat.color_at(texture).map(|c| c.powf(0.5 * passages(m, cos)));
    let coated =
        Spectrum::ONE.lerp(color, coat_weight) * (1.0 - coat_weight * coat_reflectance(m, texture, cos));
    let fuzzy = 1.0 - m.fuzz.weight_at(texture) * fuzz_reflectance(m, texture, cos);
    radiance * coated * (opacity * fuzzy)
}

/// The share of light that fuzz keeps from what is below it.
fn fuzz_reflectance(m: &OpenPbr, at: &TextureContext<'_>, cos: f32) -> f32 {
    let white = SheenLobe::new(Spectrum::ONE, at.float(m.fuzz_roughness));
    white.albedo(Vector3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos))[0]
}

fn coat_facets(m: &OpenPbr, at: &TextureContext<'_>) -> Option<Microfacet> {
    let (roughness, anisotropy) = finish(&m.coat_finish, at);
    facets(roughness, anisotropy)
}

/// The share of light that the coat's surface reflects.
fn coat_reflectance(m: &OpenPbr, at: &TextureContext<'_>, cos: f32) -> f32 {
    match coat_facets(m, at) {
        Some(surface) => m.coat_gloss.at(&surface, cos),
        None => fresnel::dielectric(cos, m.coat_ior).reflectance,
    }
}

/// How much longer than straight up the way through the coat is.
fn passages(m: &OpenPbr, cos: f32) -> f32 {
    let sin2 = (1.0 - cos * cos) / (m.coat_ior * m.coat_ior);
    1.0 / (1.0 - sin2).max(0.01).sqrt()
}

/// What light meets that wants to leave: glass, or the boundary of a body that scatters. Who is in a body has been let in
/// already, so its boundary is whole.
fn from_inside(m: &OpenPbr, at: &MaterialContext<'_>, light: &Light, out: &mut Bsdf) {
    let texture = &at.texture;
    let (metal, glass, body) =
        (metalness(m, texture), m.transmission.weight_at(texture), m.subsurface.weight_at(texture));
    let roughness = roughness(m, texture);
    let whole = |weight| Light { weight: light.weight * weight, tint: light.tint };
    if metal < 1.0 && glass < 1.0 && body > 0.0 {
        if glass > 0.0 {
            translucent(m, at, &whole(1.0), roughness, out);
        } else {
            scattering_body(m, at, &whole(1.0), roughness, out);
        }
    } else {
        translucent(m, at, &whole(glass * (1.0 - metal)), roughness, out);
    }
}

/// A body that scatters inside, below the base's boundary.
fn scattering_body(m: &OpenPbr, at: &MaterialContext<'_>, light: &Light, roughness: f32, out: &mut Bsdf) {
    let (texture, Some(albedos)) = (&at.texture, &m.albedos) else { return };
    let glass = Glass { transmittance: light.tint, ..surface(m, texture, light.tint) };
    let (_, anisotropy) = finish(&m.specular_finish, texture);
    let color = m.subsurface.color_at(texture);
    let length = texture.spectrum(m.subsurface_radius) * texture.spectrum(m.subsurface_radius_scale);
    let interior = looks_like(albedos, color, length, m.subsurface_g);
    let lobe = SubsurfaceLobe { glass, surface: facets(roughness, anisotropy), returned: color };
    out.push_boundary(lobe, interior, light.weight, at.frame, at.frame.n);
}

/// A sheet that scatters to both sides [specification, "Thin-walled": subsurface].
fn thin_body(m: &OpenPbr, at: &MaterialContext<'_>, light: &Light, out: &mut Bsdf) {
    let color = m.subsurface.color_at(&at.texture) * light.tint;
    let share = |g: f32| color * (0.5 * (1.0 + g));
    let lobe =
        DiffuseTransmissionLobe { reflectance: share(-m.subsurface_g), transmittance: share(m.subsurface_g) };
    out.push(lobe, light.weight, at.frame, at.frame.n);
}

/// What fills glass of some depth [specification, "Translucent base"].
fn filling(m: &OpenPbr, at: &TextureContext<'_>) -> Option<Interior> {
    if m.transmission_depth <= 0.0 || m.is_thin_walled {
        return None;
    }
    let per_length = 1.0 / m.transmission_depth;
    let extinction = m.transmission.color_at(at).map(|c| -c.max(1e-6).ln() * per_length);
    let scattering = at.spectrum(m.transmission_scatter).max_zero() * per_length;
    let absorption = extinction - scattering;
    // No colour may absorb less than nothing: all are lifted by as much as the lowest lacks.
    let lowest = absorption.rgb().into_iter().fold(0.0, f32::min);
    Some(Interior::from_coefficients(absorption - Spectrum::splat(lowest), scattering, m.transmission_g))
}

fn metalness(m: &OpenPbr, at: &TextureContext<'_>) -> f32 {
    at.float(m.metalness).clamp(0.0, 1.0)
}

fn finish(finish: &Finish, at: &TextureContext<'_>) -> (f32, f32) {
    (at.float(finish.roughness).clamp(0.0, 1.0), at.float(finish.anisotropy).clamp(0.0, 0.99))
}

/// The roughness of the base's surface, blurred by a rough coat above [specification, "Coat": roughening].
fn roughness(m: &OpenPbr, at: &TextureContext<'_>) -> f32 {
    let (base, _) = finish(&m.specular_finish, at);
    let (coat, _) = finish(&m.coat_finish, at);
    let blurred = (base.powi(4) + 2.0 * coat.powi(4)).min(1.0).powf(0.25);
    base + (blurred - base) * m.coat.weight_at(at)
}

fn fuzz(m: &OpenPbr, at: &MaterialContext<'_>, light: &mut Light, out: &mut Bsdf) {
    let weight = m.fuzz.weight_at(&at.texture);
    if weight > 0.0 {
        let lobe = SheenLobe::new(m.fuzz.color_at(&at.texture), at.texture.float(m.fuzz_roughness));
        out.push(lobe, light.weight * weight, at.frame, at.frame.n);
        light.weight *= 1.0 - weight * fuzz_reflectance(m, &at.texture, at.wo.dot(at.frame.n));
    }
}

/// Adds the coat's reflection; gives how much of the base is coated.
fn coat(m: &OpenPbr, at: &MaterialContext<'_>, light: &mut Light, out: &mut Bsdf) -> f32 {
    let (weight, cos) = (m.coat.weight_at(&at.texture), at.wo.dot(at.frame.n).max(1e-4));
    if weight == 0.0 {
        return 0.0;
    }
    let surface = coat_facets(m, &at.texture);
    let glass = Glass { eta: m.coat_ior, reflectance: light.tint, transmittance: Spectrum::ONE, film: None };
    out.push(GlossLobe { glass, surface }, light.weight * weight, at.frame, at.frame.n);
    // Absorption on the way in and out, both as long as the viewer's.
    let color = m.coat.color_at(&at.texture).map(|c| c.powf(passages(m, cos)));
    light.weight *= 1.0 - weight * coat_reflectance(m, &at.texture, cos);
    light.tint *= Spectrum::ONE.lerp(color, weight);
    weight
}

/// How much a coat deepens a base of some albedo by reflecting its light back [specification, "Coat": darkening].
fn darkening(m: &OpenPbr, at: &TextureContext<'_>, cos: f32, albedo: Spectrum, is_matte: bool) -> Spectrum {
    let weight = m.coat.weight_at(at) * at.float(m.coat_darkening).clamp(0.0, 1.0);
    if weight == 0.0 {
        return Spectrum::ONE;
    }
    let diffuse = 1.0 - (1.0 - fresnel::diffuse_reflectance(m.coat_ior)) / (m.coat_ior * m.coat_ior);
    let mirror = fresnel::dielectric(cos, m.coat_ior).reflectance;
    let blur = if is_matte { 1.0 } else { roughness(m, at) };
    let kept = mirror + (diffuse - mirror) * blur;
    let deepened = Spectrum::splat(1.0 - kept) / (Spectrum::ONE - albedo * kept);
    Spectrum::ONE.lerp(deepened, weight)
}

fn film(m: &OpenPbr, at: &TextureContext<'_>) -> Option<Film> {
    let weight = at.float(m.film_weight).clamp(0.0, 1.0);
    // The specification gives micrometres.
    let thickness = 1000.0 * at.float(m.film_thickness).max(0.0);
    (weight > 0.0 && thickness > 0.0).then_some(Film { eta: m.film_ior, thickness, weight })
}

fn base(m: &OpenPbr, at: &MaterialContext<'_>, cos: f32, light: &Light, coated: f32, out: &mut Bsdf) {
    let texture = &at.texture;
    let (metal, glass) = (metalness(m, texture), m.transmission.weight_at(texture));
    let roughness = roughness(m, texture);
    let share = |share: f32| Light { weight: light.weight * share, tint: light.tint };
    if metal > 0.0 {
        metallic(m, at, cos, &share(metal), roughness, out);
    }
    if metal < 1.0 && glass > 0.0 {
        translucent(m, at, &share((1.0 - metal) * glass), roughness, out);
    }
    if metal < 1.0 && glass < 1.0 {
        let (body, opaque_share) = (m.subsurface.weight_at(texture), (1.0 - metal) * (1.0 - glass));
        if body > 0.0 && m.is_thin_walled {
            thin_body(m, at, &share(opaque_share * body), out);
        } else if body > 0.0 {
            scattering_body(m, at, &share(opaque_share * body), roughness, out);
        }
        if body < 1.0 {
            opaque(m, at, cos, &share(opaque_share * (1.0 - body)), (roughness, coated), out);
        }
    }
}

fn metallic(m: &OpenPbr, at: &MaterialContext<'_>, cos: f32, light: &Light, roughness: f32, out: &mut Bsdf) {
    let texture = &at.texture;
    let f0 = m.base.color_at(texture) * m.base.weight_at(texture);
    let edge = m.specular.color_at(texture);
    let tint = light.tint * m.specular.weight_at(texture) * darkening(m, texture, cos, f0, false);
    let metal = Metal { response: Response::Tinted([f0, edge]), tint, film: film(m, texture) };
    let (_, anisotropy) = finish(&m.specular_finish, texture);
    match facets(roughness, anisotropy) {
        Some(surface) => out.push(RoughConductorLobe { metal, surface }, light.weight, at.frame, at.frame.n),
        None => out.push(ConductorLobe { metal }, light.weight, at.frame, at.frame.n),
    }
}

/// The dielectric surface of the base.
fn surface(m: &OpenPbr, at: &TextureContext<'_>, tint: Spectrum) -> Glass {
    Glass {
        eta: modulated(m.specular_ior, m.specular.weight_at(at)),
        reflectance: tint * m.specular.color_at(at),
        transmittance: if m.transmission_depth > 0.0 { tint } else { tint * m.transmission.color_at(at) },
        film: film(m, at),
    }
}

fn translucent(m: &OpenPbr, at: &MaterialContext<'_>, light: &Light, roughness: f32, out: &mut Bsdf) {
    let glass = surface(m, &at.texture, light.tint);
    let (_, anisotropy) = finish(&m.specular_finish, &at.texture);
    let (weight, frame, n) = (light.weight, at.frame, at.frame.n);
    let lobe: Lobe = match facets(roughness, anisotropy) {
        _ if m.is_thin_walled => ThinDielectricLobe { glass }.into(),
        Some(surface) => match m.dispersion {
            Some(spread) => RoughPrismLobe { glass, surface, spread }.into(),
            None => RoughDielectricLobe { glass, surface }.into(),
        },
        None => match m.dispersion {
            Some(spread) => PrismLobe { glass, spread }.into(),
            None => DielectricLobe { glass }.into(),
        },
    };
    match filling(m, &at.texture) {
        Some(interior) => out.push_boundary(lobe, interior, weight, frame, n),
        None => out.push(lobe, weight, frame, n),
    }
}

/// The glossy matte base: what the gloss leaves is scattered below it.
fn opaque(
    m: &OpenPbr,
    at: &MaterialContext<'_>,
    cos: f32,
    light: &Light,
    (roughness, coated): (f32, f32),
    out: &mut Bsdf,
) {
    let texture = &at.texture;
    let glass = surface(m, texture, light.tint);
    let (_, anisotropy) = finish(&m.specular_finish, texture);
    let surface = facets(roughness, anisotropy);
    out.push(GlossLobe { glass, surface }, light.weight, at.frame, at.frame.n);
    let taken = match surface {
        Some(surface) => m.gloss.at(&surface, cos) * m.specular.weight_at(texture),
        None => fresnel::dielectric(cos, glass.eta).reflectance,
    };
    let color = m.base.color_at(texture) * m.base.weight_at(texture);
    let deepened = if coated > 0.0 { darkening(m, texture, cos, color, true) } else { Spectrum::ONE };
    let lobe = RoughDiffuseLobe {
        reflectance: color * deepened * light.tint,
        roughness: texture.float(m.diffuse_roughness).clamp(0.0, 1.0),
    };
    out.push(lobe, light.weight * (1.0 - taken).max(0.0), at.frame, at.frame.n);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_of_gloss_scales_its_reflectance() {
        for weight in [0.25_f32, 0.5, 1.0] {
            let f0 = |ior: f32| ((ior - 1.0) / (ior + 1.0)).powi(2);
            assert!((f0(modulated(1.5, weight)) - weight * f0(1.5)).abs() < 1e-6);
        }
    }

    #[test]
    fn facets_keep_their_mean_roughness() {
        let surface = facets(0.6, 0.5).unwrap();
        let mean = (0.5 * (surface.alpha_u.powi(2) + surface.alpha_v.powi(2))).sqrt();
        assert!((mean - 0.36).abs() < 1e-4, "{surface:?}");
        assert!(facets(0.0, 0.0).is_none());
    }
}
