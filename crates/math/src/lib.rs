//! Points, vectors, frames, transforms, rays, bounds, warps, distributions, hashing, ids and arenas.
