//! The two colour scales of pages and pictures, both told apart by people who see no red or green.
//!
//! ```text
//! S        blue (cup) - pale (saddle) - red (cap)       fades to grey where R is small: there S is rounding
//! R, u     viridis (S. van der Walt, N. Smith, 2015)    dark to light in even steps
//! ```

/// Red, green, blue.
pub(super) type Colour = [u8; 3];

/// Stops of the scale of S, from -1 to 1.
pub(super) const DIVERGING: [Colour; 7] =
    [[24, 54, 130], [58, 110, 184], [140, 182, 222], [238, 236, 228], [240, 170, 116], [208, 92, 60], [142, 24, 36]];

/// Stops of viridis, from the least to the largest.
pub(super) const VIRIDIS: [Colour; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 73, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [110, 206, 88],
    [181, 222, 43],
    [253, 231, 37],
];

/// Where S says nothing.
pub(super) const FAINT: Colour = [176, 176, 176];

/// S fades to grey below this part of the largest R.
pub(super) const FADE: f64 = 0.1;

/// The colour at `t` from 0 to 1 along the stops.
pub(super) fn along(stops: &[Colour], t: f64) -> Colour {
    let last = stops.len() - 1;
    let at = t.clamp(0.0, 1.0) * last as f64;
    let below = (at.floor() as usize).min(last - 1);
    mix(stops[below], stops[below + 1], at - below as f64)
}

/// `part` of the way from one colour to another.
pub(super) fn mix(from: Colour, to: Colour, part: f64) -> Colour {
    [0, 1, 2].map(|k| (f64::from(from[k]) + part * (f64::from(to[k]) - f64::from(from[k]))).round() as u8)
}

/// As CSS has it.
pub(super) fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A quantity over the mesh with its ends and its stops.
#[derive(Clone, Debug)]
pub(super) struct Field<'a> {
    /// Key in the page's data.
    pub key: &'static str,
    /// What it is called, with its unit.
    pub name: String,
    /// Values; NaN where there is none.
    pub values: &'a [f64],
    /// Ends of the scale.
    pub ends: [f64; 2],
    /// Colours from end to end.
    pub stops: &'static [Colour],
    /// R and its largest value, by which S fades.
    pub fading: Option<(&'a [f64], f64)>,
}

impl Field<'_> {
    /// Colour of point `k`; `None` where there is no value.
    pub(super) fn colour(&self, k: usize) -> Option<Colour> {
        let value = self.values.get(k).copied().filter(|v| v.is_finite())?;
        let [lo, hi] = self.ends;
        let full = along(self.stops, (value - lo) / (hi - lo));
        let Some((curvedness, largest)) = self.fading else { return Some(full) };
        let strength = if largest > 0.0 { (curvedness[k] / (FADE * largest)).min(1.0) } else { 0.0 };
        Some(mix(FAINT, full, strength))
    }
}

/// Ends of a scale that holds the values, and is never so narrow that rounding is shown as a pattern.
pub(super) fn ends(values: &[f64]) -> [f64; 2] {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    if lo > hi || (lo == 0.0 && hi == 0.0) {
        return [0.0, 1.0];
    }
    // a tenth of the size
    let least = 0.1 * lo.abs().max(hi.abs()).max(f64::MIN_POSITIVE);
    if hi - lo >= least {
        return [lo, hi];
    }
    let middle = 0.5 * (lo + hi);
    let lower = middle - 0.5 * least;
    if lo >= 0.0 && lower < 0.0 { [0.0, least] } else { [lower, lower + least] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_no_pattern_and_both_ends_are_the_stops() {
        let [lo, hi] = ends(&[1.0, 1.0 + 1e-12, f64::NAN]);
        assert!((hi - lo - 0.1).abs() < 1e-9 && lo < 1.0 && hi > 1.0);
        assert_eq!(ends(&[]), [0.0, 1.0]);
        assert_eq!(ends(&[0.0, 3.0]), [0.0, 3.0]);
        assert_eq!((along(&VIRIDIS, -1.0), along(&VIRIDIS, 2.0)), (VIRIDIS[0], VIRIDIS[9]));
        assert_eq!(hex(mix([0, 0, 0], [255, 255, 255], 0.5)), "#808080");
    }
}
