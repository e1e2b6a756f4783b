//! Orders of accuracy beside what theory says.

use std::fmt::Write as _;
use std::io::Write;

use serde::Serialize;

use palpate_studies::frontier::Order;

/// Measured orders of one body, degree and kind of rows.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct OrderPart {
    /// Body of the scene.
    pub body: String,
    /// Degree.
    pub degree: usize,
    /// Which rows took part.
    pub rows: String,
    /// Orders of heights, slopes and curvatures over the last two halvings.
    pub found: [f64; 3],
    /// What theory says.
    pub theory: [f64; 3],
    /// Root mean square errors at 16, 32 and 64 segments.
    pub errors: [[f64; 3]; 3],
}

/// All of them.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct OrdersDocument {
    /// Schema.
    pub schema: &'static str,
    /// One for every body, degree and kind of rows.
    pub orders: Vec<OrderPart>,
}

impl OrdersDocument {
    /// The document of these orders.
    pub(crate) fn new(orders: &[Order]) -> OrdersDocument {
        let part = |order: &Order| OrderPart {
            body: order.body.into(),
            degree: order.degree,
            rows: order.rows.name().into(),
            found: order.found(),
            theory: order.theory(),
            errors: order.errors,
        };
        OrdersDocument { schema: "palpate.orders/1", orders: orders.iter().map(part).collect() }
    }
}

/// A table for people.
///
/// # Errors
/// What the system says.
pub(crate) fn write_orders_table(document: &OrdersDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from("order of accuracy over the last two halvings of the segments, and (theory)\n");
    // writing to a string cannot fail
    let _ = writeln!(
        text,
        "{:<10} {:>6}  {:<34} {:>13} {:>13} {:>13}",
        "body", "degree", "rows", "heights", "slopes", "curvatures"
    );
    for part in &document.orders {
        let words: Vec<String> = part
            .found
            .iter()
            .zip(&part.theory)
            .map(|(found, theory)| {
                let mark = if (found - theory).abs() > 0.15 { "*" } else { " " };
                format!("{:>13}", format!("{found:.2} ({theory}){mark}"))
            })
            .collect();
        let _ = writeln!(text, "{:<10} {:>6}  {:<34} {}", part.body, part.degree, part.rows, words.join(" "));
    }
    let _ = writeln!(
        text,
        "* farther than 0.15 from theory. Degree 2 with slope rows: the sum over evenly spaced stations is not the integral of\n\
         the slopes' errors; what is left tilts every segment the same way and adds up along the patch. Stations of Gauss's\n\
         quadrature bring the order back."
    );
    out.write_all(text.as_bytes())
}
