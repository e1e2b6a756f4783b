//! The rolled spherical tip: tip and surface share their normal at the contact, to 1e-12, and nothing pokes into the tip.

use palpate_app::io::scene_file::read_scene;

const SURFACES: &[&str] = &[
    "kind = \"plane\"\nrotation_deg = [15.0, -30.0, 0.0]",
    "kind = \"sphere\"\nradius = 6.0",
    "kind = \"cylinder\"\nradius = 6.6\naxis_deg = 35.0",
    "kind = \"cylinder\"\nradius = 10.0\naxis_deg = 35.0\nconcave = true",
    "kind = \"ellipsoid\"\nsemi_axes = [12.0, 9.0, 5.0]\nrotation_deg = [10.0, 5.0, 0.0]",
    "kind = \"torus\"\nmajor = 14.0\nminor = 7.0",
    "kind = \"paraboloid\"\nradii = [5.0, 9.0]",
    "kind = \"saddle\"\nradii = [6.0, 8.0]",
    "kind = \"monkey_saddle\"\nlength = 9.0",
    "kind = \"gaussian\"\nheight = 2.0\nwidth = 3.0",
    "kind = \"sinusoid\"\namplitude = 0.3\nwavelength = 7.0\nwavelength_y = 11.0",
    "kind = \"superquadric\"\nsemi_axes = [7.0, 7.0, 5.0]\nexponents = [0.8, 0.9]",
    "kind = \"union\"\n[[surface.parts]]\nkind = \"plane\"\noffset = [0.0, 0.0, -1.5]\n[[surface.parts]]\nkind = \"sphere\"\nradius = 6.0",
];

#[test]
fn tip_and_surface_share_their_normal() {
    for surface in SURFACES {
        for tip in [0.1, 0.5, 1.5] {
            let text = format!(
                "[sweep]\nfingers = [-3.5, -1.0, 0.0, 2.0, 3.5]\nfrom = -3.5\nto = 3.5\nstations = 8\nangle_deg = 17.0\n\
                 tip_radius = {tip:?}\nunreachable = \"skip\"\n[surface]\n{surface}\n"
            );
            let scene = read_scene(&text).unwrap_or_else(|error| panic!("{surface}: {error}"));
            let simulator = scene.world.compile().unwrap();
            let (reachable, total) = simulator.reach();
            assert!(reachable * 4 >= total * 3, "{surface} tip {tip}: {reachable} of {total}");
            for site in simulator.sites() {
                let (point, normal) = (site.touch.point, site.touch.local.normal);
                for k in 0..2 {
                    let miss = point[k] + tip * normal[k] - site.aim[k];
                    assert!(miss.abs() <= 1e-12 * (tip + 8.0), "{surface} tip {tip}: misses by {miss:e}");
                }
                assert_on_surface_and_free(&scene.world.surface, point, normal, tip, surface);
            }
        }
    }
}

/// The contact lies on the surface, and no point of the surface lies inside the ball.
fn assert_on_surface_and_free(
    surface: &palpate::scene::Surface,
    point: [f64; 3],
    normal: [f64; 3],
    tip: f64,
    name: &str,
) {
    assert!((surface.height(point[0], point[1]).unwrap() - point[2]).abs() < 1e-13);
    let centre = [0, 1, 2].map(|k| point[k] + tip * normal[k]);
    for i in 0..400 {
        // golden-angle spiral over the disc under the ball
        let reach = tip * (f64::from(i) / 400.0).sqrt();
        let angle = 2.399_963_229_728_653 * f64::from(i);
        let (x, y) = (centre[0] + reach * angle.cos(), centre[1] + reach * angle.sin());
        if let Some(z) = surface.height(x, y) {
            let inside = z - centre[2] + (tip * tip - reach * reach).sqrt();
            assert!(inside < 1e-9, "{name} tip {tip}: the surface is {inside:e} inside the ball");
        }
    }
}

#[test]
fn lanes_bend_as_on_a_real_hand() {
    let text = "[surface]\nkind = \"sphere\"\nradius = 6.0\n[sweep]\nfingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\nto = 4.0\nstations = 5\ntip_radius = 1.0\n";
    let simulator = read_scene(text).unwrap().world.compile().unwrap();
    let patch = simulator.patch();
    let expected = 4.0 * 6.0 / 7.0;
    assert!(
        patch.iter().zip([-1.0, 1.0, -1.0, 1.0]).all(|(side, sign)| (side - sign * expected).abs() < 1e-12),
        "{patch:?}"
    );
}
