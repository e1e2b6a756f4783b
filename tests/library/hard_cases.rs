//! Each hard case of the laboratory against its reference in 80 digits (`tests/golden/`).

#[path = "../golden/mod.rs"]
pub(crate) mod golden;

use golden::Golden;
use golden::judge::{Judged, judge};
use golden::record::{Tolerance, assert_like};
use golden::{radius, record, table};
use palpate::fit::{Objective, fit_contacts};
use palpate_laboratory::hard_cases::{CaseData, DenseRows, Expectation, HardCase, digits_each};
use palpate_laboratory::hard_cases::{FILIPPELLI_CERTIFIED, LONGLEY_CERTIFIED};
use palpate_numeric::solve::{DenseMethod, DenseSolution, SolveError, solve_dense};

/// The inputs here and those the reference solved are the same bits.
fn same_inputs(name: &str) -> (HardCase, Golden) {
    let case = HardCase::named(name).unwrap();
    let golden = Golden::read(name);
    assert_eq!(format!("{:016x}", case.fingerprint()), format!("{:016x}", golden.inputs), "inputs of {name}");
    (case, golden)
}

/// Normal rows stop when no coefficient moves by more than 1e-10 of the largest (design, section 1).
const NORMAL_ROWS_DIGITS: f64 = 10.0;

fn check(name: &str) {
    let (case, golden) = same_inputs(name);
    let judged = judge(&case, &golden);
    check_record(&case, &judged);
    match case.expectation {
        Expectation::RankDeficient => check_deficient(&judged),
        Expectation::Gap => check_gap(&case, &golden, &judged),
        _ => check_digits(&case, &judged),
    }
}

/// The line of `benches/runs/hard-cases.md`. Digits found are those of a rounding error, which another instruction set
/// makes anew; so are conditions beyond 1e12 and errors of rounding.
fn check_record(case: &HardCase, judged: &Judged) {
    let recorded = record::read("hard-cases");
    let line = recorded.lines().find(|line| line.split_whitespace().next() == Some(case.name)).unwrap();
    assert_like(&table::row(case, judged), line, &Tolerance { relative: 0.1, absolute: 2.5 });
}

/// `benches/runs/radius.md` is what palpate computes, but for rounding.
#[test]
fn the_recorded_errors_of_s_are_found_again() {
    let tolerance = Tolerance { relative: 0.011, absolute: 1e-15 };
    let (table, recorded) = (radius::table(), record::read("radius"));
    assert_eq!(table.lines().count(), recorded.lines().count());
    table.lines().zip(recorded.lines()).for_each(|(found, line)| assert_like(found, line, &tolerance));
}

/// `benches/runs/hard-cases.md` holds every case once, in the library's order, and no broken guarantee.
#[test]
fn the_recorded_table_holds_every_case() {
    let recorded = record::read("hard-cases");
    assert!(recorded.starts_with(&table::header()));
    let cases = HardCase::all();
    let lines: Vec<&str> = recorded.lines().skip(2).collect();
    let names: Vec<&str> = lines.iter().take(cases.len()).filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(names, cases.iter().map(|case| case.name).collect::<Vec<_>>());
    assert_eq!(lines.len(), cases.len() + 2);
    assert!(lines[cases.len()].starts_with("guaranteed above found: 0 of "), "{}", lines[cases.len()]);
}

/// Found at least what the data's conditioning allows less one digit, promised at most what is found.
fn check_digits(case: &HardCase, judged: &Judged) {
    assert!(judged.answered, "refused: {}", judged.method);
    let most = if matches!(case.options.objective, Objective::Normals(_)) { NORMAL_ROWS_DIGITS } else { f64::INFINITY };
    for (k, what) in ["coefficients", "S", "R"].iter().enumerate() {
        let Some(found) = judged.found[k] else { continue };
        let allowed = judged.allowed[k].unwrap().min(most);
        assert!(found >= allowed - 1.0, "{what}: found {found:.2} digits, the data allow {allowed:.2}");
        if let Some(promised) = judged.promised[k] {
            assert!(promised <= found, "{what}: promised {promised:.2} digits, found {found:.2}");
        }
    }
}

/// A point where k1 - k2 is zero to the last bit has no gradient of S, but S and its error there are known all the same.
#[test]
fn an_exact_umbilic_promises_digits() {
    let (case, golden) = same_inputs("umbilic_paraboloid");
    let judged = judge(&case, &golden);
    let [_, of_s, of_r] = judged.promised;
    assert!(of_s.unwrap() > 12.0 && of_r.unwrap() > 12.0, "{:?}", judged.promised);
}

/// A refusal that says why, or the fitted heights of any minimiser, which are unique.
fn check_deficient(judged: &Judged) {
    if judged.answered {
        let error = judged.fitted.unwrap();
        assert!(error < 1e-13, "fitted heights off by {error:.1e}");
        assert!(judged.unsupported > 0, "nothing is called unsupported");
    } else {
        assert!(judged.method.contains("line") || judged.method.contains("rank"), "{}", judged.method);
    }
}

/// The hole of radius 0.6: nothing moves by 0.3 residual sd two segments away from it, inside no height is off by half the
/// data's range (plain least squares is off by hundreds), and its centre is masked. Where the hill itself stays within the
/// data's range widened by half of it (its top lies in the hole of the other two cases: 1.0 over 0.997), so does the fit.
fn check_gap(case: &HardCase, golden: &Golden, judged: &Judged) {
    let CaseData::Contacts(contacts) = &case.data else { panic!() };
    assert!(judged.answered && judged.unsupported > 0);
    let fit = fit_contacts(contacts, &case.options).unwrap();
    let surface = fit.input_surface().unwrap();
    let sd = golden.weighted_residual / (golden.equations as f64 - golden.rank as f64).sqrt();
    for (k, reference) in golden.fitted.iter().enumerate() {
        let (x, y) = (contacts.x[k * golden.every], contacts.y[k * golden.every]);
        if x.hypot(y) > 1.0 {
            assert!((surface.at(x, y).z - reference).abs() < 0.3 * sd, "moved at ({x}, {y})");
        }
    }
    let low = contacts.z.iter().copied().fold(f64::INFINITY, f64::min);
    let high = contacts.z.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.5 * (high - low);
    let lattice = (0..41 * 41).map(|k| ((k / 41) as f64 / 34.0 - 0.6, (k % 41) as f64 / 34.0 - 0.6));
    let hole: Vec<(f64, f64)> = lattice.filter(|(x, y)| x.hypot(*y) < 0.6).collect();
    let within = |h: f64| h > low - margin && h < high + margin;
    let hill_within = hole.iter().all(|&(x, y)| within(hill(case.name, x, y)));
    assert_eq!(hill_within, case.name == "disc_gap_flank");
    let worst = hole.iter().map(|&(x, y)| (surface.at(x, y).z - hill(case.name, x, y)).abs()).fold(0.0, f64::max);
    println!("{}: worst error inside {worst:.3}, {} free", case.name, judged.unsupported);
    for (x, y) in hole {
        let (z, truth) = (surface.at(x, y).z, hill(case.name, x, y));
        assert!((z - truth).abs() < margin, "{z} for {truth} inside the hole at ({x}, {y})");
        assert!(within(z) || !hill_within, "{z} inside the hole at ({x}, {y})");
    }
    let maps = &fit.shape().maps;
    assert!(!maps.supported[[10, 10]], "the centre of the hole is not masked");
    assert!(maps.supported[[0, 10]], "the edge of the patch is masked");
}

/// The hill without noise.
fn hill(case: &str, x: f64, y: f64) -> f64 {
    let from_top = if case == "disc_gap_flank" { x - 1.0 } else { x };
    1.0 / (1.0 + from_top * from_top + 2.0 * y * y)
}

macro_rules! each_case {
    ($($(#[$mark:meta])? $name:ident)*) => {
        $($(#[$mark])? #[test] fn $name() { check(stringify!($name)); })*

        #[test]
        fn every_case_of_the_library_is_tested() {
            let tested = [$(stringify!($name)),*];
            let library: Vec<&str> = HardCase::all().iter().map(|case| case.name).collect();
            assert_eq!(tested[..], library[..]);
        }
    };
}

each_case! {
    umbilic_paraboloid umbilic_cup_pixels umbilic_lemon umbilic_monkey_saddle umbilic_sphere_quartic sphere_r1e3
    sphere_r1e5 sphere_r1e7 sphere_r1e9 cylinder45_r10 cylinder45_r1e3 cylinder45_r1e6 cylinder45_r1e9 plane_level
    plane_tilted rim_slopes_degree2 rim_slopes_degree4 rim_normals_degree2 rim_normals_degree4 horizontal_normals
    one_finger one_finger_heights two_fingers two_fingers_heights collinear collinear_heights one_contact
    disc_gap_heights disc_gap_slopes disc_gap_flank duplicated_exactly duplicated_one_ulp_apart knots_coincident knots_nearly_coincident
    crease_on_double_knot contacts_on_knots degree_one_slopes_on_knots degree_nine_single_segment
    degree_nine_heights clustered_ten_thousand_to_one clustered_heights weights_heights_1e12 weights_slopes_1e12
    weights_rows_1e12 weights_blocks_1e12 offset_1e8 offset_1e8_scattered offset_1e8_normals offset_1e8_heights
    scale_1e_minus_9 scale_1e9 aspect_1e6
    slopes_only
    slopes_only_by_row_weights
    contradictory_slopes contradictory_normals random_normals gross_outlier_heights gross_outlier_slope hilbert_axes
    hilbert_even_degree_nine lengths_near_overflow lengths_near_underflow heights_1e100 heights_1e_minus_200
    weights_1e200
    weights_1e_minus_200
    nist_longley nist_filippelli_raw nist_filippelli_centred hilbert_rows
}

fn dense(name: &str, method: DenseMethod) -> Result<DenseSolution, SolveError> {
    let case = HardCase::named(name).unwrap();
    let CaseData::Rows(DenseRows { rows, rhs }) = &case.data else { panic!() };
    let values: Vec<f64> = rows.t().iter().copied().collect();
    solve_dense(rows.nrows(), rows.ncols(), &values, rhs, method)
}

fn dense_digits(name: &str, method: DenseMethod) -> f64 {
    digits_each(&dense(name, method).unwrap().coefficients, &Golden::read(name).coefficients.unwrap())
}

#[test]
fn filippelli_by_every_method() {
    assert!(dense_digits("nist_filippelli_raw", DenseMethod::Qr) > 7.0);
    assert!(dense_digits("nist_filippelli_raw", DenseMethod::SemiNormal) > 7.0);
    let cholesky = dense("nist_filippelli_raw", DenseMethod::Cholesky);
    assert!(matches!(cholesky, Err(SolveError::NotPositiveDefinite { .. })), "{cholesky:?}");
    let auto = dense("nist_filippelli_raw", DenseMethod::Auto).unwrap();
    assert!(auto.reason.contains("Cholesky breaks down"), "{}", auto.reason);
    assert!(digits_each(&auto.coefficients, &FILIPPELLI_CERTIFIED) > 7.0);
    assert!(dense_digits("nist_filippelli_centred", DenseMethod::Cholesky) > 7.0);
}

#[test]
fn longley_to_twelve_digits() {
    for method in [DenseMethod::Auto, DenseMethod::Cholesky, DenseMethod::SemiNormal, DenseMethod::Qr] {
        assert!(dense_digits("nist_longley", method) > 12.0);
    }
    let auto = dense("nist_longley", DenseMethod::Auto).unwrap();
    assert!(digits_each(&auto.coefficients, &LONGLEY_CERTIFIED) > 12.0);
}
