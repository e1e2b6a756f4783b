//! A checked world, compiled to the list of stages it names, and the contacts it makes.
//!
//! ```text
//! contacts(seed, replicate) = stage_k( ... stage_1(touched points) ... )
//! ```
//!
//! The touched points are found once. A replicate copies them and lets every stage change the copy; a scene without
//! effects has no stages. Replicates are made one at a time or as a [`ContactBatch`], with the same bits.

use super::batch::ContactBatch;
use super::effects::{Context, Kind, Stage};
use super::surface::{Surface, SurfacePoint};
use super::sweep::{Site, Sweep, SweepPath, Touched};
use super::truth::Truth;
use super::{SceneError, World};
use palpate_geometry::contact::Contacts;
use palpate_numeric::draws::{EffectDraws, NoiseLaw};

/// A world ready to be simulated: everything is checked, the touched points are found, the stages are prepared.
#[derive(Debug)]
pub struct Simulator {
    surface: Surface,
    sweeps: Vec<Sweep>,
    touched: Touched,
    stages: Vec<Box<dyn Stage>>,
    /// The law of each stage's errors.
    laws: Vec<NoiseLaw>,
}

impl World {
    /// Checks the whole world and prepares what it names; nothing is drawn.
    ///
    /// # Errors
    /// Whatever cannot be, with the numbers that clash.
    pub fn compile(&self) -> Result<Simulator, SceneError> {
        self.surface.check()?;
        if self.sweeps.is_empty() {
            return Err(SceneError::List { key: "sweep".into(), expected: "a scene needs a sweep" });
        }
        let mut touched = Touched::default();
        let mut fingers = 0;
        for sweep in &self.sweeps {
            sweep.touch(&self.surface, fingers, &mut touched)?;
            fingers += sweep.fingers.len().max(1) as u32;
        }
        // only an effect asks where a tip came from; a scene without one does not pay for the answer
        let sites = if self.effects.is_empty() { Vec::new() } else { sites(&self.sweeps, &touched) };
        let stages = self.prepare(&sites)?;
        let laws = self.laws_of(&stages)?;
        Ok(Simulator { surface: self.surface.clone(), sweeps: self.sweeps.clone(), touched, stages, laws })
    }

    fn laws_of(&self, stages: &[Box<dyn Stage>]) -> Result<Vec<NoiseLaw>, SceneError> {
        let mut laws = vec![NoiseLaw::Normal; stages.len()];
        for (name, law) in &self.laws {
            let clash = |why: &str| SceneError::Clash {
                first: format!("effects.{name}.distribution = {law}"),
                second: format!("effects.{name}"),
                why: why.into(),
            };
            if !law.is_sound() {
                return Err(clash("more than 2 degrees of freedom are needed for an sd"));
            }
            if !self.effects.iter().any(|effect| effect.name() == *name) {
                return Err(clash("that effect is not in the scene"));
            }
            let Some(k) = stages.iter().position(|stage| stage.name() == *name) else { continue };
            if *law != NoiseLaw::Normal && stages[k].draws_per_contact() == 0 {
                return Err(clash("that effect has nothing random"));
            }
            if *law != NoiseLaw::Normal && stages[k].jumps() {
                return Err(clash("what happens with a probability has no shape"));
            }
            laws[k] = *law;
        }
        Ok(laws)
    }

    fn prepare(&self, sites: &[Site]) -> Result<Vec<Box<dyn Stage>>, SceneError> {
        let mut effects: Vec<_> = self.effects.iter().collect();
        effects.iter().try_for_each(|effect| effect.check_settings())?;
        effects.sort_by_key(|effect| effect.order());
        if let Some(twice) = effects.windows(2).find(|pair| pair[0].order() == pair[1].order()) {
            return Err(SceneError::Twice { effect: twice[0].name() });
        }
        let tip_radius = self.sweeps[0].tip_radius;
        if let Some(other) = self.sweeps.iter().find(|sweep| sweep.tip_radius != tip_radius) {
            return Err(SceneError::Clash {
                first: format!("sweep.tip_radius = {tip_radius}"),
                second: format!("sweep.second.tip_radius = {}", other.tip_radius),
                why: "both sweeps are made with the same hand".into(),
            });
        }
        if let Some(effect) = effects.iter().find(|effect| !effect.goes_around())
            && let Some(sweep) = self.sweeps.iter().find(|sweep| sweep.path != SweepPath::Down)
        {
            return Err(SceneError::Clash {
                first: format!("sweep.path = \"{}\"", if sweep.path == SweepPath::Scan { "scan" } else { "around" }),
                second: format!("effects.{}", effect.name()),
                why: "that effect belongs to fingers that come down from above".into(),
            });
        }
        let mut context =
            Context { sites, surface: &self.surface, tip_radius, believed_radius: tip_radius, load: None };
        for effect in &effects {
            match &effect.kind {
                Kind::TipRadiusError(calibration) => context.believed_radius += calibration.error,
                Kind::Indentation(indentation) => context.load = Some(indentation.threshold),
                _ => {}
            }
        }
        let mut stages = Vec::new();
        for effect in effects {
            stages.extend(effect.prepare(&context)?);
        }
        Ok(stages)
    }
}

impl Simulator {
    /// Contacts of one replicate with the truth behind them, finger by finger.
    ///
    /// Lost readings are left out of both.
    pub fn simulate(&self, seed: u64, replicate: u64) -> (Contacts, Truth) {
        if self.stages.is_empty() {
            return (self.noise_free(), self.truth());
        }
        let mut batch = ContactBatch::default();
        self.simulate_batch(seed, replicate, 1, &mut batch);
        self.contacts_of(&batch, 0)
    }

    /// As [`Simulator::simulate`], for a caller who wants one replicate only: the touched points become the truth instead
    /// of being copied, so a scene without effects costs no more than finding its points.
    pub fn into_contacts(self, seed: u64, replicate: u64) -> (Contacts, Truth) {
        if !self.stages.is_empty() {
            return self.simulate(seed, replicate);
        }
        let columns = columns(&self.touched.points);
        let contacts = labelled(columns, self.touched.fingers, self.touched.stations);
        (contacts, Truth::new(self.touched.points, self.surface))
    }

    /// Replicates `first .. first + replicates` at once, into a batch whose memory is used again.
    pub fn simulate_batch(&self, seed: u64, first_replicate: u64, replicates: usize, batch: &mut ContactBatch) {
        self.simulate_batch_from(&|stage| self.draws(stage, seed), first_replicate, replicates, batch);
    }

    /// The same with each stage's random numbers from wherever `draws(stage)` says.
    pub fn simulate_batch_from(
        &self,
        draws: &dyn Fn(usize) -> EffectDraws,
        first_replicate: u64,
        replicates: usize,
        batch: &mut ContactBatch,
    ) {
        self.unchanged_batch(first_replicate, replicates, batch);
        for (number, stage) in self.stages.iter().enumerate() {
            stage.apply(batch, &draws(number));
        }
    }

    /// The addressed random numbers of one stage, under its law.
    ///
    /// # Panics
    /// When there is no stage of this number.
    pub fn draws(&self, stage: usize, seed: u64) -> EffectDraws {
        EffectDraws::new(seed, self.stages[stage].draws_name()).with_law(self.laws[stage])
    }

    /// The law of each stage's errors, in the order they are applied.
    pub fn laws(&self) -> &[NoiseLaw] {
        &self.laws
    }

    /// The same with an effect of the caller's own behind all others.
    pub fn with_stage(mut self, stage: impl Stage + 'static) -> Simulator {
        self.stages.push(Box::new(stage));
        self.laws.push(NoiseLaw::Normal);
        self
    }

    /// The same replicates before any stage, for a caller who runs stages one by one.
    pub fn unchanged_batch(&self, first_replicate: u64, replicates: usize, batch: &mut ContactBatch) {
        batch.start(&self.touched.points, first_replicate, replicates);
    }

    /// The contacts and truth of one replicate of a batch, the replicate being counted from 0 in the batch.
    ///
    /// # Panics
    /// When the batch does not hold `replicate`.
    pub fn contacts_of(&self, batch: &ContactBatch, replicate: usize) -> (Contacts, Truth) {
        let replicates = batch.replicates();
        assert!(replicate < replicates, "replicate {replicate} of a batch that holds {replicates}");
        let touched = &self.touched;
        let kept: Vec<usize> =
            (0..touched.points.len()).filter(|contact| !batch.is_lost(*contact, replicate)).collect();
        let column = |values: &[[f64; 3]], axis: usize| -> Vec<f64> {
            kept.iter().map(|contact| values[contact * replicates + replicate][axis]).collect()
        };
        let axes = [0, 1, 2];
        let [x, y, z] = axes.map(|axis| column(&batch.points, axis));
        let [nx, ny, nz] = axes.map(|axis| column(&batch.normals, axis));
        let label = |labels: &[u32]| kept.iter().map(|contact| labels[*contact]).collect();
        let contacts = labelled([x, y, z, nx, ny, nz], label(&touched.fingers), label(&touched.stations));
        let points = kept.iter().map(|contact| touched.points[*contact]).collect();
        (contacts, Truth::new(points, self.surface.clone()))
    }

    /// The contacts without any effect.
    pub fn noise_free(&self) -> Contacts {
        labelled(columns(&self.touched.points), self.touched.fingers.clone(), self.touched.stations.clone())
    }

    /// The truth of all nominal contacts.
    pub fn truth(&self) -> Truth {
        Truth::new(self.touched.points.clone(), self.surface.clone())
    }

    /// The touches to be made.
    #[doc(hidden)]
    pub fn sites(&self) -> Vec<Site> {
        sites(&self.sweeps, &self.touched)
    }

    /// `[x0, x1, y0, y1]` of the noise-free contacts: the domain that a study fixes.
    pub fn patch(&self) -> [f64; 4] {
        let mut patch = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for touch in &self.touched.points {
            let [x, y, _] = touch.point;
            patch = [patch[0].min(x), patch[1].max(x), patch[2].min(y), patch[3].max(y)];
        }
        patch
    }

    /// Whether no stage moves x or y. Then every replicate has the same sites, and a study can keep its factor.
    pub fn keeps_sites(&self) -> bool {
        self.stages.iter().all(|stage| stage.keeps_sites())
    }

    /// Names of the stages that are compiled in, in the order they are applied.
    pub fn stage_names(&self) -> Vec<&'static str> {
        self.stages.iter().map(|stage| stage.name()).collect()
    }

    /// Sites within reach, and sites asked for.
    pub fn reach(&self) -> (usize, usize) {
        (self.touched.reachable, self.touched.total)
    }

    /// The stages that are compiled in, in the order they are applied.
    pub fn stages(&self) -> &[Box<dyn Stage>] {
        &self.stages
    }
}

/// Every touch with its aim, sweep by sweep.
fn sites(sweeps: &[Sweep], touched: &Touched) -> Vec<Site> {
    let mut first_of = Vec::new();
    for (sweep, fingers) in sweeps.iter().enumerate() {
        let first = first_of.len() as u32;
        first_of.extend(std::iter::repeat_n((sweep, first), fingers.fingers.len().max(1)));
    }
    let labels = touched.fingers.iter().zip(&touched.stations);
    let site = |((finger, station), touch): ((&u32, &u32), &SurfacePoint)| {
        let (sweep, first) = first_of[*finger as usize];
        sweeps[sweep].site(first, *finger, *station, *touch)
    };
    labels.zip(&touched.points).map(site).collect()
}

/// Touched points as columns x, y, z, nx, ny, nz.
fn columns(touched: &[SurfacePoint]) -> [Vec<f64>; 6] {
    let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; touched.len()]);
    let [x, y, z, nx, ny, nz] = &mut columns;
    // one pass: the points are read from memory once
    let points = x.iter_mut().zip(y).zip(z).zip(nx).zip(ny).zip(nz);
    for (touch, (((((x, y), z), nx), ny), nz)) in touched.iter().zip(points) {
        [*x, *y, *z] = touch.point;
        [*nx, *ny, *nz] = touch.local.normal;
    }
    columns
}

fn labelled([x, y, z, nx, ny, nz]: [Vec<f64>; 6], fingers: Vec<u32>, stations: Vec<u32>) -> Contacts {
    let mut contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, nz);
    contacts.finger = Some(fingers);
    contacts.station = Some(stations);
    contacts
}
