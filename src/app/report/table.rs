//! The technical lines: spread, uncertainty and its parts, how the surface was found, how far to trust the arithmetic.

use std::fmt::Write as _;
use std::io::Write;

use super::document::{FitDocument, FitPart, MeasurePart, ParametricPart};
use super::fold::folded;
use super::percent::percent;

/// Significant digits of means; the spread is cut at the same decimal.
const DIGITS: i32 = 4;

/// Columns of a label.
const LABEL: usize = 11;

/// Magnitudes that are shown in fixed form.
const SMALLEST: f64 = 1e-6;
const LARGEST: f64 = 1e7;

/// Classes less likely than this are not listed.
const LEAST_SHARE: f64 = 0.001;

/// Writes the technical lines of one fit.
///
/// # Errors
/// What the system says.
pub(crate) fn write_table(document: &FitDocument, width: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let mut lines = Lines::default();
    shape_lines(document, &mut lines);
    truth_line(document, &mut lines);
    fit_lines(document, &mut lines);
    for note in &document.fit.notes {
        lines.add("note", note.clone());
    }
    out.write_all(folded(&lines.0, Some(LABEL), width).as_bytes())
}

#[derive(Default)]
struct Lines(String);

impl Lines {
    fn add(&mut self, label: &str, text: impl Into<String>) {
        let _ = writeln!(self.0, "{label:<10} {}", text.into().trim_end());
    }
}

fn shape_lines(document: &FitDocument, lines: &mut Lines) {
    let shape = &document.shape;
    lines.add("S", measure(&shape.shape_index, |_| 4));
    lines.add("R", measure(&shape.curvedness, |mean| decimals(mean, DIGITS)));
    if let Some(shares) = &shape.class_probability {
        let mut likely: Vec<&(String, f64)> = shares.0.iter().filter(|(_, share)| *share >= LEAST_SHARE).collect();
        likely.sort_by(|a, b| b.1.total_cmp(&a.1));
        lines.add(
            "classes",
            likely.iter().map(|(name, share)| format!("{name} {share:.3}")).collect::<Vec<_>>().join(", "),
        );
    }
    if let Some(shares) = &shape.class_by_area {
        let shares = shares.0.iter().map(|(name, share)| format!("{name} {share:.3}"));
        lines.add("by area", format!("{} of the patch", shares.collect::<Vec<_>>().join(", ")));
        // the direction in the middle is that of none of them
        return support_lines(document, lines);
    }
    if let Some(direction) = shape.direction_deg {
        lines.add("k1", format!("along {direction:.1} deg from +x towards +y, the direction of the larger curvature"));
    }
    if let Some([x, y, z]) = shape.direction {
        lines.add("k1", format!("along ({x:.3}, {y:.3}, {z:.3}) in space, the direction of the larger curvature"));
    }
    support_lines(document, lines);
}

fn support_lines(document: &FitDocument, lines: &mut Lines) {
    let shape = &document.shape;
    let [n, m] = shape.grid;
    let used = (shape.support * (n * m) as f64).round();
    lines.add("support", format!("{used} of {n} x {m} grid points lie among the contacts"));
    if let Some(p) = shape.plane_p {
        lines.add("plane", format!("p = {}: chance of contacts like these on a plane", significant(p, 2)));
    }
}

fn truth_line(document: &FitDocument, lines: &mut Lines) {
    let Some(truth) = &document.truth else { return };
    let part = |name: &str, value: Option<f64>, error: Option<f64>| {
        let value = value.map_or("undefined".into(), |v| significant(v, DIGITS));
        let error = error.map_or(String::new(), |e| format!(" (rms error {})", significant(e, 2)));
        format!("{name} {value}{error}")
    };
    let s = part("S", truth.shape_index, truth.error_shape_index);
    let r = part("R", truth.curvedness, truth.error_curvedness);
    lines.add("truth", format!("{s}   {r}"));
}

fn fit_lines(document: &FitDocument, lines: &mut Lines) {
    if document.fit.chosen.as_ref().is_some_and(|chosen| chosen.hypothesis.is_some()) {
        recognition_lines(document, lines);
    } else {
        equation_lines(document, lines);
    }
}

/// How a recognised surface was found.
fn recognition_lines(document: &FitDocument, lines: &mut Lines) {
    let fit = &document.fit;
    if let Some(chosen) = &fit.chosen {
        lines.add("found as", chosen.why.clone());
    }
    if let Some(sigma) = &fit.sigma {
        let mut parts: Vec<String> =
            sigma.of_point().map(|sd| format!("positions {}", significant(sd, 3))).into_iter().collect();
        parts.extend(sigma.shared.zip(sigma.shared_over).map(|(sd, over)| {
            format!("of that shared by neighbours {} over a distance of {}", significant(sd, 3), significant(over, 3))
        }));
        parts.extend(sigma.normal_deg.map(|v| format!("normals {} deg", significant(v, 3))));
        lines.add("noise", parts.join(",  "));
    }
    if let Some(lack) = &fit.lack_of_fit {
        let p = lack.p.map_or(String::new(), |p| format!("  (p = {})", significant(p, 2)));
        lines.add("misfit", format!("{}{p}", lack.words));
    }
    if let Some(z) = fit.rms.z {
        lines.add("rms", format!("{} off the surface", significant(z, 3)));
    }
    let ([p, q], [n, m]) = (fit.degree, fit.segments);
    lines.add("surface", format!("{}, degree {p} x {q}, segments {n} x {m}", document.surface.kind));
}

fn equation_lines(document: &FitDocument, lines: &mut Lines) {
    let fit = &document.fit;
    let ([p, q], [n, m]) = (fit.degree, fit.segments);
    let size = format!("{} equations, {} unknowns, rank {}", fit.equations, fit.unknowns, fit.rank);
    lines.add("fit", format!("degree {p} x {q}, segments {n} x {m}: {size}"));
    let rms = [("z", fit.rms.z), ("zx", fit.rms.zx), ("zy", fit.rms.zy)];
    if let Some(weights) = fit.weights {
        // a weight of rows that are not there means nothing
        let used = rms.iter().zip(weights).filter(|((_, value), _)| value.is_some());
        let used = used.map(|((name, _), weight)| format!("{name} {}", significant(weight, DIGITS)));
        lines.add("weights", used.collect::<Vec<_>>().join("  "));
    }
    if let Some(sigma) = &fit.sigma {
        let level = |name, value: Option<f64>, unit| match value {
            Some(value) => format!("{name} {}{unit}  ", significant(value, 3)),
            None => String::new(),
        };
        let levels =
            [level("z", sigma.z, ""), level("normals", sigma.normal_deg, " deg"), level("slopes", sigma.slope, "")];
        lines.add("sigma", levels.concat());
    }
    if fit.smooth != 0.0 {
        lines.add("smooth", format!("lambda {}", significant(fit.smooth, 3)));
    }
    if let Some(chosen) = &fit.chosen {
        lines.add("surface", format!("{}: {}", chosen.surface, chosen.why));
    }
    if let Some(lack) = &fit.lack_of_fit {
        lines.add("misfit", lack.words.clone());
    }
    if let Some(part) = &fit.parametric {
        parametric_lines(part, lines);
    }
    lines.add("method", format!("{}: {}", fit.method, fit.reason));
    if fit.condition.is_some() || fit.backward_error.is_some() || fit.promise.is_some() {
        certificate_lines(fit, lines);
    }
    let mut rms: Vec<String> =
        rms.into_iter().filter_map(|(name, value)| Some(format!("{name} {}", significant(value?, 3)))).collect();
    rms.extend(fit.rms.normal_deg.map(|value| format!("normals {} deg", significant(value, 3))));
    lines.add("rms", rms.join("  "));
}

/// How far to trust the numbers.
fn certificate_lines(fit: &FitPart, lines: &mut Lines) {
    let certificate = |value: Option<f64>| value.map_or("unknown".to_string(), |v| significant(v, 2));
    let (condition, backward) = (certificate(fit.condition), certificate(fit.backward_error));
    lines.add("numbers", format!("condition {condition}, backward error {backward}"));
    if let Some(digits) = &fit.promise {
        let digits = format!(
            "coefficients {:.0}, S {:.0}, R {:.0}",
            digits.coefficients.floor(),
            digits.shape_index.floor(),
            digits.curvedness.floor()
        );
        lines.add("digits", format!("at least {digits} are free of rounding; noise is not counted here"));
    }
}

fn parametric_lines(part: &ParametricPart, lines: &mut Lines) {
    lines.add("(u, v)", part.parametrisation.clone());
    let folds = if part.fold_free { "free of folds" } else { "NOT free of folds" };
    let settled = if part.settled { "" } else { ", not settled" };
    lines.add(
        "map",
        format!(
            "{folds}, smallest Jacobian {} of the mean, bends {} times what neighbours felt, {} steps{settled}",
            significant(part.smallest_jacobian, 2),
            significant(part.bending, 2),
            part.iterations
        ),
    );
}

fn measure(part: &MeasurePart, decimals: impl Fn(f64) -> usize) -> String {
    let Some(mean) = part.mean else { return "undefined".into() };
    let places = decimals(mean);
    // where fixed form would be all zeros or a row of digits, every number gets an exponent
    let fixed = mean == 0.0 || (SMALLEST..LARGEST).contains(&mean.abs());
    let shown = |value: f64| if fixed { format!("{value:.places$}") } else { significant(value, DIGITS) };
    let mut text = shown(mean);
    if let Some(sd) = part.sd {
        let _ = write!(text, ", varies by {} over the patch", shown(sd));
    }
    if let Some(u) = part.u {
        let _ = write!(text, ",  u = {}", significant(u, 2));
    }
    if let Some([lo, hi]) = part.interval {
        let level = part.level.map_or(String::new(), |level| format!("{} ", percent(level)));
        let _ = write!(text, ",  {level}[{}, {}]", shown(lo), shown(hi));
    }
    if let (Some(noise), Some(model)) = (part.u_noise, part.u_model) {
        let _ = write!(text, "  (noise {}, model {})", significant(noise, 2), significant(model, 2));
    }
    text
}

/// Decimals that show `digits` significant digits of `value`.
pub(super) fn decimals(value: f64, digits: i32) -> usize {
    if value == 0.0 || !value.is_finite() {
        return digits as usize;
    }
    // 17 decimals show the last bit of anything near 1
    (digits - 1 - value.abs().log10().floor() as i32).clamp(0, 17) as usize
}

/// `value` with `digits` significant digits, in scientific form where it is very small or very large.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.*e}", (digits - 1) as usize);
    }
    format!("{value:.*}", decimals(value, digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones() {
        let cases =
            [(96.8512, "96.85"), (0.0073012, "0.007301"), (1.2e-16, "1.200e-16"), (0.0, "0"), (12345.6, "12346")];
        for (value, text) in cases {
            assert_eq!(significant(value, 4), text);
        }
    }

    #[test]
    fn spread_is_cut_where_the_mean_is() {
        let part = MeasurePart { mean: Some(0.00730123), sd: Some(0.0012589), u: Some(1e-5), ..MeasurePart::default() };
        assert_eq!(measure(&part, |m| decimals(m, DIGITS)), "0.007301, varies by 0.001259 over the patch,  u = 1.0e-5");
        assert_eq!(measure(&MeasurePart::default(), |_| 4), "undefined");
    }
}
