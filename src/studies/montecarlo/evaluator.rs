//! From the coefficients of many replicates, one a lane, to S, R and whatever else was asked for.
//!
//! ```text
//! S = mean_g S(c), R = mean_g R(c)/scale over the shape grid g          NaN where S is defined at no point
//! ```
//!
//! Equal degrees 2 to 4 go through the kernel for lanes, all others point by point; both are tested against each other.

use ndarray::Array2;

use super::fixed_sites::tables;
use super::quantity::Quantity;
use palpate_geometry::contact::Frame;
use palpate_geometry::curvature::{Principal, ShapeClass};
use palpate_geometry::shape::{ShapeGrid, radius_of};
use palpate_geometry::surface::HeightField;
use palpate_numeric::bspline::{BasisRow, Knots};
use palpate_numeric::simd::{GridTables, Isa, REPLICATES, mean_shapes};

/// The shape grid of a patch, and what is asked of it.
#[derive(Clone, Debug)]
pub(super) struct Evaluator {
    knots: [Knots; 2],
    frame: Frame,
    degree: [usize; 2],
    tables: GridTables,
    rows: [Vec<BasisRow>; 2],
    quantities: Vec<Quantity>,
    /// Direction of k1 without noise, degrees.
    direction: f64,
}

impl Evaluator {
    /// Over `grid` (patch coordinates) for the quantities asked for, S and R first; `nominal` are the noise-free coefficients.
    pub(super) fn new(
        knots: [Knots; 2],
        frame: Frame,
        grid: &ShapeGrid,
        quantities: Vec<Quantity>,
        nominal: &[f64],
    ) -> Evaluator {
        let degree = [knots[0].degree(), knots[1].degree()];
        let tables = tables(&knots, [&grid.x, &grid.y]);
        let rows = grid.rows(&knots);
        let mut made = Evaluator { knots, frame, degree, tables, rows, quantities, direction: 0.0 };
        made.direction = made.surface(nominal).and_then(|s| made.direction_at_centre(&s)).unwrap_or(0.0);
        made
    }

    /// `out[q][lane]` for every lane's coefficients.
    pub(super) fn block(&self, isa: Isa, c: &[[f64; REPLICATES]], out: &mut [[f64; REPLICATES]]) {
        let Some(means) = out.first_chunk_mut() else { return };
        self.means_of_lanes(isa, c, means);
        if self.quantities.len() > 2 {
            for lane in 0..REPLICATES {
                let own: Vec<f64> = c.iter().map(|lanes| lanes[lane]).collect();
                let mut values = vec![f64::NAN; self.quantities.len()];
                [values[0], values[1]] = [out[0][lane], out[1][lane]];
                self.others(&own, &mut values);
                out.iter_mut().zip(values).for_each(|(row, value)| row[lane] = value);
            }
        }
    }

    /// Mean S and mean R, input units, for every lane's coefficients.
    pub(super) fn means_of_lanes(&self, isa: Isa, c: &[[f64; REPLICATES]], [s, r]: &mut [[f64; REPLICATES]; 2]) {
        if !(2..=4).contains(&self.degree[0]) || !mean_shapes(isa, self.degree, &self.tables, c, s, r) {
            for lane in 0..REPLICATES {
                let own: Vec<f64> = c.iter().map(|lanes| lanes[lane]).collect();
                [s[lane], r[lane]] = self.means(&own);
            }
        }
        r.iter_mut().for_each(|r| *r /= self.frame.scale);
    }

    fn surface(&self, c: &[f64]) -> Option<HeightField> {
        let shape = (self.knots[0].n_basis(), self.knots[1].n_basis());
        HeightField::new(self.knots.clone(), Array2::from_shape_vec(shape, c.to_vec()).ok()?).ok()
    }

    /// Mean S and R point by point, R in patch units.
    pub(super) fn means(&self, c: &[f64]) -> [f64; 2] {
        let Some(surface) = self.surface(c) else { return [f64::NAN; 2] };
        let (mut s, mut defined, mut r) = (0.0, 0.0, 0.0);
        for bx in &self.rows[0] {
            for by in &self.rows[1] {
                let Some(p) = surface.with_rows(bx, by).derivatives().principal() else { continue };
                r += p.curvedness();
                if let Some(own) = p.shape_index() {
                    s += own;
                    defined += 1.0;
                }
            }
        }
        [s / defined, r / (self.rows[0].len() * self.rows[1].len()) as f64]
    }

    /// Quantities from the third on; `values` holds S and R in input units.
    fn others(&self, c: &[f64], values: &mut [f64]) {
        let Some(surface) = self.surface(c) else { return };
        let scale = self.frame.scale;
        let mut means = None;
        let mut k_means = || *means.get_or_insert_with(|| self.mean_curvatures(&surface));
        for (k, quantity) in self.quantities.iter().enumerate().skip(2) {
            values[k] = match quantity {
                Quantity::ShapeIndex => values[0],
                Quantity::Curvedness => values[1],
                Quantity::K1 => k_means()[0],
                Quantity::K2 => k_means()[1],
                Quantity::Radius if values[0].is_nan() => f64::NAN,
                Quantity::Radius => radius_of(ShapeClass::of_shape_index(values[0]), values[1]).unwrap_or(f64::NAN),
                Quantity::Direction => self.direction_at_centre(&surface).map_or(f64::NAN, |d| {
                    let off = (d - self.direction + 90.0).rem_euclid(180.0) - 90.0;
                    self.direction + off
                }),
                Quantity::ShapeIndexAt(at) | Quantity::CurvednessAt(at) | Quantity::K1At(at) | Quantity::K2At(at) => {
                    self.principal_at(&surface, *at).map_or(f64::NAN, |p| quantity.at_point(&p, scale))
                }
            };
        }
    }

    fn mean_curvatures(&self, surface: &HeightField) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for bx in &self.rows[0] {
            for by in &self.rows[1] {
                if let Some(p) = surface.with_rows(bx, by).derivatives().principal() {
                    sums = [sums[0] + p.k1, sums[1] + p.k2];
                }
            }
        }
        let points = (self.rows[0].len() * self.rows[1].len()) as f64;
        sums.map(|sum| sum / points / self.frame.scale)
    }

    fn principal_at(&self, surface: &HeightField, [x, y]: [f64; 2]) -> Option<Principal> {
        let [ox, oy, _] = self.frame.origin;
        let at = surface.at((x - ox) / self.frame.scale, (y - oy) / self.frame.scale);
        at.derivatives().principal()
    }

    fn direction_at_centre(&self, surface: &HeightField) -> Option<f64> {
        let [x, y] = [0, 1].map(|k| {
            let [lo, hi] = self.knots[k].domain();
            0.5 * (lo + hi)
        });
        let principal = surface.at(x, y).derivatives().principal()?;
        let d = principal.direction1;
        (principal.difference > 0.0 && (d[0] != 0.0 || d[1] != 0.0))
            .then(|| d[1].atan2(d[0]).to_degrees().rem_euclid(180.0))
    }
}
