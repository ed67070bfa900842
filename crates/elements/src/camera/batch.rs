//! `batch`: several cameras, whose pictures stand beside each other on one film.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `cameras` | cameras | | from left to right; the film's width is shared evenly |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Point2;

use super::{Camera, CameraOps, CameraRay, CameraSample};
use crate::{Element, FilmSpec, Resolver};

/// Cameras side by side.
#[derive(Clone, Debug)]
pub struct Batch {
    cameras: Vec<Camera>,
    /// Pixels across that each has.
    width: f32,
}

impl Element for Batch {
    const SUMMARY: &'static str = "Several cameras, whose pictures stand beside each other on one film.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "cameras", ty: "cameras", default: "", doc: "from left to right" }];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("cameras");
        let nodes = params.nodes("cameras")?;
        let film = resolver.film();
        let count = u32::try_from(nodes.len()).unwrap_or(u32::MAX);
        if count == 0 || !film.width.is_multiple_of(count) {
            let message = format!("a film {} pixels wide cannot be shared by {count} cameras", film.width);
            return Err(SceneError::invalid(message, at));
        }
        let film = FilmSpec { width: film.width / count, ..film };
        let cameras: Result<Vec<_>, _> = nodes.into_iter().map(|node| resolver.camera(node, film)).collect();
        Ok(Self { cameras: cameras?, width: film.width as f32 })
    }
}

impl CameraOps for Batch {
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        let place = ((sample.film.x / self.width) as usize).min(self.cameras.len() - 1);
        let film = Point2::new(sample.film.x - place as f32 * self.width, sample.film.y);
        self.cameras[place].generate_ray(&CameraSample { film, ..*sample })
    }
}
