//! Shapes.

use std::sync::Arc;

use aureole_desc::{Family, Instance, Limits, Node, NodeId, Params, SceneError, Span, Value};
use aureole_math::Transform;
use aureole_spectrum::SpectrumSource;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::scope::{Scope, resolve};
use super::translate::{MeshKey, Orientation, ReadMesh, Translator};
use super::tree::{ObjectId, Tag};
use super::{ellipsoids, sensor};
use crate::mesh::{MeshFile, curves, obj, ply, serialized, vol};

/// Mitsuba's plugins and Aureole's words for them.
pub(super) const KINDS: &[(&str, &str)] = &[
    ("sphere", "sphere"),
    ("disk", "disk"),
    ("rectangle", "rectangle"),
    ("cube", "cube"),
    ("cylinder", "cylinder"),
    ("obj", "mesh"),
    ("ply", "mesh"),
    ("serialized", "mesh"),
    ("shapegroup", "group"),
    ("instance", "instance"),
    ("merge", "merge"),
    ("sdfgrid", "sdf_grid"),
    ("heightfield", "height_field"),
    ("bsplinecurve", "tube"),
    ("linearcurve", "tube"),
    ("ellipsoids", "sphere"),
    ("ellipsoidsmesh", "sphere"),
];

/// Adds a shape of the scene. Groups appear only by their instances; merged shapes are shapes like others.
pub(super) fn root(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<(), SceneError> {
    if let Some(instance) = placed(t, id)? {
        t.scene.instances.push(instance);
        return Ok(());
    }
    let mut shapes = Vec::new();
    gather(t, id, &mut shapes, 0)?;
    t.scene.shapes.extend(shapes);
    Ok(())
}

/// The nodes of a shape, several for `merge`.
fn gather(
    t: &mut Translator<'_, '_, '_>,
    id: ObjectId,
    shapes: &mut Vec<NodeId>,
    depth: usize,
) -> Result<(), SceneError> {
    let tree = t.tree;
    let object = tree.get(id);
    t.count_gathered(object.span)?;
    match object.plugin.as_str() {
        "shapegroup" => Ok(()),
        "ellipsoids" | "ellipsoidsmesh" => ellipsoids::gather(t, id, shapes),
        "merge" if depth > t.context.options.limits.max_nesting => {
            Err(SceneError::invalid("`merge` contains itself", object.span))
        }
        "merge" => {
            let mut scope = Scope::new(tree, object)?;
            while let Some(child) = scope.take_child(&[Tag::Shape]) {
                gather(t, child.id, shapes, depth + 1)?;
            }
            t.leave(&scope);
            Ok(())
        }
        _ => {
            if let Value::Node(shape) = t.value(id)? {
                shapes.push(shape);
            }
            Ok(())
        }
    }
}

/// An instance that says no more than what stands where; others are nodes, which warn about the rest.
fn placed(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<Option<Instance>, SceneError> {
    let tree = t.tree;
    let object = tree.get(id);
    if object.plugin != "instance" || object.id.is_some() {
        return Ok(None);
    }
    let [child] = &object.children[..] else { return Ok(None) };
    let group = resolve(tree, child)?;
    let place = match (object.values.len(), object.values.get("to_world")) {
        (0, _) => Transform::IDENTITY,
        (1, Some(Value::Transform(place))) => *place,
        _ => return Ok(None),
    };
    if tree.get(group.id).plugin != "shapegroup" {
        return Ok(None);
    }
    match t.value(group.id)? {
        Value::Node(group) => Ok(Instance::new(group, &place, object.span)),
        _ => Ok(None),
    }
}

pub(super) fn translate<'a>(
    t: &mut Translator<'a, '_, '_>,
    mut scope: Scope<'a>,
) -> Result<NodeId, SceneError> {
    let kind = t.kind(&scope, Family::Shape, KINDS)?;
    scope.rename("to_world", "world_from_object");
    // For derivatives only.
    scope.ignore(&["silhouette_sampling_weight"]);
    match kind {
        "group" => return group(t, scope),
        "instance" => {
            let group = scope.take_child(&[Tag::Shape]);
            let group = group.ok_or_else(|| scope.missing("shapegroup", "a nested group or <ref>"))?;
            if t.tree.get(group.id).plugin != "shapegroup" {
                return Err(SceneError::invalid("an instance needs a `shapegroup`", group.span));
            }
            t.put(&mut scope, "group", group)?;
        }
        "mesh" => mesh(t, &mut scope)?,
        "sphere" => turn_if_mirrored(&mut scope)?,
        "sdf_grid" => sdf_grid(t, &mut scope)?,
        "tube" => tube(t, &mut scope)?,
        "height_field" => height_field(t, &mut scope)?,
        _ => {}
    }
    surface(t, &mut scope)?;
    let meter = scope.take_child(&[Tag::Sensor]);
    let shape = t.finish(scope, Family::Shape, kind)?;
    if let Some(meter) = meter {
        sensor::on_shape(t, meter.id, shape)?;
    }
    Ok(shape)
}

/// What a shape is made of, whether it shines, and what it encloses.
pub(super) fn surface<'a>(t: &mut Translator<'a, '_, '_>, scope: &mut Scope<'a>) -> Result<(), SceneError> {
    let emitter = scope.take_child(&[Tag::Emitter]);
    // No path from the camera finds a light of a single direction, in Mitsuba neither.
    if let Some(emitter) = emitter.filter(|child| t.tree.get(child.id).plugin != "directionalarea") {
        t.put(scope, "emission", emitter)?;
    }
    match scope.take_child(&[Tag::Bsdf]) {
        Some(bsdf) => t.put(scope, "bsdf", bsdf)?,
        // A light without a material reflects nothing in Mitsuba.
        None if emitter.is_some() => {
            let black = Value::Spectrum(SpectrumSource::Uniform(0.0));
            let params = Params::new().with("reflectance", black);
            let node = t.scene.add(Node::new(Family::Bsdf, "diffuse", params, scope.span()));
            scope.out.push("bsdf", Value::Node(node), scope.span());
        }
        None => {}
    }
    for side in ["interior", "exterior"] {
        if let Some(medium) = scope.take_named(side) {
            t.put(scope, side, medium)?;
        }
    }
    Ok(())
}

fn group<'a>(t: &mut Translator<'a, '_, '_>, mut scope: Scope<'a>) -> Result<NodeId, SceneError> {
    let mut shapes = Vec::new();
    while let Some(child) = scope.take_child(&[Tag::Shape]) {
        gather(t, child.id, &mut shapes, 0)?;
    }
    if shapes.is_empty() {
        return Err(scope.missing("shape", "at least one shape inside"));
    }
    scope.out.push("shapes", Value::Nodes(shapes), scope.span());
    t.finish(scope, Family::Shape, "group")
}

/// Mitsuba's spheres, and its meshes whose normals follow from their faces, turn inside out when they are mirrored.
fn turn_if_mirrored(scope: &mut Scope<'_>) -> Result<(), SceneError> {
    if scope.values.transform("world_from_object")?.swaps_handedness() {
        let flip_normals = scope.bool("flip_normals", false)?;
        scope.out.push("flip_normals", Value::Bool(!flip_normals), scope.span());
    }
    Ok(())
}

/// A mesh that a shape asks for.
struct MeshRequest<'a> {
    plugin: &'a str,
    key: MeshKey,
    at: Span,
}

/// Reads the meshes of all shapes, side by side. Those that fail are tried again, and complained about, by their shapes.
pub(super) fn read_meshes(t: &mut Translator<'_, '_, '_>) {
    let tree = t.tree;
    let is_mesh = |plugin: &str| KINDS.contains(&(plugin, "mesh"));
    let mut requests: Vec<MeshRequest<'_>> = Vec::new();
    let mut known = FxHashSet::default();
    for object in tree.objects().filter(|object| object.tag == Tag::Shape && is_mesh(&object.plugin)) {
        let request = Scope::new(tree, object).and_then(|mut scope| mesh_request(t, &mut scope));
        requests.extend(request.ok().filter(|request| known.insert(request.key.clone())));
    }
    let limits = &t.context.options.limits;
    let read = requests.into_par_iter().filter_map(|request| {
        let mesh = read_mesh(limits, &request).ok()?;
        Some((request.key, mesh))
    });
    t.meshes = read.collect::<Vec<_>>().into_iter().collect();
}

/// What mesh a shape asks for; its parameters about that are taken.
fn mesh_request<'a>(
    t: &mut Translator<'a, '_, '_>,
    scope: &mut Scope<'a>,
) -> Result<MeshRequest<'a>, SceneError> {
    let (path, at) = t.path(scope, "filename")?;
    let plugin = scope.object.plugin.as_str();
    let index = match scope.int("shape_index")? {
        Some(index) => usize::try_from(index)
            .map_err(|_| SceneError::invalid("`shape_index` is negative", scope.span()))?,
        None => 0,
    };
    let face_normals = scope.bool("face_normals", false)?;
    // Mitsuba turns the texture coordinates of OBJ files round, unless told not to.
    let flip_v = scope.bool("flip_tex_coords", plugin == "obj")?;
    let max_smooth_angle = scope.float("max_smooth_angle")?.map(f64::to_bits);
    scope.ignore(&["collapse", "fold"]);
    Ok(MeshRequest { plugin, key: MeshKey { path, index, flip_v, face_normals, max_smooth_angle }, at })
}

/// Gives a shape its mesh, which it shares with all that want it in the same way.
fn mesh<'a>(t: &mut Translator<'a, '_, '_>, scope: &mut Scope<'a>) -> Result<(), SceneError> {
    let request = mesh_request(t, scope)?;
    let read = match t.meshes.get(&request.key) {
        Some(known) => known.clone(),
        None => read_mesh(&t.context.options.limits, &request)?,
    };
    for note in read.notes.iter() {
        t.context.report.warn(format!("`{}`: {note}", request.key.path.display()), request.at);
    }
    if scope.bool("srgb", false)? && !read.mesh.attributes.is_empty() {
        t.context.report.warn("`srgb` is not heeded: colours of vertices are linear", scope.span());
    }
    if read.orientation == Orientation::ByFaces {
        turn_if_mirrored(scope)?;
    }
    scope.out.push("mesh", Value::Mesh(read.mesh), request.at);
    if request.key.face_normals {
        scope.out.push("face_normals", Value::Bool(true), scope.span());
    }
    Ok(())
}

fn read_mesh(
    limits: &Limits,
    MeshRequest { plugin, key, at }: &MeshRequest<'_>,
) -> Result<ReadMesh, SceneError> {
    let mut face_normals = key.face_normals;
    let MeshFile { mut mesh, notes } = match *plugin {
        "obj" => obj::read(&key.path, limits, *at)?,
        "ply" => ply::read(&key.path, limits, *at)?,
        _ => {
            let read = serialized::read(&key.path, key.index, limits, *at)?;
            face_normals |= read.face_normals;
            MeshFile { mesh: read.mesh, notes: Vec::new() }
        }
    };
    if key.flip_v {
        mesh.uvs.iter_mut().for_each(|[_, v]| *v = 1.0 - *v);
    }
    let max_smooth_angle = key.max_smooth_angle.map(f64::from_bits).filter(|_| !face_normals);
    let keeps_normals = !face_normals && max_smooth_angle.is_none() && !mesh.normals.is_empty();
    let orientation = if keeps_normals { Orientation::ByNormals } else { Orientation::ByFaces };
    if !keeps_normals {
        mesh.normals.clear();
    }
    match max_smooth_angle {
        Some(degrees) => mesh.add_smooth_normals_up_to(degrees.to_radians() as f32),
        // Meshes are smooth in Mitsuba unless they are told to be flat.
        None if !keeps_normals && !face_normals => mesh.add_smooth_normals(),
        None => {}
    }
    Ok(ReadMesh { mesh: Arc::new(mesh), orientation, notes: notes.into() })
}

/// A grid of signed distances, with its values.
fn sdf_grid(t: &mut Translator<'_, '_, '_>, scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let (path, at) = t.path(scope, "filename")?;
    let grid = vol::read(&path, &t.context.options.limits, at)?;
    if grid.channels != 1 {
        let message = format!("signed distances have one channel, this file has {}", grid.channels);
        return Err(SceneError::Asset { path, message, at });
    }
    scope.out.push("values", Value::Floats(grid.values), at);
    scope.out.push("resolution", Value::Ints(grid.resolution.map(|n| n as i32).as_slice().into()), at);
    Ok(())
}

/// Curves with a radius at each control point. Rays never meet them from inside.
fn tube(t: &mut Translator<'_, '_, '_>, scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let (path, at) = t.path(scope, "filename")?;
    let (basis, least) = if scope.object.plugin == "linearcurve" { ("linear", 2) } else { ("bspline", 4) };
    let curves = curves::read(&path, least, &t.context.options.limits, at)?;
    scope.out.push("points", Value::Floats(curves.points), at);
    scope.out.push("counts", Value::Ints(curves.counts), at);
    scope.out.push("basis", Value::String(basis.to_owned()), scope.span());
    scope.out.push("cull_back", Value::Bool(true), scope.span());
    Ok(())
}

/// Heights from a picture's raw numbers, or from a texture inside.
fn height_field<'a>(t: &mut Translator<'a, '_, '_>, scope: &mut Scope<'a>) -> Result<(), SceneError> {
    if let Some(texture) = scope.take_child(&[Tag::Texture]) {
        t.put(scope, "texture", texture)?;
    } else {
        let (path, at) = t.path(scope, "filename")?;
        let params = Params::new()
            .with("filename", Value::Path(path))
            .with("encoding", Value::String("linear".to_owned()))
            .with("wrap", Value::String("clamp".to_owned()));
        let texture = t.scene.add(Node::new(Family::Texture, "bitmap", params, at));
        scope.out.push("texture", Value::Node(texture), at);
    }
    if let (Some(width), Some(height)) = (scope.int("width")?, scope.int("height")?) {
        let side = |n: i64| i32::try_from(n).unwrap_or(0);
        scope.out.push("resolution", Value::Ints([side(width), side(height)].into()), scope.span());
    }
    let scale = [scope.float("height_scale")?, scope.float("scale")?].into_iter().flatten().next();
    scope.out.push("height_scale", Value::Float(scale.unwrap_or(1.0)), scope.span());
    if !scope.bool("shading_normals", true)? {
        scope.out.push("face_normals", Value::Bool(true), scope.span());
    }
    Ok(())
}
