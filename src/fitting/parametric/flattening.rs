//! Parameters (u, v) of the contacts, the result of flattening: by fingers and stations, or from the contacts alone.

/// Parameters of contacts, and which of them are neighbours.
#[derive(Clone, Debug)]
pub(super) struct Flattening {
    /// (u, v) of every contact, input units.
    pub places: Vec<[f64; 2]>,
    /// Periods of closed directions.
    pub period: [Option<f64>; 2],
    /// Triangles of contacts that the support is made of; where there are none, the support is the convex hull.
    pub triangles: Vec<[usize; 3]>,
    /// Name of the method, for the certificate.
    pub method: &'static str,
}
