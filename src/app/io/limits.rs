//! What is too large to be meant: refused where it is typed or read, before memory is asked for.

/// Most segments of a surface, both directions multiplied. As many unknowns take gigabytes to factor.
pub(crate) const MOST_SEGMENTS: usize = 512 * 512;
/// Most points of a shape grid. Its maps as CSV take some 800 MB.
pub(crate) const MOST_GRID_POINTS: usize = 2000 * 2000;

/// Whether `n x m` is more than `most`.
pub(crate) fn exceeds([n, m]: [usize; 2], most: usize) -> bool {
    n.checked_mul(m).is_none_or(|product| product > most)
}
