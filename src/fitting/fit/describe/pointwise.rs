//! Uncertainty of height, normal, S and R point by point, by the delta method.
//!
//! ```text
//! u^2(position) = u^2(S) / w^2                 w^2 = 1 + p^2 + q^2,  p, q = S_x, S_y
//! u^2(normal)   = ((1 + q^2) var p - 2 p q cov(p, q) + (1 + p^2) var q) / w^4
//! ```
//!
//! The second is the mean square of the angle by which noise turns the normal. cov(p, q) follows from the variance of p + q.

use super::uncertainty::{above_declared, noise_at_point};
use crate::fit::solved::Solved;
use crate::observation::Data;
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::{Outline, PointSds, by_coefficients, shape_gradient};
use palpate_numeric::bspline::{BasisRow, linspace};

/// Rows times functionals beyond which no point is asked: a few seconds of work, where the fit itself took a fraction of one.
const MOST_WORK: usize = 200_000_000;

/// Functionals at a point: height, p, q, p + q, S, R.
const FUNCTIONALS: usize = 6;

/// Standard uncertainties at `points` places each way of the patch's domain, the second direction running fastest, input
/// units; `None` where nothing tells the noise, or where there are too many rows to ask.
pub(in crate::fit) fn pointwise(solved: &Solved, points: usize) -> Option<Vec<PointSds>> {
    let work = solved.fitted.equations.count().saturating_mul(FUNCTIONALS * points * points);
    if work > MOST_WORK {
        return None;
    }
    let [x, y] = [0, 1].map(|k| {
        let [lo, hi] = solved.patch.knots[k].domain();
        linspace(lo, hi, points)
    });
    let scale = solved.patch.frame.scale;
    let above = above_declared(solved);
    let places = x.iter().flat_map(|x| y.iter().map(move |y| (*x, *y)));
    places.map(|(x, y)| Some(at(solved, above, x, y)?.scaled(scale))).collect()
}

fn at(solved: &Solved, above: [f64; 2], x: f64, y: f64) -> Option<PointSds> {
    let surface = &solved.surface;
    let (bx, by) = (surface.knots()[0].basis(x), surface.knots()[1].basis(y));
    let here = surface.with_rows(&bx, &by);
    let variance = |gradient: &[f64]| noise_at_point(solved, gradient, above).map(|u| u * u);
    let by_derivatives = |g: &[f64; 5]| {
        let mut out = vec![0.0; surface.coefficients().len()];
        let columns = surface.coefficients().ncols();
        by_coefficients(g, &bx, &by, |a, b, value| out[(bx.first + a) * columns + by.first + b] = value);
        out
    };
    let (p, q) = (here.zx, here.zy);
    let w2 = 1.0 + p * p + q * q;
    let of_height = variance(&heights(&bx, &by, surface.coefficients().dim()))?;
    let of_p = variance(&by_derivatives(&[1.0, 0.0, 0.0, 0.0, 0.0]))?;
    let of_q = variance(&by_derivatives(&[0.0, 1.0, 0.0, 0.0, 0.0]))?;
    let of_sum = variance(&by_derivatives(&[1.0, 1.0, 0.0, 0.0, 0.0]))?;
    let both = 0.5 * (of_sum - of_p - of_q);
    let turned = ((1.0 + q * q) * of_p - 2.0 * p * q * both + (1.0 + p * p) * of_q) / (w2 * w2);
    let gradient = shape_gradient(&here);
    let curved = gradient.sum != 0.0 || gradient.difference != 0.0;
    Some(PointSds {
        position: (of_height / w2).sqrt(),
        normal: turned.max(0.0).sqrt(),
        shape_index: if curved { variance(&by_derivatives(&gradient.shape_index)).map(f64::sqrt) } else { None },
        curvedness: if curved { variance(&by_derivatives(&gradient.curvedness)).map(f64::sqrt) } else { None },
    })
}

/// The height's derivatives by the coefficients.
fn heights(bx: &BasisRow, by: &BasisRow, (n, m): (usize, usize)) -> Vec<f64> {
    let mut out = vec![0.0; n * m];
    for (a, na) in bx.derivative(0).iter().enumerate() {
        for (b, mb) in by.derivative(0).iter().enumerate() {
            out[(bx.first + a) * m + by.first + b] = na * mb;
        }
    }
    out
}

/// Whether contacts support a place, in coordinates of the input along the frame's axes, as the shape's means have it.
pub(in crate::fit) fn supported<'a>(solved: &'a Solved) -> impl Fn(f64, f64) -> bool + 'a {
    let outline = match (&solved.data, solved.options.domain) {
        (Data::Scattered { contacts, .. }, None) => Some(Outline::new(&contacts.x, &contacts.y)),
        _ => None,
    };
    let Frame { origin, scale, .. } = solved.patch.frame;
    let origin = if solved.patch.frame.keeps_axes() { origin } else { solved.patch.frame.rotate(origin) };
    move |x, y| outline.as_ref().is_none_or(|o| o.holds((x - origin[0]) / scale, (y - origin[1]) / scale))
}

#[cfg(test)]
mod tests {
    use crate::fit::Fit;
    use crate::fit::{FitOptions, NormalSigma, Objective, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;

    const NOISE: f64 = 0.02;

    /// A saddle of 36 contacts, heights with noise.
    fn fitted(seed: u64) -> Fit {
        let mut noise = vec![0.0; 36];
        EffectDraws::new(seed, "pointwise").gaussians(0, 0, 36, &mut noise);
        let (x, y): (Vec<f64>, Vec<f64>) = (0..36).map(|r| ((r % 6) as f64 - 2.5, (r / 6) as f64 - 2.5)).unzip();
        let slopes = |r: usize| [0.2 * x[r], -0.1 * y[r]];
        let z = (0..36).map(|r| 0.1 * x[r] * x[r] - 0.05 * y[r] * y[r] + NOISE * noise[r]).collect();
        let normals: Vec<[f64; 3]> = (0..36).map(|r| [-slopes(r)[0], -slopes(r)[1], 1.0]).collect();
        let contacts = Contacts::from_positions(x.clone(), y.clone(), z).with_normal_vectors(&normals);
        // normals of one degree hold the slopes; both sds are declared, and only heights are drawn
        let objective = Objective::Normals(NormalSigma::Known { z: NOISE, normal_deg: 60.0 });
        let options = FitOptions { objective, ..FitOptions::default() };
        fit_contacts(&contacts, &options).unwrap()
    }

    #[test]
    fn spread_of_repeated_fits_is_what_each_says() {
        const POINTS: usize = 3;
        let said = fitted(0).pointwise(POINTS).unwrap();
        let at = |fit: &Fit| -> Vec<[f64; 2]> {
            let surface = fit.input_surface().unwrap();
            let places = [-2.5, 0.0, 2.5];
            let all = places.iter().flat_map(|x| places.iter().map(move |y| (*x, *y)));
            all.map(|(x, y)| surface.at(x, y))
                .map(|p| [p.z, p.derivatives().principal().unwrap().curvedness()])
                .collect()
        };
        let runs: Vec<Vec<[f64; 2]>> = (1..=300).map(|seed| at(&fitted(seed))).collect();
        for (k, said) in said.iter().enumerate() {
            let sd = |q: usize| {
                let mean = runs.iter().map(|run| run[k][q]).sum::<f64>() / runs.len() as f64;
                (runs.iter().map(|run| (run[k][q] - mean).powi(2)).sum::<f64>() / (runs.len() - 1) as f64).sqrt()
            };
            let p = fitted(0).input_surface().unwrap().at([-2.5, 0.0, 2.5][k / 3], [-2.5, 0.0, 2.5][k % 3]);
            let w = p.zx.hypot(p.zy).hypot(1.0);
            // 300 runs know a standard deviation to 4 %; normals as wide as 60 degrees add a little that is not drawn
            for (found, said) in [(sd(0) / w, said.position), (sd(1), said.curvedness.unwrap())] {
                assert!((found / said - 1.0).abs() < 0.2, "point {k}: {found} and {said}");
            }
        }
    }
}
