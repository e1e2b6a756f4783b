//! The fit of a spline that is named: a height field over x and y.

use palpate_fitting::fit::{Fit, FitError, FitOptions, NormalSigma, Objective, Statistic, fit_contacts};
use palpate_geometry::surface::{HeightField, SurfacePoint};

use crate::border::{PalpateStatus, copy_out, faulty, fill, guarded, hand_over, named, take_back, unanswered};
use crate::contacts::PalpateContacts;
use crate::shape::{PalpateClass, PalpateEstimate, PalpateKind, PalpateMapPoint, PalpateShape, class_of};

/// Which spline is fitted. `palpate_fit_defaults` fills it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateFitOptions {
    /// Degrees in x and y, 1 to 9.
    pub degree: [usize; 2],
    /// Uniform segments in x and y.
    pub segments: [usize; 2],
    /// Points of the map in x and y.
    pub grid: [usize; 2],
    /// Level of the intervals, between 0 and 1.
    pub level: f64,
    /// Whether the domain is `domain`; else it is the contacts' own rectangle.
    pub has_domain: bool,
    /// x0, x1, y0, y1.
    pub domain: [f64; 4],
    /// Known standard deviation of heights; 0: both are estimated with the fit. Counts for contacts that all have normals.
    pub sigma_z: f64,
    /// Known standard deviation of normals, degrees.
    pub sigma_normal_deg: f64,
}

/// A fitted height field.
#[derive(Debug)]
pub struct PalpateFit {
    fit: Fit,
    surface: HeightField,
    contacts: usize,
}

/// A point of a height field.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpatePoint {
    /// Height.
    pub z: f64,
    /// Slopes dz/dx and dz/dy.
    pub slopes: [f64; 2],
    /// Unit normal towards +z.
    pub normal: [f64; 3],
    /// Larger principal curvature.
    pub k1: f64,
    /// Smaller principal curvature.
    pub k2: f64,
    /// Shape index; NaN where both curvatures vanish.
    pub shape_index: f64,
    /// Curvedness.
    pub curvedness: f64,
}

fn options_of(options: &PalpateFitOptions) -> FitOptions {
    let known = options.sigma_z > 0.0;
    let sigma = NormalSigma::Known { z: options.sigma_z, normal_deg: options.sigma_normal_deg };
    let plain = FitOptions {
        degree: options.degree,
        segments: options.segments,
        grid: options.grid,
        level: options.level,
        domain: options.has_domain.then_some(options.domain),
        ..FitOptions::default()
    };
    if known { plain.with_objective(Objective::Normals(sigma)) } else { plain }
}

fn estimate_of(statistic: &Statistic) -> PalpateEstimate {
    let [mean, u] = [statistic.mean, statistic.u].map(|v| v.unwrap_or(f64::NAN));
    let [lo, hi] = statistic.interval.map_or([f64::NAN; 2], |interval| [interval.lo, interval.hi]);
    PalpateEstimate { mean, u, lo, hi }
}

fn shape_of(found: &PalpateFit) -> PalpateShape {
    let fit = &found.fit;
    let shape = fit.shape();
    let own = shape.class_probability.iter().find(|(class, _)| *class == shape.class);
    let [lo, hi] = shape.radius_interval.unwrap_or([f64::NAN; 2]);
    let radius = shape.radius.map(|mean| PalpateEstimate { mean, u: f64::NAN, lo, hi });
    PalpateShape {
        class_: class_of(shape.class),
        other_class: PalpateClass::None,
        class_probability: own.map_or(f64::NAN, |(_, p)| *p),
        kind: PalpateKind::HeightField,
        kind_probability: f64::NAN,
        shape_index: estimate_of(&shape.shape_index),
        curvedness: estimate_of(&shape.curvedness),
        radius: radius.unwrap_or(PalpateEstimate::UNDEFINED),
        level: fit.options().level,
        contacts: found.contacts,
        outliers: 0,
    }
}

fn point_of(here: &SurfacePoint) -> PalpatePoint {
    let principal = here.derivatives().principal();
    PalpatePoint {
        z: here.z,
        slopes: [here.zx, here.zy],
        normal: here.normal(),
        k1: principal.map_or(f64::NAN, |p| p.k1),
        k2: principal.map_or(f64::NAN, |p| p.k2),
        shape_index: principal.and_then(|p| p.shape_index()).unwrap_or(f64::NAN),
        curvedness: principal.map_or(f64::NAN, |p| p.curvedness()),
    }
}

/// Fills the options with the paper's spline: degree 2, one segment.
///
/// # Safety
/// `options` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_fit_defaults(options: *mut PalpateFitOptions) -> PalpateStatus {
    guarded(|| {
        let FitOptions { degree, segments, grid, level, .. } = FitOptions::default();
        let (has_domain, domain) = (false, [0.0; 4]);
        let defaults = PalpateFitOptions {
            degree,
            segments,
            grid,
            level,
            has_domain,
            domain,
            sigma_z: 0.0,
            sigma_normal_deg: 0.0,
        };
        // SAFETY: as this function asks of its caller
        unsafe { fill(options, "options", || Ok(defaults)) }
    })
}

/// Fits the spline that the options name. `options` may be null: then the defaults count. Its intervals count noise alone.
/// Where some contacts have no normal, those of the others are not used. Free the result by `palpate_fit_free`.
///
/// # Safety
/// `contacts` and `options` are null or name living values, and `fit` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_fit(
    contacts: *const PalpateContacts,
    options: *const PalpateFitOptions,
    fit: *mut *mut PalpateFit,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let contacts = unsafe { named(contacts, "contacts") }?;
        // SAFETY: likewise
        let options = unsafe { options.as_ref() }.map_or_else(FitOptions::default, options_of);
        let refused = |error: FitError| match error {
            FitError::TooFew { .. } | FitError::Collinear { .. } | FitError::Rank { .. } => unanswered(error),
            error => faulty(error),
        };
        let found = fit_contacts(&contacts.whole(), &options).map_err(refused)?;
        let surface = found.input_surface().map_err(refused)?;
        // SAFETY: likewise
        unsafe { hand_over(PalpateFit { fit: found, surface, contacts: contacts.points.len() }, fit) }
    })
}

/// Frees a fit; null is nothing.
///
/// # Safety
/// `fit` is null or a handle that was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_fit_free(fit: *mut PalpateFit) {
    // SAFETY: as this function asks of its caller
    unsafe { take_back(fit) }
}

/// What the fitted surface looks like.
///
/// # Safety
/// `fit` is null or a living handle, and `shape` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_fit_shape(fit: *const PalpateFit, shape: *mut PalpateShape) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let found = unsafe { named(fit, "fit") }?;
        // SAFETY: likewise
        unsafe { fill(shape, "shape", || Ok(shape_of(found))) }
    })
}

/// The fitted surface over a place. Outside the domain its end polynomials go on.
///
/// # Safety
/// `fit` is null or a living handle, and `point` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_fit_at(
    fit: *const PalpateFit,
    x: f64,
    y: f64,
    point: *mut PalpatePoint,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let surface = &unsafe { named(fit, "fit") }?.surface;
        if !(x.is_finite() && y.is_finite()) {
            return Err(faulty("the place is not finite"));
        }
        // SAFETY: likewise
        unsafe { fill(point, "point", || Ok(point_of(&surface.at(x, y)))) }
    })
}

/// The map of the surface over its grid: as many of its points as there is room for; `count` is how many there are. `points`
/// may be null, to ask for the count alone.
///
/// # Safety
/// `fit` is null or a living handle, `points` is null or has room for `room` values, `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_fit_map(
    fit: *const PalpateFit,
    points: *mut PalpateMapPoint,
    room: usize,
    count: *mut usize,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let fit = &unsafe { named(fit, "fit") }?.fit;
        let maps = &fit.shape().maps;
        let frame = fit.frame();
        let columns = maps.k1.ncols();
        let all = (0..maps.k1.len()).map(|k| {
            let at = [k / columns.max(1), k % columns.max(1)];
            let point = &maps.points[at];
            PalpateMapPoint {
                position: frame.direction_to_input([maps.grid.x[at[0]], maps.grid.y[at[1]], point.z]),
                normal: frame.direction_to_input(point.normal()),
                shape_index: maps.shape_index[at],
                curvedness: maps.curvedness[at],
                k1: maps.k1[at],
                k2: maps.k2[at],
                supported: maps.supported[at],
            }
        });
        // SAFETY: likewise
        unsafe { copy_out(all, points, room, count) }
    })
}
