//! Coverage of S, R, radius and axis by kind, part, contacts and noise.

use std::time::Instant;

use palpate::geometry::ShapeClass;
use palpate_laboratory::bodies::{BodyKind, RandomBody, SizeLaw, TouchedBody};

use crate::Wishes;
use crate::ranks::{is_of, recognised};

/// Parts of the way round, contacts with or without normals, and noises of the cells.
const PARTS: [f64; 3] = [1.0, 0.5, 0.2];
const CONTACTS: [(usize, bool); 6] = [(8, true), (20, false), (20, true), (60, false), (200, true), (1000, true)];
const NOISES: [f64; 2] = [0.003, 0.02];

/// A quantity's intervals: how many there were, and how many held the truth.
#[derive(Clone, Copy, Default)]
struct Held([f64; 2]);

impl Held {
    fn add(&mut self, holds: Option<bool>) {
        if let Some(holds) = holds {
            self.0[0] += 1.0;
            self.0[1] += f64::from(u8::from(holds));
        }
    }

    fn percent(&self) -> String {
        let [count, held] = self.0;
        if count > 0.0 { format!("{:5.1}", 100.0 * held / count) } else { "    -".into() }
    }
}

#[derive(Default)]
struct Cell {
    /// S, R, radius, axis.
    held: [Held; 4],
    right: u64,
    sure_and_wrong: u64,
    refused: u64,
    seconds: f64,
}

impl Cell {
    fn judge(&mut self, body: &RandomBody, kind: BodyKind) {
        let began = Instant::now();
        let found = recognised(&body.contacts, 0.95);
        self.seconds += began.elapsed().as_secs_f64();
        let Some(found) = found else {
            self.refused += 1;
            return;
        };
        let is_right = is_of(found.hypothesis, kind);
        self.right += u64::from(is_right);
        let said = found.tried.first().map_or(0.0, |tried| tried.weight);
        self.sure_and_wrong += u64::from(!is_right && said > 0.95);
        let [s, r] = body.mean_shape(found.averaged.iter().map(|(place, _)| *place));
        let s = if found.side_known { s } else { s.abs() };
        let within = |[lo, hi]: [f64; 2], truth: f64| lo <= truth && truth <= hi;
        let bent = found.class != ShapeClass::Plane;
        self.held[0].add(found.shape_index.filter(|_| bent).map(|e| within(e.interval, s)));
        self.held[1].add(Some(within(found.curvedness.interval, r)));
        let radius = body.radius().filter(|_| is_right);
        self.held[2].add(radius.and_then(|truth| Some(within(found.radius_interval?, truth))));
        let off = body.axis().filter(|_| is_right).and_then(|axis| {
            let cosine = found.axis?.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>().abs().min(1.0);
            Some(cosine.acos().to_degrees() <= found.axis_within_deg?)
        });
        self.held[3].add(off);
    }
}

/// A line a cell, and all of them together.
pub(crate) fn print(wishes: &Wishes, fits: u64) {
    println!("kind       part  contacts       noise      S     R radius  axis   right  sure, wrong  refused       ms");
    let mut pooled = [Held::default(); 4];
    for kind in wishes.kinds() {
        for part in PARTS {
            for (count, has_normals) in CONTACTS {
                for noise in NOISES {
                    let touched = TouchedBody { kind, part, count, has_normals, noise, sizes: SizeLaw::Even };
                    let mut cell = Cell::default();
                    (0..fits).for_each(|k| cell.judge(&RandomBody::new(&touched, wishes.seed + k), kind));
                    line(&touched, &cell, fits);
                    for (all, own) in pooled.iter_mut().zip(cell.held) {
                        (0..2).for_each(|k| all.0[k] += own.0[k]);
                    }
                }
            }
        }
    }
    println!("all{:>50}", pooled.map(|held| held.percent()).join(" "));
}

fn line(touched: &TouchedBody, cell: &Cell, fits: u64) {
    let share = |count: u64| 100.0 * count as f64 / fits as f64;
    let with = if touched.has_normals { "with normals" } else { "places" };
    println!(
        "{:<10} {:4.1} {:6} {with:<12} {:5.3}  {}  {:6.1} {:12.1} {:8.1} {:8.1}",
        touched.kind.name(),
        touched.part,
        touched.count,
        touched.noise,
        cell.held.map(|held| held.percent()).join(" "),
        share(cell.right),
        share(cell.sure_and_wrong),
        share(cell.refused),
        1000.0 * cell.seconds / fits as f64,
    );
}
