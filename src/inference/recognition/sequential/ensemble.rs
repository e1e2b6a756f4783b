//! The drawn surfaces as an ensemble: a column of values each, moved by linear readings of them.
//!
//! ```text
//! column of a draw: S, R, radius, then height and normal over the reported surface at every point of the lattice
//! ```

use std::collections::BTreeMap;

use crate::recognition::region::{CoarseGrid, DrawnLattice, DrawnOffset, normalise};
use crate::recognition::{Hypothesis, Recognition};
use palpate_numeric::vector::{Vector, minus};

/// Values before those of the lattice.
const SHAPE: usize = 3;

/// Values of one point of the lattice.
const OFFSET: usize = 4;

/// Lines of the lattice over a body's map in either direction. A draw beside a whole ball is a cosine of the angle, which cubics over steps of
/// h follow to 3 h^4 / 128: to a hundredth with the eight lines of a map, 45 degrees apart.
const LINES: usize = 12;

/// Draws of a component from which on its own covariances are used, and not those of all components about their own means: a variance of 16
/// draws is known to a third, `sqrt(2 / 15)`.
const OWN_COVARIANCE: usize = 16;

/// Most draws of a body that are kept, of its 400: every third. A patch keeps as large a part of its own.
const OF_BODY: usize = 160;

/// A linear reading of the values, with what a touch measured.
#[derive(Clone, Debug)]
pub(super) struct LinearReading {
    /// Numbers of values and their factors.
    pub(super) of: Vec<(usize, f64)>,
    pub(super) measured: f64,
    pub(super) variance: f64,
}

/// One draw.
#[derive(Clone, Debug)]
pub(super) struct EnsembleDraw {
    pub(super) hypothesis: Hypothesis,
    component: usize,
    /// Its shares in estimates and in intervals.
    pub(super) shares: [f64; 2],
    /// Whether it has a shape index; a plane has none.
    pub(super) is_curved: bool,
    pub(super) has_radius: bool,
    values: Vec<f64>,
}

/// All draws.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnEnsemble {
    lattice: DrawnLattice,
    pub(super) draws: Vec<EnsembleDraw>,
}

/// What the draws of one component say of a reading.
#[derive(Clone, Copy, Default)]
struct Predicted {
    share: f64,
    mean: f64,
    variance: f64,
    draws: usize,
}

impl Predicted {
    /// `ln N(y; mean p, var p + v)`, but for a constant.
    fn log_density(&self, reading: &LinearReading) -> f64 {
        let (off, variance) = (reading.measured - self.mean, self.variance + reading.variance);
        -0.5 * (off * off / variance + variance.ln())
    }
}

impl EnsembleDraw {
    pub(super) fn shape_index(&self) -> Option<f64> {
        self.is_curved.then(|| self.values[0].clamp(-1.0, 1.0))
    }

    pub(super) fn curvedness(&self) -> f64 {
        self.values[1].max(0.0)
    }

    pub(super) fn radius(&self) -> Option<f64> {
        self.has_radius.then_some(self.values[2])
    }

    fn read(&self, reading: &LinearReading) -> f64 {
        reading.of.iter().map(|(number, factor)| factor * self.values[*number]).sum()
    }
}

impl DrawnEnsemble {
    /// The draws of a recognition; empty where it has kept none.
    pub(super) fn of(found: &Recognition) -> DrawnEnsemble {
        let kept = match &found.draws.lattice {
            Some(lattice) => (lattice.clone(), (0..found.draws.shapes.len()).collect()),
            None => over_body(found),
        };
        let (lattice, numbers): (DrawnLattice, Vec<usize>) = kept;
        let one = |(number, offsets): (&usize, &Vec<DrawnOffset>)| {
            let shape = found.draws.shapes[*number];
            let own = [shape.shape_index.unwrap_or(0.0), shape.curvedness, shape.radius.unwrap_or(0.0)];
            EnsembleDraw {
                hypothesis: shape.hypothesis,
                component: shape.component,
                shares: shape.shares,
                is_curved: shape.shape_index.is_some(),
                has_radius: shape.radius.is_some(),
                values: own.into_iter().chain(offsets.iter().flatten().copied()).collect(),
            }
        };
        let draws: Vec<EnsembleDraw> =
            numbers.iter().zip(&lattice.offsets).map(one).filter(|draw| draw.shares[1] > 0.0).collect();
        let mut ensemble = DrawnEnsemble { lattice: DrawnLattice { offsets: Vec::new(), ..lattice }, draws };
        ensemble.normalise();
        ensemble
    }

    pub(super) fn is_empty(&self) -> bool {
        self.draws.is_empty()
    }

    /// The reading of offset `part` (0 the height, 1 to 3 the normal) at a place of the map, times a factor.
    pub(super) fn reading_at(&self, at: [f64; 2], parts: [f64; OFFSET]) -> Vec<(usize, f64)> {
        let points = self.lattice.around(at);
        let of = |(point, share): (usize, f64)| {
            let first = SHAPE + OFFSET * point;
            (0..OFFSET).filter(|part| parts[*part] != 0.0).map(move |part| (first + part, share * parts[part]))
        };
        points.into_iter().filter(|(_, share)| *share != 0.0).flat_map(of).collect()
    }

    /// Mean and variance of a reading over all draws.
    pub(super) fn moments(&self, reading: &LinearReading) -> [f64; 2] {
        let values: Vec<(f64, f64)> = self.draws.iter().map(|draw| (draw.read(reading), draw.shares[1])).collect();
        let mean: f64 = values.iter().map(|(value, share)| share * value).sum();
        [mean, values.iter().map(|(value, share)| share * (value - mean).powi(2)).sum()]
    }

    /// Conditions every draw on a reading.
    pub(super) fn condition(&mut self, reading: &LinearReading) {
        let predictions: Vec<f64> = self.draws.iter().map(|draw| draw.read(reading)).collect();
        let components = self.predicted(&predictions);
        let pooled = self.covariances(&predictions, &components, |_| true);
        // beside the likeliest component, so that not all of them vanish
        let most = components.values().map(|own| own.log_density(reading)).fold(f64::NEG_INFINITY, f64::max);
        for (component, own) in &components {
            let (covariance, variance) = match own.draws >= OWN_COVARIANCE {
                true => self.covariances(&predictions, &components, |other| other == *component),
                false => pooled.clone(),
            };
            let total = variance + reading.variance;
            let reduction = 1.0 / (1.0 + (reading.variance / total).sqrt());
            let off = reading.measured - own.mean;
            for (draw, prediction) in self.draws.iter_mut().zip(&predictions).filter(|(d, _)| d.component == *component)
            {
                let step = (off - reduction * (prediction - own.mean)) / total;
                draw.values.iter_mut().zip(&covariance).for_each(|(value, cov)| *value += cov * step);
                draw.shares.iter_mut().for_each(|share| *share *= (own.log_density(reading) - most).exp());
            }
        }
        // what has no share says nothing any more, and has no mean
        self.draws.retain(|draw| draw.shares[1].is_normal());
        self.normalise();
    }

    /// Moments of predictions within each component.
    fn predicted(&self, predictions: &[f64]) -> BTreeMap<usize, Predicted> {
        let mut components: BTreeMap<usize, Predicted> = BTreeMap::new();
        for (draw, prediction) in self.draws.iter().zip(predictions) {
            let own = components.entry(draw.component).or_default();
            (own.share, own.mean) = (own.share + draw.shares[1], own.mean + draw.shares[1] * prediction);
            own.draws += 1;
        }
        components.values_mut().for_each(|own| own.mean /= own.share);
        for (draw, prediction) in self.draws.iter().zip(predictions) {
            if let Some(own) = components.get_mut(&draw.component) {
                own.variance += draw.shares[1] / own.share * (prediction - own.mean).powi(2);
            }
        }
        components
    }

    /// Covariance of every value with the predictions, and their variance, over the draws of these components about their own means.
    fn covariances(
        &self,
        predictions: &[f64],
        components: &BTreeMap<usize, Predicted>,
        counts: impl Fn(usize) -> bool,
    ) -> (Vec<f64>, f64) {
        let length = self.draws.first().map_or(0, |draw| draw.values.len());
        let (mut covariance, mut variance, mut all) = (vec![0.0; length], 0.0, 0.0);
        for (draw, prediction) in self.draws.iter().zip(predictions).filter(|(d, _)| counts(d.component)) {
            let off = draw.shares[1] * (prediction - components[&draw.component].mean);
            covariance.iter_mut().zip(&draw.values).for_each(|(sum, value)| *sum += off * value);
            variance += off * (prediction - components[&draw.component].mean);
            all += draw.shares[1];
        }
        covariance.iter_mut().for_each(|sum| *sum /= all);
        (covariance, variance / all)
    }

    fn normalise(&mut self) {
        normalise(&mut self.draws.iter_mut().map(|draw| &mut draw.shares).collect::<Vec<&mut [f64; 2]>>());
    }
}

/// Where a body's draws lie over some points of its map, and which of them are kept.
fn over_body(found: &Recognition) -> (DrawnLattice, Vec<usize>) {
    let Some(body) = found.surface.body() else { return (DrawnLattice::default(), Vec::new()) };
    let coarse = CoarseGrid::of(found.grid, LINES);
    let numbers: Vec<usize> = body.some_draws(OF_BODY);
    let mut offsets: Vec<Vec<DrawnOffset>> = vec![Vec::new(); numbers.len()];
    for point in coarse.numbers().into_iter().filter_map(|number| found.map.get(number)) {
        let drawn = body.drawn_at(point.position, &numbers);
        offsets
            .iter_mut()
            .zip(drawn)
            .for_each(|(of, (distance, normal))| of.push(offset(-distance, normal, point.normal)));
    }
    (DrawnLattice { lines: coarse.shares(found.grid), offsets }, numbers)
}

fn offset(height: f64, normal: Vector, reported: Vector) -> DrawnOffset {
    let [x, y, z] = minus(normal, reported);
    [height, x, y, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two components a unit apart, each known to a millionth.
    fn apart() -> DrawnEnsemble {
        let draw = |k: usize| EnsembleDraw {
            hypothesis: Hypothesis::Sphere,
            component: k % 2,
            shares: [0.025; 2],
            is_curved: true,
            has_radius: false,
            values: vec![1.0, 0.1, 0.0, (k % 2) as f64 + 1e-6 * (k as f64).sin()],
        };
        DrawnEnsemble { lattice: DrawnLattice::default(), draws: (0..40).map(draw).collect() }
    }

    fn reading(measured: f64) -> LinearReading {
        LinearReading { of: vec![(SHAPE, 1.0)], measured, variance: 1e-12 }
    }

    #[test]
    fn a_reading_that_no_component_expects_leaves_numbers() {
        let mut ensemble = apart();
        // between both, half a million standard deviations from either
        ensemble.condition(&reading(0.5));
        assert!(!ensemble.is_empty());
        let sum: f64 = ensemble.draws.iter().map(|draw| draw.shares[1]).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn a_component_that_is_ruled_out_goes_and_the_rest_goes_on() {
        let mut ensemble = apart();
        for measured in [0.0, 1e-6, -1e-6] {
            ensemble.condition(&reading(measured));
        }
        assert_eq!(ensemble.draws.len(), 20);
        let [mean, variance] = ensemble.moments(&reading(0.0));
        assert!(mean.abs() < 1e-6 && variance > 0.0 && variance < 1e-12, "{mean} {variance}");
    }
}
