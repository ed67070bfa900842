//! A mesh file on its own: the object on a ground, framed by a camera and lit.
//!
//! +Y is up, as exporters have it. A PLY file without normals is smoothed (scans are round), an OBJ file without normals
//! is flat (as its format says). Materials of OBJ files come from their libraries.

mod material;
mod stage;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aureole_desc::{Family, Node, NodeId, Params, SceneDesc, SceneError, Span, Value};
use rustc_hash::FxHashMap;

use crate::file::{self, SearchPath};
use crate::format::{Context, Format, Input};
use crate::mesh::obj::{self, ObjFile, ObjMaterial, Split};
use crate::mesh::{MeshError, ply};

/// PLY files.
pub(crate) const PLY: Format = Format {
    name: "ply",
    summary: "Stanford polygon meshes",
    suffixes: &["ply"],
    sniff: |start| start.starts_with(b"ply\n") || start.starts_with(b"ply\r"),
    read: read_ply,
};

/// OBJ files.
pub(crate) const OBJ: Format = Format {
    name: "obj",
    summary: "Wavefront objects with materials",
    suffixes: &["obj"],
    sniff: |start| start.is_ascii() && start.split(|&b| b == b'\n').any(|line| line.starts_with(b"v ")),
    read: read_obj,
};

/// The file's bytes, and a span that names the file.
fn bytes(input: Input<'_>, context: &mut Context<'_>) -> Result<(Vec<u8>, Span), SceneError> {
    let bytes = match input.text {
        Some(text) => text.as_bytes().to_vec(),
        None => file::read_bytes(input.path, &context.options.limits, Span::NONE)?,
    };
    let source = context.sources.add_binary(input.path);
    Ok((bytes, Span::new(source, 0, 0)))
}

fn read_ply(input: Input<'_>, context: &mut Context<'_>) -> Result<SceneDesc, SceneError> {
    let (bytes, at) = bytes(input, context)?;
    let mut mesh =
        ply::decode(&bytes, &context.options.limits).map_err(|error| error.in_file(input.path, at))?;
    if mesh.normals.is_empty() {
        mesh.add_smooth_normals();
    }
    let mut scene = SceneDesc::default();
    let material = match mesh.attributes.iter().find(|attribute| attribute.name.ends_with("_color")) {
        Some(colors) => {
            let name = Value::String(colors.name.clone());
            let params = Params::new().with("name", name);
            Value::Node(scene.add(Node::new(Family::Texture, "mesh_attribute", params, at)))
        }
        None => Value::Float(0.7),
    };
    let bsdf = material::two_sided_diffuse(&mut scene, material, at);
    stage::set(&mut scene, [&mesh].into_iter(), input.path, at)?;
    let params = Params::new().with("mesh", Value::Mesh(Arc::new(mesh))).with("bsdf", Value::Node(bsdf));
    add_shape(&mut scene, params, stem(input.path), at);
    Ok(scene)
}

fn read_obj(input: Input<'_>, context: &mut Context<'_>) -> Result<SceneDesc, SceneError> {
    let (bytes, at) = bytes(input, context)?;
    let in_file = |error: MeshError| error.in_file(input.path, at);
    let file = ObjFile::parse(&bytes, Split::Parts, &context.options.limits).map_err(in_file)?;
    if file.parts.is_empty() {
        return Err(in_file(MeshError::content("no faces")));
    }
    let mut scene = SceneDesc::default();
    stage::set(&mut scene, file.parts.iter().map(|part| &part.mesh), input.path, at)?;

    let library = libraries(&file, input.path, context, at);
    let mut materials = FxHashMap::default();
    for part in file.parts {
        let found = part.material.as_ref().and_then(|name| library.get(name));
        if let (None, Some(name)) = (found, &part.material) {
            context.report.warn(format!("no library has the material `{name}`: the default is used"), at);
        }
        let made = materials.entry(part.material.clone()).or_insert_with(|| match found {
            Some((material, folder)) => material::make(&mut scene, material, folder, context.report, at),
            None => material::default(&mut scene, at),
        });
        let face_normals = part.mesh.normals.is_empty();
        let mut params = Params::new()
            .with("mesh", Value::Mesh(Arc::new(part.mesh)))
            .with("face_normals", Value::Bool(face_normals))
            .with("bsdf", Value::Node(made.bsdf));
        if let Some(emission) = made.emission {
            params.push("emission", Value::Node(emission), at);
        }
        add_shape(&mut scene, params, part.name, at);
    }
    Ok(scene)
}

fn add_shape(scene: &mut SceneDesc, params: Params, name: String, at: Span) -> NodeId {
    let mut node = Node::new(Family::Shape, "mesh", params, at);
    node.name = Some(name).filter(|name| !name.is_empty());
    let id = scene.add(node);
    scene.shapes.push(id);
    id
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// All materials of a file's libraries, each with the folder that its textures are in. A missing library is a warning.
fn libraries(
    file: &ObjFile,
    path: &Path,
    context: &mut Context<'_>,
    at: Span,
) -> FxHashMap<String, (ObjMaterial, PathBuf)> {
    let mut materials = FxHashMap::default();
    for name in &file.libraries {
        let library = SearchPath::beside(path).resolve(name);
        match file::read_text(&library, &context.options.limits, context.sources, at) {
            Ok((_, text)) => {
                let folder = library.parent().unwrap_or(Path::new("")).to_owned();
                let named = obj::parse_materials(&text).into_iter();
                materials.extend(named.map(|material| (material.name.clone(), (material, folder.clone()))));
            }
            Err(error) => context.report.warn(format!("{error}: default materials are used"), at),
        }
    }
    materials
}

#[cfg(test)]
mod tests;
