//! Materials of OBJ libraries as BSDFs.

use std::path::Path;

use aureole_desc::{Family, Node, NodeId, Params, Report, SceneDesc, Span, Value};
use aureole_math::{Transform, Vector3};
use aureole_spectrum::SpectrumSource;

use crate::file::SearchPath;
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

/// For faces without a material.
pub(super) fn default(scene: &mut SceneDesc, at: Span) -> Made {
    Made { bsdf: two_sided_diffuse(scene, Value::Float(0.7), at), emission: None }
}

/// Makes a material's nodes; its textures are looked for in `folder`.
pub(super) fn make(
    scene: &mut SceneDesc,
    material: &ObjMaterial,
    folder: &Path,
    report: &mut Report,
    at: Span,
) -> Made {
    let mut maker = Maker { scene, folder, report, at };
    let bsdf = maker.bsdf(material);
    maker.scene[bsdf].name = Some(material.name.clone());
    Made { bsdf, emission: maker.emission(material) }
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
struct Maker<'a> {
    scene: &'a mut SceneDesc,
    folder: &'a Path,
    report: &'a mut Report,
    at: Span,
}

impl Maker<'_> {
    /// The surface, then bumps, then holes.
    fn bsdf(&mut self, material: &ObjMaterial) -> NodeId {
        let mut bsdf = if refracts(material) { self.glass(material) } else { self.opaque(material) };
        let at = self.at;
        if let Some(texture) = material.bump_map.as_ref().and_then(|map| self.texture(map, "linear")) {
            let scale = material.bump_map.as_ref().map_or(1.0, |map| f64::from(map.bump_scale));
            let params =
                Params::new().with("texture", Value::Node(texture)).with("scale", Value::Float(scale));
            bsdf = wrap(self.scene, "bump", bsdf, params, at);
        }
        if let Some(texture) = material.normal_map.as_ref().and_then(|map| self.texture(map, "linear")) {
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

    fn opaque(&mut self, material: &ObjMaterial) -> NodeId {
        let diffuse = match material.diffuse_map.as_ref().and_then(|map| self.texture(map, "auto")) {
            Some(texture) => Value::Node(texture),
            None => color(material.diffuse.unwrap_or([0.6; 3])),
        };
        let alpha = roughness(material);
        let is_smooth = alpha < 0.01;
        let mut params = Params::new();
        let is_mirror = matches!(material.model, Some(3 | 5)) && brightest(material.diffuse) < 0.01;
        let kind = if material.metallic.is_some_and(|metallic| metallic > 0.5) || is_mirror {
            params.push("material", Value::String("none".to_owned()), self.at);
            let tint = if is_mirror { color(material.specular.unwrap_or([1.0; 3])) } else { diffuse };
            params.push("specular_reflectance", tint, self.at);
            if is_smooth { "conductor" } else { "rough_conductor" }
        } else if brightest(material.specular) > 0.0 && material.model != Some(1) {
            params.push("diffuse_reflectance", diffuse, self.at);
            params.push("specular_reflectance", color(material.specular.unwrap_or([1.0; 3])), self.at);
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
            let texture = self.texture(map, "linear")?;
            // A picture that has colours too keeps the opacity in its fourth channel.
            if material.diffuse_map.as_ref().is_some_and(|diffuse| diffuse.file == map.file) {
                self.scene[texture].params.push("channel", Value::String("alpha".to_owned()), self.at);
            }
            return Some(Value::Node(texture));
        }
        let opacity = material.opacity.filter(|opacity| (0.0..1.0).contains(opacity));
        opacity.filter(|_| !refracts(material)).map(|opacity| Value::Float(opacity.into()))
    }

    fn emission(&mut self, material: &ObjMaterial) -> Option<NodeId> {
        let map = material.emission_map.as_ref().and_then(|map| self.texture(map, "auto"));
        let radiance = match (map, material.emission) {
            (Some(texture), _) => Value::Node(texture),
            (None, emission) if brightest(emission) > 0.0 => color(emission.unwrap_or_default()),
            _ => return None,
        };
        let params = Params::new().with("radiance", radiance).with("two_sided", Value::Bool(true));
        Some(self.scene.add(Node::new(Family::Light, "area", params, self.at)))
    }

    /// A texture node; a missing file is a warning.
    fn texture(&mut self, map: &TextureMap, encoding: &str) -> Option<NodeId> {
        let mut search = SearchPath::default();
        search.push_back(self.folder.to_owned());
        let path = search.resolve(&map.file);
        if !path.exists() {
            self.report.warn(format!("there is no texture `{}`", path.display()), self.at);
            return None;
        }
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
        Some(self.scene.add(Node::new(Family::Texture, "bitmap", params, self.at)))
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
