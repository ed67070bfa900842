//! Textures.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use aureole_desc::{Family, Params, SceneError, Span, Value};
use aureole_math::{Transform, Vector3};
use aureole_spectrum::SpectrumSource;

use super::params::ParamSet;
use super::state::{Reader, TextureType};

impl Reader<'_, '_> {
    pub(super) fn texture_directive(
        &mut self,
        name: String,
        value_type: &str,
        class: &str,
        given: &ParamSet,
    ) -> Result<(), SceneError> {
        let at = given.span;
        if !matches!(value_type, "float" | "spectrum") {
            let message = format!("a texture is `float` or `spectrum`, not `{value_type}`");
            return Err(SceneError::syntax(message, at));
        }
        let ty = if value_type == "float" { TextureType::Float } else { TextureType::Spectrum };
        let (kind, params) = match class {
            "constant" => ("constant", self.slots(given, ty, &[("value", "value", 1.0)])?),
            "scale" => ("scale", self.slots(given, ty, &[("tex", "texture", 1.0), ("scale", "scale", 1.0)])?),
            "mix" => (
                "mix",
                self.slots(given, ty, &[("tex1", "a", 0.0), ("tex2", "b", 1.0), ("amount", "amount", 0.5)])?,
            ),
            "bilerp" => {
                let corners =
                    [("v00", "v00", 0.0), ("v01", "v01", 1.0), ("v10", "v10", 0.0), ("v11", "v11", 1.0)];
                let mut params = self.slots(given, ty, &corners)?;
                self.mapping(given, Transform::IDENTITY, &mut params)?;
                ("bilerp", params)
            }
            "checkerboard" => {
                let mut params =
                    self.slots(given, ty, &[("tex1", "color0", 1.0), ("tex2", "color1", 0.0)])?;
                // pbrt's squares are one unit wide, Aureole's half a unit.
                let half = Transform::scale(Vector3::new(0.5, 0.5, 0.5));
                match given.int("dimension", 2)? {
                    2 => self.mapping(given, half, &mut params)?,
                    3 => {
                        params.push("dimension", Value::Int(3), at);
                        self.place_texture(half, at, &mut params)?;
                    }
                    _ => {
                        let message = "a checkerboard has two or three dimensions";
                        return Err(SceneError::invalid(message, given.at("dimension")));
                    }
                }
                ("checkerboard", params)
            }
            "imagemap" => ("bitmap", self.image(given, ty)?),
            "dots" => {
                // pbrt's pictures have `outside` in the dots and `inside` around them.
                let mut params =
                    self.slots(given, ty, &[("inside", "outside", 1.0), ("outside", "inside", 0.0)])?;
                self.mapping(given, Transform::IDENTITY, &mut params)?;
                ("dots", params)
            }
            "directionmix" => ("direction_mix", self.direction_mix(given, ty)?),
            "fbm" | "wrinkled" | "windy" | "marble" => self.noise(class, given)?,
            "ptex" => {
                self.warn(format!("texture `{class}` is not rendered yet: grey stands in for it"), at);
                given.touch_all();
                ("constant", Params::new().with("value", Value::Float(0.5)))
            }
            _ => {
                let known = [
                    "bilerp",
                    "checkerboard",
                    "constant",
                    "directionmix",
                    "dots",
                    "fbm",
                    "imagemap",
                    "marble",
                    "mix",
                    "ptex",
                    "scale",
                    "windy",
                    "wrinkled",
                ];
                let known = known.map(str::to_owned).to_vec();
                return Err(SceneError::UnknownKind {
                    family: Family::Texture,
                    kind: class.to_owned(),
                    known,
                    at,
                });
            }
        };
        given.finish(&format!("texture `{class}`"), self.context.report);
        let id = self.add(Family::Texture, kind, params, at);
        self.desc[id].name = Some(name.clone());
        self.textures.entry(name).or_default()[ty as usize] = Some(id);
        Ok(())
    }

    /// Parameters that are textures or constants, with pbrt's defaults.
    fn slots(
        &self,
        given: &ParamSet,
        ty: TextureType,
        slots: &[(&str, &str, f32)],
    ) -> Result<Params, SceneError> {
        let mut params = Params::new();
        for (theirs, ours, default) in slots {
            let is_number = matches!(*theirs, "amount" | "scale");
            let value = given.textured_as(theirs, if is_number { TextureType::Float } else { ty }, self)?;
            let value = value.unwrap_or(Value::Spectrum(SpectrumSource::Uniform(*default)));
            params.push(*ours, value, given.at(theirs));
        }
        Ok(params)
    }

    /// Noise in the space of the current transform.
    fn noise(&mut self, class: &str, given: &ParamSet) -> Result<(&'static str, Params), SceneError> {
        let at = given.span;
        let mut params = Params::new();
        self.place_texture(Transform::IDENTITY, at, &mut params)?;
        if class != "windy" {
            params.push("octaves", Value::Int(given.int("octaves", 8)?), given.at("octaves"));
            params.push("roughness", Value::Float(given.float("roughness", 0.5)?), given.at("roughness"));
        }
        if class == "marble" {
            params.push("scale", Value::Float(given.float("scale", 1.0)?), given.at("scale"));
            params.push("variation", Value::Float(given.float("variation", 0.2)?), given.at("variation"));
            return Ok(("marble", params));
        }
        params.push("pattern", Value::String(class.to_owned()), at);
        Ok(("fractal", params))
    }

    fn direction_mix(&mut self, given: &ParamSet, ty: TextureType) -> Result<Params, SceneError> {
        let mut params = self.slots(given, ty, &[("tex1", "a", 0.0), ("tex2", "b", 1.0)])?;
        let direction = given.point3("dir", [0.0, 1.0, 0.0])?.map(|x| x as f32);
        let world = self.ctm(given.span)?.vector(Vector3::from(direction));
        params.push("direction", Value::Vec3([world.x, world.y, world.z].map(f64::from)), given.at("dir"));
        Ok(params)
    }

    /// The way from the world into the texture's space, which is that of the current transform, and on by `then`.
    fn place_texture(&mut self, then: Transform, at: Span, params: &mut Params) -> Result<(), SceneError> {
        let texture_from_world = then * self.ctm(at)?.inverse();
        params.push("texture_from_world", Value::Transform(texture_from_world), at);
        Ok(())
    }

    /// How texture coordinates come about, and `then` applied to them.
    fn mapping(&mut self, given: &ParamSet, then: Transform, params: &mut Params) -> Result<(), SceneError> {
        let at = given.at("mapping");
        let number = |name: &str, default: f64| given.float(name, default).map(|x| x as f32);
        match given.text("mapping")?.unwrap_or("uv") {
            "uv" => {
                let scale = Vector3::new(number("uscale", 1.0)?, number("vscale", 1.0)?, 1.0);
                let shift = Vector3::new(number("udelta", 0.0)?, number("vdelta", 0.0)?, 0.0);
                let scale = Transform::scale(scale);
                if !scale.is_invertible() {
                    return Err(SceneError::invalid("`uscale` and `vscale` must not be zero", given.span));
                }
                let to_uv = then * Transform::translate(shift) * scale;
                params.push("to_uv", Value::Transform(to_uv), at);
                return Ok(());
            }
            kind @ ("spherical" | "cylindrical") => {
                params.push("mapping", Value::String(kind.to_owned()), at);
                self.place_texture(Transform::IDENTITY, at, params)?;
            }
            "planar" => {
                params.push("mapping", Value::String("planar".to_owned()), at);
                let (v1, v2) = (given.point3("v1", [1.0, 0.0, 0.0])?, given.point3("v2", [0.0, 1.0, 0.0])?);
                let (du, dv) = (given.float("udelta", 0.0)?, given.float("vdelta", 0.0)?);
                let plane = Transform::from_rows([
                    [v1[0], v1[1], v1[2], du],
                    [v2[0], v2[1], v2[2], dv],
                    // Any third axis will do that makes an invertible matrix: the plane's own normal.
                    [
                        v1[1] * v2[2] - v1[2] * v2[1],
                        v1[2] * v2[0] - v1[0] * v2[2],
                        v1[0] * v2[1] - v1[1] * v2[0],
                        0.0,
                    ],
                    [0.0, 0.0, 0.0, 1.0],
                ]);
                let plane = plane
                    .filter(Transform::is_invertible)
                    .ok_or_else(|| SceneError::invalid("`v1` and `v2` must span a plane", given.span))?;
                self.place_texture(plane, at, params)?;
            }
            other => {
                let message =
                    format!("`mapping` is `uv`, `spherical`, `cylindrical` or `planar`, not `{other}`");
                return Err(SceneError::invalid(message, at));
            }
        }
        params.push("to_uv", Value::Transform(then), at);
        Ok(())
    }

    fn image(&mut self, given: &ParamSet, ty: TextureType) -> Result<Params, SceneError> {
        let at = given.span;
        let path = given.path("filename", self)?.ok_or_else(|| SceneError::MissingParam {
            element: "imagemap".into(),
            param: "filename".into(),
            wanted: "a picture file".into(),
            at,
        })?;
        let mut params = Params::new();
        params.push("filename", Value::Path(path.clone()), given.at("filename"));
        let filter = match given.text("filter")?.unwrap_or("bilinear") {
            "point" => "nearest",
            "ewa" | "EWA" => "ewa",
            filter @ ("bilinear" | "trilinear") => filter,
            other => {
                let message = format!("`filter` is `point`, `bilinear`, `trilinear` or `ewa`, not `{other}`");
                return Err(SceneError::invalid(message, given.at("filter")));
            }
        };
        let filter = match filter {
            "trilinear" | "ewa" if self.flags.no_texture_filter => "bilinear",
            filter => filter,
        };
        params.push("filter", Value::String(filter.into()), at);
        if ty == TextureType::Float {
            params.push("channel", Value::String(number_of(given, filter, self)?.into()), at);
        }
        let anisotropy = given.float("maxanisotropy", 8.0)?.clamp(1.0, 64.0);
        params.push("max_anisotropy", Value::Float(anisotropy), given.at("maxanisotropy"));
        let wrap = match given.text("wrap")?.unwrap_or("repeat") {
            wrap @ ("repeat" | "clamp" | "black") => wrap,
            "octahedralsphere" => "octahedral",
            other => {
                let message =
                    format!("`wrap` is `repeat`, `black`, `clamp` or `octahedralsphere`, not `{other}`");
                return Err(SceneError::invalid(message, given.at("wrap")));
            }
        };
        params.push("wrap", Value::String(wrap.into()), at);
        let mut encoding = given.text("encoding")?.unwrap_or("sRGB");
        if encoding != "sRGB" && is_always_srgb(&path) {
            self.warn(
                "pictures of this format are always sRGB: `encoding` does not count",
                given.at("encoding"),
            );
            encoding = "sRGB";
        }
        set_encoding(encoding, given.at("encoding"), &mut params)?;
        params.push("scale", Value::Float(given.float("scale", 1.0)?), at);
        params.push("invert", Value::Bool(given.bool("invert", false)?), at);
        self.mapping(given, Transform::IDENTITY, &mut params)?;
        Ok(params)
    }
}

/// What pbrt reads of a picture as a number: its filters differ. Opacity counts where a file has it as a fourth channel, not where
/// palettes or grey pictures have it.
fn number_of(given: &ParamSet, filter: &str, reader: &Reader<'_, '_>) -> Result<&'static str, SceneError> {
    if matches!(filter, "nearest" | "ewa") {
        return Ok("first");
    }
    let has_opacity = given.path("filename", reader)?.is_some_and(|path| match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("exr") => true,
        Some(extension) if extension.eq_ignore_ascii_case("png") => is_png_with_opacity(&path),
        _ => false,
    });
    Ok(if has_opacity { "number" } else { "mean" })
}

/// Whether a PNG file's header says red, green, blue and alpha.
fn is_png_with_opacity(path: &Path) -> bool {
    let mut header = [0; 26];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut header));
    // Signature, length and name of the first block, width and height, depth: then the type of colour.
    read.is_ok() && header[25] == 6
}

/// Whether pbrt pays no attention to `encoding`, going by the name as it does.
fn is_always_srgb(path: &Path) -> bool {
    let suffix = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    matches!(suffix.as_str(), "jpg" | "jpeg" | "tga" | "bmp" | "ppm" | "pgm" | "pnm")
}

/// `sRGB`, `linear` or `gamma 2.2`.
fn set_encoding(text: &str, at: Span, params: &mut Params) -> Result<(), SceneError> {
    let mut words = text.split_whitespace();
    let name = match (words.next(), words.next().map(str::parse::<f64>)) {
        (Some("sRGB"), None) => "auto",
        (Some("linear"), None) => "linear",
        (Some("gamma"), Some(Ok(gamma))) if gamma > 0.0 => {
            params.push("gamma", Value::Float(gamma), at);
            "gamma"
        }
        _ => {
            let message = format!("`encoding` is `sRGB`, `linear` or `gamma` and a number, not `{text}`");
            return Err(SceneError::invalid(message, at));
        }
    };
    params.push("encoding", Value::String(name.into()), at);
    Ok(())
}
