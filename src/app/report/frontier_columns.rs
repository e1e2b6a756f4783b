//! The points of a frontier as columns: one row a record, nested keys joined by a full stop.

use std::io::Write;

use serde_json::Value;

use super::frontier::FrontierRecord;

/// Every key of a record that holds a number or a word, with its value; lists become `key.0`, `key.1`.
fn flat(record: &FrontierRecord) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    if let Ok(value) = serde_json::to_value(record) {
        flatten("", &value, &mut found);
    }
    found
}

fn flatten(key: &str, value: &Value, found: &mut Vec<(String, Value)>) {
    let joined = |inner: &str| if key.is_empty() { inner.to_string() } else { format!("{key}.{inner}") };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(inner, value)| flatten(&joined(inner), value, found)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(k, value)| flatten(&joined(&k.to_string()), value, found));
        }
        other => found.push((key.to_string(), other.clone())),
    }
}

/// Names of all columns, in the order in which records bring them: a part that is null in one record has columns of its own
/// in another.
fn names(rows: &[Vec<(String, Value)>]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (key, value) in rows.iter().flatten() {
        if !names.contains(key) && !value.is_null() {
            names.push(key.clone());
        }
    }
    names.sort();
    names
}

/// One line a record, in the order of the records.
///
/// # Errors
/// What the system says.
pub(crate) fn write_frontier_csv(records: &[FrontierRecord], out: &mut dyn Write) -> std::io::Result<()> {
    let rows: Vec<Vec<(String, Value)>> = records.iter().map(flat).collect();
    let names = names(&rows);
    writeln!(out, "{}", names.join(","))?;
    for row in &rows {
        let word = |name: &String| match row.iter().find(|(key, _)| key == name).map(|(_, value)| value) {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(text)) => format!("\"{}\"", text.replace('"', "\"\"")),
            Some(other) => other.to_string(),
        };
        writeln!(out, "{}", names.iter().map(word).collect::<Vec<_>>().join(","))?;
    }
    Ok(())
}

/// Names and values of the columns that hold numbers, NaN where there is none; the words of row k are those of record k.
pub(crate) fn frontier_columns(records: &[FrontierRecord]) -> (Vec<String>, Vec<Vec<f64>>) {
    let rows: Vec<Vec<(String, Value)>> = records.iter().map(flat).collect();
    let number = |value: &Value| value.as_f64().or_else(|| value.as_bool().map(|yes| f64::from(u8::from(yes))));
    let numeric = |name: &String| rows.iter().flatten().any(|(key, value)| key == name && number(value).is_some());
    let names: Vec<String> = names(&rows).into_iter().filter(numeric).collect();
    let of = |row: &Vec<(String, Value)>, name: &String| {
        row.iter().find(|(key, _)| key == name).and_then(|(_, value)| number(value)).unwrap_or(f64::NAN)
    };
    let columns = names.iter().map(|name| rows.iter().map(|row| of(row, name)).collect()).collect();
    (names, columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_studies::frontier::{Clocked, Errors, Frontier, Point};

    #[test]
    fn what_is_missing_in_one_record_is_a_gap_in_its_row() {
        let errors = [Some(Errors { rms: 0.5, ..Errors::default() }); 6];
        let seconds = Some(Clocked { median: 0.5, lo: 0.5, hi: 0.5, least: 0.5 });
        let points = [Point { errors, seconds, ..Point::default() }, Point::default()];
        let records = points.map(|point| FrontierRecord::new(Frontier::Discretisation, "a scene", &point));
        let mut text = Vec::new();
        write_frontier_csv(&records, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let names: Vec<&str> = lines[0].split(',').collect();
        assert!(names.contains(&"errors.S.rms") && names.contains(&"seconds.median"), "{names:?}");
        assert_eq!(lines.len(), 3);
        let (names, columns) = frontier_columns(&records);
        let at = names.iter().position(|name| name == "error_S").unwrap();
        assert!(columns[at][0] == 0.5 && columns[at][1].is_nan());
        assert!(!names.iter().any(|name| name == "label"));
    }
}
