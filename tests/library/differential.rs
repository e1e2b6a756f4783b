//! Problems of others with their answers: SciPy's own tests of spline fitting, fits by G+Smo, and NIST's polynomials.
//!
//! ```text
//! heights on their knots -> palpate's surface      difference = largest |S - their values| / largest |value|
//! ```
//!
//! `cargo test --test library differential -- --nocapture` prints the table of `benches/runs/differential.md`; the cases are written by
//! `tests/differential/make.py`.

use palpate::fit::{FitOptions, Objective, SlopeWeights, Smooth, fit_contacts};
use palpate::{Contacts, Fit};
use serde_json::Value;

/// Where palpate answers differently, and why that is no error.
const REFUSED: [(&str, &str); 4] =
    [("lsq_constant", "too few"), ("lsq_bilinear", "too few"), ("lsq_line", "one line"), ("bisplrep_1310", "too few")];
/// SciPy answers with rank-deficient systems to 1e-8, and NIST's numbers have 15 digits; all others agree far better.
const AGREED: f64 = 1e-8;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map(|a| a.iter().filter_map(Value::as_f64).collect()).unwrap_or_default()
}

/// The places of a lattice at 0, 1, 2, ... with one height, which is not written down.
fn lattice(value: &Value) -> Option<[Vec<f64>; 3]> {
    let [rows, columns, height] = numbers(value)[..] else { return None };
    let places = || (0..rows as usize).flat_map(|i| (0..columns as usize).map(move |j| (i as f64, j as f64)));
    let (x, y): (Vec<f64>, Vec<f64>) = places().unzip();
    let z = vec![height; x.len()];
    Some([x, y, z])
}

struct Case {
    name: String,
    contacts: Contacts,
    options: FitOptions,
    at: [Vec<f64>; 2],
    values: Vec<f64>,
    slopes: Option<[Vec<f64>; 2]>,
}

fn case(value: &Value) -> Case {
    let column = |key: &str| numbers(&value[key]);
    let [x, y, z] = lattice(&value["constant"]).unwrap_or_else(|| ["x", "y", "z"].map(column));
    let [at, values] = match lattice(&value["constant"]) {
        Some([x, y, z]) => [vec![x, y], vec![z]],
        None => [[0, 1].map(|k| numbers(&value["at"][k])).to_vec(), vec![column("values")]],
    };
    let [p, q] = [0, 1].map(|k| value["degree"][k].as_u64().unwrap() as usize);
    let [tx, ty] = [0, 1].map(|k| numbers(&value["knots"][k]));
    let mut contacts = Contacts::from_positions(x, y, z);
    contacts.weights.z = value.get("weights").map(numbers);
    let options = FitOptions::default()
        .with_degrees(p, q)
        .with_knots(tx, ty)
        .with_objective(Objective::Slopes(SlopeWeights::Explicit([1.0; 3])));
    let options = match value.get("lambda").and_then(Value::as_f64) {
        Some(lambda) => options.with_smooth(Smooth::Lambda(lambda)),
        None => options,
    };
    let slopes = value.get("slopes").map(|slopes| [0, 1].map(|k| numbers(&slopes[k])));
    let [ax, ay] = [at[0].clone(), at[1].clone()];
    let name = value["name"].as_str().unwrap().to_string();
    Case { name, contacts, options, at: [ax, ay], values: values[0].clone(), slopes }
}

fn cases() -> Vec<(Case, String)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/differential/cases.json");
    let document: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let all = document["cases"].as_array().unwrap();
    all.iter().map(|value| (case(value), value["origin"].as_str().unwrap().to_string())).collect()
}

/// Largest difference of heights, and of slopes where the case has them, over the largest of both.
fn difference(case: &Case, fit: &Fit) -> f64 {
    let surface = fit.input_surface().unwrap();
    let largest = case.values.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let mut worst = 0.0_f64;
    for (k, (&x, &y)) in case.at[0].iter().zip(&case.at[1]).enumerate() {
        let point = surface.at(x, y);
        worst = worst.max((point.z - case.values[k]).abs());
        if let Some([zx, zy]) = &case.slopes {
            worst = worst.max((point.zx - zx[k]).abs()).max((point.zy - zy[k]).abs());
        }
    }
    worst / largest
}

#[test]
fn the_answers_are_those_of_scipy_gismo_and_nist() {
    let cases = cases();
    assert!(cases.len() >= 20, "{}", cases.len());
    println!("| case | origin | heights | unknowns | digits promised | difference |\n|---|---|---|---|---|---|");
    for (case, origin) in cases {
        let refused = REFUSED.iter().find(|(name, _)| *name == case.name);
        let said = match fit_contacts(&case.contacts, &case.options) {
            Ok(fit) => {
                assert!(refused.is_none(), "{} is answered", case.name);
                let (certificate, found) = (fit.certificate(), difference(&case, &fit));
                assert!(found <= AGREED, "{}: {found:e}", case.name);
                let (rank, unknowns) = (certificate.rank, certificate.unknowns);
                let free = if rank < unknowns { format!("{unknowns} (rank {rank})") } else { unknowns.to_string() };
                format!("{free} | {:.1} | {found:.1e}", certificate.digits_of_coefficients)
            }
            Err(error) => {
                let why = refused.map_or("", |(_, why)| why);
                assert!(!why.is_empty() && error.to_string().contains(why), "{}: {error}", case.name);
                format!("- | - | refused: {error}")
            }
        };
        println!("| {} | {origin} | {} | {said} |", case.name, case.contacts.len());
    }
}

/// The promise holds against exact solutions: heights are sums of coefficients with positive shares that add up to 1.
#[test]
fn nist_polynomials_keep_the_promised_digits() {
    let mut tried = 0;
    for (case, _) in cases().into_iter().filter(|(case, _)| case.name.starts_with("nist_")) {
        let fit = fit_contacts(&case.contacts, &case.options).unwrap();
        let coefficients = fit.input_surface().unwrap().coefficients().iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let largest = case.values.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
        let found = difference(&case, &fit) * largest / coefficients;
        let promised = 10.0_f64.powf(-fit.certificate().digits_of_coefficients);
        assert!(found <= promised + 1e-15, "{}: {found:e}, promised {promised:e}", case.name);
        tried += 1;
    }
    assert_eq!(tried, 7);
}
