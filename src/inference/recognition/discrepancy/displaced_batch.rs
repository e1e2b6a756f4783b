//! Eight displaced surfaces at once: S, R and both curvatures at points of their common chart.
//!
//! ```text
//! surfaces (k1, k2, A, C, B, c), eight to a pack      points (u, v, basis functions)      kernel: src/numeric/simd/displaced_shapes.rs
//! ```

use palpate_numeric::simd::{ChartBasis, EightShapes, EightSurfaces, Isa, SURFACES, displaced_shapes};

use super::state::{ChartPoint, State};

/// Points at which displaced surfaces are looked at together.
pub(crate) struct Together<'a> {
    points: Vec<ChartBasis<'a>>,
}

impl<'a> Together<'a> {
    /// `None` where one of the points has no basis functions, because nothing can be displaced.
    pub(crate) fn at(points: impl IntoIterator<Item = &'a ChartPoint>) -> Option<Together<'a>> {
        let of = |point: &'a ChartPoint| Some(point.row.as_ref()?.basis(point.chart));
        Some(Together { points: points.into_iter().map(of).collect::<Option<_>>()? })
    }

    /// Hands every pack of at most eight surfaces at all points to `tell`, in order; `None`, before anything is told, where one of the
    /// surfaces is not displaced.
    pub(crate) fn look(&self, surfaces: &[State], mut tell: impl FnMut(&[State], &[EightShapes])) -> Option<()> {
        if surfaces.iter().any(|surface| surface.displaced().is_none()) {
            return None;
        }
        let isa = Isa::for_work(self.points.len() * surfaces.len());
        let mut found = vec![EightShapes::default(); self.points.len()];
        for pack in surfaces.chunks(SURFACES) {
            displaced_shapes(isa, &packed(pack)?, &self.points, &mut found);
            tell(pack, &found);
        }
        Some(())
    }
}

/// Surfaces side by side; the lanes of those that are missing from a short pack hold planes.
fn packed(surfaces: &[State]) -> Option<EightSurfaces> {
    let (_, _, first) = surfaces.first()?.displaced()?;
    let mut out = EightSurfaces {
        curvatures: [[0.0; SURFACES]; 2],
        quadratic: [[0.0; SURFACES]; 3],
        coefficients: vec![[0.0; SURFACES]; first.len()],
    };
    for (lane, surface) in surfaces.iter().enumerate() {
        let ([k1, k2], quadratic, coefficients) = surface.displaced()?;
        (out.curvatures[0][lane], out.curvatures[1][lane]) = (k1, k2);
        out.quadratic.iter_mut().zip(quadratic).for_each(|(all, of)| all[lane] = of);
        out.coefficients.iter_mut().zip(coefficients).for_each(|(all, c)| all[lane] = *c);
    }
    Some(out)
}
