//! Sparse factors of the normal equations and what follows from them: solutions, determinant, condition, entries of the inverse.

mod equation_solver;
mod nested_dissection;
mod point_inverse;
mod sampled_inverse;
mod schwarz;
mod selected_inverse;
mod sparse_cholesky;

pub use equation_solver::EquationSolver;
pub use point_inverse::PointInverse;
pub use sampled_inverse::SampledInverse;
pub use selected_inverse::SelectedInverse;
pub use sparse_cholesky::{EliminationOrder, SparseCholesky};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::HierarchyError;

    /// The five-point matrix of a grid with wider coupling along the diagonal, upper triangle in compressed columns.
    fn grid(wide: usize, high: usize) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for k in 0..wide * high {
            let (i, j) = (k / high, k % high);
            for (di, dj) in [(1, 1), (1, 0), (0, 1), (0, 0)] {
                if i >= di && j >= dj {
                    rows.push(k - di * high - dj);
                    values.push(if di + dj == 0 { 6.0 + (k as f64).sin() } else { -0.9 / (di + dj) as f64 });
                }
            }
            starts.push(rows.len());
        }
        (starts, rows, values)
    }

    fn multiply(starts: &[usize], rows: &[usize], values: &[f64], v: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; v.len()];
        for column in 0..v.len() {
            for at in starts[column]..starts[column + 1] {
                out[rows[at]] += values[at] * v[column];
                if rows[at] != column {
                    out[column] += values[at] * v[rows[at]];
                }
            }
        }
        out
    }

    #[test]
    fn solutions_traces_and_entries_of_the_inverse() {
        for (wide, high, cut) in [
            (1, 1, false),
            (3, 2, false),
            (17, 13, false),
            (40, 31, false),
            (1, 1, true),
            (17, 13, true),
            (40, 31, true),
        ] {
            let (starts, rows, values) = grid(wide, high);
            let places: Vec<[f64; 2]> = (0..wide * high).map(|k| [k / high, k % high].map(|t| t as f64)).collect();
            let by = if cut { EliminationOrder::NestedDissection(&places) } else { EliminationOrder::MinimumDegree };
            let mut factor = SparseCholesky::plan(&starts, &rows, by).unwrap();
            factor.factor(&values).unwrap();
            let n = wide * high;
            let exact: Vec<f64> = (0..n).map(|k| (0.3 * k as f64).cos()).collect();
            let mut v = multiply(&starts, &rows, &values, &exact);
            factor.solve(&mut v);
            assert!(v.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-13));
            let inverse = SelectedInverse::of(&factor).unwrap();
            let trace = inverse.trace_with(&starts, &rows, &values);
            assert!((trace - n as f64).abs() < 1e-11 * n as f64, "{trace} for {n}");
            for column in (0..n).step_by(7) {
                let mut unit = vec![0.0; n];
                unit[column] = 1.0;
                factor.solve(&mut unit);
                for row in &rows[starts[column]..starts[column + 1]] {
                    let entry = inverse.entry(*row, column).unwrap();
                    assert!((entry - unit[*row]).abs() < 1e-14, "({row}, {column})");
                    assert_eq!(inverse.entry(column, *row), Some(entry));
                }
            }
        }
    }

    #[test]
    fn gradients_solve_what_the_factor_solves() {
        for (wide, high) in [(3, 2), (40, 31), (90, 70)] {
            let (starts, rows, values) = grid(wide, high);
            let places: Vec<[f64; 2]> = (0..wide * high).map(|k| [k / high, k % high].map(|t| t as f64)).collect();
            let mut gradients = EquationSolver::plan(&starts, &rows, &places, 0).unwrap();
            assert!(gradients.whole().is_none());
            gradients.factor(&values).unwrap();
            let exact: Vec<f64> = (0..wide * high).map(|k| (0.3 * k as f64).cos()).collect();
            let mut v = multiply(&starts, &rows, &values, &exact);
            gradients.solve(&mut v);
            assert!(v.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!(EquationSolver::plan(&starts, &rows, &places, usize::MAX).unwrap().whole().is_some());
        }
    }

    /// Loads with the five-point matrix as their covariance, by its factor as a full matrix.
    fn loads_of([starts, rows]: [&[usize]; 2], values: &[f64], draws: usize) -> Vec<Vec<f64>> {
        let n = starts.len() - 1;
        let mut l = vec![0.0; n * n];
        for column in 0..n {
            (starts[column]..starts[column + 1]).for_each(|at| l[column * n + rows[at]] = values[at]);
        }
        for j in 0..n {
            for i in j..n {
                let sum: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                let v = l[i * n + j] - sum;
                l[i * n + j] = if i == j { v.sqrt() } else { v / l[j * n + j] };
            }
        }
        let mut draw = palpate_numeric::draws::Lcg::new(7);
        let load = |_| {
            let e: Vec<f64> = (0..n).map(|_| draw.normal()).collect();
            (0..n).map(|i| (0..=i).map(|k| l[i * n + k] * e[k]).sum()).collect()
        };
        (0..draws).map(load).collect()
    }

    #[test]
    fn drawn_variances_are_those_of_the_inverse_within_their_error() {
        let (wide, high, draws) = (44, 37, 64);
        let (starts, rows, mut values) = grid(wide, high);
        // nearly singular, so that everything reaches far beyond the blocks
        (0..wide * high).for_each(|k| values[starts[k + 1] - 1] = 5.42);
        let places: Vec<[f64; 2]> = (0..wide * high).map(|k| [k / high, k % high].map(|t| t as f64)).collect();
        let solver = |most| {
            let mut solver = EquationSolver::plan(&starts, &rows, &places, most).unwrap();
            solver.factor(&values).unwrap();
            solver
        };
        let loads = || loads_of([&starts, &rows], &values, draws);
        let exact = PointInverse::of(&solver(usize::MAX), Vec::new).unwrap();
        let drawn = PointInverse::of(&solver(0), loads).unwrap();
        assert!(exact.error().is_none() && PointInverse::of(&solver(0), Vec::new).is_none());
        let told = drawn.error().unwrap();
        let (mut squares, mut count) = (0.0, 0.0);
        for k in 0..wide * high - high {
            // a value, and a slope between two that meet
            for gradient in [vec![(k as u32, 1.0)], vec![(k as u32, 1.0), ((k + high) as u32, -1.0)]] {
                let [a, b] = [&exact, &drawn].map(|inverse| inverse.quadratic(&gradient).unwrap());
                squares += ((b / a).sqrt() - 1.0).powi(2);
                count += 1.0;
            }
        }
        let found = (squares / count).sqrt();
        assert!(found < 1.5 * told && told < 0.3 * (0.5 / draws as f64).sqrt(), "{found} where {told} is told");
        let trace = drawn.trace_with(&starts, &rows, &values);
        assert!((trace / (wide * high) as f64 - 1.0).abs() < 0.01, "{trace}");
    }

    #[test]
    fn determinant_and_condition_of_a_diagonal_block() {
        // [4 1; 1 9] has the determinant 35; equilibrated [1 1/6; 1/6 1] with condition 7/5
        let mut factor = SparseCholesky::plan(&[0, 1, 3], &[0, 0, 1], EliminationOrder::MinimumDegree).unwrap();
        factor.factor(&[4.0, 1.0, 9.0]).unwrap();
        assert!((factor.log_determinant() - 35.0_f64.ln()).abs() < 1e-15);
        assert!((factor.condition() - 1.4).abs() < 1e-14);
        assert!(factor.factor_entries() >= 3 && factor.multiply_adds() >= 1.0);
    }

    #[test]
    fn what_is_not_positive_definite_is_named() {
        let mut factor = SparseCholesky::plan(&[0, 1, 3, 4], &[0, 0, 1, 2], EliminationOrder::MinimumDegree).unwrap();
        let refused = factor.factor(&[1.0, 2.0, 1.0, 1.0]).unwrap_err();
        assert!(matches!(refused, HierarchyError::NotPositiveDefinite { unknown: 0 | 1, unknowns: 3 }), "{refused}");
        assert_eq!(factor.factor(&[1.0, 0.0, 1.0, f64::NAN]), Err(HierarchyError::Overflow { unknown: 2 }));
        let empty = HierarchyError::NotPositiveDefinite { unknown: 2, unknowns: 3 };
        assert_eq!(factor.factor(&[1.0, 0.0, 1.0, 0.0]), Err(empty));
    }
}
