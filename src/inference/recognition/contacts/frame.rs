//! The frame of the patch, taken from the data alone: it rotates, moves and scales with them.
//!
//! ```text
//! c = mean of the points       cov = V diag(w0 <= w1 <= w2) V'        s = sqrt(w1 + w2), the unit of length
//! e3 = mean unit normal, or v0 without normals      e1 = v2 made orthogonal to e3      e2 = e3 x e1
//! ```
//!
//! The mean rotates with the data, which a median by coordinates does not. The sign of e1 is that of the third moment.

use faer::{Mat, Side};

use crate::recognition::{RecognitionError, RecognitionOptions};
use palpate_geometry::contact::Frame;
use palpate_geometry::neighbours::mean_of;
use palpate_numeric::vector::{Vector, along, cross, dot, minus, norm, reject, scaled, unit_or_zero, unit_rescaled};

/// Mean, principal axes (narrowest first) and principal sds of points.
pub(super) fn principal_axes(points: &[Vector]) -> Result<(Vector, [Vector; 3], Vector), RecognitionError> {
    let count = points.len() as f64;
    let Some(&first) = points.first() else { return Err(RecognitionError::Collinear { across: 0.0, along: 0.0 }) };
    let sum = points.iter().fold([0.0; 3], |sum, p| along(sum, 1.0, minus(*p, first)));
    let centre = along(first, 1.0 / count, sum);
    let largest = points.iter().map(|p| norm_of_largest(minus(*p, centre))).fold(0.0, f64::max);
    if largest == 0.0 {
        return Err(RecognitionError::Collinear { across: 0.0, along: 0.0 });
    }
    if !largest.is_finite() {
        return Err(RecognitionError::Arithmetic { step: "choice of axes", what: "the positions overflow" });
    }
    let mut covariance = Mat::<f64>::zeros(3, 3);
    for p in points {
        let d = minus(*p, centre).map(|v| v / largest);
        for i in 0..3 {
            (0..=i).for_each(|j| covariance[(i, j)] += d[i] * d[j] / count);
        }
    }
    let eigen = covariance
        .self_adjoint_eigen(Side::Lower)
        .map_err(|_| RecognitionError::Arithmetic { step: "choice of axes", what: "no eigenvectors were found" })?;
    let axes = [0, 1, 2].map(|k| [0, 1, 2].map(|i| eigen.U()[(i, k)]));
    let sds = [0, 1, 2].map(|k| eigen.S()[k].max(0.0).sqrt() * largest);
    Ok((centre, axes, sds))
}

/// Root mean square spread of points across their own longest direction, and along it.
///
/// # Errors
/// Where all points are one, or overflow.
pub(crate) fn spread_beside_a_line(points: &[Vector]) -> Result<[f64; 2], RecognitionError> {
    let (_, _, sds) = principal_axes(points)?;
    Ok([sds[1], sds[2]])
}

fn norm_of_largest(v: Vector) -> f64 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

/// The frame of the patch; `normals` are unit vectors on the free side, zero where unknown, or there are none.
pub(crate) fn patch_frame(
    points: &[Vector],
    normals: Option<&[Vector]>,
    options: &RecognitionOptions,
) -> Result<Frame, RecognitionError> {
    let (origin, axes, sds) = principal_axes(points)?;
    let thin = options.tuning.thin_patch;
    if sds[1] <= thin * sds[2] {
        return Err(RecognitionError::Collinear { across: sds[1], along: sds[2] });
    }
    let mean = normals.map(mean_of);
    let up = match mean {
        Some(mean) if norm(mean) > options.tuning.tells_up => {
            let up = unit_or_zero(mean);
            // the path of one finger over a bent surface is an arc, which is no line but still no patch
            let [across, along] = spreads_across(points, origin, up);
            if across <= thin * along {
                return Err(RecognitionError::Collinear { across, along });
            }
            up
        }
        Some(mean) => along_sign(axes[0], dot(axes[0], mean)),
        None => along_sign(axes[0], dot(axes[0], free_side(origin, options))),
    };
    let longest = if dot(axes[2], up).abs() < 0.9 { axes[2] } else { axes[1] };
    let side = unit_or_zero(reject(longest, up));
    let scale = sds[1].hypot(sds[2]);
    let third: f64 = points.iter().map(|p| (dot(minus(*p, origin), side) / scale).powi(3)).sum();
    let side = along_sign(side, third);
    Ok(Frame { origin, axes: [side, cross(up, side), up], scale })
}

/// Least and largest principal sd of points in the plane across a direction.
fn spreads_across(points: &[Vector], origin: Vector, up: Vector) -> [f64; 2] {
    let axis = if up[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = unit_or_zero(cross(up, axis));
    let second = cross(up, first);
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    for p in points {
        let [u, v] = [first, second].map(|side| dot(minus(*p, origin), side));
        (a, b, c) = (a + u * u, b + u * v, c + v * v);
    }
    let (mean, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
    [mean - half, mean + half].map(|sum| (sum.max(0.0) / points.len() as f64).sqrt())
}

/// Direction of the free side for contacts without normals.
pub(super) fn free_side(origin: Vector, options: &RecognitionOptions) -> Vector {
    match (options.up, options.viewpoint) {
        (Some(up), _) => up,
        (None, Some(viewpoint)) => unit_rescaled(minus(viewpoint, origin)),
        (None, None) => [0.0, 0.0, 1.0],
    }
}

fn along_sign(v: Vector, sign: f64) -> Vector {
    if sign < 0.0 { scaled(-1.0, v) } else { v }
}
