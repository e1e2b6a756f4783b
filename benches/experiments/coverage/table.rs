//! The tables of `benches/runs/coverage.md`: the family's intervals, how narrow they could be, and random surfaces by kind.

use crate::cells::cell::{Cell, CellQuantity, Inside};
use crate::cells::pooled::{Pooled, PooledQuantity};

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".into(), |v| format!("{v:.digits$}"))
}

fn percent(value: Option<f64>, digits: usize) -> String {
    number(value.map(|v| 100.0 * v), digits)
}

fn both(quantities: &[CellQuantity; 2], of: impl Fn(&CellQuantity) -> String) -> String {
    format!("{} / {}", of(&quantities[0]), of(&quantities[1]))
}

fn with_interval(inside: &Inside) -> String {
    match inside.interval {
        Some([lo, hi]) => format!("{} [{:.0}, {:.0}]", percent(inside.share(), 1), 100.0 * lo, 100.0 * hi),
        None => "-".into(),
    }
}

fn forecast(class: Option<[f64; 2]>) -> String {
    class.map_or("-".into(), |[given, right]| format!("{given:.2}, {right:.2}"))
}

/// How often intervals held the truth, and how wide they were.
pub(crate) fn print_family(cells: &[Cell]) {
    println!(
        "| scene | N | failed | noise alone S / R | named S / R | S chosen | width | half width | R chosen | width | class |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for cell in cells {
        let [s, r] = &cell.quantities;
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            cell.scene,
            cell.replicates,
            cell.failed,
            both(&cell.quantities, |q| percent(q.linear.share(), 0)),
            both(&cell.quantities, |q| percent(q.named.share(), 0)),
            with_interval(&s.chosen),
            number(s.chosen_over_oracle, 2),
            number(s.chosen_half_width.filter(|_| s.chosen.asked > 0), 3),
            with_interval(&r.chosen),
            number(r.chosen_over_oracle, 2),
            forecast(cell.class_forecast)
        );
    }
}

/// Widths beside the least of intervals that also hold departures from the family.
pub(crate) fn print_least(cells: &[Cell]) {
    println!(
        "| scene | ours S / R | least with departures of 1 % | ours/least | 1.5 forbidden from, % of the relief |"
    );
    println!("|---|---|---|---|---|");
    for cell in cells.iter().filter(|c| c.quantities.iter().any(|q| q.least_over_oracle.is_some())) {
        let goal = |q: &CellQuantity| match (q.least_over_oracle, q.goal_departure) {
            (Some(_), None) => "never".into(),
            (_, goal) => percent(goal, 2),
        };
        let over_least = |q: &CellQuantity| q.chosen_over_oracle.zip(q.least_over_oracle).map(|(a, b)| a / b);
        println!(
            "| {} | {} | {} | {} | {} |",
            cell.scene,
            both(&cell.quantities, |q| number(q.chosen_over_oracle, 2)),
            both(&cell.quantities, |q| number(q.least_over_oracle, 2)),
            both(&cell.quantities, |q| number(over_least(q), 2)),
            both(&cell.quantities, goal)
        );
    }
}

/// Random surfaces by kind.
pub(crate) fn print_pooled(pooled: &[Pooled]) {
    let error =
        |k: usize, value: Option<f64>| if k == 0 { number(value, 3) } else { format!("{} %", percent(value, 1)) };
    println!("| kind | surfaces | | inside, % of asked | width/oracle | median error | 90 % of errors | class |");
    println!("|---|---|---|---|---|---|---|---|");
    for one in pooled {
        for (k, letter) in ["S", "R"].into_iter().enumerate() {
            let PooledQuantity { inside, asked, over_oracle, median_error, of_90_percent } = &one.quantities[k];
            println!(
                "| {} | {} | {letter} | {} of {asked} | {} | {} | < {} | {} |",
                one.kind,
                one.surfaces,
                percent(*inside, 1),
                number(*over_oracle, 2),
                error(k, *median_error),
                error(k, *of_90_percent),
                forecast(one.class_forecast)
            );
        }
    }
}
