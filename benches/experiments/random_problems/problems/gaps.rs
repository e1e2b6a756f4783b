//! The answer to a problem with coefficients that lack data, as the rule for gaps writes it, in 32 digits.
//!
//! ```text
//! [ E_D'E_D  E_D'E_F ] [ c_D ]   [ E_D'b ]
//! [ P_FD     P_FF    ] [ c_F ] = [ 0     ]          F the coefficients that lack data, D the rest, P the roughness
//! ```

use palpate_numeric::linalg::DoubleDouble as Dd;

use super::least_squares::{Rows, dot};
use super::oracle::{Grid, Solved, Written};

impl Written<'_> {
    /// `None` where the system has no answer. The product E'E squares the condition, so half of the 32 digits remain.
    pub(super) fn solve_with_gaps(&self, free: &[usize], grid: &Grid) -> Option<Solved> {
        let unknowns = self.unknowns();
        let data = self.data_rows();
        let mut rough = Rows::new(unknowns);
        self.each_rough_row(|weight, entries| rough.push(weight, entries, Dd::ZERO));
        let mut system: Vec<Vec<Dd>> = (0..unknowns)
            .map(|u| {
                let rows = if free.binary_search(&u).is_ok() { &rough } else { &data };
                let against = rows.columns.iter().map(|column| dot(&rows.columns[u], column));
                against.chain([dot(&rows.columns[u], &rows.rhs)]).collect()
            })
            .collect();
        Some(self.solved(&gauss_jordan(&mut system)?, grid))
    }
}

/// Elimination with row pivots on rows brought to the same size.
fn gauss_jordan(system: &mut [Vec<Dd>]) -> Option<Vec<Dd>> {
    let n = system.len();
    for row in system.iter_mut() {
        let size = row[..n].iter().fold(0.0_f64, |m, v| m.max(v.to_f64().abs()));
        row.iter_mut().for_each(|v| *v = *v / Dd::new(size));
    }
    for k in 0..n {
        let size = |row: usize, system: &[Vec<Dd>]| system[row][k].to_f64().abs();
        let pivot = (k..n).fold(k, |best, r| if size(r, system) > size(best, system) { r } else { best });
        if size(pivot, system).is_nan() || size(pivot, system) == 0.0 {
            return None;
        }
        system.swap(k, pivot);
        let own = system[k].clone();
        for (_, row) in system.iter_mut().enumerate().filter(|(r, _)| *r != k) {
            let share = row[k] / own[k];
            row[k..].iter_mut().zip(&own[k..]).for_each(|(v, &o)| *v = *v - share * o);
        }
    }
    Some((0..n).map(|k| system[k][n] / system[k][k]).collect())
}
