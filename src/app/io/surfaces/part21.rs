//! The instances of a Part 21 file (STEP): `#12=NAME(parameters);`, or `#12=(NAME(..)NAME(..));` of several types at once.
//!
//! Only what is asked for becomes a value; the rest of the file is passed over. Nesting and numbers of values are bounded,
//! and no text is longer than the file.

use std::collections::HashMap;

/// Deepest nesting of lists: control points take three.
const DEEPEST: usize = 16;

/// One parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// `#12`.
    Reference(u64),
    /// A number.
    Number(f64),
    /// `.F.` and other words between full stops.
    Word(String),
    /// A list, or the parameters of a typed value.
    List(Vec<Value>),
    /// Text, `$` and `*`, which nothing here asks for.
    Other,
}

/// Where every instance stands.
pub(super) struct Instances<'a> {
    /// From the number to what stands behind `=`.
    texts: HashMap<u64, &'a str>,
    /// In the order of the file.
    order: Vec<u64>,
}

/// Whether the bytes begin as a Part 21 file.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"ISO-10303-21")
}

impl<'a> Instances<'a> {
    /// Cuts the file at its semicolons; strings and comments are passed over whole.
    ///
    /// # Errors
    /// What is wrong.
    pub(super) fn of(text: &'a str) -> Result<Instances<'a>, String> {
        let mut found = Instances { texts: HashMap::new(), order: Vec::new() };
        for statement in statements(text) {
            let Some((head, body)) = statement.trim_start().strip_prefix('#').and_then(|s| s.split_once('=')) else {
                continue;
            };
            let number = head.trim().parse::<u64>().map_err(|_| format!("#{} is no instance's number", short(head)))?;
            if found.texts.insert(number, body.trim()).is_some() {
                return Err(format!("instance #{number} stands twice"));
            }
            found.order.push(number);
        }
        Ok(found)
    }

    /// Numbers of the instances that have this type among theirs, in the order of the file.
    pub(super) fn with_type(&self, name: &str) -> Vec<u64> {
        self.order.iter().copied().filter(|n| self.parameters_text(*n, name).is_some()).collect()
    }

    /// Parameters of an instance under one of its types.
    ///
    /// # Errors
    /// Where it is not there, or malformed.
    pub(super) fn parameters(&self, number: u64, name: &str) -> Result<Vec<Value>, String> {
        let text = self.parameters_text(number, name).ok_or_else(|| format!("#{number} is no {name}"))?;
        let mut parser = Parser { rest: text };
        let values = parser.list(0).map_err(|what| format!("#{number}, {name}: {what}"))?;
        Ok(values)
    }

    /// The text from the opening bracket of a type's parameters.
    fn parameters_text(&self, number: u64, name: &str) -> Option<&'a str> {
        let body = self.texts.get(&number)?;
        let starts = |text: &'a str| {
            let rest = text.strip_prefix(name)?.trim_start();
            rest.starts_with('(').then_some(rest)
        };
        let Some(inside) = body.strip_prefix('(') else { return starts(body) };
        // several types at once: each name stands at the outermost level
        let mut rest = inside.trim_start();
        while !rest.is_empty() && !rest.starts_with(')') {
            if let Some(found) = starts(rest) {
                return Some(found);
            }
            rest = after_brackets(rest)?.trim_start();
        }
        None
    }
}

fn short(text: &str) -> String {
    text.trim().chars().filter(|c| !c.is_control()).take(20).collect()
}

/// The text behind the first bracketed list.
fn after_brackets(text: &str) -> Option<&str> {
    let mut depth = 0usize;
    let mut quoted = false;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'\'' => quoted = !quoted,
            b'(' if !quoted => depth += 1,
            b')' if !quoted => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return text.get(at + 1..);
                }
            }
            _ => {}
        }
    }
    None
}

/// Pieces between semicolons outside of strings.
fn statements(text: &str) -> impl Iterator<Item = &str> {
    let mut quoted = false;
    text.split(move |c: char| {
        quoted ^= c == '\'';
        c == ';' && !quoted
    })
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    /// `(a, b, ...)`.
    fn list(&mut self, depth: usize) -> Result<Vec<Value>, String> {
        if depth > DEEPEST {
            return Err(format!("lists are nested deeper than {DEEPEST}"));
        }
        self.expect('(')?;
        let mut values = Vec::new();
        self.blanks();
        if self.take(')') {
            return Ok(values);
        }
        loop {
            values.push(self.value(depth)?);
            self.blanks();
            if self.take(')') {
                return Ok(values);
            }
            self.expect(',')?;
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, String> {
        self.blanks();
        let first = self.rest.chars().next().ok_or("it ends in the middle")?;
        match first {
            '(' => self.list(depth + 1).map(Value::List),
            '$' | '*' => {
                self.rest = &self.rest[1..];
                Ok(Value::Other)
            }
            '\'' => self.text(),
            '#' => {
                let digits = self.word(1, |c| c.is_ascii_digit());
                digits[1..].parse().map(Value::Reference).map_err(|_| format!("{} is no reference", short(&digits)))
            }
            '.' => {
                let word = self.word(1, |c| c.is_ascii_alphanumeric() || c == '_');
                self.expect('.')?;
                Ok(Value::Word(word[1..].to_string()))
            }
            c if c.is_ascii_digit() || c == '-' || c == '+' => {
                let digits = self.word(1, |c| c.is_ascii_digit() || "+-.eE".contains(c));
                let value = digits.parse::<f64>().ok().filter(|v| v.is_finite());
                value.map(Value::Number).ok_or_else(|| format!("{} is no number", short(&digits)))
            }
            c if c.is_ascii_alphabetic() => {
                // a typed value, NAME(...)
                self.word(1, |c| c.is_ascii_alphanumeric() || c == '_');
                self.list(depth + 1).map(Value::List)
            }
            c => Err(format!("{:?} is not expected", c)),
        }
    }

    /// Text between quotes, in which a quote stands twice.
    fn text(&mut self) -> Result<Value, String> {
        let mut rest = &self.rest[1..];
        loop {
            let end = rest.find('\'').ok_or("a string does not end")?;
            rest = &rest[end + 1..];
            match rest.strip_prefix('\'') {
                Some(more) => rest = more,
                None => break,
            }
        }
        self.rest = rest;
        Ok(Value::Other)
    }

    /// The first `from` letters (ASCII) and all that follow and are taken.
    fn word(&mut self, from: usize, takes: impl Fn(char) -> bool) -> String {
        let end = self.rest[from..].find(|c| !takes(c)).map_or(self.rest.len(), |end| from + end);
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word.to_string()
    }

    fn blanks(&mut self) {
        self.rest = self.rest.trim_start();
        while let Some((_, after)) = self.rest.strip_prefix("/*").and_then(|inside| inside.split_once("*/")) {
            self.rest = after.trim_start();
        }
    }

    fn take(&mut self, c: char) -> bool {
        let found = self.rest.strip_prefix(c);
        self.rest = found.unwrap_or(self.rest);
        found.is_some()
    }

    fn expect(&mut self, c: char) -> Result<(), String> {
        self.blanks();
        if self.take(c) { Ok(()) } else { Err(format!("{c} is missing before {:?}", short(self.rest))) }
    }
}
