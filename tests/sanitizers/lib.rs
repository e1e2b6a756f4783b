//! The rooms that hold unsafe code or share work between threads, as they stand in `src`, with their unit tests.
//!
//! ```text
//! simd                                           all unsafe code
//! threads, surface, observation                  work shared between threads: joins, maps, memory behind a lock
//! ```
#![allow(dead_code, unused_imports, reason = "what the rooms above these would call")]

// the rooms of three crates stand in this one, and name each other as they do there
extern crate self as palpate_fitting;
extern crate self as palpate_geometry;
extern crate self as palpate_numeric;

#[path = "../../src/numeric/bspline/mod.rs"]
mod bspline;
#[path = "../../src/geometry/contact/mod.rs"]
mod contact;
#[path = "../../src/geometry/curvature/mod.rs"]
mod curvature;
#[path = "../../src/numeric/linalg/mod.rs"]
mod linalg;
#[path = "../../src/fitting/observation/mod.rs"]
mod observation;
#[path = "../../src/geometry/shape/mod.rs"]
mod shape;
#[path = "../../src/numeric/simd/mod.rs"]
mod simd;
#[path = "../../src/geometry/surface/mod.rs"]
mod surface;
#[cfg(not(feature = "scoped"))]
#[path = "../../src/numeric/threads.rs"]
mod threads;
#[cfg(feature = "scoped")]
#[path = "scoped.rs"]
mod threads;
#[path = "../../src/numeric/vector.rs"]
mod vector;

/// What shares work between threads, called as tests and, because the thread sanitizer does not follow the tests' harness, by
/// `races.rs`.
pub mod shared {
    use crate::bspline::Knots;
    use crate::linalg::{RowWeights, SiteWeights, StencilMatrix, TensorShape};
    use crate::observation::{CellAssembly, ScatteredSites};
    use crate::surface::CurvatureGrid;
    use crate::threads;

    /// The same sums again and again: a race that a sanitizer sees, or a bit that differs.
    #[cfg_attr(test, test)]
    pub fn every_way_to_share_work_gives_the_same_bits() {
        let of = |k: usize| (k as f64).sin() / (1.0 + k as f64);
        let sums = || -> Vec<u64> {
            let mapped = threads::map(5000, 16, of);
            let with = threads::map_with(
                5000,
                16,
                || vec![0.0; 8],
                |memory: &mut Vec<f64>, k| {
                    memory[k % 8] = of(k);
                    memory[k % 8]
                },
            );
            let tried = threads::try_map(500, |k| Some(of(k))).unwrap();
            let mut each = vec![0.0; 5000];
            threads::each(&mut each, |k, v| *v = of(k));
            let (left, right) = threads::join(|| mapped.iter().sum::<f64>(), || with.iter().sum::<f64>());
            assert!(threads::any(5000, 16, |k| k == 4999));
            [left, right, tried.iter().sum(), each.iter().sum()].map(f64::to_bits).to_vec()
        };
        let first = sums();
        (0..20).for_each(|_| assert_eq!(sums(), first));
    }

    /// The normal matrix of contacts in knot cells, whose halves are sorted and summed side by side.
    #[cfg_attr(test, test)]
    pub fn cells_are_summed_alike_again_and_again() {
        let axis = Knots::uniform(2, 12, 0.0, 1.0).unwrap();
        let place = |k: usize, step: f64| (k as f64 * step).fract();
        let points: Vec<[f64; 2]> = (0..70_000).map(|k| [place(k, 0.754_877_666), place(k, 0.569_840_291)]).collect();
        let weights = RowWeights::Uniform(SiteWeights { z: 1.0, a: 0.5, b: 0.0, d: 0.25 });
        let assembled = || -> Vec<u64> {
            let knots = [axis.clone(), axis.clone()];
            let sites = ScatteredSites::new(knots.clone(), points.clone());
            let packed = sites.packed_cells().unwrap();
            let mut matrix = StencilMatrix::zeros(TensorShape { basis: [14, 14], degree: [2, 2] });
            CellAssembly::new(knots).unwrap().add_packed(&weights, packed, &mut matrix);
            matrix.values().iter().map(|v| v.to_bits()).collect()
        };
        let first = assembled();
        (0..3).for_each(|_| assert_eq!(assembled(), first));
    }

    /// Maps of S and R of a large grid of points, whose rows are halved.
    #[cfg_attr(test, test)]
    pub fn maps_are_alike_again_and_again() {
        let axis = Knots::uniform(3, 9, 0.0, 1.0).unwrap();
        let points: Vec<f64> = (0..150).map(|k| k as f64 / 149.0).collect();
        let c: Vec<f64> = (0..144).map(|k| (k as f64 * 0.7).sin()).collect();
        let maps = || -> Vec<u64> {
            let mut grid = CurvatureGrid::new(&[axis.clone(), axis.clone()], &points, &points);
            let (mut s, mut r) = (vec![0.0; points.len().pow(2)], vec![0.0; points.len().pow(2)]);
            grid.maps(&c, &mut s, &mut r);
            s.iter().chain(&r).map(|v| v.to_bits()).collect()
        };
        let first = maps();
        (0..3).for_each(|_| assert_eq!(maps(), first));
    }

    /// A race on purpose, by which to see that the sanitizer is not blind.
    pub fn planted() {
        let cell = std::sync::atomic::AtomicPtr::new(Box::into_raw(Box::new(0_u64)));
        let add = || {
            (0..1000).for_each(|_| {
                let place = cell.load(std::sync::atomic::Ordering::Relaxed);
                #[allow(unsafe_code, reason = "a race cannot be written without")]
                // SAFETY: none, that is the point
                unsafe {
                    *place += 1
                };
            })
        };
        threads::join(add, add);
    }
}
