//! `cube`: the cube [-1, 1]³, normals outwards, every side with uv from 0 to 1.

use aureole_desc::{Mesh, ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Point2, Point3, Ray, Transform, Vector3};

use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint, TriangleMesh};
use crate::{Element, Resolver};

/// A box: to the accelerator twelve triangles.
#[derive(Clone, Debug)]
pub struct Cube(TriangleMesh);

impl Cube {
    /// The cube [-1, 1]³ placed by a transform.
    ///
    /// # Errors
    /// A transform that makes vertices infinite.
    pub fn new(world_from_object: &Transform, flip_normals: bool) -> Result<Self, SceneError> {
        // Origin, u axis and v axis of each side; u × v points outwards. The layout is Mitsuba's.
        const SIDES: [[[f32; 3]; 3]; 6] = [
            [[1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [-2.0, 0.0, 0.0]],
            [[1.0, 1.0, -1.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 2.0]],
            [[1.0, -1.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]],
            [[1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [-2.0, 0.0, 0.0]],
            [[-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, -2.0]],
            [[1.0, 1.0, -1.0], [0.0, -2.0, 0.0], [-2.0, 0.0, 0.0]],
        ];
        const UVS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let mut mesh = Mesh::default();
        for [origin, u, v] in SIDES {
            let base = mesh.positions.len() as u32;
            for [a, b] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
                mesh.positions.push(std::array::from_fn(|i| origin[i] + a * u[i] + b * v[i]));
            }
            mesh.uvs.extend(UVS);
            mesh.indices.extend([[base, base + 1, base + 2], [base + 3, base, base + 2]]);
        }
        TriangleMesh::new(&mesh, world_from_object, flip_normals, true).map(Self)
    }
}

impl Element for Cube {
    const SUMMARY: &'static str = "The cube [-1, 1]^3.";
    const PARAMS: &'static [ParamDoc] = &[];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        Self::new(&placement.world_from_object, placement.flip_normals)
    }
}

super::mesh::delegate_to_mesh!(Cube);

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::{Point3, Vector3};

    #[test]
    fn normals_point_outwards() {
        let cube = Cube::new(&Transform::IDENTITY, false).unwrap();
        assert!((cube.area() - 24.0).abs() < 1e-5);
        for primitive in 0..12 {
            let hit = ShapeHit { t: 1.0, primitive, uv: [0.3, 0.3] };
            let surface = cube.surface(&Ray::new(Point3::ORIGIN, Vector3::Z), &hit);
            assert!(surface.ng.dot(surface.p.to_vector()) > 0.9, "side {primitive}");
        }
    }
}
