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
mod table;

pub use describe::{compute_shape, describe_fit, describe_saved, points_at};
pub use description::{Description, ShownGrid, Subject, inverse_crime_remark};
pub use document::{
    ChosenPart, FitDocument, FitPart, MeasurePart, ParametricPart, PromisePart, RmsPart, Seconds, ShapePart, Shares,
    SigmaPart, SpreadPart, TruthPart,
};
pub use json::write_json;
pub use maps::{write_maps_csv, write_maps_npz};
pub use parametric::{ParametricPointShape, write_parametric_maps_csv, write_parametric_points_csv};
pub use picture::{PictureOptions, write_picture};
pub use point_table::PointTable;
pub use points::{PointShape, write_points_csv};
pub use schema::fit_schema;
pub use table::{significant, write_table};
