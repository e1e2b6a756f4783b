//! The contacts that the configurations are fitted to: replicates of the scene, with as many stations as asked for.
//!
//! ```text
//! replicate b of stations n  =  simulate(world with n stations between the same ends, seed, b)
//! ```
//!
//! A scene in which nothing is random has one replicate. How many stations there are is varied only where they are evenly
//! spaced in a single sweep: elsewhere their places mean something.

use palpate_geometry::contact::Contacts;
use palpate_world::scene::{SceneError, Simulator, SweepPath, Truth, World, linspace};

/// Replicates of a noisy scene: enough for the largest but one to be above 95 % of fresh ones with 95 % confidence (93),
/// and few enough that they fit into a processor's memory close by.
pub const REPLICATES: u64 = 96;
/// Stations are tried in these multiples of the scene's own.
const MULTIPLES: [f64; 2] = [0.5, 2.0];
/// Fewer stations show no curvature along the finger.
const LEAST_STATIONS: usize = 3;
/// Most contacts for which more stations are tried: beyond, a fit takes milliseconds and noise is seldom what limits it.
const MANY_CONTACTS: usize = 2_000;

/// Contacts of every replicate with what is true of them.
#[derive(Debug)]
pub(super) struct Touches {
    /// Stations of each finger; `None` as in the scene.
    pub stations: Option<usize>,
    /// Replicate by replicate.
    pub replicates: Vec<(Contacts, Truth)>,
}

/// Numbers of stations to be tried: the scene's own first, as `None`.
pub(super) fn stations(world: &World) -> Vec<Option<usize>> {
    let mut found = vec![None];
    if let [sweep] = &world.sweeps[..]
        && sweep.path == SweepPath::Down
        && is_even(&sweep.stations)
    {
        let own = sweep.stations.len();
        let contacts = own * sweep.fingers.len() * sweep.repeats;
        let counts = MULTIPLES.iter().map(|multiple| (own as f64 * multiple).round() as usize);
        let sound = |count: &usize| *count >= LEAST_STATIONS && (*count < own || contacts <= MANY_CONTACTS);
        found.extend(counts.filter(sound).map(Some));
    }
    found
}

fn is_even(stations: &[f64]) -> bool {
    let [first, .., last] = stations[..] else { return false };
    let even = linspace(first, last, stations.len());
    let near = 1e-9 * (last - first).abs();
    first < last && stations.iter().zip(&even).all(|(a, b)| (a - b).abs() <= near)
}

/// The same world with this many stations between the same ends.
pub(super) fn with_stations(world: &World, stations: Option<usize>) -> World {
    let mut world = world.clone();
    if let (Some(count), [sweep]) = (stations, &mut world.sweeps[..])
        && let [first, .., last] = sweep.stations[..]
    {
        sweep.stations = linspace(first, last, count);
    }
    world
}

impl Touches {
    /// Simulates the replicates, at most so many.
    ///
    /// # Errors
    /// Every [`SceneError`].
    pub(crate) fn new(world: &World, stations: Option<usize>, seed: u64, most: u64) -> Result<Touches, SceneError> {
        let simulator = with_stations(world, stations).compile()?;
        let count = if is_random(&simulator) { most } else { 1 };
        Ok(Touches { stations, replicates: (0..count).map(|b| simulator.simulate(seed, b)).collect() })
    }

    /// Contacts of the first replicate.
    pub(crate) fn contacts(&self) -> usize {
        self.replicates.first().map_or(0, |(contacts, _)| contacts.len())
    }
}

/// Whether two replicates differ.
pub(super) fn is_random(simulator: &Simulator) -> bool {
    simulator.stages().iter().any(|stage| stage.draws_per_contact() > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_world::scene::{Surface, Sweep};

    fn world(stations: Vec<f64>) -> World {
        let surface = Surface::sphere(10.0);
        let sweeps = vec![Sweep::new(vec![-4.0, 0.0, 4.0], stations)];
        World { surface, sweeps, effects: Vec::new(), laws: Vec::new() }
    }

    #[test]
    fn only_even_stations_are_varied() {
        let even = world(linspace(-4.0, 4.0, 9));
        assert_eq!(stations(&even), [None, Some(5), Some(18)]);
        assert_eq!(stations(&world(vec![-4.0, -3.0, 4.0])), [None]);
        let more = with_stations(&even, Some(18));
        assert_eq!(more.sweeps[0].stations, linspace(-4.0, 4.0, 18));
        let touches = Touches::new(&even, Some(18), 1, 9).unwrap();
        assert_eq!((touches.replicates.len(), touches.contacts()), (1, 54));
    }
}
