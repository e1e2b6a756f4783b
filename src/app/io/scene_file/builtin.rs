//! The scenes that ship with the crate: files of `src/io/scenes/`, and the paper's families of simulations.
//!
//! The paper's Figures 4 to 6 sweep radius, angle, degree and weights: three families, each listed as one scene, of
//! which every member has a name of its own; one function writes each case as the same TOML a user would. Patch and grid as recovered in the project's notes: fingers at x = -4, 0, 4, nine stations from -4 to
//! 4, a 4 x 4 grid over the whole patch.

use std::borrow::Cow;

use super::section::nearest;
use super::{SceneFile, SceneFileError, read_scene};

/// A scene by name.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltinScene {
    /// What `palpate run NAME` takes.
    pub name: String,
    /// One line on it.
    pub line: String,
    /// The scene as TOML.
    pub toml: Cow<'static, str>,
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../scenes/", $name, ".toml")))),*]
    };
}

/// The default scene first; a file's first line is its listing line.
const FILES: &[(&str, &str)] = files![
    "bar",
    "paper-cylinder",
    "paper-cylinder-position",
    "paper-concave-cylinder",
    "paper-plane",
    "paper-plane-tilted",
    "paper-plane-oblique",
    "paper-table1",
    "paper-table2",
    "poor-normals",
    "around-cylinder",
    "around-torus",
    "parts-box",
    "parts-capsule",
    "parts-cone",
    "parts-mug",
    "parts-pipe",
];

/// Radii of the paper's Figures 5 and 6: the range 5.7 to 1000.
const RADII: [f64; 9] = [5.7, 6.0, 8.0, 10.0, 20.0, 50.0, 100.0, 300.0, 1000.0];

/// The scenes that `palpate scenes` lists, a family by its name; the first is the default of `palpate run`.
pub fn builtin_scenes() -> Vec<BuiltinScene> {
    let mut scenes: Vec<BuiltinScene> = FILES
        .iter()
        .map(|(name, toml)| {
            let line = toml.lines().next().unwrap_or("").trim_start_matches('#').trim();
            BuiltinScene { name: (*name).into(), line: line.into(), toml: Cow::Borrowed(toml) }
        })
        .collect();
    scenes.extend(families());
    scenes
}

/// One scene a family, named as the family is: what `--sweep` starts from.
fn families() -> [BuiltinScene; 3] {
    let family = |name: &str, line: &str, member: BuiltinScene| {
        let toml = member.toml.replace(&member.name, name).replace(&member.line, line);
        BuiltinScene { name: name.into(), line: line.into(), toml: Cow::Owned(toml) }
    };
    [
        family(
            "paper-fig4",
            "Figure 4: cylinders turned, 42 members as paper-fig4-r6-10deg[-position]",
            figure4(10.0, 45, "tangent"),
        ),
        family(
            "paper-fig5",
            "Figure 5: cylinders at 45 degrees, 36 members as paper-fig5-r8-degree4[-position]",
            figure5_6(5, "cylinder", 10.0, 2, "tangent"),
        ),
        family(
            "paper-fig6",
            "Figure 6: spheres, 54 members as paper-fig6-r8-degree3[-position]",
            figure5_6(6, "sphere", 10.0, 2, "tangent"),
        ),
    ]
}

/// The 132 members of the three families.
pub fn family_members() -> Vec<BuiltinScene> {
    let mut scenes = Vec::new();
    for weights in ["tangent", "position"] {
        for radius in [6.0, 10.0, 20.0] {
            for angle in [0, 10, 30, 45, 60, 80, 90] {
                scenes.push(figure4(radius, angle, weights));
            }
        }
    }
    for (figure, kind, degrees) in [(5, "cylinder", &[2, 4][..]), (6, "sphere", &[2, 3, 4])] {
        for weights in ["tangent", "position"] {
            for degree in degrees {
                scenes.extend(RADII.map(|radius| figure5_6(figure, kind, radius, *degree, weights)));
            }
        }
    }
    scenes
}

/// The TOML of a built-in scene, family or member.
pub(crate) fn builtin_text(name: &str) -> Option<Cow<'static, str>> {
    let of = |scenes: Vec<BuiltinScene>| scenes.into_iter().find(|scene| scene.name == name).map(|scene| scene.toml);
    of(builtin_scenes()).or_else(|| if name.starts_with("paper-fig") { of(family_members()) } else { None })
}

/// The scene of this name, read.
///
/// # Errors
/// When there is none: the nearest name. (That each one reads is tested.)
pub fn builtin(name: &str) -> Result<SceneFile, SceneFileError> {
    match builtin_text(name) {
        Some(toml) => read_scene(&toml),
        None => {
            let known: Vec<String> =
                builtin_scenes().into_iter().chain(family_members()).map(|scene| scene.name).collect();
            let nearest = nearest(name, known.iter().map(String::as_str));
            Err(SceneFileError::NoSuchScene { name: name.into(), nearest })
        }
    }
}

fn suffix(weights: &str) -> &'static str {
    if weights == "position" { "-position" } else { "" }
}

fn figure4(radius: f64, angle: i32, weights: &str) -> BuiltinScene {
    let name = format!("paper-fig4-r{radius}-{angle}deg{}", suffix(weights));
    let line = format!("Figure 4: cylinder r = {radius} turned by {angle} degrees, degree 2, {weights} weights");
    let surface = format!("kind = \"cylinder\"\nradius = {radius:?}\naxis_deg = {:?}", f64::from(angle) + 90.0);
    scene(name, line, &surface, 2, weights)
}

fn figure5_6(figure: u32, kind: &str, radius: f64, degree: usize, weights: &str) -> BuiltinScene {
    let name = format!("paper-fig{figure}-r{radius}-degree{degree}{}", suffix(weights));
    let turned = if kind == "cylinder" { " at 45 degrees" } else { "" };
    let line = format!("Figure {figure}: {kind} r = {radius}{turned}, degree {degree}, {weights} weights");
    let axis = if kind == "cylinder" { "\naxis_deg = 135.0" } else { "" };
    scene(name, line, &format!("kind = \"{kind}\"\nradius = {radius:?}{axis}"), degree, weights)
}

fn scene(name: String, line: String, surface: &str, degree: usize, weights: &str) -> BuiltinScene {
    let toml = format!(
        "# {line}\nname = \"{name}\"\n\n[surface]\n{surface}\n\n[sweep]\nfingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\n\
         to = 4.0\nstations = 9\n\n[fit]\ndegree = {degree}\nsegments = 1\nweights = \"{weights}\"\ngrid = [4, 4]\n\
         inset = 0.0\n"
    );
    BuiltinScene { name, line, toml: Cow::Owned(toml) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_reads_simulates_and_has_a_line_of_its_own() {
        let listed = builtin_scenes();
        assert!(listed.len() <= 24, "the list fits on one screen");
        let scenes: Vec<BuiltinScene> = listed.into_iter().chain(family_members()).collect();
        assert_eq!(scenes[0].name, "bar");
        for (i, scene) in scenes.iter().enumerate() {
            assert!(!scene.line.is_empty() && !scene.line.contains('='.to_string().repeat(2).as_str()));
            assert!(scenes[..i].iter().all(|other| other.name != scene.name), "{} twice", scene.name);
            let read = builtin(&scene.name).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
            let simulator = read.world.compile().unwrap();
            let (contacts, truth) = simulator.simulate(read.seed, 0);
            contacts.check().unwrap();
            assert_eq!(contacts.len(), truth.points.len());
        }
    }
}
