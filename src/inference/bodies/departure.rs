//! The departure of a body from its base: a gaussian process over the base's feet or in space, carried by a few places.
//!
//! ```text
//! F(p) = d(p) - f(q) = 0                  the surface; d the distance from the base; q the foot of p, or p itself
//! f(q) = phi(q)' w,   phi(q)' = k(q, c) L^-T,   L L' = k(c, c),   w ~ N(0, tau^2)          k: `departure_kernel`
//! normal grad F / |grad F|         shape operator -T' (hess d - hess f) T / |grad F|, T: two directions across the normal
//! ```
//!
//! Over the feet nothing that lies above another place can be followed, which is why noise is told from shape; derivatives of f count along
//! the base. In space it holds for departures as large as the body, where errors are small beside l. `coordinates` says what else q may
//! be, `kernel_layer` which places c carry it.

use faer::MatMut;

use super::coordinates::{DepartureJet, DepartureOver};
use super::departure_kernel::DepartureKernel;
use super::kernel_layer::KernelLayer;
use crate::primitives::placed::Primitive;
use palpate_numeric::vector::Vector;

/// A process of one length; where it is as large as the body, with a broad one besides, which follows what the base cannot.
#[derive(Debug)]
pub(super) struct DepartureProcess {
    pub(super) over: DepartureOver,
    own: KernelLayer,
    broad: Option<KernelLayer>,
}

impl DepartureProcess {
    pub(super) fn new(
        at: &[Vector],
        over: DepartureOver,
        of: DepartureKernel,
        most: usize,
    ) -> Option<DepartureProcess> {
        Some(DepartureProcess { over, own: KernelLayer::new(at, over, of, most)?, broad: None })
    }

    /// The same with a broad one besides.
    pub(super) fn beside_broad(self, at: &[Vector], of: DepartureKernel, most: usize) -> Option<DepartureProcess> {
        Some(DepartureProcess { broad: Some(KernelLayer::new(at, self.over, of, most)?), ..self })
    }

    pub(super) fn len(&self) -> usize {
        self.layers().map(KernelLayer::len).sum()
    }

    /// Places that carry the process without the broad one.
    pub(super) fn own_len(&self) -> usize {
        self.own.len()
    }

    /// How alike its values are at two places, without the broad one.
    pub(super) fn kernel(&self) -> DepartureKernel {
        self.own.kernel()
    }

    fn layers(&self) -> impl Iterator<Item = &KernelLayer> {
        std::iter::once(&self.own).chain(&self.broad)
    }

    /// `k(q, c)` at a place for all carriers c.
    pub(super) fn values(&self, q: Vector) -> impl Iterator<Item = f64> + '_ {
        self.layers().flat_map(move |layer| layer.values(q))
    }

    /// Derivatives of `k(q, c)` along two directions.
    pub(super) fn slopes(&self, q: Vector, directions: [Vector; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.layers().flat_map(move |layer| layer.slopes(q, directions))
    }

    /// Rows of `k` made rows of `phi = k L^-T`, in place.
    pub(super) fn whiten(&self, mut rows: MatMut<'_, f64>) {
        let mut first = 0;
        for layer in self.layers() {
            layer.whiten(rows.as_mut().subcols_mut(first, layer.len()));
            first += layer.len();
        }
    }

    /// `L^-T w`: the departure is `k(q, c)` times it.
    pub(super) fn coefficients(&self, weights: &[f64]) -> Vec<f64> {
        let mut of_places = weights.to_vec();
        let (own, broad) = of_places.split_at_mut(self.own.len());
        self.own.carry(own);
        if let Some(layer) = &self.broad {
            layer.carry(broad);
        }
        of_places
    }

    /// The departure of such coefficients at a place of the cloud, its gradient and its Hessian.
    pub(super) fn jet_at(&self, coefficients: &[f64], base: &Primitive, place: Vector, foot: Vector) -> DepartureJet {
        let jet = self.jet(coefficients, self.over.coordinates(base, place, foot));
        match self.over {
            DepartureOver::Feet | DepartureOver::Space => jet,
            DepartureOver::Section => jet.turned(base.own(foot)).out_of(base),
            DepartureOver::Turned => jet.turned(base.own(place)).out_of(base),
            DepartureOver::Extruded => jet.extruded().out_of(base),
        }
    }

    /// The same in the coordinates that it is a function of.
    fn jet(&self, coefficients: &[f64], q: Vector) -> DepartureJet {
        let mut jet = DepartureJet { value: 0.0, gradient: [0.0; 3], hessian: [[0.0; 3]; 3] };
        let (own, broad) = coefficients.split_at(self.own.len());
        self.own.add(own, q, &mut jet);
        if let Some(layer) = &self.broad {
            layer.add(broad, q, &mut jet);
        }
        (0..3).for_each(|i| (0..i).for_each(|j| jet.hessian[j][i] = jet.hessian[i][j]));
        jet
    }
}
