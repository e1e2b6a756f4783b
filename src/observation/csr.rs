//! The weighted observation matrix written out, for interchange and as the oracle of every structured route.

use nalgebra_sparse::{CooMatrix, CsrMatrix};

use crate::linalg::{RowWeights, Sites};

/// E in compressed rows: row `3 r + k` is row k (value, first slope, second slope) of site r. Structural zeros of a
/// site's (p + 1)(q + 1) entries are kept, rows of weight zero are empty.
pub fn to_csr(sites: &impl Sites, row_weights: &RowWeights) -> CsrMatrix<f64> {
    let shape = sites.shape();
    let mut triplets = CooMatrix::new(3 * sites.len(), shape.unknowns());
    sites.visit(|site| {
        let m = row_weights.at(site.index);
        for a in 0..site.x.len() {
            for b in 0..site.y.len() {
                let column = (site.first[0] + a) * shape.basis[1] + site.first[1] + b;
                let entries = [
                    m.z * site.x[a] * site.y[b],
                    m.a * site.dx[a] * site.y[b] + m.b * site.x[a] * site.dy[b],
                    m.d * site.x[a] * site.dy[b],
                ];
                let live = [m.z != 0.0, m.a != 0.0 || m.b != 0.0, m.d != 0.0];
                for k in 0..3 {
                    if live[k] {
                        triplets.push(3 * site.index + k, column, entries[k]);
                    }
                }
            }
        }
    });
    CsrMatrix::from(&triplets)
}
