//! Nearly vertical and vertical surfaces: radius 5.7 on a patch whose corner lies 5.657 from the centre (slopes of 8).

use super::HardCase;
use super::inputs::{linspace, normal_rows, options, sites, sphere, sweep, tangent, with_normals, with_slopes};
use palpate_fitting::fit::{FitOptions, FrameChoice};
use palpate_geometry::contact::Contacts;

/// A half pipe of radius 4 along y: the normals of the outer fingers are horizontal, `nz = 0`.
fn half_pipe() -> Contacts {
    let sites = sites(&[-4.0, -2.0, 0.0, 2.0, 4.0], &linspace(-4.0, 4.0, 9));
    let x: Vec<f64> = sites.iter().map(|s| s[0]).collect();
    let y = sites.iter().map(|s| s[1]).collect();
    let z: Vec<f64> = x.iter().map(|v| (16.0 - v * v).sqrt()).collect();
    let nx = x.iter().map(|v| v / 4.0).collect();
    let nz = z.iter().map(|h| h / 4.0).collect();
    let ny = vec![0.0; x.len()];
    Contacts::from_positions(x, y, z).with_normals(nx, ny, nz)
}

pub(super) fn cases() -> Vec<HardCase> {
    let slopes = || with_slopes(&sweep(3), sphere(5.7));
    let normals = || with_normals(&sweep(3), sphere(5.7));
    // without this choice a horizontal normal would rotate the frame, and the reference is written in the input's axes
    let upright = FitOptions { frame: Some(FrameChoice::Keep), ..options(2, normal_rows(1.0, 15.0)) };
    vec![
        HardCase::contacts("rim_slopes_degree2", "slopes up to 8 at the corners", slopes(), options(2, tangent())),
        HardCase::contacts("rim_slopes_degree4", "slopes up to 8, a wilder basis", slopes(), options(4, tangent())),
        HardCase::contacts(
            "rim_normals_degree2",
            "the same rim by normal rows, which divide by no nz",
            normals(),
            options(2, normal_rows(1.0, 15.0)),
        ),
        HardCase::contacts(
            "rim_normals_degree4",
            "small sigmas: Gauss-Newton far from its start",
            normals(),
            options(4, normal_rows(0.02, 2.0)),
        ),
        HardCase::contacts("horizontal_normals", "nz = 0 exactly", half_pipe(), upright),
    ]
}
