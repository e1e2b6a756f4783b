//! The references of `tests/golden/*.json`, for tests and benches.

#![allow(dead_code, reason = "a test and a bench share this file, and each reads other fields")]

pub(crate) mod judge;
pub(crate) mod radius;
pub(crate) mod record;
pub(crate) mod table;

use std::path::PathBuf;

use serde_json::Value;

/// One golden file (not every test and bench reads every field); 25-digit numerals rounded to the nearest double.
pub(crate) struct Golden {
    /// FNV-1a of the inputs' bits.
    pub inputs: u64,
    /// Rows of the weighted problem.
    pub equations: usize,
    /// Coefficients.
    pub unknowns: usize,
    /// Rank in exact arithmetic.
    pub rank: usize,
    /// Condition of the column-equilibrated weighted rows.
    pub condition: f64,
    /// kappa + kappa^2 |r| / (|E| |c|).
    pub loss: f64,
    /// Norm of the weighted residual.
    pub weighted_residual: f64,
    /// `none`, `constant` (known up to one), or `least roughness`.
    pub gauge: String,
    /// `None`: not determined even by least roughness.
    pub coefficients: Option<Vec<f64>>,
    /// Every how many contacts a fitted height is stored.
    pub every: usize,
    /// Fitted heights at the contacts.
    pub fitted: Vec<f64>,
    /// Shape index on the grid, x slowest; `None` where undefined.
    pub shape_index: Vec<Option<f64>>,
    /// Curvedness on the grid.
    pub curvedness: Vec<f64>,
    /// Change of S (absolute) and R (relative) that a backward error of 2^-53 allows.
    pub allowed: [f64; 2],
}

impl Golden {
    /// Reads the golden file of a case.
    pub(crate) fn read(name: &str) -> Golden {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.json"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let json: Value = serde_json::from_str(&text).unwrap();
        let list = |v: &Value| v.as_array().map(|a| a.iter().map(number).collect::<Vec<f64>>());
        let count = |key: &str| json[key].as_u64().unwrap() as usize;
        let maybe = |v: &Value| if v.is_null() { None } else { Some(number(v)) };
        Golden {
            inputs: u64::from_str_radix(json["inputs"].as_str().unwrap(), 16).unwrap(),
            equations: count("equations"),
            unknowns: count("unknowns"),
            rank: count("rank"),
            condition: number(&json["condition"]),
            loss: number(&json["loss"]),
            weighted_residual: number(&json["weighted_residual"]),
            gauge: json["gauge"].as_str().unwrap_or("none").to_string(),
            coefficients: list(&json["coefficients"]),
            every: json["fitted"]["every"].as_u64().unwrap_or(1) as usize,
            fitted: list(&json["fitted"]["heights"]).unwrap_or_default(),
            shape_index: json["S"].as_array().map(|a| a.iter().map(maybe).collect()).unwrap_or_default(),
            curvedness: list(&json["R"]).unwrap_or_default(),
            allowed: ["S", "R"].map(|k| if json["allowed"].is_null() { 0.0 } else { number(&json["allowed"][k]) }),
        }
    }
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| v.as_str().unwrap().parse().unwrap())
}
