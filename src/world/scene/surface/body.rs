//! Every body there is: one file each, and one line each in the table at the end of this file.

use std::sync::Arc;

use super::geometry::Geometry;
use super::*;

macro_rules! bodies {
    ($($(#[$doc:meta])* $kind:ident($type:ty) => $name:literal;)*) => {
        /// A shape with its apex at the origin and its free side upwards.
        #[derive(Clone, Debug)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
        pub enum Body {
            /// The plane `z = 0`.
            Plane,
            $($(#[$doc])* $kind($type),)*
            /// A surface that another room supplies, such as a saved fit. It is code, so `serde` refuses it.
            #[cfg_attr(feature = "serde", serde(skip))]
            Imported(Arc<dyn ImportedSurface>),
        }

        impl Body {
            /// The words for bodies in scene files.
            pub const KINDS: &'static [&'static str] = &["plane", $($name,)* "imported"];

            /// The word for this body in scene files.
            pub fn kind(&self) -> &'static str {
                match self {
                    Body::Plane => "plane",
                    $(Body::$kind(_) => $name,)*
                    Body::Imported(_) => "imported",
                }
            }

            #[inline]
            pub fn geometry(&self) -> &dyn Geometry {
                match self {
                    Body::Plane => &plane::Plane,
                    $(Body::$kind(body) => body,)*
                    Body::Imported(surface) => surface,
                }
            }

            #[inline]
            pub fn height(&self, x: f64, y: f64) -> Option<f64> {
                match self {
                    Body::Plane => plane::Plane.height(x, y),
                    $(Body::$kind(body) => body.height(x, y),)*
                    Body::Imported(surface) => surface.height(x, y),
                }
            }

            #[inline]
            pub fn local(&self, p: [f64; 3]) -> Option<Local> {
                match self {
                    Body::Plane => plane::Plane.local(p),
                    $(Body::$kind(body) => body.local(p),)*
                    Body::Imported(surface) => surface.local(p),
                }
            }
        }

        impl PartialEq for Body {
            fn eq(&self, other: &Body) -> bool {
                match (self, other) {
                    (Body::Plane, Body::Plane) => true,
                    $((Body::$kind(a), Body::$kind(b)) => a == b,)*
                    (Body::Imported(a), Body::Imported(b)) => Arc::ptr_eq(a, b),
                    _ => false,
                }
            }
        }
    };
}

bodies! {
    /// A ball.
    Sphere(Sphere) => "sphere";
    /// A round bar along x.
    Cylinder(Cylinder) => "cylinder";
    /// A stretched ball.
    Ellipsoid(Ellipsoid) => "ellipsoid";
    /// A ring lying flat.
    Torus(Torus) => "torus";
    /// A dish.
    Paraboloid(Paraboloid) => "paraboloid";
    /// A pass between two hills.
    Saddle(Saddle) => "saddle";
    /// Three valleys and three ridges.
    MonkeySaddle(MonkeySaddle) => "monkey_saddle";
    /// A hill.
    Gaussian(GaussianBump) => "gaussian";
    /// Waves.
    Sinusoid(Sinusoid) => "sinusoid";
    /// Anything from a pillow to a box.
    Superquadric(Superquadric) => "superquadric";
    /// The upper envelope of several surfaces.
    Union(Union) => "union";
    /// Solids that are joined and cut.
    Solids(Solids) => "solids";
}
