//! The functions against those of G+Smo (`tests/golden/thb_gismo.py`), which are numbered otherwise.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::HierarchicalField;
use crate::mesh::{CellId, Mesh};
use crate::space::HierarchicalSpace;
use palpate_numeric::bspline::Knots;

/// One hierarchy of the file.
struct Reference {
    degree: usize,
    segments: usize,
    count: usize,
    splits: Vec<CellId>,
    places: Vec<[f64; 2]>,
    /// Values of every function that is seen, place by place.
    values: BTreeMap<usize, Vec<f64>>,
}

fn number<T: std::str::FromStr>(text: &str) -> T {
    text.parse().ok().unwrap()
}

fn references() -> Vec<Reference> {
    let mut found: Vec<Reference> = Vec::new();
    for line in include_str!("../../../tests/golden/thb_gismo.txt").lines() {
        let (kind, rest) = line.split_once(' ').unwrap();
        let words: Vec<&str> = rest.split_whitespace().collect();
        if kind == "hierarchy" {
            let [degree, segments, count] = [0, 1, 2].map(|k| number(words[k]));
            let (splits, places, values) = (Vec::new(), Vec::new(), BTreeMap::new());
            found.push(Reference { degree, segments, count, splits, places, values });
            continue;
        }
        let last = found.last_mut().unwrap();
        if kind == "splits" {
            last.splits.extend(words.iter().map(|word| {
                let parts: Vec<u32> = word.split(',').map(number).collect();
                CellId { level: parts[0] as u8, place: [parts[1], parts[2]] }
            }));
            continue;
        }
        let place = last.places.len();
        last.places.push([number(words[0]), number(words[1])]);
        for word in &words[2..] {
            let (function, value) = word.split_once(':').unwrap();
            last.values.entry(number(function)).or_insert_with(|| vec![0.0; 40])[place] = number(value);
        }
    }
    found
}

#[test]
fn functions_are_those_of_another_program() {
    let references = references();
    assert_eq!(references.len(), 4);
    for reference in references {
        let Reference { degree, segments, count, splits, places, values } = reference;
        let knots = || Knots::uniform(degree, segments, 0.0, 1.0).unwrap();
        let mesh = Mesh::of_splits([knots(), knots()], splits.iter().copied()).unwrap();
        assert_eq!(mesh.splits().count(), splits.len(), "the file names all that are split");
        let space = Arc::new(HierarchicalSpace::new(mesh));
        assert_eq!(space.unknowns(), count);
        let mut ours: Vec<Vec<f64>> = (0..count)
            .map(|k| {
                let mut unit = vec![0.0; count];
                unit[k] = 1.0;
                let field = HierarchicalField::new(space.clone(), unit).unwrap();
                places.iter().map(|[x, y]| field.at(*x, *y).z).collect()
            })
            .collect();
        // some functions are seen from none of the places
        ours.retain(|values| values.iter().any(|v| *v != 0.0));
        assert_eq!(ours.len(), values.len(), "degree {degree}");
        for (function, theirs) in values {
            let far = |mine: &Vec<f64>| mine.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let at = (0..ours.len()).min_by(|a, b| far(&ours[*a]).total_cmp(&far(&ours[*b]))).unwrap();
            assert!(far(&ours[at]) < 1e-14, "degree {degree}, function {function}: {}", far(&ours[at]));
            ours.swap_remove(at);
        }
    }
}
