//! Canonical problems with reference solutions: the hard cases, shared by tests and benches.
//!
//! ```text
//! a case = data (contacts, a grid, or dense rows) + fit options + what may be expected of the answer
//! ```
//!
//! Every input is made with IEEE `+ - * / sqrt` and one integer generator, in an order that `tests/golden/cases.py`
//! repeats, so that both sides hold the same bits; [`HardCase::fingerprint`] is compared with the one stored beside the
//! reference. The references (`tests/golden/<name>.json`) solve the problem as it is written, by Householder QR in 80
//! digits.

mod clusters;
mod contradictions;
mod degrees;
mod duplicates;
mod extremes;
mod fingerprint;
mod fingers;
mod gap;
mod hilbert;
mod inputs;
mod knots;
mod nist;
mod outliers;
mod radii;
mod rim;
mod scales;
mod slopes_only;
mod umbilics;
mod weights;

pub use nist::{FILIPPELLI_CERTIFIED, LONGLEY_CERTIFIED};
pub use palpate_numeric::draws::Lcg;
pub use palpate_studies::frontier::{DIGITS_OF_A_DOUBLE, digits_absolute, digits_of};

use ndarray::Array2;

use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::{Contacts, Grid};

/// A least squares problem that comes as rows: `min |rhs - rows c|`.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseRows {
    /// Equations x unknowns.
    pub rows: Array2<f64>,
    /// One entry per equation.
    pub rhs: Vec<f64>,
}

/// What is fitted.
#[derive(Clone, Debug, PartialEq)]
pub enum CaseData {
    /// Scattered contacts.
    Contacts(Contacts),
    /// A complete grid of heights.
    Grid(Grid),
    /// No surface at all: rows for the least squares core.
    Rows(DenseRows),
}

/// What the data of a case determine, and so what an answer can be held to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// Coefficients, S and R are those of the reference.
    Determined,
    /// Coefficients up to one constant (no heights); S and R are those of the reference.
    UpToHeight,
    /// Rank below the number of unknowns: the fitted values at the contacts are those of the reference; where the
    /// surface of least thin-plate roughness is unique, so are the coefficients.
    RankDeficient,
    /// Coefficients of the reference and no S: the surface is a plane.
    Plane,
    /// A hole: held to the reference at the contacts only, to the data's range inside.
    Gap,
}

/// One hard problem.
#[derive(Clone, Debug, PartialEq)]
pub struct HardCase {
    /// Name of the case and of its golden file.
    pub name: &'static str,
    /// What makes it hard.
    pub tests: &'static str,
    /// What is fitted.
    pub data: CaseData,
    /// How.
    pub options: FitOptions,
    /// What the data determine.
    pub expectation: Expectation,
}

/// Each file beside this one holds one family.
const FAMILIES: [fn() -> Vec<HardCase>; 17] = [
    umbilics::cases,
    radii::cases,
    rim::cases,
    fingers::cases,
    gap::cases,
    duplicates::cases,
    knots::cases,
    degrees::cases,
    clusters::cases,
    weights::cases,
    scales::cases,
    slopes_only::cases,
    contradictions::cases,
    outliers::cases,
    hilbert::cases,
    extremes::cases,
    nist::cases,
];

impl HardCase {
    /// All hard cases, family by family.
    pub fn all() -> Vec<HardCase> {
        FAMILIES.iter().flat_map(|family| family()).collect()
    }

    /// The case of that name.
    pub fn named(name: &str) -> Option<HardCase> {
        HardCase::all().into_iter().find(|case| case.name == name)
    }

    /// Scattered contacts whose answer is determined.
    fn contacts(name: &'static str, tests: &'static str, contacts: Contacts, options: FitOptions) -> HardCase {
        let data = CaseData::Contacts(contacts);
        HardCase { name, tests, data, options, expectation: Expectation::Determined }
    }

    /// A grid whose answer is determined.
    fn grid(name: &'static str, tests: &'static str, grid: Grid, options: FitOptions) -> HardCase {
        HardCase { name, tests, data: CaseData::Grid(grid), options, expectation: Expectation::Determined }
    }

    /// Dense rows of full rank.
    fn rows(name: &'static str, tests: &'static str, rows: DenseRows) -> HardCase {
        let (data, options) = (CaseData::Rows(rows), FitOptions::default());
        HardCase { name, tests, data, options, expectation: Expectation::Determined }
    }

    fn expecting(mut self, expectation: Expectation) -> HardCase {
        self.expectation = expectation;
        self
    }
}

/// Digits of the worst entry, each relative to itself (NIST's log relative error).
pub fn digits_each(found: &[f64], reference: &[f64]) -> f64 {
    if found.len() != reference.len() {
        return 0.0;
    }
    found.iter().zip(reference).map(|(f, r)| digits_of(&[*f], &[*r])).fold(DIGITS_OF_A_DOUBLE, f64::min)
}
