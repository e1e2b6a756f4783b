//! Sites that can only be visited one by one, for tests: the safe twin of every visit by cells or by rows of a grid.

use palpate_numeric::linalg::{Site, Sites, TensorShape};

/// The same sites without axes and without cells.
pub(super) struct Single<S>(pub(super) S);

impl<S: Sites> Sites for Single<S> {
    fn shape(&self) -> TensorShape {
        self.0.shape()
    }
    fn len(&self) -> usize {
        self.0.len()
    }
    fn visit(&self, f: impl FnMut(&Site)) {
        self.0.visit(f);
    }
}
