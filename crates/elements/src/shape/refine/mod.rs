//! Meshes that become finer before they are rendered: subdivision surfaces and displacement.
//!
//! | parameter of `mesh` | type | default | meaning |
//! |---|---|---|---|
//! | `subdivision` | string | none | `none`, `loop` (triangles) or `catmull_clark` (faces of any number of corners) |
//! | `levels` | int | 3 | how often each face is divided, 0 to 12 |
//! | `crease_edges` | ints | | of `catmull_clark`: pairs of vertices whose edges stay sharp |
//! | `crease_sharpness` | floats | infinite | levels for which each of them does; one number for all, or one each |
//! | `displacement` | texture | | moves the surface along its normals, in the mesh's own units |
//! | `edge_length` | float | 1 | longest edge of a displaced mesh before it is moved, in the world |
//!
//! Vertices at the same place are one: where texture coordinates or normals change from face to face, a surface does not
//! open. A displaced mesh is divided at its longest edges, each in its middle and only if it is too long, so that both
//! sides of an edge agree about it.

mod catmull_clark;
mod displace;
mod limit_surface;
mod loop_scheme;
mod weld;

use std::sync::Arc;

use aureole_desc::{Mesh, ParamDoc, Params, SceneError, Span, Textured};
use aureole_math::{Id, Transform};
use aureole_spectrum::SpectrumRole;

use crate::{Resolver, Texture};

/// How faces are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scheme {
    None,
    Loop,
    CatmullClark,
}

/// What a mesh's parameters ask for.
#[derive(Debug)]
pub(super) struct Refinement {
    scheme: Scheme,
    levels: u32,
    creases: Vec<([u32; 2], f32)>,
    displacement: Option<Id<Texture>>,
    edge_length: f32,
}

impl Refinement {
    pub(super) const SUBDIVISION: ParamDoc = ParamDoc {
        name: "subdivision",
        ty: "string",
        default: "none",
        doc: "`none`, `loop` (triangles) or `catmull_clark`",
    };
    pub(super) const LEVELS: ParamDoc =
        ParamDoc { name: "levels", ty: "int", default: "3", doc: "how often each face is divided" };
    pub(super) const CREASE_EDGES: ParamDoc = ParamDoc {
        name: "crease_edges",
        ty: "ints",
        default: "",
        doc: "of `catmull_clark`: pairs of vertices whose edges stay sharp",
    };
    pub(super) const CREASE_SHARPNESS: ParamDoc = ParamDoc {
        name: "crease_sharpness",
        ty: "floats",
        default: "infinite",
        doc: "levels for which they do; one number, or one for each edge",
    };
    pub(super) const DISPLACEMENT: ParamDoc = ParamDoc {
        name: "displacement",
        ty: "texture",
        default: "",
        doc: "moves the surface along its normals, in the mesh's units",
    };
    pub(super) const EDGE_LENGTH: ParamDoc = ParamDoc {
        name: "edge_length",
        ty: "float",
        default: "1",
        doc: "longest edge of a displaced mesh before it is moved, in the world",
    };

    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let scheme = params.one_of(
            "subdivision",
            &[("none", Scheme::None), ("loop", Scheme::Loop), ("catmull_clark", Scheme::CatmullClark)],
        )?;
        let levels = params.int_in("levels", 3, 0, 12)? as u32;
        let displacement = match params.try_textured("displacement")? {
            Some(Textured::Node(node)) => Some(resolver.texture(node)?),
            Some(Textured::Constant(c)) => Some(resolver.constant(&c, SpectrumRole::Unbounded)),
            None => None,
        };
        let edge_length = params.float_in("edge_length", 1.0, f32::MIN_POSITIVE, f32::MAX)?;
        Ok(Self { scheme, levels, creases: creases(params)?, displacement, edge_length })
    }

    /// The refined mesh, in the space of the given one; the same where nothing is asked for.
    pub(super) fn apply(
        &self,
        mesh: Arc<Mesh>,
        world_from_object: &Transform,
        resolver: &mut dyn Resolver,
    ) -> Result<Arc<Mesh>, SceneError> {
        if self.scheme == Scheme::None && self.displacement.is_none() {
            return Ok(mesh);
        }
        let invalid = |message: String| SceneError::invalid(message, Span::NONE);
        mesh.check().map_err(invalid)?;
        let limit = resolver.limits().max_mesh_elements.min(u64::from(u32::MAX) / 8);
        self.check(&mesh, limit)?;
        let mut mesh = match self.scheme {
            Scheme::None => mesh,
            Scheme::Loop => Arc::new(loop_scheme::subdivide(&mesh, self.levels).map_err(invalid)?),
            Scheme::CatmullClark => Arc::new(catmull_clark::subdivide(&mesh, self.levels, &self.creases)),
        };
        if let Some(texture) = self.displacement {
            let is_constant = resolver.textures().get(texture).is_some_and(Texture::is_constant);
            if mesh.uvs.is_empty() && !is_constant {
                let message = "the displaced mesh has no texture coordinates: they count as zero";
                resolver.report().warn(message, Span::NONE);
            }
            let fine = displace::tessellate(&mesh, world_from_object, self.edge_length, limit)
                .ok_or_else(|| too_many(u64::MAX, limit))?;
            mesh = Arc::new(displace::displace(fine, world_from_object, texture, resolver.textures()));
        }
        Ok(mesh)
    }

    /// Refuses more triangles than the limits allow.
    fn check(&self, mesh: &Mesh, limit: u64) -> Result<(), SceneError> {
        let faces = match self.scheme {
            Scheme::None => return Ok(()),
            Scheme::Loop => mesh.indices.len() as u64,
            // The first level makes a quadrilateral of each corner, and each ends as two triangles.
            Scheme::CatmullClark => mesh.faces().map(|(corners, _)| corners.len() as u64).sum::<u64>() / 2,
        };
        let found = faces.saturating_mul(1 << (2 * self.levels));
        if found > limit { Err(too_many(found, limit)) } else { Ok(()) }
    }
}

fn too_many(found: u64, limit: u64) -> SceneError {
    SceneError::Limit {
        what: "triangles of a refined mesh".into(),
        found,
        limit,
        name: Some("max-mesh-elements"),
        at: Span::NONE,
    }
}

/// The sharp edges and their sharpness.
fn creases(params: &mut Params) -> Result<Vec<([u32; 2], f32)>, SceneError> {
    let edges = params.try_ints("crease_edges")?;
    let sharpness = params.try_floats("crease_sharpness")?;
    let Some(edges) = edges else { return Ok(Vec::new()) };
    if !edges.len().is_multiple_of(2) || edges.iter().any(|&i| i < 0) {
        let at = params.span("crease_edges");
        return Err(SceneError::invalid("`crease_edges` must be pairs of vertex numbers", at));
    }
    let sharpness = sharpness.as_deref().unwrap_or(&[f32::INFINITY]);
    if sharpness.len() != 1 && sharpness.len() != edges.len() / 2 || sharpness.iter().any(|s| s.is_nan()) {
        let at = params.span("crease_sharpness");
        return Err(SceneError::invalid("`crease_sharpness` must be one number, or one for each edge", at));
    }
    let pairs = edges.chunks_exact(2).enumerate();
    Ok(pairs.map(|(i, e)| ([e[0] as u32, e[1] as u32], sharpness[i % sharpness.len()])).collect())
}
