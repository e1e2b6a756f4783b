//! How narrow an interval can be that also holds the truth of surfaces beside the family.
//!
//! ```text
//! class     members of the family + sum_k u_k f_k(x, y),  |u| <= U     f_k: third and fourth degree, rms = relief
//! d(t)^2  = min of u'Au + (t - h.u)^2  over |u| <= U     distance, in noise, to the nearest whose mean R lies t off
//! A       = F_uu - F_up F^+ F_pu      h = (g_u - F_up F^+ g_p)/s       g: slopes of R by p and u; s: sd of the oracle
//! length >= s integral Phi(1.645 - d(t)) dt                            t in units of s
//! ```
//!
//! An interval that holds the truth in 95 % wherever in the class it lies cannot, at the family's own member, leave out a
//! value more often than the best test of 5 % finds the nearest surface that has it. J. W. Pratt, *J. Amer. Statist.
//! Assoc.* 56 (1961) 549; T. B. Armstrong and M. Kolesar, *Econometrica* 86 (2018) 655. To first order in the departures
//! and the noise, both of which are small. The relief is the rms of the height over its plane. With U = 0 the length is
//! 0.85 of the oracle's, which treats all members alike, while this bound may be met at one member alone. The length is the
//! expected one.

use faer::{Mat, Side};
use statrs::distribution::{ContinuousCDF, Normal};

use super::cramer_rao::{Family, Known, PLACES, Tangent, ends, lattice};
use palpate_numeric::linalg::dot;
use palpate_world::scene::Surface;
use palpate_world::scene::surface::Local;

/// Size of the departures that the table counts, as a share of the relief. Ten times less leaves few contacts as they are,
/// ten times more is no narrower bound.
pub const SHARE: f64 = 0.01;

/// Widths over the oracle's that are wanted.
const WANTED: f64 = 1.5;

/// Degrees of the polynomials along one side of the patch.
const DEGREES: usize = 5;

/// Degrees of the departures, x and y together.
const DEPARTURES: std::ops::RangeInclusive<usize> = 3..=4;

/// Step of t, in units of the oracle's sd.
const STEP_OF_T: f64 = 0.02;

/// Widths over the oracle's at which nothing is known, and no larger one is looked for.
const NOTHING: f64 = 100.0;

/// What is seen of a departure, at least: one that no contact shows would be told by none of the numbers.
const UNSEEN: f64 = 1e-9;

/// The least width that can be had of S and of R.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeastWidth {
    /// Over the oracle's, where departures may be [`SHARE`] of the relief.
    pub over_oracle: [Option<f64>; 2],
    /// Share of the relief from which on no interval is within 1.5 times the oracle's; `None` where there is none.
    pub share_of_goal: [Option<f64>; 2],
}

impl LeastWidth {
    /// That of the true member of a family; nothing where the family fixes the value or the arithmetic fails.
    pub fn of(family: &Family, places: &[[f64; 2]], noise: [Option<f64>; 2]) -> LeastWidth {
        let both = Distances::both(family, places, noise).unwrap_or_default();
        LeastWidth {
            over_oracle: both.each_ref().map(|d| d.as_ref().map(|d| d.over_oracle(SHARE, NOTHING))),
            share_of_goal: both.each_ref().map(|d| d.as_ref().and_then(Distances::share_of_goal)),
        }
    }
}

/// The distances of a class, in the directions in which departures are seen one by one.
struct Distances {
    /// Eigenvalues of A, units of the relief.
    seen: Vec<f64>,
    /// h along them.
    moves: Vec<f64>,
    /// How far the value can lie below and above the truth, in units of the oracle's sd.
    reach: [f64; 2],
}

impl Distances {
    /// Those of S and of R; `None` where the family fixes the value or the arithmetic fails.
    fn both(family: &Family, places: &[[f64; 2]], noise: [Option<f64>; 2]) -> Option<[Option<Distances>; 2]> {
        let tangent = Tangent::of(family, places, noise)?;
        let known = Known::of(&tangent.columns)?;
        let surface = (family.member)(&family.sizes)?;
        let departures = Departures::of(&surface, places)?;
        let columns = departures.columns(&surface, places, noise)?;
        let shared: Vec<Vec<f64>> = columns
            .iter()
            .map(|c| known.coordinates(&tangent.columns.iter().map(|p| dot(p, c)).collect::<Vec<_>>()))
            .collect();
        let count = columns.len();
        let a = Mat::from_fn(count, count, |i, j| dot(&columns[i], &columns[j]) - dot(&shared[i], &shared[j]));
        let eigen = a.self_adjoint_eigen(Side::Lower).ok()?;
        let most = eigen.S()[count - 1];
        let seen: Vec<f64> = (0..count).map(|k| eigen.S()[k].max(UNSEEN * most)).collect();
        let of = |q: usize| {
            let of_family = known.coordinates(&tangent.slopes[q]);
            let sd = dot(&of_family, &of_family).sqrt();
            let slopes = departures.slopes(q)?;
            let h: Vec<f64> = (0..count).map(|k| (slopes[k] - dot(&shared[k], &of_family)) / sd).collect();
            let along = |k: usize| (0..count).map(|i| eigen.U()[(i, k)] * h[i]).sum();
            let truth = departures.mean(q, None)?;
            let [low, high] = if q == 0 { [-1.0, 1.0] } else { [0.0, f64::INFINITY] };
            let reach = [(truth - low) / sd, (high - truth) / sd];
            Some(Distances { seen: seen.clone(), moves: (0..count).map(along).collect(), reach })
        };
        Some([0, 1].map(|q| if tangent.moves(q) { of(q) } else { None }))
    }

    /// Size of the nearest departure, and its distance, for t = 1 and a price `mu` of its square.
    fn nearest(&self, mu: f64) -> [f64; 2] {
        let v: Vec<f64> = self.moves.iter().zip(&self.seen).map(|(h, seen)| h / (seen + mu)).collect();
        let part = 1.0 / (1.0 + dot(&self.moves, &v));
        let seen: f64 = v.iter().zip(&self.seen).map(|(v, seen)| seen * v * v).sum();
        [part * dot(&v, &v).sqrt(), part * (seen + 1.0).sqrt()]
    }

    /// Distance to the nearest surface of the class whose value lies t off.
    fn distance(&self, t: f64, most: f64) -> f64 {
        let [free, near] = self.nearest(0.0);
        if free * t <= most {
            return near * t;
        }
        // the price rises until the departure is small enough
        let [mut low, mut high] = [1e-9, 1e18];
        for _ in 0..60 {
            let middle = f64::sqrt(low * high);
            if self.nearest(middle)[0] * t > most { low = middle } else { high = middle }
        }
        self.nearest(high)[1] * t
    }

    /// Least length over that of the oracle, where departures are at most this share of the relief; no more than `enough` is
    /// looked for.
    fn over_oracle(&self, share: f64, enough: f64) -> f64 {
        let Ok(normal) = Normal::new(0.0, 1.0) else { return f64::NAN };
        let [two_sided, one_sided] = [0.975, 0.95].map(|level| normal.inverse_cdf(level));
        let (mut found, mut t) = (0.0, 0.5 * STEP_OF_T);
        while found < enough && self.reach.iter().any(|reach| t < *reach) {
            let left_out = one_sided - self.distance(t, share);
            if left_out.is_nan() || left_out < -6.0 {
                break;
            }
            let sides = self.reach.iter().filter(|reach| t < **reach).count() as f64;
            found += normal.cdf(left_out) * sides * STEP_OF_T / (2.0 * two_sided);
            t += STEP_OF_T;
        }
        found
    }

    fn share_of_goal(&self) -> Option<f64> {
        let [mut low, mut high] = [1e-6, 1.0];
        if self.over_oracle(high, WANTED) < WANTED {
            return None;
        }
        for _ in 0..30 {
            let middle = f64::sqrt(low * high);
            if self.over_oracle(middle, WANTED) < WANTED { low = middle } else { high = middle }
        }
        Some(high)
    }
}

/// Departures of third and fourth degree over a patch.
struct Departures {
    /// Middle and half length of the patch along x and along y.
    patch: [[f64; 2]; 2],
    grid: Vec<[f64; 2]>,
    /// Slopes and bends of the true surface over the grid.
    bends: Vec<[f64; 5]>,
    /// Polynomials along one side, orthonormal over the lattice.
    along: [[f64; DEGREES]; DEGREES],
    /// Degrees of each departure along x and y.
    degrees: Vec<[usize; 2]>,
    relief: f64,
}

impl Departures {
    fn of(surface: &Surface, places: &[[f64; 2]]) -> Option<Departures> {
        let patch = ends(places).map(|[lo, hi]| [0.5 * (lo + hi), 0.5 * (hi - lo)]);
        if patch.iter().any(|[_, half]| *half <= 0.0) {
            return None;
        }
        let degrees = DEPARTURES.flat_map(|d| (0..=d).map(move |i| [d - i, i])).collect();
        let grid = lattice(places);
        let bends = grid.iter().map(|place| slopes_and_bends(surface, *place)).collect::<Option<Vec<_>>>()?;
        let mut found = Departures { patch, grid, bends, along: gram(), degrees, relief: 1.0 };
        let heights: Option<Vec<f64>> = found.grid.iter().map(|[x, y]| surface.height(*x, *y)).collect();
        let heights = heights?;
        let count = heights.len() as f64;
        let of_plane = [[0, 0], [1, 0], [0, 1]].map(|degrees| {
            found.grid.iter().zip(&heights).map(|(p, z)| found.jet(degrees, *p)[0] * z).sum::<f64>() / count
        });
        let square = dot(&heights, &heights) / count - dot(&of_plane, &of_plane);
        found.relief = square.max(0.0).sqrt();
        (found.relief > 1e-9 * patch[0][1]).then_some(found)
    }

    /// `[f, f_x, f_y, f_xx, f_xy, f_yy]` of the product of two polynomials.
    fn jet(&self, degrees: [usize; 2], place: [f64; 2]) -> [f64; 6] {
        let [x, y] = [0, 1].map(|d| {
            let [middle, half] = self.patch[d];
            let [f, first, second] = value(&self.along[degrees[d]], (place[d] - middle) / half);
            [self.scale(d) * f, self.scale(d) * first / half, self.scale(d) * second / (half * half)]
        });
        [x[0] * y[0], x[1] * y[0], x[0] * y[1], x[2] * y[0], x[1] * y[1], x[0] * y[2]]
    }

    /// The relief belongs to one of the two factors.
    fn scale(&self, axis: usize) -> f64 {
        if axis == 0 { self.relief } else { 1.0 }
    }

    /// Derivatives of every height and normal by each departure, in their standard deviations.
    fn columns(&self, surface: &Surface, places: &[[f64; 2]], [sd_z, sd_n]: [Option<f64>; 2]) -> Option<Vec<Vec<f64>>> {
        let sd_z = sd_z?;
        let column = |degrees: &[usize; 2]| {
            let mut column = Vec::new();
            for place in places {
                let normal = surface.at(place[0], place[1])?.local.normal;
                let [f, fx, fy, ..] = self.jet(*degrees, *place);
                column.push(f / sd_z);
                let turn = [-fx, -fy, 0.0];
                let across = dot(&normal, &turn);
                let sd_n = sd_n.unwrap_or(f64::INFINITY);
                column.extend([0, 1, 2].map(|d| normal[2] * (turn[d] - across * normal[d]) / sd_n));
            }
            // without normals the family's columns hold heights alone
            if sd_n.is_none() {
                column = column.into_iter().step_by(4).collect();
            }
            Some(column)
        };
        self.degrees.iter().map(column).collect()
    }

    /// Derivatives of mean S or R by each departure.
    fn slopes(&self, q: usize) -> Option<Vec<f64>> {
        const PART: f64 = 1e-5;
        let slope = |degrees: &[usize; 2]| {
            let [ahead, behind] = [PART, -PART].map(|part| self.mean(q, Some((*degrees, part))));
            Some((ahead? - behind?) / (2.0 * PART))
        };
        self.degrees.iter().map(slope).collect()
    }

    /// Mean S or R with a part of one departure.
    fn mean(&self, q: usize, departure: Option<([usize; 2], f64)>) -> Option<f64> {
        let mut values = Vec::new();
        for (place, bends) in self.grid.iter().zip(&self.bends) {
            let mut jet = *bends;
            if let Some((degrees, part)) = departure {
                let [_, more @ ..] = self.jet(degrees, *place);
                jet.iter_mut().zip(more).for_each(|(own, more)| *own += part * more);
            }
            let local = Local::of_height(jet)?;
            values.extend(if q == 0 { local.shape_index() } else { Some(local.curvedness()) });
        }
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// `[z_x, z_y, z_xx, z_xy, z_yy]`; the bends are differences of slopes.
fn slopes_and_bends(surface: &Surface, [x, y]: [f64; 2]) -> Option<[f64; 5]> {
    const APART: f64 = 1e-5;
    let slopes = |x: f64, y: f64| {
        let n = surface.at(x, y)?.local.normal;
        Some([-n[0] / n[2], -n[1] / n[2]])
    };
    let [zx, zy] = slopes(x, y)?;
    let bend = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k| (a[k] - b[k]) / (2.0 * APART));
    let [xx, xy] = bend(slopes(x + APART, y)?, slopes(x - APART, y)?);
    let [yx, yy] = bend(slopes(x, y + APART)?, slopes(x, y - APART)?);
    Some([zx, zy, xx, 0.5 * (xy + yx), yy])
}

/// Polynomials of degree 0 to 4 with unit rms and no common part over an even lattice from -1 to 1: Gram's.
fn gram() -> [[f64; DEGREES]; DEGREES] {
    let points: Vec<f64> = (0..PLACES).map(|i| 2.0 * i as f64 / (PLACES - 1) as f64 - 1.0).collect();
    let mean = |a: &[f64; DEGREES], b: &[f64; DEGREES]| {
        points.iter().map(|t| value(a, *t)[0] * value(b, *t)[0]).sum::<f64>() / PLACES as f64
    };
    let mut found = [[0.0; DEGREES]; DEGREES];
    for degree in 0..DEGREES {
        let mut one = [0.0; DEGREES];
        one[degree] = 1.0;
        for lower in &found[..degree] {
            let part = mean(&one, lower);
            one.iter_mut().zip(lower).for_each(|(c, l)| *c -= part * l);
        }
        let size = mean(&one, &one).sqrt();
        found[degree] = one.map(|c| c / size);
    }
    found
}

/// A polynomial with its first two derivatives.
fn value(coefficients: &[f64; DEGREES], t: f64) -> [f64; 3] {
    coefficients
        .iter()
        .rev()
        .fold([0.0; 3], |[f, first, second], c| [f * t + c, first * t + f, second * t + 2.0 * first])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> Vec<[f64; 2]> {
        (0..36).map(|i| [4.0 * (i / 12) as f64 - 4.0, 8.0 / 11.0 * (i % 12) as f64 - 4.0]).collect()
    }

    fn distances(surface: &Surface, q: usize) -> Distances {
        let noise = [Some(0.005), Some(0.5_f64.to_radians())];
        let [s, r] = Distances::both(&Family::of(surface).unwrap(), &places(), noise).unwrap();
        if q == 0 { s.unwrap() } else { r.unwrap() }
    }

    #[test]
    fn without_departures_the_least_is_the_best_test_of_one_member() {
        // z Phi(z) + phi(z) with z = 1.645, over 1.96
        for surface in [Surface::saddle([12.0, 12.0]), Surface::torus(20.0, 8.0)] {
            for q in [0, 1] {
                let alone = distances(&surface, q).over_oracle(0.0, NOTHING);
                assert!((alone - 0.850).abs() < 1e-3, "{alone}");
            }
        }
        let surface = Surface::sphere(10.0);
        let noise = [Some(0.005), None];
        let found = LeastWidth::of(&Family::of(&surface).unwrap(), &places(), noise);
        assert!(found.over_oracle[0].is_none() && found.over_oracle[1].unwrap() > 0.85);
    }

    #[test]
    fn larger_departures_never_lower_it_and_the_goal_is_met_at_its_share() {
        let torus = distances(&Surface::torus(20.0, 8.0), 0);
        let shares = [0.0, 1e-4, 1e-3, 3e-3, 1e-2, 0.1, 1.0].map(|share| torus.over_oracle(share, NOTHING));
        assert!(shares.is_sorted(), "{shares:?}");
        let share = torus.share_of_goal().unwrap();
        assert!((torus.over_oracle(share, NOTHING) - WANTED).abs() < 1e-3 && share < 1e-3, "{share}");
    }

    #[test]
    fn large_departures_leave_what_a_fit_with_free_departures_knows() {
        let torus = distances(&Surface::torus(20.0, 8.0), 1);
        // sd^2 of the larger model over s^2: 1 + h' A^-1 h
        let more: f64 = torus.moves.iter().zip(&torus.seen).map(|(h, seen)| h * h / seen).sum();
        assert!((torus.over_oracle(1e3, NOTHING) / (0.850 * (1.0 + more).sqrt()) - 1.0).abs() < 2e-3);
    }

    #[test]
    fn four_contacts_that_tell_little_have_an_answer() {
        let places = [[-4.0, -4.0], [-4.0, 4.0], [4.0, -4.0], [4.0, 4.0]];
        let surface = Surface::torus(20.0, 8.0);
        let found = LeastWidth::of(&Family::of(&surface).unwrap(), &places, [Some(0.005), Some(0.01)]);
        assert!(found.over_oracle[1].is_none_or(|least| least > 0.84), "{found:?}");
    }

    #[test]
    fn polynomials_are_orthonormal_and_derivatives_are_theirs() {
        let along = gram();
        let mean = |a: usize, b: usize| {
            let t = |i: usize| 2.0 * i as f64 / (PLACES - 1) as f64 - 1.0;
            (0..PLACES).map(|i| value(&along[a], t(i))[0] * value(&along[b], t(i))[0]).sum::<f64>() / PLACES as f64
        };
        for (a, b) in (0..DEGREES).flat_map(|a| (0..DEGREES).map(move |b| (a, b))) {
            assert!((mean(a, b) - f64::from(u8::from(a == b))).abs() < 1e-12);
        }
        assert_eq!(value(&[0.0, 0.0, 0.0, 1.0, 0.0], 2.0), [8.0, 12.0, 12.0]);
    }
}
