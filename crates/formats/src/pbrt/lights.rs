//! Lights.

use std::f64::consts::PI;

use aureole_desc::{Family, NodeId, Params, SceneError, Value};
use aureole_math::{Transform, Vector3};
use aureole_spectrum::{SpectrumRole, SpectrumSource, luminance};

use super::params::ParamSet;
use super::shapes::towards;
use super::state::Reader;
use crate::mesh::ies;

impl Reader<'_, '_> {
    pub(super) fn light(&mut self, kind: &str, given: &ParamSet) -> Result<(), SceneError> {
        let at = given.span;
        let ctm = self.ctm(at)?;
        let mut params = Params::new();
        let name = match kind {
            "point" => self.point(given, &mut params)?,
            "spot" => self.spot(given, &mut params)?,
            "distant" => self.distant(given, &mut params)?,
            "infinite" => self.infinite(given, &mut params)?,
            "goniometric" => self.goniometric(given, &mut params)?,
            "projection" => self.projection(given, &mut params)?,
            _ => {
                let known = ["distant", "goniometric", "infinite", "point", "projection", "spot"];
                let known = known.map(str::to_owned).to_vec();
                return Err(SceneError::UnknownKind {
                    family: Family::Light,
                    kind: kind.to_owned(),
                    known,
                    at,
                });
            }
        };
        // A light that points somewhere has put that into a transform of its own.
        let own = params.transform("world_from_light")?;
        params.push("world_from_light", Value::Transform(ctm * own), at);
        given.finish(&format!("light `{kind}`"), self.context.report);
        let id = self.add(Family::Light, name, params, at);
        self.desc.lights.push(id);
        Ok(())
    }

    /// `scale`, and what `power` makes of it when the light's power per unit of intensity is known.
    fn strength(&mut self, given: &ParamSet, power_per_unit: f64) -> Result<f64, SceneError> {
        let scale = given.float("scale", 1.0)?;
        Ok(match given.try_float("power")?.filter(|power| *power > 0.0) {
            Some(power) => scale * power / power_per_unit,
            None => scale,
        })
    }

    /// The power that a light is scaled to, if one is given: pbrt leaves the factors of colour and `scale` on top.
    fn power(&mut self, given: &ParamSet, color: &SpectrumSource) -> Result<f64, SceneError> {
        let factor = luminance(color.to_rgb(SpectrumRole::Illuminant));
        Ok(given.float("power", 0.0)?.max(0.0) * f64::from(factor))
    }

    fn point(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let strength = self.strength(given, 4.0 * PI)?;
        params.push("intensity", Value::Spectrum(given.light("I", strength, self)?), given.at("I"));
        params.push("position", Value::Vec3(given.point3("from", [0.0; 3])?), given.at("from"));
        Ok("point")
    }

    fn spot(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let at = given.span;
        let (from, to) = (given.point3("from", [0.0; 3])?, given.point3("to", [0.0, 0.0, 1.0])?);
        let place =
            towards(from, to).ok_or_else(|| SceneError::invalid("`from` and `to` must differ", at))?;
        let cone = given.float("coneangle", 30.0)?;
        let beam = cone - given.float("conedeltaangle", 5.0)?;
        // The cone's solid angle, its soft edge counted by half.
        let solid_angle = 2.0
            * PI
            * ((1.0 - beam.to_radians().cos()) + (beam.to_radians().cos() - cone.to_radians().cos()) / 2.0);
        let strength = self.strength(given, solid_angle)?;
        params.push("intensity", Value::Spectrum(given.light("I", strength, self)?), at);
        params.push("cutoff_angle", Value::Float(cone), at);
        params.push("beam_width", Value::Float(beam.max(0.0)), at);
        params.push("falloff", Value::String("smoothstep".into()), at);
        params.push("world_from_light", Value::Transform(place), at);
        Ok("spot")
    }

    fn goniometric(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let at = given.at("filename");
        let scale = given.float("scale", 1.0)?;
        let intensity = given.light("I", scale, self)?;
        let power = self.power(given, &intensity)?;
        let Some(path) = given.path("filename", self)? else {
            self.warn("a goniometric light without a `filename` shines evenly", given.span);
            params.push("intensity", Value::Spectrum(intensity), given.at("I"));
            return Ok("point");
        };
        params.push("intensity", Value::Spectrum(intensity), given.at("I"));
        params.push("power", Value::Float(power), given.at("power"));
        // The picture's middle is towards +Y in pbrt, as is straight up of a luminaire's profile.
        if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("ies")) {
            let profile = ies::read(&path, self.limits(), at)?;
            params.push("vertical", Value::Floats(profile.vertical.into()), at);
            params.push("horizontal", Value::Floats(profile.horizontal.into()), at);
            params.push("candela", Value::Floats(profile.candela.into()), at);
            let down = Transform::rotate(Vector3::X, 90.0);
            params.push("world_from_light", Value::Transform(down), at);
        } else {
            params.push("filename", Value::Path(path), at);
            let [x, y, z, w] =
                [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
            let swapped = Transform::from_rows([x, y, z, w]).unwrap_or_default();
            params.push("world_from_light", Value::Transform(swapped), at);
        }
        Ok("goniometric")
    }

    fn projection(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let at = given.span;
        let path = given.path("filename", self)?.ok_or_else(|| SceneError::MissingParam {
            element: "projection".into(),
            param: "filename".into(),
            wanted: "a picture file".into(),
            at,
        })?;
        let picture = Params::new()
            .with("filename", Value::Path(path))
            .with("filter", Value::String("nearest".into()))
            .with("wrap", Value::String("clamp".into()));
        let slide = self.add(Family::Texture, "bitmap", picture, given.at("filename"));
        let scale = given.float("scale", 1.0)?;
        params.push("irradiance", Value::Node(slide), given.at("filename"));
        params.push("measure", Value::String("intensity".into()), at);
        params.push("scale", Value::Float(scale), given.at("scale"));
        params.push("power", Value::Float(given.float("power", 0.0)? * scale), given.at("power"));
        params.push("fov", Value::Float(given.float("fov", 90.0)?), given.at("fov"));
        params.push("fov_axis", Value::String("smaller".into()), at);
        // pbrt's screen has +X to the right.
        let mirror = Transform::scale(Vector3::new(-1.0, 1.0, 1.0));
        params.push("world_from_light", Value::Transform(mirror), at);
        Ok("projector")
    }

    fn distant(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let at = given.span;
        let (from, to) = (given.point3("from", [0.0; 3])?, given.point3("to", [0.0, 0.0, 1.0])?);
        let travels: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
        let scale =
            given.float("scale", 1.0)? * given.try_float("illuminance")?.filter(|e| *e > 0.0).unwrap_or(1.0);
        params.push("direction", Value::Vec3(travels), at);
        params.push("irradiance", Value::Spectrum(given.light("L", scale, self)?), at);
        Ok("directional")
    }

    fn infinite(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let at = given.span;
        let mut scale = given.float("scale", 1.0)?;
        let illuminance = given.try_float("illuminance")?.filter(|e| *e > 0.0);
        let file = given.path("filename", self)?;
        if file.is_some() && given.get("L").is_some() {
            return Err(SceneError::invalid("`L` and `filename` cannot both be given", given.at("L")));
        }
        let portal = given.floats("portal")?;
        match file {
            None if portal.is_none() => {
                // Even surroundings of radiance one give a surface π.
                scale *= illuminance.map_or(1.0, |e| e / PI);
                params.push("radiance", Value::Spectrum(given.light("L", scale, self)?), at);
                return Ok("constant");
            }
            None => {
                // To pbrt a picture of one texel, whose illuminance it takes to be 2π times its luminance.
                if let Some(illuminance) = illuminance {
                    let one = given.light("L", 1.0, self)?.to_rgb(SpectrumRole::Illuminant);
                    scale *= illuminance / (2.0 * PI * f64::from(luminance(one).max(f32::MIN_POSITIVE)));
                }
                params.push("tint", Value::Spectrum(given.light("L", scale, self)?), given.at("L"));
            }
            Some(path) => {
                if let Some(illuminance) = illuminance {
                    // pbrt takes the upper half of the picture for the whole sphere: what it shows is twice as bright.
                    params.push("illuminance", Value::Float(2.0 * illuminance), given.at("illuminance"));
                }
                params.push("filename", Value::Path(path), given.at("filename"));
                params.push("scale", Value::Float(scale), at);
                params.push("mapping", Value::String("equal_area".into()), at);
                params.push("filter", Value::String("nearest".into()), at);
            }
        }
        let Some(corners) = portal else { return Ok("envmap") };
        // Corners are in the world, whatever the current transform is.
        params.push("portal", Value::Floats(corners.into()), given.at("portal"));
        Ok("portal_envmap")
    }

    /// The emission of shapes below an `AreaLightSource`.
    pub(super) fn area_light(&mut self, given: &ParamSet) -> Result<NodeId, SceneError> {
        let at = given.span;
        let scale = given.float("scale", 1.0)?;
        let mut params = Params::new();
        let file = given.path("filename", self)?;
        if file.is_some() && given.get("L").is_some() {
            return Err(SceneError::invalid("`L` and `filename` cannot both be given", given.at("L")));
        }
        let radiance = match file {
            Some(path) => {
                let mut picture = Params::new();
                picture.push("filename", Value::Path(path), given.at("filename"));
                picture.push("scale", Value::Float(scale), at);
                params.push("power", Value::Float(given.float("power", 0.0)? * scale), given.at("power"));
                Value::Node(self.add(Family::Texture, "bitmap", picture, at))
            }
            None => {
                let radiance = given.light("L", scale, self)?;
                params.push("power", Value::Float(self.power(given, &radiance)?), given.at("power"));
                Value::Spectrum(radiance)
            }
        };
        params.push("radiance", radiance, at);
        if given.get("power").is_some() {
            params.push("power_of", Value::String("primitive".into()), given.at("power"));
        }
        params.push("two_sided", Value::Bool(given.bool("twosided", false)?), at);
        given.finish("AreaLightSource", self.context.report);
        Ok(self.add(Family::Light, "area", params, at))
    }
}
