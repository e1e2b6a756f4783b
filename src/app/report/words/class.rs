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

/// A class of less probability than this is not what the contacts show, though the mean of S lies in it.
const UNLIKELY: f64 = 0.1;

/// The likelier class where the class of the mean of S has nearly no probability, with the probabilities of both.
pub(in crate::report) fn likelier(shape: &ShapePart) -> Option<(&str, [f64; 2])> {
    let own = probability(shape, shape.class.as_deref()?)?;
    second(shape).filter(|(_, other)| own < UNLIKELY && *other >= own).map(|(name, other)| (name, [own, other]))
}

/// The radius, unless the class that it belongs to has nearly no probability.
pub(in crate::report) fn radius_of_class(shape: &ShapePart) -> Option<f64> {
    shape.radius.filter(|_| likelier(shape).is_none())
}

/// The class in few words, for a title: all of them where there are several.
pub(crate) fn named(shape: &ShapePart) -> String {
    match (shape.class.as_deref(), likelier(shape), &shape.class_by_area) {
        (Some(class), Some((other, _)), _) => format!("between {class} and {other}"),
        (Some(class), None, _) => with_other(shape, class),
        (None, _, Some(by_area)) => {
            let names: Vec<&str> = by_area.0.iter().map(|(name, _)| name.as_str()).collect();
            format!("{} side by side", names.join(", "))
        }
        (None, _, None) => "no class".into(),
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
    if let Some((other, [p, q])) = likelier(shape) {
        return format!(
            "between {class} and {other}: the mean of S is that of a {class}, but {} of the surfaces that explain the contacts are a \
             {other}, {} a {class}",
            chance(q),
            chance(p)
        );
    }
    if let (Some(p), Some((other, q))) = (probability(shape, class), second(shape))
        && q >= p
    {
        let sure = format!("{} and {} sure", chance(p), chance(q));
        return format!("{class} by the mean of S, {other} by its bounds: the contacts do not tell which ({sure})");
    }
    let like = like_either(shape, class);
    let sure = probability(shape, class).map_or(String::new(), |p| format!(" ({} sure)", chance(p)));
    let class = &with_other(shape, class);
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

/// A class with its share of the patch, as `dome on 31 % of the patch`.
pub(in crate::report) fn of_patch(class: &str, share: f64) -> String {
    format!("{class} on {} of the patch", of_hundred(share))
}

/// The class with its mirror image where nothing tells which side is free, as `cap or cup`.
fn with_other(shape: &ShapePart, class: &str) -> String {
    shape.other_class.as_ref().map_or(class.into(), |other| format!("{class} or {other}"))
}

/// What it looks like, from either side where nothing tells which is free.
fn like_either(shape: &ShapePart, class: &str) -> &'static str {
    match (shape.other_class.is_some(), class) {
        (true, "cap" | "cup") => "like a ball, from outside or from inside",
        (true, "ridge" | "rut") => "like a pipe, from outside or from inside",
        (true, "dome" | "trough") => "like the side of an egg, from outside or from inside",
        (true, _) => "and nothing tells which side is free",
        (false, _) => like(class),
    }
}

/// Probability of a class, where it is known; of both where nothing tells which side is free.
pub(super) fn probability(shape: &ShapePart, class: &str) -> Option<f64> {
    let of = |name: &str| shape.class_probability.as_ref()?.0.iter().find(|(n, _)| n == name).map(|(_, p)| *p);
    let other = shape.other_class.as_deref().filter(|_| shape.class.as_deref() == Some(class)).and_then(of);
    of(class).map(|p| p + other.unwrap_or(0.0))
}

/// The likeliest other class with its probability.
pub(super) fn second(shape: &ShapePart) -> Option<(&str, f64)> {
    let class = shape.class.as_deref()?;
    let others = shape.class_probability.as_ref()?.0.iter().filter(|(name, _)| name != class);
    let others = others.filter(|(name, _)| shape.other_class.as_ref() != Some(name));
    others.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, p)| (name.as_str(), *p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::curvature::ShapeClass;

    #[test]
    fn every_class_has_words() {
        for class in ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]) {
            assert!(!like(class.name()).is_empty(), "{class}");
        }
    }
}
