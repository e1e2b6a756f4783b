//! The answer in the input's coordinates and units: the map, the class, the radii, the noise and the words.

use std::sync::Arc;

use crate::bodies::Tuning;
use crate::dense;
use crate::recognition::contacts::Dropped;
use crate::recognition::discrepancy::{ChartPoint, State};
use crate::recognition::evidence::Node;
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::region::{CoarseGrid, DrawnLattice, DrawnShape, PatchSurface, PosteriorDraws, Region, places};
use crate::recognition::{
    Hypothesis, MapPoint, Misfit, NoiseFound, Recognition, RecognitionError, RecognitionOptions, Remark,
};
use palpate_geometry::curvature::{ShapeClass, curvedness, shape_index};
use palpate_geometry::shape::radius_of;

use super::inference::Findings;
use super::misfit::{self, misfit};
use super::model_comparison::reported;
use super::normalised_weights::total;
use super::posterior::{Summary, likeliest, summary};
use super::shape_means::Points;

/// Rows and columns of the map at whose points uncertainties are drawn; other points have what lies between.
const MAPPED: usize = 20;

/// The points that contacts support.
fn held(points: &[ChartPoint], supported: &[bool]) -> Vec<ChartPoint> {
    points.iter().zip(supported).filter(|(_, supported)| **supported).map(|(point, _)| point.clone()).collect()
}

/// The middle of the chart.
fn middle_of(surface: &PatchSurface) -> [f64; 2] {
    [surface.u, surface.v].map(|range| 0.5 * (range[0] + range[1]))
}

fn failed(step: &'static str) -> RecognitionError {
    RecognitionError::Arithmetic {
        step,
        what: "no kind of surface could be computed from these contacts; lengths of ordinary size (mm, not 1e-200) may help",
    }
}

impl Findings<'_> {
    /// The whole answer.
    pub(crate) fn recognition(&self, options: &RecognitionOptions) -> Result<Recognition, RecognitionError> {
        let tried = self.tried();
        let hypothesis = reported(&tried).ok_or_else(|| failed("comparison of hypotheses"))?;
        let own = self.nodes.iter().zip(&self.weights.estimate).filter(|(n, _)| n.hypothesis() == hypothesis);
        let (best, _) = own.max_by(|a, b| a.1.total_cmp(b.1)).ok_or_else(|| failed("comparison of hypotheses"))?;
        let state = likeliest(self.evidence, best).ok_or_else(|| failed("likeliest surface"))?;
        let misfit = self.misfit(best, &state, &options.tuning)?;
        let scale = self.patch.frame.scale;
        let base = self.evidence.models.iter().find(|m| m.kind() == Kind::General);
        let Some(Model::Constant(_, base)) = base else { return Err(failed("general fit")) };
        let around = |state: State| Region::new(self.patch, self.evidence, base, state, self.asked.means, options);
        let region = around(state);
        let mut found = self.summary_over(&region, best, options).ok_or_else(|| failed("averaging"))?;
        let region = if found.surface == region.surface.state { region } else { around(found.surface.clone()) };
        let Region { surface, map: points, supported, lattice, within_map, over: level_over } = region;
        if self.asked.means.is_none() && within_map.is_none() {
            found.move_to(&surface.state, &lattice, &held(&points, &supported));
        }
        let [of_departures, of_bodies] = options.tuning.left_by_splines;
        let of_splines = match best.group() {
            2 => of_departures,
            4 => of_bodies,
            _ => 0.0,
        };
        found.curvedness.doubted(self.doubt_of_places.hypot(of_splines));
        if let Some(s) = found.shape_index.as_mut().filter(|_| of_splines > 0.0) {
            s.blurred(of_splines, [-1.0, 1.0]);
        }
        let map = self.map(&surface, (&points, options.grid), &supported, &found);
        let plane_probability = total(&self.weights.estimate, self.nodes, |n| n.kind == Kind::Plane);
        let shape = found.shape_index.filter(|_| plane_probability <= 0.5);
        let class = shape.map_or(ShapeClass::Plane, |s| ShapeClass::of_shape_index(s.mean));
        let place_of = |p: &ChartPoint| surface.at(p.chart[0], p.chart[1]);
        let curvedness = found.curvedness.over(scale);
        let [k1, k2] = [found.k1 / scale, found.k2 / scale];
        let bounds = [1, 0].map(|i| radius_of(class, curvedness.interval[i]));
        let directed = !matches!(hypothesis, Hypothesis::Plane | Hypothesis::Sphere) && class != ShapeClass::Plane;
        let directions = if directed { self.directions(&surface) } else { None };
        // along a ridge or rut runs the direction of the smaller of the two in size
        let lengthwise = usize::from(found.k1.abs() > found.k2.abs());
        let axis = directions.map(|both| both[lengthwise]).filter(|_| class.has_axis());
        let Dropped { outliers, missing, normals_of_length_zero, normals_against, normals_flipped } =
            self.patch.dropped;
        let notes = self.notes(best, &misfit, class, &options.tuning);
        Ok(Recognition {
            hypothesis,
            class,
            class_probability: found.classes.clone(),
            shape_index: shape,
            curvedness,
            k1,
            k2,
            radius: radius_of(class, curvedness.mean),
            radii: radii(class, k1, k2),
            radius_interval: bounds[0].zip(bounds[1]).map(|(lo, hi)| [lo, hi]),
            direction: directions.map(|[k1, _]| k1),
            axis,
            axis_within_deg: axis.and(found.directions_within_deg).map(|both| both[lengthwise]),
            plane_probability,
            frame: self.patch.frame,
            support: (supported.iter().filter(|s| **s).count(), points.len()),
            map,
            grid: options.grid,
            over: level_over,
            averaged: match self.asked.means {
                Some(_) => lattice.iter().map(place_of).collect(),
                None => held(&points, &supported).iter().map(place_of).collect(),
            },
            surface: surface.into(),
            outliers,
            missing,
            normals_of_length_zero,
            normals_against,
            normals_flipped,
            normals: self.patch.normals,
            noise: self.noise(best),
            tried,
            effective_contacts: self.effective_contacts(best),
            contacts: self.patch.points.len(),
            side_known: !notes.iter().any(Remark::leaves_side_open),
            notes,
            predictive: found.predictive.into_iter().map(|draw| draw.scaled(scale)).collect(),
            draws: self.draws(found.draws, options.grid),
            misfit,
        })
    }

    /// Estimates and intervals over the points of a region.
    fn summary_over(&self, region: &Region, best: &Node, options: &RecognitionOptions) -> Option<Summary> {
        let chosen = CoarseGrid::of(options.grid, MAPPED).numbers();
        let map: Vec<ChartPoint> = chosen.iter().map(|number| region.map[*number].clone()).collect();
        let [u, v] = middle_of(&region.surface);
        // planes and spheres have no directions
        let is_directed = !matches!(best.kind, Kind::Plane | Kind::Sphere);
        let over = Points {
            all: &region.lattice,
            map: &map,
            within: region.within_map.as_deref().filter(|_| map.len() == region.map.len()),
            middle: is_directed.then(|| region.surface.chart_point(u, v)),
            touched: &places(&region.surface, self.asked.touches),
        };
        summary(self.evidence, self.nodes, self.weights, best, &over, options)
    }

    /// Correlation between the distances of single contacts and of those beside them, and the number of pairs: it shows a pattern that
    /// is finer than the cells, as along an edge.
    fn agreement_of_neighbours(&self, best: &Node, state: &State) -> (f64, f64) {
        let base = self.evidence.models.iter().find(|m| m.kind() == Kind::General);
        let distance = |i: usize| self.distance(base, best, state, self.patch.points[i]);
        let (mut product, mut square) = (0.0, 0.0);
        for &[i, j] in self.nearest {
            let (here, beside) = (distance(i), distance(j));
            product += here * beside;
            square += 0.5 * (here * here + beside * beside);
        }
        (if square > 0.0 { product / square } else { 0.0 }, self.nearest.len() as f64)
    }

    fn misfit(&self, best: &Node, state: &State, tuning: &Tuning) -> Result<Misfit, RecognitionError> {
        let residuals = self.residuals(best, state);
        let size = self.size(&residuals);
        let outliers =
            100.0 * self.patch.dropped.outliers as f64 / (self.patch.dropped.outliers + self.patch.points.len()) as f64;
        let correlated = total(&self.weights.estimate, self.nodes, |n| n.ratio > 0.0);
        let certain = best.is_displaced() && self.weights.displaced > tuning.certain;
        let findings = misfit::Findings {
            of_relief: size / self.relief,
            correlated,
            tau: best.tau() / self.relief,
            displacement: certain.then_some(self.weights.size),
            certain: tuning.certain,
        };
        let mut found = misfit(self.evidence.cells, &residuals, &findings);
        if size > tuning.unsaid_of_relief * self.relief {
            let (correlation, pairs) = self.agreement_of_neighbours(best, state);
            if correlation > found.neighbour_correlation {
                (found.neighbour_correlation, found.p) = (correlation, misfit::chance(correlation, pairs).min(found.p));
                found.words = misfit::words(&findings, found.p);
            }
        }
        let is_unexplained = size > tuning.unexplained_of_relief * self.relief && size > tuning.sensor_of_size;
        if is_unexplained && found.p < tuning.pattern_by_chance {
            return Err(RecognitionError::NotOneSheet { misfit: 100.0 * size / self.relief, outliers });
        }
        Ok(found)
    }

    fn map(
        &self,
        surface: &PatchSurface,
        (points, grid): (&[ChartPoint], [usize; 2]),
        supported: &[bool],
        found: &Summary,
    ) -> Vec<MapPoint> {
        let scale = self.patch.frame.scale;
        let coarse = CoarseGrid::of(grid, MAPPED);
        let one = |(i, point): (usize, &ChartPoint)| {
            let bent = surface.state.at(point);
            let u = coarse.between(&found.u, i);
            MapPoint {
                position: self.patch.frame.to_input(bent.place),
                normal: self.patch.frame.rotate_back(bent.normal),
                shape_index: shape_index(bent.k1 + bent.k2, bent.k1 - bent.k2),
                curvedness: curvedness(bent.k1, bent.k2) / scale,
                k1: bent.k1 / scale,
                k2: bent.k2 / scale,
                supported: supported[i],
                u_shape_index: u[0],
                u_curvedness: u[1] / scale,
                u_curvatures: [u[4], u[5]].map(|u| u / scale),
                u_position: u[2] * scale,
                u_normal: u[3],
            }
        };
        points.iter().enumerate().map(one).collect()
    }

    /// Draws over the map, in the input's units and axes.
    fn draws(&self, own: PosteriorDraws, grid: [usize; 2]) -> Arc<PosteriorDraws> {
        let scale = self.patch.frame.scale;
        let one = |shape: DrawnShape| DrawnShape { curvedness: shape.curvedness / scale, ..shape };
        let lines = CoarseGrid::of(grid, MAPPED).shares(grid);
        Arc::new(PosteriorDraws {
            shapes: own.shapes.into_iter().map(one).collect(),
            lattice: own.lattice.map(|lattice| DrawnLattice { lines, ..lattice }.in_input(&self.patch.frame)),
        })
    }

    /// Directions of k1 and of k2 in the middle of the cells, input axes.
    fn directions(&self, surface: &PatchSurface) -> Option<[[f64; 3]; 2]> {
        let [u, v] = middle_of(surface);
        let both = surface.state.directions(&surface.chart_point(u, v))?;
        Some(both.map(|direction| self.patch.frame.rotate_back(direction)))
    }

    fn noise(&self, best: &Node) -> NoiseFound {
        let cells = self.evidence.cells;
        let scale = self.patch.frame.scale;
        let per_cell = self.patch.points.len() as f64 / cells.points.len() as f64;
        let per_normal = self.patch.normals_per_cell(cells);
        NoiseFound {
            sd_z: scale * (best.variance * per_cell).sqrt(),
            sd_correlated: scale * best.tau(),
            correlation_length: (best.ratio > 0.0).then_some(scale * best.length),
            sd_normal_deg: self.linearised.normal_noise.map(|n| n.sd_of_normal(per_normal).to_degrees()),
        }
    }

    /// `(total variance of one contact) 1' Sigma^-1 1`.
    fn effective_contacts(&self, best: &Node) -> f64 {
        let cells = self.evidence.cells;
        let Some(lower) = self.evidence.kernels[best.kernel].factor(&cells.variance, self.distances) else {
            return 0.0;
        };
        let mut ones = vec![1.0; cells.points.len()];
        dense::forward(&lower, &mut ones);
        let per_cell = self.patch.points.len() as f64 / cells.points.len() as f64;
        (per_cell + best.ratio) * ones.iter().map(|v| v * v).sum::<f64>()
    }

    /// What the normals are too steep by; `None` where they may not be.
    fn gain(&self, best: &Node) -> Option<Remark> {
        let gain = self.linearised.gain.as_ref()?.mean(&self.evidence.coefficients(best)?)?;
        Some(Remark::Gain { gain })
    }

    /// By how much the normals are all turned; `None` where they may not be.
    fn tilt(&self, best: &Node) -> Option<Remark> {
        let degrees = self.linearised.tilt.as_ref()?.angle_deg(&self.evidence.coefficients(best)?)?;
        Some(Remark::Tilt { degrees })
    }

    fn notes(&self, best: &Node, misfit: &Misfit, class: ShapeClass, tuning: &Tuning) -> Vec<Remark> {
        let mut notes = self.patch.notes.clone();
        notes.extend(self.gain(best).into_iter().chain(self.tilt(best)));
        if self.weights.displacement_is_error() {
            let percent = 100.0 * self.weights.size;
            notes.push(match self.weights.taken_for_shape {
                true => Remark::DepartureAsShape { percent },
                false => Remark::DepartureAsError { percent },
            });
        }
        if self.place_errors.shown {
            notes.push(Remark::PlacesErr { sd: self.place_errors.across.sqrt() * self.patch.frame.scale });
        }
        let is_unexplained = misfit.percent_of_relief > 100.0 * tuning.unexplained_of_relief;
        if is_unexplained && misfit.p < tuning.pattern_by_chance {
            notes.push(if class == ShapeClass::Plane { Remark::MisfitOfPlane } else { Remark::MisfitOfShape });
        }
        notes
    }
}

/// Radii of dome and trough, the smaller first.
fn radii(class: ShapeClass, k1: f64, k2: f64) -> Option<[f64; 2]> {
    let (large, small) = (k1.abs().max(k2.abs()), k1.abs().min(k2.abs()));
    matches!(class, ShapeClass::Dome | ShapeClass::Trough).then(|| [1.0 / large, 1.0 / small])
}
