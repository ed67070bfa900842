//! Materials. In pbrt they look the same from both sides.

use aureole_desc::{Family, NodeId, Params, SceneError, Value};
use aureole_spectrum::{SpectrumRole, SpectrumSource, named_spectrum};

use super::params::ParamSet;
use super::state::{Reader, TextureType, unknown};
use crate::brdf;

const KINDS: &[&str] = &[
    "coatedconductor",
    "coateddiffuse",
    "conductor",
    "dielectric",
    "diffuse",
    "diffusetransmission",
    "hair",
    "interface",
    "measured",
    "mix",
    "none",
    "subsurface",
    "thindielectric",
];

/// Parameters that are numbers; the others are colours.
const NUMBERS: [&str; 8] = ["alpha", "beta_m", "beta_n", "eta", "eumelanin", "g", "pheomelanin", "thickness"];

impl Reader<'_, '_> {
    pub(super) fn named_material(&mut self, name: &str, at: aureole_desc::Span) -> Result<(), SceneError> {
        let found = self.material_by_name(name, at)?;
        self.state.material = Some(found);
        Ok(())
    }

    fn material_by_name(&self, name: &str, at: aureole_desc::Span) -> Result<NodeId, SceneError> {
        self.materials
            .get(name)
            .copied()
            .ok_or_else(|| unknown("named material", name, self.materials.keys(), at))
    }

    pub(super) fn make_named_material(&mut self, name: &str, given: &ParamSet) -> Result<(), SceneError> {
        let kind = given.text("type")?.ok_or_else(|| SceneError::MissingParam {
            element: "MakeNamedMaterial".into(),
            param: "type".into(),
            wanted: "the material's kind as a string".into(),
            at: given.span,
        })?;
        let id = self.material(kind, given)?;
        self.desc[id].name = Some(name.to_owned());
        self.materials.insert(name.to_owned(), id);
        Ok(())
    }

    /// Builds a material with its bumps, for both sides.
    pub(super) fn material(&mut self, kind: &str, given: &ParamSet) -> Result<NodeId, SceneError> {
        let at = given.span;
        let (name, params) = match kind {
            "diffuse" => ("diffuse", self.copied(given, &[("reflectance", "reflectance")])?),
            "conductor" => self.conductor(given)?,
            "dielectric" => self.dielectric(given)?,
            "thindielectric" => ("thin_dielectric", self.index(given)?),
            "diffusetransmission" => self.diffuse_transmission(given)?,
            "coateddiffuse" => self.coated_diffuse(given)?,
            "mix" => self.mix(given)?,
            "interface" | "none" | "" => ("null", Params::new()),
            "coatedconductor" => self.coated_conductor(given)?,
            "hair" => ("hair", self.hair(given)?),
            "measured" => self.measured(given)?,
            "subsurface" => self.subsurface(given)?,
            _ => {
                let known = KINDS.iter().map(|k| (*k).to_owned()).collect();
                return Err(SceneError::UnknownKind {
                    family: Family::Bsdf,
                    kind: kind.to_owned(),
                    known,
                    at,
                });
            }
        };
        let mut id = self.add(Family::Bsdf, name, params, at);
        // Sides are those of the bent surface.
        if matches!(name, "diffuse" | "conductor" | "rough_conductor" | "measured" | "merl") {
            id = self.add(Family::Bsdf, "two_sided", Params::new().with("bsdf", Value::Node(id)), at);
        }
        id = self.bumps(id, given)?;
        given.finish(&format!("material `{kind}`"), self.context.report);
        Ok(id)
    }

    /// Parameters that are textures or constants under another name.
    fn copied(&self, given: &ParamSet, names: &[(&str, &str)]) -> Result<Params, SceneError> {
        let mut params = Params::new();
        for (theirs, ours) in names {
            let ty = if NUMBERS.contains(theirs) { TextureType::Float } else { TextureType::Spectrum };
            if let Some(value) = given.textured_as(theirs, ty, self)? {
                params.push(*ours, value, given.at(theirs));
            }
        }
        Ok(params)
    }

    /// `normalmap` and `displacement`, which any material may have.
    fn bumps(&mut self, mut id: NodeId, given: &ParamSet) -> Result<NodeId, SceneError> {
        if let Some(path) = given.path("normalmap", self)? {
            let at = given.at("normalmap");
            let mut picture = Params::new();
            picture.push("filename", Value::Path(path), at);
            picture.push("encoding", Value::String("linear".into()), at);
            let texture = self.add(Family::Texture, "bitmap", picture, at);
            id = self.bent("normal_map", texture, id, at);
        }
        if let Some(Value::Node(texture)) = given.textured_float("displacement", self)? {
            if given.get("normalmap").is_some() {
                self.warn("`normalmap` counts, `displacement` does not", given.at("displacement"));
                return Ok(id);
            }
            id = self.bent("bump", texture, id, given.at("displacement"));
            self.desc[id].params.push(
                "tangents",
                Value::String("displaced".into()),
                given.at("displacement"),
            );
        }
        Ok(id)
    }

    fn bent(&mut self, kind: &str, texture: NodeId, material: NodeId, at: aureole_desc::Span) -> NodeId {
        let mut params = Params::new();
        params.push("texture", Value::Node(texture), at);
        params.push("bsdf", Value::Node(material), at);
        // pbrt has none of Mitsuba's corrections.
        params.push("keep_sides", Value::Bool(false), at);
        params.push("flip_invalid_normals", Value::Bool(false), at);
        params.push("soften_terminator", Value::Bool(false), at);
        self.add(Family::Bsdf, kind, params, at)
    }

    /// Roughness along and across the tangent as the microfacets' alpha.
    fn alphas(&mut self, given: &ParamSet, prefix: &str, default: f64) -> Result<[Value; 2], SceneError> {
        let remap = given.bool("remaproughness", true)?;
        let both = given.textured_float(&format!("{prefix}roughness"), self)?;
        let mut alpha = |name: &str| -> Result<Value, SceneError> {
            let value = given.textured_float(&format!("{prefix}{name}"), self)?.or_else(|| both.clone());
            let value = value.unwrap_or(Value::Spectrum(SpectrumSource::Uniform(default as f32)));
            Ok(match value {
                Value::Spectrum(constant) => {
                    let r = constant.to_rgb(SpectrumRole::Unbounded)[0];
                    Value::Float(f64::from(if remap { r.max(0.0).sqrt() } else { r }))
                }
                Value::Node(texture) if remap => {
                    let params = Params::new()
                        .with("texture", Value::Node(texture))
                        .with("exponent", Value::Float(0.5));
                    Value::Node(self.add(Family::Texture, "power", params, given.span))
                }
                other => other,
            })
        };
        Ok([alpha("uroughness")?, alpha("vroughness")?])
    }

    /// Roughness as the microfacets' alpha; `None` for a smooth surface.
    fn roughness(&mut self, given: &ParamSet, default: f64) -> Result<Option<[Value; 2]>, SceneError> {
        let is_smooth = |value: &Value| matches!(value, Value::Float(alpha) if *alpha < 1e-3);
        let alphas = self.alphas(given, "", default)?;
        Ok(if alphas.iter().all(is_smooth) { None } else { Some(alphas) })
    }

    fn rough(params: &mut Params, [u, v]: [Value; 2], at: aureole_desc::Span) {
        params.push("distribution", Value::String("ggx".into()), at);
        params.push("shadowing", Value::String("height_correlated".into()), at);
        params.push("alpha_u", u, at);
        params.push("alpha_v", v, at);
    }

    /// What a metal is made of: an index, or a reflectance.
    fn metal(&mut self, given: &ParamSet, prefix: &str) -> Result<Params, SceneError> {
        let mut params = self.copied(given, &[("reflectance", "reflectance")])?;
        for (ours, default) in [("eta", "metal-Cu-eta"), ("k", "metal-Cu-k")] {
            let theirs = format!("{prefix}{ours}");
            let value = given.textured(&theirs, self)?;
            if params.has("reflectance") {
                if value.is_some() {
                    let message = format!("`reflectance` and `{theirs}` cannot both be given");
                    return Err(SceneError::invalid(message, given.at(&theirs)));
                }
                continue;
            }
            let default =
                || named_spectrum(default).map(|table| Value::Spectrum(SpectrumSource::Tabulated(table)));
            if let Some(value) = value.or_else(default) {
                params.push(ours, value, given.at(&theirs));
            }
        }
        Ok(params)
    }

    fn conductor(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let at = given.span;
        let mut params = self.metal(given, "")?;
        match self.roughness(given, 0.0)? {
            Some(alphas) => {
                Self::rough(&mut params, alphas, at);
                Ok(("rough_conductor", params))
            }
            None => Ok(("conductor", params)),
        }
    }

    /// The index of a dielectric: a number, or a glass's index near the sodium line.
    fn eta(&mut self, given: &ParamSet, name: &str) -> Result<f64, SceneError> {
        let eta = match given.spectrum(name, self)? {
            Some(SpectrumSource::Tabulated(table)) => {
                self.warn("dispersion needs spectral rendering: the index at 589 nm is used", given.at(name));
                f64::from(table.eval(589.0))
            }
            Some(constant) => f64::from(constant.to_rgb(SpectrumRole::Unbounded)[0]),
            None => 1.5,
        };
        // An index of zero is none at all.
        Ok(if eta == 0.0 { 1.0 } else { eta })
    }

    fn index(&mut self, given: &ParamSet) -> Result<Params, SceneError> {
        let mut params = Params::new();
        params.push("int_ior", Value::Float(self.eta(given, "eta")?), given.span);
        params.push("ext_ior", Value::Float(1.0), given.span);
        Ok(params)
    }

    fn dielectric(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let mut params = self.index(given)?;
        match self.roughness(given, 0.0)? {
            Some(alphas) => {
                Self::rough(&mut params, alphas, given.span);
                Ok(("rough_dielectric", params))
            }
            None => Ok(("dielectric", params)),
        }
    }

    fn diffuse_transmission(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let mut params =
            self.copied(given, &[("reflectance", "reflectance"), ("transmittance", "transmittance")])?;
        let scale = given.float("scale", 1.0)?;
        if scale != 1.0 {
            for name in ["reflectance", "transmittance"] {
                let value = params.get(name).cloned().unwrap_or(Value::Float(0.25));
                let scaled = Params::new().with("texture", value).with("scale", Value::Float(scale));
                let id = self.add(Family::Texture, "scale", scaled, given.span);
                params.push(name, Value::Node(id), given.span);
            }
        }
        Ok(("diffuse_transmission", params))
    }

    /// A coat and the medium below it; `prefix`: of the coat's own parameters.
    fn coat(&mut self, given: &ParamSet, prefix: &str) -> Result<Params, SceneError> {
        let at = given.span;
        let mut params =
            self.copied(given, &[("thickness", "thickness"), ("g", "g"), ("albedo", "albedo")])?;
        params.push("int_ior", Value::Float(self.eta(given, &format!("{prefix}eta"))?), at);
        params.push("ext_ior", Value::Float(1.0), at);
        let [u, v] = self.alphas(given, prefix, 0.0)?;
        params.push("alpha_u", u, at);
        params.push("alpha_v", v, at);
        params.push("max_depth", Value::Int(given.int("maxdepth", 10)?), given.at("maxdepth"));
        params.push("sample_count", Value::Int(given.int("nsamples", 1)?), given.at("nsamples"));
        Ok(params)
    }

    fn coated_diffuse(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let mut params = self.coat(given, "")?;
        if let Some(reflectance) = given.textured("reflectance", self)? {
            params.push("reflectance", reflectance, given.at("reflectance"));
        }
        Ok(("coated_diffuse", params))
    }

    fn coated_conductor(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let mut params = self.coat(given, "interface.")?;
        for param in self.metal(given, "conductor.")?.iter() {
            params.set(param.clone());
        }
        let [u, v] = self.alphas(given, "conductor.", 0.0)?;
        params.push("base_alpha_u", u, given.span);
        params.push("base_alpha_v", v, given.span);
        Ok(("coated_conductor", params))
    }

    fn measured(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let at = given.at("filename");
        let path = given.path("filename", self)?.ok_or_else(|| SceneError::MissingParam {
            element: "material `measured`".into(),
            param: "filename".into(),
            wanted: "a file of a measured reflectance".into(),
            at,
        })?;
        brdf::read(&path, &self.context.options.limits, at)
    }

    fn hair(&mut self, given: &ParamSet) -> Result<Params, SceneError> {
        let names =
            ["sigma_a", "reflectance", "eumelanin", "pheomelanin", "eta", "beta_m", "beta_n", "alpha"];
        let mut params = self.copied(given, &names.map(|name| (name, name)))?;
        let colour = given.textured("color", self)?; // an older name
        if let Some(colour) = colour.filter(|_| !params.has("reflectance")) {
            params.push("reflectance", colour, given.at("color"));
        }
        Ok(params)
    }

    fn mix(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let at = given.at("materials");
        let names: Vec<String> = match given.get("materials").map(|p| &p.values) {
            Some(super::params::Values::Texts(names)) if names.len() == 2 => names.clone(),
            _ => return Err(SceneError::invalid("`mix` needs `materials`: the names of two materials", at)),
        };
        let mut params = Params::new();
        params.push("a", Value::Node(self.material_by_name(&names[0], at)?), at);
        params.push("b", Value::Node(self.material_by_name(&names[1], at)?), at);
        params.push("weight", given.textured_float("amount", self)?.unwrap_or(Value::Float(0.5)), at);
        Ok(("blend", params))
    }

    /// A body that scatters inside. As in pbrt, light leaves it in directions that do not depend on how it came.
    fn subsurface(&mut self, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let at = given.span;
        let names = ["sigma_a", "sigma_s", "reflectance", "mfp"];
        let mut params = self.copied(given, &names.map(|name| (name, name)))?;
        if params.has("sigma_a") != params.has("sigma_s") && given.get("name").is_none() {
            return Err(SceneError::invalid("`sigma_a` and `sigma_s` are given together or not at all", at));
        }
        if let Some(name) = given.text("name")?.filter(|name| !name.is_empty()) {
            params.push("name", Value::String(name.to_owned()), given.at("name"));
            // A name decides alone.
            for other in names {
                params.take(other);
            }
        }
        for (name, default) in [("g", 0.0), ("scale", 1.0)] {
            params.push(name, Value::Float(given.float(name, default)?), given.at(name));
        }
        let eta = if given.get("eta").is_some() { self.eta(given, "eta")? } else { 1.33 };
        params.push("int_ior", Value::Float(eta), at);
        params.push("ext_ior", Value::Float(1.0), at);
        let [u, v] = self.alphas(given, "", 0.0)?;
        params.push("alpha_u", u, at);
        params.push("alpha_v", v, at);
        params.push("exit", Value::String("diffuse".into()), at);
        Ok(("subsurface", params))
    }
}
