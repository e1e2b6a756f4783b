//! Any tiling, in any order of the pieces' places, gives the bits of one memory.

use super::*;
use crate::adaptive::{ContactBounds, RowVariances, fit_adaptive};
use crate::field::HierarchicalField;
use palpate_geometry::contact::Contacts;
use palpate_numeric::draws::Lcg;

/// A smooth surface with bumps, half of it touched a hundred times as densely, 1 % of the contacts far off.
fn touched(count: usize, seed: u64) -> Contacts {
    let mut draw = Lcg::new(seed);
    let mut columns = [0, 1, 2].map(|_| Vec::with_capacity(count));
    for _ in 0..count {
        let dense = draw.uniform() < 0.5;
        let [x, y] = [0, 1].map(|_| if dense { 0.2 * draw.uniform() } else { 2.0 * draw.uniform() - 1.0 });
        let bump = |u: f64, v: f64| 0.05 * (-((x - u).powi(2) + (y - v).powi(2)) / 0.003).exp();
        let strange = if draw.uniform() < 0.01 { draw.uniform() } else { 0.0 };
        let z = 0.3 * (1.5 * x).sin() * y.cos() + bump(0.1, 0.1) + bump(-0.5, 0.4) + 0.002 * draw.normal() + strange;
        [x, y, z].into_iter().zip(&mut columns).for_each(|(v, column)| column.push(v));
    }
    let [x, y, z] = columns;
    Contacts::from_positions(x, y, z)
}

/// Contacts from the first to before the second.
fn piece(contacts: &Contacts, from: usize, to: usize) -> Contacts {
    contacts.in_order(&(from as u32..to as u32).collect::<Vec<u32>>())
}

/// Tiles in memory that are packed and unpacked on the way.
struct Held(Vec<Vec<u8>>);

impl TileSource for Held {
    fn answers(&mut self, questions: Vec<TileQuestion>) -> Result<Vec<Vec<f64>>, HierarchyError> {
        let answer = |(tile, question): (&Vec<u8>, TileQuestion)| {
            ContactTile::unpack(tile)?.answer(&TileQuestion::unpack(&question.pack())?)
        };
        self.0.iter().zip(questions).map(answer).collect()
    }
}

/// So many tiles of contacts that come in so many parts.
fn tiled(contacts: &Contacts, options: &AdaptiveOptions, tiles: usize, parts: usize) -> (TileGround, Vec<Vec<u8>>) {
    let edges: Vec<usize> = (0..=parts).map(|k| contacts.len() * k / parts).collect();
    let pieces: Vec<Contacts> = edges.windows(2).map(|ends| piece(contacts, ends[0], ends[1])).collect();
    let bounds = pieces.iter().fold(ContactBounds::NONE, |sum, piece| sum.with(ContactBounds::of(piece)));
    let ground = TileGround::unpack(&TileGround::of(&bounds, options).unwrap().pack()).unwrap();
    let runs: Vec<ContactRun> =
        pieces.iter().zip(&edges).map(|(piece, first)| ContactRun::of(piece, &ground, *first).unwrap()).collect();
    let roots = |tile: usize| ground.roots() * tile / tiles..ground.roots() * (tile + 1) / tiles;
    let own: Vec<ContactRun> = (0..tiles)
        .map(|tile| ContactRun::merged(&runs.iter().map(|run| run.of_roots(roots(tile))).collect::<Vec<_>>()).unwrap())
        .collect();
    let counts: Vec<usize> = own.iter().map(ContactRun::len).collect();
    let packed = (0..tiles).map(|tile| {
        let (sides, before) = beside_tile(&counts, tile);
        let sides = sides.map(|side| side.into_iter().map(|(other, range)| own[other].slice(range)).collect());
        let total = counts.iter().sum();
        ContactTile::new(&ground, roots(tile), own[tile].clone(), sides, [before, total]).unwrap().pack()
    });
    let packed = packed.collect();
    (ground, packed)
}

fn fitted_in(
    contacts: &Contacts,
    options: &AdaptiveOptions,
    tiles: usize,
    parts: usize,
) -> crate::adaptive::AdaptiveFit {
    let (ground, packed) = tiled(contacts, options, tiles, parts);
    let extents: Vec<TileExtent> = packed
        .iter()
        .map(|tile| TileExtent::unpack(&ContactTile::unpack(tile).unwrap().extent().pack()).unwrap())
        .collect();
    fit_tiles(&ground, &extents, &mut Held(packed), options).unwrap()
}

fn same(found: &crate::adaptive::AdaptiveFit, whole: &crate::adaptive::AdaptiveFit) {
    let bits = |field: &HierarchicalField| field.coefficients().iter().map(|c| c.to_bits()).collect::<Vec<u64>>();
    assert!(found.field().space().leaves() == whole.field().space().leaves());
    assert!(bits(found.field()) == bits(whole.field()));
    let (a, b) = (found.report(), whole.report());
    assert_eq!((&a.rounds, &a.outliers, &a.lambdas, a.counted), (&b.rounds, &b.outliers, &b.lambdas, b.counted));
    assert_eq!((a.freedom, a.rms, a.plane_p, a.backward_error), (b.freedom, b.rms, b.plane_p, b.backward_error));
    assert_eq!(found.height_sd(0.1, 0.12), whole.height_sd(0.1, 0.12));
    assert_eq!((found.height_noise(), found.slope_noise()), (whole.height_noise(), whole.slope_noise()));
}

#[test]
fn one_four_and_nine_tiles_give_the_bits_of_one_memory() {
    let contacts = touched(60_000, 31);
    let options = AdaptiveOptions::default();
    let whole = fit_adaptive(&contacts, &options).unwrap();
    assert!(whole.report().rounds.len() > 2 && !whole.report().outliers.is_empty(), "{:?}", whole.report().rounds);
    // 64 tiles are the base cells one by one; most have fewer contacts than a block
    for (tiles, parts) in [(1, 1), (4, 3), (9, 5), (64, 2)] {
        same(&fitted_in(&contacts, &options, tiles, parts), &whole);
    }
}

#[test]
fn slopes_normals_and_weights_are_tiled_too() {
    let bare = touched(12_000, 33);
    let mut draw = Lcg::new(34);
    let slopes: Vec<[f64; 2]> = (0..bare.len())
        .map(|r| {
            let (x, y) = (bare.x[r], bare.y[r]);
            let exact = [0.45 * (1.5 * x).cos() * y.cos(), -0.3 * (1.5 * x).sin() * y.sin()];
            exact.map(|s| s + 0.05 * draw.normal())
        })
        .collect();
    let (zx, zy) = slopes.iter().map(|s| (s[0], s[1])).unzip();
    let normals: Vec<[f64; 3]> = slopes.iter().map(|[p, q]| [-p, -q, 1.0]).collect();
    let mut weighed = bare.clone().with_slopes(zx, zy);
    weighed.weights.z = Some((0..bare.len()).map(|r| 0.5 + (r % 3) as f64).collect());
    let known = RowVariances::Known { heights: 0.002, slopes: 0.05 };
    for (contacts, noise) in [(bare.with_normal_vectors(&normals), RowVariances::Estimated), (weighed, known)] {
        let options = AdaptiveOptions { noise, ..AdaptiveOptions::default() };
        same(&fitted_in(&contacts, &options, 4, 3), &fit_adaptive(&contacts, &options).unwrap());
    }
}

#[test]
fn contacts_are_spooled_through_a_folder_that_is_gone_afterwards() {
    let contacts = touched(60_000, 31);
    let options = AdaptiveOptions::default();
    let folder = std::env::temp_dir().join(format!("palpate-spool-{}", std::process::id()));
    let pieces = (0..7).map(|k| Ok(piece(&contacts, 60_000 * k / 7, 60_000 * (k + 1) / 7)));
    let found = fit_spooled(pieces, &options, &folder, 9_000).unwrap();
    same(&found, &fit_adaptive(&contacts, &options).unwrap());
    assert!(!folder.exists());
    // a fault in the middle leaves nothing behind
    let bad = HierarchyError::Parts { what: "a torn line".into() };
    let pieces = [Ok(piece(&contacts, 0, 10)), Err(bad.clone())];
    assert_eq!(fit_spooled(pieces, &options, &folder, 9_000).unwrap_err(), bad);
    let slopes = piece(&contacts, 0, 1).with_slopes(vec![0.0], vec![0.0]);
    let mixed = fit_spooled([Ok(piece(&contacts, 0, 10)), Ok(slopes)], &options, &folder, 9_000).unwrap_err();
    assert!(matches!(mixed, HierarchyError::Parts { .. }), "{mixed}");
    assert!(matches!(fit_spooled([], &options, &folder, 9_000), Err(HierarchyError::Parts { .. })));
    assert!(!folder.exists());
}

#[test]
fn tiles_that_do_not_belong_together_are_refused() {
    let contacts = touched(3_000, 35);
    let options = AdaptiveOptions::default();
    let (ground, mut packed) = tiled(&contacts, &options, 3, 2);
    let extents: Vec<TileExtent> = packed.iter().map(|tile| ContactTile::unpack(tile).unwrap().extent()).collect();
    let refused = |extents: &[TileExtent], packed: Vec<Vec<u8>>| {
        assert!(matches!(fit_tiles(&ground, extents, &mut Held(packed), &options), Err(HierarchyError::Parts { .. })));
    };
    refused(&extents[..2], packed[..2].to_vec());
    refused(&[&extents[1..], &extents[..1]].concat(), packed.clone());
    refused(&extents, packed[1..].to_vec());
    for cut in [0, 7, 8, packed[0].len() / 2, packed[0].len() - 1] {
        assert!(matches!(ContactTile::unpack(&packed[0][..cut]), Err(HierarchyError::Parts { .. })), "{cut}");
    }
    packed[1].push(0);
    refused(&extents, packed);
}
