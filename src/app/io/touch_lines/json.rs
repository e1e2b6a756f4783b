//! One JSON object as named fields: nested keys are joined by points, and three numbers in a row are x, y and z.
//!
//! ```text
//! {"pose": {"position": {"x": 1}}, "normal": [0, 0, 1]}     pose.position.x, normal.x, normal.y, normal.z
//! ```

use serde_json::Value;

/// What stands behind a key.
#[derive(Debug, Default)]
pub(super) struct FieldValue {
    /// As a number; null is one that is missing.
    pub(super) number: Option<f64>,
    /// As it stands.
    pub(super) text: Option<String>,
}

/// How deep objects may stand in each other; messages of robots have four floors.
const DEEPEST: usize = 8;

/// Every number and word of an object with its name.
pub(super) fn fields(line: &str) -> Result<Vec<(String, FieldValue)>, String> {
    let value: Value = serde_json::from_str(line).map_err(|error| error.to_string())?;
    let mut found = Vec::new();
    gather("", &value, DEEPEST, &mut found);
    Ok(found)
}

fn gather(name: &str, value: &Value, depth: usize, found: &mut Vec<(String, FieldValue)>) {
    let within = |key: &str| if name.is_empty() { key.to_string() } else { format!("{name}.{key}") };
    match value {
        Value::Object(fields) if depth > 0 => {
            fields.iter().for_each(|(key, value)| gather(&within(key), value, depth - 1, found));
        }
        Value::Array(values) if values.len() == 3 => {
            ["x", "y", "z"].iter().zip(values).for_each(|(key, value)| gather(&within(key), value, 0, found));
        }
        Value::Number(number) => found.push((name.into(), FieldValue { number: number.as_f64(), ..of_text(value) })),
        Value::String(text) => found.push((name.into(), FieldValue { number: None, text: Some(text.clone()) })),
        Value::Null => found.push((name.into(), FieldValue { number: Some(f64::NAN), text: None })),
        Value::Bool(_) | Value::Array(_) | Value::Object(_) => {}
    }
}

fn of_text(value: &Value) -> FieldValue {
    FieldValue { number: None, text: Some(value.to_string()) }
}
