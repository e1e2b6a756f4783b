//! `[surface]`: the kinds of surface. Lengths are in the unit of the scene. The highest point of a raised body, or the
//! lowest of a hollow one, is at the origin.

use super::Default::{Required, Value, Words};
use super::Range::{Any, Other, Positive};
use super::{Entry, Key, keys};

/// Keys of every surface.
pub(super) const SHARED: &[Key] = keys! {
    "axis_deg" = "45.0", Value("0.0"), Any, "direction of the body's long axis, degrees from x towards y";
    "concave" = "true", Value("false"), Other("true, false", "1"), "seen from inside: touched on its hollow side";
    "rotation_deg" = "[0.0, 20.0, 0.0]", Value("[0.0, 0.0, 0.0]"), Other("three numbers", "1.0"),
        "turns the body about x, y, z in this order, degrees";
    "offset" = "[0.0, 0.0, 5.0]", Value("[0.0, 0.0, 0.0]"), Other("three numbers", "1.0"), "moves it, units of length";
};

const fn surface(kind: &'static str, about: &'static str, keys: &'static [Key]) -> Entry {
    Entry { table: "surface", kind: Some(kind), about, keys }
}

pub(super) const SURFACES: &[Entry] = &[
    surface("plane", "A plane: flat, level unless it is turned.", &[]),
    surface("sphere", "A ball.", keys! { "radius" = "10.0", Required, Positive, "radius, units of length"; }),
    surface(
        "cylinder",
        "A round bar that lies along its axis.",
        keys! {
            "radius" = "10.0", Required, Positive, "radius, units of length";
        },
    ),
    surface(
        "ellipsoid",
        "A ball stretched by another factor along each axis.",
        keys! {
            "semi_axes" = "[12.0, 8.0, 6.0]", Required, Other("three numbers above 0", "[1.0, 1.0, -1.0]"),
                "half its length along x, y, z, units of length";
        },
    ),
    surface(
        "torus",
        "A ring that lies flat, touched on top of its tube.",
        keys! {
            "major" = "20.0", Required, Positive, "radius of the ring, to the middle of the tube, units of length";
            "minor" = "5.0", Required, Positive, "radius of the tube, units of length";
        },
    ),
    surface(
        "paraboloid",
        "A bowl turned over: z = -x^2/(2 r1) - y^2/(2 r2).",
        keys! {
            "radii" = "[10.0, 20.0]", Required, Other("two numbers, neither 0", "[0.0, 1.0]"),
                "radii of curvature r1, r2 along x and y at the top, units of length";
        },
    ),
    surface(
        "saddle",
        "Raised along one axis, hollow along the other: z = -x^2/(2 r1) + y^2/(2 r2).",
        keys! {
            "radii" = "[10.0, 10.0]", Required, Other("two numbers, neither 0", "[0.0, 1.0]"),
                "radii of curvature r1, r2 along x and y in the middle, units of length";
        },
    ),
    surface(
        "monkey_saddle",
        "A saddle for two legs and a tail: z = (x^3 - 3 x y^2)/l^2.",
        keys! {
            "length" = "20.0", Required, Positive, "the length l, units of length";
        },
    ),
    surface(
        "gaussian",
        "A smooth bump on a plane: z = h exp(-(x^2 + y^2)/(2 w^2)) - h.",
        keys! {
            "height" = "2.0", Required, Any, "its height h, units of length; below 0 a dent";
            "width" = "5.0", Required, Positive, "its width w (one sigma), units of length";
        },
    ),
    surface(
        "sinusoid",
        "Waves.",
        keys! {
            "amplitude" = "0.5", Required, Any, "half their height, units of length";
            "wavelength" = "10.0", Required, Positive, "from crest to crest along x, units of length";
            "wavelength_y" = "10.0", Words("no waves along y"), Positive, "from crest to crest along y, units of length";
        },
    ),
    surface(
        "superquadric",
        "From a box with rounded edges to an ellipsoid.",
        keys! {
            "semi_axes" = "[10.0, 10.0, 10.0]", Required, Other("three numbers above 0", "[1.0, 1.0, -1.0]"),
                "half its length along x, y, z, units of length";
            "exponents" = "[0.5, 0.5]", Required, Other("two numbers above 0, at most 1", "[0.5, 2.0]"),
                "roundness e1 from top to side and e2 round about: 1 is an ellipsoid, near 0 a box";
        },
    ),
    surface(
        "union",
        "Several bodies at once; the fingers touch whichever comes first from above.",
        keys! {
            "parts" = "[{ kind = \"sphere\", radius = 10.0 }, { kind = \"plane\", offset = [0.0, 0.0, -3.0] }]", Required,
                Other("a list of surfaces; each part may be its own [[surface.parts]]", "[]"), "the bodies";
        },
    ),
    surface(
        "solids",
        "Solids joined and cut: block (size), ball (radius), bar (radius, length), frustum (radius, top, length), ring (major, \
         minor), each centred at its offset with its axis upright, and taken away where cut = true.",
        keys! {
            "parts" = "[{ kind = \"ball\", radius = 10.0 }, { kind = \"bar\", radius = 3.0, length = 8.0, cut = true }]", Required,
                Other("a list of solids; each part may be its own [[surface.parts]]", "[]"), "the solids";
        },
    ),
    surface(
        "imported",
        "A surface that palpate fitted and saved.",
        keys! {
            "file" = "\"surface.json\"", Required, Other("the name of a file, beside the scene", "1"), "what --save or --json wrote";
        },
    ),
];
