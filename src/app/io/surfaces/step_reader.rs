//! STEP back: the one `B_SPLINE_SURFACE_WITH_KNOTS` of a file, not rational. Units and trimming are not read.

use ndarray::Array2;

use super::cad::CadPatch;
use super::part21::{Instances, Value};

const SURFACE: &str = "B_SPLINE_SURFACE_WITH_KNOTS";

/// Surfaces of other kinds, to say what a file holds instead.
const OTHERS: [&str; 8] = [
    "PLANE",
    "CYLINDRICAL_SURFACE",
    "CONICAL_SURFACE",
    "SPHERICAL_SURFACE",
    "TOROIDAL_SURFACE",
    "SURFACE_OF_REVOLUTION",
    "SURFACE_OF_LINEAR_EXTRUSION",
    "BEZIER_SURFACE",
];

/// Ways of placing a shape somewhere else than its own coordinates say.
const PLACED: [&str; 2] = ["MAPPED_ITEM", "ITEM_DEFINED_TRANSFORMATION"];

/// The spline.
///
/// # Errors
/// What the file holds instead, and what would do.
pub(super) fn read(bytes: &[u8]) -> Result<CadPatch, String> {
    // names may be in any encoding; numbers and keywords are ASCII
    let text = String::from_utf8_lossy(bytes);
    let file = Instances::of(&text)?;
    if let Some(kind) = PLACED.into_iter().find(|kind| !file.with_type(kind).is_empty()) {
        return Err(format!("{kind}: parts that are placed in an assembly are not read; export the one surface alone"));
    }
    let found = file.with_type(SURFACE);
    let number = match found[..] {
        [number] => number,
        [] => return Err(nothing(&file)),
        _ => {
            let count = found.len();
            return Err(format!("{count} spline surfaces; one is read: export the face of interest alone"));
        }
    };
    if file.parameters(number, "RATIONAL_B_SPLINE_SURFACE").is_ok() {
        return Err("RATIONAL_B_SPLINE_SURFACE: a spline with weights (NURBS) is not read; export it as a polynomial \
                    B-spline surface"
            .into());
    }
    // one type with all parameters, or several types that share them out
    let knots = file.parameters(number, SURFACE)?;
    let (head, tail) = match file.parameters(number, "B_SPLINE_SURFACE") {
        Ok(head) => (head, knots),
        Err(_) if knots.len() == 13 => (knots[1..8].to_vec(), knots[8..].to_vec()),
        Err(_) => return Err(format!("#{number}: {} parameters where {SURFACE} has 13", knots.len())),
    };
    patch(&file, &head, &tail)
}

fn nothing(file: &Instances) -> String {
    let others: Vec<&str> = OTHERS.into_iter().filter(|kind| !file.with_type(kind).is_empty()).collect();
    let instead = if others.is_empty() { String::new() } else { format!("; it holds {}", others.join(", ")) };
    format!("no {SURFACE}{instead}; convert the face to one polynomial B-spline surface")
}

/// `head` from the degree in u to `self_intersect`, `tail` from the multiplicities in u.
fn patch(file: &Instances, head: &[Value], tail: &[Value]) -> Result<CadPatch, String> {
    let [p, q, net, ..] = head else { return Err(format!("{SURFACE} without degrees or control points")) };
    let [mu, mv, ku, kv, ..] = tail else { return Err(format!("{SURFACE} without knots")) };
    let Value::List(rows) = net else { return Err("control points are no list".into()) };
    let columns = |row: &Value| match row {
        Value::List(row) => Ok(row.len()),
        _ => Err("a row of control points is no list".to_string()),
    };
    let m = rows.first().map_or(Ok(0), columns)?;
    let mut points = Vec::with_capacity(rows.len() * m);
    for row in rows {
        let Value::List(row) = row else { return Err("a row of control points is no list".into()) };
        if row.len() != m {
            return Err(format!("rows of {m} and of {} control points", row.len()));
        }
        for reference in row {
            points.push(point(file, reference)?);
        }
    }
    let points = Array2::from_shape_vec((rows.len(), m), points).map_err(|e| e.to_string())?;
    Ok(CadPatch { degree: [count(p)?, count(q)?], knots: [vector(mu, ku)?, vector(mv, kv)?], points })
}

fn point(file: &Instances, reference: &Value) -> Result<[f64; 3], String> {
    let Value::Reference(number) = reference else { return Err("a control point is no reference".into()) };
    let values = file.parameters(*number, "CARTESIAN_POINT")?;
    let Some(Value::List(xyz)) = values.get(1) else { return Err(format!("#{number} has no coordinates")) };
    match xyz[..] {
        [Value::Number(x), Value::Number(y), Value::Number(z)] => Ok([x, y, z]),
        _ => Err(format!("#{number} has not three coordinates")),
    }
}

/// Most knots in one direction: the limit on segments holds for both directions multiplied, and two of them are few.
const MOST_KNOTS: usize = 1 << 18;

/// Knots with each repeated as often as it says.
fn vector(multiplicities: &Value, knots: &Value) -> Result<Vec<f64>, String> {
    let (Value::List(times), Value::List(knots)) = (multiplicities, knots) else {
        return Err("knots or their multiplicities are no list".into());
    };
    if times.len() != knots.len() {
        return Err(format!("{} knots with {} multiplicities", knots.len(), times.len()));
    }
    let mut out = Vec::new();
    for (times, knot) in times.iter().zip(knots) {
        let Value::Number(knot) = knot else { return Err("a knot is no number".into()) };
        let times = count(times)?;
        if times > MOST_KNOTS - out.len() {
            return Err(format!("more than {MOST_KNOTS} knots"));
        }
        out.extend(std::iter::repeat_n(*knot, times));
    }
    Ok(out)
}

fn count(value: &Value) -> Result<usize, String> {
    match value {
        // at most 2^18 here, far below what a float64 holds exactly
        Value::Number(v) if v.fract() == 0.0 && (0.0..=MOST_KNOTS as f64).contains(v) => Ok(*v as usize),
        other => Err(format!("{other:?} is no whole number of the size expected")),
    }
}
