//! Triangle meshes are surfaces. Of a coarse one, what it says of the surface stands between its vertices, and is sampled there; of a
//! fine one the vertices say where the surface lies, and the facets around them which way it faces ([`vertices`]).
//!
//! ```text
//! h = sqrt(area / 2000)                        spacing of 2000 contacts over the whole; small pieces ask for more
//! coarse   a tenth of the area or more lies in facets with an edge longer than 2 h
//! seam     where two facets meet:  flat < 0.1 degrees <= smooth < 40 degrees <= sharp
//!
//! seam smooth, straight on the surface (a generator of a cylinder or cone)    points along it, normal between both
//! seam smooth, bent along itself (a ball, a ring)                             its ends only: the chord lies inside; not at rims
//! face flat                                                                   points within, the face's normal
//! seam sharp or open, corner, apex                                            none: there is no one normal
//! ```
//!
//! A program that draws a cylinder needs vertices on its two rims only, and normals that are means around a vertex lean there
//! over the edge. A scanner's mesh has a vertex wherever it measured. The rule looks at the facets and not at who wrote them: every
//! facet stands for as many contacts as its area holds at the spacing h. Where all facets are small each stands for less than one, and
//! the mesh is fine. The share of a tenth, and not the largest facet, decides, so that a scan with a filled hole stays a scan; 2 h and
//! not h, because triangles of one mesh differ by about that much.
//! More contacts tell an exact surface nothing new and take longer; fewer leave small faces too few.
//!
//! Vertices lie on the surface and facets beside it. The points that are kept lie on the surface, too; how far the facets leave it
//! between them, the sagitta `length^2 k / 8`, is said in a note.

mod faces;
mod joined;
mod normals_of_file;
mod polygon;
mod samples;
mod seams;
mod sectors;
mod straight;
mod vertices;
mod winding;

use std::collections::HashSet;

use palpate_numeric::statistics::upper_median;
use palpate_numeric::vector::{Vector, cross, minus, norm, unit_or_zero};

use super::columns::{COLUMNS, Column, Columns, Need};
use super::place::Unit;
use super::{IoError, ReadOptions, Reading};

pub(super) use polygon::PolygonList;
use samples::FacetSample;

/// Contacts that the whole area holds where no small pieces ask for more: more cost time and tell an exact surface nothing new.
const PLACES: f64 = 2000.0;

/// Edges in units of the spacing from which on a facet is coarse.
const COARSE_EDGE: f64 = 2.0;

/// Edges in units of the median from which on a facet spans what has no vertices.
const BARE_EDGE: f64 = 4.0;

/// Share of the area in coarse facets from which on a mesh is.
const COARSE_SHARE: f64 = 0.1;

/// Fewer triangles enclose nothing, and are no mesh.
const FEWEST_TRIANGLES: usize = 4;

/// Triangles with what is asked of them again and again.
struct Facets {
    places: Vec<Vector>,
    /// Anticlockwise, seen from outside.
    corners: Vec<[usize; 3]>,
    /// Unit normals.
    normals: Vec<Vector>,
    areas: Vec<f64>,
    /// Longest edge of each.
    longest: Vec<f64>,
    /// Size of the whole.
    size: f64,
}

impl Facets {
    /// Triangles without area are left out, and those that stand there already, as on meshes that are drawn from both sides.
    fn of(places: Vec<Vector>, triangles: &[[usize; 3]]) -> Facets {
        let (low, high) = places.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), p| {
            ([0, 1, 2].map(|k| p[k].min(low[k])), [0, 1, 2].map(|k| p[k].max(high[k])))
        });
        let size = norm(minus(high, low));
        let (corners, normals, areas, longest) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut facets = Facets { places, corners, normals, areas, longest, size };
        let mut known = HashSet::with_capacity(triangles.len());
        for &corners in triangles {
            let mut sorted = corners;
            sorted.sort_unstable();
            if !known.insert(sorted) {
                continue;
            }
            let [a, b, c] = corners.map(|v| facets.places[v]);
            let across = cross(minus(b, a), minus(c, a));
            let area = norm(across) / 2.0;
            if area > 0.0 && area.is_finite() {
                let edges = [minus(b, a), minus(c, b), minus(a, c)];
                facets.corners.push(corners);
                facets.normals.push(unit_or_zero(across));
                facets.areas.push(area);
                facets.longest.push(edges.into_iter().map(norm).fold(0.0, f64::max));
            }
        }
        facets
    }

    fn len(&self) -> usize {
        self.corners.len()
    }

    fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// Area that one contact stands for.
    fn area_of_one(&self) -> f64 {
        self.area() / PLACES
    }

    fn is_coarse(&self) -> bool {
        let spacing = self.area_of_one().sqrt();
        let coarse = self.areas.iter().zip(&self.longest).filter(|(_, l)| **l > COARSE_EDGE * spacing);
        coarse.map(|(area, _)| area).sum::<f64>() >= COARSE_SHARE * self.area()
    }

    /// Whether some of the surface has no vertices where the rest has many.
    fn is_bare(&self) -> bool {
        let most = BARE_EDGE * upper_median(self.longest.clone()).unwrap_or(0.0);
        let bare = self.areas.iter().zip(&self.longest).filter(|(_, longest)| **longest > most);
        bare.map(|(area, _)| area).sum::<f64>() >= COARSE_SHARE * self.area()
    }
}

/// Contacts on the facets of a mesh.
pub(super) struct FacetContacts {
    samples: Vec<FacetSample>,
    /// How many of them are vertices.
    vertices: usize,
    /// Some facets meet in a sharp edge.
    has_edges: bool,
    sampling: Sampling,
}

/// How the contacts of a mesh were chosen.
enum Sampling {
    /// Between the vertices, where the facets are at most so far from the surface.
    Between { open: f64 },
    /// At the vertices but those on edges.
    AtVertices { on_edges: usize },
}

/// Contacts on the surface that `triangles` between `places` stand for. `None` where the vertices are to be read as they are: what the
/// mesh has are no facets, or they follow the noise of a scan; it is bent everywhere, and most vertices stand at rims; the file has normals
/// of its own that its facets bear out, and the mesh is fine, or has no edges at which they are means of several faces and no part without
/// vertices.
pub(super) fn sampled(
    places: &[Vector],
    triangles: &[[usize; 3]],
    normals: Option<&[Vector]>,
) -> Option<FacetContacts> {
    let sound = triangles.len() >= FEWEST_TRIANGLES
        && places.iter().flatten().all(|v| v.is_finite())
        && triangles.iter().flatten().all(|&v| v < places.len());
    if !sound {
        return None;
    }
    let facets = Facets::of(places.to_vec(), triangles);
    if facets.len() < FEWEST_TRIANGLES || !facets.size.is_finite() {
        return None;
    }
    let has_normals = normals.is_some_and(|normals| !normals_of_file::are_of_others(&facets, normals));
    if !facets.is_coarse() {
        return if has_normals { None } else { vertices::at_vertices(joined::joined(facets)) };
    }
    let facets = joined::joined(facets);
    let (vertices, is_bare) = (facets.places.len(), facets.is_bare());
    let found = samples::of(facets);
    let enough = found.vertices < found.samples.len() || 2 * found.vertices > vertices;
    (enough && (found.has_edges || is_bare || !has_normals)).then_some(found)
}

/// The same of the polygons of a file whose vertices `columns` holds. Vertices with fingers or weights were touched, and stay contacts.
pub(super) fn sampled_polygons(columns: &Columns, polygons: &PolygonList) -> Option<FacetContacts> {
    let touched = COLUMNS.into_iter().skip_while(|column| *column != Column::Zx).any(|column| columns.has(column));
    let [x, y, z] = [Column::X, Column::Y, Column::Z].map(|column| columns.get(column));
    let (x, y, z) = (x.filter(|_| !touched)?, y?, z?);
    let places: Vec<Vector> = (0..x.len()).map(|row| [x[row], y[row], z[row]]).collect();
    let [nx, ny, nz] = [Column::Nx, Column::Ny, Column::Nz].map(|column| columns.get(column));
    let normals: Option<Vec<Vector>> =
        nx.zip(ny).zip(nz).map(|((nx, ny), nz)| (0..x.len()).map(|row| [nx[row], ny[row], nz[row]]).collect());
    sampled(&places, &polygons.triangles(&places), normals.as_deref())
}

impl FacetContacts {
    /// The contacts of a file in `form`, which a note tells of.
    pub(super) fn into_reading(self, file: &str, form: &str, options: &ReadOptions) -> Result<Reading, IoError> {
        let mut columns = Columns::named(file, &["x", "y", "z", "nx", "ny", "nz"], Need::Contacts)?;
        let of = |value: &dyn Fn(&FacetSample) -> f64| self.samples.iter().map(value).collect::<Vec<f64>>();
        for (k, column) in [Column::X, Column::Y, Column::Z].into_iter().enumerate() {
            columns.set(column, of(&|s| s.place[k]));
        }
        for (k, column) in [Column::Nx, Column::Ny, Column::Nz].into_iter().enumerate() {
            columns.set(column, of(&|s| s.normal[k]));
        }
        let facets = self.samples.iter().map(|s| s.facet).collect();
        let mut reading = columns.into_reading(file, (facets, Unit::Facet), options)?;
        reading.notes.push(self.note(form));
        Ok(reading)
    }

    fn note(&self, form: &str) -> String {
        let places = self.samples.len();
        match self.sampling {
            Sampling::Between { open } => {
                let start = format!("{form}: the mesh is coarse, and its facets are sampled at {places} places");
                if open == 0.0 {
                    return format!("{start}; all its faces are flat");
                }
                format!("{start}; between these the facets lie up to {open:.1e} beside the surface that they stand for")
            }
            Sampling::AtVertices { on_edges } => {
                let start = format!("{form}: the vertices of the mesh have normals from the triangles around each");
                if on_edges == 0 {
                    start
                } else {
                    format!("{start}; {on_edges} on edges have no one normal and are left out")
                }
            }
        }
    }
}
