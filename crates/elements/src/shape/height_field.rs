//! `height_field`: heights over the square [-1, 1]², as in a map.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `heights` | floats | | z at the points of a grid, x fastest, from (-1, -1) on |
//! | `resolution` | ints | see below | points along x and along y, at least 2 |
//! | `texture` | texture | | instead of `heights`: its number at each point |
//! | `height_scale` | float | 1 | factor |
//! | `face_normals` | bool | false | facets instead of smooth normals |
//!
//! Without a `resolution`, a picture gives a point for each of its texels, any other texture 256 in each direction. uv is
//! (0, 0) at (-1, -1) and (1, 1) at (1, 1); a row of a picture is a row of points, its lowest at y = -1. Each cell becomes
//! two triangles, so that the accelerator's kernels meet it; the surface turns its outer side to +Z.

use std::sync::Arc;

use aureole_desc::{Mesh, ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Id, Point2, Point3, Ray, Vector3};
use aureole_spectrum::Wavelengths;

use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint, TriangleMesh};
use crate::{Element, Resolver, Texture, TextureContext};

/// Heights over a square: to the accelerator triangles.
#[derive(Clone, Debug)]
pub struct HeightField(TriangleMesh);

/// Points in each direction where nothing says how many.
const DEFAULT_RESOLUTION: u32 = 256;

impl Element for HeightField {
    const SUMMARY: &'static str = "Heights over the square [-1, 1]^2.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "heights", ty: "floats", default: "", doc: "z at the points of a grid, x fastest" },
        ParamDoc {
            name: "resolution",
            ty: "ints",
            default: "the picture's, or 256",
            doc: "points along x and along y",
        },
        ParamDoc { name: "texture", ty: "texture", default: "", doc: "instead of `heights`" },
        ParamDoc { name: "height_scale", ty: "float", default: "1", doc: "factor" },
        ParamDoc {
            name: "face_normals",
            ty: "bool",
            default: "false",
            doc: "facets instead of smooth normals",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let scale = params.float("height_scale", 1.0)?;
        let is_faceted = params.bool("face_normals", false)?;
        let texture = params.try_node("texture")?.map(|node| resolver.texture(node)).transpose()?;
        let given = match (params.try_ints("resolution")?.as_deref(), texture) {
            (Some([w, h]), _) => Some([*w, *h].map(|n| n.max(0) as u32)),
            (Some(_), _) => Some([0, 0]),
            (None, Some(id)) => resolver.textures()[id].resolution().or(Some([DEFAULT_RESOLUTION; 2])),
            (None, None) => None,
        };
        let heights = params.try_floats("heights")?;
        let at = params.span("resolution");
        let [width, height] = match (given, &heights) {
            (Some(resolution), _) => resolution,
            (None, Some(heights)) => [(heights.len() as f64).sqrt() as u32; 2],
            (None, None) => {
                return Err(SceneError::MissingParam {
                    element: "height_field".into(),
                    param: "heights".into(),
                    wanted: "a list of heights, or a `texture`".into(),
                    at: Span::NONE,
                });
            }
        };
        if width < 2 || height < 2 {
            return Err(SceneError::invalid("a height field needs two points in each direction", at));
        }
        let (found, limit) = (2 * u64::from(width) * u64::from(height), resolver.limits().max_mesh_elements);
        if found > limit.min(u64::from(u32::MAX)) {
            return Err(SceneError::Limit {
                what: "triangles of a height field".into(),
                found,
                limit,
                name: Some("max-mesh-elements"),
                at,
            });
        }
        let points = width as usize * height as usize;
        let heights: Arc<[f32]> = match (texture, heights) {
            (Some(texture), _) => sampled(texture, width, height, resolver).into(),
            (None, Some(heights)) if heights.len() == points => heights,
            (None, heights) => {
                let found = heights.map_or(0, |heights| heights.len());
                let message = format!("{found} heights for {width} x {height} points");
                return Err(SceneError::invalid(message, params.span("heights")));
            }
        };
        let mesh = grid(width, height, &heights, scale, is_faceted);
        let shines = params.has("emission");
        TriangleMesh::new(&mesh, &placement.world_from_object, placement.flip_normals, shines).map(Self)
    }
}

/// The numbers of a texture at the points of a grid: those of a picture of the same size are its texels.
fn sampled(texture: Id<Texture>, width: u32, height: u32, resolver: &dyn Resolver) -> Vec<f32> {
    let textures = resolver.textures();
    let has_texels = textures[texture].resolution() == Some([width, height]);
    let along = |i: u32, n: u32| match has_texels {
        true => (i as f32 + 0.5) / n as f32,
        false => i as f32 / (n - 1) as f32,
    };
    let value = |i: u32, j: u32| {
        let uv = Point2::new(along(i, width), along(j, height));
        let p = Point3::new(2.0 * uv.x - 1.0, 2.0 * uv.y - 1.0, 0.0);
        let dp_duv = [Vector3::X * 2.0, Vector3::Y * 2.0];
        let at = TextureContext { p, dp_duv, ..TextureContext::at_uv(textures, Wavelengths::RGB, uv) };
        at.float(texture)
    };
    (0..height).flat_map(|j| (0..width).map(move |i| (i, j))).map(|(i, j)| value(i, j)).collect()
}

/// Two triangles for each cell, with the normals of the slopes by central differences.
fn grid(width: u32, height: u32, heights: &[f32], scale: f32, is_faceted: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let z = |i: u32, j: u32| {
        let z = heights[(j * width + i) as usize] * scale;
        if z.is_finite() { z } else { 0.0 }
    };
    let (du, dv) = (1.0 / (width - 1) as f32, 1.0 / (height - 1) as f32);
    for j in 0..height {
        for i in 0..width {
            let uv = [i as f32 * du, j as f32 * dv];
            mesh.positions.push([2.0 * uv[0] - 1.0, 2.0 * uv[1] - 1.0, z(i, j)]);
            mesh.uvs.push(uv);
            if !is_faceted {
                let [left, right] = [i.saturating_sub(1), (i + 1).min(width - 1)];
                let [low, high] = [j.saturating_sub(1), (j + 1).min(height - 1)];
                let by_x = (z(right, j) - z(left, j)) / ((right - left) as f32 * 2.0 * du);
                let by_y = (z(i, high) - z(i, low)) / ((high - low) as f32 * 2.0 * dv);
                let n = Vector3::new(-by_x, -by_y, 1.0).try_normalized().unwrap_or(Vector3::Z);
                mesh.normals.push(n.to_array());
            }
        }
    }
    for j in 0..height - 1 {
        for a in (0..width - 1).map(|i| j * width + i) {
            mesh.indices.extend([[a, a + 1, a + width + 1], [a, a + width + 1, a + width]]);
        }
    }
    mesh
}

super::mesh::delegate_to_mesh!(HeightField);
