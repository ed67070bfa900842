//! Ray-intersection structures: list, grid, binary and wide hierarchies, triangle-mesh kernels.
