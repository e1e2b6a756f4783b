//! A table of a TOML document that knows which of its keys have a meaning, so that the rest can be refused.

use std::cell::RefCell;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::SceneFileError;

pub(super) type Value<'d> = Spanned<DeValue<'d>>;

/// Line and column, from 1, of a byte offset; columns count characters.
pub(super) fn place(source: &str, offset: usize) -> (usize, usize) {
    let mut end = offset.min(source.len());
    while !source.is_char_boundary(end) {
        end -= 1;
    }
    let before = &source[..end];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// ", did you mean `x`?" for the closest of `known`, or nothing when none is close.
pub(super) fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    // below 0.7 Jaro-Winkler names rarely have anything to do with each other
    let closest = known
        .into_iter()
        .map(|k| (strsim::jaro_winkler(name, k), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(score, _)| *score >= 0.7);
    closest.map_or(String::new(), |(_, k)| format!(", did you mean `{k}`?"))
}

pub(super) struct Section<'d> {
    pub source: &'d str,
    pub path: String,
    table: &'d DeTable<'d>,
    offset: usize,
    asked: RefCell<Vec<&'static str>>,
}

impl<'d> Section<'d> {
    pub(super) fn new(source: &'d str, path: &str, table: &'d DeTable<'d>, offset: usize) -> Section<'d> {
        Section { source, path: path.into(), table, offset, asked: RefCell::default() }
    }

    pub(super) fn place(&self) -> (usize, usize) {
        place(self.source, self.offset)
    }

    pub(super) fn place_of(&self, value: &Value) -> (usize, usize) {
        place(self.source, value.span().start)
    }

    pub(super) fn full(&self, key: &str) -> String {
        if self.path.is_empty() { key.into() } else { format!("{}.{key}", self.path) }
    }

    /// The value of a key.
    pub(super) fn get(&self, key: &str) -> Option<&'d Value<'d>> {
        self.table.get(key)
    }

    /// These keys are known from now on.
    pub(super) fn know(&self, keys: &[&'static str]) {
        self.asked.borrow_mut().extend_from_slice(keys);
    }

    /// Of the keys that are known, only these have a meaning here.
    pub(super) fn keep(&self, keys: impl Fn(&str) -> bool) {
        self.asked.borrow_mut().retain(|key| keys(key));
    }

    /// The keys that are known, in the order in which they came to be.
    pub(super) fn known(self) -> Vec<&'static str> {
        self.asked.into_inner()
    }

    pub(super) fn value_error(&self, key: &str, value: &Value, expected: impl Into<String>) -> SceneFileError {
        let (line, column) = self.place_of(value);
        let found = self.source.get(value.span()).unwrap_or("?").to_string();
        SceneFileError::Value { line, column, key: self.full(key), found, expected: expected.into() }
    }

    pub(super) fn unknown_word(&self, what: &str, value: &Value, name: &str, known: &[&str]) -> SceneFileError {
        let (line, column) = self.place_of(value);
        SceneFileError::Unknown {
            line,
            column,
            what: what.into(),
            name: name.into(),
            nearest: nearest(name, known.iter().copied()),
            known: known.join(", "),
        }
    }

    pub(super) fn missing(&self, key: &'static str, expected: &str) -> SceneFileError {
        let (line, column) = self.place();
        SceneFileError::Missing { line, column, section: self.path.clone(), key, expected: expected.into() }
    }

    pub(super) fn clash(&self, first: &str, second: &str) -> SceneFileError {
        let text = |key: &str| {
            let value = self.table.get(key);
            let written = value.and_then(|v| self.source.get(v.span())).unwrap_or("?");
            (format!("{} = {written}", self.full(key)), value.map_or(self.offset, |v| v.span().start))
        };
        let ((first, _), (second, offset)) = (text(first), text(second));
        let (line, column) = place(self.source, offset);
        SceneFileError::Clash { line, column, first, second }
    }

    /// A table inside this one.
    pub(super) fn section(&self, key: &'static str) -> Result<Option<Section<'d>>, SceneFileError> {
        self.know(&[key]);
        let Some(value) = self.get(key) else { return Ok(None) };
        match value.get_ref() {
            DeValue::Table(table) => Ok(Some(Section::new(self.source, &self.full(key), table, value.span().start))),
            _ => Err(self.value_error(key, value, format!("a table, [{}], is needed", self.full(key)))),
        }
    }

    /// The tables of a list, one by one.
    pub(super) fn tables(&self, key: &'static str, expected: &str) -> Result<Vec<Section<'d>>, SceneFileError> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let Some(list) = as_array(value) else { return Err(self.value_error(key, value, expected)) };
        let table = |entry: &'d Value<'d>| match entry.get_ref() {
            DeValue::Table(table) => Ok(Section::new(self.source, &self.full(key), table, entry.span().start)),
            _ => Err(self.value_error(key, entry, expected)),
        };
        list.iter().map(table).collect()
    }

    pub(super) fn word(&self, key: &'static str) -> Result<Option<(&'d str, &'d Value<'d>)>, SceneFileError> {
        self.know(&[key]);
        match self.get(key).map(|value| (value, value.get_ref())) {
            None => Ok(None),
            Some((value, DeValue::String(word))) => Ok(Some((word.as_ref(), value))),
            Some((value, _)) => Err(self.value_error(key, value, "a string is needed")),
        }
    }

    /// Refuses the first key that was never asked for.
    pub(super) fn finish(self, what: &str) -> Result<(), SceneFileError> {
        let mut known = self.asked.into_inner();
        known.sort_unstable();
        known.dedup();
        let stranger = self
            .table
            .iter()
            .filter(|(key, _)| !known.contains(&key.get_ref().as_ref()))
            .min_by_key(|(key, _)| key.span().start);
        let Some((key, _)) = stranger else { return Ok(()) };
        let (line, column) = place(self.source, key.span().start);
        let name = key.get_ref().to_string();
        let what = if self.path.is_empty() || what != "key" { what.into() } else { format!("key of [{}]", self.path) };
        let nearest = nearest(&name, known.iter().copied());
        Err(SceneFileError::Unknown { line, column, what, name, nearest, known: known.join(", ") })
    }
}

pub(super) fn as_array<'v, 'd>(value: &'v Value<'d>) -> Option<&'v toml::de::DeArray<'d>> {
    match value.get_ref() {
        DeValue::Array(array) => Some(array),
        _ => None,
    }
}

pub(super) fn as_number(value: &Value) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64),
        _ => None,
    }
}

pub(super) fn as_count(value: &Value) -> Option<u64> {
    match value.get_ref() {
        DeValue::Integer(integer) => u64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        _ => None,
    }
}
