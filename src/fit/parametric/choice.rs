//! `--surface auto`: when a height field cannot stand up to what was felt.
//!
//! ```text
//! steep     some slope |(nx, ny)|/nz > 1.5
//! turn      one normal in twenty more than 20 degrees from their mean
//! ```
//!
//! On the paper's patches a height field of degree 2 is off in R by 3 % where normals turn by 12 degrees and by 12 % where
//! they turn by 24; the surface in space by 0.1 % (`cargo bench --bench parametric -- auto`). One in twenty, because a
//! single poor normal calls for nothing.

use std::fmt;

use crate::contact::{Contacts, Orientation};
use crate::fit::FitOptions;

/// Largest slope that a height field is left with.
const STEEP: f64 = 1.5;
/// Turn from the mean normal, degrees, that a height field is left with.
const TURN_DEG: f64 = 20.0;
/// Share of the normals that may turn by more.
const BEYOND: f64 = 0.05;

/// Which kind of surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceKind {
    /// `z = S(x, y)`.
    #[default]
    Height,
    /// `Q(u, v)`.
    Parametric,
    /// Whichever the contacts call for.
    Auto,
}

impl SurfaceKind {
    /// The word on the command line, in scenes and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            SurfaceKind::Height => "height",
            SurfaceKind::Parametric => "parametric",
            SurfaceKind::Auto => "auto",
        }
    }
}

impl fmt::Display for SurfaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// `Height` or `Parametric` for these contacts, and why.
pub fn choose_surface(contacts: &Contacts, options: &FitOptions) -> (SurfaceKind, String) {
    match options.surface {
        SurfaceKind::Auto => by_normals(contacts, options),
        kind => (kind, "asked for".into()),
    }
}

fn by_normals(contacts: &Contacts, options: &FitOptions) -> (SurfaceKind, String) {
    if options.closed != [false; 2] {
        return (SurfaceKind::Parametric, "a direction closes".into());
    }
    if contacts.orientation == Orientation::None || contacts.is_empty() {
        return (SurfaceKind::Height, "without normals there is nothing to hold a surface in space".into());
    }
    let normals: Vec<[f64; 3]> = (0..contacts.len()).filter_map(|r| contacts.unit_normal(r)).collect();
    let sum = normals.iter().fold([0.0; 3], |m, n| [0, 1, 2].map(|k| m[k] + n[k]));
    let mean = super::vector::unit(sum);
    let mut turns: Vec<f64> =
        normals.iter().map(|n| super::vector::dot(*n, mean).clamp(-1.0, 1.0).acos().to_degrees()).collect();
    turns.sort_by(f64::total_cmp);
    let turn = turns[((1.0 - BEYOND) * (turns.len() - 1) as f64).floor() as usize];
    let steepest = normals.iter().map(|n| if n[2] > 0.0 { n[0].hypot(n[1]) / n[2] } else { f64::INFINITY });
    let steepest = steepest.fold(0.0, f64::max);
    if turn > TURN_DEG {
        return (SurfaceKind::Parametric, format!("normals turn by {turn:.0} degrees from the mean one"));
    }
    if steepest > STEEP {
        return (SurfaceKind::Parametric, format!("the steepest slope is {steepest:.2}, above {STEEP}"));
    }
    (SurfaceKind::Height, format!("no slope above {steepest:.2}, normals within {turn:.0} degrees from the mean"))
}
