//! Uncertainty of position, normal, S, R, k1 and k2 of a height field point by point: what noise tells of its coefficients.

use super::uncertainty::{above_declared, noise_at_point};
use crate::fit::linear::equations::Equations;
use crate::fit::solved::Solved;
use crate::observation::Data;
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::{
    ByJet, Outline, PointSds, ShapeSds, Support, Uncertain, by_coefficients, point_sds, principal_gradients,
    shape_gradient,
};
use palpate_geometry::surface::{Jet, Surface};
use palpate_numeric::bspline::{BasisRow, linspace};
use palpate_numeric::linalg::{Sites, TensorShape};

/// Rows times functionals beyond which the rows are assembled once: a few seconds of work, where the fit itself took a fraction of one.
const MOST_WORK: usize = 200_000_000;

/// Entries of a banded factor times functionals beyond which no point is asked then.
const MOST_SOLVING: usize = 2_000_000_000;

/// Functionals at a point that the bound above counts: a fit that was asked before must not fall silent.
const FUNCTIONALS: usize = 8;

/// Standard uncertainties at `points` places each way of the patch's domain, the second direction running fastest, input
/// units; `None` where nothing tells the noise, or where there are too many unknowns to ask.
pub(in crate::fit) fn pointwise(solved: &Solved, points: usize) -> Option<Vec<PointSds>> {
    let equations = &solved.fitted.equations;
    let functionals = FUNCTIONALS * points * points;
    let assembled;
    let equations = if equations.count().saturating_mul(functionals) > MOST_WORK {
        let TensorShape { basis, degree } = equations.sites.shape();
        let band = degree[0] * basis[1] + degree[1];
        if equations.unknowns().saturating_mul(band).saturating_mul(functionals) > MOST_SOLVING {
            return None;
        }
        assembled = equations.clone().assembled_once();
        &assembled
    } else {
        equations
    };
    let [x, y] = [0, 1].map(|k| {
        let [lo, hi] = solved.patch.knots[k].domain();
        linspace(lo, hi, points)
    });
    let scale = solved.patch.frame.scale;
    let noisy = Noisy { solved, equations, above: above_declared(solved) };
    let places = x.iter().flat_map(|x| y.iter().map(move |y| [*x, *y]));
    places.map(|at| Some(point_sds(&noisy, at)?.scaled(scale))).collect()
}

/// The fitted height field with what noise makes of it; `above` are the factors by which it is larger than declared.
struct Noisy<'a> {
    solved: &'a Solved,
    equations: &'a Equations,
    above: [f64; 2],
}

impl Noisy<'_> {
    fn rows(&self, [x, y]: [f64; 2]) -> [BasisRow; 2] {
        let knots = self.solved.surface.knots();
        [knots[0].basis(x), knots[1].basis(y)]
    }

    /// Of a functional with these derivatives by the slopes and second derivatives, and by the height.
    fn sd(&self, [bx, by]: &[BasisRow; 2], g: &[f64; 5], of_height: f64) -> Option<f64> {
        let (n, m) = self.solved.surface.coefficients().dim();
        let mut out = vec![0.0; n * m];
        by_coefficients(g, bx, by, |a, b, value| out[(bx.first + a) * m + by.first + b] = value);
        if of_height != 0.0 {
            add_heights(bx, by, of_height, m, &mut out);
        }
        noise_at_point(self.solved, self.equations, &out, self.above)
    }
}

impl Uncertain for Noisy<'_> {
    fn jet(&self, at: [f64; 2]) -> Jet {
        self.solved.surface.jet(at)
    }

    fn functional_sd(&self, at: [f64; 2], by: &ByJet) -> Option<f64> {
        // x and y are fixed: noise moves the heights alone
        let [height, p, q, r, s, t] = by.map(|by| by[2]);
        self.sd(&self.rows(at), &[p, q, r, s, t], height)
    }

    fn shape_sds(&self, at: [f64; 2], jet: &Jet) -> ShapeSds {
        let rows = self.rows(at);
        // five derivatives instead of fifteen, as the means over the grid have them
        let gradient = shape_gradient(&self.solved.surface.with_rows(&rows[0], &rows[1]));
        let here = jet.derivatives.principal().and_then(|p| Some([p.shape_index()?, p.curvedness()]));
        let Some(here) = here.filter(|_| gradient.sum != 0.0 || gradient.difference != 0.0) else { return [None; 4] };
        let [of_k1, of_k2] = principal_gradients(here, &gradient.shape_index, &gradient.curvedness);
        [gradient.shape_index, gradient.curvedness, of_k1, of_k2].map(|g| self.sd(&rows, &g, 0.0))
    }
}

/// Adds `factor` times the height's derivatives by the coefficients.
fn add_heights(bx: &BasisRow, by: &BasisRow, factor: f64, columns: usize, out: &mut [f64]) {
    for (a, na) in bx.derivative(0).iter().enumerate() {
        for (b, mb) in by.derivative(0).iter().enumerate() {
            out[(bx.first + a) * columns + by.first + b] += factor * na * mb;
        }
    }
}

/// Whether contacts support a place, in coordinates of the input along the frame's axes, as the shape's means have it.
pub(in crate::fit) fn supported<'a>(solved: &'a Solved) -> impl Fn(f64, f64) -> bool + 'a {
    let outline = match (&solved.data, solved.options.domain) {
        (Data::Scattered { contacts, .. }, None) => Some(Outline::new(&contacts.x, &contacts.y)),
        _ => None,
    };
    let Frame { origin, scale, .. } = solved.patch.frame;
    let origin = if solved.patch.frame.keeps_axes() { origin } else { solved.patch.frame.rotate(origin) };
    move |x, y| outline.as_ref().is_none_or(|o| o.supports([(x - origin[0]) / scale, (y - origin[1]) / scale]))
}

#[cfg(test)]
mod tests {
    use super::PointSds;
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
        // what one fit says is taken at its own surface, which noise has bent: the root mean square of forty is compared
        let said: Vec<Vec<PointSds>> = (301..=340).map(|seed| fitted(seed).pointwise(POINTS).unwrap()).collect();
        let mean = |k: usize, pick: fn(&PointSds) -> f64| {
            (said.iter().map(|of| pick(&of[k]).powi(2)).sum::<f64>() / said.len() as f64).sqrt()
        };
        let at = |fit: &Fit| -> Vec<[f64; 4]> {
            let surface = fit.input_surface().unwrap();
            let places = [-2.5, 0.0, 2.5];
            let all = places.iter().flat_map(|x| places.iter().map(move |y| (*x, *y)));
            all.map(|(x, y)| surface.at(x, y))
                .map(|p| (p.z, p.derivatives().principal().unwrap()))
                .map(|(z, p)| [z, p.curvedness(), p.k1, p.k2])
                .collect()
        };
        let runs: Vec<Vec<[f64; 4]>> = (1..=300).map(|seed| at(&fitted(seed))).collect();
        for k in 0..POINTS * POINTS {
            let sd = |q: usize| {
                let mean = runs.iter().map(|run| run[k][q]).sum::<f64>() / runs.len() as f64;
                (runs.iter().map(|run| (run[k][q] - mean).powi(2)).sum::<f64>() / (runs.len() - 1) as f64).sqrt()
            };
            let p = fitted(0).input_surface().unwrap().at([-2.5, 0.0, 2.5][k / 3], [-2.5, 0.0, 2.5][k % 3]);
            let w = p.zx.hypot(p.zy).hypot(1.0);
            // 300 runs know a standard deviation to 4 %; normals as wide as 60 degrees add a little that is not drawn
            let pairs = [
                (sd(0) / w, mean(k, |u| u.position)),
                (sd(1), mean(k, |u| u.curvedness.unwrap())),
                (sd(2), mean(k, |u| u.curvatures.unwrap()[0])),
                (sd(3), mean(k, |u| u.curvatures.unwrap()[1])),
            ];
            for (found, said) in pairs {
                assert!((found / said - 1.0).abs() < 0.2, "point {k}: {found} and {said}");
            }
        }
    }
}
