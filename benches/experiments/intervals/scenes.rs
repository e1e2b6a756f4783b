//! The rows of the table: surfaces, contacts, noise and the model that is named.

/// Surfaces: word and TOML.
const SURFACES: [(&str, &str); 8] = [
    ("saddle", "kind = \"saddle\"\nradii = [10.0, 10.0]"),
    ("cylinder45", "kind = \"cylinder\"\nradius = 10.0\naxis_deg = 45.0"),
    ("cylinder0", "kind = \"cylinder\"\nradius = 10.0"),
    ("sphere10", "kind = \"sphere\"\nradius = 10.0"),
    ("sphere100", "kind = \"sphere\"\nradius = 100.0"),
    ("plane", "kind = \"plane\""),
    ("bump", "kind = \"gaussian\"\nheight = 1.0\nwidth = 3.0"),
    ("ellipsoid", "kind = \"ellipsoid\"\nsemi_axes = [16.0, 12.0, 9.0]"),
];

const MEDIUM: &str = "[effects.position_noise]\nsigma = [0.0, 0.0, 0.02]\n[effects.normal_noise]\nsigma_deg = 2.0";
const SMALL: &str = "[effects.position_noise]\nsigma = [0.0, 0.0, 0.002]\n[effects.normal_noise]\nsigma_deg = 0.2";
const LARGE: &str = "[effects.position_noise]\nsigma = [0.0, 0.0, 0.1]\n[effects.normal_noise]\nsigma_deg = 8.0";
const IN_PLACE: &str = "[effects.position_noise]\nsigma = [0.3, 0.3, 0.02]\n[effects.normal_noise]\nsigma_deg = 2.0";
// stations one apart: neighbouring errors of z correlate by 0.9
const ALONG: &str =
    "[effects.normal_noise]\nsigma_deg = 2.0\n[effects.finger_noise]\nsigma = [0.0, 0.0, 0.02]\nlength = 9.49";
const SLIPS: &str = "[effects.position_noise]\nsigma = [0.0, 0.0, 0.02]\n[effects.normal_noise]\nsigma_deg = 2.0\n\
                     [effects.slip]\nprobability = 0.05\nsize = 0.5";

const DECLARED: &str = "sigma = [0.02, 2.0]";

/// Surface, fingers x stations, effects with their word, `[fit]`.
type Row = (&'static str, [usize; 2], (&'static str, &'static str), &'static str);

const ROWS: &[Row] = &[
    ("saddle", [3, 9], ("medium", MEDIUM), DECLARED),
    ("saddle", [3, 9], ("small", SMALL), "sigma = [0.002, 0.2]"),
    ("saddle", [3, 9], ("large", LARGE), "sigma = [0.1, 8.0]"),
    ("saddle", [3, 9], ("medium", MEDIUM), "sigma = \"auto\""),
    ("saddle", [3, 4], ("medium", MEDIUM), "sigma = \"auto\""),
    ("saddle", [3, 3], ("medium", MEDIUM), "sigma = \"auto\""),
    ("saddle", [25, 40], ("medium", MEDIUM), "sigma = \"auto\""),
    ("saddle", [3, 9], ("medium", MEDIUM), "weights = \"tangent\""),
    ("saddle", [3, 9], ("medium", MEDIUM), "weights = \"position\""),
    ("saddle", [3, 4], ("medium", MEDIUM), "weights = \"tangent\""),
    ("saddle", [3, 9], ("medium", MEDIUM), "sigma = \"auto\"\nrobust = \"huber\""),
    ("saddle", [3, 9], ("medium", MEDIUM), "sigma = \"auto\"\nrobust = \"tukey\""),
    ("saddle", [3, 9], ("slips", SLIPS), "sigma = \"auto\"\nrobust = \"tukey\""),
    ("saddle", [3, 9], ("along the finger 0.9", ALONG), "sigma = \"auto\""),
    ("saddle", [3, 9], ("in x and y", IN_PLACE), "sigma = \"auto\""),
    ("saddle", [3, 9], ("in x and y", IN_PLACE), "sigma = \"auto\"\nsigma_xy = 0.3"),
    ("saddle", [3, 9], ("in x and y", IN_PLACE), DECLARED),
    ("saddle", [3, 9], ("in x and y", IN_PLACE), "sigma = [0.02, 2.0]\nsigma_xy = 0.3"),
    ("saddle", [3, 9], ("in x and y", IN_PLACE), "weights = \"tangent\"\nsigma_xy = 0.3"),
    ("saddle", [25, 40], ("in x and y", IN_PLACE), "sigma = \"auto\""),
    ("saddle", [25, 40], ("in x and y", IN_PLACE), "sigma = \"auto\"\nsigma_xy = 0.3"),
    ("saddle", [3, 9], ("in x and y", IN_PLACE), "sigma = \"auto\"\nsigma_xy = 0.3\nrobust = \"huber\""),
    ("plane", [3, 9], ("in x and y", IN_PLACE), "sigma = [0.02, 2.0]\nsigma_xy = 0.3"),
    ("saddle", [3, 9], ("along the finger 0.9", ALONG), DECLARED),
    ("saddle", [3, 9], ("along the finger 0.9", ALONG), "weights = \"tangent\""),
    ("saddle", [5, 12], ("along the finger 0.9", ALONG), "sigma = \"auto\""),
    ("saddle", [25, 40], ("along the finger 0.9", ALONG), "sigma = \"auto\""),
    ("plane", [3, 9], ("along the finger 0.9", ALONG), "sigma = \"auto\""),
    ("plane", [3, 9], ("along the finger 0.9", ALONG), DECLARED),
    ("plane", [25, 40], ("along the finger 0.9", ALONG), "sigma = \"auto\""),
    ("plane", [6, 6], ("medium", MEDIUM), "sigma = \"auto\"\nrobust = \"tukey\""),
    ("plane", [10, 20], ("medium", MEDIUM), "sigma = \"auto\"\nrobust = \"tukey\""),
    ("saddle", [3, 9], ("medium", MEDIUM), "sigma = [0.01, 1.0]"),
    ("saddle", [3, 9], ("medium", MEDIUM), "sigma = [0.04, 4.0]"),
    ("saddle", [6, 6], ("large", LARGE), "sigma = [0.1, 8.0]\ndegree = 4"),
    ("cylinder45", [3, 9], ("medium", MEDIUM), DECLARED),
    ("cylinder45", [3, 9], ("large", LARGE), "sigma = [0.1, 8.0]"),
    ("cylinder45", [6, 6], ("small", SMALL), "sigma = [0.002, 0.2]"),
    ("cylinder45", [25, 40], ("medium", MEDIUM), DECLARED),
    ("cylinder45", [25, 40], ("medium", MEDIUM), "sigma = [0.02, 2.0]\ndegree = 3\nsegments = 8"),
    ("cylinder45", [25, 40], ("medium", MEDIUM), "sigma = [0.02, 2.0]\ndegree = 3\nsegments = 8\nsmooth = \"auto\""),
    ("cylinder0", [3, 9], ("medium", MEDIUM), DECLARED),
    ("cylinder0", [3, 9], ("medium", MEDIUM), "weights = \"tangent\""),
    ("sphere10", [6, 6], ("medium", MEDIUM), DECLARED),
    ("sphere10", [6, 6], ("small", SMALL), "sigma = [0.002, 0.2]"),
    ("sphere100", [6, 6], ("medium", MEDIUM), DECLARED),
    ("sphere100", [6, 6], ("small", SMALL), "sigma = [0.002, 0.2]"),
    ("ellipsoid", [3, 9], ("medium", MEDIUM), DECLARED),
    ("ellipsoid", [6, 6], ("small", SMALL), "sigma = [0.002, 0.2]"),
    ("bump", [3, 9], ("medium", MEDIUM), DECLARED),
    ("bump", [6, 6], ("medium", MEDIUM), DECLARED),
    ("bump", [25, 40], ("medium", MEDIUM), DECLARED),
    ("plane", [3, 9], ("medium", MEDIUM), DECLARED),
    ("plane", [3, 9], ("medium", MEDIUM), "sigma = \"auto\""),
    ("plane", [3, 4], ("medium", MEDIUM), "sigma = \"auto\""),
    ("plane", [3, 3], ("medium", MEDIUM), "sigma = \"auto\""),
    ("plane", [3, 9], ("medium", MEDIUM), "weights = \"tangent\""),
    ("plane", [3, 9], ("medium", MEDIUM), "weights = \"position\""),
    ("plane", [3, 9], ("medium", MEDIUM), "sigma = \"auto\"\nrobust = \"huber\""),
    ("plane", [3, 9], ("medium", MEDIUM), "sigma = \"auto\"\nrobust = \"tukey\""),
];

/// `(name, TOML)` of every row.
pub(crate) fn all() -> Vec<(String, String)> {
    let one = |(surface, [fingers, stations], (noise, effects), fit): &Row| {
        let toml = SURFACES.iter().find(|(word, _)| word == surface).map_or("", |(_, toml)| toml);
        let named = fit.replace('\n', ", ").replace('"', "").replace(" = ", " ");
        let name = format!("{surface}, {} contacts, {noise}, {named}", fingers * stations);
        let places: Vec<f64> = (0..*fingers).map(|k| -4.0 + 8.0 * k as f64 / (*fingers as f64 - 1.0)).collect();
        let text = format!(
            "name = \"{name}\"\n[surface]\n{toml}\n[sweep]\nfingers = {places:?}\nfrom = -4.0\nto = 4.0\n\
             stations = {stations}\n{effects}\n[fit]\n{fit}\n"
        );
        (name, text)
    };
    ROWS.iter().map(one).collect()
}
