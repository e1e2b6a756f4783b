//! FNV-1a (64 bits) over the little-endian bytes of every double an answer depends on.
//!
//! ```text
//! h <- (h xor byte) * 0x100000001b3,   h0 = 0xcbf29ce484222325
//! ```
//!
//! The order is that of `Case.stream` in `tests/golden/inputs.py`; each list is preceded by its length.

use super::{CaseData, DenseRows, HardCase};
use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, SlopeWeights};
use palpate_geometry::contact::{Contacts, Grid, Orientation};

impl HardCase {
    /// Hash of the inputs' bits, as stored in the golden file.
    pub fn fingerprint(&self) -> u64 {
        let mut stream = Vec::new();
        match &self.data {
            CaseData::Rows(rows) => push_rows(&mut stream, rows),
            CaseData::Contacts(contacts) => {
                push_options(&mut stream, &self.options);
                push_contacts(&mut stream, contacts);
            }
            CaseData::Grid(grid) => {
                push_options(&mut stream, &self.options);
                push_grid(&mut stream, grid);
            }
        }
        fnv1a(&stream)
    }
}

fn fnv1a(stream: &[f64]) -> u64 {
    let bytes = stream.iter().flat_map(|v| v.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

fn push_list(stream: &mut Vec<f64>, list: &[f64]) {
    stream.push(list.len() as f64);
    stream.extend_from_slice(list);
}

fn push_rows(stream: &mut Vec<f64>, rows: &DenseRows) {
    stream.extend([rows.rows.nrows() as f64, rows.rows.ncols() as f64]);
    stream.extend(rows.rows.iter());
    stream.extend(&rows.rhs);
}

fn push_options(stream: &mut Vec<f64>, options: &FitOptions) {
    let counts = [options.degree, options.segments];
    stream.extend(counts.iter().flatten().map(|&v| v as f64));
    for knots in options.knots.iter().flatten() {
        push_list(stream, knots);
    }
    stream.extend(options.domain.iter().flatten());
    match options.objective {
        Objective::Slopes(SlopeWeights::Explicit(weights)) => {
            stream.push(0.0);
            stream.extend(weights);
        }
        Objective::Normals(NormalSigma::Known { z, normal_deg }) => stream.extend([2.0, z, normal_deg]),
        _ => stream.push(1.0), // the tangent preset; the library uses no other
    }
    stream.extend(options.grid.iter().map(|&v| v as f64));
    stream.push(options.inset);
}

fn push_contacts(stream: &mut Vec<f64>, contacts: &Contacts) {
    for column in [&contacts.x, &contacts.y, &contacts.z] {
        push_list(stream, column);
    }
    match &contacts.orientation {
        Orientation::None => {}
        Orientation::Slopes { zx, zy } => [zx, zy].iter().for_each(|c| push_list(stream, c)),
        Orientation::Normals { nx, ny, nz } => [nx, ny, nz].iter().for_each(|c| push_list(stream, c)),
    }
    for weights in [&contacts.weights.z, &contacts.weights.x, &contacts.weights.y] {
        push_list(stream, weights.as_deref().unwrap_or_default());
    }
}

fn push_grid(stream: &mut Vec<f64>, grid: &Grid) {
    push_list(stream, &grid.x);
    push_list(stream, &grid.y);
    push_list(stream, &grid.z.iter().copied().collect::<Vec<f64>>());
    for _ in 0..3 {
        push_list(stream, &[]);
    }
}
