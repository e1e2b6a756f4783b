//! `[surface]`: kind, sizes, pose; one type a kind. Lengths are in the unit of the scene. The highest point of a raised
//! body, or the lowest of a hollow one, is at the origin. Types that are `remote` are read straight into the body of the
//! simulated world.

use palpate_world::scene::Surface;
use palpate_world::scene::surface::{self as world, Body, SolidShape};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::keys::keys;
use super::manual::entry::{Entry, Key};
use super::section::Section;
use super::{Importer, SceneFileError};

/// A plane: flat, level unless it is turned.
#[derive(Deserialize, JsonSchema)]
struct PlaneKeys {}

/// A ball.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Sphere")]
struct SphereKeys {
    /// Radius, units of length.
    #[schemars(example = 10.0, extend("exclusiveMinimum" = 0, "x-needed" = "a radius is needed"))]
    radius: f64,
}

/// A round bar that lies along its axis.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Cylinder")]
struct CylinderKeys {
    /// Radius, units of length.
    #[schemars(example = 10.0, extend("exclusiveMinimum" = 0, "x-needed" = "a radius is needed"))]
    radius: f64,
}

/// A ball stretched by another factor along each axis.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Ellipsoid")]
struct EllipsoidKeys {
    /// Half its length along x, y, z, units of length.
    #[schemars(example = [12.0, 8.0, 6.0])]
    #[schemars(extend("x-range" = "three numbers above 0", "x-needed" = "three semi-axes are needed"))]
    semi_axes: [f64; 3],
}

/// A ring that lies flat, touched on top of its tube.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Torus")]
struct TorusKeys {
    /// Radius of the ring, to the middle of the tube, units of length.
    #[schemars(example = 20.0, extend("exclusiveMinimum" = 0, "x-needed" = "the radius of the ring is needed"))]
    major: f64,
    /// Radius of the tube, units of length.
    #[schemars(example = 5.0, extend("exclusiveMinimum" = 0, "x-needed" = "the radius of the tube is needed"))]
    minor: f64,
}

/// A bowl turned over: z = -x^2/(2 r1) - y^2/(2 r2).
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Paraboloid")]
struct ParaboloidKeys {
    /// Radii of curvature r1, r2 along x and y at the top, units of length.
    #[schemars(example = [10.0, 20.0])]
    #[schemars(extend("x-range" = "two numbers, neither 0", "x-needed" = "two radii of curvature are needed"))]
    radii: [f64; 2],
}

/// Rising along x and falling along y: z = x^2/(2 r1) - y^2/(2 r2).
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Saddle")]
struct SaddleKeys {
    /// Radii of curvature r1, r2 along x and y in the middle, units of length.
    #[schemars(example = [10.0, 10.0])]
    #[schemars(extend("x-range" = "two numbers, neither 0", "x-needed" = "two radii of curvature are needed"))]
    radii: [f64; 2],
}

/// A saddle for two legs and a tail: z = (x^3 - 3 x y^2)/l^2.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::MonkeySaddle")]
struct MonkeySaddleKeys {
    /// The length l, units of length.
    #[schemars(example = 20.0, extend("exclusiveMinimum" = 0))]
    #[schemars(extend("x-needed" = "the length l of z = (x^3 - 3 x y^2)/l^2 is needed"))]
    length: f64,
}

/// A smooth bump on a plane: z = h exp(-(x^2 + y^2)/(2 w^2)) - h.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::GaussianBump")]
struct GaussianBumpKeys {
    /// Its height h, units of length; below 0 a dent.
    #[schemars(example = 2.0, extend("x-needed" = "the height of the bump is needed"))]
    height: f64,
    /// Its width w (one sigma), units of length.
    #[schemars(example = 5.0, extend("exclusiveMinimum" = 0, "x-needed" = "the width (sigma) of the bump is needed"))]
    width: f64,
}

/// Waves.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Sinusoid")]
struct SinusoidKeys {
    /// Half their height, units of length.
    #[schemars(example = 0.5, extend("x-needed" = "the amplitude of the waves is needed"))]
    amplitude: f64,
    /// From crest to crest along x, units of length.
    #[schemars(example = 10.0, extend("exclusiveMinimum" = 0, "x-needed" = "the wavelength along x is needed"))]
    wavelength: f64,
    /// From crest to crest along y, units of length.
    #[schemars(example = 10.0, extend("exclusiveMinimum" = 0, "x-left-out" = "no waves along y"))]
    wavelength_y: Option<f64>,
}

/// From a box with rounded edges to an ellipsoid.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Superquadric")]
struct SuperquadricKeys {
    /// Half its length along x, y, z, units of length.
    #[schemars(example = [10.0, 10.0, 10.0])]
    #[schemars(extend("x-range" = "three numbers above 0", "x-needed" = "three semi-axes are needed"))]
    semi_axes: [f64; 3],
    /// Roundness e1 from top to side and e2 round about: 1 is an ellipsoid, near 0 a box.
    #[schemars(example = [0.5, 0.5])]
    #[schemars(extend("x-range" = "two numbers above 0, at most 1", "x-needed" = "the exponents e1, e2 in (0, 1] are needed"))]
    exponents: [f64; 2],
}

/// Several bodies at once; the fingers touch whichever comes first from above.
#[derive(Deserialize, JsonSchema)]
struct UnionKeys {
    /// The bodies.
    #[schemars(with = "Vec<serde_json::Value>", extend("x-example" = BODIES, "x-needed" = EACH_PART, "x-expected" = EACH_PART))]
    #[schemars(extend("x-range" = "a list of surfaces; each part may be its own [[surface.parts]]"))]
    #[expect(dead_code, reason = "each part is a section, which is read as the surface is")]
    parts: IgnoredAny,
}

const BODIES: &str = "[{ kind = \"sphere\", radius = 10.0 }, { kind = \"plane\", offset = [0.0, 0.0, -3.0] }]";

/// Solids joined and cut: block (size), ball (radius), bar (radius, length), frustum (radius, top, length), ring (major,
/// minor), each centred at its offset with its axis upright, and taken away where cut = true.
#[derive(Deserialize, JsonSchema)]
struct SolidsKeys {
    /// The solids.
    #[schemars(with = "Vec<serde_json::Value>", extend("x-example" = SOLIDS, "x-needed" = EACH_PART, "x-expected" = EACH_PART))]
    #[schemars(extend("x-range" = "a list of solids; each part may be its own [[surface.parts]]"))]
    #[expect(dead_code, reason = "each part is a section")]
    parts: IgnoredAny,
}

const SOLIDS: &str = "[{ kind = \"ball\", radius = 10.0 }, { kind = \"bar\", radius = 3.0, length = 8.0, cut = true }]";
const EACH_PART: &str = "give each part as a [[surface.parts]]";

/// A surface that palpate fitted and saved.
#[derive(Deserialize, JsonSchema)]
struct Imported {
    /// What --save or --json wrote.
    #[schemars(example = &"surface.json", extend("x-needed" = "the JSON of a fit is needed"))]
    #[schemars(extend("x-range" = "the name of a file, beside the scene"))]
    file: String,
}

/// A box.
#[derive(Deserialize, JsonSchema)]
struct Block {
    /// Sides along x, y, z, units of length.
    #[schemars(extend("x-needed" = "three sides are needed"))]
    size: [f64; 3],
}

/// A round bar.
#[derive(Deserialize, JsonSchema)]
struct BarKeys {
    /// Radius, units of length.
    #[schemars(extend("x-needed" = "a radius is needed"))]
    radius: f64,
    /// Length from end to end, units of length.
    #[schemars(extend("x-needed" = "the length from end to end is needed"))]
    length: f64,
}

/// A bar that narrows.
#[derive(Deserialize, JsonSchema)]
struct Frustum {
    /// Radius of the lower end, units of length.
    #[schemars(extend("x-needed" = "a radius is needed"))]
    radius: f64,
    /// Radius of the upper end, units of length.
    #[schemars(extend("x-needed" = "the radius of the upper end is needed"))]
    top: f64,
    /// Length from end to end, units of length.
    #[schemars(extend("x-needed" = "the length from end to end is needed"))]
    length: f64,
}

/// Keys of every surface and of every solid.
#[derive(Deserialize, JsonSchema)]
struct PoseKeys {
    /// Direction of the body's long axis, degrees from x towards y.
    #[serde(default)]
    #[schemars(example = 45.0)]
    axis_deg: f64,
    /// Turns the body about x, y, z in this order, degrees.
    #[serde(default)]
    #[schemars(example = [0.0, 20.0, 0.0])]
    rotation_deg: [f64; 3],
    /// Moves it, units of length.
    #[serde(default)]
    #[schemars(example = [0.0, 0.0, 5.0])]
    offset: [f64; 3],
}

/// Key of every surface.
#[derive(Deserialize, JsonSchema)]
struct SideKeys {
    /// Seen from inside: touched on its hollow side.
    #[serde(default)]
    #[schemars(example = true)]
    concave: bool,
}

/// Key of every solid.
#[derive(Deserialize, JsonSchema)]
struct CutKeys {
    /// Taken away from the solids before it.
    #[serde(default)]
    cut: bool,
}

keys! {
    PlaneKeys => PlaneKeys,
    SphereKeys => world::Sphere,
    CylinderKeys => world::Cylinder,
    EllipsoidKeys => world::Ellipsoid,
    TorusKeys => world::Torus,
    ParaboloidKeys => world::Paraboloid,
    SaddleKeys => world::Saddle,
    MonkeySaddleKeys => world::MonkeySaddle,
    GaussianBumpKeys => world::GaussianBump,
    SinusoidKeys => world::Sinusoid,
    SuperquadricKeys => world::Superquadric,
    UnionKeys => UnionKeys,
    SolidsKeys => SolidsKeys,
    Imported => Imported,
    Block => Block,
    BarKeys => BarKeys,
    Frustum => Frustum,
    PoseKeys => PoseKeys,
    SideKeys => SideKeys,
    CutKeys => CutKeys,
}

type Reader = fn(&Section, &Importer) -> Result<Body, SceneFileError>;
type Describer = fn(&'static str, &'static str) -> Entry;

/// Every kind of surface, in the order of [`Body::KINDS`].
const KINDS: &[(&str, Reader, Describer)] = &[
    ("plane", |s, _| s.read::<PlaneKeys>().map(|_| Body::Plane), Entry::of::<PlaneKeys>),
    ("sphere", |s, _| s.read::<SphereKeys>().map(Body::Sphere), Entry::of::<SphereKeys>),
    ("cylinder", |s, _| s.read::<CylinderKeys>().map(Body::Cylinder), Entry::of::<CylinderKeys>),
    ("ellipsoid", |s, _| s.read::<EllipsoidKeys>().map(Body::Ellipsoid), Entry::of::<EllipsoidKeys>),
    ("torus", |s, _| s.read::<TorusKeys>().map(Body::Torus), Entry::of::<TorusKeys>),
    ("paraboloid", |s, _| s.read::<ParaboloidKeys>().map(Body::Paraboloid), Entry::of::<ParaboloidKeys>),
    ("saddle", |s, _| s.read::<SaddleKeys>().map(Body::Saddle), Entry::of::<SaddleKeys>),
    ("monkey_saddle", |s, _| s.read::<MonkeySaddleKeys>().map(Body::MonkeySaddle), Entry::of::<MonkeySaddleKeys>),
    ("gaussian", |s, _| s.read::<GaussianBumpKeys>().map(Body::Gaussian), Entry::of::<GaussianBumpKeys>),
    ("sinusoid", |s, _| s.read::<SinusoidKeys>().map(Body::Sinusoid), Entry::of::<SinusoidKeys>),
    ("superquadric", |s, _| s.read::<SuperquadricKeys>().map(Body::Superquadric), Entry::of::<SuperquadricKeys>),
    ("union", union, Entry::of::<UnionKeys>),
    ("solids", solids, Entry::of::<SolidsKeys>),
    ("imported", imported, Entry::of::<Imported>),
];

/// The kinds of surface for the manual.
pub(super) fn entries() -> impl Iterator<Item = Entry> {
    KINDS.iter().map(|(kind, _, describe)| describe("surface", kind))
}

/// The keys of every surface for the manual.
pub(super) fn shared() -> Vec<Key> {
    let mut keys = Key::all::<PoseKeys>();
    keys.splice(1..1, Key::all::<SideKeys>());
    keys
}

pub(super) fn read(section: Section, importer: &Importer) -> Result<Surface, SceneFileError> {
    let Some((kind, value)) = section.word("kind")? else {
        return Err(section.missing("kind", "one of plane, sphere, cylinder, ... is needed"));
    };
    let Some((_, reader, _)) = KINDS.iter().find(|(known, ..)| *known == kind) else {
        return Err(section.unknown_word("surface", value, kind, Body::KINDS));
    };
    let body = reader(&section, importer)?;
    let pose = pose(&section)?;
    let SideKeys { concave } = section.read::<SideKeys>()?;
    section.finish("key")?;
    Ok(Surface { body, concave, pose })
}

fn pose(section: &Section) -> Result<world::Pose, SceneFileError> {
    let PoseKeys { axis_deg, rotation_deg, offset } = section.read::<PoseKeys>()?;
    Ok(world::Pose::new(axis_deg, rotation_deg, offset))
}

fn union(section: &Section, importer: &Importer) -> Result<Body, SceneFileError> {
    section.read::<UnionKeys>()?;
    let parts = section.tables("parts", EACH_PART)?;
    Ok(Body::Union(world::Union {
        parts: parts.into_iter().map(|part| read(part, importer)).collect::<Result<_, _>>()?,
    }))
}

fn solids(section: &Section, _: &Importer) -> Result<Body, SceneFileError> {
    section.read::<SolidsKeys>()?;
    let parts = section.tables("parts", EACH_PART)?;
    Ok(Body::Solids(world::Solids { parts: parts.into_iter().map(solid).collect::<Result<_, _>>()? }))
}

/// A block, ball, bar, frustum or ring.
fn solid(part: Section) -> Result<world::Solid, SceneFileError> {
    let Some((kind, value)) = part.word("kind")? else {
        return Err(part.missing("kind", "one of block, ball, bar, frustum, ring is needed"));
    };
    let shape = match kind {
        "block" => part.read::<Block>().map(|Block { size }| SolidShape::Block { size }),
        "ball" => part.read::<SphereKeys>().map(|ball| SolidShape::Ball { radius: ball.radius }),
        "bar" => part.read::<BarKeys>().map(|BarKeys { radius, length }| SolidShape::Bar { radius, length }),
        "frustum" => {
            part.read::<Frustum>().map(|Frustum { radius, top, length }| SolidShape::Frustum { radius, top, length })
        }
        "ring" => part.read::<TorusKeys>().map(|ring| SolidShape::Ring { major: ring.major, minor: ring.minor }),
        other => Err(part.unknown_word("solid", value, other, &SolidShape::KINDS)),
    }?;
    let pose = pose(&part)?;
    let CutKeys { cut } = part.read::<CutKeys>()?;
    part.finish("key")?;
    Ok(world::Solid { shape, pose, cut })
}

fn imported(section: &Section, importer: &Importer) -> Result<Body, SceneFileError> {
    let Imported { file } = section.read::<Imported>()?;
    let (line, column) = section.get("file").map_or_else(|| section.place(), |value| section.place_of(value));
    importer(&file).map(Body::Imported).map_err(|reason| SceneFileError::Import { line, column, file, reason })
}
