//! Waves with a crest at the origin: `z = A (cos(2 pi x/l_x) - 1) + A (cos(2 pi y/l_y) - 1)`, the y term only with l_y.
//!
//! `cos t - 1 = -2 sin^2(t/2)` keeps the digits near the crest.

use super::geometry::Geometry;
use super::local::Local;
use super::ray::{first_below, through_slab, widened};
use super::{Body, Surface};
use crate::scene::error::{SceneError, finite, positive};
use palpate_numeric::vector::{Vector, along};
use std::f64::consts::{PI, TAU};

/// Corrugated sheet (one wavelength) or egg box (two).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sinusoid {
    /// Amplitude A of each wave, input units.
    pub amplitude: f64,
    /// Wavelength along x, input units.
    pub wavelength: f64,
    /// Wavelength along y; `None`: no wave along y.
    pub wavelength_y: Option<f64>,
}

impl Surface {
    /// A corrugated sheet with a crest at the origin: `z = A (cos(2 pi x/l) - 1)`, amplitude A and wavelength l in input
    /// units. Range: the amplitude finite, the wavelength above zero.
    pub fn sinusoid(amplitude: f64, wavelength: f64) -> Surface {
        Surface::new(Body::Sinusoid(Sinusoid { amplitude, wavelength, wavelength_y: None }), 0.0)
    }

    /// An egg box: the waves of [`Surface::sinusoid`] along x and along y, with a wavelength each.
    pub fn egg_box(amplitude: f64, wavelengths: [f64; 2]) -> Surface {
        let [wavelength, along_y] = wavelengths;
        Surface::new(Body::Sinusoid(Sinusoid { amplitude, wavelength, wavelength_y: Some(along_y) }), 0.0)
    }
}

impl Geometry for Sinusoid {
    fn check(&self) -> Result<(), SceneError> {
        finite("surface.amplitude", self.amplitude)?;
        positive("surface.wavelength", self.wavelength)?;
        self.wavelength_y.map_or(Ok(()), |l| positive("surface.wavelength", l))
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let drop = |t: f64, l: f64| -2.0 * self.amplitude * (PI * t / l).sin().powi(2);
        Some(drop(x, self.wavelength) + self.wavelength_y.map_or(0.0, |l| drop(y, l)))
    }

    fn local(&self, [x, y, _]: Vector) -> Option<Local> {
        let wave = |t: f64, l: f64| {
            let k = TAU / l;
            let (s, c) = (k * t).sin_cos();
            (-self.amplitude * k * s, -self.amplitude * k * k * c)
        };
        let (hx, hxx) = wave(x, self.wavelength);
        let (hy, hyy) = self.wavelength_y.map_or((0.0, 0.0), |l| wave(y, l));
        Local::of_height([hx, hy, hxx, 0.0, hyy])
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let (low, high) = widened(through_slab(o, d, -4.0 * self.amplitude.abs(), 4.0 * self.amplitude.abs())?);
        first_below(low, high, |t| {
            let p = along(o, t, d);
            self.height(p[0], p[1]).map(|z| p[2] - z)
        })
    }
}
