//! Filters, samplers, textures, shapes, BSDFs, lights, cameras: a folder a family, a file a thing.
