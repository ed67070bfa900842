//! Texture coordinates of corners on vertices.

use aureole_desc::Mesh;

/// Gives a mesh the texture coordinates of its triangles' corners: a vertex that has different ones in different faces becomes
/// several. Where they are not numbers, those of the vertex count.
///
/// The mesh must be sound.
pub(super) fn split_at_seams(mesh: &mut Mesh, corner_uvs: &[[f32; 2]]) {
    let own = |vertex: u32| mesh.uvs.get(vertex as usize).copied().unwrap_or_default();
    let corners = mesh.indices.iter().flatten().zip(corner_uvs);
    let uvs: Vec<[f32; 2]> =
        corners.map(|(&vertex, &uv)| if uv.iter().any(|x| x.is_nan()) { own(vertex) } else { uv }).collect();
    let corners = mesh.split_vertices(uvs.iter().map(|uv| uv.map(f32::to_bits)));
    mesh.uvs = corners.into_iter().map(|corner| corner.map(|i| uvs[i]).unwrap_or_default()).collect();
}
