//! How a point of a surface becomes a point of a picture or of a solid pattern.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Point3, Transform, Vector2, Vector3, warp};

use super::{TextureContext, UvMap};

/// Where a flat texture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// The surface's own parameters.
    Uv,
    /// Polar angle over π, azimuth over 2π.
    Spherical,
    /// Azimuth over 2π, height.
    Cylindrical,
    /// x and y.
    Planar,
}

/// A flat texture's mapping: parameters `mapping`, `texture_from_world` and `to_uv`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    kind: Kind,
    texture_from_world: Transform,
    to_uv: UvMap,
}

/// The manual of `to_uv`.
pub(super) const TO_UV: ParamDoc = ParamDoc {
    name: "to_uv",
    ty: "transform",
    default: "identity",
    doc: "applied to the mapped coordinates",
};
/// The manual of `mapping`.
pub(super) const MAPPING: ParamDoc = ParamDoc {
    name: "mapping",
    ty: "string",
    default: "uv",
    doc: "`uv`, `spherical`, `cylindrical` or `planar`: from the surface, or from where it is",
};
/// The manual of `texture_from_world`.
pub(super) const TEXTURE_FROM_WORLD: ParamDoc = ParamDoc {
    name: "texture_from_world",
    ty: "transform",
    default: "identity",
    doc: "into the texture's space, for what depends on where the surface is",
};

impl Default for Mapping {
    /// The surface's own parameters.
    fn default() -> Self {
        let identity = Transform::default();
        Self { kind: Kind::Uv, texture_from_world: identity, to_uv: UvMap::new(&identity) }
    }
}

impl Mapping {
    pub(super) fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        Ok(Self {
            kind: params.one_of(
                "mapping",
                &[
                    ("uv", Kind::Uv),
                    ("spherical", Kind::Spherical),
                    ("cylindrical", Kind::Cylindrical),
                    ("planar", Kind::Planar),
                ],
            )?,
            texture_from_world: params.transform("texture_from_world")?,
            to_uv: UvMap::new(&params.transform("to_uv")?),
        })
    }

    /// The place on the picture.
    #[inline]
    pub fn apply(&self, at: &TextureContext<'_>) -> Point2 {
        if self.kind == Kind::Uv {
            return self.to_uv.apply(at.uv);
        }
        self.to_uv.apply(self.place_of(at.p))
    }

    /// Where a point of the world is before `to_uv`.
    fn place_of(&self, p: Point3) -> Point2 {
        let p = self.texture_from_world.point(p);
        match self.kind {
            Kind::Spherical => {
                let w = (p - Point3::ORIGIN).try_normalized().unwrap_or(Vector3::Z);
                Point2::new(warp::polar_angle(w) * FRAC_1_PI, warp::azimuth(w.y, w.x) / TAU)
            }
            Kind::Cylindrical => Point2::new((PI + p.y.atan2(p.x)) / TAU, p.z),
            Kind::Planar | Kind::Uv => Point2::new(p.x, p.y),
        }
    }

    /// The steps on the picture from a pixel to the next, across and down.
    pub fn footprint(&self, at: &TextureContext<'_>) -> Option<[Vector2; 2]> {
        let footprint = at.footprint?;
        Some([0, 1].map(|i| {
            if self.kind == Kind::Uv {
                return self.to_uv.linear(footprint.duv[i]);
            }
            let mut step = self.place_of(at.p + footprint.dp[i]) - self.place_of(at.p);
            // Azimuths jump by one.
            match self.kind {
                Kind::Spherical => step.y -= step.y.round(),
                Kind::Cylindrical => step.x -= step.x.round(),
                Kind::Planar | Kind::Uv => {}
            }
            self.to_uv.linear(step)
        }))
    }

    /// A gradient on the picture as one by the surface's parameters; `None` where that is not a plain matrix product.
    pub fn pull_back(&self, g: Vector2) -> Option<Vector2> {
        (self.kind == Kind::Uv).then(|| self.to_uv.pull_back(g))
    }
}
