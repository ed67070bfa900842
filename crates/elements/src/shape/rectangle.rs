//! `rectangle`: the square [-1, 1]² in the plane z = 0, its normal along +Z, uv from 0 to 1.

use aureole_desc::{Mesh, ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Point2, Ray, Transform};

use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint, TriangleMesh};
use crate::{Element, Resolver};

/// A parallelogram: to the accelerator two triangles.
#[derive(Clone, Debug)]
pub struct Rectangle(TriangleMesh);

impl Rectangle {
    /// The square [-1, 1]² placed by a transform.
    ///
    /// # Errors
    /// A transform that makes vertices infinite.
    pub fn new(world_from_object: &Transform, flip_normals: bool) -> Result<Self, SceneError> {
        let mesh = Mesh {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            indices: vec![[0, 1, 2], [2, 3, 0]],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            ..Mesh::default()
        };
        TriangleMesh::new(&mesh, world_from_object, flip_normals, true).map(Self)
    }
}

impl Element for Rectangle {
    const SUMMARY: &'static str = "The square [-1, 1]^2 in the plane z = 0, its normal along +Z.";
    const PARAMS: &'static [ParamDoc] = &[];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        Self::new(&placement.world_from_object, placement.flip_normals)
    }
}

super::mesh::delegate_to_mesh!(Rectangle);
