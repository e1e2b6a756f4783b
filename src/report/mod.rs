//! Results as JSON, tables, maps and pictures, written to any `Write`. No statistics are computed here.
//!
//! ```text
//! a fit, or a saved surface   ->  Description        describe_fit, describe_saved
//! FitDocument (palpate.fit/1) ->  JSON, or a table for people
//! ShapeMaps, ParametricMaps   ->  maps.csv, maps.npz, shape.svg
//! a saved surface at points   ->  PointTable         points_at
//! ```

mod describe;
mod describe_height;
mod describe_parametric;
mod description;
mod document;
mod json;
mod maps;
mod parametric;
mod picture;
mod point_table;
mod points;
mod schema;
mod study;
mod study_picture;
mod study_samples;
mod study_table;
mod sweep;
mod table;

pub use describe::{compute_shape, describe_fit, describe_saved, points_at};
pub use description::{Description, ShownGrid, Subject, inverse_crime_remark};
pub use document::{ChosenPart, FitDocument, Seconds};
pub use json::write_json;
pub use schema::{fit_schema, study_schema};
pub use study::{
    NamedQuantities, NamedShares, QuantityPart, STUDY_SCHEMA, StudyDocument, effect_parts, study_notes, sum_parts,
};
pub use study_picture::write_study_picture;
pub use study_table::{stopped_words, write_study_table};
pub use sweep::{SweepPoint, write_sweep_csv, write_sweep_picture, write_sweep_table};
pub use table::{significant, write_table};
