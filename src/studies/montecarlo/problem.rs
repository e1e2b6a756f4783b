//! The fit of a study's contacts in the patch that stands still: knots, frame, weights, and the nominal contacts.

use palpate_fitting::fit::{Fit, FitError, MethodUsed, NoiseSource};
use palpate_fitting::observation::{Roughness, ScatteredSites, linearise_normals};
use palpate_geometry::contact::{Contacts, Frame, Orientation};
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{RowWeights, SiteWeights, StencilMatrix, Targets, assemble, normal_rhs};
use palpate_numeric::solve::Cholesky;

/// Which rows are minimised, patch units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rows {
    /// Slope rows with these weights.
    Slopes(SiteWeights),
    /// Normal rows: 1/sd of heights and of normals.
    Normals {
        /// Weight of the heights.
        height: f64,
        /// Weight of the normals.
        weight: f64,
    },
}

/// A patch with its nominal contacts, ready to be fitted again and again.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    knots: [Knots; 2],
    frame: Frame,
    rows: Rows,
    roughness: Option<Roughness>,
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    /// Slopes of the nominal surface at the nominal sites.
    slopes: Vec<[f64; 2]>,
}

/// Sites, weights, factor and coefficients of the nominal problem.
pub(super) type Factored = (ScatteredSites, RowWeights, Cholesky, Vec<f64>);

impl Problem {
    /// From the fit of the nominal contacts; why not, where its answer is more than one Cholesky factor.
    pub(super) fn new(fit: &Fit, contacts: &Contacts) -> Result<Problem, &'static str> {
        let solution = fit.solution();
        if !fit.frame().keeps_axes() {
            return Err("the patch has axes of its own");
        }
        if !solution.unsupported.is_empty() || solution.pinned.is_some() {
            return Err("the nominal contacts leave coefficients free");
        }
        if solution.method != MethodUsed::Cholesky {
            return Err("the nominal fit needs more than Cholesky");
        }
        let Orientation::Normals { nx, ny, nz } = &contacts.orientation else {
            return Err("the contacts have no normals");
        };
        let scale = fit.frame().scale;
        let levels = fit.noise();
        let rows = match levels.source {
            NoiseSource::Weights(_) => Rows::Slopes(fit.equations().row_weights.at(0)),
            NoiseSource::Sigma => match (levels.sigma_z, levels.sigma_normal_deg) {
                (Some(z), Some(deg)) => Rows::Normals { height: scale / z, weight: 1.0 / deg.to_radians() },
                _ => return Err("the noise levels are not known"),
            },
            NoiseSource::Estimated => return Err("the noise levels are estimated with every fit"),
        };
        let normals = (0..contacts.len()).map(|r| [nx[r], ny[r], nz[r]]).collect();
        let points: Vec<[f64; 3]> =
            (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect();
        let knots = fit.patch().knots.clone();
        let frame = *fit.frame();
        let slopes = points
            .iter()
            .map(|p| {
                let at = fit.surface().at((p[0] - frame.origin[0]) / scale, (p[1] - frame.origin[1]) / scale);
                [at.zx, at.zy]
            })
            .collect();
        let roughness = fit.equations().roughness.clone();
        Ok(Problem { knots, frame, rows, roughness, points, normals, slopes })
    }

    /// Knots in patch coordinates.
    pub(super) fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// The rows.
    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The penalty.
    pub(super) fn roughness(&self) -> Option<&Roughness> {
        self.roughness.as_ref()
    }

    /// Length scale.
    pub(super) fn scale(&self) -> f64 {
        self.frame.scale
    }

    /// Nominal slopes at contact `r`.
    pub(super) fn slopes_at(&self, r: usize) -> [f64; 2] {
        self.slopes[r]
    }

    /// Nominal point of contact `r`, input units.
    pub(super) fn point(&self, r: usize) -> [f64; 3] {
        self.points[r]
    }

    /// Nominal normal of contact `r`.
    pub(super) fn normal(&self, r: usize) -> [f64; 3] {
        self.normals[r]
    }

    /// A point in patch coordinates.
    #[inline]
    pub(super) fn local(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| (point[k] - self.frame.origin[k]) / self.frame.scale)
    }

    /// A height in patch coordinates.
    #[inline]
    pub(super) fn local_height(&self, z: f64) -> f64 {
        (z - self.frame.origin[2]) / self.frame.scale
    }

    /// Sites, weights, factor and coefficients of the nominal problem.
    ///
    /// # Errors
    /// A factor that breaks.
    pub(super) fn factored(&self) -> Result<Factored, FitError> {
        let places: Vec<[f64; 2]> = self.points.iter().map(|p| self.local(*p)).map(|[x, y, _]| [x, y]).collect();
        let sites = ScatteredSites::new(self.knots.clone(), places);
        let mut row_weights = Vec::new();
        let mut targets = Targets::new();
        for (r, (point, normal)) in self.points.iter().zip(&self.normals).enumerate() {
            let height = self.local_height(point[2]);
            match self.rows {
                Rows::Slopes(m) => {
                    row_weights.push(m);
                    targets.push([m.z * height, -m.a * normal[0] / normal[2], -m.d * normal[1] / normal[2]]);
                }
                Rows::Normals { height: z, weight: w } => {
                    let [p, q] = self.slopes[r];
                    let (u, [first, second]) = linearise_normals(*normal, p, q);
                    row_weights.push(SiteWeights { z, a: w * u.a, b: w * u.b, d: w * u.d });
                    targets.push([z * height, w * first, w * second]);
                }
            }
        }
        let row_weights = RowWeights::PerSite(row_weights);
        let (factor, coefficients) = self.solved(&sites, &row_weights, &targets)?;
        Ok((sites, row_weights, factor, coefficients))
    }

    /// One fit of rows at any sites: factor and coefficients.
    ///
    /// # Errors
    /// A factor that breaks.
    pub(super) fn solved(
        &self,
        sites: &ScatteredSites,
        row_weights: &RowWeights,
        targets: &Targets,
    ) -> Result<(Cholesky, Vec<f64>), FitError> {
        let shape = palpate_numeric::linalg::Sites::shape(sites);
        let mut matrix = StencilMatrix::zeros(shape);
        assemble(sites, row_weights, &mut matrix);
        if let Some(Roughness { lambda, penalty, .. }) = &self.roughness {
            matrix.add_scaled(*lambda, penalty);
        }
        let mut c = vec![0.0; shape.unknowns()];
        normal_rhs(sites, row_weights, targets, &mut c);
        let mut factor = Cholesky::plan(shape).map_err(|source| FitError::Solve { source })?;
        factor.factor_and_solve(&matrix, &mut c).map_err(|source| FitError::Solve { source })?;
        Ok((factor, c))
    }
}
