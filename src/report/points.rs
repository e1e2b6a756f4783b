//! The surface at the user's own points: `show --at`.

use std::io::Write;

use serde::Serialize;

/// Heights, slopes, normal and shape at one point. Input units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointShape {
    /// As given.
    pub x: f64,
    /// As given.
    pub y: f64,
    /// Whether the point lies in the surface's domain; outside, the end polynomial is shown.
    pub inside: bool,
    /// Height.
    pub z: f64,
    /// dz/dx.
    pub zx: f64,
    /// dz/dy.
    pub zy: f64,
    /// Unit normal to the free side.
    pub normal: [f64; 3],
    /// Larger principal curvature.
    pub k1: Option<f64>,
    /// Smaller principal curvature.
    pub k2: Option<f64>,
    /// Shape index.
    #[serde(rename = "S")]
    pub shape_index: Option<f64>,
    /// Curvedness.
    #[serde(rename = "R")]
    pub curvedness: Option<f64>,
}

/// `x,y,inside,z,zx,zy,nx,ny,nz,k1,k2,S,R`, one row a point, empty where undefined.
///
/// # Errors
/// What the system says.
pub fn write_points_csv(points: &[PointShape], out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from("x,y,inside,z,zx,zy,nx,ny,nz,k1,k2,S,R\n");
    let entry = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for p in points {
        let ([nx, ny, nz], inside) = (p.normal, u8::from(p.inside));
        let [k1, k2, s, r] = [p.k1, p.k2, p.shape_index, p.curvedness].map(entry);
        let row = format!("{},{},{inside},{},{},{},{nx},{ny},{nz},{k1},{k2},{s},{r}\n", p.x, p.y, p.z, p.zx, p.zy);
        text.push_str(&row);
    }
    out.write_all(text.as_bytes())
}
