//! An adaptive fit in the units of its contacts: the surface, its noise and its standard uncertainties.
//!
//! ```text
//! cov c = sigma^2 (A + lambda P)^-1        u^2 = g' cov g + (g'b)^2 + e^2,   g a functional's derivatives by the coefficients
//! b = (A + lambda P)^-1 lambda P c         e: what is smaller than the cells, by the leading term of a spline's error
//! ```
//!
//! The covariance is that of the surface given the contacts when its roughness is drawn from the penalty's own law: over the points of a
//! surface it covers what smoothing takes away, too (G. Wahba, *J. R. Stat. Soc. B* 45 (1983) 133). At peaks more is taken away than on average:
//! b is what the roughness takes off a surface like the one that was found. All functions that a point needs meet
//! on its cell, so the entries of the inverse along the factor suffice. Where the factor would be too large, blocks of it and random draws take
//! its place.

use super::refinement::RefinementRound;
use super::system::FitWork;
use super::unresolved::unresolved_variance;
use crate::error::HierarchyError;
use crate::factor::{EquationSolver, PointInverse};
use crate::field::HierarchicalField;
use crate::space::LocalFunction;
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::{ByJet, PointSds, Uncertain, point_sds};
use palpate_geometry::surface::{Heights, Jet, Surface, SurfacePoint};
use palpate_numeric::bspline::BasisRow;

/// A surface fitted with knots where the contacts ask for them.
#[derive(Clone, Debug)]
pub struct AdaptiveFit {
    pub(super) field: HierarchicalField,
    pub(super) frame: Frame,
    pub(super) factor: EquationSolver,
    pub(super) inverse: Option<PointInverse>,
    /// What roughness takes off the surface, as far as the surface tells; known with the inverse.
    pub(super) smoothing: Option<HierarchicalField>,
    /// Variance of a height of weight 1, patch units.
    pub(super) variance: f64,
    pub(super) slope_sd: Option<f64>,
    pub(super) report: AdaptiveReport,
}

/// What became of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptiveReport {
    /// All rounds.
    pub rounds: Vec<RefinementRound>,
    /// Contacts that were left out, by their numbers, ascending.
    pub outliers: Vec<usize>,
    /// Weights of the roughness over the cells of every level in the patch's frame, for heights of weight 1.
    pub lambdas: Vec<f64>,
    /// Degrees of freedom of the surface; `None` without the entries of the inverse.
    pub freedom: Option<f64>,
    /// Whether the contacts came with normals.
    pub normals: bool,
    /// Contacts that count: those that were not left out.
    pub counted: usize,
    /// p-value of the best plane against the surface; `None` where the degrees of freedom are not known.
    pub plane_p: Option<f64>,
    /// Root mean square of the residuals of the heights that count, input units.
    pub rms: f64,
    /// Condition of the equilibrated matrix in the 1-norm, an estimate; NaN without the factor of the whole.
    pub condition: f64,
    /// Backward error of the coefficients in the last equations; `None` where uncertainties were not asked for.
    pub backward_error: Option<f64>,
    /// Numbers in the factor, or in those of the blocks that precondition conjugate gradients.
    pub factor_entries: usize,
    /// Whether conjugate gradients solved the equations, because the factor would have been too large.
    pub by_gradients: bool,
    /// Share by which random draws put standard uncertainties at points off, root mean square; `None` where nothing was drawn: from the
    /// factor of the whole they are exact.
    pub draws_error: Option<f64>,
    /// Where the time went.
    pub work: FitWork,
}

impl AdaptiveFit {
    /// The surface in the patch's frame, whose axes are those of the input.
    pub fn field(&self) -> &HierarchicalField {
        &self.field
    }

    /// Origin and unit of the patch's frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The surface in the input's own coordinates.
    ///
    /// # Errors
    /// When the input's own rounding makes distinct knots equal.
    pub fn input_field(&self) -> Result<HierarchicalField, HierarchyError> {
        self.field.placed(self.frame.origin, self.frame.scale)
    }

    /// How it came about.
    pub fn report(&self) -> &AdaptiveReport {
        &self.report
    }

    /// Standard deviation of a height of weight 1, input units; of noise that varies the root of the harmonic mean of its variances.
    pub fn height_noise(&self) -> f64 {
        self.variance.sqrt() * self.frame.scale
    }

    /// Standard deviation of a slope, or of a normal for each tangent axis in radians; `None` without either.
    pub fn slope_noise(&self) -> Option<f64> {
        self.slope_sd
    }

    pub(super) fn to_patch(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.frame.origin[0]) / self.frame.scale, (y - self.frame.origin[1]) / self.frame.scale]
    }

    /// Height, slopes and second derivatives at a place of the input.
    pub fn at(&self, x: f64, y: f64) -> SurfacePoint {
        let [u, v] = self.to_patch([x, y]);
        let (here, scale) = (self.field.at(u, v), self.frame.scale);
        SurfacePoint {
            z: self.frame.origin[2] + scale * here.z,
            zx: here.zx,
            zy: here.zy,
            zxx: here.zxx / scale,
            zxy: here.zxy / scale,
            zyy: here.zyy / scale,
        }
    }

    /// Standard uncertainty of the height at a place, input units; `None` where the inverse was not asked for.
    pub fn height_sd(&self, x: f64, y: f64) -> Option<f64> {
        let mut by: ByJet = [[0.0; 3]; 6];
        by[0][2] = 1.0;
        self.functional_sd([x, y], &by)
    }

    /// Standard uncertainties of position, normal, S and R at a place.
    pub fn point_sds(&self, at: [f64; 2]) -> Option<PointSds> {
        point_sds(self, at)
    }

    /// A functional's derivatives by the coefficients, `(function, derivative)`, of the six numbers' weights in the patch's frame.
    pub(super) fn gradient(&self, [u, v]: [f64; 2], weights: [f64; 6]) -> Vec<(u32, f64)> {
        let space = self.field.space();
        let leaf = space.leaf_at([u, v]);
        let place = space.leaves()[leaf].place.map(|k| k as usize);
        let [kx, ky] = space.knots_of(leaf);
        let (x, y) = (kx.basis_on(place[0], u), ky.basis_on(place[1], v));
        let width = ky.degree() + 1;
        let mut gradient: Vec<(u32, f64)> = Vec::new();
        for (k, function) in space.local_functions(leaf).enumerate() {
            let value = combined(&x, &y, [k / width, k % width], weights);
            match function {
                LocalFunction::Active(number) => gradient.push((number, value)),
                LocalFunction::Truncated(shares) => {
                    gradient.extend(shares.iter().map(|(number, share)| (*number, share * value)));
                }
            }
        }
        gradient.sort_unstable_by_key(|(number, _)| *number);
        gradient.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            kept.1 += if same { later.1 } else { 0.0 };
            same
        });
        gradient
    }
}

/// Weighted sum of value, slopes and second derivatives of one B-spline.
fn combined(x: &BasisRow, y: &BasisRow, [a, b]: [usize; 2], w: [f64; 6]) -> f64 {
    let of = |dx: usize, dy: usize| x.derivative(dx)[a] * y.derivative(dy)[b];
    w[0] * of(0, 0) + w[1] * of(1, 0) + w[2] * of(0, 1) + w[3] * of(2, 0) + w[4] * of(1, 1) + w[5] * of(0, 2)
}

/// Weighted sum of the six numbers of a surface at a place.
fn functional(field: &HierarchicalField, [u, v]: [f64; 2], weights: [f64; 6]) -> f64 {
    let here = field.at(u, v);
    let numbers = [here.z, here.zx, here.zy, here.zxx, here.zxy, here.zyy];
    numbers.iter().zip(weights).map(|(number, weight)| number * weight).sum()
}

impl Heights for AdaptiveFit {
    fn height_at(&self, x: f64, y: f64) -> SurfacePoint {
        self.at(x, y)
    }
}

impl Surface for AdaptiveFit {
    fn domain(&self) -> [[f64; 2]; 2] {
        let ends = self.field.domain();
        [0, 1].map(|k| ends[k].map(|t| self.frame.origin[k] + self.frame.scale * t))
    }

    fn closed(&self) -> [bool; 2] {
        [false; 2]
    }

    fn unknowns(&self) -> usize {
        self.field.coefficients().len()
    }

    fn jet(&self, [x, y]: [f64; 2]) -> Jet {
        let here = self.at(x, y);
        Jet { point: [x, y, here.z], derivatives: here.derivatives() }
    }
}

impl Uncertain for AdaptiveFit {
    fn jet(&self, at: [f64; 2]) -> Jet {
        Surface::jet(self, at)
    }

    fn functional_sd(&self, at: [f64; 2], by: &ByJet) -> Option<f64> {
        let inverse = self.inverse.as_ref()?;
        // only the third coordinate of a height field moves; derivatives of the input are those of the patch over its unit
        let scale = self.frame.scale;
        let units = [scale, 1.0, 1.0, 1.0 / scale, 1.0 / scale, 1.0 / scale];
        let (place, weights) = (self.to_patch(at), std::array::from_fn(|k| by[k][2] * units[k]));
        let noise = self.variance * inverse.quadratic(&self.gradient(place, weights))?.max(0.0);
        let smoothed = self.smoothing.as_ref().map_or(0.0, |bias| functional(bias, place, weights).powi(2));
        Some((noise + smoothed + unresolved_variance(&self.field, place, weights)).sqrt())
    }
}
