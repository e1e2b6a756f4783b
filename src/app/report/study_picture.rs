//! `study`: how S and R scatter with interval, mean and truth, shares of the classes, shares of the effects.

use std::io::Write;

use super::charts::{Scatter, class_shares, draw_shares, effect_shares};
use super::drawing::{Anchor, Drawing};
use super::percent::percent;
use super::pictures::{PictureFormat, write_drawing};
use super::study::StudyDocument;
use palpate_studies::montecarlo::Ranked;

/// Left edges of the columns of histograms, and of those of shares.
const PANELS: [f64; 2] = [0.0, 480.0];
const COLUMNS: [[f64; 2]; 3] = [[20.0, 300.0], [330.0, 620.0], [650.0, 940.0]];
/// Edges of the histograms.
const TOP: f64 = 46.0;
const BOTTOM: f64 = 330.0;

/// Draws a study; `ranked` are the values of S and of R.
///
/// # Errors
/// What the system says.
pub(crate) fn write_study_picture(
    document: &StudyDocument,
    ranked: &[Ranked<'_>; 2],
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    write_drawing(&draw(document, ranked), format, out)
}

fn draw(document: &StudyDocument, ranked: &[Ranked<'_>; 2]) -> Drawing {
    let mut drawing = Drawing::new(960.0, 420.0);
    let title = format!("{}: {} replicates", document.scene, document.replicates);
    drawing.word([12.0, 18.0], title, 16.0, Anchor::Start);
    let both = [("S, shape index", &document.shape_index), ("R, curvedness", &document.curvedness)];
    for (((name, part), ranked), left) in both.into_iter().zip(ranked).zip(PANELS) {
        let Some(scatter) = Scatter::new(part, ranked) else {
            drawing.word([left + 20.0, TOP + 20.0], format!("{name}: undefined"), 14.0, Anchor::Start);
            continue;
        };
        scatter.draw(&mut drawing, [[left + 74.0, left + 462.0], [TOP, BOTTOM]], name);
        if let Some(far) = scatter.far() {
            drawing.word([left + 74.0, TOP - 12.0], far, 12.0, Anchor::Start);
        }
    }
    let words = format!(
        "pale: interval that holds {} of the measurements; black: mean; orange: truth",
        percent(document.level)
    );
    drawing.word([20.0, BOTTOM + 50.0], words, 12.0, Anchor::Start);
    let [s, r] = effect_shares(document);
    let classes = class_shares(document);
    let captions = ["share of each class", "share of the variance of S", "share of the variance of R"];
    let rows = [classes, s, r];
    let ends = COLUMNS.into_iter().zip(captions).zip(&rows).filter(|(_, rows)| !rows.is_empty());
    let ends: Vec<f64> =
        ends.map(|((edges, caption), rows)| draw_shares(&mut drawing, edges, BOTTOM + 86.0, caption, rows)).collect();
    drawing.size[1] = ends.into_iter().fold(drawing.size[1], f64::max);
    drawing
}
