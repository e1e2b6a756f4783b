//! Coefficients that the descent starts from: a linear least squares fit at the flattened places of the contacts.
//!
//! ```text
//! minimise  sum_r |P_r - Q(u_r)|^2 / Z^2 + ((n_r . Q_u)^2 + (n_r . Q_v)^2) / sigma^2
//!           + a integral |Q_uuu|^2 + |Q_vvv|^2 + b integral |Q_uu|^2 + 2 |Q_uv|^2 + |Q_vv|^2
//! ```
//!
//! The normals couple the coordinates, so the matrix has full 3 x 3 blocks. The penalty on third
//! derivatives keeps a surface of any degree and number of segments near a biquadratic, whose curvatures stay moderate;
//! closed directions need none.

use super::cell_sums::{Buckets, Gather, Products};
use super::cells::Row;
use super::descent::Solver;
use super::problem::Problem;
use super::vector::Vector;
use crate::fit::FitError;

/// Trace of the third-derivative penalty over the trace of the data: enough that three fingers determine nine
/// coefficients.
const THIRD: f64 = 1.0;
/// The same for the thin plate, which only keeps corners without contacts from being undetermined.
const PLATE: f64 = 1e-8;
/// The same for several segments of degree 1 or 2, whose third derivatives vanish.
const PLATE_OF_LOW_DEGREE: f64 = 1e-3;

/// The distinct coefficients that the descent starts from.
///
/// # Errors
/// The normal matrix has no factor.
pub(super) fn start(problem: &Problem, solver: &mut Solver, places: &[[f64; 2]]) -> Result<Vec<Vector>, FitError> {
    let cells = problem.cells;
    let matrix = &mut solver.matrix;
    matrix.clear();
    let mut rhs = vec![0.0; matrix.order()];
    let by_cell = Buckets::new(cells.count(), places.iter().map(|p| cells.cell_of(*p)));
    problem.gather(matrix, &mut rhs, |cell, sums, products| {
        by_cell.of(cell).iter().for_each(|r| add_contact(problem, *r, places[*r], sums, products));
    });
    let data: f64 = matrix.diagonal().iter().sum();
    let third = [(3, 0), (0, 3)].into_iter().zip(cells.shape().closed).filter(|(_, closed)| !closed);
    let third: Vec<_> = third.map(|(order, _)| (order, 1.0)).collect();
    let plate = [((2, 0), 1.0), ((1, 1), 2.0), ((0, 2), 1.0)];
    let low = (0..2).any(|k| cells.shape().degree[k] < 3 && cells.knots()[k].n_segments() > 1);
    let plate_share = if low { PLATE_OF_LOW_DEGREE } else { PLATE };
    let mut buffer = vec![0.0; cells.local()];
    for (orders, share) in [(&third[..], THIRD), (&plate[..], plate_share)] {
        let trace: f64 = problem.gauss.iter().map(|p| 3.0 * p.weight * roughness(&p.row, orders, &mut buffer)).sum();
        if trace <= 0.0 {
            continue;
        }
        problem.gather(matrix, &mut rhs, |cell, sums, products| {
            for point in problem.rule_of(cell) {
                for (order, factor) in orders {
                    products.fill(&point.row, &[*order]);
                    let weight = (share * data / trace * factor * point.weight).sqrt();
                    axes(weight).iter().for_each(|e| sums.add(&[(*e, products.of(0))], 0.0));
                }
            }
        });
    }
    solver.factor.factor(&solver.matrix, 0.0).map_err(|source| FitError::Solve { source })?;
    solver.factor.solve(&mut rhs);
    Ok(rhs.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

fn add_contact(problem: &Problem, r: usize, [u, v]: [f64; 2], sums: &mut Gather, products: &mut Products) {
    products.fill(&problem.cells.row(u, v, 1), &[(0, 0), (1, 0), (0, 1)]);
    let weight = problem.contacts.position_weight[r] / problem.weights.position;
    for (e, p) in axes(weight).iter().zip(problem.contacts.points[r]) {
        sums.add(&[(*e, products.of(0))], weight * p);
    }
    let weight = problem.contacts.normal_weight[r] / problem.weights.normal;
    let normal = problem.contacts.normals[r].map(|n| weight * n);
    (1..3).for_each(|k| sums.add(&[(normal, products.of(k))], 0.0));
}

fn axes(length: f64) -> [Vector; 3] {
    [[length, 0.0, 0.0], [0.0, length, 0.0], [0.0, 0.0, length]]
}

fn roughness(row: &Row, orders: &[((usize, usize), f64)], products: &mut [f64]) -> f64 {
    let square = |(order, factor): &((usize, usize), f64)| {
        row.products(*order, products);
        factor * products.iter().map(|v| v * v).sum::<f64>()
    };
    orders.iter().map(square).sum()
}
