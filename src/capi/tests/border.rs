//! The border holds: answers are those of the Rust library, and nulls, faults and handles are refused in words.

#![allow(unsafe_code)] // a test of functions that C calls

use std::ffi::CStr;
use std::ptr::{null, null_mut};

use palpate_capi::*;
use palpate_fitting::fit::{FitOptions, fit_contacts};
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::{Recognition, RecognitionOptions};

fn message() -> String {
    // SAFETY: the words stay until the next refusal
    unsafe { CStr::from_ptr(palpate_last_message()) }.to_str().unwrap().to_string()
}

/// A ball of radius 10, with errors that are a fixed pattern.
fn ball() -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let touch = |k: usize| {
        let (x, y) = (1.5 * (k % 6) as f64 - 3.75, 1.5 * (k / 6) as f64 - 3.75);
        let z = (100.0 - x * x - y * y).sqrt();
        ([x, y, z + 0.02 * (2.3 * k as f64).sin()], [x / 10.0, y / 10.0 + 0.01 * (1.7 * k as f64).sin(), z / 10.0])
    };
    (0..36).map(touch).unzip()
}

fn handed() -> *mut PalpateContacts {
    let mut contacts = null_mut();
    let (points, normals) = ball();
    // SAFETY: the place is this function's own
    unsafe {
        assert_eq!(palpate_contacts_new(&mut contacts), PalpateStatus::Ok);
        for ([x, y, z], [nx, ny, nz]) in points.into_iter().zip(normals) {
            assert_eq!(palpate_contacts_add_with_normal(contacts, x, y, z, nx, ny, nz), PalpateStatus::Ok);
        }
        assert_eq!(palpate_contacts_count(contacts), 36);
    }
    contacts
}

fn shape_by(read: impl FnOnce(*mut PalpateShape) -> PalpateStatus) -> PalpateShape {
    let mut shape = std::mem::MaybeUninit::uninit();
    assert_eq!(read(shape.as_mut_ptr()), PalpateStatus::Ok);
    // SAFETY: it was filled
    unsafe { shape.assume_init() }
}

#[test]
fn answers_are_those_of_the_library() {
    let (points, normals) = ball();
    let own = Contacts::from_points(&points).with_normal_vectors(&normals);
    let contacts = handed();
    // SAFETY: pointers name values of this function, and handles are freed once
    unsafe {
        let (mut found, mut count, mut distance) = (null_mut(), 0, 0.0);
        assert_eq!(palpate_recognise(contacts, null(), &mut found), PalpateStatus::Ok);
        let shape = shape_by(|place| palpate_recognition_shape(found, place));
        let expected = Recognition::of(&own, &RecognitionOptions::default()).unwrap();
        assert_eq!((shape.class_, shape.kind), (PalpateClass::Cap, PalpateKind::Sphere));
        assert_eq!(Some(shape.radius.mean), expected.radius);
        assert_eq!(Some([shape.radius.lo, shape.radius.hi]), expected.radius_interval);
        assert_eq!([shape.curvedness.lo, shape.curvedness.hi], expected.curvedness.interval);
        assert_eq!(palpate_recognition_map(found, null_mut(), 0, &mut count), PalpateStatus::Ok);
        assert_eq!(count, expected.map.len());
        let mut points = Vec::with_capacity(count);
        assert_eq!(palpate_recognition_map(found, points.as_mut_ptr(), count, &mut count), PalpateStatus::Ok);
        points.set_len(count);
        assert_eq!(points[7].position, expected.map[7].position);
        assert_eq!(palpate_recognition_distance(found, 0.0, 0.0, 12.0, &mut distance), PalpateStatus::Ok);
        assert_eq!(distance, expected.distance([0.0, 0.0, 12.0]));
        palpate_recognition_free(found);

        let mut fit = null_mut();
        assert_eq!(palpate_fit(contacts, null(), &mut fit), PalpateStatus::Ok);
        let shape = shape_by(|place| palpate_fit_shape(fit, place));
        let expected = fit_contacts(&own, &FitOptions::default()).unwrap();
        assert_eq!(Some(shape.curvedness.mean), expected.shape().curvedness.mean);
        assert_eq!(Some(shape.curvedness.u), expected.shape().curvedness.u);
        assert_eq!(palpate_fit_map(fit, null_mut(), 0, &mut count), PalpateStatus::Ok);
        assert_eq!(count, 64);
        palpate_fit_free(fit);
        palpate_contacts_free(contacts);
    }
}

#[test]
fn faults_are_refused_in_words() {
    let contacts = handed();
    // SAFETY: pointers are null or name values of this function, and handles are freed once
    unsafe {
        assert_eq!(palpate_contacts_add(null_mut(), 0.0, 0.0, 0.0), PalpateStatus::Null);
        assert_eq!(message(), "contacts is null");
        assert_eq!(palpate_contacts_add(contacts, 0.0, f64::NAN, 0.0), PalpateStatus::Input);
        assert!(message().contains("y of contact 36 is NaN"), "{}", message());
        assert_eq!(palpate_contacts_add_with_normal(contacts, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), PalpateStatus::Input);
        assert_eq!(palpate_contacts_count(contacts), 36);
        assert_eq!(palpate_recognise(contacts, null(), null_mut()), PalpateStatus::Null);
        let mut found = null_mut();
        let mut options = std::mem::MaybeUninit::uninit();
        assert_eq!(palpate_recognise_defaults(options.as_mut_ptr()), PalpateStatus::Ok);
        let mut options = options.assume_init();
        options.level = 1.5;
        assert_ne!(palpate_recognise(contacts, &options, &mut found), PalpateStatus::Ok);
        assert!(found.is_null() && !message().is_empty());
        assert_eq!(palpate_contacts_clear(contacts), PalpateStatus::Ok);
        assert_eq!(palpate_contacts_add(contacts, 0.0, 0.0, 0.0), PalpateStatus::Ok);
        assert_eq!(palpate_recognise(contacts, null(), &mut found), PalpateStatus::NoAnswer);
        assert!(found.is_null() && message().contains("1 contact"), "{}", message());
        let mut stream = null_mut();
        let mut plan = std::mem::MaybeUninit::uninit();
        assert_eq!(palpate_stream_defaults(plan.as_mut_ptr()), PalpateStatus::Ok);
        let mut plan = plan.assume_init();
        assert_eq!(palpate_stream_new(&plan, &mut stream), PalpateStatus::Input);
        plan.domain = [0.0, 1.0, 0.0, 1.0];
        (plan.window, plan.decay) = (5, 0.5);
        assert_eq!(palpate_stream_new(&plan, &mut stream), PalpateStatus::Input);
        assert!(stream.is_null() && message().contains("one of them"));
        // nothing is freed of null, and nothing is counted
        palpate_contacts_free(null_mut());
        palpate_fit_free(null_mut());
        palpate_recognition_free(null_mut());
        palpate_stream_free(null_mut());
        assert_eq!(palpate_stream_count(null()) + palpate_contacts_count(null()), 0);
        palpate_contacts_free(contacts);
    }
}
