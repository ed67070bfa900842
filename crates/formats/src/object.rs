//! A mesh file on its own: the object on a ground, framed by a camera and lit.
//!
//! +Y is up, as exporters have it. Meshes without normals are flat. Materials of OBJ files come from their libraries, pictures of PLY
//! files from their comments; where there is neither, colours of vertices and faces are shown. A picture replaces the colour of its
//! material, as modelling programs have it, and so do colours of vertices; a missing one is magenta.

mod lookup;
mod material;
mod stage;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aureole_desc::{Family, Mesh, Node, NodeId, Params, SceneDesc, SceneError, Span, Value, suggest};
use rustc_hash::{FxHashMap, FxHashSet};

use self::material::Maker;
use crate::file;
use crate::format::{Context, Format, Input};
use crate::mesh::lines::{lines, without_mark};
use crate::mesh::obj::{self, MaterialNote, ObjFile, ObjMaterial, Split, TextureMap};
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
    sniff: |start| {
        let start = without_mark(start);
        start.is_ascii() && lines(start).any(|(_, line)| line.starts_with(b"v "))
    },
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
    let mut file =
        ply::decode(&bytes, &context.options.limits).map_err(|error| error.in_file(input.path, at))?;
    context.report.warn_all(&file.notes, at);
    if file.mesh.uvs.is_empty() && !file.pictures.is_empty() {
        let message =
            format!("the picture `{}` is not shown: there are no texture coordinates", file.pictures[0]);
        context.report.warn(message, at);
        file.pictures.clear();
    }
    let mut scene = SceneDesc::default();
    stage::set(&mut scene, [&file.mesh].into_iter(), input.path, at)?;
    for (mut mesh, picture) in file.into_parts() {
        let mut maker = Maker { scene: &mut scene, folder: folder(input.path), report: context.report, at };
        let reflectance = match picture {
            Some(picture) => Value::Node(maker.texture(&TextureMap::of(picture), "auto")),
            None => maker.own_colors(material::own_colors(&mut mesh), Value::Float(0.7)),
        };
        let bsdf = material::two_sided_diffuse(&mut scene, reflectance, at);
        add_shape(&mut scene, shape(mesh, bsdf), stem(input.path), at);
    }
    Ok(scene)
}

fn read_obj(input: Input<'_>, context: &mut Context<'_>) -> Result<SceneDesc, SceneError> {
    let (bytes, at) = bytes(input, context)?;
    let in_file = |error: MeshError| error.in_file(input.path, at);
    let file = ObjFile::parse(&bytes, Split::Parts, &context.options.limits).map_err(in_file)?;
    if file.parts.is_empty() {
        return Err(in_file(file.no_faces()));
    }
    context.report.warn_all(&file.notes, at);
    let mut scene = SceneDesc::default();
    stage::set(&mut scene, file.parts.iter().map(|part| &part.mesh), input.path, at)?;

    let library = libraries(&file, input.path, context, at);
    let mut materials = FxHashMap::default();
    for mut part in file.parts {
        let found = part.material.as_ref().and_then(|name| library.get(name));
        if let (None, Some(name)) = (found, &part.material) {
            let help = suggest(name, library.keys().map(String::as_str))
                .map(|near| format!("did you mean `{near}`?"));
            let message = format!("no library has the material `{name}`: the default is used");
            context.report.warn_with_help(message, help, at);
        }
        let folder = found.map_or(folder(input.path), |(_, folder)| folder);
        let mut maker = Maker { scene: &mut scene, folder, report: context.report, at };
        let colors = material::own_colors(&mut part.mesh);
        let made = materials
            .entry((part.material, colors))
            .or_insert_with(|| maker.make(found.map(|(material, _)| material), colors));
        let mut params = shape(part.mesh, made.bsdf);
        if let Some(emission) = made.emission {
            params.push("emission", Value::Node(emission), at);
        }
        add_shape(&mut scene, params, part.name, at);
    }
    Ok(scene)
}

/// The parameters of a shape that is flat where it has no normals.
fn shape(mesh: Mesh, bsdf: NodeId) -> Params {
    let face_normals = mesh.normals.is_empty();
    Params::new()
        .with("mesh", Value::Mesh(Arc::new(mesh)))
        .with("face_normals", Value::Bool(face_normals))
        .with("bsdf", Value::Node(bsdf))
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

fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// All materials of a file's libraries, each with the folder that its textures are in; of those of one name the first counts. A
/// missing library is a warning.
fn libraries(
    file: &ObjFile,
    path: &Path,
    context: &mut Context<'_>,
    at: Span,
) -> FxHashMap<String, (ObjMaterial, PathBuf)> {
    let mut materials = FxHashMap::default();
    // Many programs name the library anew before each object.
    let mut seen_lines = FxHashSet::default();
    let lines = file.libraries.iter().filter(|line| seen_lines.insert(line.as_str()));
    let lines = lines.take(context.options.limits.max_files as usize);
    let mut seen = FxHashSet::default();
    for (name, library) in lines.flat_map(|line| lookup::libraries(folder(path), line)) {
        let library = library.unwrap_or_else(|| folder(path).join(name));
        if !seen.insert(library.clone()) {
            continue;
        }
        match file::read_text(&library, &context.options.limits, context.sources, at) {
            Ok((source, text)) => {
                let read = obj::parse_materials(&text);
                for MaterialNote { message, place } in read.notes {
                    context.report.warn(message, Span::new(source, place.start, place.end));
                }
                for material in read.list {
                    let folder = folder(&library).to_owned();
                    materials.entry(material.name.clone()).or_insert((material, folder));
                }
            }
            Err(error) => context.report.warn(format!("{error}: default materials are used"), at),
        }
    }
    materials
}

#[cfg(test)]
mod tests;
