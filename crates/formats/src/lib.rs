//! Readers of scene and mesh files: pbrt-v4, Mitsuba 3, PLY, OBJ, serialized; the embedded gallery.
