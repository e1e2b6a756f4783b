//! `explore`: where it touched and in which order; u(S) and u(R)/R against the contacts.

use std::io::Write;

use super::charts::{Falling, touched};
use super::drawing::{Anchor, Drawing};
use super::explore::ExploreDocument;
use super::pictures::{PictureFormat, write_drawing};

/// Left edge of the right column, and upper edges of its panels.
const RIGHT: f64 = 620.0;
const TOPS: [f64; 2] = [66.0, 332.0];

/// Draws an exploration.
///
/// # Errors
/// What the system says.
pub(crate) fn write_explore_picture(
    document: &ExploreDocument,
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    write_drawing(&draw(document), format, out)
}

fn draw(document: &ExploreDocument) -> Drawing {
    let mut drawing = Drawing::new(1040.0, 560.0);
    let title = format!(
        "{}: {} contacts by {}, stopped by {}",
        document.scene, document.contacts, document.strategy, document.stopped
    );
    drawing.word([12.0, 18.0], title, 16.0, Anchor::Start);
    drawing.word([70.0, TOPS[0] - 14.0], "touches in their order (grey: the first sweep)", 14.0, Anchor::Start);
    touched(&mut drawing, [[70.0, 530.0], [TOPS[0], 514.0]], document);
    for (falling, top) in Falling::both(document).into_iter().zip(TOPS) {
        drawing.word([RIGHT, top - 14.0], falling.name, 14.0, Anchor::Start);
        if falling.is_known(document) {
            falling.draw(&mut drawing, [[RIGHT, 1024.0], [top, top + 182.0]], document);
        } else {
            drawing.word([RIGHT, top + 20.0], "undefined", 14.0, Anchor::Start);
        }
    }
    drawing
}
