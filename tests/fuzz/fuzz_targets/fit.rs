//! The fit of small inputs: any bit pattern as coordinates, slopes or normals and weights, under any mix of options. An
//! error is an answer; a panic, a hang or an answer without finite coefficients is a find. The fault planted here stands
//! behind a fit: coefficients that the data leave free.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::Contacts;
use palpate::fit::{FitOptions, Method, NormalSigma, Objective, Robust, SlopeWeights, Smooth, SurfaceKind};
use palpate::parametric::FittedSurface;

/// Touches at most: hard enough. Loss, smoothing and noise levels iterate, so that a fit in ten takes a tenth of a second.
const MOST_TOUCHES: usize = 40;

fuzz_target!(|bytes: &[u8]| {
    let Some((head, rest)) = bytes.split_at_checked(6) else { return };
    let numbers: Vec<f64> = rest.chunks_exact(4).map(number).collect();
    let kind = head[0] % 3;
    let columns = if kind == 1 { 5 } else { 6 };
    let touches = (numbers.len() / columns).min(MOST_TOUCHES);
    let column = |k: usize| numbers[k * touches..(k + 1) * touches].to_vec();
    let mut contacts = Contacts::from_positions(column(0), column(1), column(2));
    match kind {
        0 => contacts.weights.z = Some(column(3)),
        1 => contacts = contacts.with_slopes(column(3), column(4)),
        _ => contacts = contacts.with_normals(column(3), column(4), column(5)),
    }
    match FittedSurface::of(&contacts, &options(head)) {
        Ok((FittedSurface::Height(fit), _)) => {
            assert!(fit.surface().coefficients().iter().all(|c| c.is_finite()));
            let _ = (fit.shape(), fit.certificate(), fit.rms());
            assert!(!cfg!(feature = "planted") || fit.solution().unsupported.is_empty(), "the planted fault");
        }
        Ok((FittedSurface::Parametric(fit), _)) => {
            let largest = fit.shape().curvedness.mean;
            assert!(largest.is_none_or(f64::is_finite));
            assert!(!cfg!(feature = "planted") || fit.certificate().settled, "the planted fault");
        }
        Err(_) => {}
    }
});

/// Half of the numbers are tame, sixteenths in [-8, 8); the others are the f32 of their bits, NaN and all.
fn number(bytes: &[u8]) -> f64 {
    let word = [bytes[0], bytes[1], bytes[2], bytes[3]];
    if word[3] & 1 == 0 { f64::from(word[0]) / 16.0 - 8.0 } else { f64::from(f32::from_le_bytes(word)) }
}

fn options(head: &[u8]) -> FitOptions {
    let objectives = [
        Objective::Auto,
        Objective::Slopes(SlopeWeights::Tangent),
        Objective::Slopes(SlopeWeights::Auto),
        Objective::Slopes(SlopeWeights::Explicit([0.0, 1.0, 1.0])),
        Objective::Normals(NormalSigma::Known { z: 0.1, normal_deg: 5.0 }),
    ];
    let pick = |k: usize, choices: usize| usize::from(head[k]) % choices;
    FitOptions::default()
        .with_degrees(1 + pick(1, 4), 1 + pick(2, 4))
        .with_segments(1 + pick(1, 12) / 4, 1 + pick(2, 12) / 4)
        .with_objective(objectives[pick(3, objectives.len())])
        .with_method([Method::Auto, Method::Cholesky, Method::Qr][pick(4, 3)])
        .with_smooth([Smooth::None, Smooth::Auto, Smooth::Lambda(0.01)][pick(5, 3)])
        .with_robust([Robust::None, Robust::Huber, Robust::Tukey][pick(5, 9) / 3])
        .with_grid(3, 3)
        .with_surface([SurfaceKind::Height, SurfaceKind::Parametric, SurfaceKind::Auto][pick(0, 9) / 3])
        .with_closed([pick(0, 36) / 9 % 2 == 1, pick(0, 36) / 18 == 1])
}
