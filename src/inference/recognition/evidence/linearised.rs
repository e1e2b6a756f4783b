//! Everything that the evidence is computed from, linearised about fitted models.
//!
//! ```text
//! models, displacement -> rows y, J, Z        covariance of normals        whitened normals' Gram matrix
//! ```

use faer::Mat;

use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use crate::recognition::discrepancy::{DepartureResolution, Displacement, Forms};
use crate::recognition::equations::{Moved, Rows, first_of_displacement};
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::noise::{Factors, Gain, NormalNoise, Tilt};
use palpate_numeric::vector::Vector;

/// Factors of the covariances of positions and of normals.
pub(crate) struct FactorPair<'a> {
    pub(crate) positions: Factors<'a>,
    /// `None` where every cell has as many normals as positions: one factor then serves both.
    normals: Option<Factors<'a>>,
}

impl<'a> FactorPair<'a> {
    pub(crate) fn new(cells: &'a Cells, distances: &'a Mat<f64>) -> FactorPair<'a> {
        let own = cells.normals.as_ref().filter(|normals| normals.variance != cells.variance);
        FactorPair {
            positions: Factors::new(&cells.variance, distances, cells.floors),
            normals: own.map(|normals| Factors::new(&normals.variance, distances, cells.floors)),
        }
    }

    fn normals(&self) -> &Factors<'a> {
        self.normals.as_ref().unwrap_or(&self.positions)
    }
}

/// What normals tell of the models without a departure.
pub(super) struct NormalsTold {
    pub(super) noise: Option<NormalNoise>,
    /// Gram matrix of the whitened normal rows.
    pub(super) gram: Option<Mat<f64>>,
}

/// Models with their equations.
#[derive(Clone)]
pub(crate) struct Linearised {
    pub(crate) models: Vec<Model>,
    pub(super) displacement: Option<Displacement>,
    /// How finely it may vary.
    pub(super) resolution: DepartureResolution,
    /// Prior standard deviation of natural departures, in natural sizes.
    pub(super) natural_sizes: f64,
    pub(crate) rows: Rows,
    pub(crate) normal_noise: Option<NormalNoise>,
    /// Gram matrix of the whitened normal rows.
    pub(crate) normals: Option<Mat<f64>>,
    /// Where all normals may be turned by one angle.
    pub(crate) tilt: Option<Tilt>,
    /// Where all normals may be too steep by one factor.
    pub(crate) gain: Option<Gain>,
    /// Where departures stand over a plane instead of a curved surface: what its longer rows add to the log evidence.
    pub(crate) over_plane: Option<f64>,
}

impl Linearised {
    /// Equations about these models.
    pub(crate) fn new(
        cells: &Cells,
        contacts: &[Vector],
        models: Vec<Model>,
        factors: &FactorPair,
        tuning: &Tuning,
    ) -> Linearised {
        let (resolution, natural_sizes) = (DepartureResolution::default(), tuning.natural_departure);
        let displacement = displacement_of(&models, cells, contacts, &Forms::default(), (resolution, natural_sizes));
        let rows = Rows::new(cells, &models, displacement.as_ref());
        let noise = NormalNoise::find(&rows, factors.normals(), 0.0);
        let mut made = Linearised {
            models,
            displacement,
            resolution,
            natural_sizes,
            rows,
            normal_noise: None,
            normals: None,
            tilt: None,
            gain: None,
            over_plane: None,
        };
        made.weigh_normals(noise, factors);
        made
    }

    /// The same equations where all normals may be too steep by one factor; `None` without normals.
    pub(super) fn with_gain(&self, cells: &Cells, factors: &FactorPair, tuning: &Tuning) -> Option<Linearised> {
        let gain = Some(Gain::new(cells, &self.models, None, tuning)?);
        Some(Linearised { gain, ..self.clone() }.with_normals_asked(factors))
    }

    /// The same equations where all normals may be turned by one angle; `None` where they cannot.
    pub(super) fn with_tilt(&self, cells: &Cells, factors: &FactorPair, tuning: &Tuning) -> Option<Linearised> {
        let tilt = Some(Tilt::new(cells, tuning)?);
        Some(Linearised { tilt, ..self.clone() }.with_normals_asked(factors))
    }

    /// With errors of the normals as the models without a departure say.
    fn with_normals_asked(mut self, factors: &FactorPair) -> Linearised {
        self.weigh_normals(NormalNoise::find(&self.rows, factors.normals(), 0.0), factors);
        self
    }

    /// What the normals tell of the models without a departure.
    pub(super) fn told(&self) -> NormalsTold {
        let n = first_of_displacement();
        let own = |gram: &Mat<f64>| gram.as_ref().submatrix(0, 0, n, n).to_owned();
        NormalsTold { noise: self.normal_noise, gram: self.normals.as_ref().map(own) }
    }

    /// The same where all normals may be too steep by one factor; `None` where they cannot.
    pub(super) fn told_with_gain(&self, cells: &Cells, factors: &FactorPair, tuning: &Tuning) -> Option<NormalsTold> {
        let gain = Gain::new(cells, &self.models, None, tuning)?;
        Some(self.told_with(self.tilt.clone(), Some(gain), factors))
    }

    /// The same where all normals may be turned by one angle; `None` where they cannot.
    pub(super) fn told_with_tilt(&self, cells: &Cells, factors: &FactorPair, tuning: &Tuning) -> Option<NormalsTold> {
        Some(self.told_with(Some(Tilt::new(cells, tuning)?), None, factors))
    }

    fn told_with(&self, mut tilt: Option<Tilt>, mut gain: Option<Gain>, factors: &FactorPair) -> NormalsTold {
        let mut noise = NormalNoise::find(&self.rows, factors.normals(), 0.0);
        let of_models = self.rows.of_models();
        let gram = |noise: &mut NormalNoise| noise.gram(&of_models, factors.normals(), tilt.as_mut(), gain.as_mut());
        NormalsTold { gram: noise.as_mut().and_then(gram), noise }
    }

    /// The same equations, with a gain about the general surface under a displacement of these slopes, and errors of the normals as they
    /// were without it.
    pub(super) fn with_gain_about(
        &self,
        slopes: Option<&[Vec<f64>; 2]>,
        cells: &Cells,
        factors: &FactorPair,
        tuning: &Tuning,
    ) -> Option<Linearised> {
        let gain = Some(Gain::new(cells, &self.models, slopes, tuning)?);
        let mut made = Linearised { gain, ..self.clone() };
        made.weigh_normals(self.normal_noise, factors);
        Some(made)
    }

    /// Lets the normals have errors of this covariance, and a gain.
    fn weigh_normals(&mut self, noise: Option<NormalNoise>, factors: &FactorPair) {
        self.normal_noise = noise;
        let (gain, tilt) = (self.gain.as_mut(), self.tilt.as_mut());
        let gram = |noise: &mut NormalNoise| noise.gram(&self.rows, factors.normals(), tilt, gain);
        self.normals = self.normal_noise.as_mut().and_then(gram);
    }

    /// The same equations with normals that err independently, by as much as differences between neighbours say; `None` where
    /// neighbours do not share errors anyway.
    pub(super) fn with_normals_believed(&self, factors: &FactorPair) -> Option<Linearised> {
        self.normal_noise.filter(NormalNoise::is_shared)?;
        let mut made = self.clone();
        made.weigh_normals(NormalNoise::of_differences(&self.rows, factors.normals()), factors);
        Some(made)
    }

    /// What the errors of the normals add to the log evidence of every hypothesis, and what rows over a plane do.
    pub(super) fn log_share(&self) -> f64 {
        self.normal_noise.map_or(0.0, |noise| noise.log_share) + self.over_plane.unwrap_or(0.0)
    }

    /// Equations about the moved models, with normals that scatter about the displacement which moved them; `None` where the moved
    /// surface has no chart that a displacement could stand on.
    pub(crate) fn about(
        &self,
        moved: &Moved,
        cells: &Cells,
        contacts: &[Vector],
        factors: &FactorPair,
    ) -> Option<Linearised> {
        let models = self.models_with(moved);
        let prior = (self.resolution, self.natural_sizes);
        let displacement = displacement_of(&models, cells, contacts, &moved.forms, prior)?;
        let mut rows = Rows::new(cells, &models, Some(&displacement));
        moved.average(&mut rows, cells, contacts);
        moved.lengthen(&mut rows, cells);
        let over_plane = moved.base.is_flat().then_some(0.0);
        if over_plane.is_some() {
            rows.bend_by(&displacement.quadratic);
        }
        let (displacement, gain) = (Some(displacement), self.gain.clone());
        let mut made = Linearised {
            models,
            displacement,
            resolution: self.resolution,
            natural_sizes: self.natural_sizes,
            rows,
            normal_noise: None,
            normals: None,
            tilt: self.tilt.clone(),
            gain,
            over_plane,
        };
        made.scatter_about(moved, cells, factors);
        Some(made)
    }

    /// Lets the normals scatter about this displacement.
    pub(super) fn scatter_about(&mut self, moved: &Moved, cells: &Cells, factors: &FactorPair) {
        self.gain = self.gain.as_ref().and_then(|gain| gain.about(cells, &self.models, moved.slopes.as_ref()));
        let noise = NormalNoise::find(&moved.without_displacement(&self.rows), factors.normals(), moved.spent);
        self.weigh_normals(noise, factors);
    }

    /// The models, the general one in its new place.
    fn models_with(&self, moved: &Moved) -> Vec<Model> {
        let of = |m: &Model| if m.kind() == Kind::General { moved.base.clone() } else { m.clone() };
        self.models.iter().map(of).collect()
    }
}

/// The displacement about the general surface, where the data and its chart allow one.
fn displacement_of(
    models: &[Model],
    cells: &Cells,
    contacts: &[Vector],
    forms: &Forms,
    prior: (DepartureResolution, f64),
) -> Option<Displacement> {
    match models.iter().find(|m| m.kind() == Kind::General) {
        Some(Model::Constant(_, surface)) => Displacement::new(surface, cells, contacts, forms, prior),
        _ => None,
    }
}
