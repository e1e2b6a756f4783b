//! Random surfaces by their kind: how often their intervals held the truth, how wide they were, and how far the values lay off.
//!
//! ```text
//! inside = sum of intervals that held the truth / sum of those asked        over the surfaces of a kind
//! error of S: value - truth        error of R: (value - truth)/truth        median, and what 90 % of the sizes do not exceed
//! ```

use super::cell::Cell;

/// One quantity over the surfaces of a kind.
pub(crate) struct PooledQuantity {
    pub inside: Option<f64>,
    pub asked: u64,
    /// Median over the surfaces of the half width over the oracle's.
    pub over_oracle: Option<f64>,
    pub median_error: Option<f64>,
    /// What the size of nine errors in ten does not exceed.
    pub of_90_percent: Option<f64>,
}

/// The surfaces of one kind.
pub(crate) struct Pooled {
    pub kind: String,
    pub surfaces: usize,
    /// S and R.
    pub quantities: [PooledQuantity; 2],
    /// Mean probability given to the reported class, and the share in which it is the true one.
    pub class_forecast: Option<[f64; 2]>,
}

impl Pooled {
    fn new(kind: &str, own: &[&Cell]) -> Pooled {
        let quantity = |q: usize| {
            let parts = || own.iter().map(|cell| &cell.quantities[q]);
            let asked: u64 = parts().map(|p| p.chosen.asked).sum();
            let inside: u64 = parts().map(|p| p.chosen.inside).sum();
            let errors: Vec<f64> = parts().flat_map(|p| p.errors.clone()).collect();
            PooledQuantity {
                inside: (asked > 0).then(|| inside as f64 / asked as f64),
                asked,
                over_oracle: quantile(parts().filter_map(|p| p.chosen_over_oracle).collect(), 0.5),
                of_90_percent: quantile(errors.iter().map(|e| e.abs()).collect(), 0.9),
                median_error: quantile(errors, 0.5),
            }
        };
        let forecasts: Vec<[f64; 2]> = own.iter().filter_map(|cell| cell.class_forecast).collect();
        let mean = |k: usize| forecasts.iter().map(|f| f[k]).sum::<f64>() / forecasts.len() as f64;
        Pooled {
            kind: kind.into(),
            surfaces: own.len(),
            quantities: [0, 1].map(quantity),
            class_forecast: (!forecasts.is_empty()).then(|| [mean(0), mean(1)]),
        }
    }
}

/// The smallest value that a part `p` of the values does not exceed.
fn quantile(mut values: Vec<f64>, p: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let rank = (p * values.len() as f64).ceil() as usize;
    values.get(rank.saturating_sub(1)).copied()
}

/// Kind of a random surface: its name up to the first dash.
fn kind_of(cell: &Cell) -> &str {
    cell.scene.split('-').next().unwrap_or_default()
}

/// The kinds in order of their names, and all surfaces.
pub(crate) fn pooled(cells: &[Cell]) -> Vec<Pooled> {
    let mut kinds: Vec<&str> = cells.iter().map(kind_of).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let of_kind = |kind: &str| Pooled::new(kind, &cells.iter().filter(|c| kind_of(c) == kind).collect::<Vec<_>>());
    let all = Pooled::new("all", &cells.iter().collect::<Vec<_>>());
    kinds.into_iter().map(of_kind).chain([all]).collect()
}
