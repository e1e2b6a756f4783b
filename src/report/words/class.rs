//! The class as a sentence: what such a surface looks like from the side that was touched, and how sure it is.

use super::super::document::{ShapePart, Shares};
use super::numbers::{chance, of_hundred};

/// What a class looks like from the side that was touched; empty for a word that is no class.
pub(in crate::report) fn like(class: &str) -> &'static str {
    match class {
        "cup" => "like the inside of a bowl",
        "trough" => "like the inside of a spoon",
        "rut" => "like the inside of a pipe",
        "saddle rut" => "between a rut and a saddle",
        "saddle" => "like a horse's saddle: hollow one way, raised the other",
        "saddle ridge" => "between a saddle and a ridge",
        "ridge" => "like the outside of a pipe",
        "dome" => "like the side of an egg",
        "cap" => "like the outside of a ball",
        "plane" => "flat, as far as these contacts can tell",
        _ => "",
    }
}

/// The class, what it looks like, and how sure it is.
pub(super) fn sentence(shape: &ShapePart) -> String {
    let Some(class) = shape.class.as_deref() else {
        return if let Some(by_area) = &shape.class_by_area {
            format!("several side by side: {}", of_the_patch(by_area))
        } else if shape.shape_index.mean.is_some() {
            "NO RESULT: the contacts show none of the shapes; the notes say why".into()
        } else {
            "NO RESULT: these contacts are too few to tell; the notes say why".into()
        };
    };
    if let (Some(p), Some((other, q))) = (probability(shape, class), second(shape))
        && q >= p
    {
        let sure = format!("{} and {} sure", chance(p), chance(q));
        return format!("{class} by the mean of S, {other} by its bounds: the contacts do not tell which ({sure})");
    }
    let like = like(class);
    let sure = probability(shape, class).map_or(String::new(), |p| format!(" ({} sure)", chance(p)));
    if like.is_empty() { format!("{class}{sure}") } else { format!("{class}: {like}{sure}") }
}

/// Classes that stand side by side, as `dome on 31 % of the patch, ridge on 20 %`.
pub(in crate::report) fn of_the_patch(by_area: &Shares) -> String {
    let each = by_area.0.iter().enumerate().map(|(k, (class, share))| {
        let patch = if k == 0 { " of the patch" } else { "" };
        format!("{class} on {}{patch}", of_hundred(*share))
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Probability of a class, where it is known.
pub(super) fn probability(shape: &ShapePart, class: &str) -> Option<f64> {
    shape.class_probability.as_ref()?.0.iter().find(|(name, _)| name == class).map(|(_, p)| *p)
}

/// The likeliest other class with its probability.
pub(super) fn second(shape: &ShapePart) -> Option<(&str, f64)> {
    let class = shape.class.as_deref()?;
    let others = shape.class_probability.as_ref()?.0.iter().filter(|(name, _)| name != class);
    others.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, p)| (name.as_str(), *p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::ShapeClass;

    #[test]
    fn every_class_has_words() {
        for class in ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]) {
            assert!(!like(class.name()).is_empty(), "{class}");
        }
    }
}
