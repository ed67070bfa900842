//! Materials of OBJ libraries as BSDFs.

use std::path::Path;

use aureole_desc::{Family, Mesh, Node, NodeId, Params, Report, SceneDesc, Span, Value};
use aureole_math::{Transform, Vector3};
use aureole_spectrum::SpectrumSource;

use super::lookup;
use crate::mesh::colors;
use crate::mesh::obj::{ObjMaterial, TextureMap};

/// A material's nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Made {
    pub(super) bsdf: NodeId,
    /// The light on a surface that shines.
    pub(super) emission: Option<NodeId>,
}

/// A diffuse material that can be seen from both sides: who knows how a file's faces are turned.
pub(super) fn two_sided_diffuse(scene: &mut SceneDesc, reflectance: Value, at: Span) -> NodeId {
    let params = Params::new().with("reflectance", reflectance);
    let diffuse = scene.add(Node::new(Family::Bsdf, "diffuse", params, at));
    wrap(scene, "two_sided", diffuse, Params::new(), at)
}

/// The attribute with the colours that a mesh has of its own, from 0 to 1.
pub(super) fn own_colors(mesh: &mut Mesh) -> Option<&'static str> {
    let known = ["vertex_color", "face_color", "vertex_diffuse"];
    let is_there = |name: &&str| mesh.attributes.iter().any(|attribute| attribute.name == *name);
    let name = known.into_iter().find(is_there)?;
    let colors = mesh.attributes.iter_mut().find(|attribute| attribute.name == name)?;
    // Some programs write bytes as floating-point numbers.
    let span = colors::span(colors.data.iter().copied(), 65_535.0);
    colors.data.iter_mut().for_each(|value| *value /= span);
    Some(name)
}

fn wrap(scene: &mut SceneDesc, kind: &str, inner: NodeId, params: Params, at: Span) -> NodeId {
    scene.add(Node::new(Family::Bsdf, kind, params.with("bsdf", Value::Node(inner)), at))
}

fn color(rgb: [f32; 3]) -> Value {
    Value::Spectrum(SpectrumSource::Rgb(rgb))
}

fn brightest(rgb: Option<[f32; 3]>) -> f32 {
    rgb.map_or(0.0, |rgb| rgb.into_iter().fold(0.0, f32::max))
}

/// What is needed to make nodes.
pub(super) struct Maker<'a> {
    pub(super) scene: &'a mut SceneDesc,
    /// Where textures are looked for.
    pub(super) folder: &'a Path,
    pub(super) report: &'a mut Report,
    pub(super) at: Span,
}

impl Maker<'_> {
    /// Makes the nodes of a material, or of none, for a mesh with colours of its own, where it has any.
    pub(super) fn make(&mut self, material: Option<&ObjMaterial>, colors: Option<&'static str>) -> Made {
        let Some(material) = material else {
            let reflectance = self.own_colors(colors, Value::Float(0.7));
            return Made { bsdf: two_sided_diffuse(self.scene, reflectance, self.at), emission: None };
        };
        let bsdf = self.bsdf(material, colors);
        self.scene[bsdf].name = Some(material.name.clone());
        Made { bsdf, emission: self.emission(material) }
    }

    /// A mesh's own colours, or another value.
    pub(super) fn own_colors(&mut self, attribute: Option<&str>, otherwise: Value) -> Value {
        let Some(name) = attribute else { return otherwise };
        let params = Params::new().with("name", Value::String(name.to_owned()));
        Value::Node(self.scene.add(Node::new(Family::Texture, "mesh_attribute", params, self.at)))
    }

    /// The surface, then bumps, then holes.
    fn bsdf(&mut self, material: &ObjMaterial, colors: Option<&str>) -> NodeId {
        let mut bsdf = if refracts(material) { self.glass(material) } else { self.opaque(material, colors) };
        let at = self.at;
        if let Some(texture) = material.bump_map.as_ref().and_then(|map| self.shape_texture(map)) {
            let scale = material.bump_map.as_ref().map_or(1.0, |map| f64::from(map.bump_scale));
            let params =
                Params::new().with("texture", Value::Node(texture)).with("scale", Value::Float(scale));
            bsdf = wrap(self.scene, "bump", bsdf, params, at);
        }
        if let Some(texture) = material.normal_map.as_ref().and_then(|map| self.shape_texture(map)) {
            bsdf =
                wrap(self.scene, "normal_map", bsdf, Params::new().with("texture", Value::Node(texture)), at);
        }
        if !refracts(material) {
            bsdf = wrap(self.scene, "two_sided", bsdf, Params::new(), at);
        }
        match self.opacity(material) {
            Some(opacity) => wrap(self.scene, "mask", bsdf, Params::new().with("opacity", opacity), at),
            None => bsdf,
        }
    }

    fn glass(&mut self, material: &ObjMaterial) -> NodeId {
        let ior = material.ior.filter(|ior| *ior > 1.0).unwrap_or(1.5);
        let params = Params::new()
            .with("int_ior", Value::Float(ior.into()))
            .with("ext_ior", Value::Float(1.0))
            .with("specular_transmittance", color(material.transmission.unwrap_or([1.0; 3])));
        self.scene.add(Node::new(Family::Bsdf, "dielectric", params, self.at))
    }

    fn opaque(&mut self, material: &ObjMaterial, colors: Option<&str>) -> NodeId {
        let diffuse = match &material.diffuse_map {
            Some(map) => Value::Node(self.texture(map, "auto")),
            None => self.own_colors(colors, color(material.diffuse.unwrap_or([0.6; 3]))),
        };
        let specular = match &material.specular_map {
            Some(map) => Value::Node(self.texture(map, "auto")),
            None => color(material.specular.unwrap_or([1.0; 3])),
        };
        let shines = material.specular_map.is_some() || brightest(material.specular) > 0.0;
        let alpha = roughness(material);
        let is_smooth = alpha < 0.01;
        let mut params = Params::new();
        let is_mirror = matches!(material.model, Some(3 | 5)) && brightest(material.diffuse) < 0.01;
        let kind = if material.metallic.is_some_and(|metallic| metallic > 0.5) || is_mirror {
            params.push("material", Value::String("none".to_owned()), self.at);
            let tint = if is_mirror { specular } else { diffuse };
            params.push("specular_reflectance", tint, self.at);
            if is_smooth { "conductor" } else { "rough_conductor" }
        } else if shines && material.model != Some(1) {
            params.push("diffuse_reflectance", diffuse, self.at);
            params.push("specular_reflectance", specular, self.at);
            if is_smooth { "plastic" } else { "rough_plastic" }
        } else {
            params.push("reflectance", diffuse, self.at);
            "diffuse"
        };
        if kind.starts_with("rough") {
            params.push("alpha", Value::Float(alpha.into()), self.at);
            params.push("distribution", Value::String("ggx".to_owned()), self.at);
        }
        self.scene.add(Node::new(Family::Bsdf, kind, params, self.at))
    }

    /// How much of the surface is there, unless all of it.
    fn opacity(&mut self, material: &ObjMaterial) -> Option<Value> {
        if let Some(map) = &material.opacity_map {
            let texture = self.shape_texture(map)?;
            // A picture that has colours too keeps the opacity in its fourth channel.
            let has_colors = material.diffuse_map.as_ref().is_some_and(|diffuse| diffuse.file == map.file);
            if map.alpha || has_colors {
                self.scene[texture].params.push("channel", Value::String("alpha".to_owned()), self.at);
            }
            return Some(Value::Node(texture));
        }
        let opacity = material.opacity.filter(|opacity| (0.0..1.0).contains(opacity));
        opacity.filter(|_| !refracts(material)).map(|opacity| Value::Float(opacity.into()))
    }

    fn emission(&mut self, material: &ObjMaterial) -> Option<NodeId> {
        let map = material.emission_map.as_ref().map(|map| self.texture(map, "auto"));
        let radiance = match (map, material.emission) {
            (Some(texture), _) => Value::Node(texture),
            (None, emission) if brightest(emission) > 0.0 => color(emission.unwrap_or_default()),
            _ => return None,
        };
        let params = Params::new().with("radiance", radiance).with("two_sided", Value::Bool(true));
        Some(self.scene.add(Node::new(Family::Light, "area", params, self.at)))
    }

    /// A texture of what a surface is like or where it is; none, with a warning, where there is no such file.
    fn shape_texture(&mut self, map: &TextureMap) -> Option<NodeId> {
        if lookup::find(self.folder, &map.file).is_none() {
            let file = self.folder.join(&map.file);
            self.report.warn(format!("there is no texture `{}`: it is left out", file.display()), self.at);
            return None;
        }
        Some(self.texture(map, "linear"))
    }

    /// A texture node. Where there is no such file, a placeholder will be seen.
    pub(super) fn texture(&mut self, map: &TextureMap, encoding: &str) -> NodeId {
        let path = lookup::find(self.folder, &map.file).unwrap_or_else(|| self.folder.join(&map.file));
        let [su, sv] = map.scale;
        let [ou, ov] = map.offset;
        let to_uv =
            Transform::translate(Vector3::new(ou, ov, 0.0)) * Transform::scale(Vector3::new(su, sv, 1.0));
        let wrap = if map.clamp { "clamp" } else { "repeat" };
        let mut params = Params::new()
            .with("filename", Value::Path(path))
            .with("encoding", Value::String(encoding.to_owned()))
            .with("wrap", Value::String(wrap.to_owned()));
        if !to_uv.is_identity() && to_uv.is_invertible() {
            params.push("to_uv", Value::Transform(to_uv), self.at);
        }
        if map.invert {
            params.push("invert", Value::Bool(true), self.at);
        }
        self.scene.add(Node::new(Family::Texture, "bitmap", params, self.at))
    }
}

/// Whether light goes through and is bent: the illumination models for refraction, or a filter with an index.
fn refracts(material: &ObjMaterial) -> bool {
    let is_clear = material.opacity.is_some_and(|opacity| opacity < 0.5);
    let has_index = material.ior.is_some_and(|ior| ior > 1.01);
    matches!(material.model, Some(4 | 6 | 7)) || (is_clear && has_index && material.opacity_map.is_none())
}

/// The roughness of the microfacets whose highlight is as wide as that of the Phong exponent: α² = 2 / (n + 2)
/// [Walter et al. 2007, section 5.2].
fn roughness(material: &ObjMaterial) -> f32 {
    match (material.roughness, material.exponent) {
        (Some(roughness), _) => (roughness * roughness).clamp(0.0, 1.0),
        (None, exponent) => (2.0 / (exponent.unwrap_or(20.0).max(0.0) + 2.0)).sqrt(),
    }
}
