//! Normals on one side: those of a smooth piece agree with their neighbours, whichever way the file wrote them.
//!
//! ```text
//! pieces: contacts linked to neighbours with |n_i . n_j| > 0.7        within a piece n_j <- sign(n_i . n_j) n_j
//! the sign of a piece: that of most of its normals in the file
//! ```
//!
//! Signs are not carried across edges: there the normals are at right angles and tell nothing of each other.

use std::collections::VecDeque;

use super::error::PartsError;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, dot, scaled};

/// Cosine from which on two normals are thought to belong to one smooth piece: 45 degrees.
const PARALLEL: f64 = 0.7;

/// Share of nearest neighbours that are parallel, below which the normals are none. Random directions have 0.3.
const CONSISTENT: f64 = 0.5;

/// Neighbours that a normal is compared with.
const NEAREST: usize = 8;

/// Turns the normals that contradict their neighbours; how many those were.
pub(super) fn one_side(points: &[Vector], normals: &mut [Vector]) -> Result<usize, PartsError> {
    let tree = Neighbours::new(points);
    let links = threads::map(points.len(), 256, |i| {
        let found = tree.nearest(points[i], NEAREST + 1);
        found.iter().map(|(_, j)| *j).filter(|j| *j as usize != i).collect::<Vec<u32>>()
    });
    let cosine = |i: usize, j: u32| dot(normals[i], normals[j as usize]);
    let nearest = || (0..points.len()).filter_map(|i| links[i].first().map(|j| cosine(i, *j)));
    let parallel = nearest().filter(|c| c.abs() > PARALLEL).count() as f64 / nearest().count().max(1) as f64;
    if parallel < CONSISTENT {
        return Err(PartsError::Normals { percent: 100.0 * parallel });
    }
    if nearest().all(|c| c > -PARALLEL) {
        return Ok(0);
    }
    let mut visited = vec![false; points.len()];
    let mut turned = 0;
    for root in 0..points.len() {
        if visited[root] {
            continue;
        }
        visited[root] = true;
        let mut piece = vec![(root as u32, false)];
        let mut queue = VecDeque::from([(root as u32, false)]);
        while let Some((i, is_turned)) = queue.pop_front() {
            for &j in &links[i as usize] {
                let cosine = dot(normals[i as usize], normals[j as usize]);
                if !visited[j as usize] && cosine.abs() > PARALLEL {
                    visited[j as usize] = true;
                    let turned = is_turned != (cosine < 0.0);
                    piece.push((j, turned));
                    queue.push_back((j, turned));
                }
            }
        }
        let against = piece.iter().filter(|(_, is_turned)| *is_turned).count();
        let minority = 2 * against <= piece.len();
        for (i, _) in piece.iter().filter(|(_, is_turned)| *is_turned == minority) {
            normals[*i as usize] = scaled(-1.0, normals[*i as usize]);
            turned += 1;
        }
    }
    Ok(turned)
}
