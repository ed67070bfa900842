//! `aov`: quantities of the first surface, as further channels of the image.
//!
//! Every integrator takes the parameter `layers`: pairs `name:quantity` between commas. Each becomes one or more channels,
//! named by the layer's name and the last word of this table:
//!
//! | quantity | channels | |
//! |---|---|---|
//! | `albedo` | R G B | how much light the surface scatters |
//! | `depth` | T | distance from the camera's near plane |
//! | `position` | X Y Z | in the world |
//! | `uv` | U V | surface parameters |
//! | `geo_normal`, `sh_normal` | X Y Z | unit normals in the world, without and with interpolation |
//! | `dp_du`, `dp_dv` | X Y Z | derivatives of position |
//! | `prim_index`, `shape_index` | I | numbers of the primitive and the shape |
//! | `duv_dx`, `duv_dy` | U V | change of surface parameters from a sample to the next, across and down |
//! | `alpha` | A | 1 where the picture is covered |
//! | `radiance` | R G B A | the picture again, and where it is covered |
//! | `xyz`, `xyz2` | X Y Z | the picture in CIE XYZ, and the mean of its squares |
//!
//! Where nothing is met, they are zero. They are filtered as the picture is.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_scene::{Interaction, Scene, SceneHit};
use aureole_spectrum::{Spectrum, Wavelengths, xyz_from_srgb};

use super::{Batch, Integrator, IntegratorManual, PathStart};
use crate::replay::Event;

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "aov",
    summary: "No picture, only the layers that are asked for; every integrator takes `layers`.",
    params: &[ParamDoc {
        name: "layers",
        ty: "string",
        default: "",
        doc: "pairs `name:quantity`: albedo, depth, position, uv, geo_normal, sh_normal, dp_du, dp_dv, ...",
    }],
    build: |_| Ok(Box::new(Nothing)),
};

/// The most layers of an image. Each is a sum for every pixel.
const MOST: u64 = 256;

/// How many channels a list of layers makes; what is no layer makes none.
pub(crate) fn channel_count(list: &str) -> u64 {
    let words = list.split(',').filter_map(|pair| pair.rsplit_once(':'));
    let channels =
        words.filter_map(|(_, word)| Quantity::ALL.iter().find(|(known, ..)| *known == word.trim()));
    channels.map(|(.., names)| names.len() as u64).sum()
}

/// No picture.
struct Nothing;

impl Integrator for Nothing {
    fn trace(&self, _: &Scene, _: &[PathStart], _: &mut [Spectrum], _: &mut Batch) {}
}

/// What a layer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Albedo,
    Depth,
    Position,
    Uv,
    GeometricNormal,
    ShadingNormal,
    DpDu,
    DpDv,
    DuvDx,
    DuvDy,
    PrimitiveIndex,
    ShapeIndex,
    Alpha,
    Radiance,
    Xyz,
    XyzSquared,
}

use Quantity::{
    Albedo, Alpha, Depth, DpDu, DpDv, DuvDx, DuvDy, GeometricNormal, Position, PrimitiveIndex, Radiance,
    ShadingNormal, ShapeIndex, Uv, Xyz, XyzSquared,
};

impl Quantity {
    /// Names, and the last words of the channels.
    const ALL: [(&str, Self, &[&str]); 16] = [
        ("albedo", Albedo, &["R", "G", "B"]),
        ("depth", Depth, &["T"]),
        ("position", Position, &["X", "Y", "Z"]),
        ("uv", Uv, &["U", "V"]),
        ("geo_normal", GeometricNormal, &["X", "Y", "Z"]),
        ("sh_normal", ShadingNormal, &["X", "Y", "Z"]),
        ("dp_du", DpDu, &["X", "Y", "Z"]),
        ("dp_dv", DpDv, &["X", "Y", "Z"]),
        ("duv_dx", DuvDx, &["U", "V"]),
        ("duv_dy", DuvDy, &["U", "V"]),
        ("prim_index", PrimitiveIndex, &["I"]),
        ("shape_index", ShapeIndex, &["I"]),
        ("alpha", Alpha, &["A"]),
        ("radiance", Radiance, &["R", "G", "B", "A"]),
        ("xyz", Xyz, &["X", "Y", "Z"]),
        ("xyz2", XyzSquared, &["X", "Y", "Z"]),
    ];

    /// Whether it is about a surface, not about the picture.
    fn is_of_surface(self) -> bool {
        !matches!(self, Xyz | XyzSquared | Radiance | Alpha)
    }

    /// Adds its values at a surface.
    fn at_surface(
        self,
        scene: &Scene,
        start: &PathStart,
        hit: &SceneHit,
        at: &Interaction<'_>,
        out: &mut Vec<f32>,
    ) {
        let surface = &at.surface;
        match self {
            Albedo => {
                let wo = -start.ray.direction;
                out.extend(scene.bsdf(at, wo, Wavelengths::RGB).albedo(wo).rgb());
            }
            Depth => out.push(hit.t - start.ray.t_min),
            Position => out.extend(surface.p.to_array()),
            Uv => out.extend([surface.uv.x, surface.uv.y]),
            GeometricNormal => out.extend(surface.ng.to_array()),
            ShadingNormal => out.extend(surface.frame.n.to_array()),
            DpDu => out.extend(surface.dp_du.to_array()),
            DpDv => out.extend(surface.dp_dv.to_array()),
            DuvDx | DuvDy => {
                let [dx, dy] = scene.parameter_steps(surface);
                out.extend(if self == DuvDx { dx.to_array() } else { dy.to_array() });
            }
            PrimitiveIndex => out.push(hit.primitive as f32),
            ShapeIndex => out.push(hit.geometry as f32),
            Alpha | Radiance | Xyz | XyzSquared => {}
        }
    }
}

/// A layer: its quantity and the names of its channels.
pub(super) struct Layer {
    quantity: Quantity,
    channels: Vec<String>,
}

impl Layer {
    /// Reads the parameter `layers`.
    pub(super) fn from_params(params: &mut Params) -> Result<Vec<Self>, SceneError> {
        let at = params.span("layers");
        let text = params.try_string("layers")?.unwrap_or_default();
        let found = text.split(',').count() as u64;
        if found > MOST {
            return Err(SceneError::Limit {
                what: "layers of an image".into(),
                found,
                limit: MOST,
                name: None,
                at,
            });
        }
        let mut layers: Vec<Self> = Vec::new();
        for pair in text.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
            let (name, word) = pair.rsplit_once(':').ok_or_else(|| {
                SceneError::invalid(format!("`{pair}` is no layer: a pair `name:quantity` is wanted"), at)
            })?;
            let (_, quantity, words) =
                Quantity::ALL.into_iter().find(|(known, ..)| *known == word.trim()).ok_or_else(|| {
                    SceneError::unknown_name("layer", word, Quantity::ALL.iter().map(|(word, ..)| *word), at)
                })?;
            let channels: Vec<String> = words.iter().map(|word| format!("{}.{word}", name.trim())).collect();
            let taken = |channel: &String| layers.iter().any(|layer| layer.channels.contains(channel));
            if let Some(channel) = channels.iter().find(|channel| taken(channel)) {
                return Err(SceneError::invalid(format!("two layers have a channel `{channel}`"), at));
            }
            layers.push(Self { quantity, channels });
        }
        Ok(layers)
    }
}

impl Layer {
    /// The picture's own alpha.
    pub(super) fn alpha() -> Self {
        Self { quantity: Alpha, channels: vec!["A".to_owned()] }
    }
}

/// An integrator that gathers layers as well.
pub(super) fn with_layers(inner: Box<dyn Integrator>, layers: Vec<Layer>) -> Box<dyn Integrator> {
    let names = layers.iter().flat_map(|layer| layer.channels.iter().cloned()).collect();
    let looks = layers
        .iter()
        .any(|layer| layer.quantity.is_of_surface() || matches!(layer.quantity, Radiance | Alpha));
    Box::new(Layered { inner, layers, names, looks })
}

struct Layered {
    inner: Box<dyn Integrator>,
    layers: Vec<Layer>,
    names: Vec<String>,
    /// Whether it must know what the camera sees.
    looks: bool,
}

impl Layered {
    /// Adds the values of one ray.
    fn values(&self, scene: &Scene, start: &PathStart, radiance: Spectrum, batch: &mut Batch) {
        let radiance = radiance * start.weight;
        let hit = self.looks.then(|| scene.closest_hit(&start.ray)).flatten();
        batch.rays += u64::from(self.looks);
        let at = hit.map(|hit| (hit, scene.interaction(&start.ray, &hit)));
        for layer in &self.layers {
            let sky_covers = !self.inner.hides_emitters() && !scene.environments().is_empty();
            let alpha = || f32::from(u8::from(at.is_some() || sky_covers));
            match (layer.quantity, &at) {
                (Alpha, _) => batch.layers.push(alpha()),
                (Radiance, _) => {
                    batch.layers.extend(radiance.rgb());
                    batch.layers.push(alpha());
                }
                (Xyz, _) => batch.layers.extend(xyz_from_srgb(radiance.rgb())),
                (XyzSquared, _) => batch.layers.extend(xyz_from_srgb(radiance.rgb()).map(|x| x * x)),
                (quantity, Some((hit, at))) => quantity.at_surface(scene, start, hit, at, &mut batch.layers),
                (_, None) => batch.layers.extend(layer.channels.iter().map(|_| 0.0)),
            }
        }
    }
}

impl Integrator for Layered {
    fn layers(&self) -> &[String] {
        &self.names
    }

    fn trace(&self, scene: &Scene, starts: &[PathStart], radiance: &mut [Spectrum], batch: &mut Batch) {
        self.inner.trace(scene, starts, radiance, batch);
        for (start, &radiance) in starts.iter().zip(radiance.iter()) {
            self.values(scene, start, radiance, batch);
        }
    }

    fn trace_watched(
        &self,
        scene: &Scene,
        starts: &[PathStart; 1],
        radiance: &mut [Spectrum; 1],
        batch: &mut Batch,
        events: &mut Vec<Event>,
    ) {
        self.inner.trace_watched(scene, starts, radiance, batch, events);
    }
}

#[cfg(test)]
mod tests {
    use aureole_desc::Value;

    use super::*;

    fn layers(text: &str) -> Result<Vec<Layer>, SceneError> {
        Layer::from_params(&mut Params::new().with("layers", Value::String(text.to_owned())))
    }

    #[test]
    fn layers_name_their_channels() {
        let channels = |text: &str| -> Vec<String> {
            layers(text).unwrap().into_iter().flat_map(|layer| layer.channels).collect()
        };
        assert_eq!(channels("dd.y:depth, nn:sh_normal"), ["dd.y.T", "nn.X", "nn.Y", "nn.Z"]);
        assert!(channels("").is_empty());
    }

    #[test]
    fn layers_are_counted_before_they_are_made() {
        assert_eq!(channel_count("a:depth, b:position,c,d:heat"), 4);
        let many: Vec<String> = (0..=MOST).map(|i| format!("a{i}:depth")).collect();
        assert!(matches!(layers(&many.join(",")), Err(SceneError::Limit { found: 257, limit: 256, .. })));
        assert!(layers(&many[1..].join(",")).is_ok());
    }

    #[test]
    fn wrong_layers_are_refused() {
        for text in ["depth", "a:heat", "a:depth,a:depth", "a:position,a:xyz"] {
            assert!(layers(text).is_err(), "{text}");
        }
    }
}
