//! The scenes on which intervals are judged: eight surfaces, each with four pairs of contacts and noise.
//!
//! Half of them have little noise or many contacts, so that the error of the model stands out of it: there an interval that
//! knows of noise alone cannot hold the truth. Degrees 2, 3 and 4; 27, 36, 200 and 2,000 contacts.

/// Surfaces: name and TOML of `[surface]`.
const SURFACES: [(&str, &str); 8] = [
    ("sphere", "kind = \"sphere\"\nradius = 10.0"),
    ("cylinder", "kind = \"cylinder\"\nradius = 10.0"),
    ("cylinder-45deg", "kind = \"cylinder\"\nradius = 10.0\naxis_deg = 45.0"),
    ("saddle", "kind = \"saddle\"\nradii = [12.0, 12.0]"),
    ("torus", "kind = \"torus\"\nmajor = 20.0\nminor = 8.0"),
    ("bump", "kind = \"gaussian\"\nheight = 2.0\nwidth = 4.0"),
    ("ellipsoid", "kind = \"ellipsoid\"\nsemi_axes = [16.0, 12.0, 9.0]"),
    ("plane", "kind = \"plane\""),
];

/// Contacts and noise: fingers, stations, degree, sd of z, sd of the normals in degrees.
const SWEEPS: [(usize, usize, usize, f64, f64); 4] =
    [(3, 9, 2, 0.05, 3.0), (3, 12, 3, 0.005, 0.5), (10, 20, 2, 0.005, 0.5), (40, 50, 4, 0.05, 3.0)];

/// `(name, TOML)` of every scene.
pub(crate) fn coverage_family() -> Vec<(String, String)> {
    let mut scenes = Vec::new();
    for (surface, toml) in SURFACES {
        for (fingers, stations, degree, z, deg) in SWEEPS {
            let contacts = fingers * stations;
            let name = format!("{surface}-{contacts}-degree{degree}");
            let places = palpate_world::scene::linspace(-4.0, 4.0, fingers);
            let text = format!(
                "name = \"{name}\"\n\n[surface]\n{toml}\n\n[sweep]\nfingers = {places:?}\nfrom = -4.0\nto = 4.0\nstations = {stations}\n\n\
                 [effects.position_noise]\nsigma = [0.0, 0.0, {z:?}]\n\n[effects.normal_noise]\nsigma_deg = {deg:?}\n\n\
                 [fit]\ndegree = {degree}\nsigma = [{z:?}, {deg:?}]\n"
            );
            scenes.push((name, text));
        }
    }
    scenes
}
