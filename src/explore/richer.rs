//! Does a richer surface explain the contacts better than the one that was recognised?
//!
//! ```text
//! residuals    z - z_0 and slopes - slopes_0 in the patch's own frame, over their noise sds
//! richer       + sum_{a+b<=4} c_ab x^a y^b                                       15 terms, of which k stand in the surface already
//! F = ((RSS - RSS_rich) / (15 - k)) / (RSS_rich / (rows - 15))
//! ```
//!
//! The noise sds are those that the recognition found; their common factor cancels. A recognition reads a small departure as a
//! sensor's error, because contacts cannot tell it from shape. Whoever is about to stop touching does better to doubt it.
//! A bump differs from a ball in the fourth degree first. A spline of degree 4 each way has that and ten terms more, up to
//! x^4 y^4, which tell of no smooth surface and take the test's power.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::contact::Contacts;
use crate::recognition::Recognition;
use crate::shape::f_upper_tail;

/// Powers of x and y.
const TERMS: [[i32; 2]; 15] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [2, 0],
    [1, 1],
    [0, 2],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
    [4, 0],
    [3, 1],
    [2, 2],
    [1, 3],
    [0, 4],
];

/// Rows that must be left over after the unknowns: with fewer the test overlooks what it is there for. (12 contacts with
/// normals have 36 rows.)
const LEFT_OVER: usize = 20;

/// Least sds, so that a world without noise can be asked: of a height in patch sizes, of a normal in radians.
const LEAST: [f64; 2] = [1e-9, 1e-7];

/// Normals that are not believed count as good as this, in radians: next to nothing.
const UNKNOWN_NORMAL: f64 = 0.5;

/// Normals flatter than this have no slope to speak of in the patch's frame.
const FLAT: f64 = 0.1;

/// Probability of so large an F, or a larger one, if the recognised surface were all there is; `None` where the contacts
/// are too few to ask.
pub(super) fn richer_p(contacts: &Contacts, found: &Recognition) -> Option<f64> {
    let rows = rows(contacts, found)?;
    let left = rows.len().checked_sub(TERMS.len()).filter(|left| *left >= LEFT_OVER)? as f64;
    let count = TERMS.len();
    let (mut matrix, mut right) = (Mat::<f64>::zeros(count, count), Mat::<f64>::zeros(count, 1));
    let mut simple = 0.0;
    for (row, residual) in &rows {
        simple += residual * residual;
        for i in 0..count {
            right[(i, 0)] += row[i] * residual;
            (0..=i).for_each(|j| matrix[(i, j)] += row[i] * row[j]);
        }
    }
    let solved = matrix.llt(Side::Lower).ok()?.solve(&right);
    let explained: f64 = (0..count).map(|i| solved[(i, 0)] * right[(i, 0)]).sum();
    let rich = simple - explained;
    let more = count.checked_sub(found.hypothesis.unknowns()).filter(|more| *more > 0)? as f64;
    let p = f_upper_tail((explained.max(0.0) / more) / (rich / left), more, left);
    (rich > 0.0 && p.is_finite()).then_some(p)
}

/// The terms' rows and what the recognised surface leaves over, height and slopes of every contact.
fn rows(contacts: &Contacts, found: &Recognition) -> Option<Vec<([f64; TERMS.len()], f64)>> {
    let frame = &found.frame;
    let of_height = (found.noise.sd_z / frame.scale).max(LEAST[0]);
    let of_normal = found.noise.sd_normal_deg.map_or(UNKNOWN_NORMAL, f64::to_radians).max(LEAST[1]);
    let mut all = Vec::with_capacity(3 * contacts.len());
    for r in 0..contacts.len() {
        let place = [contacts.x[r], contacts.y[r], contacts.z[r]];
        let [x, y, _] = frame.to_patch(place);
        let [u, v] = found.surface.chart_of(place);
        let up = frame.rotate(found.surface.at(u, v).1);
        let felt = frame.rotate(contacts.unit_normal(r)?);
        if up[2] < FLAT || felt[2] < FLAT {
            continue;
        }
        let term = |by_x: i32, by_y: i32, over: f64| -> [f64; TERMS.len()] {
            TERMS.map(|[a, b]| {
                let power = |v: f64, k: i32| if k < 0 { 0.0 } else { v.powi(k) };
                let factor = f64::from(if by_x > 0 { a } else { 1 } * if by_y > 0 { b } else { 1 });
                factor * power(x, a - by_x) * power(y, b - by_y) / over
            })
        };
        // distances are along the normal, and a slope's error is that of its normal over nz^2
        let height = found.surface.distance(place) / frame.scale / up[2];
        all.push((term(0, 0, of_height), height / of_height));
        let of_slope = of_normal / (up[2] * up[2]);
        let slopes = [0, 1].map(|k| up[k] / up[2] - felt[k] / felt[2]);
        all.push((term(1, 0, of_slope), slopes[0] / of_slope));
        all.push((term(0, 1, of_slope), slopes[1] / of_slope));
    }
    all.iter().all(|(_, residual)| residual.is_finite()).then_some(all)
}
