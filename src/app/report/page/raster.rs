//! Colours of a map as a PNG inside the page: one pixel a point, transparent where nothing is known.

use png::ColorType;

use super::super::colour::Colour;
use super::super::png::encoded;
use crate::io::base64;

/// A picture of `width` x `height` pixels as a `data:` address; `colour(column, row)` counts rows from the top.
///
/// # Errors
/// What the system says of memory.
pub(super) fn data_url(
    width: usize,
    height: usize,
    colour: impl Fn(usize, usize) -> Option<Colour>,
) -> std::io::Result<String> {
    // PNG knows no picture without pixels
    if width == 0 || height == 0 {
        return Ok("data:,".into());
    }
    let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let pixels = places.flat_map(|(column, row)| match colour(column, row) {
        Some([r, g, b]) => [r, g, b, 255],
        None => [0; 4],
    });
    let file = encoded([width, height], ColorType::Rgba, &pixels.collect::<Vec<u8>>())?;
    Ok(format!("data:image/png;base64,{}", base64(&file)))
}
