//! `area`: a surface that shines, the same in all directions of its outer side.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radiance` | texture | 1 | emitted radiance, over the shape's uv |
//! | `two_sided` | bool | false | shine on the inner side as well |
//! | `power` | float | 0 | if positive: scale to this power, W |
//! | `power_of` | string | shape | what has that power: the whole `shape`, or each `primitive`, as in pbrt |
//!
//! It is given to a shape as `emission`. A shape in a group shines in each instance of it. Shapes of a material that shines
//! by itself (`open_pbr` with `emission_luminance`) are such lights too; what their textures are asked for is known but for
//! the attributes of meshes.
//!
//! Where a shape's `alpha` cuts it out it does not shine; but with a constant `alpha` of zero it is not seen and shines all
//! the same, as in pbrt.

use std::f32::consts::PI;
use std::sync::{Arc, OnceLock};

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Id, Point2, Point3, Transform, Vector3, offset_ray_origin};
use aureole_spectrum::{Spectrum, SpectrumRole, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::bsdf::EmissionContext;
use crate::shape::ShapeSample;
use crate::{Element, Material, Resolver, Shape, SurfacePoint, Texture, TextureContext, spectrum_texture};

/// A shining surface.
#[derive(Clone, Debug)]
pub struct Area {
    shape: Id<Shape>,
    source: Source,
    /// The power to scale to, if positive.
    power: f32,
    /// Whether each triangle (patch, piece ...) of the shape has it.
    power_of_each: bool,
    /// The factor that does it, per area of what has that power, once its shape and texture can be asked.
    scale: OnceLock<f32>,
    /// Where the shape is, if it is in a group that an instance places.
    place: Option<Arc<Place>>,
    cut: Cut,
}

/// What is left of a shape that shines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cut {
    Whole,
    /// By chance as often as this says.
    Holes(Id<Texture>),
    /// No ray meets it, but it shines.
    Unseen,
}

/// What says how much it shines.
#[derive(Clone, Copy, Debug)]
enum Source {
    Texture { radiance: Id<Texture>, two_sided: bool },
    Material(Id<Material>),
}

/// Where an instance puts a shape.
#[derive(Debug)]
struct Place {
    world_from_group: Transform,
    group_from_world: Transform,
    /// |det| of the linear part.
    volume_scale: f32,
}

impl Place {
    fn new(world_from_group: Transform) -> Self {
        let [x, y, z] = [Vector3::X, Vector3::Y, Vector3::Z].map(|axis| world_from_group.vector(axis));
        let volume_scale = x.cross(y).dot(z).abs();
        Self { world_from_group, group_from_world: world_from_group.inverse(), volume_scale }
    }

    /// By how much densities per steradian grow around unit `w` of the group: directions that are drawn apart there are drawn
    /// together here, by |det M| / |M w|³.
    fn density_scale(&self, w: Vector3) -> f32 {
        let stretch = self.world_from_group.vector(w).length();
        stretch * stretch * stretch / self.volume_scale
    }

    fn sample(&self, shape: &Shape, reference: Point3, u: Point2) -> Option<ShapeSample> {
        let local = self.group_from_world.point(reference);
        let drawn = shape.sample_towards(local, u)?;
        let w = (drawn.p - local).try_normalized()?;
        let pdf = drawn.pdf * self.density_scale(w);
        Some(ShapeSample { pdf, ..drawn.transformed(&self.world_from_group) })
    }

    fn pdf_towards(&self, shape: &Shape, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        let Some(w) = self.group_from_world.vector(wi).try_normalized() else { return 0.0 };
        let surface = surface.transformed(&self.group_from_world);
        shape.pdf_towards(self.group_from_world.point(reference), w, &surface) * self.density_scale(w)
    }

    /// The shape's area in the world: the mean stretch of points that are drawn evenly.
    fn area(&self, shape: &Shape) -> f32 {
        const SIDE: usize = 16;
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..SIDE * SIDE {
            let grid = |i: usize| (i as f32 + 0.5) / SIDE as f32;
            let Some(drawn) = shape.sample_area(Point2::new(grid(i % SIDE), grid(i / SIDE))) else {
                continue;
            };
            let stretch = Vector3::from(self.world_from_group.normal(drawn.ng.into())).length();
            sum += stretch * self.volume_scale / drawn.pdf;
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

impl Element for Area {
    const SUMMARY: &'static str = "A surface that shines; given to a shape as `emission`.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "radiance",
            ty: "texture",
            default: "1",
            doc: "emitted radiance, over the shape's uv",
        },
        ParamDoc { name: "two_sided", ty: "bool", default: "false", doc: "shine on the inner side as well" },
        ParamDoc { name: "power", ty: "float", default: "0", doc: "if positive: scale to this power, W" },
        ParamDoc {
            name: "power_of",
            ty: "string",
            default: "shape",
            doc: "what has that power: the whole `shape`, or each `primitive`",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let shape = resolver.emitting_shape().ok_or_else(|| {
            SceneError::invalid("an `area` light belongs to a shape, as its `emission`", Span::NONE)
        })?;
        let radiance = spectrum_texture(params, resolver, "radiance", 1.0, SpectrumRole::Illuminant)?;
        Ok(Self {
            shape,
            source: Source::Texture { radiance, two_sided: params.bool("two_sided", false)? },
            power: params.float("power", 0.0)?,
            power_of_each: params.one_of("power_of", &[("shape", false), ("primitive", true)])?,
            scale: OnceLock::new(),
            place: None,
            cut: Cut::Whole,
        })
    }
}

impl Area {
    /// The light of a shape whose material shines.
    pub fn of_material(shape: Id<Shape>, material: Id<Material>) -> Self {
        let source = Source::Material(material);
        let (scale, place, cut) = (OnceLock::new(), None, Cut::Whole);
        Self { shape, source, power: 0.0, power_of_each: false, scale, place, cut }
    }

    /// Radiance from a point of a primitive with normal `ng`, towards a direction at a cosine to it.
    #[inline]
    fn radiance(
        &self,
        at: &LightContext<'_>,
        (p, primitive): (Point3, u32),
        ng: Vector3,
        uv: Point2,
        cos: f32,
    ) -> Spectrum {
        let texture = TextureContext::at_uv(at.textures, at.wavelengths, uv);
        match self.source {
            Source::Texture { radiance, two_sided } if cos > 0.0 || two_sided => {
                let radiance = texture.spectrum(radiance);
                if self.power > 0.0 { radiance * self.scale(at, primitive) } else { radiance }
            }
            Source::Texture { .. } => Spectrum::ZERO,
            Source::Material(material) => {
                let texture = TextureContext { p, n: ng, ..texture };
                EmissionContext { texture, materials: at.materials, cos }.nested(material)
            }
        }
    }
}

impl Area {
    /// Cuts out the shape where `alpha` is less than one; `is_zero`: it is zero everywhere.
    pub(super) fn cut_out(&mut self, alpha: Id<Texture>, is_zero: bool) {
        self.cut = if is_zero { Cut::Unseen } else { Cut::Holes(alpha) };
    }

    /// The chance that a drawn point is there.
    #[inline]
    fn share(&self, at: &LightContext<'_>, drawn: &ShapeSample) -> f32 {
        let Cut::Holes(alpha) = self.cut else { return 1.0 };
        let place = TextureContext::at_uv(at.textures, at.wavelengths, drawn.uv);
        TextureContext { p: drawn.p, ..place }.float(alpha).clamp(0.0, 1.0)
    }

    /// The same light on a shape of a group, in an instance of it.
    pub(super) fn placed(&self, world_from_group: Transform) -> Self {
        Self { scale: OnceLock::new(), place: Some(Arc::new(Place::new(world_from_group))), ..self.clone() }
    }

    /// Power per unit area before it is scaled.
    fn unscaled_exitance(&self, at: &LightContext<'_>) -> f32 {
        let mean = match self.source {
            Source::Texture { radiance, two_sided } => {
                at.textures[radiance].mean(at.textures) * if two_sided { 2.0 } else { 1.0 }
            }
            Source::Material(_) => self.mean_of_material(at),
        };
        luminance(mean.rgb()) * PI
    }

    /// The area of the shape where it is.
    fn area(&self, at: &LightContext<'_>) -> f32 {
        let shape = &at.shapes[self.shape];
        self.place.as_ref().map_or_else(|| shape.area(), |place| place.area(shape))
    }

    /// Mean radiance of both sides together, over uv, at a middling angle.
    fn mean_of_material(&self, at: &LightContext<'_>) -> Spectrum {
        const SIDE: usize = 16;
        let grid = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        let place = |i: usize| Point2::new(grid(i % SIDE), grid(i / SIDE));
        let sum: Spectrum = (0..SIDE * SIDE)
            .flat_map(|i| {
                [0.6, -0.6].map(|cos| self.radiance(at, (Point3::ORIGIN, 0), Vector3::Z, place(i), cos))
            })
            .sum();
        sum / (SIDE * SIDE) as f32
    }

    /// The power that is asked for.
    fn wanted_power(&self, at: &LightContext<'_>) -> f32 {
        let count = if self.power_of_each { at.shapes[self.shape].primitive_count() } else { 1 };
        self.power * count as f32
    }

    fn scale(&self, at: &LightContext<'_>, primitive: u32) -> f32 {
        let shape = &at.shapes[self.shape];
        let per_area = *self.scale.get_or_init(|| {
            let stretch = self.area(at) / shape.area();
            self.power / (self.unscaled_exitance(at) * stretch).max(f32::MIN_POSITIVE)
        });
        per_area / if self.power_of_each { shape.primitive_area(primitive) } else { shape.area() }
    }
}

impl LightOps for Area {
    #[inline]
    fn sample(&self, at: &LightContext<'_>, reference: Point3, u: Point2) -> Option<LightSample> {
        let shape = &at.shapes[self.shape];
        let drawn = match &self.place {
            None => shape.sample_towards(reference, u)?,
            Some(place) => place.sample(shape, reference, u)?,
        };
        let wi = (drawn.p - reference).try_normalized()?;
        let mut radiance =
            self.radiance(at, (drawn.p, drawn.primitive), drawn.ng, drawn.uv, -drawn.ng.dot(wi));
        if self.cut != Cut::Whole {
            radiance *= self.share(at, &drawn);
        }
        let target = offset_ray_origin(drawn.p, drawn.error, drawn.ng, -wi);
        (!radiance.is_black()).then_some(LightSample {
            wi,
            target: Some(target),
            radiance,
            pdf_omega: drawn.pdf,
            is_delta: self.cut == Cut::Unseen,
        })
    }

    #[inline]
    fn pdf_omega(
        &self,
        at: &LightContext<'_>,
        reference: Point3,
        wi: Vector3,
        surface: Option<&SurfacePoint>,
    ) -> f32 {
        let (Some(surface), shape) = (surface, &at.shapes[self.shape]) else { return 0.0 };
        match &self.place {
            None => shape.pdf_towards(reference, wi, surface),
            Some(place) => place.pdf_towards(shape, reference, wi, surface),
        }
    }

    #[inline]
    fn emitted(&self, at: &LightContext<'_>, surface: &SurfacePoint, w: Vector3) -> Spectrum {
        self.radiance(at, (surface.p, surface.primitive), surface.ng, surface.uv, surface.ng.dot(w))
    }

    fn power(&self, at: &LightContext<'_>, _: &Bounds3) -> f32 {
        if self.power > 0.0 { self.wanted_power(at) } else { self.unscaled_exitance(at) * self.area(at) }
    }
}
