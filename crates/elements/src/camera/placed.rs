//! Where a camera is, and when: what all cameras that look from a place share.

use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Motion, Transform};

/// Parameters of the place and the shutter.
pub(super) const PARAMS: [ParamDoc; 4] = [
    ParamDoc {
        name: "world_from_camera",
        ty: "transform",
        default: "identity",
        doc: "looks along +Z, +Y up",
    },
    ParamDoc {
        name: "world_from_camera_end",
        ty: "transform",
        default: "the same",
        doc: "where it is at time 1, if it moves from time 0 on",
    },
    ParamDoc { name: "shutter_open", ty: "float", default: "0", doc: "start of the exposure" },
    ParamDoc { name: "shutter_close", ty: "float", default: "0", doc: "end of the exposure" },
];

/// A place in the world that may move while the shutter is open.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// At time 0.
    pub start: Transform,
    motion: Option<Arc<Motion>>,
    shutter: [f32; 2],
}

impl Placed {
    pub(super) fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        let start = params.transform("world_from_camera")?;
        let motion = if params.has("world_from_camera_end") {
            let at = params.span("world_from_camera_end");
            let end = params.transform("world_from_camera_end")?;
            let motion = Motion::new(start, end).ok_or_else(|| {
                SceneError::invalid("no way leads from one of the camera's places to the other", at)
            })?;
            (start != end).then(|| Arc::new(motion))
        } else {
            None
        };
        let shutter = [params.float("shutter_open", 0.0)?, params.float("shutter_close", 0.0)?];
        Ok(Self { start, motion, shutter })
    }

    /// The time at a share of the exposure.
    #[inline]
    pub(super) fn time(&self, share: f32) -> f32 {
        self.shutter[0] + (self.shutter[1] - self.shutter[0]) * share
    }

    /// What `look` sees from where the camera is at a time.
    #[inline]
    pub(super) fn at<R>(&self, time: f32, look: impl FnOnce(&Transform) -> R) -> R {
        match &self.motion {
            None => look(&self.start),
            Some(motion) => look(&motion.at(time)),
        }
    }
}
