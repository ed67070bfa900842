//! Normals and tangents of an OpenPBR surface's layers.

use aureole_desc::{Params, SceneError};
use aureole_math::{Frame, Id, Vector3};
use aureole_spectrum::SpectrumRole;

use super::super::MaterialContext;
use super::super::bend::towards_viewer;
use crate::{Resolver, Texture, spectrum_texture};

/// How a layer's shading frame is turned, by pictures of vectors in the surface's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bearing {
    normal: Option<Id<Texture>>,
    tangent: Option<Id<Texture>>,
}

impl Bearing {
    /// Reads the pair of parameters of a layer.
    pub(super) fn from_params(
        params: &mut Params,
        resolver: &mut dyn Resolver,
        [normal, tangent]: [&str; 2],
    ) -> Result<Self, SceneError> {
        let mut given = |name: &str| match params.has(name) {
            true => spectrum_texture(params, resolver, name, 0.0, SpectrumRole::Unbounded).map(Some),
            false => Ok(None),
        };
        Ok(Self { normal: given(normal)?, tangent: given(tangent)? })
    }

    pub(super) fn is_turned(&self) -> bool {
        self.normal.is_some() || self.tangent.is_some()
    }

    /// The place as this layer sees it.
    pub(super) fn at<'a>(&self, at: &MaterialContext<'a>) -> MaterialContext<'a> {
        if !self.is_turned() {
            return *at;
        }
        let vector = |texture: Option<Id<Texture>>, otherwise: Vector3| {
            let [x, y, z] = at.texture.spectrum(texture?).rgb().map(|c| 2.0 * c - 1.0);
            Some(at.frame.to_world(Vector3::new(x, y, z)).try_normalized().unwrap_or(otherwise))
        };
        let n = vector(self.normal, at.frame.n).map_or(at.frame.n, |bent| towards_viewer(bent, at));
        let tangent = vector(self.tangent, at.frame.s).unwrap_or(at.frame.s);
        MaterialContext { frame: Frame::from_normal_and_tangent(n, tangent), ..*at }
    }
}
