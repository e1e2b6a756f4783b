//! Which known object a body is: records and the line of the table.

use schemars::JsonSchema;
use serde::Serialize;

use super::words::chance;
use palpate_inference::parts::ObjectMatch;

/// One known object.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct ObjectRecord {
    /// The name of its file; `null`: none of the library.
    pub name: Option<String>,
    /// How probable.
    pub probability: f64,
    /// Parts of the body with the parts of the object that they most probably are.
    pub pairs: Vec<[usize; 2]>,
}

impl ObjectRecord {
    pub(crate) fn of(found: ObjectMatch) -> ObjectRecord {
        ObjectRecord { name: found.name, probability: found.probability, pairs: found.pairs }
    }
}

/// Objects that are named in a line at most; the document has all.
const NAMED: usize = 4;

/// `mug (98 %), bowl (2 %)`.
pub(crate) fn object_line(objects: &[ObjectRecord]) -> String {
    let name = |object: &ObjectRecord| object.name.clone().unwrap_or_else(|| "none of the library".into());
    let is_worth = |(k, object): &(usize, &ObjectRecord)| *k == 0 || object.probability >= 0.01;
    let named = objects.iter().enumerate().filter(is_worth).take(NAMED);
    named.map(|(_, o)| format!("{} ({})", name(o), chance(o.probability))).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_not_named() {
        let one =
            |name: Option<&str>, probability| ObjectRecord { name: name.map(Into::into), probability, pairs: vec![] };
        let line = object_line(&[one(Some("mug"), 0.972), one(None, 0.024), one(Some("bowl"), 0.004)]);
        assert_eq!(line, "mug (97 %), none of the library (2 %)");
    }
}
