//! Film, filter, sampler, integrator.

use aureole_desc::{Family, Params, SceneError, Value};
use aureole_math::Transform;

use super::params::ParamSet;
use super::state::{PendingCamera, Reader};

/// Samplers of the file format; all but `independent` and `stratified` become `sobol`.
const SAMPLERS: [&str; 7] =
    ["halton", "independent", "paddedsobol", "pmj02bn", "sobol", "stratified", "zsobol"];

impl Reader<'_, '_> {
    pub(super) fn film_directive(&mut self, kind: &str, params: ParamSet) -> Result<(), SceneError> {
        if kind != "rgb" {
            self.warn(format!("film `{kind}` is taken as `rgb`"), params.span);
        }
        self.film = Some(params);
        Ok(())
    }

    /// Builds film and camera, which need to know of each other.
    pub(super) fn finish_options(&mut self) -> Result<(), SceneError> {
        let film = self.film.take().unwrap_or_else(|| ParamSet::empty(aureole_desc::Span::NONE));
        let size = [film.int("xresolution", 1280)?, film.int("yresolution", 720)?];
        if size.iter().any(|&n| n < 1) {
            return Err(SceneError::invalid(
                "the film needs at least one pixel in each direction",
                film.span,
            ));
        }
        let mut params = Params::new();
        params.push("width", Value::Int(size[0]), film.at("xresolution"));
        params.push("height", Value::Int(size[1]), film.at("yresolution"));
        self.crop(&film, size, &mut params)?;
        if let Some(name) = film.text("filename")? {
            params.push("filename", Value::String(name.to_owned()), film.at("filename"));
        }
        let gain = self.exposure(&film)? * film.float("iso", 100.0)? / 100.0;
        if gain != 1.0 {
            params.push("gain", Value::Float(gain), film.at("iso"));
        }
        let sensor = film.text("sensor")?.unwrap_or("cie1931").to_owned();
        if let Some(most) = film.try_float("maxcomponentvalue")? {
            // Its channels are those of the sensor.
            let channels = if sensor == "cie1931" { "xyz" } else { "rgb" };
            params.push("max_component", Value::Float(most), film.at("maxcomponentvalue"));
            params.push("max_component_of", Value::String(channels.into()), film.at("maxcomponentvalue"));
        }
        if sensor != "cie1931" {
            self.warn(format!("sensor `{sensor}` is taken as `cie1931`"), film.at("sensor"));
        }
        if film.float("whitebalance", 0.0)? != 0.0 {
            self.warn("the film's colours are not balanced: white is that of D65", film.at("whitebalance"));
        }
        let diagonal = film.float("diagonal", 35.0)?;
        // What files hold is the program's business.
        for name in ["savefp16", "coordinatesystem", "nbuckets", "lambdamin", "lambdamax"] {
            film.get(name);
        }
        film.finish("Film", self.context.report);
        self.desc.film = Some(self.add(Family::Film, "film", params, film.span));
        self.defaults()?;
        if self.flags.no_pixel_jitter {
            // A filter so narrow that all samples lie in the middle.
            let params = Params::new().with("radius", Value::Vec2([1e-6; 2]));
            self.desc.filter = Some(self.add(Family::Filter, "box", params, film.span));
        }
        // Without any, the camera is at the origin and looks along +Z.
        let camera = self.camera.take().unwrap_or_else(|| PendingCamera {
            kind: "perspective".into(),
            params: ParamSet::empty(film.span),
            world_from_camera: [Transform::IDENTITY; 2],
        });
        self.camera_node(&camera, size, diagonal)
    }

    /// What pbrt takes where a file says nothing: a Gaussian, 16 samples, paths of five bounces.
    fn defaults(&mut self) -> Result<(), SceneError> {
        let empty = ParamSet::empty(aureole_desc::Span::NONE);
        if self.desc.filter.is_none() {
            self.filter("gaussian", &empty)?;
        }
        if self.desc.sampler.is_none() {
            self.sampler("zsobol", &empty)?;
        }
        if self.desc.integrator.is_none() {
            self.integrator("volpath", &empty)?;
        }
        Ok(())
    }

    /// How long the film sees light: while the camera's shutter is open.
    fn exposure(&self, film: &ParamSet) -> Result<f64, SceneError> {
        if let Some(time) = film.try_float("exposuretime")? {
            return Ok(time.max(0.0));
        }
        let Some(PendingCamera { params, .. }) = &self.camera else { return Ok(1.0) };
        let time = params.float("shutterclose", 1.0)? - params.float("shutteropen", 0.0)?;
        if time > 0.0 {
            Ok(time)
        } else {
            Err(SceneError::invalid("the shutter does not open: the image would be black", params.span))
        }
    }

    fn crop(&mut self, film: &ParamSet, size: [i64; 2], params: &mut Params) -> Result<(), SceneError> {
        let (pixels, window) = (film.ints("pixelbounds")?, film.floats("cropwindow")?);
        if pixels.is_some() && window.is_some() {
            self.warn("`cropwindow` counts, `pixelbounds` does not", film.at("pixelbounds"));
        }
        let [width, height] = size;
        let bounds = if let Some(list) = window {
            let edge = |x: f32, n: i64| (f64::from(x.clamp(0.0, 1.0)) * n as f64).ceil() as i64;
            <[f32; 4]>::try_from(list).ok().map(|c| {
                let [x0, x1, y0, y1] =
                    [edge(c[0], width), edge(c[1], width), edge(c[2], height), edge(c[3], height)];
                [x0.min(x1), x0.max(x1), y0.min(y1), y0.max(y1)]
            })
        } else if let Some(list) = pixels {
            <[i32; 4]>::try_from(list).ok().map(|b| {
                let [x0, x1, y0, y1] = b.map(i64::from);
                [x0.clamp(0, width), x1.clamp(0, width), y0.clamp(0, height), y1.clamp(0, height)]
            })
        } else {
            return Ok(());
        };
        let Some([x0, x1, y0, y1]) = bounds.filter(|b| b[1] > b[0] && b[3] > b[2]) else {
            return Err(SceneError::invalid(
                "the crop must be four numbers x0 x1 y0 y1, with pixels in between",
                film.span,
            ));
        };
        for (name, value) in
            [("crop_x", x0), ("crop_y", y0), ("crop_width", x1 - x0), ("crop_height", y1 - y0)]
        {
            params.push(name, Value::Int(value), film.span);
        }
        Ok(())
    }

    pub(super) fn filter(&mut self, kind: &str, given: &ParamSet) -> Result<(), SceneError> {
        let at = given.span;
        let (name, radius) = match kind {
            "box" => ("box", 0.5),
            "gaussian" => ("gaussian", 1.5),
            "mitchell" => ("mitchell", 2.0),
            "sinc" => ("lanczos", 4.0),
            "triangle" => ("tent", 2.0),
            other => {
                self.warn(format!("filter `{other}` is not known: `gaussian` stands in for it"), at);
                ("gaussian", 1.5)
            }
        };
        let mut params = Params::new();
        params.push(
            "radius",
            Value::Vec2([given.float("xradius", radius)?, given.float("yradius", radius)?]),
            at,
        );
        let extra: &[(&str, &str, f64)] = match name {
            "gaussian" => &[("sigma", "std_dev", 0.5)],
            "mitchell" => &[("B", "b", 1.0 / 3.0), ("C", "c", 1.0 / 3.0)],
            "lanczos" => &[("tau", "tau", 3.0)],
            _ => &[],
        };
        for (theirs, ours, default) in extra {
            params.push(*ours, Value::Float(given.float(theirs, *default)?), at);
        }
        given.finish("PixelFilter", self.context.report);
        self.desc.filter = Some(self.add(Family::Filter, name, params, at));
        Ok(())
    }

    pub(super) fn sampler(&mut self, kind: &str, given: &ParamSet) -> Result<(), SceneError> {
        let name = match kind {
            "independent" => "independent",
            "stratified" => "stratified",
            _ => "sobol",
        };
        let count = if name == "stratified" {
            given.int("xsamples", 4)?.saturating_mul(given.int("ysamples", 4)?)
        } else {
            given.int("pixelsamples", if name == "independent" { 4 } else { 16 })?
        };
        if !given.bool("jitter", true)? {
            self.warn("samples are placed at random in their cells all the same", given.at("jitter"));
        }
        for ignored in ["seed", "randomization"] {
            given.get(ignored);
        }
        if !SAMPLERS.contains(&kind) {
            self.warn(format!("sampler `{kind}` is not known: `zsobol` stands in for it"), given.span);
        }
        given.finish("Sampler", self.context.report);
        let mut params = Params::new();
        params.push("sample_count", Value::Int(count), given.span);
        self.desc.sampler = Some(self.add(Family::Sampler, name, params, given.span));
        Ok(())
    }

    pub(super) fn integrator(&mut self, kind: &str, given: &ParamSet) -> Result<(), SceneError> {
        let at = given.span;
        let name = if kind == "ambientocclusion" { "ao" } else { "path" };
        if !matches!(
            kind,
            "path" | "volpath" | "simplepath" | "simplevolpath" | "randomwalk" | "ambientocclusion"
        ) {
            self.warn(format!("integrator `{kind}` is not there yet: `path` finds the same image"), at);
            given.touch_all(); // what they have of their own
        }
        let mut params = Params::new();
        if name == "ao" {
            params.push("cos_sample", Value::Bool(given.bool("cossample", true)?), at);
            params.push("distance", Value::Float(given.float("maxdistance", -1.0)?), at);
        } else {
            // pbrt counts bounces, Aureole segments.
            params.push("max_depth", Value::Int(given.int("maxdepth", 5)?.clamp(0, 1 << 30) + 1), at);
            if given.bool("regularize", false)? {
                params.push("regularize", Value::Bool(kind.contains("path")), given.at("regularize"));
            }
            if self.flags.force_diffuse {
                params.push("force_diffuse", Value::Bool(true), at);
            }
        }
        for ignored in ["lightsampler", "samplelights", "samplebsdf"] {
            given.get(ignored);
        }
        given.finish("Integrator", self.context.report);
        self.desc.integrator = Some(self.add(Family::Integrator, name, params, at));
        Ok(())
    }
}
