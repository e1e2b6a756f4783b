//! The closed set of bodies, each formula in its own file.

use std::sync::Arc;

use super::ray::{first_below, through_ball, through_slab};
use super::*;
use crate::scene::vector::along;

/// A shape with its apex at the origin, free side upwards.
#[derive(Clone, Debug)]
pub enum Body {
    /// `z = 0`.
    Plane,
    /// A ball.
    Sphere(Sphere),
    /// A round bar along x.
    Cylinder(Cylinder),
    /// A stretched ball.
    Ellipsoid(Ellipsoid),
    /// A ring lying flat.
    Torus(Torus),
    /// A dish.
    Paraboloid(Paraboloid),
    /// A pass.
    Saddle(Saddle),
    /// Three valleys, three ridges.
    MonkeySaddle(MonkeySaddle),
    /// A hill.
    Gaussian(GaussianBump),
    /// Waves.
    Sinusoid(Sinusoid),
    /// Pillow to box.
    Superquadric(Superquadric),
    /// The upper envelope of several.
    Union(Union),
    /// From elsewhere.
    Imported(Arc<dyn ImportedSurface>),
}

impl PartialEq for Body {
    fn eq(&self, other: &Body) -> bool {
        match (self, other) {
            (Body::Plane, Body::Plane) => true,
            (Body::Sphere(a), Body::Sphere(b)) => a == b,
            (Body::Cylinder(a), Body::Cylinder(b)) => a == b,
            (Body::Ellipsoid(a), Body::Ellipsoid(b)) => a == b,
            (Body::Torus(a), Body::Torus(b)) => a == b,
            (Body::Paraboloid(a), Body::Paraboloid(b)) => a == b,
            (Body::Saddle(a), Body::Saddle(b)) => a == b,
            (Body::MonkeySaddle(a), Body::MonkeySaddle(b)) => a == b,
            (Body::Gaussian(a), Body::Gaussian(b)) => a == b,
            (Body::Sinusoid(a), Body::Sinusoid(b)) => a == b,
            (Body::Superquadric(a), Body::Superquadric(b)) => a == b,
            (Body::Union(a), Body::Union(b)) => a == b,
            (Body::Imported(a), Body::Imported(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl Body {
    /// The word used for it in scene files.
    pub fn kind(&self) -> &'static str {
        match self {
            Body::Plane => "plane",
            Body::Sphere(_) => "sphere",
            Body::Cylinder(_) => "cylinder",
            Body::Ellipsoid(_) => "ellipsoid",
            Body::Torus(_) => "torus",
            Body::Paraboloid(_) => "paraboloid",
            Body::Saddle(_) => "saddle",
            Body::MonkeySaddle(_) => "monkey_saddle",
            Body::Gaussian(_) => "gaussian",
            Body::Sinusoid(_) => "sinusoid",
            Body::Superquadric(_) => "superquadric",
            Body::Union(_) => "union",
            Body::Imported(_) => "imported",
        }
    }

    #[inline]
    pub(crate) fn height(&self, x: f64, y: f64) -> Option<f64> {
        match self {
            Body::Plane => Some(0.0),
            Body::Sphere(sphere) => sphere.height(x, y),
            Body::Cylinder(cylinder) => cylinder.height(y),
            Body::Ellipsoid(ellipsoid) => ellipsoid.quadric().height(x, y),
            Body::Torus(torus) => torus.height(x, y),
            Body::Paraboloid(paraboloid) => paraboloid.quadric().height(x, y),
            Body::Saddle(saddle) => saddle.quadric().height(x, y),
            Body::MonkeySaddle(saddle) => Some(saddle.height(x, y)),
            Body::Gaussian(bump) => Some(bump.height(x, y)),
            Body::Sinusoid(waves) => Some(waves.height(x, y)),
            Body::Superquadric(superquadric) => superquadric.height(x, y),
            Body::Union(union) => union.uppermost(|part| part.height(x, y)).map(|(z, _)| z),
            Body::Imported(surface) => surface.jet(x, y).map(|jet| jet[0]),
        }
    }

    #[inline]
    pub(crate) fn local(&self, p: [f64; 3]) -> Option<Local> {
        match self {
            Body::Plane => Some(plane::local()),
            Body::Sphere(sphere) => Some(sphere.local(p)),
            Body::Cylinder(cylinder) => Some(cylinder.local(p)),
            Body::Ellipsoid(ellipsoid) => ellipsoid.quadric().local(p),
            Body::Torus(torus) => torus.local(p),
            Body::Paraboloid(paraboloid) => paraboloid.quadric().local(p),
            Body::Saddle(saddle) => saddle.quadric().local(p),
            Body::MonkeySaddle(saddle) => saddle.local(p[0], p[1]),
            Body::Gaussian(bump) => bump.local(p[0], p[1]),
            Body::Sinusoid(waves) => waves.local(p[0], p[1]),
            Body::Superquadric(superquadric) => superquadric.local(p),
            Body::Union(union) => union.touched(p)?.local(p),
            Body::Imported(surface) => {
                let [_, hx, hy, hxx, hxy, hyy] = surface.jet(p[0], p[1])?;
                Local::of_height([hx, hy, hxx, hxy, hyy])
            }
        }
    }

    /// Parameter of the uppermost point along `o + t d`.
    pub(crate) fn hit(&self, o: [f64; 3], d: [f64; 3]) -> Option<f64> {
        let above = |height: &dyn Fn(f64, f64) -> Option<f64>, t: f64| {
            let p = along(o, t, d);
            height(p[0], p[1]).map(|z| p[2] - z)
        };
        match self {
            Body::Plane => plane::QUADRIC.hit(o, d),
            Body::Sphere(sphere) => sphere.quadric().hit(o, d),
            Body::Cylinder(cylinder) => cylinder.quadric().hit(o, d),
            Body::Ellipsoid(ellipsoid) => ellipsoid.quadric().hit(o, d),
            Body::Paraboloid(paraboloid) => paraboloid.quadric().hit(o, d),
            Body::Saddle(saddle) => saddle.quadric().hit(o, d),
            Body::Torus(torus) => {
                let (low, high) = through_ball(o, d, [-torus.major, 0.0, -torus.minor], torus.major + torus.minor)?;
                first_below(low, high, |t| Some(torus.value(along(o, t, d))))
            }
            Body::Superquadric(superquadric) => {
                let [a, b, c] = superquadric.semi_axes;
                let (low, high) = through_ball(o, d, [0.0, 0.0, -c], a.hypot(b).hypot(c))?;
                first_below(low, high, |t| Some(superquadric.value(along(o, t, d))))
            }
            Body::Gaussian(bump) => {
                let (low, high) = widened(through_slab(o, d, -bump.height.abs(), bump.height.abs())?);
                first_below(low, high, |t| above(&|x, y| Some(bump.height(x, y)), t))
            }
            Body::Sinusoid(waves) => {
                let (low, high) =
                    widened(through_slab(o, d, -4.0 * waves.amplitude.abs(), 4.0 * waves.amplitude.abs())?);
                first_below(low, high, |t| above(&|x, y| Some(waves.height(x, y)), t))
            }
            Body::MonkeySaddle(saddle) => {
                let (low, high) = around(o, d, saddle.length)?;
                first_below(low, high, |t| above(&|x, y| Some(saddle.height(x, y)), t))
            }
            Body::Imported(surface) => {
                let (low, high) = around(o, d, 0.0)?;
                first_below(low, high, |t| above(&|x, y| surface.jet(x, y).map(|jet| jet[0]), t))
            }
            Body::Union(union) => union.uppermost(|part| part.hit(o, d)).map(|(t, _)| t),
        }
    }
}

/// A little more than the range, so that its ends lie off the surface.
fn widened((low, high): (f64, f64)) -> (f64, f64) {
    let margin = 1e-3 * (high - low);
    (low - margin, high + margin)
}

/// A range of heights that holds an unbounded height field about the patch: four times its distance from the origin.
fn around(o: [f64; 3], d: [f64; 3], length: f64) -> Option<(f64, f64)> {
    let half = 4.0 * (o[0].hypot(o[1]).hypot(o[2]) + length);
    through_slab(o, d, -half, half)
}
