//! Where the descent begins: the linear rows of the flattened contacts.
//!
//! ```text
//! minimise  sum_r |P_r - Q(u_r)|^2 / Z^2 + ((n_r . Q_u)^2 + (n_r . Q_v)^2) / sigma^2
//!           + a integral |Q_uuu|^2 + |Q_vvv|^2 + b integral |Q_uu|^2 + 2 |Q_uv|^2 + |Q_vv|^2
//! ```
//!
//! The normals couple the coordinates, so the matrix has full 3 x 3 blocks. The third derivatives bring a surface of any
//! degree and number of segments near a biquadratic, whose curvatures do not run away; closed directions need none.

use super::cells::Row;
use super::descent::Solver;
use super::problem::Problem;
use super::vector::Vector;
use crate::fit::FitError;

/// Share of the data's trace that the third derivatives get: enough that three lanes bear nine coefficients.
const THIRD: f64 = 1.0;
/// The same for the thin plate, which only keeps a corner without contacts from being free.
const PLATE: f64 = 1e-8;
/// And where several segments of degree 1 or 2 have no third derivative to hold them.
const PLATE_OF_LOW_DEGREE: f64 = 1e-3;

/// Distinct coefficients of the start.
///
/// # Errors
/// A matrix without a factor.
pub fn start(problem: &Problem, solver: &mut Solver, places: &[[f64; 2]]) -> Result<Vec<Vector>, FitError> {
    let cells = problem.cells;
    let matrix = &mut solver.matrix;
    matrix.clear();
    let mut rhs = vec![0.0; matrix.order()];
    let (mut alive, mut products) = (Vec::new(), Vec::new());
    for (r, place) in places.iter().enumerate() {
        let row = cells.row(place[0], place[1]);
        cells.alive(&row, &mut alive);
        let (point, normal) = (problem.touches.points[r], problem.touches.normals[r]);
        let weight = (problem.touches.position_weight[r] / problem.weights.position).powi(2);
        row.products((0, 0), &mut products);
        add(&alive, &products, weight, &IDENTITY, matrix);
        for (k, product) in alive.iter().zip(&products) {
            (0..3).for_each(|d| rhs[3 * k + d] += weight * product * point[d]);
        }
        let weight = (problem.touches.normal_weight[r] / problem.weights.normal).powi(2);
        let outer = normal.map(|a| normal.map(|b| a * b));
        for order in [(1, 0), (0, 1)] {
            row.products(order, &mut products);
            add(&alive, &products, weight, &outer, matrix);
        }
    }
    let data: f64 = matrix.diagonal().iter().sum();
    let third = [(3, 0), (0, 3)].into_iter().zip(cells.shape().closed).filter(|(_, closed)| !closed);
    let third: Vec<_> = third.map(|(order, _)| (order, 1.0)).collect();
    let plate = [((2, 0), 1.0), ((1, 1), 2.0), ((0, 2), 1.0)];
    let low = (0..2).any(|k| cells.shape().degree[k] < 3 && cells.knots()[k].n_segments() > 1);
    let plate_share = if low { PLATE_OF_LOW_DEGREE } else { PLATE };
    for (orders, share) in [(&third[..], THIRD), (&plate[..], plate_share)] {
        let trace: f64 = problem.gauss.iter().map(|p| 3.0 * p.weight * roughness(&p.row, orders, &mut products)).sum();
        if trace > 0.0 {
            for point in problem.gauss {
                cells.alive(&point.row, &mut alive);
                for (order, factor) in orders {
                    point.row.products(*order, &mut products);
                    add(&alive, &products, share * data / trace * factor * point.weight, &IDENTITY, matrix);
                }
            }
        }
    }
    solver.factor.factor(&solver.matrix, 0.0).map_err(|source| FitError::Solve { source })?;
    solver.factor.solve(&mut rhs);
    Ok(rhs.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn roughness(row: &Row, orders: &[((usize, usize), f64)], products: &mut Vec<f64>) -> f64 {
    let square = |(order, factor): &((usize, usize), f64)| {
        row.products(*order, products);
        factor * products.iter().map(|v| v * v).sum::<f64>()
    };
    orders.iter().map(square).sum()
}

/// `A += w (s s') (x) block`, block symmetric.
fn add(alive: &[usize], s: &[f64], w: f64, block: &[[f64; 3]; 3], matrix: &mut crate::linalg::BlockMatrix) {
    for (a, &row) in alive.iter().enumerate() {
        for (b, &column) in alive[..=a].iter().enumerate() {
            let factor = w * s[a] * s[b];
            matrix.add(row.max(column), row.min(column), &block.map(|line| line.map(|v| factor * v)));
        }
    }
}
