//! IGES back: the one polynomial B-spline surface (entity 128) of a file. Units and trimming are not read.

use ndarray::Array2;

use super::cad::CadPatch;

/// Columns of a record.
const RECORD: usize = 80;

/// Whether the bytes begin as an IGES file of 80 columns: the first record ends in S and 1.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let line = bytes.split(|b| *b == b'\n').next().unwrap_or_default().trim_ascii_end();
    line.len() == RECORD && line[RECORD - 8] == b'S' && number(&line[RECORD - 7..]) == Ok(1)
}

/// The spline.
///
/// # Errors
/// What the file holds instead, and what would do.
pub(super) fn read(bytes: &[u8]) -> Result<CadPatch, String> {
    // names may be in any encoding, a letter of which takes one column
    let lines: Vec<&[u8]> = bytes.split(|b| *b == b'\n').map(<[u8]>::trim_ascii_end).collect();
    let of = |letter: u8| lines.iter().filter(move |line| line.len() == RECORD && line[RECORD - 8] == letter);
    let (comma, semicolon) = separators(&of(b'G').flat_map(|line| line[..72].to_vec()).collect::<Vec<u8>>())?;
    let directory: Vec<&&[u8]> = of(b'D').collect();
    let entries: Vec<&[&&[u8]]> = directory.chunks_exact(2).collect();
    let kinds: Vec<usize> = entries.iter().map(|entry| number(&entry[0][..8])).collect::<Result<_, _>>()?;
    let found: Vec<usize> = (0..kinds.len()).filter(|k| kinds[*k] == 128).collect();
    let entry = match found[..] {
        [one] => entries[one],
        [] => return Err(format!("no B-spline surface (entity 128); it holds entities {}", some(&kinds))),
        _ => return Err(format!("{} B-spline surfaces; one is read: export the face of interest alone", found.len())),
    };
    if number(&entry[0][48..56])? != 0 {
        return Err(
            "the surface is moved by a transformation (entity 124), which is not read; export it in place".into()
        );
    }
    let (first, count) = (number(&entry[0][8..16])?, number(&entry[1][24..32])?);
    let text: Vec<u8> =
        of(b'P').skip(first.saturating_sub(1)).take(count).flat_map(|line| line[..64].to_vec()).collect();
    let text = String::from_utf8(text).map_err(|_| "parameters that are no text")?;
    let body = text.split(semicolon).next().unwrap_or_default();
    let values = body.split(comma).map(real).collect::<Result<Vec<f64>, String>>()?;
    patch(&values)
}

fn some(kinds: &[usize]) -> String {
    let mut kinds = kinds.to_vec();
    kinds.sort_unstable();
    kinds.dedup();
    kinds.iter().take(8).map(usize::to_string).collect::<Vec<_>>().join(", ")
}

/// What separates parameters, and what ends them: the first two global fields, `1H,` and `1H;` or nothing.
fn separators(global: &[u8]) -> Result<(char, char), String> {
    let usual = |c: u8| c.is_ascii_graphic() && !c.is_ascii_alphanumeric() && !b"+-.".contains(&c);
    let (comma, rest) = match global {
        [b'1', b'H', c, _, rest @ ..] if usual(*c) => (*c, rest),
        [b',', rest @ ..] => (b',', rest),
        _ => return Err("a global section that does not begin with its separator, as in 1H,".into()),
    };
    let semicolon = match rest {
        [b'1', b'H', c, ..] if usual(*c) => *c,
        _ => b';',
    };
    Ok((comma.into(), semicolon.into()))
}

fn number(field: &[u8]) -> Result<usize, String> {
    let text = String::from_utf8_lossy(field.trim_ascii()).into_owned();
    if text.is_empty() { Ok(0) } else { text.parse().map_err(|_| format!("{text:?} where a whole number stands")) }
}

fn real(field: &str) -> Result<f64, String> {
    let text: String = field.trim().replace(['D', 'd'], "E");
    text.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| {
        format!("{:?} is no number", field.chars().filter(|c| !c.is_control()).take(20).collect::<String>())
    })
}

/// Takes values one after the other.
struct Values<'a>(&'a [f64]);

impl<'a> Values<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [f64], String> {
        if count > self.0.len() {
            return Err(format!("{} parameters where {count} more are needed", self.0.len()));
        }
        let (head, tail) = self.0.split_at(count);
        self.0 = tail;
        Ok(head)
    }
}

/// Largest index or degree: a product of two stays far below overflow.
const LARGEST: f64 = 1e6;

fn patch(values: &[f64]) -> Result<CadPatch, String> {
    let mut values = Values(values);
    let head = values.take(10)?;
    if head.iter().any(|v| v.fract() != 0.0 || !(0.0..=LARGEST).contains(v)) {
        return Err("sizes, degrees and flags are whole numbers of at most a million".into());
    }
    let whole = |k: usize| head[k] as usize;
    let (n, m, p, q) = (whole(1) + 1, whole(2) + 1, whole(3), whole(4));
    let knots = [values.take(n + p + 1)?.to_vec(), values.take(m + q + 1)?.to_vec()];
    let weights = values.take(n * m)?;
    if weights.iter().any(|w| *w != weights[0]) {
        return Err("a rational surface: its weights differ (NURBS), which is not read; export it as a polynomial \
                    B-spline surface"
            .into());
    }
    let points = values.take(3 * n * m)?;
    let at = |(i, j): (usize, usize)| [0, 1, 2].map(|k| points[3 * (j * n + i) + k]);
    Ok(CadPatch { degree: [p, q], knots, points: Array2::from_shape_fn((n, m), at) })
}
