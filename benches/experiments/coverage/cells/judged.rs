//! A scene whose intervals are judged: of the family by its name, or a surface drawn at random.

use palpate_app::io::scene_file::{SceneFile, read_scene};
use palpate_laboratory::coverage::{Family, LeastWidth, RandomSurface, noise_of, oracle_sd};

use super::family::coverage_family;

/// A scene, the oracle's standard deviations of S and R there, and the least widths.
pub(crate) struct Judged {
    pub scene: SceneFile,
    /// Seed of its noise.
    pub seed: u64,
    pub oracle: [Option<f64>; 2],
    pub least: LeastWidth,
    pub is_random: bool,
}

impl Judged {
    fn new(scene: SceneFile, seed: u64, family: Option<Family>) -> Judged {
        let places = scene.world.compile().map(|simulator| {
            let contacts = simulator.noise_free();
            contacts.x.iter().zip(&contacts.y).map(|(x, y)| [*x, *y]).collect::<Vec<_>>()
        });
        let noise = noise_of(&scene.world);
        let (oracle, least) = match (family, places) {
            (Some(family), Ok(places)) => (oracle_sd(&family, &places, noise), LeastWidth::of(&family, &places, noise)),
            _ => ([None; 2], LeastWidth::default()),
        };
        Judged { scene, seed, oracle, least, is_random: false }
    }

    /// The scene of the family whose text this is, with the noise of a seed.
    pub(crate) fn of_text(name: &str, text: &str, seed: u64) -> Judged {
        let scene = read_scene(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let surface = scene.world.surface.clone();
        Judged::new(scene, seed, Family::of(&surface))
    }

    /// The random surface of a seed, with noise of its own: that of one seed for all would move all of them the same way. Its
    /// named model is a height field of degree 3 with the noise declared.
    pub(crate) fn random(seed: u64) -> Judged {
        let drawn = RandomSurface::new(seed);
        let [z, normal] = noise_of(&drawn.world).map(|sd| sd.unwrap_or(1.0));
        let text = format!(
            "seed = {seed}\n[surface]\nkind = \"plane\"\n[sweep]\nfingers = [0.0]\nfrom = 0.0\nto = 1.0\nstations = 2\n\
             [fit]\ndegree = 3\nsigma = [{z:?}, {:?}]\n",
            normal.to_degrees()
        );
        let template = read_scene(&text).unwrap_or_else(|error| panic!("{}: {error}", drawn.name));
        let scene = SceneFile { name: drawn.name.clone(), world: drawn.world.clone(), ..template };
        Judged { is_random: true, ..Judged::new(scene, seed, drawn.family()) }
    }
}

/// The scenes of the family whose name holds one of these words; all of them where there are none.
pub(crate) fn of_family(words: &[String], seed: u64) -> impl Iterator<Item = (String, impl FnOnce() -> Judged)> {
    let wanted = move |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
    let chosen: Vec<_> = coverage_family().into_iter().filter(|(name, _)| wanted(name)).collect();
    chosen.into_iter().map(move |(name, text)| (name.clone(), move || Judged::of_text(&name, &text, seed)))
}
