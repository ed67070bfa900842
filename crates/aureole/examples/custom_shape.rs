//! A shape of one's own: a ring, found by walking along the ray in steps of its distance [Hart 1996].

use aureole::elements::shape::{ShapeHit, ShapeKind, ShapeOps};
use aureole::elements::{Element, Resolver, SurfacePoint};
use aureole::math::{Bounds3, Frame, Point2, Ray};
use aureole::prelude::*;

/// A ring of radius 1 around Y; its tube has this radius.
#[derive(Debug)]
struct Ring(f32);

impl Ring {
    fn distance(&self, p: Point3) -> f32 {
        (p.x.hypot(p.z) - 1.0).hypot(p.y) - self.0
    }
}

impl Element for Ring {
    const SUMMARY: &'static str = "A ring.";
    const PARAMS: &'static [ParamDoc] = &[];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self(params.float_in("tube", 0.3, 0.01, 1.0)?))
    }
}

impl ShapeOps for Ring {
    fn bounds(&self) -> Bounds3 {
        let corner = Point3::new(1.0 + self.0, self.0, 1.0 + self.0);
        Bounds3::new(Point3::ORIGIN - corner.to_vector(), corner)
    }

    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        let walk = |t: &f32| Some(t + self.distance(ray.at(*t)).abs());
        let mut steps = std::iter::successors(Some(ray.t_min + 1e-3), walk).take(200);
        let t = steps.find(|t| self.distance(ray.at(*t)).abs() < 1e-5).filter(|t| *t < ray.t_max)?;
        Some(ShapeHit { t, primitive, uv: [0.0; 2] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let p = ray.at(hit.t);
        let slope = |axis: Vector3| self.distance(p + axis * 1e-3) - self.distance(p - axis * 1e-3);
        let n = Vector3::new(slope(Vector3::X), slope(Vector3::Y), slope(Vector3::Z)).normalized();
        let frame = Frame::from_normal(n);
        SurfacePoint::new(p, Vector3::splat(1e-4), n, Point2::new(0.0, 0.0), frame.s, frame.t)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut desc = SceneDesc::default();
    let params = Params::new().with("tube", Value::Float(0.4));
    desc.shapes = vec![desc.add(Node::new(Family::Shape, "ring", params, Span::NONE))];
    desc.lights = vec![desc.add(Node::new(Family::Light, "constant", Params::new(), Span::NONE))];
    let options = CompileOptions { shapes: vec![ShapeKind::of::<Ring>("ring")], ..CompileOptions::default() };
    let scene = compile(&desc, &options, &mut Report::default())?;
    let rendered = render(&scene, &RenderOptions::default(), &Silent)?;
    Ok(write_image(&rendered.image, &std::env::temp_dir().join("ring.png"), &WriteOptions::default())?)
}
