//! A drawing as a part of the report page: inline SVG whose colours come from the style sheet, so that it follows light and
//! dark, and whose marks say their values.
//!
//! A mark's `<title>` is read out by screen readers and shown by browsers without JavaScript, too.

use super::html::text;
use crate::report::colour::hex;
use crate::report::drawing::{Drawing, Hook, Shape};

impl Drawing {
    /// As an SVG element of this class; `label` says in a sentence what it shows, `more` are further attributes.
    pub(in crate::report) fn inline(&self, class: &str, label: &str, more: &str) -> String {
        let ([width, height], label) = (self.size, text(label));
        let head =
            format!("class=\"{class}\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"{label}\"");
        format!("<svg {head}{more}>\n{}</svg>\n", self.elements())
    }

    /// Its shapes alone.
    pub(in crate::report) fn elements(&self) -> String {
        let mut out = String::new();
        let none = Hook::default();
        for (k, shape) in self.shapes.iter().enumerate() {
            let hook = self.hooks.get(&k).unwrap_or(&none);
            if !hook.file_only {
                out.push_str(&element(shape, hook));
                out.push('\n');
            }
        }
        out
    }
}

/// One element with its class and its words.
fn element(shape: &Shape, hook: &Hook) -> String {
    let class = if hook.class.is_empty() { String::new() } else { format!(" class=\"{}\"", hook.class) };
    // what is pointed at can have the focus
    let (focus, words) = match &hook.words {
        Some(words) => (" tabindex=\"-1\"", format!("<title>{}</title>", text(words))),
        None => ("", String::new()),
    };
    let plain = hook.class.is_empty() || hook.own_colour;
    match shape {
        Shape::Line { points, width, colour } => {
            let colours =
                if plain { format!(" style=\"stroke:{};stroke-width:{width}\"", hex(*colour)) } else { String::new() };
            format!("<polyline{class} points=\"{}\" fill=\"none\"{colours}{focus}>{words}</polyline>", list(points))
        }
        Shape::Area { points, fill, .. } => {
            let colours = if plain { format!(" style=\"fill:{}\"", hex(*fill)) } else { String::new() };
            format!("<polygon{class} points=\"{}\"{colours}{focus}>{words}</polygon>", list(points))
        }
        Shape::Dots { points, radius, colour } => {
            let colours = if plain { format!(" style=\"fill:{}\"", hex(*colour)) } else { String::new() };
            let dots = points.iter().map(|[x, y]| {
                format!("<circle{class} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"{colours}{focus}>{words}</circle>")
            });
            dots.collect()
        }
        Shape::Word { at: [x, y], text: word, anchor, upwards, .. } => {
            let turned = if *upwards { format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"") } else { String::new() };
            format!(
                "<text{class} x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{}\" dominant-baseline=\"central\"{turned}>{}</text>",
                anchor.name(),
                text(word)
            )
        }
        Shape::Image { corner: [x, y], size: [width, height], raster } => format!(
            "<image{class} href=\"{}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             preserveAspectRatio=\"none\"/>",
            raster.data_url()
        ),
    }
}

fn list(points: &[[f64; 2]]) -> String {
    points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<String>>().join(" ")
}
