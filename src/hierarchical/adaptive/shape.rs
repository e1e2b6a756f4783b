//! S and R of an adaptive fit over a grid, and how far to trust their means.
//!
//! ```text
//! u^2(mean S) = sigma^2 g' (A + lambda P)^-1 g,   g = d(mean S)/dc      by one solution with the factor
//! ```

use super::answer::AdaptiveFit;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{
    Interval, Outline, PLANE_SIGNIFICANCE, ShapeGrid, ShapeMaps, ShapeReport, Spread, Statistic, class_probabilities,
    normal_interval, radius_of, shape_gradient,
};

/// Where the shape is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeQuestion {
    /// Points of the grid in x and y.
    pub points: [usize; 2],
    /// Fraction of each side that is cut at every edge.
    pub inset: f64,
    /// Level of the intervals.
    pub level: f64,
}

impl AdaptiveFit {
    /// Curvatures, S and R over a grid in input units, where contacts support them.
    pub fn maps(&self, grid: ShapeGrid, support: Option<&Outline>) -> ShapeMaps {
        let mut maps = ShapeMaps::of_heights(self, grid);
        if let Some(outline) = support {
            maps.leave_out_beyond(outline);
        }
        maps
    }

    /// Means, spread, class and radius over a grid; the means with their uncertainty where the fit has one.
    pub fn shape(&self, asked: &ShapeQuestion, support: Option<&Outline>) -> ShapeReport<ShapeMaps> {
        let domain = palpate_geometry::surface::Surface::domain(self);
        let maps = self.maps(ShapeGrid::over(domain, asked.points, asked.inset), support);
        let (s, r) = (maps.spread_of_shape_index(), maps.spread_of(&maps.curvedness, 1.0));
        let [u_s, u_r] = self.sds_of_means(&maps);
        let is_plane = self.report().plane_p.is_some_and(|p| p > PLANE_SIGNIFICANCE);
        let curved = s.mean.filter(|_| !is_plane);
        let class = curved.map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
        let of_r = statistic(r, u_r, asked.level, [0.0, f64::INFINITY]);
        ShapeReport {
            shape_index: curved.map_or(Statistic::default(), |_| statistic(s, u_s, asked.level, [-1.0, 1.0])),
            // what passes for a plane may be one
            curvedness: if is_plane { reaching_zero(of_r) } else { of_r },
            class,
            class_probability: curved.zip(u_s).map_or(Vec::new(), |(mean, u)| class_probabilities(mean, u)),
            radius: r.mean.and_then(|mean| radius_of(class, mean)),
            k1: maps.spread_of(&maps.k1, 1.0),
            k2: maps.spread_of(&maps.k2, 1.0),
            support: s.count as f64 / maps.grid.len() as f64,
            plane_p: self.report().plane_p,
            ..ShapeReport::of_maps(maps)
        }
    }

    /// Standard uncertainties of mean S and mean R, input units; `None` where they were not asked for.
    fn sds_of_means(&self, maps: &ShapeMaps) -> [Option<f64>; 2] {
        if self.inverse.is_none() {
            return [None; 2];
        }
        let (mut of_s, mut of_r) =
            (vec![0.0; self.field.coefficients().len()], vec![0.0; self.field.coefficients().len()]);
        let mut counts = [0.0; 2];
        for ((i, j), point) in maps.points.indexed_iter().filter(|(at, _)| maps.supported[*at]) {
            let place = self.to_patch([maps.grid.x[i], maps.grid.y[j]]);
            let by = shape_gradient(point);
            let defined = [maps.shape_index_at(i, j).is_some(), true];
            for (k, (sum, g)) in [(&mut of_s, by.shape_index), (&mut of_r, by.curvedness)].into_iter().enumerate() {
                if defined[k] {
                    counts[k] += 1.0;
                    self.gradient(place, self.in_patch(g))
                        .into_iter()
                        .for_each(|(number, d)| sum[number as usize] += d);
                }
            }
        }
        let sd = |gradient: Vec<f64>, count: f64| {
            let mut solved = gradient.clone();
            self.factor.solve(&mut solved);
            let square: f64 = gradient.iter().zip(&solved).map(|(a, b)| a * b).sum();
            (count > 0.0).then(|| (self.variance * square.max(0.0)).sqrt() / count)
        };
        [sd(of_s, counts[0]), sd(of_r, counts[1])]
    }

    /// Weights of the six numbers of a point in the patch's frame from derivatives by slopes and second derivatives of the input.
    fn in_patch(&self, [p, q, r, t, u]: [f64; 5]) -> [f64; 6] {
        let scale = self.frame.scale;
        [0.0, p, q, r / scale, t / scale, u / scale]
    }
}

fn statistic(spread: Spread, u: Option<f64>, level: f64, [floor, ceiling]: [f64; 2]) -> Statistic {
    let interval = spread.mean.zip(u).map(|(mean, u)| normal_interval(mean, u, level, floor, ceiling));
    Statistic { mean: spread.mean, sd: spread.sd, u, interval, ..Statistic::default() }
}

fn reaching_zero(statistic: Statistic) -> Statistic {
    Statistic { interval: statistic.interval.map(|of| Interval { lo: 0.0, ..of }), ..statistic }
}
