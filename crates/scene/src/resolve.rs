//! Names become ids: the compiler's side of the door to the elements.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aureole_desc::{Family, Limits, NodeId, Report, SceneDesc, SceneError, Span, Value};
use aureole_elements::{Camera, FilmSpec, Material, Resolver, Shape, Texture, texture};
use aureole_image::{Bitmap, Encoding, ImageLimits, read_bitmap};
use aureole_math::{Arena, Bounds3, Id};
use aureole_spectrum::{SpectrumRole, SpectrumSource};
use rustc_hash::FxHashMap;

/// A node that is being built, or has been, at some cost of evaluation.
#[derive(Clone, Copy)]
enum Progress<T> {
    Begun,
    Done(Id<T>, u64),
}

/// The compiler's state while elements are built.
pub(crate) struct Resolve<'a> {
    pub desc: &'a SceneDesc,
    pub report: &'a mut Report,
    pub textures: Arena<Texture>,
    pub materials: Arena<Material>,
    pub film: FilmSpec,
    pub emitting_shape: Option<Id<Shape>>,
    /// The shape that a camera sits on.
    pub measured_shape: Option<Shape>,
    /// What the scene's shapes are within, once they are built.
    pub bounds: Bounds3,
    limits: Limits,
    /// Elements that are being built: each waits for the next.
    depth: usize,
    /// Evaluations that the element at work asks of others, so far.
    cost: u64,
    built_textures: FxHashMap<NodeId, Progress<Texture>>,
    built_materials: FxHashMap<NodeId, Progress<Material>>,
    bitmaps: FxHashMap<(PathBuf, String), Arc<Bitmap>>,
}

impl<'a> Resolve<'a> {
    pub(crate) fn new(desc: &'a SceneDesc, report: &'a mut Report, film: FilmSpec, limits: Limits) -> Self {
        Self {
            desc,
            report,
            textures: Arena::new(),
            materials: Arena::new(),
            film,
            emitting_shape: None,
            measured_shape: None,
            bounds: Bounds3::EMPTY,
            limits,
            depth: 0,
            cost: 0,
            built_textures: FxHashMap::default(),
            built_materials: FxHashMap::default(),
            bitmaps: FxHashMap::default(),
        }
    }

    /// Checks that a node is of the family that its place asks for.
    pub(crate) fn expect(&self, node: NodeId, family: Family) -> Result<(), SceneError> {
        let found = &self.desc[node];
        if found.family == family {
            return Ok(());
        }
        Err(SceneError::invalid(format!("a {family} is wanted here, not a {}", found.family), found.span))
    }

    /// The node of every material.
    pub(crate) fn material_nodes(&self) -> FxHashMap<Id<Material>, NodeId> {
        let done = |(node, progress): (&NodeId, &Progress<Material>)| match progress {
            Progress::Done(id, _) => Some((*id, *node)),
            Progress::Begun => None,
        };
        self.built_materials.iter().filter_map(done).collect()
    }

    /// Builds an element below the current one; gives its cost too. Chains must not outgrow the stack, and two that both
    /// refer to two that both refer to two ... must not outgrow all patience.
    fn descend<T>(
        &mut self,
        node: NodeId,
        build: impl FnOnce(&mut Self) -> Result<T, SceneError>,
    ) -> Result<(T, u64), SceneError> {
        let at = self.desc[node].span;
        let check = |what: &str, found: u64, limit: u64, name| match found > limit {
            true => Err(SceneError::Limit { what: what.to_owned(), found, limit, name: Some(name), at }),
            false => Ok(()),
        };
        check(
            "the chain of elements that refer to each other",
            self.depth as u64,
            self.limits.max_nesting as u64,
            "max-nesting",
        )?;
        self.depth += 1;
        let others = std::mem::take(&mut self.cost);
        let built = build(self);
        self.depth -= 1;
        let cost = 1 + std::mem::replace(&mut self.cost, others);
        check(
            "the number of evaluations of one element",
            cost,
            self.limits.max_evaluations,
            "max-evaluations",
        )?;
        self.cost += cost;
        Ok((built?, cost))
    }

    fn cycle(&self, node: NodeId) -> SceneError {
        let node = &self.desc[node];
        let name = node.name.as_deref().unwrap_or(&node.kind);
        SceneError::invalid(format!("{} `{name}` refers to itself", node.family), node.span)
    }
}

impl Resolver for Resolve<'_> {
    fn texture(&mut self, node: NodeId) -> Result<Id<Texture>, SceneError> {
        match self.built_textures.get(&node) {
            Some(Progress::Done(id, cost)) => {
                self.cost += cost;
                return Ok(*id);
            }
            Some(Progress::Begun) => return Err(self.cycle(node)),
            None => {}
        }
        self.expect(node, Family::Texture)?;
        self.built_textures.insert(node, Progress::Begun);
        let desc = self.desc;
        let (built, cost) = self.descend(node, |this| Texture::build(&desc[node], this))?;
        let id = self.textures.push(built);
        self.built_textures.insert(node, Progress::Done(id, cost));
        Ok(id)
    }

    fn constant(&mut self, spectrum: &SpectrumSource, role: SpectrumRole) -> Id<Texture> {
        self.textures.push(texture::Constant::new(spectrum.prepare(role)).into())
    }

    fn material(&mut self, node: NodeId) -> Result<Id<Material>, SceneError> {
        match self.built_materials.get(&node) {
            Some(Progress::Done(id, cost)) => {
                self.cost += cost;
                return Ok(*id);
            }
            Some(Progress::Begun) => return Err(self.cycle(node)),
            None => {}
        }
        self.expect(node, Family::Bsdf)?;
        self.built_materials.insert(node, Progress::Begun);
        let desc = self.desc;
        let (built, cost) = self.descend(node, |this| Material::build(&desc[node], this))?;
        let id = self.materials.push(built);
        self.built_materials.insert(node, Progress::Done(id, cost));
        Ok(id)
    }

    fn bitmap(&mut self, path: &Path, encoding: Encoding, at: Span) -> Result<Arc<Bitmap>, SceneError> {
        let key = (path.to_owned(), format!("{encoding:?}"));
        if let Some(bitmap) = self.bitmaps.get(&key) {
            return Ok(bitmap.clone());
        }
        let max_pixels = self.limits.max_pixels;
        // Eight floats a pixel, where there may be more of them than usual.
        let max_bytes = ImageLimits::default().max_bytes.max(max_pixels.saturating_mul(32));
        let limits = ImageLimits { max_pixels, max_bytes };
        let bitmap = Arc::new(read_bitmap(path, encoding, &limits).unwrap_or_else(|error| {
            let mut help = "a magenta picture stands in for it".to_owned();
            if error.is_limit() {
                help += "; `--max-pixels N` raises the limit";
            }
            self.report.warn_with_help(error.to_string(), Some(help), at);
            Bitmap::placeholder([1.0, 0.0, 1.0])
        }));
        self.bitmaps.insert(key, bitmap.clone());
        Ok(bitmap)
    }

    fn camera(&mut self, node: NodeId, film: FilmSpec) -> Result<Camera, SceneError> {
        self.expect(node, Family::Camera)?;
        let mut described = self.desc[node].clone();
        if described.kind == "distant" && !self.bounds.is_empty() {
            let center = self.bounds.centroid().to_array().map(f64::from);
            described.params.push("scene_center", Value::Vec3(center), described.span);
            let radius = f64::from(self.bounds.radius());
            described.params.push("scene_radius", Value::Float(radius), described.span);
        }
        let whole = std::mem::replace(&mut self.film, film);
        let built = self.descend(node, |this| Camera::build(&described, this));
        self.film = whole;
        Ok(built?.0)
    }

    fn measured_shape(&self) -> Option<Shape> {
        self.measured_shape.clone()
    }

    fn film(&self) -> FilmSpec {
        self.film
    }

    fn emitting_shape(&self) -> Option<Id<Shape>> {
        self.emitting_shape
    }

    fn report(&mut self) -> &mut Report {
        self.report
    }

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn textures(&self) -> &Arena<Texture> {
        &self.textures
    }
}
