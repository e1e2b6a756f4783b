//! Results as JSON, tables, maps and pictures, written to any `Write`. No statistics are computed here.
//!
//! ```text
//! a fit, or a saved surface   ->  Description        describe_fit, describe_saved
//! FitDocument (palpate.fit/1) ->  JSON, or a table for people
//! ShapeMaps, ParametricMaps   ->  maps.csv, maps.npz
//! SurfaceView                 ->  report.html, shape.svg and the other pictures
//! a saved surface at points   ->  PointTable         points_at
//! ```

mod adaptive_answer;
mod bare_surface;
mod body_graph;
mod charts;
mod colour;
mod describe;
mod description;
mod diff;
mod diff_picture;
mod document;
mod drawing;
mod drawing_pdf;
mod drawing_png;
mod explore;
mod explore_picture;
mod fits;
mod fold;
mod frontier;
mod frontier_columns;
mod frontier_long;
mod frontier_orders;
mod frontier_picture;
mod frontier_stages;
mod frontier_table;
mod frontier_words;
mod glyphs;
mod height_view;
mod interval_words;
mod json;
mod maps;
mod objects;
mod page;
mod parametric;
mod parametric_view;
mod parts;
mod parts_file;
mod parts_picture;
mod percent;
mod pictures;
mod png;
mod point_shapes;
mod point_table;
mod points;
mod radius;
mod recognised_view;
mod relations;
#[cfg(test)]
mod sample;
mod schema;
mod shape_part;
mod study;
mod study_picture;
mod study_table;
mod subject;
mod surface_maps;
mod surface_view;
mod sweep;
mod sweep_picture;
mod table;
mod truth_part;
mod uncertainty;
mod words;

pub(crate) use adaptive_answer::AdaptiveAnswer;
pub(crate) use bare_surface::document_of_surface;
pub(crate) use body_graph::{write_dot, write_graphml};
pub(crate) use charts::KINDS;
pub(crate) use describe::recognised::move_document;
pub(crate) use describe::{Answer, compute_shape, describe_fit, describe_saved, points_at};
pub(crate) use description::{Description, inverse_crime_remark};
pub(crate) use diff::{DiffDocument, SurfacePart, write_diff_csv, write_diff_table};
pub(crate) use diff_picture::write_diff_picture;
pub(crate) use document::{ChosenPart, FitDocument, LackOfFitPart, Seconds, ShapePart, Shares, TriedPart};
pub(crate) use explore::{ExploreDocument, write_explore_csv, write_explore_table};
pub(crate) use explore_picture::write_explore_picture;
pub(crate) use fits::{FitsDocument, FitsRow, write_fits_csv, write_fits_line};
pub(crate) use fold::{PAGE_WIDTH, folded};
pub(crate) use frontier::{
    AskedPart, BesidePart, FRONTIER_SCHEMA, FrontierDocument, FrontierRecord, PickPart, RecommendedPart, StagePart,
};
pub(crate) use frontier_columns::{frontier_columns, write_frontier_csv};
pub(crate) use frontier_orders::{OrdersDocument, write_orders_table};
pub(crate) use frontier_picture::{has_picture, write_frontier_picture};
pub(crate) use frontier_stages::write_stages_picture;
pub(crate) use frontier_table::write_frontier_table;
pub(crate) use json::write_json;
pub(crate) use page::{
    INTERRUPTED, PartsBody, Provenance, SweepPage, TablePage, write_explore_page, write_fit_page, write_frontier_page,
    write_parts_page, write_study_page, write_sweep_page, write_table_page,
};
pub(crate) use parts::{PartsDocument, write_parts_csv, write_parts_table};
pub(crate) use parts_file::parts_of_document;
pub(crate) use parts_picture::write_parts_picture;
pub(crate) use percent::percent;
pub(crate) use pictures::{PictureFormat, SurfacePictures};
pub(crate) use point_shapes::{PointShapesFormat, write_point_shapes, write_point_shapes_summary};
pub(crate) use radius::radius_bounds;
pub use schema::{diff_schema, explore_schema, fit_schema, fits_schema, frontier_schema, parts_schema, study_schema};
pub(crate) use study::{
    NamedQuantities, QuantityPart, STUDY_SCHEMA, StudyDocument, effect_parts, study_notes, sum_parts,
};
pub(crate) use study_picture::write_study_picture;
pub(crate) use study_table::{stopped_words, write_study_table};
pub(crate) use subject::Subject;
pub(crate) use surface_maps::ShownGrid;
pub(crate) use sweep::{SweepPoint, sweep_columns, write_sweep_csv, write_sweep_table};
pub(crate) use sweep_picture::write_sweep_picture;
pub(crate) use table::{significant, write_table};
pub(crate) use words::{Audience, chance, named, write_words};
