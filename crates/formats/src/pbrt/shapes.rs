//! Shapes.

use std::path::PathBuf;
use std::sync::Arc;

use aureole_desc::{Family, Mesh, NodeId, Params, SceneError, Span, Value};
use aureole_math::{Transform, Vector3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::curve;
use super::params::ParamSet;
use super::quads::Parts;
use super::state::Reader;
use crate::mesh::{MeshFile, ply};

const KINDS: &[&str] =
    &["bilinearmesh", "curve", "cylinder", "disk", "loopsubdiv", "plymesh", "sphere", "trianglemesh"];

/// Texture coordinates of triangles of meshes that have none.
const DEFAULT_UVS: (&str, &str) = ("default_uvs", "half_square");

impl Reader<'_, '_> {
    pub(super) fn shape(&mut self, kind: &str, given: &ParamSet) -> Result<(), SceneError> {
        let at = given.span;
        let places = self.moving_ctm(at)?;
        let moves = places[0] != places[1] && self.open_object.is_none();
        // What moves becomes a group of its own, whose instance does.
        let ctm = if moves { Transform::IDENTITY } else { self.ctm(at)? };
        let mut params = Params::new();
        let (name, place) = match kind {
            "trianglemesh" => (self.triangle_mesh(given, &mut params)?, ctm),
            "plymesh" => (self.ply_mesh(given, &mut params)?, ctm),
            "bilinearmesh" => (bilinear_mesh(given, &mut params)?, ctm),
            "sphere" => (sphere(given, &mut params)?, ctm),
            "disk" => (disk(given, &mut params)?, ctm),
            "cylinder" => (cylinder(given, &mut params)?, ctm),
            "curve" => (curve::translate(given, &mut params)?, ctm),
            "loopsubdiv" => (self.loop_subdivision(given, &mut params)?, ctm),
            _ => {
                return Err(SceneError::UnknownKind {
                    family: Family::Shape,
                    kind: kind.to_owned(),
                    known: KINDS.iter().map(|k| (*k).to_owned()).collect(),
                    at,
                });
            }
        };
        params.push("world_from_object", Value::Transform(place), at);
        self.surface(given, &mut params, matches!(name, "mesh" | "bilinear_mesh"))?;
        let is_quadric = matches!(name, "sphere" | "disk" | "cylinder");
        // For meshes pbrt's normals stay outside when a transform mirrors them, for quadrics they turn round; but not where
        // points of lamps are drawn, which is what lights a room.
        let turns = is_quadric && place.swaps_handedness() && !params.has("emission");
        // The normals of subdivided surfaces are the cross products of tangents that go round the other way.
        let flip = self.state.reverse_orientation != (turns || kind == "loopsubdiv");
        params.push("flip_normals", Value::Bool(flip), at);
        given.finish(&format!("shape `{kind}`"), self.context.report);
        let id = self.add(Family::Shape, name, params, at);
        match &mut self.open_object {
            Some(object) => object.shapes.push(id),
            None if moves => {
                let group = Params::new().with("shapes", Value::Nodes(vec![id]));
                let group = self.add(Family::Shape, "group", group, at);
                self.instance(group, places, at);
            }
            None => self.desc.shapes.push(id),
        }
        Ok(())
    }

    /// Material, emission and cut-out.
    fn surface(
        &mut self,
        given: &ParamSet,
        params: &mut Params,
        has_many_primitives: bool,
    ) -> Result<(), SceneError> {
        let at = given.span;
        if let Some(alpha) = given.textured_float("alpha", self)? {
            params.push("alpha", alpha, given.at("alpha"));
        }
        if let Some(area_light) = self.state.area_light.clone() {
            if self.open_object.is_some() {
                self.warn("area lights in object definitions are ignored, as in pbrt", at);
            } else if self.state.material.is_some_and(|material| self.desc[material].kind == "null") {
                self.warn("surfaces of `interface` do not shine, as in pbrt", at);
            } else if self.state.ctm[0] != self.state.ctm[1] {
                self.warn("what moves does not shine, as in pbrt", at);
            } else {
                let emission = self.area_light(&area_light)?;
                params.push("emission", Value::Node(emission), area_light.span);
                if has_many_primitives && self.desc[emission].params.has("power_of") {
                    params.push("drawn", Value::String("each_alike".into()), area_light.span);
                }
            }
        }
        let material = match self.state.material {
            Some(material) => material,
            None => {
                let default = self.material("diffuse", &ParamSet::empty(at))?;
                self.state.material = Some(default);
                default
            }
        };
        params.push("bsdf", Value::Node(material), at);
        Ok(())
    }

    fn triangle_mesh(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let at = given.span;
        let triples = |name: &str| -> Result<Vec<[f32; 3]>, SceneError> {
            Ok(given.floats(name)?.unwrap_or_default().chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
        };
        let positions = triples("P")?;
        if positions.is_empty() {
            return Err(missing("trianglemesh", "P", "vertex positions", at));
        }
        let indices = match given.ints("indices")? {
            Some(list) => triangles(&list, given.at("indices"))?,
            None if positions.len() == 3 => vec![[0, 1, 2]],
            None => {
                return Err(missing("trianglemesh", "indices", "three vertex numbers for each triangle", at));
            }
        };
        let uvs = match given.floats("uv")? {
            Some(list) => Some(list),
            None => given.floats("st")?,
        };
        let uvs = uvs.unwrap_or_default().chunks_exact(2).map(|c| [c[0], c[1]]).collect();
        if given.get("S").is_some() {
            self.warn("tangents are those of the texture coordinates", given.at("S"));
        }
        given.get("faceIndices"); // for ptex
        let mesh = Mesh { positions, indices, normals: triples("N")?, uvs, ..Mesh::default() };
        mesh.check().map_err(|message| SceneError::invalid(message, at))?;
        params.push("mesh", Value::Mesh(Arc::new(mesh)), at);
        params.push(DEFAULT_UVS.0, Value::String(DEFAULT_UVS.1.into()), at);
        Ok("mesh")
    }

    fn loop_subdivision(
        &mut self,
        given: &ParamSet,
        params: &mut Params,
    ) -> Result<&'static str, SceneError> {
        let at = given.span;
        let list = given.floats("P")?.ok_or_else(|| missing("loopsubdiv", "P", "vertex positions", at))?;
        let indices = given.ints("indices")?;
        let indices =
            indices.ok_or_else(|| missing("loopsubdiv", "indices", "three vertex numbers a face", at))?;
        let control = Mesh {
            positions: list.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
            indices: triangles(&indices, given.at("indices"))?,
            ..Mesh::default()
        };
        control.check().map_err(|message| SceneError::invalid(message, at))?;
        given.get("scheme"); // there is but one
        params.push("subdivision", Value::String("loop".into()), at);
        params.push("levels", Value::Int(given.int("levels", 3)?), given.at("levels"));
        params.push("mesh", Value::Mesh(Arc::new(control)), at);
        params.push(DEFAULT_UVS.0, Value::String(DEFAULT_UVS.1.into()), at);
        Ok("mesh")
    }

    fn ply_mesh(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let path = given
            .path("filename", self)?
            .ok_or_else(|| missing("plymesh", "filename", "a PLY file", given.span))?;
        let edge_length = given.float("edgelength", 1.0)? * self.flags.edge_scale;
        if let Some(displacement) = given.textured_float("displacement", self)? {
            params.push("displacement", displacement, given.at("displacement"));
            params.push("edge_length", Value::Float(edge_length), given.at("edgelength"));
        }
        // All files are read at the end, side by side; until then the path stands in for the mesh.
        params.push("mesh", Value::Path(path), given.at("filename"));
        params.push(DEFAULT_UVS.0, Value::String(DEFAULT_UVS.1.into()), given.span);
        Ok("mesh")
    }

    /// Reads all mesh files side by side, each once, and gives the shapes their meshes.
    pub(super) fn read_meshes(&mut self) -> Result<(), SceneError> {
        let mut files: Vec<(PathBuf, Span)> = Vec::new();
        let mut index_of = FxHashMap::default();
        let mut users: Vec<(NodeId, usize, Span)> = Vec::new();
        for (id, node) in self.desc.nodes().filter(|(_, node)| node.kind == "mesh") {
            let Some(Value::Path(path)) = node.params.get("mesh") else { continue };
            let at = node.params.span("mesh");
            let index = *index_of.entry(path.clone()).or_insert_with(|| {
                files.push((path.clone(), at));
                files.len() - 1
            });
            users.push((id, index, at));
        }
        let limits = self.limits();
        let read = |(path, at): &(PathBuf, Span)| ply::read(path, limits, *at);
        let mut meshes = Vec::new();
        let mut errors = Vec::new();
        for result in files.par_iter().map(read).collect::<Vec<_>>() {
            let read = result.map_err(|error| errors.push(error)).ok();
            meshes.push(read.map(|MeshFile { mesh, notes }| (Arc::new(mesh), notes)));
        }
        let parts: Vec<_> =
            meshes.iter().map(|read| read.as_ref().and_then(|(mesh, _)| Parts::of(mesh))).collect();
        let mut patches_of = FxHashMap::default();
        for (id, index, at) in users {
            let Some((mesh, notes)) = &meshes[index] else { continue };
            for note in notes {
                let message = format!("`{}`: {note}", files[index].0.display());
                self.context.report.warn(message, files[index].1);
            }
            match &parts[index] {
                // What is displaced is triangles.
                Some(parts) if !self.desc[id].params.has("displacement") => {
                    if let Some(patches) = parts.put_into(&mut self.desc, id, at) {
                        patches_of.insert(id, patches);
                    }
                }
                _ => self.desc[id].params.push("mesh", Value::Mesh(mesh.clone()), at),
            }
        }
        super::quads::add_beside(&mut self.desc, &patches_of);
        let mut errors = errors.into_iter();
        let first = errors.next();
        self.context.report.errors.extend(errors);
        first.map_or(Ok(()), Err)
    }
}

pub(super) fn missing(element: &str, param: &str, wanted: &str, at: Span) -> SceneError {
    SceneError::MissingParam { element: element.into(), param: param.into(), wanted: wanted.into(), at }
}

/// Vertex numbers by threes.
fn triangles(list: &[i32], at: Span) -> Result<Vec<[u32; 3]>, SceneError> {
    if !list.len().is_multiple_of(3) || list.iter().any(|&i| i < 0) {
        return Err(SceneError::invalid("`indices` must be vertex numbers, three for each triangle", at));
    }
    Ok(list.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|i| i as u32)).collect())
}

fn bilinear_mesh(given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
    let at = given.span;
    let positions = given.floats("P")?.ok_or_else(|| missing("bilinearmesh", "P", "vertex positions", at))?;
    params.push("positions", Value::Floats(positions.into()), at);
    if let Some(indices) = given.ints("indices")? {
        params.push("indices", Value::Ints(indices.into()), given.at("indices"));
    }
    for (theirs, ours) in [("N", "normals"), ("uv", "uvs")] {
        if let Some(list) = given.floats(theirs)? {
            params.push(ours, Value::Floats(list.into()), given.at(theirs));
        }
    }
    // The one is for ptex, the other for where pbrt's light samples go.
    for name in ["faceIndices", "emissionfilename"] {
        given.get(name);
    }
    Ok("bilinear_mesh")
}

/// Copies a number where it is given.
fn copy(given: &ParamSet, params: &mut Params, names: &[(&str, &str)]) -> Result<(), SceneError> {
    for (theirs, ours) in names {
        if let Some(x) = given.try_float(theirs)? {
            params.push(*ours, Value::Float(x), given.at(theirs));
        }
    }
    Ok(())
}

fn sphere(given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
    copy(
        given,
        params,
        &[("radius", "radius"), ("zmin", "z_min"), ("zmax", "z_max"), ("phimax", "phi_max")],
    )?;
    params.push("flip_v", Value::Bool(true), given.span);
    Ok("sphere")
}

fn disk(given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
    let names =
        [("radius", "radius"), ("innerradius", "inner_radius"), ("height", "height"), ("phimax", "phi_max")];
    copy(given, params, &names)?;
    params.push("uv", Value::String("angle_radius".into()), given.span);
    Ok("disk")
}

fn cylinder(given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
    copy(given, params, &[("radius", "radius"), ("phimax", "phi_max")])?;
    let (a, b) = (given.float("zmin", -1.0)?, given.float("zmax", 1.0)?);
    params.push("p0", Value::Vec3([0.0, 0.0, a.min(b)]), given.span);
    params.push("p1", Value::Vec3([0.0, 0.0, a.max(b)]), given.span);
    Ok("cylinder")
}

/// The transform that puts +Z along a direction from a point.
pub(super) fn towards(from: [f64; 3], to: [f64; 3]) -> Option<Transform> {
    let point = |p: [f64; 3]| aureole_math::Point3::from(p.map(|x| x as f32));
    let direction = point(to) - point(from);
    let up = if direction.x.abs() < 1e-6 && direction.z.abs() < 1e-6 { Vector3::X } else { Vector3::Y };
    Transform::look_at(point(from), point(to), up)
}
