//! The values in columns: what was found, between which bounds the truth lies, what the number means.

use super::super::document::{FitDocument, MeasurePart, ShapePart};
use super::super::percent::percent;
use super::super::radius::radius_bounds;
use super::super::table::{decimals, significant};
use super::super::truth_part::TruthPart;
use super::class::{likelier, radius_of_class};
use super::numbers::{DIGITS, like};
use super::wrap::Labelled;

/// Most decimals beyond those of the value that are spent on telling the ends of an interval apart.
const MOST_MORE: usize = 4;

/// An axis that is known to so many degrees only may run any way.
pub(in crate::report) const OPEN: f64 = 60.0;

/// What S stands for, in one line.
const SCALE: &str = "-1 cup, -0.5 rut, 0 saddle, 0.5 ridge, 1 cap";

/// One line of the table.
#[derive(Default)]
struct Row {
    label: &'static str,
    value: String,
    between: String,
    truth: String,
    meaning: String,
}

impl Row {
    /// The label where lines are short: what stands before its comma.
    fn short(&self) -> &'static str {
        self.label.split(',').next().unwrap_or(self.label)
    }

    fn cells(&self) -> [&str; 5] {
        [self.label, &self.value, &self.between, &self.truth, &self.meaning]
    }
}

/// The table, aligned; with a column of true values in a simulated world. What the numbers mean stands beside them where the
/// lines are long enough, otherwise below.
pub(super) fn table(document: &FitDocument, text: &mut Labelled) {
    let mut rows = rows(document);
    let width = text.width();
    if lines(&rows, document).iter().all(|line| line.chars().count() <= width) {
        return lines(&rows, document).iter().for_each(|line| text.push(line));
    }
    let meanings: Vec<(&str, String)> =
        rows.iter_mut().map(|row| (row.short(), std::mem::take(&mut row.meaning))).collect();
    if lines(&rows, document).iter().any(|line| line.chars().count() > width) {
        rows.iter_mut().for_each(|row| row.label = row.short());
    }
    lines(&rows, document).iter().for_each(|line| text.push(line));
    text.blank();
    meanings.iter().filter(|(_, meaning)| !meaning.is_empty()).for_each(|(label, meaning)| text.add(label, meaning));
}

/// Head and rows.
fn lines(rows: &[Row], document: &FitDocument) -> Vec<String> {
    let some = |pick: fn(&Row) -> &String| rows.iter().any(|row| !pick(row).is_empty());
    let level = document.shape.curvedness.level.filter(|_| some(|row| &row.between));
    let head = level.map_or(String::new(), |level| format!("{} sure to lie between", percent(level)));
    let truth = if some(|row| &row.truth) { "in truth" } else { "" };
    let heads = [["", "value", &head, truth, ""]];
    let all: Vec<[&str; 5]> = heads.into_iter().chain(rows.iter().map(Row::cells)).collect();
    let widths: [usize; 4] =
        std::array::from_fn(|k| all.iter().map(|cells| cells[k].chars().count()).max().unwrap_or(0));
    let filled = all.iter().filter(|cells| cells.iter().any(|cell| !cell.is_empty()));
    filled.map(|cells| aligned(cells, &widths).trim_end().to_string()).collect()
}

/// Cells below each other, three blanks apart; columns that are empty throughout take no room.
fn aligned(cells: &[&str; 5], widths: &[usize; 4]) -> String {
    let mut line = String::new();
    for (k, width) in widths.iter().enumerate().filter(|(_, width)| **width > 0) {
        let gap = width - cells[k].chars().count();
        // values stand to the right, as numbers do
        let [left, right] = if k == 1 { [gap, 0] } else { [0, gap] };
        line.extend([" ".repeat(left), cells[k].to_string(), " ".repeat(right + 3)]);
    }
    line + cells[4]
}

fn rows(document: &FitDocument) -> Vec<Row> {
    let truth = document.truth.as_ref();
    let known = |value: Option<f64>| value.map_or(String::new(), |v| significant(v, DIGITS));
    let mut rows: Vec<Row> = radius(document).into_iter().chain(axis(document)).collect();
    if let Some(truth) = truth {
        rows.iter_mut().for_each(|row| row.truth = true_of(row, truth));
    }
    rows.push(Row { truth: known(truth.and_then(|t| t.shape_index)), ..shape_index(document) });
    rows.push(Row { truth: known(truth.and_then(|t| t.curvedness)), ..curvedness(document) });
    rows
}

/// What is true of a radius or of a direction, in the form of the row.
fn true_of(row: &Row, truth: &TruthPart) -> String {
    let length = |value: f64| significant(value, DIGITS);
    let both = |[small, large]: [f64; 2]| format!("{}, {}", length(small), length(large));
    let found = match row.label {
        "radius" => truth.radius.map(length),
        "radii" => truth.radii.map(both),
        "axis" => truth.axis_deg.map(degrees).or(truth.axis.map(in_space)),
        _ => truth.direction_deg.map(degrees).or(truth.direction.map(in_space)),
    };
    found.unwrap_or_default()
}

/// An angle from x towards y.
fn degrees(angle: f64) -> String {
    format!("{angle:.1} deg")
}

/// A direction in space.
fn in_space([x, y, z]: [f64; 3]) -> String {
    // adding zero takes the sign off a negative one
    let [x, y, z] = [x, y, z].map(|v| (100.0 * v).round() / 100.0 + 0.0);
    format!("{x:.2}, {y:.2}, {z:.2}")
}

fn shape_index(document: &FitDocument) -> Row {
    let shape = &document.shape;
    let meaning = match (shape.shape_index.mean, shape.class.as_deref()) {
        (Some(_), _) => SCALE,
        (None, Some(_)) => "a flat surface has none",
        (None, None) => "not known",
    };
    Row { meaning: meaning.into(), ..measure("S, shape as a number", &shape.shape_index, Some(4)) }
}

fn curvedness(document: &FitDocument) -> Row {
    let shape = &document.shape;
    let label = "R, strength of bend";
    let per = document.unit.as_ref().map_or("per unit of length".into(), |unit| format!("per {unit}"));
    if shape.curvedness.mean.is_none() {
        return Row { label, value: "-".into(), meaning: "not known".into(), ..Row::default() };
    }
    let meaning = match shape.class.as_deref().filter(|_| likelier(shape).is_none()) {
        Some("ridge" | "rut") => format!("{per}; 0.707/radius; 0 is flat"),
        Some("cap" | "cup") => format!("{per}; 1/radius; 0 is flat"),
        _ => format!("{per}; 0 is flat"),
    };
    if let Some(value) = flat_r(shape) {
        let level = shape.curvedness.level.map_or(String::new(), |level| format!("{} sure; ", percent(level)));
        return Row { label, value, meaning: level + &meaning, ..Row::default() };
    }
    Row { meaning, ..measure(label, &shape.curvedness, None) }
}

/// R of a plane, in words: it is zero within its bounds, so that the upper one says all.
pub(in crate::report) fn flat_r(shape: &ShapePart) -> Option<String> {
    let [_, most] = shape.curvedness.interval.filter(|_| shape.class.as_deref() == Some("plane"))?;
    Some(if most > 0.0 { format!("below {}", significant(most, 2)) } else { "0".into() })
}

fn measure(label: &'static str, part: &MeasurePart, places: Option<usize>) -> Row {
    let Some(mean) = part.mean else {
        return Row { label, value: "-".into(), ..Row::default() };
    };
    let between = part.interval.map_or(String::new(), |ends| bounds(mean, places, ends));
    Row { label, value: like(mean, places)(mean), between, ..Row::default() }
}

/// Both ends of an interval, with as many decimals as tell them apart.
fn bounds(mean: f64, places: Option<usize>, [lo, hi]: [f64; 2]) -> String {
    let fewest = places.unwrap_or_else(|| decimals(mean, DIGITS));
    let shown = |places: usize| [lo, hi].map(like(mean, Some(places)));
    let apart = (fewest..fewest + MOST_MORE).map(shown).find(|[lo, hi]| lo != hi);
    let [lo, hi] = apart.unwrap_or_else(|| shown(fewest));
    format!("{lo} and {hi}")
}

fn radius(document: &FitDocument) -> Option<Row> {
    let shape = &document.shape;
    let with_unit = |text: String| document.unit.as_ref().map_or(text.clone(), |unit| format!("{text} {unit}"));
    if let Some([small, large]) = shape.radii {
        let [small, large] = [small, large].map(|radius| significant(radius, DIGITS));
        return Some(Row {
            label: "radii",
            value: with_unit(format!("{small}, {large}")),
            meaning: "across and along".into(),
            ..Row::default()
        });
    }
    let radius = radius_of_class(shape)?;
    let between = match radius_bounds(shape) {
        [Some(lo), Some(hi)] => bounds(radius, None, [lo, hi]),
        [Some(lo), None] => format!("above {}", significant(lo, DIGITS)),
        _ => String::new(),
    };
    let body = if matches!(shape.class.as_deref(), Some("cap" | "cup")) { "ball" } else { "pipe or bar" };
    let meaning = format!("of the {body} that fits best; diameter {}", significant(2.0 * radius, DIGITS));
    Some(Row { label: "radius", value: with_unit(significant(radius, DIGITS)), between, meaning, ..Row::default() })
}

/// Along which direction a ridge or rut runs, or in which direction a saddle rises.
fn axis(document: &FitDocument) -> Option<Row> {
    let shape = &document.shape;
    // where several shapes stand side by side, the axis in the middle is that of no shape
    let hypothesis = document.fit.chosen.as_ref().and_then(|chosen| chosen.hypothesis.as_deref());
    let is_of_all = matches!(hypothesis, Some("surface of revolution" | "extrusion" | "torus" | "cone" | "quadric"));
    if shape.class_by_area.is_some() && !is_of_all {
        return None;
    }
    let saddle = shape.class.as_deref() == Some("saddle") && !is_of_all;
    let (label, angle, vector) =
        if saddle { ("hollow", shape.direction_deg, shape.direction) } else { ("axis", shape.axis_deg, shape.axis) };
    let along = match hypothesis {
        Some("surface of revolution" | "torus" | "cone") => "that it is turned about".into(),
        Some("quadric") => "its longest way".into(),
        Some("extrusion") => "the way along it".into(),
        _ if saddle => "the direction in which it is hollow".into(),
        _ => format!("the way along the {}", shape.class.as_deref().unwrap_or("surface")),
    };
    let within = shape.axis_within_deg.filter(|_| !saddle);
    let between = |said: &dyn Fn(f64) -> String| match within {
        Some(within) if within > OPEN => "any direction".into(),
        Some(within) => said(within),
        None => String::new(),
    };
    if let Some(angle) = angle {
        // ends beyond 0 and 180 are said as they come: -2 and 3 is nearer to what is meant than 178 and 3
        let between = between(&|within| bounds(angle, Some(1), [angle - within, angle + within]));
        let (value, meaning) = (degrees(angle), format!("from x towards y: {along}"));
        return Some(Row { label, value, between, meaning, ..Row::default() });
    }
    let between = between(&|within| format!("within {} deg of it", significant(within, 2)));
    let (value, meaning) = (in_space(vector?), format!("along x, y, z: {along}"));
    Some(Row { label, value, between, meaning, ..Row::default() })
}
