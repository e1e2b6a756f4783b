//! `[surface]`: kind, sizes, pose.

use super::section::{Section, Value, as_array};
use super::{Importer, SceneFileError};
use palpate_world::scene::surface::*;
use toml::de::DeValue;

pub(super) fn read(section: Section, importer: &Importer) -> Result<Surface, SceneFileError> {
    let Some((kind, value)) = section.word("kind")? else {
        return Err(section.missing("kind", "one of plane, sphere, cylinder, ... is needed"));
    };
    let body = match kind {
        "plane" => Body::Plane,
        "sphere" => Body::Sphere(Sphere { radius: radius(&section)? }),
        "cylinder" => Body::Cylinder(Cylinder { radius: radius(&section)? }),
        "ellipsoid" => Body::Ellipsoid(Ellipsoid { semi_axes: semi_axes(&section)? }),
        "torus" => Body::Torus(Torus {
            major: section.required("major", "the radius of the ring is needed")?,
            minor: section.required("minor", "the radius of the tube is needed")?,
        }),
        "paraboloid" => Body::Paraboloid(Paraboloid { radii: radii(&section)? }),
        "saddle" => Body::Saddle(Saddle { radii: radii(&section)? }),
        "monkey_saddle" => Body::MonkeySaddle(MonkeySaddle {
            length: section.required("length", "the length l of z = (x^3 - 3 x y^2)/l^2 is needed")?,
        }),
        "gaussian" => Body::Gaussian(GaussianBump {
            height: section.required("height", "the height of the bump is needed")?,
            width: section.required("width", "the width (sigma) of the bump is needed")?,
        }),
        "sinusoid" => Body::Sinusoid(Sinusoid {
            amplitude: section.required("amplitude", "the amplitude of the waves is needed")?,
            wavelength: section.required("wavelength", "the wavelength along x is needed")?,
            wavelength_y: section.number("wavelength_y")?,
        }),
        "superquadric" => Body::Superquadric(Superquadric {
            semi_axes: semi_axes(&section)?,
            exponents: match section.several("exponents")? {
                Some(exponents) => exponents,
                None => return Err(section.missing("exponents", "the exponents e1, e2 in (0, 1] are needed")),
            },
        }),
        "solids" => Body::Solids(Solids { parts: solids(&section)? }),
        "union" => Body::Union(Union { parts: parts(&section, importer)? }),
        "imported" => imported(&section, importer)?,
        other => return Err(section.unknown_word("surface", value, other, Body::KINDS)),
    };
    let pose = pose(&section)?;
    let concave = section.truth("concave")?;
    section.finish("key")?;
    Ok(Surface { body, concave, pose })
}

fn radius(section: &Section) -> Result<f64, SceneFileError> {
    section.required("radius", "a radius is needed")
}

fn semi_axes(section: &Section) -> Result<[f64; 3], SceneFileError> {
    section.several("semi_axes")?.ok_or_else(|| section.missing("semi_axes", "three semi-axes are needed"))
}

fn radii(section: &Section) -> Result<[f64; 2], SceneFileError> {
    section.several("radii")?.ok_or_else(|| section.missing("radii", "two radii of curvature are needed"))
}

fn parts(section: &Section, importer: &Importer) -> Result<Vec<Surface>, SceneFileError> {
    each_part(section, |part| read(part, importer))
}

/// Every `[[surface.parts]]`, read one by one.
fn each_part<T>(
    section: &Section,
    read: impl Fn(Section) -> Result<T, SceneFileError>,
) -> Result<Vec<T>, SceneFileError> {
    const EXPECTED: &str = "give each part as a [[surface.parts]]";
    let Some(value) = section.get("parts") else { return Err(section.missing("parts", EXPECTED)) };
    let table = |part: &'_ Value| part.span().start;
    let Some(array) = as_array(value) else { return Err(section.value_error("parts", value, EXPECTED)) };
    let mut parts = Vec::new();
    for part in array.iter() {
        let DeValue::Table(inner) = part.get_ref() else {
            return Err(section.value_error("parts", part, EXPECTED));
        };
        parts.push(read(Section::new(section.source, &section.full("parts"), inner, table(part)))?);
    }
    Ok(parts)
}

/// Blocks, balls, bars, frustums and rings.
fn solids(section: &Section) -> Result<Vec<Solid>, SceneFileError> {
    each_part(section, |part| {
        let Some((kind, value)) = part.word("kind")? else {
            return Err(part.missing("kind", "one of block, ball, bar, frustum, ring is needed"));
        };
        let length = |part: &Section| part.required("length", "the length from end to end is needed");
        let shape = match kind {
            "block" => SolidShape::Block {
                size: part.several("size")?.ok_or_else(|| part.missing("size", "three sides are needed"))?,
            },
            "ball" => SolidShape::Ball { radius: radius(&part)? },
            "bar" => SolidShape::Bar { radius: radius(&part)?, length: length(&part)? },
            "frustum" => SolidShape::Frustum {
                radius: radius(&part)?,
                top: part.required("top", "the radius of the upper end is needed")?,
                length: length(&part)?,
            },
            "ring" => SolidShape::Ring {
                major: part.required("major", "the radius of the ring is needed")?,
                minor: part.required("minor", "the radius of the tube is needed")?,
            },
            other => return Err(part.unknown_word("solid", value, other, &SolidShape::KINDS)),
        };
        let pose = pose(&part)?;
        let cut = part.truth("cut")?;
        part.finish("key")?;
        Ok(Solid { shape, pose, cut })
    })
}

fn pose(section: &Section) -> Result<Pose, SceneFileError> {
    let axis = section.number_or("axis_deg", 0.0)?;
    let rotation = section.several("rotation_deg")?.unwrap_or([0.0; 3]);
    let offset = section.several("offset")?.unwrap_or([0.0; 3]);
    Ok(Pose::new(axis, rotation, offset))
}

fn imported(section: &Section, importer: &Importer) -> Result<Body, SceneFileError> {
    let Some((file, value)) = section.word("file")? else {
        return Err(section.missing("file", "the JSON of a fit is needed"));
    };
    let (line, column) = section.place_of(value);
    let failed = |reason| SceneFileError::Import { line, column, file: file.into(), reason };
    importer(file).map(Body::Imported).map_err(failed)
}
