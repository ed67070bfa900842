//! Scenes: what integrators ask.

use std::sync::Arc;

use aureole_accel::{Hit, NO_INSTANCE, Stats, World};
use aureole_desc::Node;
use aureole_elements::bsdf::MaterialContext;
use aureole_elements::light::{LightContext, LightSample};
use aureole_elements::shape::ShapeHit;
use aureole_elements::texture::Footprint;
use aureole_elements::{
    Bsdf, Camera, Filter, Light, Material, Sampler, Shape, SurfacePoint, Texture, TextureContext,
};
use aureole_math::{Arena, Bounds3, Id, Motion, Ray, Transform, Vector2, Vector3, offset_ray_origin};
use aureole_spectrum::{Spectrum, Wavelengths};

use crate::film::Film;
use crate::lights::LightPicker;
use crate::origins::Origins;
use crate::shapes::Lookup;

/// What a geometry of a level is.
#[derive(Clone, Debug)]
pub(crate) enum Object {
    Solid { shape: Id<Shape>, material: Id<Material>, light: Option<Id<Light>>, alpha: Option<Id<Texture>> },
    Instance(Instance),
}

/// A group, placed.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub level: u32,
    pub place: Place,
    /// Geometries of the group that shine, in ascending order, and the lights that they are here.
    pub lights: Box<[(u32, Id<Light>)]>,
}

/// Where an instance is.
#[derive(Clone, Debug)]
pub(crate) enum Place {
    /// Shared with the accelerator while that is built.
    Still(Arc<Transform>),
    Moving(Box<Motion>),
}

impl Instance {
    /// The light that a geometry of the group is here.
    #[inline]
    fn light(&self, geometry: u32) -> Option<Id<Light>> {
        let found = self.lights.binary_search_by_key(&geometry, |(geometry, _)| *geometry).ok()?;
        Some(self.lights[found].1)
    }
}

/// A scene that is ready for rays. Nothing in it changes while it is rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Resolution and crop.
    pub film: Film,
    /// The camera.
    pub camera: Camera,
    /// The reconstruction filter.
    pub filter: Filter,
    /// The sample generator.
    pub sampler: Sampler,
    /// What the scene says about light transport.
    pub integrator: Node,
    pub(crate) textures: Arena<Texture>,
    pub(crate) materials: Arena<Material>,
    pub(crate) shapes: Arena<Shape>,
    /// All lights.
    pub lights: Arena<Light>,
    /// Chooses among them.
    pub picker: LightPicker,
    pub(crate) environments: Vec<Id<Light>>,
    pub(crate) world: World,
    pub(crate) levels: Vec<Vec<Object>>,
    pub(crate) unbounded: Vec<Object>,
    pub(crate) has_alpha: bool,
    pub(crate) is_see_through: bool,
    /// Whether some material asks how shading normals change.
    pub(crate) follows_normals: bool,
    /// By how much footprints are narrower than a pixel; zero where no texture is filtered.
    pub(crate) footprint_scale: f32,
    /// What was built from which nodes.
    pub origins: Origins,
}

/// Where a ray meets the scene.
pub type SceneHit = Hit;

/// Stands in a hit's geometry for "one of the unbounded shapes".
const UNBOUNDED: u32 = u32::MAX - 1;

/// What is known where a ray meets the scene.
#[derive(Clone, Copy, Debug)]
pub struct Interaction<'a> {
    /// The surface, in the world.
    pub surface: SurfacePoint,
    /// The light that the surface is, if it shines.
    pub light: Option<Id<Light>>,
    material: Id<Material>,
    shape: &'a Shape,
    hit: ShapeHit,
}

/// What a surface is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements {
    /// The shape.
    pub shape: Id<Shape>,
    /// Its material.
    pub material: Id<Material>,
    /// The light that it is.
    pub light: Option<Id<Light>>,
}

/// How many there are of what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "plain counts")]
pub struct Counts {
    pub shapes: usize,
    pub primitives: usize,
    pub instances: usize,
    pub groups: usize,
    pub textures: usize,
    pub materials: usize,
    pub lights: usize,
}

impl Scene {
    /// The nearest surface on a ray.
    #[inline]
    pub fn closest_hit(&self, ray: &Ray) -> Option<SceneHit> {
        let hit = if self.has_alpha {
            self.world.closest_hit(ray, &Lookup::<true>(self))
        } else {
            self.world.closest_hit(ray, &Lookup::<false>(self))
        };
        if self.unbounded.is_empty() { hit } else { self.with_unbounded(ray, hit) }
    }

    /// [`closest_hit`](Self::closest_hit) for many rays; a hit without a primitive where there is none.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut [SceneHit]) {
        if self.has_alpha {
            self.world.closest_hits(rays, hits, &Lookup::<true>(self));
        } else {
            self.world.closest_hits(rays, hits, &Lookup::<false>(self));
        }
        if !self.unbounded.is_empty() {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.with_unbounded(ray, hit.is_some().then_some(*hit)).unwrap_or(Hit::NONE);
            }
        }
    }

    /// Whether anything lies on a ray.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let blocked = if self.has_alpha {
            self.world.occluded(ray, &Lookup::<true>(self))
        } else {
            self.world.occluded(ray, &Lookup::<false>(self))
        };
        blocked || (!self.unbounded.is_empty() && self.with_unbounded(ray, None).is_some())
    }

    /// [`occluded`](Self::occluded) for many rays.
    pub fn occluded_many(&self, rays: &[Ray], blocked: &mut [bool]) {
        if self.has_alpha {
            self.world.occluded_many(rays, blocked, &Lookup::<true>(self));
        } else {
            self.world.occluded_many(rays, blocked, &Lookup::<false>(self));
        }
        if !self.unbounded.is_empty() {
            for (ray, blocked) in rays.iter().zip(blocked) {
                *blocked = *blocked || self.with_unbounded(ray, None).is_some();
            }
        }
    }

    /// Whether some surface may let light pass straight on, as if it were not there.
    #[inline]
    pub fn is_see_through(&self) -> bool {
        self.is_see_through
    }

    /// How much light gets along a ray to its end.
    #[inline]
    pub fn visibility(&self, ray: &Ray, wavelengths: Wavelengths) -> Spectrum {
        match (self.occluded(ray), self.is_see_through) {
            (false, _) => Spectrum::ONE,
            (true, false) => Spectrum::ZERO,
            (true, true) => self.transmittance(ray, wavelengths),
        }
    }

    /// How much light gets along a ray to its end through the surfaces on it, each of which may let it pass straight on.
    pub fn transmittance(&self, ray: &Ray, wavelengths: Wavelengths) -> Spectrum {
        /// More surfaces than this count as opaque, so that no ray goes on for ever.
        const MOST: u32 = 1 << 12;
        let (mut ray, mut passed, mut bsdf) = (*ray, Spectrum::ONE, Bsdf::new());
        for _ in 0..MOST {
            let Some(hit) = self.closest_hit(&ray) else { return passed };
            let at = self.interaction(&ray, &hit);
            self.bsdf_into(&at, -ray.direction.normalized(), wavelengths, &mut bsdf);
            passed *= bsdf.null_transmittance();
            if passed.is_black() {
                break;
            }
            let onward = at.surface.spawn_ray(ray.direction, ray.time);
            let behind = (onward.origin - ray.origin).dot(ray.direction) / ray.direction.length_squared();
            ray = onward.until(ray.t_max - behind);
        }
        Spectrum::ZERO
    }

    /// The nearer of a hit and those with shapes that have no box.
    fn with_unbounded(&self, ray: &Ray, mut best: Option<Hit>) -> Option<Hit> {
        for (i, object) in self.unbounded.iter().enumerate() {
            let nearer = ray.until(best.map_or(ray.t_max, |hit| hit.t));
            if let Some(hit) = self.first_there::<true>(object, 0, &nearer) {
                let (geometry, primitive) = (UNBOUNDED, i as u32);
                let [u, v] = hit.uv;
                best = Some(Hit { t: hit.t, u, v, primitive, geometry, instance: NO_INSTANCE });
            }
        }
        best
    }

    /// Everything about the place of a hit.
    #[inline]
    pub fn interaction(&self, ray: &Ray, hit: &SceneHit) -> Interaction<'_> {
        let local = ShapeHit { t: hit.t, primitive: hit.primitive, uv: [hit.u, hit.v] };
        if hit.geometry == UNBOUNDED {
            return self.solid(&self.unbounded[hit.primitive as usize], ray, local);
        }
        if hit.instance == NO_INSTANCE {
            return self.solid(&self.levels[0][hit.geometry as usize], ray, local);
        }
        self.instanced(ray, hit, local)
    }

    /// What the surface at a hit is made of.
    pub fn elements(&self, hit: &SceneHit) -> Elements {
        let object = match self.levels[0].get(hit.instance as usize) {
            _ if hit.geometry == UNBOUNDED => &self.unbounded[hit.primitive as usize],
            Some(Object::Instance(instance)) => &self.levels[instance.level as usize][hit.geometry as usize],
            _ => &self.levels[0][hit.geometry as usize],
        };
        let Object::Solid { shape, material, light, .. } = object else {
            unreachable!("instances hold no hits of their own")
        };
        let light = match self.levels[0].get(hit.instance as usize) {
            Some(Object::Instance(instance)) => instance.light(hit.geometry),
            _ => *light,
        };
        Elements { shape: *shape, material: *material, light }
    }

    fn instanced(&self, ray: &Ray, hit: &SceneHit, local: ShapeHit) -> Interaction<'_> {
        let Object::Instance(instance) = &self.levels[0][hit.instance as usize] else {
            unreachable!("the accelerator names instances by the geometries that are instances")
        };
        let moved;
        let place = match &instance.place {
            Place::Still(place) => place.as_ref(),
            Place::Moving(motion) => {
                moved = motion.at(ray.time);
                &moved
            }
        };
        let object = &self.levels[instance.level as usize][hit.geometry as usize];
        let inner = self.solid(object, &place.inverse().ray(ray), local);
        Interaction {
            surface: inner.surface.transformed(place),
            light: instance.light(hit.geometry),
            ..inner
        }
    }

    #[inline]
    fn solid(&self, object: &Object, ray: &Ray, hit: ShapeHit) -> Interaction<'_> {
        let Object::Solid { shape, material, light, .. } = object else {
            unreachable!("instances hold no hits of their own")
        };
        let shape = &self.shapes[*shape];
        let mut surface = shape.surface(ray, &hit);
        if self.follows_normals {
            surface.dn_duv = shape.normal_change(&surface, &hit);
        }
        Interaction { surface, light: *light, material: *material, shape, hit }
    }

    /// The scattering at a place, seen along unit `wo`.
    pub fn bsdf(&self, at: &Interaction<'_>, wo: Vector3, wavelengths: Wavelengths) -> Bsdf {
        let mut bsdf = Bsdf::new();
        self.bsdf_into(at, wo, wavelengths, &mut bsdf);
        bsdf
    }

    /// [`bsdf`](Self::bsdf) into the place of an old one, which spares a copy.
    #[inline]
    pub fn bsdf_into(&self, at: &Interaction<'_>, wo: Vector3, wavelengths: Wavelengths, bsdf: &mut Bsdf) {
        let surface = &at.surface;
        let texture = TextureContext {
            textures: &self.textures,
            wavelengths,
            uv: surface.uv,
            p: surface.p,
            n: surface.frame.n,
            dp_duv: [surface.dp_du, surface.dp_dv],
            mesh: at.shape.mesh_point(&at.hit),
            footprint: if self.footprint_scale > 0.0 { self.footprint(surface) } else { None },
        };
        let context = MaterialContext {
            texture,
            materials: &self.materials,
            frame: surface.frame,
            ng: surface.ng,
            dp_du: surface.dp_du,
            dp_dv: surface.dp_dv,
            dn_duv: surface.dn_duv,
            has_vertex_normals: surface.has_vertex_normals,
            wo,
        };
        bsdf.clear();
        self.materials[at.material].evaluate(&context, 1.0, bsdf);
    }

    /// What a pixel covers of a surface, if the camera saw it directly.
    fn footprint(&self, at: &SurfacePoint) -> Option<Footprint> {
        let steps = self.camera.footprint(at.p, at.ng).map(|step| step * self.footprint_scale);
        Footprint::new(steps, [at.dp_du, at.dp_dv])
    }

    /// How a surface's parameters change from a sample of a pixel to the next, across and down, as the camera sees it; zero
    /// where that is not known. As many samples lie beside each other as above each other.
    pub fn parameter_steps(&self, at: &SurfacePoint) -> [Vector2; 2] {
        let scale = (self.sampler.sample_count().max(1) as f32).sqrt().recip();
        let steps = self.camera.footprint(at.p, at.ng).map(|step| step * scale);
        Footprint::new(steps, [at.dp_du, at.dp_dv]).map_or([Vector2::ZERO; 2], |footprint| footprint.duv)
    }

    /// What lights may ask for.
    #[inline]
    pub fn light_context(&self, wavelengths: Wavelengths) -> LightContext<'_> {
        LightContext {
            textures: &self.textures,
            shapes: &self.shapes,
            materials: &self.materials,
            wavelengths,
        }
    }

    /// Radiance that a place sends along unit `w` by itself.
    #[inline]
    pub fn emitted(&self, at: &Interaction<'_>, w: Vector3, wavelengths: Wavelengths) -> Spectrum {
        match at.light {
            Some(light) => self.lights[light].emitted(&self.light_context(wavelengths), &at.surface, w),
            None => Spectrum::ZERO,
        }
    }

    /// The lights that rays see when they leave the scene.
    pub fn environments(&self) -> &[Id<Light>] {
        &self.environments
    }

    /// The ray that decides whether a light sample is visible from a surface.
    #[inline]
    pub fn shadow_ray(&self, from: &SurfacePoint, sample: &LightSample, time: f32) -> Ray {
        // The light's own surface is kept off by its own offset; the rest is for rounding of the direction.
        const END: f32 = 1.0 - 1e-5;
        let origin = offset_ray_origin(from.p, from.error, from.ng, sample.wi);
        match sample.target {
            Some(target) => Ray { time, ..Ray::new(origin, target - origin).until(END) },
            None => Ray { time, ..Ray::new(origin, sample.wi) },
        }
    }

    /// The kinds of a surface's shape and material.
    pub fn kinds(&self, elements: &Elements) -> [&'static str; 2] {
        [self.shapes[elements.shape].kind(), self.materials[elements.material].kind()]
    }

    /// The box around everything that has one.
    pub fn bounds(&self) -> Bounds3 {
        self.world.bounds()
    }

    /// Figures about the acceleration of each level: the top one, then the groups.
    pub fn accel_stats(&self) -> Vec<Stats> {
        self.world.stats_of_levels().into_iter().map(|(_, stats)| stats).collect()
    }

    /// How many there are of what.
    pub fn counts(&self) -> Counts {
        let is_instance = |object: &&Object| matches!(object, Object::Instance(_));
        Counts {
            shapes: self.shapes.len(),
            primitives: self.shapes.iter().map(|(_, shape)| shape.primitive_count()).sum(),
            instances: self.levels[0].iter().filter(is_instance).count(),
            groups: self.levels.len() - 1,
            textures: self.textures.len(),
            materials: self.materials.len(),
            lights: self.lights.len(),
        }
    }
}
