//! Lengths on a page, with the unit that the user gave, where one was given.
//!
//! ```text
//! 10 mm      x (mm)      (1/mm)          10      x      (1/length)
//! ```

use crate::report::document::FitDocument;

/// The unit of a document's lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lengths<'a>(Option<&'a str>);

impl<'a> Lengths<'a> {
    pub(super) fn of(document: &'a FitDocument) -> Lengths<'a> {
        Lengths(document.unit.as_deref())
    }

    /// A length.
    pub(super) fn of_size(&self, number: String) -> String {
        self.0.map_or(number.clone(), |unit| format!("{number} {unit}"))
    }

    /// The name of an axis or a column of lengths.
    pub(super) fn along(&self, name: &str) -> String {
        self.0.map_or(name.into(), |unit| format!("{name} ({unit})"))
    }

    /// The unit of a curvature.
    pub(super) fn inverse(&self) -> String {
        format!("1/{}", self.0.unwrap_or("length"))
    }
}

#[cfg(test)]
mod tests {
    use super::Lengths;

    #[test]
    fn lengths_carry_their_unit_where_one_was_given() {
        let (some, none) = (Lengths(Some("mm")), Lengths(None));
        assert_eq!([some.of_size("10".into()), some.along("x"), some.inverse()], ["10 mm", "x (mm)", "1/mm"]);
        assert_eq!([none.of_size("10".into()), none.along("x"), none.inverse()], ["10", "x", "1/length"]);
    }
}
