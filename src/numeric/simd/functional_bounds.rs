//! Error bounds of functionals `g'c` in which only the unknowns of one cell take part: two kinds at eight points.
//!
//! ```text
//! bound = (min(m |D g|_2, v (sqrt(g'A g) rho + |A g|'t) + s |g|_1) + rounding) / size
//! ```
//!
//! A is symmetric, n x n, stored row by row. The eight vectors g of a kind are interleaved: entry u of all eight comes
//! before entry u + 1. Taking both kinds at once reads A once instead of twice.

use super::lanes::Lanes;
use super::{Isa, by_width, dispatch};

/// Functionals of one kind taken at once.
pub(super) const FUNCTIONALS: usize = 8;
/// Kinds of functionals taken at once: S and R.
pub(super) const KINDS: usize = 2;

/// One number for each functional.
pub type OfKinds = [[f64; FUNCTIONALS]; KINDS];

/// What the second bound needs, the one in the direction g.
#[derive(Clone, Copy, Debug)]
pub struct DirectedTerms<'a> {
    /// A, row by row.
    pub matrix: &'a [f64],
    /// t, one number for each row.
    pub weights: &'a [f64],
    /// rho.
    pub rows: f64,
    /// v.
    pub backward: f64,
    /// s.
    pub settled: f64,
}

/// What is the same for all functionals.
#[derive(Clone, Copy, Debug)]
pub struct BoundTerms<'a> {
    /// D, one number for each unknown.
    pub scales: &'a [f64],
    /// m; infinite where the second bound is the smaller one for every g.
    pub moved: f64,
    /// The second bound, where there is one.
    pub directed: Option<DirectedTerms<'a>>,
}

/// The unknowns of one cell, and the gradients of the functionals by these unknowns.
#[derive(Clone, Copy, Debug)]
pub struct CellGradients<'a> {
    /// First unknown of each run of neighbours, ascending.
    pub runs: &'a [usize],
    /// Gradients run after run, all runs of one length; one slice for each kind.
    pub entries: [&'a [[f64; FUNCTIONALS]]; KINDS],
}

impl<'a> CellGradients<'a> {
    #[inline(always)]
    fn cut<const P: usize, const Q: usize>(&self) -> CellGradients<'a> {
        if P * Q == 0 {
            return *self;
        }
        CellGradients { runs: &self.runs[..P], entries: self.entries.map(|entries| &entries[..P * Q]) }
    }

    #[inline(always)]
    fn width(&self) -> usize {
        self.entries[0].len() / self.runs.len()
    }

    #[inline(always)]
    fn entry<V: Lanes>(&self, place: usize, lanes: usize) -> [V; KINDS] {
        [V::load(&self.entries[0][place][lanes..]), V::load(&self.entries[1][place][lanes..])]
    }

    /// `sum_u values[u] g_u` over the unknowns of the cell.
    #[inline(always)]
    fn times<V: Lanes>(&self, values: &[f64], lanes: usize) -> [V; KINDS] {
        let width = self.width();
        let mut sums = [V::splat(0.0); KINDS];
        for (r, start) in self.runs.iter().enumerate() {
            for (k, value) in values[*start..*start + width].iter().enumerate() {
                let [g, h] = self.entry::<V>(r * width + k, lanes);
                let value = V::splat(*value);
                sums = [value.mul_add(g, sums[0]), value.mul_add(h, sums[1])];
            }
        }
        sums
    }

    /// `sum_u (scales[u] g_u)^2` of each kind.
    #[inline(always)]
    fn squares<V: Lanes>(&self, scales: &[f64], lanes: usize) -> [V; KINDS] {
        let width = self.width();
        let mut squares = [V::splat(0.0); KINDS];
        for (r, start) in self.runs.iter().enumerate() {
            for (k, scale) in scales[*start..*start + width].iter().enumerate() {
                let [g, h] = self.entry::<V>(r * width + k, lanes);
                let (g, h) = (V::splat(*scale) * g, V::splat(*scale) * h);
                squares = [g.mul_add(g, squares[0]), h.mul_add(h, squares[1])];
            }
        }
        squares
    }

    /// `sum_u |g_u|` of each kind.
    #[inline(always)]
    fn lengths<V: Lanes>(&self, lanes: usize) -> [V; KINDS] {
        let mut lengths = [V::splat(0.0); KINDS];
        for place in 0..self.entries[0].len() {
            let [g, h] = self.entry::<V>(place, lanes);
            lengths = [lengths[0] + g.abs(), lengths[1] + h.abs()];
        }
        lengths
    }
}

#[inline(always)]
fn bounds<V: Lanes, const P: usize, const Q: usize>(
    terms: &BoundTerms,
    gradients: &CellGradients,
    rounding: &OfKinds,
    size: &OfKinds,
) -> OfKinds {
    let gradients = &gradients.cut::<P, Q>();
    let mut out = [[0.0; FUNCTIONALS]; KINDS];
    let zero = V::splat(0.0);
    for lanes in (0..FUNCTIONALS).step_by(V::N) {
        let mut bounds = [V::splat(f64::INFINITY); KINDS];
        if terms.moved < f64::INFINITY {
            let [of_s, of_r] = gradients.squares::<V>(terms.scales, lanes);
            bounds = [V::splat(terms.moved) * of_s.sqrt(), V::splat(terms.moved) * of_r.sqrt()];
        }
        if let Some(directed) = &terms.directed {
            let is_patch = P * Q > 0 && directed.weights.len() == P * Q;
            let [forms, weighted] = if is_patch {
                patch_forms::<V, P, Q>(directed, gradients, lanes)
            } else {
                forms::<V>(directed, gradients, lanes)
            };
            // s is zero for most fits, which are solved directly: then no lengths are needed
            let lengths = if directed.settled > 0.0 { gradients.lengths::<V>(lanes) } else { [zero; KINDS] };
            for kind in 0..KINDS {
                let along = forms[kind].max(zero).sqrt().mul_add(V::splat(directed.rows), weighted[kind]);
                let other = along.mul_add(V::splat(directed.backward), V::splat(directed.settled) * lengths[kind]);
                // a comparison with NaN is false, which leaves the plain bound
                bounds[kind] = V::select(other.less(bounds[kind]), other, bounds[kind]);
            }
        }
        for kind in 0..KINDS {
            let whole = bounds[kind] + V::load(&rounding[kind][lanes..]);
            whole.div(V::load(&size[kind][lanes..])).store(&mut out[kind][lanes..]);
        }
    }
    out
}

/// `[g'A g, |A g|'t]` for a patch of one cell: all lengths are literal, and g is read once for Q rows of A.
#[inline(always)]
fn patch_forms<V: Lanes, const P: usize, const Q: usize>(
    directed: &DirectedTerms,
    gradients: &CellGradients,
    lanes: usize,
) -> [[V; KINDS]; 2] {
    let [mut forms, mut weighted] = [[V::splat(0.0); KINDS]; 2];
    let order = P * Q;
    let (matrix, weights) = (&directed.matrix[..order * order], &directed.weights[..order]);
    for a in 0..P {
        let rows = &matrix[a * Q * order..(a + 1) * Q * order];
        let mut products = [[V::splat(0.0); KINDS]; Q];
        for v in 0..order {
            let [g, h] = gradients.entry::<V>(v, lanes);
            for (b, sums) in products.iter_mut().enumerate() {
                let value = V::splat(rows[b * order + v]);
                *sums = [value.mul_add(g, sums[0]), value.mul_add(h, sums[1])];
            }
        }
        for (b, [along, across]) in products.into_iter().enumerate() {
            let (u, [g, h]) = (a * Q + b, gradients.entry::<V>(a * Q + b, lanes));
            let weight = V::splat(weights[u]);
            forms = [along.mul_add(g, forms[0]), across.mul_add(h, forms[1])];
            weighted = [along.abs().mul_add(weight, weighted[0]), across.abs().mul_add(weight, weighted[1])];
        }
    }
    [forms, weighted]
}

/// `[g'A g, |A g|'t]` for more cells: the rows of other cells' unknowns matter for the second number only.
#[inline(always)]
fn forms<V: Lanes>(directed: &DirectedTerms, gradients: &CellGradients, lanes: usize) -> [[V; KINDS]; 2] {
    let [mut forms, mut weighted] = [[V::splat(0.0); KINDS]; 2];
    let (order, width) = (directed.weights.len(), gradients.width());
    let mut next = 0;
    for (r, start) in gradients.runs.iter().enumerate() {
        for u in next..*start {
            directed.add_row(u, gradients, lanes, &mut weighted);
        }
        for k in 0..width {
            let products = directed.add_row(start + k, gradients, lanes, &mut weighted);
            let own = gradients.entry::<V>(r * width + k, lanes);
            forms = [products[0].mul_add(own[0], forms[0]), products[1].mul_add(own[1], forms[1])];
        }
        next = start + width;
    }
    for u in next..order {
        directed.add_row(u, gradients, lanes, &mut weighted);
    }
    [forms, weighted]
}

impl DirectedTerms<'_> {
    /// Returns `(A g)_u` and adds `|(A g)_u| t_u` to the sums.
    #[inline(always)]
    fn add_row<V: Lanes>(
        &self,
        u: usize,
        gradients: &CellGradients,
        lanes: usize,
        sums: &mut [V; KINDS],
    ) -> [V; KINDS] {
        let order = self.weights.len();
        let products: [V; KINDS] = gradients.times(&self.matrix[u * order..(u + 1) * order], lanes);
        let weight = V::splat(self.weights[u]);
        *sums = [products[0].abs().mul_add(weight, sums[0]), products[1].abs().mul_add(weight, sums[1])];
        products
    }
}

/// The bounds of both kinds at eight points.
///
/// # Panics
/// When an unknown has no scale or no column in the matrix, or there are fewer entries than runs need.
pub fn functional_bounds(
    isa: Isa,
    terms: &BoundTerms,
    gradients: &CellGradients,
    rounding: &OfKinds,
    size: &OfKinds,
) -> OfKinds {
    let widths = [gradients.runs.len(), gradients.width()];
    by_width!(isa, widths, bounds(
        terms: &BoundTerms,
        gradients: &CellGradients,
        rounding: &OfKinds,
        size: &OfKinds,
    ) -> OfKinds)
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    /// Twin: the written sums over all unknowns.
    fn twin(terms: &BoundTerms, gradient: &[f64], rounding: f64, size: f64) -> f64 {
        let n = gradient.len();
        let square: f64 = (0..n).map(|u| (terms.scales[u] * gradient[u]).powi(2)).sum();
        let mut bound = terms.moved * square.sqrt();
        if let Some(d) = &terms.directed {
            let product = |u: usize| (0..n).map(|v| d.matrix[u * n + v] * gradient[v]).sum::<f64>();
            let form: f64 = (0..n).map(|u| gradient[u] * product(u)).sum();
            let weighted: f64 = (0..n).map(|u| product(u).abs() * d.weights[u]).sum();
            let length: f64 = gradient.iter().map(|g| g.abs()).sum();
            bound = bound.min(d.backward * (form.max(0.0).sqrt() * d.rows + weighted) + d.settled * length);
        }
        (bound + rounding) / size
    }

    #[test]
    fn every_isa_agrees_with_the_written_sums() {
        let value = |a: usize, b: usize| ((a * 7 + b * 5 + 1) as f64 * 0.41).sin();
        let cells: [(usize, usize, Vec<usize>); 4] =
            [(9, 3, vec![0, 3, 6]), (23, 3, vec![2, 9]), (1, 1, vec![0]), (25, 4, vec![1, 6, 12, 18])];
        for (n, width, runs) in cells {
            let alive: Vec<usize> = runs.iter().flat_map(|&start| start..start + width).collect();
            // a Gram matrix, as a covariance is
            let gram = |a: usize, b: usize| (0..n + 3).map(|k| value(a, k) * value(b, k)).sum::<f64>();
            let matrix: Vec<f64> = (0..n * n).map(|k| gram(k / n, k % n)).collect();
            let weights: Vec<f64> = (0..n).map(|u| value(u, 3).abs()).collect();
            let scales: Vec<f64> = (0..n).map(|u| value(u, 5).abs() + 0.1).collect();
            let entries = [11, 29].map(|from| {
                alive.iter().map(|&u| std::array::from_fn(|k| value(u, k + from))).collect::<Vec<[f64; FUNCTIONALS]>>()
            });
            let gradients = CellGradients { runs: &runs, entries: entries.each_ref().map(|entries| &entries[..]) };
            let rounding = [[1e-3; FUNCTIONALS], [2e-3; FUNCTIONALS]];
            let size = [[1.0; FUNCTIONALS], std::array::from_fn(|k| 1.0 + k as f64)];
            let directed =
                |settled| Some(DirectedTerms { matrix: &matrix, weights: &weights, rows: 0.3, backward: 0.7, settled });
            for directed in [None, directed(0.0), directed(0.01)] {
                for moved in [0.02, 20.0].into_iter().chain(directed.map(|_| f64::INFINITY)) {
                    let terms = BoundTerms { scales: &scales, moved, directed };
                    for isa in Isa::available() {
                        let bounds = functional_bounds(isa, &terms, &gradients, &rounding, &size);
                        let mut twins = Twins::new("functional_bounds", isa);
                        for (kind, k) in (0..KINDS * FUNCTIONALS).map(|p| (p / FUNCTIONALS, p % FUNCTIONALS)) {
                            let mut whole = vec![0.0; n];
                            alive.iter().zip(&entries[kind]).for_each(|(&u, g)| whole[u] = g[k]);
                            twins.compare(bounds[kind][k], twin(&terms, &whole, rounding[kind][k], size[kind][k]));
                        }
                        twins.hold(4.0);
                    }
                }
            }
        }
    }
}
