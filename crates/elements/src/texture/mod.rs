//! Values that vary over surfaces.

mod bilerp;
mod bitmap;
mod checkerboard;
mod constant;
mod direction_mix;
mod dots;
mod footprint;
mod fractal;
mod grid;
mod mapping;
mod marble;
mod mesh_attribute;
mod mix;
mod noise;
mod power;
mod scale;
mod uv_map;
mod wrap;

use std::fmt::Debug;

use aureole_desc::Attribute;
use aureole_math::{Arena, Id, Point2, Point3, Vector2, Vector3};
use aureole_spectrum::{Spectrum, Wavelengths};

pub use bilerp::Bilerp;
pub use bitmap::BitmapTexture;
pub use checkerboard::Checkerboard;
pub use constant::Constant;
pub use direction_mix::DirectionMix;
pub use dots::Dots;
pub use footprint::Footprint;
pub(crate) use footprint::onto_plane;
pub use fractal::Fractal;
pub use grid::Grid;
pub use mapping::Mapping;
pub use marble::Marble;
pub use mesh_attribute::MeshAttribute;
pub use mix::Mix;
pub use power::Power;
pub use scale::Scale;
pub use uv_map::UvMap;

/// Where on a triangle mesh a texture is evaluated, for textures that read mesh attributes.
#[derive(Clone, Copy, Debug)]
pub struct MeshPoint<'a> {
    /// The mesh's attributes.
    pub attributes: &'a [Attribute],
    /// The triangle.
    pub face: u32,
    /// Its vertices.
    pub vertices: [u32; 3],
    /// Barycentric weights of the three vertices.
    pub barycentric: [f32; 3],
}

/// Where a texture is evaluated, and the textures that it may ask in turn.
#[derive(Clone, Copy, Debug)]
pub struct TextureContext<'a> {
    /// All textures of the scene.
    pub textures: &'a Arena<Texture>,
    /// What the lanes of the result mean.
    pub wavelengths: Wavelengths,
    /// Surface parameters; v = 0 is the bottom of an image.
    pub uv: Point2,
    /// World position.
    pub p: Point3,
    /// Unit shading normal.
    pub n: Vector3,
    /// Derivatives of position by u and v, for the derivatives of textures that depend on position.
    pub dp_duv: [Vector3; 2],
    /// The place on the mesh, if the surface is one.
    pub mesh: Option<MeshPoint<'a>>,
    /// What a pixel covers here, for textures that are filtered by it; not known where no texture asks.
    pub footprint: Option<Footprint>,
}

impl<'a> TextureContext<'a> {
    /// A context that knows nothing but uv, for lights and tests.
    pub fn at_uv(textures: &'a Arena<Texture>, wavelengths: Wavelengths, uv: Point2) -> Self {
        let (p, n) = (Point3::ORIGIN, Vector3::Z);
        Self { textures, wavelengths, uv, p, n, dp_duv: [Vector3::ZERO; 2], mesh: None, footprint: None }
    }

    /// The value of a texture here.
    #[inline]
    pub fn spectrum(&self, texture: Id<Texture>) -> Spectrum {
        self.textures[texture].eval(self)
    }

    /// The value of a texture that is a share of light: none, all, or something in between.
    #[inline]
    pub fn albedo(&self, texture: Id<Texture>) -> Spectrum {
        self.spectrum(texture).clamp(0.0, 1.0)
    }

    /// The value of a texture of numbers here: the first lane.
    #[inline]
    pub fn float(&self, texture: Id<Texture>) -> f32 {
        self.textures[texture].eval_float(self)
    }

    /// The derivative of a texture of numbers by u and v.
    pub fn gradient(&self, texture: Id<Texture>) -> Vector2 {
        self.textures[texture].gradient(self)
    }
}

/// What every texture can do.
pub trait TextureOps: Debug + Send + Sync {
    /// The value at a point.
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum;

    /// The value as one number: for coloured textures the luminance.
    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        let value = self.eval(at);
        aureole_spectrum::luminance(value.rgb())
    }

    /// The derivative of [`eval_float`](Self::eval_float) by u and v; by central differences unless a texture knows better.
    fn gradient(&self, at: &TextureContext<'_>) -> Vector2 {
        central_difference(self, at)
    }

    /// An estimate of the mean over the unit square, for choosing among lights and lobes.
    fn mean(&self, textures: &Arena<Texture>) -> Spectrum;

    /// Texels across and down, for textures made of texels.
    fn resolution(&self) -> Option<[u32; 2]> {
        None
    }

    /// Whether the value is the same everywhere.
    fn is_constant(&self) -> bool {
        false
    }

    /// Whether [`TextureContext::footprint`] makes a difference.
    fn is_filtered(&self) -> bool {
        false
    }
}

/// The derivative of a texture's number by u and v, from its values nearby.
fn central_difference<T: TextureOps + ?Sized>(texture: &T, at: &TextureContext<'_>) -> Vector2 {
    const STEP: f32 = 1.0 / 4096.0;
    let value = |du: f32, dv: f32| {
        let uv = Point2::new(at.uv.x + du, at.uv.y + dv);
        let p = at.p + at.dp_duv[0] * du + at.dp_duv[1] * dv;
        texture.eval_float(&TextureContext { uv, p, ..*at })
    };
    Vector2::new(
        (value(STEP, 0.0) - value(-STEP, 0.0)) / (2.0 * STEP),
        (value(0.0, STEP) - value(0.0, -STEP)) / (2.0 * STEP),
    )
}

registry! {
    ($)
    /// Any built-in texture.
    Texture: TextureOps, match with each_texture;
    constant::Constant as Constant = "constant",
    bitmap::BitmapTexture as Bitmap = "bitmap",
    checkerboard::Checkerboard as Checkerboard = "checkerboard",
    scale::Scale as Scale = "scale",
    mix::Mix as Mix = "mix",
    power::Power as Power = "power",
    bilerp::Bilerp as Bilerp = "bilerp",
    mesh_attribute::MeshAttribute as MeshAttribute = "mesh_attribute",
    direction_mix::DirectionMix as DirectionMix = "direction_mix",
    dots::Dots as Dots = "dots",
    fractal::Fractal as Fractal = "fractal",
    marble::Marble as Marble = "marble",
    grid::Grid as Grid = "grid",
}

impl Texture {
    /// The value at a point.
    #[inline]
    pub fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        each_texture!(self, t => t.eval(at))
    }

    /// The value as one number.
    #[inline]
    pub fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        each_texture!(self, t => t.eval_float(at))
    }

    /// The derivative of [`eval_float`](Self::eval_float) by u and v.
    pub fn gradient(&self, at: &TextureContext<'_>) -> Vector2 {
        each_texture!(self, t => t.gradient(at))
    }

    /// An estimate of the mean over the unit square.
    pub fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        each_texture!(self, t => t.mean(textures))
    }

    /// Texels across and down, for textures made of texels.
    pub fn resolution(&self) -> Option<[u32; 2]> {
        each_texture!(self, t => t.resolution())
    }

    /// Whether the value is the same everywhere.
    pub fn is_constant(&self) -> bool {
        each_texture!(self, t => t.is_constant())
    }

    /// Whether [`TextureContext::footprint`] makes a difference.
    pub fn is_filtered(&self) -> bool {
        each_texture!(self, t => t.is_filtered())
    }
}
