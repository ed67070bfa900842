//! Names become ids: the compiler's side of the door to the elements.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aureole_desc::{Family, NodeId, Report, SceneDesc, SceneError, Span};
use aureole_elements::{FilmSpec, Material, Resolver, Shape, Texture, texture};
use aureole_image::{Bitmap, Encoding, ImageLimits, read_bitmap};
use aureole_math::{Arena, Id};
use aureole_spectrum::{SpectrumRole, SpectrumSource};
use rustc_hash::FxHashMap;

/// A node that is being built, or has been.
#[derive(Clone, Copy)]
enum Progress<T> {
    Begun,
    Done(Id<T>),
}

/// The compiler's state while elements are built.
pub(crate) struct Resolve<'a> {
    pub desc: &'a SceneDesc,
    pub report: &'a mut Report,
    pub textures: Arena<Texture>,
    pub materials: Arena<Material>,
    pub film: FilmSpec,
    pub emitting_shape: Option<Id<Shape>>,
    image_limits: ImageLimits,
    built_textures: FxHashMap<NodeId, Progress<Texture>>,
    built_materials: FxHashMap<NodeId, Progress<Material>>,
    bitmaps: FxHashMap<(PathBuf, String), Arc<Bitmap>>,
}

impl<'a> Resolve<'a> {
    pub(crate) fn new(desc: &'a SceneDesc, report: &'a mut Report, film: FilmSpec, max_pixels: u64) -> Self {
        Self {
            desc,
            report,
            textures: Arena::new(),
            materials: Arena::new(),
            film,
            emitting_shape: None,
            image_limits: ImageLimits { max_pixels, ..ImageLimits::default() },
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

    fn cycle(&self, node: NodeId) -> SceneError {
        let node = &self.desc[node];
        let name = node.name.as_deref().unwrap_or(&node.kind);
        SceneError::invalid(format!("{} `{name}` refers to itself", node.family), node.span)
    }
}

impl Resolver for Resolve<'_> {
    fn texture(&mut self, node: NodeId) -> Result<Id<Texture>, SceneError> {
        match self.built_textures.get(&node) {
            Some(Progress::Done(id)) => return Ok(*id),
            Some(Progress::Begun) => return Err(self.cycle(node)),
            None => {}
        }
        self.expect(node, Family::Texture)?;
        self.built_textures.insert(node, Progress::Begun);
        let desc = self.desc;
        let built = Texture::build(&desc[node], self)?;
        let id = self.textures.push(built);
        self.built_textures.insert(node, Progress::Done(id));
        Ok(id)
    }

    fn constant(&mut self, spectrum: &SpectrumSource, role: SpectrumRole) -> Id<Texture> {
        self.textures.push(texture::Constant::new(spectrum.prepare(role)).into())
    }

    fn material(&mut self, node: NodeId) -> Result<Id<Material>, SceneError> {
        match self.built_materials.get(&node) {
            Some(Progress::Done(id)) => return Ok(*id),
            Some(Progress::Begun) => return Err(self.cycle(node)),
            None => {}
        }
        self.expect(node, Family::Bsdf)?;
        self.built_materials.insert(node, Progress::Begun);
        let desc = self.desc;
        let built = Material::build(&desc[node], self)?;
        let id = self.materials.push(built);
        self.built_materials.insert(node, Progress::Done(id));
        Ok(id)
    }

    fn bitmap(&mut self, path: &Path, encoding: Encoding, at: Span) -> Result<Arc<Bitmap>, SceneError> {
        let key = (path.to_owned(), format!("{encoding:?}"));
        if let Some(bitmap) = self.bitmaps.get(&key) {
            return Ok(bitmap.clone());
        }
        let bitmap = Arc::new(read_bitmap(path, encoding, &self.image_limits).unwrap_or_else(|error| {
            let help = "a magenta picture stands in for it".to_owned();
            self.report.warn_with_help(error.to_string(), Some(help), at);
            Bitmap::placeholder([1.0, 0.0, 1.0])
        }));
        self.bitmaps.insert(key, bitmap.clone());
        Ok(bitmap)
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
}
