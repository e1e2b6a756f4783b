//! Sizes that a body can have.

use super::{Body, Surface};
use crate::scene::SceneError;
use crate::scene::error::{finite, positive};

impl Surface {
    /// Every number of the surface is in its range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), SceneError> {
        match &self.body {
            Body::Plane | Body::Imported(_) => Ok(()),
            Body::Sphere(sphere) => positive("surface.radius", sphere.radius),
            Body::Cylinder(cylinder) => positive("surface.radius", cylinder.radius),
            Body::Ellipsoid(ellipsoid) => all_positive("surface.semi_axes", &ellipsoid.semi_axes),
            Body::Paraboloid(paraboloid) => all_not_zero("surface.radii", &paraboloid.radii),
            Body::Saddle(saddle) => all_not_zero("surface.radii", &saddle.radii),
            Body::MonkeySaddle(saddle) => positive("surface.length", saddle.length),
            Body::Gaussian(bump) => {
                finite("surface.height", bump.height)?;
                positive("surface.width", bump.width)
            }
            Body::Sinusoid(waves) => {
                finite("surface.amplitude", waves.amplitude)?;
                positive("surface.wavelength", waves.wavelength)?;
                waves.wavelength_y.map_or(Ok(()), |l| positive("surface.wavelength", l))
            }
            Body::Torus(torus) => {
                positive("surface.major", torus.major)?;
                positive("surface.minor", torus.minor)?;
                if torus.minor < torus.major {
                    return Ok(());
                }
                Err(SceneError::Clash {
                    first: format!("surface.minor = {}", torus.minor),
                    second: format!("surface.major = {}", torus.major),
                    why: "the tube is thinner than the ring is wide".into(),
                })
            }
            Body::Superquadric(superquadric) => {
                all_positive("surface.semi_axes", &superquadric.semi_axes)?;
                for exponent in superquadric.exponents {
                    if !(exponent > 0.0 && exponent <= 1.0) {
                        let expected =
                            "an exponent above 0, at most 1, is needed (beyond 1 there are edges without normals)";
                        return Err(SceneError::range("surface.exponents", exponent, expected));
                    }
                }
                Ok(())
            }
            Body::Union(union) => {
                if union.parts.is_empty() {
                    return Err(SceneError::List {
                        key: "surface.parts".into(),
                        expected: "at least one part is needed",
                    });
                }
                union.parts.iter().try_for_each(Surface::check)
            }
        }
    }
}

fn all_positive(key: &str, values: &[f64]) -> Result<(), SceneError> {
    values.iter().try_for_each(|value| positive(key, *value))
}

/// Radii of either sign, infinite ones allowed: no curvature that way.
fn all_not_zero(key: &str, values: &[f64]) -> Result<(), SceneError> {
    match values.iter().find(|value| **value == 0.0 || value.is_nan()) {
        Some(value) => Err(SceneError::range(key, *value, "a radius of curvature other than zero is needed")),
        None => Ok(()),
    }
}
