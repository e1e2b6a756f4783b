//! Which basis functions have data: column i of the observation matrix is empty when no x has `N_i(x) != 0`.

use super::Knots;

/// Basis functions without data. Necessary for full rank, in two dimensions not sufficient: rank comes from the
/// factorisation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Sites on whose segment each basis function lives, one count per basis function.
    pub counts: Vec<usize>,
    /// Basis functions with no site at all.
    pub empty: Vec<usize>,
}

/// Counts, for every basis function, the sites `x` at which it or its slope is not zero.
pub fn coverage(knots: &Knots, x: impl IntoIterator<Item = f64>) -> Coverage {
    let mut counts = vec![0; knots.n_basis()];
    for x in x {
        let row = knots.basis(x);
        for a in 0..=knots.degree() {
            if row.derivative(0)[a] != 0.0 || row.derivative(1)[a] != 0.0 {
                counts[row.first + a] += 1;
            }
        }
    }
    let empty = (0..counts.len()).filter(|&i| counts[i] == 0).collect();
    Coverage { counts, empty }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_the_functions_over_a_gap() {
        let knots = Knots::uniform(2, 6, 0.0, 6.0).unwrap();
        let found = coverage(&knots, [0.2, 0.5, 0.8, 5.1, 5.9]);
        assert_eq!(found.empty, vec![3, 4]);
        assert_eq!(found.counts, vec![3, 3, 3, 0, 0, 2, 2, 2]);
    }
}
