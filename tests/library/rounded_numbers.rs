//! Numbers that were rounded where they were written: no patch is refused for it, and intervals hold the truth.
//!
//! ```text
//! bar, ball, saddle, plane      aligned or turned; on a grid or scattered; with normals or without
//! rounded to 2, 3, 4, 5, 6 decimals or to single precision, and by nothing else
//! ```
//!
//! `cargo test --release --test library rounded -- --ignored --nocapture` prints the whole study, 600 patches of each family.

use crate::binomial::assert_share;
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::{Hypothesis, Recognition, RecognitionOptions};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{Vector, cross, dot, unit};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Family {
    Bar,
    Ball,
    Saddle,
    Plane,
}

impl Family {
    const ALL: [Family; 4] = [Family::Bar, Family::Ball, Family::Saddle, Family::Plane];

    /// Height and outward direction over a place, for a radius.
    fn at(self, x: f64, y: f64, r: f64) -> (f64, Vector) {
        match self {
            Family::Bar => ((r * r - x * x).sqrt() - r, [x, 0.0, (r * r - x * x).sqrt()]),
            Family::Ball => ((r * r - x * x - y * y).sqrt() - r, [x, y, (r * r - x * x - y * y).sqrt()]),
            Family::Saddle => (0.5 * (x * x - y * y) / r, [-x / r, y / r, 1.0]),
            Family::Plane => (0.0, [0.0, 0.0, 1.0]),
        }
    }

    /// R at a place.
    fn curvedness(self, x: f64, y: f64, r: f64) -> f64 {
        match self {
            Family::Bar => 0.5_f64.sqrt() / r,
            Family::Ball => 1.0 / r,
            Family::Saddle => {
                let (p, q) = ((x / r).powi(2), (y / r).powi(2));
                let w = 1.0 + p + q;
                let mean = 0.5 * (q - p) / (r * w.powf(1.5));
                (2.0 * mean * mean + (r * w).powi(-2)).sqrt()
            }
            Family::Plane => 0.0,
        }
    }
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Written {
    Decimals(i32),
    Single,
}

impl Written {
    fn of(self, v: f64) -> f64 {
        match self {
            Written::Decimals(digits) => {
                let unit = 10.0_f64.powi(digits);
                (v * unit).round() / unit
            }
            Written::Single => f64::from(v as f32),
        }
    }
}

/// One patch of the study.
#[derive(Clone, Copy, Debug)]
struct Case {
    family: Family,
    written: Written,
    turned: bool,
    on_grid: bool,
    with_normals: bool,
    radius: f64,
    sides: [usize; 2],
    seed: u64,
}

impl Case {
    fn drawn(family: Family, seed: u64) -> Case {
        let mut u = [0.0; 4];
        EffectDraws::new(seed, "rounded").uniforms(0, 0, 4, &mut u);
        let written = [2, 3, 4, 5, 6].map(Written::Decimals);
        let kind = seed as usize % 6;
        Case {
            family,
            written: if kind < 5 { written[kind] } else { Written::Single },
            turned: u[3] < 0.5,
            on_grid: (seed / 6).is_multiple_of(2),
            with_normals: (seed / 12).is_multiple_of(2),
            radius: HALF * 1.5 * (u[0] * 8.0_f64.ln()).exp(),
            sides: [u[1], u[2]].map(|u| 5 + (7.0 * u) as usize),
            seed,
        }
    }

    /// Axes of the body in the input.
    fn axes(&self) -> [Vector; 3] {
        if !self.turned {
            return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        }
        let mut g = [0.0; 6];
        EffectDraws::new(self.seed, "turned").gaussians(0, 0, 6, &mut g);
        let up = unit([0.4 * g[0], 0.4 * g[1], 1.0]);
        let side = unit(cross([g[2], g[3], g[4]], up));
        [side, cross(up, side), up]
    }

    fn places(&self) -> Vec<[f64; 2]> {
        let [n, m] = self.sides;
        let even = |k: usize, n: usize| HALF * (2.0 * k as f64 / (n - 1) as f64 - 1.0);
        let on_grid = (0..n * m).map(|r| [even(r % n, n), even(r / n, m)]);
        let scattered = (0..n * m).map(|r| {
            let mut u = [0.0; 2];
            EffectDraws::new(self.seed, "scattered").uniforms(r as u64, 0, 2, &mut u);
            u.map(|u| HALF * (2.0 * u - 1.0))
        });
        // a grid that is not turned is written first, and measured at its written places
        let written = |p: [f64; 2]| if self.turned { p } else { p.map(|v| self.written.of(v)) };
        if self.on_grid { on_grid.map(written).collect() } else { scattered.map(written).collect() }
    }

    fn contacts(&self) -> Contacts {
        let axes = self.axes();
        let placed = |v: Vector| [0, 1, 2].map(|k| self.written.of((0..3).map(|a| v[a] * axes[a][k]).sum()));
        let touched: Vec<(Vector, Vector)> = (self.places().iter())
            .map(|[x, y]| {
                let (z, normal) = self.family.at(*x, *y, self.radius);
                (placed([*x, *y, z]), placed(unit(normal)))
            })
            .collect();
        let (points, normals): (Vec<Vector>, Vec<Vector>) = touched.into_iter().unzip();
        let contacts = Contacts::from_points(&points);
        if self.with_normals { contacts.with_normal_vectors(&normals) } else { contacts }
    }

    /// Whether the interval of R, and of the radius where one is told, holds the truth; the reason where there is no answer.
    fn holds(&self) -> Result<bool, String> {
        let options = RecognitionOptions::default().with_up(self.axes()[2]);
        let found = Recognition::of(&self.contacts(), &options).map_err(|error| error.to_string())?;
        let axes = self.axes();
        let own = |p: Vector| [dot(p, axes[0]), dot(p, axes[1])];
        let truths = found.averaged.iter().map(|(p, _)| own(*p));
        let truth =
            truths.map(|[x, y]| self.family.curvedness(x, y, self.radius)).sum::<f64>() / found.averaged.len() as f64;
        let inside = |[lo, hi]: [f64; 2], truth: f64| lo <= truth && truth <= hi;
        let is_plane = self.family == Family::Plane && found.hypothesis == Hypothesis::Plane;
        let by_radius = found.radius_interval.filter(|_| matches!(self.family, Family::Bar | Family::Ball));
        let right = inside(found.curvedness.interval, truth) && by_radius.is_none_or(|i| inside(i, self.radius));
        Ok(right || is_plane)
    }
}

/// Half of a patch's side.
const HALF: f64 = 4.0;

/// Patches held and asked; the reasons of those that were refused.
fn study(family: Family, seeds: std::ops::Range<u64>) -> ([u64; 2], Vec<String>) {
    let (mut counts, mut refused) = ([0; 2], Vec::new());
    for seed in seeds {
        let case = Case::drawn(family, seed);
        counts[1] += 1;
        match case.holds() {
            Ok(held) => counts[0] += u64::from(held),
            Err(why) => refused.push(format!("{case:?}: {why}")),
        }
    }
    println!("{family:?}: {} of {} held, {} refused", counts[0], counts[1], refused.len());
    (counts, refused)
}

#[test]
fn rounded_patches_are_never_refused_and_mostly_held() {
    let (mut held, mut asked) = (0, 0);
    for family in Family::ALL {
        let (counts, refused) = study(family, 0..18);
        assert!(refused.is_empty(), "{refused:?}");
        (held, asked) = (held + counts[0], asked + counts[1]);
    }
    assert_share(held, asked, [0.95, 0.8], "rounded patches");
}

#[test]
#[ignore = "the whole study takes minutes"]
fn all_rounded_patches() {
    for (family, (counts, refused)) in Family::ALL.map(|family| (family, study(family, 0..600))) {
        assert!(refused.is_empty(), "{refused:?}");
        assert!(100 * counts[0] >= 94 * counts[1], "{family:?}: {counts:?}");
        assert_share(counts[0], counts[1], [0.95, 0.9], &format!("{family:?}"));
    }
}

/// Bars along an even grid, as their makers print them: most rows fit exactly.
#[test]
fn bars_along_a_grid_hold_their_radius() {
    for (radius, digits, sides) in
        [(15.0, 3, [7, 7]), (15.0, 6, [9, 9]), (12.5, 4, [6, 4]), (6.0, 6, [7, 7]), (1000.0, 6, [7, 7])]
    {
        for with_normals in [true, false] {
            let written = Written::Decimals(digits);
            let family = Family::Bar;
            let case = Case { family, written, turned: false, on_grid: true, with_normals, radius, sides, seed: 0 };
            assert_eq!(case.holds(), Ok(true), "{case:?}");
        }
    }
}

/// The diagonals of a square grid of a saddle lie exactly in planes; 9 and 7 of 25 contacts are no things beside a saddle of all.
#[test]
fn saddles_on_a_square_grid_are_one_surface() {
    for (written, side) in
        [(Written::Single, 5), (Written::Decimals(6), 5), (Written::Single, 7), (Written::Decimals(4), 6)]
    {
        for radius in [9.0, 17.8, 40.0] {
            let sides = [side, side];
            let family = Family::Saddle;
            let case =
                Case { family, written, turned: false, on_grid: true, with_normals: false, radius, sides, seed: 0 };
            assert!(case.holds().is_ok(), "{case:?}: {:?}", case.holds());
        }
    }
}

/// Doubles of full precision, and round numbers on a round quadric, keep their exact answers.
#[test]
fn exact_numbers_answer_exactly() {
    let places: Vec<[f64; 2]> = (0..49).map(|r| [f64::from(r % 7) - 3.0, f64::from(r / 7) - 3.0]).collect();
    let bar: Vec<Vector> = places.iter().map(|[x, y]| [*x, *y, (225.0 - x * x).sqrt() - 15.0]).collect();
    let saddle: Vec<Vector> = places.iter().map(|[x, y]| [*x, *y, (x * y).round() / 10.0]).collect();
    for points in [bar, saddle] {
        let found = Recognition::of(&Contacts::from_points(&points), &RecognitionOptions::default()).unwrap();
        assert!(found.noise.sd_z < 1e-8, "{:?}", found.noise);
    }
}
