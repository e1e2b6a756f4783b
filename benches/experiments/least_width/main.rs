//! How narrow intervals can be that hold the truth of every family of the coverage table, and of the random surfaces.
//!
//!     cargo bench --bench least_width [-- NAME]
//!
//! ```text
//! d(v) = least distance in noise from the true surface to a member of any family whose mean S (or R) is v
//! length >= integral Phi(1.645 - d(v)) dv        over that of the oracle, 2 x 1.96 sd
//! ```
//!
//! J. W. Pratt, *J. Amer. Statist. Assoc.* 56 (1961) 549. Members are found by descent from many starts, and followed to other values
//! of S and R; a nearer one that was not found would raise the bound, so that it holds all the same. The departures from families
//! that `cargo bench --bench coverage` counts are another class.

mod descent;
mod kinds;
mod member;
mod profile;
mod starts;
mod view;

use palpate_numeric::draws::EffectDraws;
use palpate_world::scene::linspace;
use rayon::prelude::*;

use kinds::Kind;
use member::Member;
use profile::{Profile, length};
use view::View;

/// Contacts as fingers and stations, how many of the table's each of them stands for, and the sds of z and of normals in degrees.
const SWEEPS: [(usize, usize, f64, f64, f64); 4] =
    [(3, 9, 1.0, 0.05, 3.0), (3, 12, 1.0, 0.005, 0.5), (10, 20, 1.0, 0.005, 0.5), (10, 20, 10.0, 0.05, 3.0)];

/// Starts of each family, and how many of the nearest ends are followed.
const STARTS: u64 = 60;
const FOLLOWED: usize = 3;

/// Contacts that a first descent takes, at most.
const COARSE: usize = 40;

/// Distance beyond which a family says nothing.
const FAR: f64 = 5.0;

/// The surfaces of the coverage table: name, family, sizes.
fn surfaces() -> [(&'static str, Kind, Vec<f64>); 6] {
    [
        ("sphere", Kind::Sphere, vec![10.0]),
        ("cylinder", Kind::Cylinder, vec![10.0]),
        ("saddle", Kind::Paraboloid, vec![-1.0 / 12.0, 1.0 / 12.0]),
        ("torus", Kind::Torus, vec![12.0, 8.0]),
        ("bump", Kind::Gaussian, vec![2.0, 4.0]),
        ("ellipsoid", Kind::Ellipsoid, vec![16.0, 12.0, 9.0]),
    ]
}

/// Members of a kind that lie nearest to the true surface, with their distances, the nearest first.
fn nearest(kind: Kind, view: &View, coarse: &View) -> Vec<(Member, f64)> {
    let draws = EffectDraws::new(kind as u64 + 1, "least width");
    let mut ends: Vec<(Member, f64)> = (0..STARTS)
        .filter_map(|start| descent::descend(coarse, kind.start(&draws, start, coarse)?, None, 25))
        .collect();
    ends.sort_by(|a, b| a.1.total_cmp(&b.1));
    ends.truncate(FOLLOWED);
    let fine = ends.into_iter().filter_map(|(member, _)| descent::descend(view, member, None, 60));
    let mut fine: Vec<(Member, f64)> = fine.map(|(member, square)| (member, square.sqrt())).collect();
    fine.sort_by(|a, b| a.1.total_cmp(&b.1));
    fine
}

/// What one family says of a scene: the least distance, and profiles of S and R from every near member that was found. Where the true
/// surface is a member of a larger family, as a ball is an ellipsoid, they lead in different directions.
struct Said {
    kind: Kind,
    distance: f64,
    profiles: [Vec<Profile>; 2],
}

fn said(kind: Kind, truth: &Member, view: &View, coarse: &View) -> Option<Said> {
    let found = if kind == truth.kind { vec![(truth.clone(), 0.0)] } else { nearest(kind, view, coarse) };
    let distance = found.first()?.1;
    let near = || found.iter().filter(|(_, distance)| *distance < FAR);
    let profiles = [0, 1].map(|q| near().map(|(member, _)| profile::follow(view, member, q)).collect());
    Some(Said { kind, distance, profiles })
}

/// Least lengths over the oracle's, for S and R, by some families.
fn over_oracle(said: &[Said], of: impl Fn(Kind) -> bool, sd: [Option<f64>; 2]) -> String {
    let one = |q: usize| {
        let profiles: Vec<&Profile> = said.iter().filter(|s| of(s.kind)).flat_map(|s| &s.profiles[q]).collect();
        sd[q].map_or("-".into(), |sd| format!("{:.2}", length(&profiles) / (2.0 * 1.96 * sd)))
    };
    format!("{:>6} {:>6}", one(0), one(1))
}

fn row(name: &str, truth: &Member, (fingers, stations, stands_for, sd_z, sd_deg): (usize, usize, f64, f64, f64)) {
    let (x, y) = (linspace(-4.0, 4.0, fingers), linspace(-4.0, 4.0, stations));
    let places: Vec<[f64; 2]> = x.iter().flat_map(|x| y.iter().map(move |y| [*x, *y])).collect();
    let sd = [sd_z, f64::to_radians(sd_deg)].map(|sd| sd / f64::sqrt(stands_for));
    let every = places.len().div_ceil(COARSE);
    let few: Vec<[f64; 2]> = places.iter().step_by(every).copied().collect();
    let wider = (few.len() as f64 / places.len() as f64).sqrt();
    let coarse = View::new(truth, few, sd.map(|sd| sd * wider));
    let view = View::new(truth, places, sd);
    let sd = [0, 1].map(|q| profile::sd(&view, truth, q));
    let said: Vec<Said> = Kind::ALL.par_iter().filter_map(|kind| said(*kind, truth, &view, &coarse)).collect();
    let near: Vec<String> = said
        .iter()
        .filter(|s| s.kind != truth.kind && s.distance < FAR)
        .map(|s| format!("{} {:.2}", s.kind.name(), s.distance))
        .collect();
    println!(
        "{:<16} {}   {}   {}   {}   {}",
        format!("{name}-{}", fingers * stations * stands_for as usize),
        over_oracle(&said, |kind| kind == truth.kind, sd),
        over_oracle(&said, |kind| !kind.is_sum(), sd),
        over_oracle(&said, |kind| kind != Kind::AnyBumps, sd),
        over_oracle(&said, |_| true, sd),
        near.join(", ")
    );
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    println!(
        "least width over the oracle's, S and R, by the family itself, all bodies, and sums of three bumps as random surfaces draw"
    );
    println!("them, and of any size; then the distance in noise of the nearest members that lie within {FAR}");
    println!("{:<16} {:>13}   {:>13}   {:>13}   {:>13}", "", "itself", "bodies", "drawn bumps", "any bumps");
    for (name, kind, sizes) in surfaces() {
        let truth = Member::upright(kind, sizes);
        for sweep in SWEEPS {
            let (fingers, stations, stands_for, ..) = sweep;
            let row_name = format!("{name}-{}", fingers * stations * stands_for as usize);
            if asked.is_empty() || asked.iter().any(|a| row_name.contains(a.as_str())) {
                row(name, &truth, sweep);
            }
        }
    }
}
