//! IGES: rational B-spline surfaces (entity 128) whose weights are all 1, in records of 80 columns.
//!
//! ```text
//! S start, G global, D directory (two records an entity), P parameters (64 columns and the entity's number), T terminate
//! 128, K1, K2, M1, M2, closed u, closed v, polynomial, periodic u, periodic v, knots u, knots v, weights, points, u0, u1, v0, v1
//! ```
//!
//! Numbers have as many digits as read back to the same bits. The first index of points runs fastest.

use super::cad::CadPatch;

/// Columns of text in a record, before its letter and number.
const TEXT: usize = 72;
/// Columns of parameters, before the number of their entity.
const PARAMETERS: usize = 64;

/// The whole file.
pub(super) fn write(patches: &[CadPatch], title: &str) -> String {
    let title: String = title.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
    let (mut directory, mut parameters) = (Vec::new(), Vec::new());
    for patch in patches {
        let entity = directory.len() + 1;
        let first = (parameters.len() + 1).to_string();
        let own = lines(&parameter_fields(patch), PARAMETERS);
        let count = own.len().to_string();
        directory.push(["128", &first, "0", "0", "0", "0", "0", "0", "00000000"].map(in_field).concat());
        directory.push(["128", "0", "0", &count, "0", "", "", "SURFACE", "0"].map(in_field).concat());
        parameters.extend(own.into_iter().map(|line| format!("{line:<64}{entity:>8}")));
    }
    let mut out = String::new();
    let start = ["spline surface fitted to contacts, written by palpate".to_string()];
    let global = lines(&global_fields(patches, &title), TEXT);
    let mut counts = String::new();
    for (letter, section) in [('S', &start[..]), ('G', &global), ('D', &directory), ('P', &parameters)] {
        for (number, line) in section.iter().enumerate() {
            out.push_str(&format!("{line:<TEXT$}{letter}{:>7}\n", number + 1));
        }
        counts.push_str(&format!("{letter}{:>7}", section.len()));
    }
    out + &format!("{counts:<TEXT$}T{:>7}\n", 1)
}

/// A field of the directory.
fn in_field(field: &str) -> String {
    format!("{field:>8}")
}

/// Fields in lines of at most `width` columns, with commas between and a semicolon at the end. A field is never cut, except
/// for text that is longer than a line.
fn lines(fields: &[String], width: usize) -> Vec<String> {
    let mut out = vec![String::new()];
    for (k, field) in fields.iter().enumerate() {
        let mark = if k + 1 == fields.len() { ';' } else { ',' };
        let mut rest = format!("{field}{mark}");
        let room = width - out.last().map_or(0, String::len);
        if rest.len() > room && rest.len() <= width {
            out.push(String::new());
        }
        while !rest.is_empty() {
            let room = width - out.last().map_or(0, String::len);
            if room == 0 {
                out.push(String::new());
                continue;
            }
            // fields are ASCII
            let cut = rest.split_off(rest.len().min(room));
            if let Some(line) = out.last_mut() {
                line.push_str(&rest);
            }
            rest = cut;
        }
    }
    out
}

/// Text as IGES counts it.
fn text(words: &str) -> String {
    format!("{}H{words}", words.len())
}

fn global_fields(patches: &[CadPatch], title: &str) -> Vec<String> {
    let program = format!("palpate {}", env!("CARGO_PKG_VERSION"));
    let largest = patches.iter().flat_map(|patch| &patch.points).flatten().map(|v| v.abs()).fold(0.0, f64::max);
    let name = if title.is_empty() { "surface" } else { title };
    // no clock is read: the same surface gives the same file
    let date = text("19700101.000000");
    [
        text(","),
        text(";"),
        text(name),
        text("surface.igs"),
        text(&program),
        text(&program),
        "32".into(),
        "38".into(),
        "6".into(),
        "308".into(),
        "15".into(),
        text(name),
        "1.".into(),
        "2".into(),
        text("MM"),
        "1".into(),
        "0.01".into(),
        date.clone(),
        "1.E-7".into(),
        real(largest),
        text("palpate"),
        text("palpate"),
        "11".into(),
        "0".into(),
        date,
    ]
    .to_vec()
}

fn parameter_fields(patch: &CadPatch) -> Vec<String> {
    let (n, m) = patch.points.dim();
    let [p, q] = patch.degree;
    let whole = [128, n - 1, m - 1, p, q, 0, 0, 1, 0, 0];
    let mut fields: Vec<String> = whole.iter().map(usize::to_string).collect();
    fields.extend(patch.knots.iter().flatten().map(|t| real(*t)));
    fields.extend(std::iter::repeat_n("1.".to_string(), n * m));
    for j in 0..m {
        fields.extend((0..n).flat_map(|i| patch.points[[i, j]]).map(real));
    }
    for (knots, degree) in patch.knots.iter().zip(patch.degree) {
        fields.extend([knots[degree], knots[knots.len() - 1 - degree]].map(real));
    }
    fields
}

/// A number of double precision: a decimal point always, `D` before the exponent.
fn real(value: f64) -> String {
    super::step_writer::real(value).replace('E', "D")
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn records_have_eighty_columns_and_the_numbers_that_the_last_one_says() {
        let points = Array2::from_shape_fn((2, 2), |(i, j)| [i as f64 / 3.0, j as f64, -1e-300]);
        let knots = [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
        let text = write(&[CadPatch { degree: [1, 1], knots, points }], "a title of no length to speak of; or,");
        assert!(text.lines().all(|line| line.len() == 80), "{text}");
        let count = |letter: char| text.lines().filter(|line| line.as_bytes()[72] == letter as u8).count();
        let last = text.lines().last().unwrap();
        let expected = format!("S{:>7}G{:>7}D{:>7}P{:>7}", count('S'), count('G'), 2, count('P'));
        assert!(last.starts_with(&expected), "{last}");
    }
}
