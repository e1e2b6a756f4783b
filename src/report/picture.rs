//! `shape.svg`: S and R over the patch, side by side, with the contacts on them.
//!
//! S runs from blue (cup) over white (saddle) to red (cap), and fades to grey where R is small: on flat ground S is
//! the direction of rounding. R runs from white to dark.

use std::io::Write;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::shape::ShapeMaps;

/// What is drawn besides the maps.
#[derive(Clone, Copy, Debug)]
pub(super) struct PictureOptions<'a> {
    /// Line above the panels.
    pub title: &'a str,
    /// x and y of the contacts, in the coordinates of the maps' grid; drawn where few enough to be told apart.
    pub contacts: Option<(&'a [f64], &'a [f64])>,
    /// What the axes are called: x, y of a height field, u, v of a parametric surface.
    pub axes: [&'a str; 2],
}

impl Default for PictureOptions<'_> {
    fn default() -> Self {
        PictureOptions { title: "", contacts: None, axes: ["x", "y"] }
    }
}

type Drawing<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Panel<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Paint<'a> = dyn Fn(usize, usize) -> Option<RGBColor> + 'a;

/// Pixels of one panel's map along the patch's longer side.
const SIDE: f64 = 360.0;
/// Beyond this many the dots would hide the map.
const DOTS: usize = 3_000;
/// S fades to grey below this part of the largest R.
const FADE: f64 = 0.1;
/// Where nothing is known.
const UNKNOWN: RGBColor = RGBColor(225, 225, 225);

/// Draws S and R as an SVG.
///
/// # Errors
/// What the system says.
pub(super) fn write_picture(maps: &ShapeMaps, options: &PictureOptions, out: &mut dyn Write) -> std::io::Result<()> {
    let mut svg = String::new();
    draw(maps, options, &mut svg).map_err(|e| std::io::Error::other(e.to_string()))?;
    out.write_all(svg.as_bytes())
}

fn draw(maps: &ShapeMaps, options: &PictureOptions, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let edges = [cell_edges(&maps.grid.x), cell_edges(&maps.grid.y)];
    let [width, height] = [&edges[0], &edges[1]].map(|e| e[e.len() - 1] - e[0]);
    let scale = SIDE / width.max(height);
    // a sliver would leave no room for its labels
    let [across, up] = [width, height].map(|side| (side * scale).max(0.2 * SIDE) as u32);
    let panel = (across + 150, up + 70);
    let root = SVGBackend::with_string(svg, (2 * panel.0, panel.1 + 30)).into_drawing_area();
    root.fill(&WHITE)?;
    let (title, body) = root.split_vertically(30);
    title.draw(&Text::new(options.title.to_string(), (12, 8), ("sans-serif", 16)))?;
    let (left, right) = body.split_horizontally(panel.0);

    let largest = largest_curvedness(maps);
    let faded = |i, j| {
        let (s, r) = (maps.shape_index_at(i, j)?, maps.curvedness_at(i, j)?);
        let strength = if largest > 0.0 { (r / (FADE * largest)).min(1.0) } else { 0.0 };
        Some(mix(UNKNOWN, diverging(s), strength))
    };
    let dark = |i, j| maps.curvedness_at(i, j).map(|r| sequential(r / largest.max(f64::MIN_POSITIVE)));
    panel_of(&left, "S, shape index", &edges, &faded, options)?;
    bar_of(&left, panel.1, [-1.0, 1.0], &|t| diverging(2.0 * t - 1.0))?;
    panel_of(&right, "R, curvedness", &edges, &dark, options)?;
    bar_of(&right, panel.1, [0.0, largest], &sequential)?;
    root.present()?;
    Ok(())
}

fn panel_of(
    area: &Drawing,
    caption: &str,
    edges: &[Vec<f64>; 2],
    paint: &Paint,
    options: &PictureOptions,
) -> Result<(), Box<dyn std::error::Error>> {
    let ends = |e: &[f64]| e[0]..e[e.len() - 1];
    let mut chart: Panel = ChartBuilder::on(area)
        .caption(caption, ("sans-serif", 14))
        .margin_left(8)
        .margin_right(90)
        .margin_bottom(4)
        .x_label_area_size(30)
        .y_label_area_size(46)
        .build_cartesian_2d(ends(&edges[0]), ends(&edges[1]))?;
    let cells = (0..edges[0].len() - 1).flat_map(|i| (0..edges[1].len() - 1).map(move |j| (i, j)));
    chart.draw_series(cells.map(|(i, j)| {
        let corners = [(edges[0][i], edges[1][j]), (edges[0][i + 1], edges[1][j + 1])];
        Rectangle::new(corners, paint(i, j).unwrap_or(UNKNOWN).filled())
    }))?;
    if let Some((x, y)) = options.contacts.filter(|(x, _)| x.len() <= DOTS) {
        let radius = if x.len() > 300 { 1 } else { 3 };
        let inside = x.iter().zip(y).filter(|(x, y)| ends(&edges[0]).contains(x) && ends(&edges[1]).contains(y));
        chart.draw_series(inside.map(|(x, y)| Circle::new((*x, *y), radius, BLACK.mix(0.7).filled())))?;
    }
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(options.axes[0])
        .y_desc(options.axes[1])
        .x_labels(5)
        .y_labels(5)
        .draw()?;
    Ok(())
}

/// A colour scale at the panel's right edge, its ends in numbers.
fn bar_of(
    area: &Drawing,
    height: u32,
    ends: [f64; 2],
    colour: &dyn Fn(f64) -> RGBColor,
) -> Result<(), Box<dyn std::error::Error>> {
    const STEPS: i32 = 32;
    let (width, _) = area.dim_in_pixel();
    let (x, top, bottom) = (width as i32 - 80, 30, height as i32 - 40);
    let at = |step: i32| bottom + (top - bottom) * step / STEPS;
    for step in 0..STEPS {
        let fill = colour((f64::from(step) + 0.5) / f64::from(STEPS)).filled();
        area.draw(&Rectangle::new([(x, at(step + 1)), (x + 12, at(step))], fill))?;
    }
    for (part, step) in [(0.0, 0), (0.5, STEPS / 2), (1.0, STEPS)] {
        let value = ends[0] + part * (ends[1] - ends[0]);
        let text = super::table::significant(value, 3);
        area.draw(&Text::new(text, (x + 16, at(step) - 6), ("sans-serif", 11)))?;
    }
    Ok(())
}

/// Edges half way between grid points, so that each point sits in its cell.
fn cell_edges(axis: &[f64]) -> Vec<f64> {
    let n = axis.len();
    if n < 2 {
        let x = axis.first().copied().unwrap_or(0.0);
        return vec![x - 0.5, x + 0.5];
    }
    let mut edges = vec![axis[0] - 0.5 * (axis[1] - axis[0])];
    edges.extend(axis.windows(2).map(|w| 0.5 * (w[0] + w[1])));
    edges.push(axis[n - 1] + 0.5 * (axis[n - 1] - axis[n - 2]));
    edges
}

fn largest_curvedness(maps: &ShapeMaps) -> f64 {
    let known = maps.curvedness.indexed_iter().filter(|((i, j), _)| maps.supported[[*i, *j]]);
    known.map(|(_, r)| *r).fold(0.0, f64::max)
}

/// Blue, white, red over [-1, 1].
fn diverging(s: f64) -> RGBColor {
    const STOPS: [RGBColor; 5] = [
        RGBColor(24, 54, 130),
        RGBColor(92, 150, 214),
        RGBColor(250, 250, 245),
        RGBColor(240, 150, 80),
        RGBColor(158, 24, 32),
    ];
    along(&STOPS, 0.5 * (s + 1.0))
}

/// White to dark green over [0, 1].
fn sequential(t: f64) -> RGBColor {
    const STOPS: [RGBColor; 4] =
        [RGBColor(252, 252, 248), RGBColor(166, 214, 160), RGBColor(40, 130, 110), RGBColor(8, 48, 62)];
    along(&STOPS, t)
}

fn along(stops: &[RGBColor], t: f64) -> RGBColor {
    let last = stops.len() - 1;
    let at = t.clamp(0.0, 1.0) * last as f64;
    let below = (at.floor() as usize).min(last - 1);
    mix(stops[below], stops[below + 1], at - below as f64)
}

fn mix(from: RGBColor, to: RGBColor, part: f64) -> RGBColor {
    let channel = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(channel(from.0, to.0), channel(from.1, to.1), channel(from.2, to.2))
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use crate::bspline::Knots;
    use crate::shape::{ShapeGrid, shape_maps};
    use crate::surface::HeightField;

    /// A groove along y: z = x^2, with one unsupported corner.
    fn groove(points: [usize; 2]) -> ShapeMaps {
        let knots = [Knots::uniform(2, 1, -2.0, 2.0).unwrap(), Knots::uniform(1, 1, 0.0, 3.0).unwrap()];
        let coefficients = Array2::from_shape_vec((3, 2), vec![4.0, 4.0, -4.0, -4.0, 4.0, 4.0]).unwrap();
        let surface = HeightField::new(knots, coefficients).unwrap();
        let mut maps = shape_maps(&surface, ShapeGrid::over([[-2.0, 2.0], [0.0, 3.0]], points, 0.0), &[]);
        maps.supported[[0, 0]] = false;
        maps
    }

    #[test]
    fn every_cell_is_painted_twice_and_every_contact_dotted_twice() {
        let mut svg = Vec::new();
        let contacts = ([0.0, 1.0, 99.0], [1.0, 2.0, 1.0]);
        let options =
            PictureOptions { title: "a groove", contacts: Some((&contacts.0, &contacts.1)), axes: ["u", "v"] };
        write_picture(&groove([9, 7]), &options, &mut svg).unwrap();
        let text = String::from_utf8(svg).unwrap();
        for word in ["a groove", "S, shape index", "R, curvedness", ">\nu\n<", ">\nv\n<"] {
            assert!(text.contains(word), "{word}");
        }
        assert_eq!(text.matches("<circle").count(), 4);
        // background, two panels of cells, two bars of 32 steps
        assert_eq!(text.matches("<rect").count(), 1 + 2 * 63 + 2 * 32);
    }

    #[test]
    fn one_point_and_flat_ground_have_pictures_too() {
        let mut flat = groove([1, 5]);
        flat.curvedness.fill(0.0);
        flat.shape_index.fill(f64::NAN);
        write_picture(&flat, &PictureOptions::default(), &mut Vec::new()).unwrap();
        flat.supported.fill(false);
        write_picture(&flat, &PictureOptions::default(), &mut Vec::new()).unwrap();
    }
}
