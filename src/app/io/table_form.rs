//! How a text table is laid out: its separator, where its names stand, and where its rows begin.
//!
//! ```text
//! x,y,z            //X Y Z          12            1.5 2.5 3.5          x;y;z
//! 1,2,3            1 2 3            1 2 3 77      4.5 5.5 6.5          1,5;2,5;3,5
//! names            names in a       PTS: a count  no names: by the     decimal commas
//!                  comment          and no names  count of columns
//! ```
//!
//! A first line `sep=;`, as spreadsheets write and want it, names the separator. Otherwise it is the one that makes the most sense of the line with the names: most columns that palpate knows, then
//! the order comma, semicolon, tab, blank. Numbers may have a decimal comma wherever the comma does not separate.
//!
//! A count of rows, alone in its line, may stand before the names, after them, or before rows without names. Below the names
//! may stand a row of units (`mm,mm,mm`).

use std::borrow::Cow;

use super::columns::{Column, Need};
use super::names::ColumnNames;
use super::separator::{SEPARATORS, Separator, declared_separator};
use super::{IoError, names};

/// The layout of one table.
#[derive(Debug)]
pub(super) struct TableForm {
    pub(super) separator: Separator,
    /// In our words, as [`names::in_our_words`] has them.
    pub(super) names: Vec<String>,
    /// As they stand in the file.
    pub(super) titles: Vec<String>,
    /// Unit of length of the places, from their names or from the row of units below them.
    pub(super) unit: Option<String>,
    /// Index (from 0) of the line of the first row.
    pub(super) first_row: usize,
    /// What was assumed because nothing said it.
    pub(super) note: Option<String>,
}

/// A line that is no row: empty or a comment.
pub(super) fn is_aside(line: &str) -> bool {
    line.is_empty() || line.starts_with('#') || line.starts_with("//")
}

/// Finds the layout of the table in `text`; `ending` is the file name's, in lower case.
///
/// # Errors
/// [`IoError::Empty`] and [`IoError::NoHeader`].
pub(super) fn table_form(
    file: &str,
    text: &str,
    ending: &str,
    need: Need,
    said: Option<&ColumnNames>,
) -> Result<TableForm, IoError> {
    let lines = || text.split('\n').map(str::trim).enumerate();
    let mut rows = lines().filter(|(_, line)| !is_aside(line)).peekable();
    let empty = || IoError::Empty { file: file.into() };
    let (mut at, mut first) = rows.next().ok_or_else(empty)?;
    let declared = declared_separator(first);
    if declared.is_some() {
        (at, first) = rows.next().ok_or_else(empty)?;
    }
    if is_count(first)
        && let Some((next_at, next)) = rows.next_if(|(_, line)| !is_count(line))
    {
        (at, first) = (next_at, next);
    }
    /// Longest line of names: room for a hundred thousand columns.
    const MOST_LINE: usize = 1 << 20;
    if first.len() > MOST_LINE {
        return Err(no_header(file, at + 1, first));
    }
    if let Some(named) = names_in_line(file, first, declared.as_slice(), said)? {
        let several = named.names.len() > 1;
        let below = rows.next_if(|(_, line)| several && units_in_row(&named, line).is_some());
        let units = below.and_then(|(_, line)| units_in_row(&named, line)).unwrap_or_default();
        let counted = rows.next_if(|(_, line)| several && is_count(line));
        let first_row = counted.or(below).map_or(at, |(last, _)| last) + 1;
        let unit = unit_of_places(file, &named, &units)?;
        return Ok(TableForm { first_row, unit, ..named });
    }
    if declared.is_some() {
        return Err(no_header(file, at + 1, first));
    }
    // a number stands where names should be
    let asides: Vec<&str> =
        lines().take(at).map(|(_, line)| line).filter(|line| is_aside(line) && !line.is_empty()).collect();
    /// Comments in which names are looked for, from the last one up.
    const MOST_ASIDES: usize = 9;
    if let Some(form) = asides.iter().rev().take(MOST_ASIDES).find_map(|aside| named_by_aside(file, aside, first, said))
    {
        return Ok(TableForm { first_row: at, ..form });
    }
    let may_be_bare = need == Need::Contacts && ["xyz", "xyzn", "pts", "txt", "asc"].contains(&ending);
    let second = rows.peek().map(|(_, line)| *line);
    match may_be_bare.then(|| without_names(first, second, ending)).flatten() {
        Some(form) => Ok(TableForm { first_row: at, ..form }),
        None => Err(no_header(file, at + 1, first)),
    }
}

/// A whole number alone in its line.
pub(super) fn is_count(line: &str) -> bool {
    line.parse::<u64>().is_ok()
}

fn no_header(file: &str, line: usize, header: &str) -> IoError {
    /// Enough of a line to recognise it by.
    const SHOWN: usize = 60;
    let text = header.chars().take(SHOWN).collect();
    IoError::NoHeader { file: file.into(), line, text, example: "x,y,z,nx,ny,nz" }
}

/// The names in a line and what separates them, one of `declared` where there is any; `None` where the line holds a number.
pub(super) fn names_in_line(
    file: &str,
    line: &str,
    declared: &[Separator],
    said: Option<&ColumnNames>,
) -> Result<Option<TableForm>, IoError> {
    let mut best: Option<(usize, TableForm)> = None;
    for &separator in if declared.is_empty() { &SEPARATORS[..] } else { declared } {
        let fields = separator.fields(line);
        let fields: Vec<&str> = fields.iter().map(Cow::as_ref).collect();
        let found = names::in_our_words(file, &fields, said);
        let known = found.iter().flatten().filter(|name| Column::of(name).is_some()).count();
        // of two that know nothing, the one that divides the line
        let better = best
            .as_ref()
            .is_none_or(|(most, form)| known > *most || (*most == 0 && form.names.len() == 1 && fields.len() > 1));
        if better {
            let names = found?.into_iter().map(Cow::into_owned).collect();
            let titles = fields.iter().map(|title| title.trim().to_string()).collect();
            best = Some((known, TableForm { separator, names, titles, unit: None, first_row: 0, note: None }));
        }
    }
    Ok(best.map(|(_, form)| form).filter(|form| {
        let number = |name: &String| form.separator.number(name).is_some_and(f64::is_finite);
        !form.names.iter().any(number)
    }))
}

/// The units of a row below the names: words for every field, of which at least one is a unit of length.
pub(super) fn units_in_row(named: &TableForm, line: &str) -> Option<Vec<Option<&'static str>>> {
    let fields = named.separator.fields(line);
    let number = |field: &Cow<str>| named.separator.number(field.trim()).is_some();
    let units: Vec<Option<&str>> = fields.iter().map(|field| names::unit_of_length(field)).collect();
    let is_row = fields.len() == named.names.len() && units.iter().any(Option::is_some);
    (is_row && !fields.iter().any(number)).then_some(units)
}

/// The unit of length of x, y and z, by their names and by the row below them.
fn unit_of_places(file: &str, named: &TableForm, below: &[Option<&'static str>]) -> Result<Option<String>, IoError> {
    let is_place = |name: &String| ["x", "y", "z"].contains(&name.as_str());
    let places = named.names.iter().zip(&named.titles).enumerate().filter(|(_, (name, _))| is_place(name));
    let units = places.map(|(k, (_, title))| {
        (title.as_str(), names::unit_of_name(title).or_else(|| below.get(k).copied().flatten()))
    });
    names::unit_in(file, units)
}

/// The layout where the comment `aside` names the fields of `row`, as CloudCompare and others write it.
fn named_by_aside(file: &str, aside: &str, row: &str, said: Option<&ColumnNames>) -> Option<TableForm> {
    let inner = aside.trim_start_matches(['#', '/']).trim();
    let form = names_in_line(file, inner, &[], said).ok()??;
    let separator = SEPARATORS.into_iter().find(|separator| {
        let fields = separator.fields(row);
        fields.len() == form.names.len() && fields.iter().all(|f| separator.number(f).is_some())
    })?;
    let has = |column: &str| form.names.iter().any(|name| name == column);
    let unit = unit_of_places(file, &form, &[]).ok()?;
    (has("x") && has("y")).then_some(TableForm { separator, unit, ..form })
}

/// The layout of a table without names, by the numbers in its first row, and by the next where these may be numbers of points.
fn without_names(row: &str, next: Option<&str>, ending: &str) -> Option<TableForm> {
    let (separator, values) = SEPARATORS.into_iter().find_map(|separator| {
        let values: Option<Vec<f64>> = separator.fields(row).iter().map(|f| separator.number(f)).collect();
        values.filter(|v| v.len() >= 3).map(|v| (separator, v))
    })?;
    let colour = |v: &f64| v.fract() == 0.0 && (0.0..=255.0).contains(v);
    let length = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    /// A normal of a file that has rounded it, and no triple of other numbers.
    const UNIT: std::ops::RangeInclusive<f64> = 0.9..=1.1;
    let (names, words) = match (values.len(), ending) {
        (3, _) => ("x,y,z", "x,y,z"),
        (6, _) if UNIT.contains(&length(&values[3..])) => ("x,y,z,nx,ny,nz", "x,y,z,nx,ny,nz"),
        (6, _) if values[3..].iter().all(colour) => ("x,y,z,red,green,blue", "x,y,z and a colour"),
        (7, _) if ending != "pts" && values[3..6].iter().all(colour) => {
            ("x,y,z,red,green,blue,scalar", "x,y,z, a colour and a number")
        }
        (4, _) if ending != "pts" && are_numbered(row, next, separator) => {
            ("number,x,y,z", "the number of a point and x,y,z")
        }
        (4, "pts") => ("x,y,z,intensity", "x,y,z and an intensity"),
        (7, "pts") => ("x,y,z,intensity,red,green,blue", "x,y,z, an intensity and a colour"),
        _ => return None,
    };
    let note = format!("no header: the {} columns are taken as {words}", values.len());
    let names: Vec<String> = names.split(',').map(String::from).collect();
    Some(TableForm { separator, titles: names.clone(), names, unit: None, first_row: 0, note: Some(note) })
}

/// Whether two rows begin with the numbers of points, as surveyors write them: whole, without a point, and growing.
fn are_numbered(row: &str, next: Option<&str>, separator: Separator) -> bool {
    let number = |row: &str| separator.fields(row).first().and_then(|field| field.trim().parse::<u64>().ok());
    let [first, second] = [Some(row), next].map(|row| row.and_then(number));
    first.zip(second).is_some_and(|(first, second)| first < second)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(text: &str, ending: &str) -> TableForm {
        table_form("f", text, ending, Need::Contacts, None).unwrap()
    }

    #[test]
    fn separators_are_found() {
        let cases = [
            ("x,y,z\n", Separator::Comma),
            ("x; y; z\n", Separator::Semicolon),
            ("X\tY\tZ\n", Separator::Tab),
            ("x y   z\n", Separator::Blank),
            ("x, y, z\n", Separator::Comma),
            ("x [mm];y [mm];z [mm]\n", Separator::Semicolon),
            ("//X Y Z\n1 2 3\n", Separator::Blank),
            ("# x y z\n1;2;3\n", Separator::Semicolon),
        ];
        for (text, separator) in cases {
            let form = form(text, "csv");
            assert_eq!((form.separator, form.names.join(",")), (separator, "x,y,z".to_string()), "{text:?}");
        }
    }

    #[test]
    fn a_spreadsheet_may_name_its_separator() {
        for (text, separator) in [
            ("sep=;\r\nx;y;z\n", Separator::Semicolon),
            ("\"SEP=,\"\nx,y,z\n", Separator::Comma),
            ("sep=\t\nx\ty\tz\n", Separator::Tab),
        ] {
            let form = form(text, "csv");
            assert_eq!(
                (form.separator, form.names.join(","), form.first_row),
                (separator, "x,y,z".into(), 2),
                "{text:?}"
            );
        }
        let numbers = table_form("f", "sep=;\n1;2;3\n", "xyz", Need::Contacts, None);
        assert!(matches!(numbers, Err(IoError::NoHeader { line: 2, .. })), "{numbers:?}");
    }

    #[test]
    fn tables_without_names_need_a_telling_ending() {
        assert_eq!(form("1 2 3\n", "xyz").names.join(","), "x,y,z");
        assert_eq!(form("1,5 2,5 3,5\n", "txt").separator, Separator::Blank);
        assert_eq!(form("1 2 3 0 0.6 0.8\n", "xyz").names.join(","), "x,y,z,nx,ny,nz");
        assert_eq!(form("1 2 3 0 60 255\n", "txt").names[3], "red");
        assert_eq!(form("1 2 3 0 60 255 0.5\n", "xyz").names[6], "scalar");
        assert_eq!(form("11 1.5 2 3\n12 1 2 3\n", "txt").names.join(","), "number,x,y,z");
        let pts = form("2\n1 2 3 -700 1 2 3\n1 2 3 4 5 6 7\n", "pts");
        assert_eq!((pts.first_row, pts.names[3].as_str()), (1, "intensity"));
        for (text, ending) in [
            ("1 2 3\n", "csv"),
            ("1 2 3 4\n", "xyz"),
            ("1.5 2 3 4\n2.5 2 3 4\n", "xyz"),
            ("1 2 3 4 5.5 6\n", "xyz"),
            ("1 2\n", "xyz"),
        ] {
            assert!(
                matches!(table_form("f", text, ending, Need::Contacts, None), Err(IoError::NoHeader { .. })),
                "{text:?}"
            );
        }
    }

    #[test]
    fn a_count_of_rows_is_no_row() {
        let cases = [
            ("2\nx y z\n1 2 3\n4 5 6\n", "csv", 2),
            ("x,y,z\n\n2\n1,2,3\n4,5,6\n", "csv", 3),
            ("//X Y Z\n2\n1 2 3\n4 5 6\n", "asc", 2),
            ("# made by a scanner\n2\n1 2 3\n4 5 6\n", "xyz", 2),
            ("sep=;\n2\nx;y;z\n1;2;3\n", "csv", 3),
        ];
        for (text, ending, first_row) in cases {
            let form = form(text, ending);
            assert_eq!((form.first_row, form.names.join(",")), (first_row, "x,y,z".to_string()), "{text:?}");
        }
        // a line of one number is no count where the table has one column, nor is one followed by another
        assert_eq!(form("x\n2\n1\n", "csv").first_row, 1);
        for (text, wrong) in [("5\n6\n7\n", 1), ("2\n1 2 3\n4 5 6\n", 2)] {
            let found = table_form("f", text, "csv", Need::Contacts, None);
            assert!(matches!(found, Err(IoError::NoHeader { line, .. }) if line == wrong), "{text:?}: {found:?}");
        }
    }

    #[test]
    fn a_row_of_units_is_no_row() {
        let found = form("x,y,z,nx,ny,nz\nmm,mm,mm,-,-,-\n3\n1,2,3,0,0,1\n", "csv");
        assert_eq!((found.first_row, found.unit.as_deref()), (3, Some("mm")));
        let named = form("px [m];py [m];pz [m]\n1;2;3\n", "csv");
        assert_eq!((named.first_row, named.unit.as_deref(), named.titles[0].as_str()), (1, Some("m"), "px [m]"));
        assert!(table_form("f", "x,y,z\nmm,m,mm\n1,2,3\n", "csv", Need::Contacts, None).is_err());
        // words that are no units are a fault of a row
        assert_eq!(form("x,y,z\na,b,c\n", "csv").first_row, 1);
    }

    #[test]
    fn a_remark_that_mentions_axes_names_nothing() {
        let text = "# x y z are in millimetres\n1 2 3\n";
        assert!(form(text, "xyz").note.is_some());
    }
}
