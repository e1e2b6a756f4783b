//! Results as JSON, tables, maps and pictures, written to any `Write`. Nothing is computed here.
//!
//! ```text
//! FitDocument (palpate.fit/1)  ->  JSON | table for people
//! ShapeMaps, ParametricMaps         ->  maps.csv, maps.npz, shape.svg
//! ```

mod document;
mod json;
mod maps;
mod parametric;
mod picture;
mod points;
mod schema;
mod study;
mod study_picture;
mod sweep;
mod table;

pub use document::{
    ChosenPart, FitDocument, FitPart, MeasurePart, ParametricPart, PromisePart, RmsPart, Seconds, ShapePart, Shares,
    SigmaPart, SpreadPart, TruthPart,
};
pub use json::write_json;
pub use maps::{write_maps_csv, write_maps_npz};
pub use parametric::{ParametricPointShape, write_parametric_maps_csv, write_parametric_points_csv};
pub use picture::{PictureOptions, write_picture};
pub use points::{PointShape, write_points_csv};
pub use schema::{fit_schema, study_schema};
pub use study::{
    EffectPart, LinearDocument, LinearQuantity, NamedQuantities, NamedShares, QuantilePart, QuantityPart, STUDY_SCHEMA,
    StandardErrors, StudyDocument, SumPart, effect_parts, stopped_words, study_notes, sum_parts, write_study_table,
};
pub use study_picture::write_study_picture;
pub use sweep::{SweepPoint, write_sweep_csv, write_sweep_picture, write_sweep_table};
pub use table::{significant, write_table};
