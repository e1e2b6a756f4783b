//! What the numbers of a fit mean, in sentences for somebody who never saw the program.

use super::figure::{precise, shown};
use super::lengths::Lengths;
use crate::report::document::{FitDocument, MeasurePart};
use crate::report::percent::percent;
use crate::report::radius::radius_bounds;
use crate::report::table::significant;
use crate::report::words::{chance, like, likelier, of_the_patch, radius_of_class};

/// The level of an interval in front of its name, where it is known: `95 % interval`, `an interval`.
pub(super) fn named_level(level: Option<f64>) -> String {
    level.map_or("an".into(), percent)
}

/// The interval of a mean, as `95 % interval 0.48 to 0.52`.
pub(super) fn interval_of(part: &MeasurePart) -> Option<String> {
    let [lo, hi] = apart(part.interval?)?;
    Some(format!("{} interval {lo} to {hi}", named_level(part.level)))
}

/// Both ends of an interval in words; nothing where they cannot be told apart, as of contacts without noise.
pub(super) fn apart([lo, hi]: [f64; 2]) -> Option<[String; 2]> {
    Some([precise(lo, hi - lo), precise(hi, hi - lo)]).filter(|[lo, hi]| lo != hi)
}

/// What was found, in one or two sentences.
pub(super) fn finding(document: &FitDocument) -> String {
    let (shape, lengths) = (&document.shape, Lengths::of(document));
    let Some(class) = shape.class.as_deref() else {
        return if let Some(by_area) = &shape.class_by_area {
            format!(
                "No single kind of shape: {}. Means over the whole patch describe no part of it.",
                of_the_patch(by_area)
            )
        } else if shape.shape_index.mean.is_some() {
            "No kind of shape describes the patch.".into()
        } else {
            "The shape index is undefined here, so the patch has no class.".into()
        };
    };
    let mut words = match likelier(shape) {
        Some((other, [_, sure])) => format!(
            "The patch lies between a {class} and a {other}: the mean of S is that of a {class}, but {} of the surfaces that explain \
             the contacts are a {other}.",
            chance(sure)
        ),
        None => format!("The patch is a {class}: {}.", like(class)),
    };
    if let Some(radius) = radius_of_class(shape) {
        let sure = shape.curvedness.level.map_or(String::new(), |level| format!(", {} sure", percent(level)));
        let between = match radius_bounds(shape) {
            [Some(lo), Some(hi)] => apart([lo, hi])
                .map_or(String::new(), |[lo, hi]| format!(" (between {lo} and {}{sure})", lengths.of_size(hi))),
            [Some(lo), None] => format!(" (above {}{sure})", lengths.of_size(shown(lo))),
            _ => String::new(),
        };
        words.push_str(&format!(" Its radius is {}{between}.", lengths.of_size(shown(radius))));
    }
    if let Some([small, large]) = shape.radii {
        words.push_str(&format!(" Its two radii are {} and {}.", shown(small), lengths.of_size(shown(large))));
    }
    words
}

/// The certificate and all that bears on trust, a sentence each.
pub(super) fn certificate(document: &FitDocument) -> Vec<String> {
    let (fit, shape) = (&document.fit, &document.shape);
    let [n, m] = shape.grid;
    let used = (shape.support * (n * m) as f64).round();
    let mut said = vec![format!(
        "Support: contacts surround {used} of the {} points at which the shape is looked at; means are taken over these alone.",
        n * m
    )];
    said.extend(fit.chosen.iter().map(|chosen| format!("Kind of surface: {}.", chosen.why.trim_end_matches('.'))));
    said.extend(
        fit.lack_of_fit
            .iter()
            .map(|lack| format!("What the surface leaves unsaid: {}.", lack.words.trim_end_matches('.'))),
    );
    said.push(equations(document));
    said.extend(arithmetic(document));
    said.extend(in_space(document));
    said.extend(shape.plane_p.map(|p| {
        format!("Flatness: were the patch a plane, residuals like these would have probability {}.", significant(p, 2))
    }));
    said
}

/// How many numbers were measured, and how many were to be found.
fn equations(document: &FitDocument) -> String {
    let fit = &document.fit;
    if fit.method == "recognition" {
        return format!("{} measured numbers fix {} unknowns.", fit.equations, fit.unknowns);
    }
    let held = if fit.rank >= fit.unknowns {
        "the contacts determine all of them".to_string()
    } else {
        format!("the contacts determine {} of them, and S and R are left out where the others matter", fit.rank)
    };
    let ([p, q], [a, b]) = (fit.degree, fit.segments);
    format!(
        "Equations: {} for the {} coefficients of a spline surface of degree {p} x {q} with {a} x {b} segments; {held}.",
        fit.equations, fit.unknowns
    )
}

/// What rounding can have done.
fn arithmetic(document: &FitDocument) -> Vec<String> {
    let fit = &document.fit;
    let floor = |v: f64| v.floor().max(0.0);
    let digits = fit.promise.as_ref().map(|digits| {
        format!(
            "Rounding: at least {} digits of the coefficients, {} of S and {} of R are those of the exact solution of the equations. \
             This is about arithmetic, not about how near the surface is to the truth.",
            floor(digits.coefficients),
            floor(digits.shape_index),
            floor(digits.curvedness)
        )
    });
    let condition = fit.condition.map(|condition| {
        let times = significant(condition, 2);
        format!("Condition: a relative error in the equations may grow {times}-fold in the coefficients.")
    });
    let backward = fit.backward_error.map(|error| {
        let part = significant(error, 2);
        format!("Backward error: the computed answer solves equations that differ from the written ones by {part} of their size.")
    });
    [digits, condition, backward].into_iter().flatten().collect()
}

/// What a surface in space certifies.
fn in_space(document: &FitDocument) -> Vec<String> {
    let Some(part) = &document.fit.parametric else { return Vec::new() };
    let folds = if part.fold_free {
        "folds back on itself nowhere"
    } else {
        "folds back on itself somewhere: do not trust S and R there"
    };
    let settled = if part.settled { "ended at a minimum" } else { "was cut short before a minimum" };
    vec![format!("Surface in space: it {folds}; the descent {settled} after {} steps.", part.iterations)]
}

/// Noise found or declared, in words.
pub(super) fn noise(document: &FitDocument) -> Option<String> {
    let (sigma, lengths) = (document.fit.sigma.as_ref()?, Lengths::of(document));
    let mut parts: Vec<String> =
        sigma.of_point().map(|sd| format!("{} in position", lengths.of_size(significant(sd, 3)))).into_iter().collect();
    if let (Some(sd), Some(over)) = (sigma.shared, sigma.shared_over) {
        parts.push({
            let [sd, over] = [sd, over].map(|v| lengths.of_size(significant(v, 3)));
            format!("of that {sd} shared by neighbours over a distance of {over}")
        });
    }
    parts.extend(sigma.normal_deg.map(|v| format!("{} degrees in the normal", significant(v, 3))));
    parts.extend(sigma.slope.map(|v| format!("{} in the slope", significant(v, 3))));
    (!parts.is_empty()).then(|| format!("Noise of one contact (standard deviation): {}.", parts.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_that_are_one_number_are_no_interval() {
        assert_eq!(apart([24.2, 26.5]), Some(["24.2".to_string(), "26.5".to_string()]));
        assert_eq!(apart([6.6, 6.6 + 1e-13]), None);
        let part = MeasurePart { interval: Some([0.5, 0.5 + 1e-15]), ..MeasurePart::default() };
        assert_eq!(interval_of(&part), None);
    }
}
