//! One way to fit a scene: surface, degree, segments, weights, and how many stations each finger stops at.
//!
//! ```text
//! candidates = {height} x degrees x segments x weights x stations  +  {parametric} x degrees x stations
//!              +  what is recognised where no model is named, x stations
//! ```

use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, SlopeWeights, SurfaceKind};

/// Degrees across and along the fingers that are tried; beyond 5 the rows of a few dozen contacts determine little more.
const DEGREES: [[usize; 2]; 6] = [[2, 2], [3, 3], [4, 4], [5, 5], [2, 4], [4, 2]];
/// Segments across and along the fingers. Fingers are few and stations many, so that some pairs cut along them alone.
const SEGMENTS: [[usize; 2]; 4] = [[1, 1], [1, 2], [2, 2], [1, 4]];
/// More segments, and the contacts from which on they are tried: some six contacts a segment.
const FINE_SEGMENTS: [([usize; 2], usize); 2] = [([4, 4], 100), ([8, 8], 400)];
/// Weights that are tried besides the scene's own.
const OBJECTIVES: [Objective; 5] = [
    Objective::Slopes(SlopeWeights::Tangent),
    Objective::Slopes(SlopeWeights::Position),
    Objective::Slopes(SlopeWeights::Equal),
    Objective::Slopes(SlopeWeights::Auto),
    Objective::Normals(NormalSigma::Auto),
];
/// Degree and segments of the parametric surfaces that are tried: each takes some hundred times as long as a height field.
const PARAMETRIC: [(usize, [usize; 2]); 2] = [(3, [1, 1]), (3, [2, 2])];

/// Steps of a fit at most: one that needs more takes seconds, of which a frontier has few.
const MOST_STEPS: usize = 300;

/// One way to fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Everything that decides the fit.
    pub options: FitOptions,
    /// Stations of each finger; `None` where the sweep stays as it is.
    pub stations: Option<usize>,
    /// No model is named: the contacts are recognised, as `palpate fit` does it.
    pub recognised: bool,
}

/// What decides how much there is to compute: ways that agree in it take the same time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WorkKind<'a> {
    recognised: bool,
    surface: &'static str,
    degree: [usize; 2],
    segments: [usize; 2],
    stations: Option<usize>,
    /// The weights, but for presets, whose numbers alone differ.
    weights: Option<&'a Objective>,
}

impl Configuration {
    /// The kind of work that it is.
    pub(super) fn work(&self) -> WorkKind<'_> {
        let FitOptions { surface, degree, segments, objective, .. } = &self.options;
        let preset = matches!(objective, Objective::Slopes(weights) if *weights != SlopeWeights::Auto);
        WorkKind {
            recognised: self.recognised,
            surface: surface.name(),
            degree: *degree,
            segments: *segments,
            stations: self.stations,
            weights: (!preset).then_some(objective),
        }
    }

    /// How much has to be named and how much is fitted, the least first: nothing named, a height field, few unknowns.
    pub(super) fn simplicity(&self) -> (bool, bool, usize) {
        let unknowns = |k: usize| self.options.degree[k] + self.options.segments[k];
        let fitted = if self.recognised { 0 } else { unknowns(0) * unknowns(1) };
        (self.stations.is_some(), self.options.surface != SurfaceKind::Height, fitted)
    }

    /// The line by which people tell it from others.
    pub(crate) fn label(&self) -> String {
        let stations = self.stations.map_or(String::new(), |count| format!(", {count} stations"));
        if self.recognised {
            return format!("recognised{stations}");
        }
        let [p, q] = self.options.degree;
        let [n, m] = self.options.segments;
        let degree = if p == q { format!("{p}") } else { format!("{p},{q}") };
        format!("{} degree {degree}, {n}x{m}, {}{stations}", self.options.surface.name(), self.weights())
    }

    /// The weights in the words of a scene.
    pub(crate) fn weights(&self) -> String {
        if self.recognised {
            return "found".into();
        }
        match self.options.objective {
            Objective::Auto => "auto".into(),
            Objective::Slopes(SlopeWeights::Explicit([z, x, y])) => format!("weights {z},{x},{y}"),
            Objective::Slopes(weights) => {
                let known = SlopeWeights::WORDS.iter().find(|(_, known)| *known == weights);
                format!("weights {}", known.map_or("", |(word, _)| word))
            }
            Objective::Normals(NormalSigma::Auto) => "sigma auto".into(),
            Objective::Normals(NormalSigma::Known { z, normal_deg }) => format!("sigma {z},{normal_deg}"),
        }
    }
}

/// Everything that is tried beside the scene's own choice `own`, which comes first. `stations` are the numbers of stations,
/// the scene's own first; `contacts` say how fine a surface may be.
pub(super) fn candidates(
    own: &FitOptions,
    stations: &[Option<usize>],
    normals: bool,
    contacts: usize,
) -> Vec<Configuration> {
    let mut found = Vec::new();
    let mut add = |configuration: Configuration| {
        if !found.contains(&configuration) {
            found.push(configuration);
        }
    };
    let with = |degree: [usize; 2], segments: [usize; 2], objective: Objective| {
        let options = FitOptions {
            surface: SurfaceKind::Height,
            closed: [false; 2],
            degree,
            segments,
            knots: None,
            objective,
            ..own.clone()
        };
        let steps = if options == *own { own.steps } else { own.steps.min(MOST_STEPS) };
        FitOptions { steps, ..options }
    };
    for count in stations {
        add(Configuration { options: own.clone(), stations: *count, recognised: false });
    }
    for count in stations {
        add(Configuration { options: unnamed(own), stations: *count, recognised: true });
    }
    let objectives = OBJECTIVES.iter().filter(|objective| normals || !matches!(objective, Objective::Normals(_)));
    let objectives: Vec<Objective> = objectives.chain([&own.objective]).copied().collect();
    let fine = FINE_SEGMENTS.iter().filter(|(_, least)| contacts >= *least).map(|(segments, _)| *segments);
    let all_segments: Vec<[usize; 2]> = SEGMENTS.into_iter().chain(fine).collect();
    for count in stations {
        for degree in DEGREES {
            for segments in all_segments.iter().copied() {
                for objective in &objectives {
                    let options = with(degree, segments, *objective);
                    add(Configuration { options, stations: *count, recognised: false });
                }
            }
        }
    }
    for (degree, segments) in PARAMETRIC.into_iter().filter(|_| normals) {
        let objective = Objective::Normals(NormalSigma::Auto);
        let options = FitOptions { surface: SurfaceKind::Parametric, ..with([degree; 2], segments, objective) };
        add(Configuration { options, stations: stations.first().copied().flatten(), recognised: false });
    }
    found
}

/// Options that name no model: what says where S and R are wanted, and how sure.
fn unnamed(own: &FitOptions) -> FitOptions {
    FitOptions { grid: own.grid, level: own.level, sigma_xy: own.sigma_xy, ..FitOptions::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_candidate_is_there_once_and_the_scenes_own_first() {
        let own = FitOptions { objective: Objective::Slopes(SlopeWeights::Tangent), ..FitOptions::default() };
        let found = candidates(&own, &[None, Some(12)], true, 36);
        assert_eq!(found[0], Configuration { options: own.clone(), stations: None, recognised: false });
        assert_eq!(found.len(), 6 * 4 * 5 * 2 + 2 + 2);
        assert_eq!(candidates(&own, &[None], true, 400).len(), 6 * 6 * 5 + 1 + 2);
        let mut labels: Vec<String> = found.iter().map(Configuration::label).collect();
        labels.sort();
        labels.dedup();
        assert_eq!(labels.len(), found.len());
    }

    #[test]
    fn labels_say_what_is_fitted() {
        let options = FitOptions { degree: [3, 2], segments: [1, 4], ..FitOptions::default() };
        let one = Configuration { options, stations: Some(9), recognised: false };
        assert_eq!(one.label(), "height degree 3,2, 1x4, auto, 9 stations");
        assert_eq!(Configuration { recognised: true, ..one }.label(), "recognised, 9 stations");
    }

    #[test]
    fn presets_are_the_same_work_and_what_is_iterated_is_another() {
        let with = |objective| Configuration {
            options: FitOptions { objective, ..FitOptions::default() },
            stations: None,
            recognised: false,
        };
        let [equal, tangent, auto] = [SlopeWeights::Equal, SlopeWeights::Tangent, SlopeWeights::Auto]
            .map(|weights| with(Objective::Slopes(weights)));
        assert!(equal.work() == tangent.work() && equal.work() != auto.work());
    }
}
