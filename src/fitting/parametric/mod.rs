//! Fits of parametric surfaces, `Q(u, v) = sum_ij c_ij N_i(u) M_j(v)` in space, to contacts that no height field can follow.
//!
//! ```text
//! 1  flatten: (u, v) of every contact from fingers and stations, or from the contacts alone     fingers, isomap, layout
//! 2  start: linear rows, full 3 x 3 blocks                                                      start
//! 3  minimise  sum (n^.(P - Q(u)))^2/Z^2 + |n - n^|^2/sigma^2 + lambda E + tau T                descent, problem, foot_point, fairness
//! 4  estimate Z, sigma, lambda by their variance components                                     noise
//! 5  raise lambda until the surface bends no more than the contacts can have felt               limit_bending
//! 6  S, R and directions where contacts reach                                                   describe
//! ```
//!
//! Everything is made of scalar products, so S and R do not change when the contacts are rotated in space.

mod bending;
mod cell_sums;
mod cells;
mod certificate;
mod choice;
mod descent;
mod describe;
mod fairness;
mod fingers;
mod fit_data;
mod fitted;
mod flattening;
mod foot_point;
mod isomap;
mod layout;
mod limit_bending;
mod noise;
mod parallel;
mod parametric_fit;
mod patch_contacts;
mod pointwise;
mod problem;
mod quadrature;
mod robust;
mod start;
mod subset_start;
mod thinning;
mod vector;

use std::sync::OnceLock;

pub use certificate::ParametricCertificate;
#[doc(hidden)]
pub use choice::choose_surface;
pub use describe::ParametricShape;
pub use fitted::FittedSurface;
pub use parametric_fit::ParametricFit;
use parametric_fit::ParametricNoise;

use crate::fit::{FitError, FitOptions, Robust};
use cells::Cells;
use descent::Solver;
use fit_data::FitData;
use limit_bending::Limited;
use palpate_geometry::contact::Contacts;
use palpate_geometry::surface::Parametric;
use patch_contacts::PatchContacts;
use problem::{Problem, Weights};

/// tau of T: Christoffel symbols of 0.2 over the patch cost as much as one contact at one sigma. The contacts determine
/// the parametrisation; with 1 the corners of noisy patches fold together, and 1000 begins to hold back small balls.
const SLACK: f64 = 30.0;
/// alpha of the ties: an rms distance of 0.01 from the flattened places costs as much as one contact at one sigma.
/// With 100 the descent takes hundreds of steps instead of 20, and one replicate in thirty of noisy balls diverges.
const TIE: f64 = 1e4;

impl ParametricFit {
    /// Fits a parametric surface to contacts with normals.
    ///
    /// # Errors
    /// Every [`FitError`]: contacts on one curve or of several sheets, normals that change sides, too few of them, a surface
    /// that bends more than neighbouring contacts can have felt.
    pub fn new(contacts: &Contacts, options: &FitOptions) -> Result<ParametricFit, FitError> {
        options.check()?;
        let mut contacts = PatchContacts::new(contacts)?;
        let (mut flat, reason) = layout::flatten(&contacts, options)?;
        let (frame, knots) = layout::lay_out(&contacts, &mut flat, options)?;
        contacts.place(frame.origin, frame.scale);
        let cells = Cells::new(knots);
        check_count(&contacts, &cells)?;
        let gauss = quadrature::gauss_points(&cells);
        let (weights, unknown) = noise::first(options.objective, options.smooth, [SLACK, TIE], frame.scale);
        let mut problem = Problem::new(&cells, &contacts, &flat.places, &gauss, weights);
        let mut solver = Solver::new(&problem)?;
        let (mut state, mut reached, few) = subset_start::fit(&mut problem, &mut solver, &flat, unknown)?;
        let weights = problem.weights;
        let mut weighted = contacts.clone();
        if options.robust != Robust::None {
            robust::reweight(options.robust, &problem, &mut weighted, &mut solver, &mut state, &mut reached)?;
        }
        let mut problem = Problem::new(&cells, &weighted, &flat.places, &gauss, weights);
        let Limited { geometry, raised } =
            limit_bending::limit(&mut problem, &mut solver, &flat, unknown, &mut state, &mut reached)?;
        let weights = problem.weights;
        let mut last = certificate::final_factor(&problem, &mut solver, &state)?;
        if few.standing.is_some() {
            last.condition = subset_start::unraised_factor(&problem, [SLACK, TIE], &mut solver, &state)?;
        }
        let residuals = problem.residuals(&state.coefficients, &state.feet);
        let data = FitData {
            options: options.clone(),
            frame,
            surface: Parametric::from_free(cells.knots().clone(), &state.coefficients)?,
            support: layout::support(&flat, &state.feet.places, cells.knots()),
            feet: state.feet,
            weights,
            solver,
            residuals,
            cells,
            contacts: weighted,
            standing: few.standing,
        };
        Ok(ParametricFit {
            certificate: ParametricCertificate {
                parametrisation: format!("{}{reason}", flat.method),
                equations: contacts.equations(),
                unknowns: 3 * data.cells.shape().coefficients(),
                fairness_raised: few.raised + raised,
                ..ParametricCertificate::of(&reached, &geometry, last)
            },
            noise: noise_of(&weights, frame.scale, unknown.any()),
            data,
            shape: OnceLock::new(),
        })
    }
}

/// Checks that there are as many equations as coefficients: of the three unknowns of a coefficient contacts determine the
/// one along the normal, and the ties the other two.
fn check_count(contacts: &PatchContacts, cells: &Cells) -> Result<(), FitError> {
    let (equations, unknowns) = (contacts.equations(), cells.shape().coefficients());
    if equations < unknowns {
        return Err(FitError::TooFew { contacts: contacts.len(), equations, unknowns });
    }
    Ok(())
}

/// Noise sds and fairness in the units of the input.
fn noise_of(weights: &Weights, scale: f64, estimated: bool) -> ParametricNoise {
    ParametricNoise {
        position: weights.position * scale,
        normal_deg: weights.normal.to_degrees(),
        fairness: weights.fairness,
        estimated,
    }
}
