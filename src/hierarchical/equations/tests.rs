//! The packed cells against the rows of the contacts, one by one.

use std::sync::Arc;

use super::*;
use crate::field::HierarchicalField;
use crate::mesh::{CellId, Mesh};
use crate::space::HierarchicalSpace;
use palpate_fitting::observation::{RoughnessOrder, linearise_normals};
use palpate_geometry::contact::{Contacts, Frame};
use palpate_numeric::bspline::Knots;
use palpate_numeric::draws::Lcg;
use palpate_numeric::vector::unit;

fn space(degree: [usize; 2]) -> Arc<HierarchicalSpace> {
    let mut mesh = Mesh::new(degree.map(|p| Knots::uniform(p, 4, -1.0, 1.0).unwrap())).unwrap();
    for level in 0..3 {
        mesh.refine(CellId { level, place: [1 << level, 2 << level] }).unwrap();
    }
    Arc::new(HierarchicalSpace::new(mesh))
}

fn contacts(count: usize, draw: &mut Lcg) -> Contacts {
    let mut column = || (0..count).map(|_| 2.0 * draw.uniform() - 1.0).collect::<Vec<f64>>();
    let mut contacts = Contacts::from_positions(column(), column(), column());
    contacts.weights.z = Some(column().iter().map(|w| 1.5 + w).collect());
    contacts
}

/// Rows `wz N o M` and slope rows of all contacts, dense, about a surface.
fn dense(sorted: &SortedContacts, field: &HierarchicalField, weights: BlockWeights) -> (Vec<Vec<f64>>, Vec<f64>) {
    let space = field.space();
    let n = space.unknowns();
    let units: Vec<HierarchicalField> = (0..n)
        .map(|k| {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            HierarchicalField::new(space.clone(), unit).unwrap()
        })
        .collect();
    let (mut matrix, mut load) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    let columns = sorted.contacts();
    for r in 0..sorted.len() {
        let at = [columns.x[r], columns.y[r]];
        let functions: Vec<[f64; 3]> =
            units.iter().map(|unit| unit.at(at[0], at[1])).map(|p| [p.z, p.zx, p.zy]).collect();
        let here = field.at(at[0], at[1]);
        let wz = columns.weights.z.as_ref().map_or(1.0, |w| w[r]);
        let mut rows = vec![([wz, 0.0, 0.0], wz * (columns.z[r] - here.z), weights.heights)];
        if let Some(normal) = columns.unit_normal(r) {
            let (m, target) = linearise_normals(normal, here.zx, here.zy);
            rows.push(([0.0, m.a, m.b], target[0] - m.a * here.zx - m.b * here.zy, weights.slopes));
            rows.push(([0.0, 0.0, m.d], target[1] - m.d * here.zy, weights.slopes));
        }
        for (row, left, weight) in rows {
            let row: Vec<f64> = functions.iter().map(|f| (0..3).map(|k| row[k] * f[k]).sum()).collect();
            for i in 0..n {
                load[i] += weight * row[i] * left;
                (0..n).for_each(|k| matrix[i][k] += weight * row[i] * row[k]);
            }
        }
    }
    (matrix, load)
}

#[test]
fn packed_cells_give_the_rows_of_the_contacts() {
    let mut draw = Lcg::new(11);
    for degree in [[3, 3], [2, 4], [5, 3], [2, 3]] {
        let space = space(degree);
        let c = (0..space.unknowns()).map(|k| (0.7 * k as f64).sin()).collect();
        let field = HierarchicalField::new(space.clone(), c).unwrap();
        for oriented in [false, true] {
            let mut measured = contacts(400, &mut draw);
            if oriented {
                let normals: Vec<[f64; 3]> = (0..400).map(|_| unit([0, 1, 2].map(|_| draw.normal()))).collect();
                measured = measured.with_normal_vectors(&normals);
            }
            let sorted = SortedContacts::new(&measured, &Frame::IDENTITY, space.mesh()).unwrap();
            let weights = BlockWeights { heights: 1.7, slopes: 0.3 };
            let residuals = ContactResiduals::of(&sorted, SurfaceCells::of(&field));
            let mut sums = CellSums::empty(space.leaves().len(), SumLayout::of(degree, sorted.contacts()));
            sums.add(&sorted, SurfaceCells::of(&field), &residuals, None);
            let pattern = MeetingPattern::of(&space);
            let (values, load) = pattern.assemble(&space, &sums, weights);
            let (matrix, expected) = dense(&sorted, &field, weights);
            let csc = pattern.to_csc(&values);
            let largest = (0..space.unknowns()).map(|k| matrix[k][k]).fold(0.0, f64::max);
            for k in 0..space.unknowns() {
                assert!((load[k] - expected[k]).abs() < 1e-12 * largest, "{degree:?} {k}");
                for i in 0..=k {
                    let found = csc.get_entry(i, k).map_or(0.0, |entry| entry.into_value());
                    assert!((found - matrix[i][k]).abs() < 1e-13 * largest, "{degree:?} {oriented} ({i}, {k})");
                }
            }
        }
    }
}

/// Contacts in pieces: the same sums but for the order of additions. Slopes of one weight: the same as with four sums.
#[test]
fn pieces_and_kinds_of_sums_agree() {
    let mut draw = Lcg::new(12);
    let space = space([3, 3]);
    let field = HierarchicalField::new(space.clone(), vec![0.1; space.unknowns()]).unwrap();
    let mut measured = contacts(900, &mut draw);
    measured.weights.z = None;
    let measured = measured.with_slopes(vec![0.3; 900], (0..900).map(|_| draw.normal()).collect());
    let part = |from: usize, to: usize| measured.in_order(&(from as u32..to as u32).collect::<Vec<_>>());
    let sums_of = |pieces: &[[usize; 2]], weighted: bool| {
        let mut all: Option<CellSums> = None;
        for [from, to] in pieces {
            let mut piece = part(*from, *to);
            piece.weights.x = weighted.then(|| vec![1.0; to - from]);
            let sorted = SortedContacts::new(&piece, &Frame::IDENTITY, space.mesh()).unwrap();
            let sums = all
                .get_or_insert_with(|| CellSums::empty(space.leaves().len(), SumLayout::of([3, 3], sorted.contacts())));
            sums.add(&sorted, SurfaceCells::of(&field), &ContactResiduals::of(&sorted, SurfaceCells::of(&field)), None);
        }
        let sums = all.unwrap();
        let pattern = MeetingPattern::of(&space);
        (pattern.assemble(&space, &sums, BlockWeights { heights: 1.0, slopes: 0.5 }), sums.totals())
    };
    let ((one, one_load), totals) = sums_of(&[[0, 900]], false);
    for ((values, load), others) in [sums_of(&[[0, 250], [250, 900]], false), sums_of(&[[0, 900]], true)] {
        assert!(one.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-10));
        assert!(one_load.iter().zip(&load).all(|(a, b)| (a - b).abs() < 1e-10));
        assert!(totals.iter().zip(&others).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}

/// The roughness of a polynomial over the square, by hand: z = x^2 y has z_xx = 2 y, z_xy = 2 x, z_yy = 0, z_xxy = 2.
#[test]
fn roughness_is_the_integral() {
    let space = space([3, 2]);
    // coefficients by least squares of exact contacts
    let mut draw = Lcg::new(13);
    let mut measured = contacts(3000, &mut draw);
    measured.weights.z = None;
    measured.z = (0..3000).map(|r| measured.x[r].powi(2) * measured.y[r]).collect();
    let sorted = SortedContacts::new(&measured, &Frame::IDENTITY, space.mesh()).unwrap();
    let zero = HierarchicalField::new(space.clone(), vec![0.0; space.unknowns()]).unwrap();
    let mut sums = CellSums::empty(space.leaves().len(), SumLayout::of([3, 2], sorted.contacts()));
    sums.add(&sorted, SurfaceCells::of(&zero), &ContactResiduals::of(&sorted, SurfaceCells::of(&zero)), None);
    let pattern = MeetingPattern::of(&space);
    let (values, load) = pattern.assemble(&space, &sums, BlockWeights { heights: 1.0, slopes: 0.0 });
    let mut factor = crate::factor::SparseCholesky::plan(
        pattern.starts(),
        pattern.rows(),
        crate::factor::EliminationOrder::MinimumDegree,
    )
    .unwrap();
    factor.factor(&values).unwrap();
    let mut c = load;
    factor.solve(&mut c);
    let (second, third) = (RoughnessOrder::Second, RoughnessOrder::Third);
    for (order, exact) in [(second, 4.0 * 4.0 / 3.0 + 2.0 * 4.0 * 4.0 / 3.0), (third, 3.0 * 4.0 * 4.0)] {
        let mut rough = vec![0.0; values.len()];
        pattern.roughness(&space, order).iter().for_each(|level| level.add_to(1.0, &mut rough));
        let mut product = vec![0.0; c.len()];
        pattern.multiply(&rough, &c, &mut product);
        let found: f64 = product.iter().zip(&c).map(|(a, b)| a * b).sum();
        assert!((found - exact).abs() < 1e-6 * exact, "{order:?}: {found} {exact}");
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let mut draw = Lcg::new(14);
    let space = space([3, 3]);
    let field = HierarchicalField::new(space.clone(), vec![0.1; space.unknowns()]).unwrap();
    let measured = contacts(5000, &mut draw);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let sorted = SortedContacts::new(&measured, &Frame::IDENTITY, space.mesh()).unwrap();
            let mut sums = CellSums::empty(space.leaves().len(), SumLayout::of([3, 3], sorted.contacts()));
            sums.add(&sorted, SurfaceCells::of(&field), &ContactResiduals::of(&sorted, SurfaceCells::of(&field)), None);
            MeetingPattern::of(&space).assemble(&space, &sums, BlockWeights { heights: 1.0, slopes: 0.0 })
        })
    };
    assert_eq!(run(1), run(3));
}
