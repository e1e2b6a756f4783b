//! The test for a plane: the best plane against the fit, by chi-square with declared sds, else by F.
//!
//! ```text
//! rise = rss(plane) - rss(fit),  nu = rank - 3        declared:  P(chi^2_nu > rise)
//!                                                      else:     P(F_nu,rest > (rise/nu) / (rss(fit)/rest))
//! ```

use statrs::function::{beta::beta_reg, gamma::gamma_ur};

/// The significance at which the best plane is rejected; below it a patch is taken as a plane.
pub const PLANE_SIGNIFICANCE: f64 = 0.01;

/// Upper tail of chi-square with `freedom` degrees: the p-value of the plane under declared sds.
pub fn chi_square_upper_tail(value: f64, freedom: f64) -> f64 {
    if value <= 0.0 || freedom <= 0.0 {
        return 1.0;
    }
    gamma_ur(0.5 * freedom, 0.5 * value)
}

/// Upper tail of F with `(freedom, rest)` degrees.
pub fn f_upper_tail(value: f64, freedom: f64, rest: f64) -> f64 {
    if value.is_nan() || value <= 0.0 || freedom <= 0.0 || rest <= 0.0 {
        return 1.0;
    }
    // P(F > f) = I_x(rest/2, freedom/2), x = rest/(rest + freedom f)
    beta_reg(0.5 * rest, 0.5 * freedom, rest / (rest + freedom * value))
}

/// The least squares plane `z = h + gx x + gy y` through a grid of heights, and its largest deviation.
pub fn best_plane(points: impl Iterator<Item = [f64; 3]> + Clone) -> ([f64; 3], f64) {
    let count = points.clone().count().max(1) as f64;
    let mean = points.clone().fold([0.0; 3], |m, p| [0, 1, 2].map(|k| m[k] + p[k] / count));
    let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for p in points.clone() {
        let d = [0, 1, 2].map(|k| p[k] - mean[k]);
        xx += d[0] * d[0];
        xy += d[0] * d[1];
        yy += d[1] * d[1];
        xz += d[0] * d[2];
        yz += d[1] * d[2];
    }
    let determinant = xx * yy - xy * xy;
    let (gx, gy) = if determinant > 0.0 {
        ((yy * xz - xy * yz) / determinant, (xx * yz - xy * xz) / determinant)
    } else {
        (0.0, 0.0)
    };
    let deviation =
        points.map(|p| ((p[2] - mean[2]) - gx * (p[0] - mean[0]) - gy * (p[1] - mean[1])).abs()).fold(0.0, f64::max);
    ([mean[2] - gx * mean[0] - gy * mean[1], gx, gy], deviation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_match_tables() {
        assert!((chi_square_upper_tail(16.811_893_829_770_93, 6.0) - 0.01).abs() < 1e-12);
        // F with 2 and n degrees has the closed form (1 + 2 f/n)^(-n/2)
        assert!((f_upper_tail(3.7, 2.0, 10.0) - 1.74_f64.powi(-5)).abs() < 1e-14);
        assert_eq!(f_upper_tail(f64::NAN, 6.0, 9.0), 1.0);
    }
}
