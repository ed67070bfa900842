//! The manual pages of what the compiler itself understands: films, groups and instances.

use aureole_desc::ParamDoc;
use aureole_elements::Manual;

const fn param(name: &'static str, ty: &'static str, default: &'static str, doc: &'static str) -> ParamDoc {
    ParamDoc { name, ty, default, doc }
}

/// The image plane.
pub const FILM: Manual = Manual {
    kind: "film",
    summary: "The image plane: its size, and the part of it that is rendered.",
    params: &[
        param("width", "int", "256", "pixels across"),
        param("height", "int", "256", "pixels down"),
        param("crop_x", "int", "0", "first column that is rendered"),
        param("crop_y", "int", "0", "first row that is rendered"),
        param("crop_width", "int", "the rest", "columns that are rendered"),
        param("crop_height", "int", "the rest", "rows that are rendered"),
        param(
            "pixel_format",
            "string",
            "rgb",
            "`rgb`, `luminance`, `xyz`; or with coverage: `rgba`, `luminance_alpha`, `xyza`",
        ),
        param("gain", "float", "1", "what the image is multiplied by"),
        param("max_component", "float", "", "samples with a brighter channel are scaled down to it"),
        param("max_component_of", "string", "rgb", "what these channels are: `rgb` or `xyz`"),
        param("filename", "string", "", "where programs write the image unless told otherwise"),
    ],
};

/// Shapes that are described once.
pub const GROUP: Manual = Manual {
    kind: "group",
    summary: "Shapes that are seen only through instances.",
    params: &[param("shapes", "shapes", "", "the shapes")],
};

/// A group, placed.
pub const INSTANCE: Manual = Manual {
    kind: "instance",
    summary: "A group, placed in the world; any number of instances share its memory.",
    params: &[
        param("group", "shape", "", "the group"),
        param("world_from_object", "transform", "identity", "where it is"),
        param(
            "world_from_object_end",
            "transform",
            "the same",
            "where it is at time 1, if it moves from time 0 on",
        ),
    ],
};
