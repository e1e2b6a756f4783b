//! Names that the benches, tests and fuzz targets of this repository reach. They are no part of the public interface and
//! change without notice.
//!
//! ```text
//! internals = what a measurement has to call and a user does not
//! ```

/// Hard cases and how digits are counted.
pub mod cases {
    pub use crate::cases::{
        CaseData, DIGITS_OF_A_DOUBLE, DenseRows, Expectation, FILIPPELLI_CERTIFIED, HardCase, LONGLEY_CERTIFIED, Lcg,
        digits_absolute, digits_each, digits_of,
    };
}

/// Random streams.
pub mod draws {
    pub use crate::draws::EffectDraws;
}

/// The loop of an exploration.
pub mod explore {
    pub use crate::explore::{Exploration, ExploreOptions, Goal, Look, Stopped, Strategy, explore};
}

/// The equations of a fit.
pub mod fit {
    pub use crate::fit::Equations;
}

/// Readers and writers.
#[cfg(feature = "cli")]
pub mod io {
    pub use crate::io::{
        ContactFormat, Input, Place, ReadOptions, Reading, read_input_bytes, read_surface_bytes, write_contacts,
    };
    /// Scene files.
    pub mod scene_file {
        pub use crate::io::scene_file::{
            SceneFile, SceneFileError, builtin, builtin_scenes, family_members, read_scene, read_scene_with,
        };
    }
}

/// Structured systems.
pub mod linalg {
    pub use crate::linalg::{
        DoubleDouble, RowWeights, SiteWeights, Sites, StencilMatrix, Targets, TensorShape, assemble, normal_rhs,
    };
}

/// Replicates.
pub mod montecarlo {
    pub use crate::montecarlo::ROW_NOISE;
}

/// Data to equations.
pub mod observation {
    pub use crate::observation::{ScatteredSites, to_csr};
}

/// Parametric surfaces.
pub mod parametric {
    pub use crate::parametric::choose_surface;
}

/// Parts beside the truth.
pub mod parts {
    pub use crate::parts::{Agreement, against};
}

/// The schema of documents.
#[cfg(feature = "cli")]
pub mod report {
    pub use crate::report::{
        diff_schema, explore_schema, fit_schema, fits_schema, frontier_schema, parts_schema, study_schema,
    };
}

/// The simulated world.
pub mod scene {
    pub use crate::scene::{ContactBatch, SurfacePoint, linspace};
    /// What each effect costs.
    pub mod explain {
        pub use crate::scene::explain::table;
    }
    /// Local shape.
    pub mod surface {
        pub use crate::scene::surface::Local;
    }
}

/// Maps of parametric surfaces.
pub mod shape {
    pub use crate::shape::{UvSupport, parametric_maps, uv_grid};
}

/// Kernels.
pub mod simd {
    pub use crate::simd::{CHACHA_BLOCKS, CHACHA_WORDS, Isa, REPLICATES, chacha8, gaussian_triples, multiply_add_peak};
}

/// Factorisations.
pub mod solve {
    pub use crate::solve::{Cholesky, DenseMethod, DenseSolution, SolveError, TriangularFactor, solve_dense};
}
