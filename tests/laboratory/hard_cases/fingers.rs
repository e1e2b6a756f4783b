//! Too few fingers: contacts on one line, two lines, a diagonal, or a single contact.

use super::inputs::{equal, linspace, options, sites, sphere, with_heights, with_slopes};
use super::{Expectation, HardCase};

pub(super) fn cases() -> Vec<HardCase> {
    let stations = linspace(-4.0, 4.0, 9);
    let one = sites(&[0.0], &stations);
    let two = sites(&[-2.0, 2.0], &stations);
    let diagonal: Vec<[f64; 2]> = stations.iter().map(|&s| [s, s]).collect();
    let ball = || sphere(10.0);
    let deficient = |name, tests, contacts| {
        HardCase::contacts(name, tests, contacts, options(2, equal())).expecting(Expectation::RankDeficient)
    };
    let slopes_two = with_slopes(&two, ball());
    vec![
        deficient("one_finger", "rank 6 of 9: nothing says how the surface bends in x", with_slopes(&one, ball())),
        deficient("one_finger_heights", "rank 3 of 9: nor how it leans", with_heights(&one, ball())),
        HardCase::contacts("two_fingers", "slopes make two fingers enough", slopes_two, options(2, equal())),
        deficient("two_fingers_heights", "rank 6 of 9 without slopes", with_heights(&two, ball())),
        deficient("collinear", "rank 8 of 9: a diagonal sweep", with_slopes(&diagonal, ball())),
        deficient(
            "collinear_heights",
            "rank 5 of 9, and the least rough surface is not unique",
            with_heights(&diagonal, ball()),
        ),
        deficient("one_contact", "rank 3 of 9: its tangent plane", with_slopes(&[[1.0, 2.0]], ball())),
    ]
}
