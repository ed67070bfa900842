//! What `bump` and `normal_map` share: a material below a bent shading normal.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Frame, Id, Vector3};

use super::{Bsdf, Material, MaterialContext, nested_material};
use crate::Resolver;

/// Documentation of the parameters of materials that bend normals.
pub(super) const BEND_PARAMS: [ParamDoc; 4] = [
    ParamDoc { name: "bsdf", ty: "bsdf", default: "", doc: "the material" },
    ParamDoc {
        name: "keep_sides",
        ty: "bool",
        default: "true",
        doc: "no light where the bent normal and the true one take it to be on different sides",
    },
    ParamDoc {
        name: "flip_invalid_normals",
        ty: "bool",
        default: "true",
        doc: "mirror a bent normal that the viewer could only see from behind",
    },
    ParamDoc {
        name: "soften_terminator",
        ty: "bool",
        default: "true",
        doc: "fade light towards the true surface's horizon; with `keep_sides`",
    },
];

/// A material below a bent normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    pub(super) material: Id<Material>,
    keep_sides: bool,
    flip_invalid_normals: bool,
    soften_terminator: bool,
}

impl Bend {
    /// Reads the shared parameters.
    pub(super) fn from_params(
        params: &mut Params,
        resolver: &mut dyn Resolver,
        element: &str,
    ) -> Result<Self, SceneError> {
        Ok(Self {
            material: nested_material(params, resolver, "bsdf", element)?,
            keep_sides: params.bool("keep_sides", true)?,
            flip_invalid_normals: params.bool("flip_invalid_normals", true)?,
            soften_terminator: params.bool("soften_terminator", true)?,
        })
    }

    /// Evaluates the material as if the shading normal were `bent`.
    pub(super) fn evaluate(&self, bent: Vector3, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let n = at.frame.n;
        let bent = if self.keep_sides { bent } else { bent.face_forward(at.ng) };
        let bent = if self.flip_invalid_normals { towards_viewer(bent, at) } else { bent };
        let first = out.len();
        let frame = Frame::from_normal_and_tangent(bent, at.dp_du);
        MaterialContext { frame, ..*at }.nested(self.material, weight, out);
        if self.keep_sides {
            out.rebase(first, n, self.soften_terminator);
        }
    }
}

/// A bent normal, mirrored about the shading normal if the viewer could only see it from behind: its slope is kept.
pub(super) fn towards_viewer(bent: Vector3, at: &MaterialContext<'_>) -> Vector3 {
    let n = at.frame.n;
    let is_invalid = at.wo.dot(bent) * at.wo.dot(n) <= 0.0;
    if is_invalid { n * (2.0 * n.dot(bent)) - bent } else { bent }
}
