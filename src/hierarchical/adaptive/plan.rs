//! The same places measured again: cells, weights and factor stay, and every new set of heights costs one pass and one solution.
//!
//! ```text
//! c = (A + P)^-1 g      g = sum_r w_r N_r' z_r, with slopes likewise      sigma^2 = (sum w z^2 - g'c)/(N - m)
//! ```
//!
//! Nothing is decided anew: which cells there are, how strongly roughness counts and which contacts are left out is what the first
//! measurement said.

use std::sync::Arc;

use super::answer::AdaptiveFit;
use super::contact_passes::ContactPasses;
use super::held_contacts::HeldContacts;
use super::options::AdaptiveOptions;
use super::{PreparedContacts, answered, refined};
use crate::equations::{BlockWeights, MeetingPattern};
use crate::error::HierarchyError;
use crate::factor::EquationSolver;
use crate::field::HierarchicalField;
use crate::space::HierarchicalSpace;
use palpate_geometry::contact::{ContactError, Contacts, Frame, Orientation};

/// A surface over the cells of the first measurement.
#[derive(Clone, Debug)]
pub struct RepeatedHeights {
    /// The surface in the patch's frame, that of the first measurement.
    pub field: HierarchicalField,
    /// Standard deviation of a height of weight 1, input units.
    pub height_noise: f64,
    frame: Frame,
}

impl RepeatedHeights {
    /// The surface in the input's own coordinates.
    ///
    /// # Errors
    /// When the input's own rounding makes distinct knots equal.
    pub fn input_field(&self) -> Result<HierarchicalField, HierarchyError> {
        self.field.placed(self.frame.origin, self.frame.scale)
    }
}

/// A hierarchy with its factor, for new heights at the same places.
#[derive(Clone, Debug)]
pub struct AdaptivePlan {
    frame: Frame,
    contacts: HeldContacts,
    weights: BlockWeights,
    pattern: MeetingPattern,
    factor: EquationSolver,
    flat: HierarchicalField,
    /// Dimension of the surfaces without roughness.
    smooth: f64,
}

/// Fits as [`fit_adaptive`](super::fit_adaptive) does, and keeps what repeats of it need.
///
/// # Errors
/// Those of a fit; contacts with normals, whose rows depend on the heights.
pub fn plan_adaptive(
    contacts: &Contacts,
    options: &AdaptiveOptions,
) -> Result<(AdaptiveFit, AdaptivePlan), HierarchyError> {
    if matches!(contacts.orientation, Orientation::Normals { .. }) {
        let expected = "heights with slopes or without: rows of normals depend on the heights";
        return Err(HierarchyError::Option { option: "orientation", value: "normals".into(), expected });
    }
    let mut given = PreparedContacts::of(contacts, options)?;
    let (refinement, system) = refined(&given.ground, &mut given.held, options, given.sorting)?;
    let space: Arc<HierarchicalSpace> = system.space.clone();
    let flat = HierarchicalField::new(space.clone(), vec![0.0; space.unknowns()])?;
    let (weights, pattern, factor) = (refinement.weights, system.pattern.clone(), system.factor.clone());
    let frame = given.ground.frame;
    let fit = answered(refinement, system, frame)?;
    let smooth = options.roughness.null_dimension() as f64;
    Ok((fit, AdaptivePlan { frame, contacts: given.held, weights, pattern, factor, flat, smooth }))
}

impl AdaptivePlan {
    /// The surface of other heights, and of other slopes where the first contacts had some, in their order and in input units.
    ///
    /// # Errors
    /// Columns of another length, numbers that are not finite, slopes that are missing or have no place.
    pub fn fit(&mut self, heights: &[f64], slopes: Option<[&[f64]; 2]>) -> Result<RepeatedHeights, HierarchyError> {
        self.check(heights, slopes)?;
        let (origin, scale) = (self.frame.origin[2], self.frame.scale);
        self.contacts.sorted.measure_again(|number| (heights[number] - origin) / scale, slopes);
        self.contacts.about(&self.flat)?;
        let space = self.flat.space();
        let sums = self.contacts.sums(&self.flat)?;
        let (_, load) = self.pattern.assemble(space, &sums, self.weights);
        let [squares, rows, slope_squares, slope_rows] = sums.totals();
        let mut coefficients = load.clone();
        self.factor.solve(&mut coefficients);
        let gain: f64 = load.iter().zip(&coefficients).map(|(a, b)| a * b).sum();
        let left = self.weights.heights * squares + self.weights.slopes * slope_squares - gain;
        let variance = left.max(0.0) / (rows + 2.0 * slope_rows - self.smooth).max(1.0);
        let field = HierarchicalField::new(space.clone(), coefficients)?;
        Ok(RepeatedHeights { field, height_noise: variance.sqrt() * scale, frame: self.frame })
    }

    fn check(&self, heights: &[f64], slopes: Option<[&[f64]; 2]>) -> Result<(), HierarchyError> {
        let expected = self.contacts.sorted.len();
        let given = slopes.map(|[zx, zy]| [("zx", zx), ("zy", zy)]);
        if given.is_some() != self.contacts.sorted.oriented() {
            let expected = if given.is_some() { "none: the first contacts had none" } else { "those of every contact" };
            return Err(HierarchyError::Option { option: "slopes", value: format!("{:?}", given.is_some()), expected });
        }
        for (column, values) in [("z", heights)].into_iter().chain(given.into_iter().flatten()) {
            if values.len() != expected {
                return Err(ContactError::Length { column, found: values.len(), expected }.into());
            }
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(ContactError::NotFinite { column, index, value: values[index] }.into());
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptive::fit_adaptive;
    use palpate_numeric::draws::Lcg;

    const COUNT: usize = 20_000;

    /// Places, and two measurements of a surface with a bump, the second one with another bump beside it.
    fn measured() -> (Contacts, Vec<f64>) {
        let mut draw = Lcg::new(21);
        let [x, y]: [Vec<f64>; 2] = [0, 1].map(|_| (0..COUNT).map(|_| 2.0 * draw.uniform() - 1.0).collect());
        let bump = |x: f64, y: f64, at: f64| 0.1 * (-((x - at).powi(2) + y * y) / 0.01).exp();
        let mut heights = |second: f64| -> Vec<f64> {
            let at = |r: usize| 0.2 * x[r] * y[r] + bump(x[r], y[r], 0.3) + second * bump(x[r], y[r], 0.35);
            (0..COUNT).map(|r| at(r) + 0.002 * draw.normal()).collect()
        };
        let (first, again) = (heights(0.0), heights(0.3));
        (Contacts::from_positions(x, y, first), again)
    }

    #[test]
    fn the_first_heights_again_are_the_first_fit() {
        let (contacts, _) = measured();
        let options = AdaptiveOptions::default();
        let (fit, mut plan) = plan_adaptive(&contacts, &options).unwrap();
        assert_eq!(fit.field(), fit_adaptive(&contacts, &options).unwrap().field());
        let again = plan.fit(&contacts.z, None).unwrap();
        let pairs = fit.field().coefficients().iter().zip(again.field.coefficients());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-11));
        assert!((again.height_noise / fit.height_noise() - 1.0).abs() < 1e-8);
    }

    #[test]
    fn other_heights_are_fitted_over_the_same_cells() {
        let (contacts, again) = measured();
        let (_, mut plan) = plan_adaptive(&contacts, &AdaptiveOptions::default()).unwrap();
        let repeated = plan.fit(&again, None).unwrap();
        assert!((repeated.height_noise / 0.002 - 1.0).abs() < 0.1, "{}", repeated.height_noise);
        // solutions of sums are sums of solutions
        let [first, both] = [plan.fit(&contacts.z, None).unwrap(), {
            let middle: Vec<f64> = contacts.z.iter().zip(&again).map(|(a, b)| 0.5 * (a + b)).collect();
            plan.fit(&middle, None).unwrap()
        }];
        let c = |of: &RepeatedHeights| of.field.coefficients().to_vec();
        let means = c(&first).into_iter().zip(c(&repeated)).map(|(a, b)| 0.5 * (a + b));
        assert!(means.zip(c(&both)).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn columns_that_do_not_fit_are_refused() {
        let (contacts, mut again) = measured();
        let (_, mut plan) = plan_adaptive(&contacts, &AdaptiveOptions::default()).unwrap();
        assert!(matches!(plan.fit(&again[1..], None), Err(HierarchyError::Contacts(ContactError::Length { .. }))));
        assert!(matches!(
            plan.fit(&again, Some([&again, &again])),
            Err(HierarchyError::Option { option: "slopes", .. })
        ));
        again[7] = f64::NAN;
        let refused = plan.fit(&again, None).unwrap_err();
        assert!(matches!(refused, HierarchyError::Contacts(ContactError::NotFinite { index: 7, .. })));
        let normals = contacts.clone().with_normal_vectors(&vec![[0.0, 0.0, 1.0]; COUNT]);
        assert!(plan_adaptive(&normals, &AdaptiveOptions::default()).is_err());
    }
}
