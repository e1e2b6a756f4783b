//! Touches one by one, without memory being asked for after the plan is made.

use palpate_fitting::fit::Statistic;
use palpate_fitting::plans::{PlanError, TouchStream};
use palpate_numeric::bspline::{Knots, linspace};

use crate::border::{
    PalpateStatus, Refused, faulty, fill, guarded, hand_over, named, named_mut, take_back, unanswered,
};
use crate::shape::PalpateEstimate;

/// The plan of a stream. `palpate_stream_defaults` fills all but the domain.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateStreamOptions {
    /// Where touches may lie: x0, x1, y0, y1.
    pub domain: [f64; 4],
    /// Degrees in x and y, 1 to 9.
    pub degree: [usize; 2],
    /// Uniform segments in x and y.
    pub segments: [usize; 2],
    /// Standard deviations of heights and of slopes in x and in y.
    pub sigma: [f64; 3],
    /// Points in x and y over which S and R are averaged.
    pub grid: [usize; 2],
    /// Part of the domain's sides that is left out at each edge of the grid, below 1/2.
    pub inset: f64,
    /// Only the last so many touches count; 0: all of them.
    pub window: usize,
    /// Share that a touch counts of what it counted before, with every touch after it; 1: nothing fades. Not beside a window.
    pub decay: f64,
}

/// A fit that grows touch by touch.
#[derive(Debug)]
pub struct PalpateStream {
    stream: TouchStream,
}

/// S and R after the touches so far.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateStreamShape {
    /// Shape index S; its interval is NaN, because noise alone is known.
    pub shape_index: PalpateEstimate,
    /// Curvedness R, 1/length.
    pub curvedness: PalpateEstimate,
    /// Touches that count.
    pub contacts: usize,
}

/// What a stream refuses.
fn refused(error: PlanError) -> Refused {
    match error {
        PlanError::Solve(_) => unanswered(error),
        error => faulty(error),
    }
}

fn planned(options: &PalpateStreamOptions) -> Result<TouchStream, Refused> {
    let [x0, x1, y0, y1] = options.domain;
    let inset = options.inset;
    if !(0.0..0.5).contains(&inset) {
        return Err(faulty(format!("the inset is {inset}: a share of at least 0 and below 1/2 is needed")));
    }
    let axis =
        |k: usize, [lo, hi]: [f64; 2]| Knots::uniform(options.degree[k], options.segments[k], lo, hi).map_err(faulty);
    let knots = [axis(0, [x0, x1])?, axis(1, [y0, y1])?];
    let most = 4096;
    if options.grid.iter().any(|points| *points == 0 || *points > most) {
        return Err(faulty(format!("the grid is {:?}: 1 to {most} points each way are needed", options.grid)));
    }
    let points = |k: usize, [lo, hi]: [f64; 2]| {
        let cut = inset * (hi - lo);
        linspace(lo + cut, hi - cut, options.grid[k])
    };
    let (x, y) = (points(0, [x0, x1]), points(1, [y0, y1]));
    let stream = TouchStream::new(knots, options.sigma, [&x, &y]).map_err(refused)?;
    match (options.window, options.decay) {
        (0, 1.0) => Ok(stream),
        (0, decay) => stream.with_decay(decay).map_err(refused),
        (window, 1.0) => stream.with_window(window).map_err(refused),
        _ => Err(faulty("a window and a decay: give one of them")),
    }
}

fn estimate_of(statistic: &Statistic) -> PalpateEstimate {
    let [mean, u] = [statistic.mean, statistic.u].map(|v| v.unwrap_or(f64::NAN));
    PalpateEstimate { mean, u, ..PalpateEstimate::UNDEFINED }
}

/// Fills the options but for the domain, which is empty until it is named.
///
/// # Safety
/// `options` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_defaults(options: *mut PalpateStreamOptions) -> PalpateStatus {
    guarded(|| {
        let defaults = PalpateStreamOptions {
            domain: [0.0; 4],
            degree: [2; 2],
            segments: [1; 2],
            sigma: [1.0; 3],
            grid: [8; 2],
            inset: 0.0,
            window: 0,
            decay: 1.0,
        };
        // SAFETY: as this function asks of its caller
        unsafe { fill(options, "options", || Ok(defaults)) }
    })
}

/// Plans a stream. Free it by `palpate_stream_free`.
///
/// # Safety
/// `options` is null or names a living value, and `stream` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_new(
    options: *const PalpateStreamOptions,
    stream: *mut *mut PalpateStream,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let options = unsafe { named(options, "options") }?;
        let planned = planned(options)?;
        // SAFETY: likewise
        unsafe { hand_over(PalpateStream { stream: planned }, stream) }
    })
}

/// Frees a stream; null is nothing.
///
/// # Safety
/// `stream` is null or a handle that was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_free(stream: *mut PalpateStream) {
    // SAFETY: as this function asks of its caller
    unsafe { take_back(stream) }
}

/// Adds a touch with its slopes dz/dx and dz/dy. Asks for no memory where it succeeds; changes nothing where it fails.
///
/// # Safety
/// `stream` is null or a living handle that no other thread uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_push(
    stream: *mut PalpateStream,
    x: f64,
    y: f64,
    z: f64,
    zx: f64,
    zy: f64,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let stream = &mut unsafe { named_mut(stream, "stream") }?.stream;
        stream.push([x, y], z, [zx, zy]).map_err(refused)
    })
}

/// Adds a touch with its outward normal, of any length, with nz > 0. As `palpate_stream_push`.
///
/// # Safety
/// `stream` is null or a living handle that no other thread uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_push_with_normal(
    stream: *mut PalpateStream,
    x: f64,
    y: f64,
    z: f64,
    nx: f64,
    ny: f64,
    nz: f64,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let stream = &mut unsafe { named_mut(stream, "stream") }?.stream;
        if !(nz > 0.0 && nz.is_finite()) {
            return Err(faulty(format!("nz is {nz}, and a height field needs a normal with nz > 0")));
        }
        stream.push([x, y], z, [-nx / nz, -ny / nz]).map_err(refused)
    })
}

/// S and R after the touches so far, with the standard uncertainties that the sds of the plan give. Asks for no memory on
/// patches of one segment.
///
/// # Safety
/// `stream` is null or a living handle that no other thread uses meanwhile, and `shape` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_shape(
    stream: *mut PalpateStream,
    shape: *mut PalpateStreamShape,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let stream = &mut unsafe { named_mut(stream, "stream") }?.stream;
        let found = || {
            let [s, r] = stream.shape().map_err(refused)?;
            let (shape_index, curvedness) = (estimate_of(&s), estimate_of(&r));
            Ok(PalpateStreamShape { shape_index, curvedness, contacts: stream.contacts() })
        };
        // SAFETY: likewise
        unsafe { fill(shape, "shape", found) }
    })
}

/// Forgets all touches; the plan stays.
///
/// # Safety
/// `stream` is null or a living handle that no other thread uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_clear(stream: *mut PalpateStream) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        unsafe { named_mut(stream, "stream") }?.stream.clear();
        Ok(())
    })
}

/// Touches that count; 0 of null.
///
/// # Safety
/// `stream` is null or a living handle that no other thread changes meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_stream_count(stream: *const PalpateStream) -> usize {
    // SAFETY: as this function asks of its caller
    unsafe { named(stream, "stream") }.map_or(0, |stream| stream.stream.contacts())
}
