//! A small scene that elements can be built in.

use std::path::Path;
use std::sync::Arc;

use aureole_desc::{Family, Limits, Node, NodeId, Params, Report, SceneDesc, SceneError, Span, Value};
use aureole_elements::{Camera, FilmSpec, Light, Material, Resolver, Shape, Texture};
use aureole_image::{Bitmap, Encoding};
use aureole_math::{Arena, Id};
use aureole_spectrum::{SpectrumRole, SpectrumSource};

/// A description and the arenas of what was built from it.
pub(crate) struct World {
    desc: SceneDesc,
    pub(crate) textures: Arena<Texture>,
    pub(crate) materials: Arena<Material>,
    pub(crate) shapes: Arena<Shape>,
    emitting: Option<Id<Shape>>,
    /// The shape that a camera sits on.
    pub(crate) measured: Option<Shape>,
    film: FilmSpec,
    report: Report,
    limits: Limits,
    built: Vec<(Family, String)>,
}

impl Default for World {
    fn default() -> Self {
        Self {
            desc: SceneDesc::default(),
            textures: Arena::new(),
            materials: Arena::new(),
            shapes: Arena::new(),
            emitting: None,
            measured: None,
            film: FilmSpec { width: 256, height: 128 },
            report: Report::default(),
            limits: Limits::default(),
            built: Vec::new(),
        }
    }
}

/// Parameters from a list.
pub(crate) fn params<const N: usize>(list: [(&str, Value); N]) -> Params {
    list.into_iter().fold(Params::new(), |params, (name, value)| params.with(name, value))
}

/// A colour.
pub(crate) fn rgb(r: f32, g: f32, b: f32) -> Value {
    Value::Spectrum(SpectrumSource::Rgb([r, g, b]))
}

/// A word.
pub(crate) fn word(text: &str) -> Value {
    Value::String(text.to_owned())
}

impl World {
    /// A world whose film is a square.
    pub(crate) fn half_as_wide() -> Self {
        Self { film: FilmSpec { width: 128, height: 128 }, ..Self::default() }
    }

    /// Describes an element for others to refer to.
    pub(crate) fn add<const N: usize>(
        &mut self,
        family: Family,
        kind: &str,
        list: [(&str, Value); N],
    ) -> Value {
        Value::Node(self.desc.add(Node::new(family, kind, params(list), Span::NONE)))
    }

    /// Fails unless an element of each kind was built, and without warnings.
    pub(crate) fn assert_complete(&self, family: Family, kinds: &[&str]) {
        for kind in kinds {
            let is_it = |(f, k): &(Family, String)| *f == family && k == kind;
            assert!(self.built.iter().any(is_it), "no example of {family} `{kind}`");
        }
        assert!(self.report.warnings.is_empty(), "{:?}", self.report);
    }

    fn note(&mut self, node: NodeId) -> Node {
        let node = self.desc[node].clone();
        self.built.push((node.family, node.kind.clone()));
        node
    }

    pub(crate) fn shape(&mut self, kind: &str, params: Params) -> Id<Shape> {
        self.built.push((Family::Shape, kind.to_owned()));
        let node = Node::new(Family::Shape, kind, params, Span::NONE);
        let shape = Shape::build(&node, self).unwrap_or_else(|error| panic!("{kind}: {error}"));
        self.shapes.push(shape)
    }

    pub(crate) fn light(&mut self, kind: &str, params: Params, on: Option<Id<Shape>>) -> Light {
        self.emitting = on;
        self.built.push((Family::Light, kind.to_owned()));
        let node = Node::new(Family::Light, kind, params, Span::NONE);
        Light::build(&node, self).unwrap_or_else(|error| panic!("{kind}: {error}"))
    }

    pub(crate) fn material_of(&mut self, value: &Value) -> Id<Material> {
        let Value::Node(id) = value else { panic!("not a node: {value:?}") };
        self.material(*id).unwrap_or_else(|error| panic!("{error}"))
    }

    pub(crate) fn texture_of(&mut self, value: &Value) -> Id<Texture> {
        let Value::Node(id) = value else { panic!("not a node: {value:?}") };
        self.texture(*id).unwrap_or_else(|error| panic!("{error}"))
    }
}

impl Resolver for World {
    fn texture(&mut self, node: NodeId) -> Result<Id<Texture>, SceneError> {
        let texture = Texture::build(&self.note(node), self)?;
        Ok(self.textures.push(texture))
    }

    fn constant(&mut self, spectrum: &SpectrumSource, role: SpectrumRole) -> Id<Texture> {
        self.textures.push(aureole_elements::texture::Constant::new(spectrum.prepare(role)).into())
    }

    fn material(&mut self, node: NodeId) -> Result<Id<Material>, SceneError> {
        let material = Material::build(&self.note(node), self)?;
        Ok(self.materials.push(material))
    }

    fn bitmap(&mut self, _: &Path, _: Encoding, _: Span) -> Result<Arc<Bitmap>, SceneError> {
        Ok(Arc::new(picture()))
    }

    fn film(&self) -> FilmSpec {
        self.film
    }

    fn emitting_shape(&self) -> Option<Id<Shape>> {
        self.emitting
    }

    fn camera(&mut self, node: NodeId, film: FilmSpec) -> Result<Camera, SceneError> {
        let node = self.note(node);
        let whole = std::mem::replace(&mut self.film, film);
        let camera = Camera::build(&node, self);
        self.film = whole;
        camera
    }

    fn measured_shape(&self) -> Option<Shape> {
        self.measured.clone()
    }

    fn report(&mut self) -> &mut Report {
        &mut self.report
    }

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn textures(&self) -> &Arena<Texture> {
        &self.textures
    }
}

/// A small picture with a bright spot.
fn picture() -> Bitmap {
    let (width, height) = (16, 8);
    let texel = |x: usize, y: usize| {
        let spot = if (x, y) == (11, 2) { 20.0 } else { 0.0 };
        [0.2 + 0.05 * x as f32 + spot, 0.3 + 0.05 * y as f32 + spot, 0.5]
    };
    let floats = (0..width * height).flat_map(|i| texel(i % width, i / width)).collect();
    Bitmap::from_floats(width, height, 3, floats, Encoding::Linear).expect("as many floats as texels ask for")
}
