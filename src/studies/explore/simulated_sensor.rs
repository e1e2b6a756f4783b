//! The hand in a simulated world: where it can touch, and what it feels there.
//!
//! ```text
//! contacts so far = World { surface, sweeps of the scene + one sweep for every touch, effects }(seed)
//! ```
//!
//! Every touch is added to the world as a sweep of one station, and the world is simulated again. Random numbers belong to
//! the number of a contact, so the contacts that were made before stay as they were. A touch counts as a finger of its own
//! for effects that belong to fingers.

use palpate_geometry::contact::Contacts;
use palpate_world::scene::{SceneError, Sweep, SweepPath, Truth, World, linspace};

use super::ExploreError;

/// Places each way at which a touch may be made. A denser lattice hardly changes the choice: between neighbours the
/// criterion differs by a few per cent.
const PLACES: usize = 21;

/// A world that is touched more and more.
#[derive(Clone, Debug)]
pub struct Hand {
    world: World,
    seed: u64,
    first: Sweep,
    /// Contacts that the scene's own sweeps make.
    pub swept: usize,
    /// Touches made since.
    pub touches: Vec<[f64; 2]>,
    /// Where the next touches may be made, fingers outside, stations inside; those off the surface are left out.
    pub candidates: Vec<[f64; 2]>,
    /// The place of each candidate in the lattice, finger and station.
    pub(super) lattice: Vec<[u32; 2]>,
}

impl Hand {
    /// The world with its candidates: a lattice over the rectangle of the first sweep, or over `reach` (`[x0, x1, y0, y1]`).
    ///
    /// # Errors
    /// A world that cannot be touched from above, or nowhere in the reach.
    pub fn new(world: &World, seed: u64, reach: Option<[f64; 4]>) -> Result<Hand, ExploreError> {
        if world.sweeps.iter().any(|sweep| sweep.path != SweepPath::Down) {
            return Err(ExploreError::Around);
        }
        let simulator = world.compile()?;
        let swept = simulator.sites().len();
        let area = area(&world.sweeps[0], reach, swept)?;
        let tried = World { sweeps: vec![area.clone()], effects: Vec::new(), laws: Vec::new(), ..world.clone() };
        let places = match tried.compile() {
            Ok(simulator) => simulator.sites(),
            Err(SceneError::Unreachable { .. }) => Vec::new(),
            Err(error) => return Err(error.into()),
        };
        if places.is_empty() {
            let why = format!("the surface lies under none of the {PLACES} x {PLACES} places of the reach");
            return Err(ExploreError::NoCandidate { why });
        }
        let candidates = places.iter().map(|site| site.aim).collect();
        let lattice = places.iter().map(|site| [site.finger, site.station]).collect();
        Ok(Hand { world: world.clone(), seed, first: area, swept, touches: Vec::new(), candidates, lattice })
    }

    /// Contacts and truth of the scene's sweeps and all touches so far.
    ///
    /// # Errors
    /// A touch that misses the surface.
    pub fn feel(&self) -> Result<(Contacts, Truth), ExploreError> {
        let mut world = self.world.clone();
        world.sweeps.extend(self.touches.iter().map(|place| single(&self.first, *place)));
        Ok(world.compile()?.into_contacts(self.seed, 0))
    }

    /// Where the scene's own sweeps touch.
    pub(super) fn sites(&self) -> Result<Vec<[f64; 2]>, ExploreError> {
        Ok(self.world.compile()?.sites().iter().map(|site| site.aim).collect())
    }

    /// Whether a place lies in the reach and on the surface.
    pub(super) fn can_touch(&self, place: [f64; 2]) -> bool {
        let world = World {
            sweeps: vec![single(&self.first, place)],
            effects: Vec::new(),
            laws: Vec::new(),
            ..self.world.clone()
        };
        self.inside(place) && world.compile().is_ok()
    }

    /// Middle of the reach.
    pub(super) fn middle(&self) -> [f64; 2] {
        let [f, s] = [&self.first.fingers, &self.first.stations].map(|list| 0.5 * (list[0] + list[list.len() - 1]));
        let (sin, cos) = self.first.angle_deg.to_radians().sin_cos();
        [self.first.centre[0] + f * cos - s * sin, self.first.centre[1] + f * sin + s * cos]
    }

    /// Length of the reach's diagonal.
    pub(super) fn diagonal(&self) -> f64 {
        let [f, s] = [&self.first.fingers, &self.first.stations].map(|list| list[list.len() - 1] - list[0]);
        f.hypot(s)
    }

    fn inside(&self, [x, y]: [f64; 2]) -> bool {
        let (sin, cos) = self.first.angle_deg.to_radians().sin_cos();
        let [dx, dy] = [x - self.first.centre[0], y - self.first.centre[1]];
        let own = [dx * cos + dy * sin, -dx * sin + dy * cos];
        let slack = 1e-9 * self.diagonal();
        [&self.first.fingers, &self.first.stations]
            .into_iter()
            .zip(own)
            .all(|(list, v)| (list[0] - slack..=list[list.len() - 1] + slack).contains(&v))
    }
}

/// The lattice of candidates, written as a sweep.
fn area(sweep: &Sweep, reach: Option<[f64; 4]>, contacts: usize) -> Result<Sweep, ExploreError> {
    let extent =
        |list: &[f64]| list.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(*v), hi.max(*v)]);
    let lattice = |fingers: [f64; 2], stations: [f64; 2]| {
        let [fingers, stations] = [fingers, stations].map(|[lo, hi]| linspace(lo, hi, PLACES));
        Sweep { repeats: 1, skip_unreachable: true, fingers, stations, ..sweep.clone() }
    };
    if let Some([x0, x1, y0, y1]) = reach {
        return Ok(Sweep { angle_deg: 0.0, centre: [0.0; 2], ..lattice([x0, x1], [y0, y1]) });
    }
    let [fingers, stations] = [extent(&sweep.fingers), extent(&sweep.stations)];
    let (across, along) = (fingers[1] - fingers[0], stations[1] - stations[0]);
    if !(across > 0.0 && along > 0.0) {
        return Err(ExploreError::NoPatch { contacts, along, across });
    }
    Ok(lattice(fingers, stations))
}

/// One touch as a sweep with the scene's own tip.
fn single(like: &Sweep, [x, y]: [f64; 2]) -> Sweep {
    Sweep {
        fingers: vec![x],
        stations: vec![y],
        repeats: 1,
        angle_deg: 0.0,
        centre: [0.0; 2],
        skip_unreachable: false,
        ..like.clone()
    }
}
