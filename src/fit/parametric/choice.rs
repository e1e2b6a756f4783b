//! `--surface auto`: when a height field cannot stand up to what was felt.
//!
//! ```text
//! steep     some slope |(nx, ny)|/nz > 1.5          turn   the widest turn between a normal and their mean > 60 degrees
//! ```
//!
//! A height field of degree 2 over half an arc of 56 degrees (slope 1.5) already loses 4 % of R; that is the paper's
//! cylinder of radius 6.6 on its patch less a margin. Between there and flat a height field is the better conditioned.

use std::fmt;

use crate::contact::{Contacts, Orientation};
use crate::fit::FitOptions;

/// Largest slope that a height field is left with.
const STEEP: f64 = 1.5;
/// Widest turn from the mean normal, degrees.
const TURN_DEG: f64 = 60.0;

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
    if contacts.orientation == Orientation::None {
        return (SurfaceKind::Height, "without normals there is nothing to hold a surface in space".into());
    }
    let normals: Vec<[f64; 3]> = (0..contacts.len()).filter_map(|r| contacts.unit_normal(r)).collect();
    let sum = normals.iter().fold([0.0; 3], |m, n| [0, 1, 2].map(|k| m[k] + n[k]));
    let mean = super::vector::unit(sum);
    let turn = normals.iter().map(|n| super::vector::dot(*n, mean)).fold(1.0, f64::min).clamp(-1.0, 1.0);
    let turn = turn.acos().to_degrees();
    let steepest = normals.iter().map(|n| if n[2] > 0.0 { n[0].hypot(n[1]) / n[2] } else { f64::INFINITY });
    let steepest = steepest.fold(0.0, f64::max);
    if turn > TURN_DEG {
        return (SurfaceKind::Parametric, format!("a normal turns by {turn:.0} degrees from the mean one"));
    }
    if steepest > STEEP {
        return (SurfaceKind::Parametric, format!("the steepest slope is {steepest:.2}, above {STEEP}"));
    }
    (SurfaceKind::Height, format!("no slope above {steepest:.2}, no normal more than {turn:.0} degrees from the mean"))
}
