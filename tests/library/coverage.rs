//! The cells of `cargo bench --bench coverage`: the family's scenes, the oracle's widths beside them, random surfaces.

#[path = "../../benches/experiments/coverage/cells/mod.rs"]
#[allow(dead_code, reason = "the bench uses the rest")]
mod cells;

use cells::cell::Cell;
use cells::family::coverage_family;
use cells::judged::{Judged, of_family};
use cells::pooled::pooled;
use palpate_app::io::scene_file::read_scene;

#[test]
fn every_scene_reads() {
    let scenes = coverage_family();
    assert!(scenes.len() >= 24);
    for (name, text) in scenes {
        let scene = read_scene(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(scene.name, name);
    }
}

#[test]
fn a_member_of_the_family_is_judged_by_its_name() {
    let words = ["cylinder-27-degree2", "cylinder-28-degree2"].map(String::from);
    let named: Vec<_> = of_family(&words[..1], 1997).collect();
    assert_eq!(named.len(), 1);
    let (name, judged) = named.into_iter().next().unwrap();
    let cell = Cell::new(&judged(), 2).unwrap();
    assert_eq!((&name[..], &cell.scene[..], cell.fitted), ("cylinder-27-degree2", "cylinder-27-degree2", 2));
    // the family fixes S; R is wanted at 1.5 times the oracle's, which small departures from the bar forbid
    let [s, r] = &cell.quantities;
    assert!(s.least_over_oracle.is_none() && r.least_over_oracle.unwrap() > 1.5);
    assert!(r.goal_departure.unwrap() < 0.01);
    assert_eq!(of_family(&words[1..], 1997).count(), 0);
}

#[test]
fn random_surfaces_are_pooled_by_their_kind() {
    let cells: Vec<Cell> = (5..11).map(|seed| Cell::new(&Judged::random(seed), 1).unwrap()).collect();
    let pooled = pooled(&cells);
    let names: Vec<&str> = pooled.iter().map(|p| &p.kind[..]).collect();
    assert_eq!(names, ["bumps", "superquadric", "torus", "all"]);
    let r = || cells.iter().map(|cell| &cell.quantities[1].chosen);
    let all = &pooled[3].quantities[1];
    assert_eq!(all.asked, r().map(|part| part.asked).sum::<u64>());
    let inside: f64 = r().filter_map(|part| part.share()).sum();
    assert!((all.inside.unwrap() * all.asked as f64 - inside).abs() < 1e-12);
    assert!(all.median_error.unwrap().abs() <= all.of_90_percent.unwrap());
}

/// The noise of a random surface is that of its own seed, whichever list it stands in; and a cell comes back from its line.
#[test]
fn a_random_surface_is_the_same_in_every_list() {
    let of = |seed| Cell::new(&Judged::random(seed), 1).unwrap();
    let (one, again) = (of(6), of(6));
    assert_eq!((one.seed, &one), (6, &again));
    assert_ne!(one.quantities[1].errors, of(9).quantities[1].errors);
    let line = serde_json::to_string(&one).unwrap();
    assert_eq!(serde_json::from_str::<Cell>(&line).unwrap(), one);
}
