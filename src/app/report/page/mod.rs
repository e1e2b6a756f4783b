//! `report.html`: what a verb found, on one page that needs nothing else.
//!
//! ```text
//! Description, StudyDocument, ...  ->  sections of HTML and SVG, the document, data of the turning view  ->  Page
//! ```
//!
//! *One file.* A folder of scripts and pictures is torn apart by the first e-mail. Everything stands in the page, its policy
//! forbids the network, and `palpate show` reads the document in it back to the same bits.
//!
//! *three.js for space.* It has a release every month or two (MIT), brings turning by mouse and touch, and survives a lost
//! graphics context; the parts used here are 0.56 MB. OGL would be a tenth of that (55 kB), with its last release in March
//! 2025; plotly's smallest bundle with surfaces is 1.75 MB. Pages without a surface (studies, frontiers) leave it out.
//!
//! *No library for charts.* Charts and maps are SVG that is written here: they stand on the page before a script runs and
//! without one, follow light and dark by the style sheet, and print. The scripts add values to a pointer, nothing else.
//!
//! | file | |
//! |---|---|
//! | `shell.rs`, `html.rs`, `lengths.rs`, `provenance.rs` | the page around its sections, escaping, units, where it comes from |
//! | `fit_page.rs`, `surface_sections.rs`, `words.rs` | a surface: sections, sentences |
//! | `study_page.rs`, `frontier_page.rs`, `explore_page.rs`, `sweep_page.rs`, `parts_page.rs`, `table_page.rs` | the other verbs |
//! | `figure.rs`, `inline.rs`, `figures.rs`, `tables.rs` | charts (drawn by `report/charts`), maps and tables |
//! | `camera.rs`, `perspective.rs`, `body.rs` | still pictures in space |
//! | `view_data.rs` | data for the scripts |
//! | `assets/` | style, scripts, and in `vendor/` the library with its licence and the script that bundles it |

mod body;
mod camera;
mod explore_page;
mod figure;
mod figures;
mod fit_page;
mod frontier_page;
mod html;
mod inline;
mod lengths;
mod parts_page;
mod perspective;
mod provenance;
mod raster;
mod shell;
mod study_page;
mod surface_sections;
mod sweep_page;
mod table_page;
mod tables;
mod view_data;
mod words;

pub(crate) use body::PartsBody;
pub(crate) use explore_page::write_explore_page;
pub(crate) use fit_page::write_fit_page;
pub(crate) use frontier_page::write_frontier_page;
pub(super) use html::text as escaped;
pub(crate) use parts_page::write_parts_page;
pub(crate) use provenance::Provenance;
pub(crate) use study_page::{INTERRUPTED, write_study_page};
pub(crate) use sweep_page::{SweepPage, write_sweep_page};
pub(crate) use table_page::{TablePage, write_table_page};
