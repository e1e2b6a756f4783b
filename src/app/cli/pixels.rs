//! The pixels of a grid that are there, as contacts.

use palpate_geometry::contact::{Contacts, Grid};

/// The same with the weights of their heights, where the grid has some.
pub(super) fn weighed_contacts_of(grid: &Grid) -> Contacts {
    let mut contacts = contacts_of(grid);
    contacts.weights.z = grid.wz.as_ref().map(|weights| {
        weights.iter().zip(&grid.z).filter(|(_, height)| height.is_finite()).map(|(weight, _)| *weight).collect()
    });
    contacts
}

/// With slopes where every one of these pixels has them.
pub(super) fn contacts_of(grid: &Grid) -> Contacts {
    let (mut x, mut y, mut z, mut zx, mut zy) = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let slope = |slopes: &Option<ndarray::Array2<f64>>, at: (usize, usize)| slopes.as_ref().map(|s| s[at]);
    for ((i, j), height) in grid.z.indexed_iter().filter(|(_, height)| height.is_finite()) {
        x.push(grid.x[i]);
        y.push(grid.y[j]);
        z.push(*height);
        zx.extend(slope(&grid.zx, (i, j)));
        zy.extend(slope(&grid.zy, (i, j)));
    }
    let whole = zx.len() == x.len() && zy.len() == x.len() && zx.iter().chain(&zy).all(|v| v.is_finite());
    let contacts = Contacts::from_positions(x, y, z);
    if whole { contacts.with_slopes(zx, zy) } else { contacts }
}
