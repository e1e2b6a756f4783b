//! The extension module behind the Python package `palpate`: NumPy arrays in, NumPy arrays out.
//!
//! ```text
//! palpate/*.py (names, views of results)  ->  _native (arrays, errors, threads)  ->  the crate palpate
//! ```
//!
//! Nothing is computed here that the crate does not compute. The interpreter's lock is released while the crate works;
//! long work looks between its chunks whether Ctrl-C was pressed.

mod arrays;
mod attend;
mod batch;
mod contacts;
mod differences;
mod errors;
mod evaluate;
mod explorations;
mod fitting;
mod frontiers;
mod inputs;
mod live;
mod options;
mod plans;
mod scenes;
mod stream;
mod studies;
mod surfaces;
mod tiles;

use pyo3::prelude::*;

/// The compiled part of palpate; use the names of the package instead.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::{class_names, fit_batch};
    #[pymodule_export]
    use super::differences::diff_documents;
    #[pymodule_export]
    use super::explorations::{TouchPlanner, explore};
    #[pymodule_export]
    use super::fitting::{FitCore, adaptive_surface, fit_contacts, fit_grid, time_fit, unit_name};
    #[pymodule_export]
    use super::frontiers::{frontier, frontier_of_contacts};
    #[pymodule_export]
    use super::inputs::{column_names, parts_of, read_contacts};
    #[pymodule_export]
    use super::live::LiveCore;
    #[pymodule_export]
    use super::plans::{PlanCore, plan_adaptive};
    #[pymodule_export]
    use super::scenes::{scene_contacts, scene_texts};
    #[pymodule_export]
    use super::stream::{StreamShape, TouchStream};
    #[pymodule_export]
    use super::studies::{StudyPlan, StudyRun, merge_parts};
    #[pymodule_export]
    use super::surfaces::{ParametricSurface, Surface};
    #[pymodule_export]
    use super::tiles::{
        TiledFit, contact_tile, merged_runs, part_bounds, part_run, run_of_roots, run_slice, tile_answer, tile_sides,
    };

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
