//! What a recognition is given of an input that has weights: it takes every contact as it stands and knows no weights.
//!
//! ```text
//! heights of weight 0            are left out and counted; all of them: there is nothing to recognise
//! other weights that differ      a note says that only a model that is named counts them
//! ```

use std::borrow::Cow;

use crate::io::Input;
use palpate_geometry::contact::{Contacts, Grid};

/// Note where weights are of no effect.
const UNUSED: &str = "the weights of the input (wz, wx, wy) count only for a model that is named, as by --degree 2: \
     here every contact counts the same";

/// The contacts whose heights count, with what is said of the others; `None` where no height counts.
pub(super) fn with_heights(input: &Input) -> Option<(Cow<'_, Input>, Vec<String>)> {
    let (left, away) = match input {
        Input::Contacts(contacts) => without_unmeasured(contacts),
        Input::Grid(grid) => without_unmeasured_pixels(grid),
    };
    if away > 0 && left.as_ref().is_none_or(is_empty) {
        return None;
    }
    let left_out = (away > 0).then(|| format!("{away} heights of weight 0 (wz) are left out"));
    let input = left.map_or(Cow::Borrowed(input), Cow::Owned);
    let unused = has_weights(&input).then(|| UNUSED.to_string());
    Some((input, left_out.into_iter().chain(unused).collect()))
}

/// Whether no height of the contacts was measured, as in a table of places and directions.
pub(super) fn is_without_heights(contacts: &Contacts) -> bool {
    contacts.weights.z.as_ref().is_some_and(|weights| !weights.is_empty() && weights.iter().all(|w| *w == 0.0))
}

fn without_unmeasured(contacts: &Contacts) -> (Option<Input>, usize) {
    let Some(weights) = &contacts.weights.z else { return (None, 0) };
    let kept: Vec<u32> = weights.iter().zip(0..).filter(|(weight, _)| **weight != 0.0).map(|(_, r)| r).collect();
    match weights.len() - kept.len() {
        0 => (None, 0),
        away => (Some(Input::Contacts(contacts.in_order(&kept))), away),
    }
}

fn without_unmeasured_pixels(grid: &Grid) -> (Option<Input>, usize) {
    let Some(weights) = &grid.wz else { return (None, 0) };
    let mut left = grid.clone();
    let mut away = 0;
    for (at, z) in left.z.indexed_iter_mut().filter(|(at, z)| weights.get(*at) == Some(&0.0) && !z.is_nan()) {
        *z = f64::NAN;
        for slope in [&mut left.zx, &mut left.zy].into_iter().flatten().filter_map(|slope| slope.get_mut(at)) {
            *slope = f64::NAN;
        }
        away += 1;
    }
    (Some(Input::Grid(left)).filter(|_| away > 0), away)
}

fn is_empty(input: &Input) -> bool {
    match input {
        Input::Contacts(contacts) => contacts.is_empty(),
        Input::Grid(grid) => grid.z.iter().all(|z| z.is_nan()),
    }
}

/// Whether any block holds weights that differ; alike, they change no answer.
fn has_weights(input: &Input) -> bool {
    fn differ<'a>(weights: impl IntoIterator<Item = &'a f64>) -> bool {
        let mut weights = weights.into_iter().filter(|weight| **weight != 0.0);
        weights.next().is_some_and(|first| weights.any(|weight| weight != first))
    }
    match input {
        Input::Contacts(contacts) => {
            let weights = &contacts.weights;
            [&weights.z, &weights.x, &weights.y].into_iter().flatten().any(differ)
        }
        Input::Grid(grid) => [&grid.wz, &grid.wx, &grid.wy].into_iter().flatten().any(differ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::ContactWeights;

    fn weighed(weights: &[f64]) -> Input {
        let points: Vec<[f64; 3]> = (0..weights.len()).map(|r| [r as f64, 0.0, 1.0]).collect();
        let weights = ContactWeights { z: Some(weights.to_vec()), ..ContactWeights::default() };
        Input::Contacts(Contacts { weights, ..Contacts::from_points(&points) })
    }

    #[test]
    fn what_weighs_nothing_is_left_out_and_what_differs_is_said() {
        let cases: [(&[f64], usize, usize); 4] =
            [(&[1.0, 1.0, 1.0], 3, 0), (&[2.0, 0.0, 2.0], 2, 1), (&[1.0, 2.0, 2.0], 3, 1), (&[0.0, 1.0, 2.0], 2, 2)];
        for (weights, left, said) in cases {
            let input = weighed(weights);
            let (kept, notes) = with_heights(&input).unwrap();
            let Input::Contacts(kept) = kept.as_ref() else { panic!("a grid") };
            assert_eq!((kept.len(), notes.len()), (left, said), "{weights:?}: {notes:?}");
        }
        assert!(with_heights(&weighed(&[0.0, 0.0])).is_none());
    }

    #[test]
    fn pixels_of_weight_zero_are_missing_ones() {
        let axis = vec![0.0, 1.0, 2.0];
        let mut grid = Grid::new(axis.clone(), axis, ndarray::Array2::from_elem((3, 3), 5.0));
        grid.wz = Some(ndarray::Array2::from_shape_fn((3, 3), |(i, _)| if i == 0 { 0.0 } else { 1.0 }));
        let input = Input::Grid(grid);
        let (kept, notes) = with_heights(&input).unwrap();
        let Input::Grid(kept) = kept.as_ref() else { panic!("contacts") };
        assert_eq!(kept.z.iter().filter(|z| z.is_nan()).count(), 3);
        assert_eq!(notes.len(), 1, "{notes:?}");
    }
}
