//! Each hard case of `palpate::cases` against its reference in 80 digits (`tests/golden/`).

mod golden;

use golden::Golden;
use palpate::cases::{HardCase, hard_case, hard_cases};

/// The inputs here and those the reference solved are the same bits.
fn same_inputs(name: &str) -> (HardCase, Golden) {
    let case = hard_case(name).unwrap();
    let golden = Golden::read(name);
    assert_eq!(format!("{:016x}", case.fingerprint()), format!("{:016x}", golden.inputs), "inputs of {name}");
    (case, golden)
}

fn check(name: &str) {
    let (_case, _golden) = same_inputs(name);
}

macro_rules! each_case {
    ($($name:ident)*) => {
        $(#[test] fn $name() { check(stringify!($name)); })*

        #[test]
        fn every_case_of_the_library_is_tested() {
            let tested = [$(stringify!($name)),*];
            let library: Vec<&str> = hard_cases().iter().map(|case| case.name).collect();
            assert_eq!(tested[..], library[..]);
        }
    };
}

each_case! {
    umbilic_paraboloid umbilic_cup_pixels umbilic_lemon umbilic_monkey_saddle umbilic_sphere_quartic sphere_r1e3
    sphere_r1e5 sphere_r1e7 sphere_r1e9 cylinder45_r10 cylinder45_r1e3 cylinder45_r1e6 cylinder45_r1e9
    plane_level plane_tilted rim_slopes_degree2 rim_slopes_degree4 rim_normals_degree2 rim_normals_degree4
    horizontal_normals one_finger one_finger_heights two_fingers two_fingers_heights collinear collinear_heights
    one_contact disc_gap_heights disc_gap_slopes duplicated_exactly duplicated_one_ulp_apart knots_coincident
    knots_nearly_coincident crease_on_double_knot contacts_on_knots degree_one_slopes_on_knots
    degree_nine_single_segment degree_nine_heights clustered_ten_thousand_to_one clustered_heights
    weights_heights_1e12 weights_slopes_1e12 weights_rows_1e12 weights_blocks_1e12 offset_1e8
    offset_1e8_scattered offset_1e8_normals offset_1e8_heights scale_1e_minus_9 scale_1e9 aspect_1e6 slopes_only
    slopes_only_by_row_weights contradictory_slopes contradictory_normals random_normals gross_outlier_heights
    gross_outlier_slope hilbert_axes hilbert_even_degree_nine lengths_near_overflow lengths_near_underflow
    heights_1e100 heights_1e_minus_200 weights_1e200 weights_1e_minus_200 nist_longley nist_filippelli_raw
    nist_filippelli_centred hilbert_rows
}
