//! From description to scene.

use std::sync::Arc;

use aureole_accel::{AccelError, Config, Geometry, World};
use aureole_desc::{
    self as desc, Family, Limits, Node, NodeId, Params, Report, SceneDesc, SceneError, Span, Value,
};
use aureole_elements::light::Area;
use aureole_elements::{Camera, Filter, Light, Material, Resolver, Sampler, Shape, Texture, shape};
use aureole_math::{Arena, Bounds3, Id, Motion, Point3, Transform, Vector3};
use aureole_spectrum::{SpectrumRole, SpectrumSource, Wavelengths};
use rustc_hash::FxHashMap;

use crate::attributes;
use crate::film::Film;
use crate::lights::LightPicker;
use crate::origins::Origins;
use crate::resolve::Resolve;
use crate::scene::{Instance, Object, Place, Scene};

/// Options of a compilation.
#[derive(Clone, Debug, Default)]
pub struct CompileOptions {
    /// How acceleration structures are built.
    pub accel: Config,
    /// Which of the scene's cameras; the first by default.
    pub camera: usize,
    /// What a scene may ask for.
    pub limits: Limits,
    /// Kinds of shapes that the program defines itself.
    pub shapes: Vec<shape::ShapeKind>,
}

/// Builds every element of a description and the structures that answer rays.
///
/// # Errors
/// The first thing that is wrong; further ones are in the report.
pub fn compile(desc: &SceneDesc, options: &CompileOptions, report: &mut Report) -> Result<Scene, SceneError> {
    let film = Film::of(desc, &options.limits)?;
    attributes::check(desc, report);
    let resolve = Resolve::new(desc, report, film.full, options.limits);
    let mut compiler = Compiler {
        resolve,
        options,
        shapes: Arena::new(),
        lights: Arena::new(),
        levels: vec![Vec::new()],
        shining: vec![Vec::new()],
        worlds: FxHashMap::default(),
        unbounded: Vec::new(),
        default_material: None,
        begun_groups: Vec::new(),
        origins: Origins::default(),
    };
    let world = compiler.world()?;
    compiler.lights()?;
    let bounds = world.bounds();
    let camera = compiler.camera(bounds)?;
    let filter = compiler.root(desc.filter, Family::Filter, "box", Filter::build)?;
    let film = Film { border: border(&filter), gain: film.gain * camera.gain(), ..film };
    let sampler = compiler.root(desc.sampler, Family::Sampler, "sobol", Sampler::build)?;
    let integrator =
        desc.integrator.map_or_else(|| default_node(Family::Integrator, "path"), |id| desc[id].clone());
    Ok(compiler.finish(film, camera, filter, sampler, integrator, world))
}

/// Samples are shared by the pixels whose filters cover them. Filters of one pixel have nothing to share; those wider than
/// this, in pixels, would cost more than they save.
const WIDEST_SHARED: f32 = 4.0;

/// How many pixels beside its own a sample adds to.
fn border(filter: &Filter) -> [u32; 2] {
    let radius = filter.radius();
    let is_shared = radius.x.max(radius.y) > 0.5 && radius.x.max(radius.y) <= WIDEST_SHARED;
    [radius.x, radius.y].map(|r| if is_shared { (r - 0.5).ceil().max(0.0) as u32 } else { 0 })
}

const NOT_INVERTIBLE: &str = "the transform cannot be inverted";

struct Compiler<'a> {
    resolve: Resolve<'a>,
    options: &'a CompileOptions,
    shapes: Arena<Shape>,
    lights: Arena<Light>,
    /// What the geometries of each level are; level 0 is the world.
    levels: Vec<Vec<Object>>,
    /// What shines in each level but the world: geometry, light, and the node that describes the light.
    shining: Vec<Vec<(u32, Light, NodeId)>>,
    /// Groups that have been built.
    worlds: FxHashMap<NodeId, Arc<World>>,
    unbounded: Vec<Object>,
    default_material: Option<Id<Material>>,
    begun_groups: Vec<NodeId>,
    origins: Origins,
}

fn default_node(family: Family, kind: &str) -> Node {
    Node::new(family, kind, Params::new(), Span::NONE)
}

/// The way from one transform to another; none where they are the same.
fn motion(start: Transform, end: Transform, at: Span) -> Result<Option<Motion>, SceneError> {
    if start == end {
        return Ok(None);
    }
    let turns_over = start.swaps_handedness() != end.swaps_handedness();
    let motion = Motion::new(start, end).filter(|_| !turns_over);
    motion.map(Some).ok_or_else(|| {
        SceneError::invalid("no way without mirroring leads from one transform to the other", at)
    })
}

/// What a level is made of, as far as it is built.
struct Members {
    geometries: Vec<Geometry>,
    /// Where each was written.
    spans: Vec<Span>,
    first_error: Option<SceneError>,
}

impl Members {
    fn with_capacity(count: usize) -> Self {
        Self { geometries: Vec::with_capacity(count), spans: Vec::with_capacity(count), first_error: None }
    }

    /// Takes a geometry, if there is one, and collects all errors but the first.
    fn take(
        &mut self,
        built: Result<Option<Geometry>, SceneError>,
        at: Span,
        report: &mut Report,
    ) -> Result<(), SceneError> {
        match built {
            Ok(Some(geometry)) => {
                self.geometries.push(geometry);
                self.spans.push(at);
            }
            Ok(None) => {}
            Err(error) if self.first_error.is_none() => self.first_error = Some(error),
            Err(error) => report.collect(error)?,
        }
        Ok(())
    }
}

/// The geometry that an accelerator complains about.
fn geometry_of(error: &AccelError) -> Option<usize> {
    match error {
        AccelError::NonFinite { geometry, .. } | AccelError::BadIndex { geometry, .. } => Some(*geometry),
        _ => None,
    }
}

impl Compiler<'_> {
    fn world(&mut self) -> Result<World, SceneError> {
        let desc = self.resolve.desc;
        self.level(0, &desc.shapes, &desc.instances)
    }

    /// Builds the shapes of a level and what accelerates them. Goes on after errors, to report several at once.
    fn level(
        &mut self,
        level: usize,
        nodes: &[NodeId],
        instances: &[desc::Instance],
    ) -> Result<World, SceneError> {
        let count = nodes.len() + instances.len();
        self.levels[level].reserve_exact(count);
        let mut members = Members::with_capacity(count);
        for &node in nodes {
            let built = self.shape(level, node);
            members.take(built, self.resolve.desc[node].span, self.resolve.report)?;
        }
        for instance in instances {
            let built = self.placed(instance).map(Some);
            members.take(built, instance.span, self.resolve.report)?;
        }
        if let Some(error) = members.first_error {
            return Err(error);
        }
        let Members { geometries, spans, .. } = members;
        World::build(geometries, level as u32, &self.options.accel).map_err(|error| {
            let at = geometry_of(&error).and_then(|geometry| spans.get(geometry));
            SceneError::invalid(error.to_string(), at.copied().unwrap_or(Span::NONE))
        })
    }

    /// Builds a shape and says how the accelerator sees it; `None` for those that it does not see.
    fn shape(&mut self, level: usize, node: NodeId) -> Result<Option<Geometry>, SceneError> {
        self.resolve.expect(node, Family::Shape)?;
        match self.resolve.desc[node].kind.as_str() {
            "group" => Ok(None), // seen only through its instances
            "instance" => self.instance(level, node).map(Some),
            _ => self.solid(level, node),
        }
    }

    fn instance(&mut self, level: usize, node: NodeId) -> Result<Geometry, SceneError> {
        let desc = self.resolve.desc;
        let span = desc[node].span;
        if level > 0 {
            return Err(SceneError::invalid("an instance cannot be inside a group", span));
        }
        let mut params = desc[node].params.clone();
        let group = params.try_node("group")?.ok_or_else(|| SceneError::MissingParam {
            element: "instance".into(),
            param: "group".into(),
            wanted: "a group of shapes".into(),
            at: span,
        })?;
        let world_from_object = params.transform("world_from_object")?;
        if !world_from_object.is_invertible() {
            return Err(SceneError::invalid(NOT_INVERTIBLE, span));
        }
        let motion = match params.has("world_from_object_end") {
            true => {
                let at = params.span("world_from_object_end");
                motion(world_from_object, params.transform("world_from_object_end")?, at)?
            }
            false => None,
        };
        let (world, inner_level) = self.group(group)?;
        if let Some(motion) = motion {
            if !self.shining[inner_level as usize].is_empty() {
                self.resolve.report.warn("what moves does not shine: lights in this group are dark", span);
            }
            let place = Place::Moving(Box::new(motion.clone()));
            let instance = Instance { level: inner_level, place, lights: Box::default() };
            self.levels[0].push(Object::Instance(instance));
            return Ok(Geometry::MovingInstance { level: world, world_from_object: Box::new(motion) });
        }
        Ok(self.still(world, inner_level, world_from_object))
    }

    /// An instance that the description gives in few bytes.
    fn placed(&mut self, instance: &desc::Instance) -> Result<Geometry, SceneError> {
        let place = instance.transform().filter(Transform::is_invertible);
        let place = place.ok_or_else(|| SceneError::invalid(NOT_INVERTIBLE, instance.span))?;
        let (world, level) = self.group(instance.group)?;
        Ok(self.still(world, level, place))
    }

    /// An instance that does not move.
    fn still(&mut self, world: Arc<World>, inner_level: u32, place: Transform) -> Geometry {
        let place = Arc::new(place);
        let mut lights = Vec::new();
        for (geometry, light, node) in &self.shining[inner_level as usize] {
            self.origins.lights.push(*node);
            lights.push((*geometry, self.lights.push(light.placed(&place))));
        }
        let still = Place::Still(place.clone());
        let instance = Instance { level: inner_level, place: still, lights: lights.into() };
        self.levels[0].push(Object::Instance(instance));
        Geometry::Instance { level: world, world_from_object: place }
    }

    /// The world of a group, built once, and its level.
    fn group(&mut self, node: NodeId) -> Result<(Arc<World>, u32), SceneError> {
        if let (Some(world), Some(level)) =
            (self.worlds.get(&node), self.begun_groups.iter().position(|&g| g == node))
        {
            return Ok((world.clone(), level as u32 + 1));
        }
        self.resolve.expect(node, Family::Shape)?;
        let desc = self.resolve.desc;
        let mut params = desc[node].params.clone();
        let children = params.nodes("shapes")?;
        self.begun_groups.push(node);
        self.levels.push(Vec::new());
        self.shining.push(Vec::new());
        let level = self.levels.len() - 1;
        let world = Arc::new(self.level(level, &children, &[])?);
        self.worlds.insert(node, world.clone());
        Ok((world, level as u32))
    }

    fn build_shape(&mut self, node: &Node) -> Result<Shape, SceneError> {
        match self.options.shapes.iter().find(|kind| kind.manual.kind == node.kind) {
            Some(kind) => kind.build(node, &mut self.resolve),
            None => Shape::build(node, &mut self.resolve),
        }
    }

    /// Builds a shape that is really there, with its material, emission and cut-out.
    fn solid(&mut self, level: usize, node: NodeId) -> Result<Option<Geometry>, SceneError> {
        let desc = self.resolve.desc;
        let mut params = desc[node].params.clone();
        let bsdf = params.try_node("bsdf")?;
        let material = match bsdf {
            Some(bsdf) => self.resolve.material(bsdf)?,
            None => self.default_material()?,
        };
        let own_light = params.try_node("emission")?;
        let glow = bsdf.filter(|_| self.resolve.materials[material].shines(&self.resolve.materials));
        // Shapes that points are drawn from, for light of their material or to measure, have to know.
        let is_drawn_from = glow.is_some() || self.measured() == Some(node);
        let built = if is_drawn_from && own_light.is_none() {
            let mut shining = desc[node].clone();
            shining.params.push("emission", Value::Node(node), desc[node].span);
            self.build_shape(&shining)?
        } else {
            self.build_shape(&desc[node])?
        };
        let geometry = match built.geometry() {
            shape::Geometry::Triangles { positions, indices } => {
                Some(Geometry::Triangles { positions, indices })
            }
            shape::Geometry::Boxes(boxes) => Some(Geometry::User(boxes)),
            shape::Geometry::Unbounded => None,
        };
        let id = self.shapes.push(built);
        self.origins.shapes.push(node);
        let made = match (own_light, glow) {
            (Some(emission), _) => Some((self.emission(id, emission)?, emission)),
            (None, Some(bsdf)) => self.glow(id, material, bsdf, node),
            (None, None) => None,
        };
        let alpha = if params.has("alpha") {
            Some(aureole_elements::float_texture(&mut params, &mut self.resolve, "alpha", 1.0)?)
        } else {
            None
        };
        let light = match made.map(|(light, origin)| (self.cut_out(light, alpha), origin)) {
            // Each instance of the group makes a light of its own from it.
            Some((light, origin)) if level > 0 => {
                self.shining[level].push((self.levels[level].len() as u32, light, origin));
                None
            }
            Some((light, origin)) => {
                self.origins.lights.push(origin);
                Some(self.lights.push(light))
            }
            None => None,
        };
        for name in ["interior", "exterior"] {
            if params.has(name) {
                self.resolve.report.warn("participating media are not rendered yet", params.span(name));
            }
        }
        let object = Object::Solid { shape: id, material, light, alpha };
        match geometry {
            Some(_) => self.levels[level].push(object),
            None if level == 0 => self.unbounded.push(object),
            None => self.resolve.report.warn("an infinite plane inside a group is ignored", desc[node].span),
        }
        Ok(geometry)
    }

    /// A shape's light where its `alpha` leaves something of it.
    fn cut_out(&self, mut light: Light, alpha: Option<Id<Texture>>) -> Light {
        if let Some(alpha) = alpha {
            let textures = &self.resolve.textures;
            let is_constant = matches!(textures[alpha], Texture::Constant(_));
            light.cut_out(alpha, is_constant && textures[alpha].mean(textures).is_black());
        }
        light
    }

    /// The light of a shape whose material shines, and the node that it comes from.
    fn glow(
        &mut self,
        shape: Id<Shape>,
        material: Id<Material>,
        bsdf: NodeId,
        node: NodeId,
    ) -> Option<(Light, NodeId)> {
        if !self.shapes[shape].area().is_finite() {
            let message = "the material shines, but this shape cannot: its area is not known";
            self.resolve.report.warn(message, self.resolve.desc[node].span);
            return None;
        }
        Some((Area::of_material(shape, material).into(), bsdf))
    }

    fn emission(&mut self, shape: Id<Shape>, node: NodeId) -> Result<Light, SceneError> {
        self.resolve.expect(node, Family::Light)?;
        let desc = self.resolve.desc;
        if !self.shapes[shape].area().is_finite() {
            return Err(SceneError::invalid(
                "this shape cannot shine: its area is not known",
                desc[node].span,
            ));
        }
        self.resolve.emitting_shape = Some(shape);
        let light = Light::build(&desc[node], &mut self.resolve);
        self.resolve.emitting_shape = None;
        light
    }

    fn default_material(&mut self) -> Result<Id<Material>, SceneError> {
        if let Some(id) = self.default_material {
            return Ok(id);
        }
        let grey = self.resolve.constant(&SpectrumSource::Uniform(0.5), SpectrumRole::Albedo);
        let id = self.resolve.materials.push(aureole_elements::bsdf::Diffuse::new(grey).into());
        self.default_material = Some(id);
        Ok(id)
    }

    fn lights(&mut self) -> Result<(), SceneError> {
        let desc = self.resolve.desc;
        for &node in &desc.lights {
            self.resolve.expect(node, Family::Light)?;
            let light = Light::build(&desc[node], &mut self.resolve)?;
            self.origins.lights.push(node);
            self.lights.push(light);
        }
        if self.lights.is_empty() {
            self.resolve.report.warn("the scene has no lights: the image will be black", Span::NONE);
        }
        Ok(())
    }

    /// The shape that the chosen camera sits on.
    fn measured(&self) -> Option<NodeId> {
        let camera = &self.resolve.desc[*self.resolve.desc.cameras.get(self.options.camera)?];
        if camera.kind != "irradiance_meter" {
            return None;
        }
        camera.params.clone().try_node("shape").ok().flatten()
    }

    /// The chosen camera, or one that looks at everything.
    fn camera(&mut self, bounds: Bounds3) -> Result<Camera, SceneError> {
        let desc = self.resolve.desc;
        if let Some(&node) = desc.cameras.get(self.options.camera) {
            self.resolve.bounds = bounds;
            if let Some(shape) = self.measured() {
                let place = self.origins.shapes.iter().position(|&origin| origin == shape);
                self.resolve.measured_shape = place.map(|i| self.shapes[Id::new(i as u32)].clone());
            }
            let film = self.resolve.film;
            return self.resolve.camera(node, film);
        }
        if self.options.camera > 0 {
            let message =
                format!("there is no camera {}; the scene has {}", self.options.camera, desc.cameras.len());
            return Err(SceneError::invalid(message, Span::NONE));
        }
        self.resolve.report.warn("the scene has no camera: one that looks at everything is used", Span::NONE);
        let radius = bounds.radius().max(1e-3);
        let target = if bounds.is_empty() { Point3::ORIGIN } else { bounds.centroid() };
        let origin = target + Vector3::new(0.6, 0.5, 1.0).normalized() * (radius * 2.9);
        let place = Transform::look_at(origin, target, Vector3::Y).unwrap_or_default();
        let params = Params::new()
            .with("world_from_camera", Value::Transform(place))
            .with("fov_axis", Value::String("smaller".into()))
            .with("near_clip", Value::Float(f64::from(radius) * 1e-3))
            .with("far_clip", Value::Float(f64::from(radius) * 1e3));
        Camera::build(&Node::new(Family::Camera, "perspective", params, Span::NONE), &mut self.resolve)
    }

    /// Builds one of the scene's single elements, or its default.
    fn root<T>(
        &mut self,
        node: Option<NodeId>,
        family: Family,
        default: &str,
        build: fn(&Node, &mut dyn Resolver) -> Result<T, SceneError>,
    ) -> Result<T, SceneError> {
        let desc = self.resolve.desc;
        match node {
            Some(id) => {
                self.resolve.expect(id, family)?;
                build(&desc[id], &mut self.resolve)
            }
            None => build(&default_node(family, default), &mut self.resolve),
        }
    }

    fn finish(
        self,
        film: Film,
        camera: Camera,
        filter: Filter,
        sampler: Sampler,
        integrator: Node,
        world: World,
    ) -> Scene {
        let has_alpha =
            self.levels.iter().flatten().any(|object| matches!(object, Object::Solid { alpha: Some(_), .. }));
        let materials = &self.resolve.materials;
        let is_see_through = self.levels.iter().flatten().chain(&self.unbounded).any(|object| match object {
            Object::Solid { material, .. } => {
                materials[*material].is_see_through(materials, &self.resolve.textures)
            }
            Object::Instance(_) => false,
        });
        let follows_normals = materials
            .iter()
            .any(|(_, material)| matches!(material, Material::Bump(bump) if bump.follows_normals()));
        // Many samples a pixel do part of the filtering themselves, as in pbrt.
        let is_filtered = self.resolve.textures.iter().any(|(_, texture)| texture.is_filtered());
        let samples = sampler.sample_count().max(1) as f32;
        // They do so as far as they are spread over it.
        let spread = (filter.radius().x + filter.radius().y).min(1.0);
        let narrow = 1.0 - spread * (1.0 - samples.sqrt().recip());
        let footprint_scale = if is_filtered { narrow.max(0.125) } else { 0.0 };
        let environments =
            self.lights.iter().filter(|(_, light)| light.is_environment()).map(|(id, _)| id).collect();
        let origins = Origins { materials: self.resolve.material_nodes(), ..self.origins };
        let mut scene = Scene {
            origins,
            film,
            camera,
            filter,
            sampler,
            integrator,
            textures: self.resolve.textures,
            materials: self.resolve.materials,
            shapes: self.shapes,
            lights: self.lights,
            picker: LightPicker::default(),
            environments,
            world,
            levels: self.levels,
            unbounded: self.unbounded,
            has_alpha,
            is_see_through,
            follows_normals,
            footprint_scale,
        };
        let counts = scene.counts();
        tracing::debug!(counts.shapes, counts.primitives, counts.textures, counts.lights, "scene built");
        let context = scene.light_context(Wavelengths::RGB);
        let bounds = scene.world.bounds();
        let powers: Vec<f32> = scene.lights.iter().map(|(_, light)| light.power(&context, &bounds)).collect();
        scene.picker = LightPicker::new(&powers);
        scene
    }
}
