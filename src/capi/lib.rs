//! `palpate` for C and C++: contacts, named fits, recognition, and touch streams, behind functions that never panic.
//!
//! ```text
//! palpate_contacts_*      places, perhaps with normals
//! palpate_recognise       which shape they show: class, kind, S, R, radius, each with its interval
//! palpate_fit             the same under a spline that is named
//! palpate_stream_*        touches one by one, without memory being asked for
//! PalpateStatus           what went wrong; palpate_last_message says it in words
//! ```
//!
//! What is undefined is NaN here, because C has no other word for it. Every function that can fail gives a status. A fault of
//! the library itself is caught at the border and comes as `PALPATE_STATUS_INTERNAL`. A handle may be used by one thread at a
//! time.
//!
//! Unsafe code stands in these functions alone: they read what the caller's pointers name. `include/palpate.h` is made of this
//! crate by `src/capi/header.sh`, and a test compares the two.

// the border with C is made of raw pointers; nothing else of this crate is
#![allow(unsafe_code)]
#![warn(missing_docs)]

mod border;
mod contacts;
mod fit;
mod recognition;
mod shape;
mod stream;

pub use border::{PalpateStatus, palpate_last_message, palpate_version};
pub use contacts::{
    PalpateContacts, palpate_contacts_add, palpate_contacts_add_with_normal, palpate_contacts_clear,
    palpate_contacts_count, palpate_contacts_free, palpate_contacts_new,
};
pub use fit::{
    PalpateFit, PalpateFitOptions, PalpatePoint, palpate_fit, palpate_fit_at, palpate_fit_defaults, palpate_fit_free,
    palpate_fit_map, palpate_fit_shape,
};
pub use recognition::{
    PalpateRecogniseOptions, PalpateRecognition, palpate_recognise, palpate_recognise_defaults,
    palpate_recognition_distance, palpate_recognition_free, palpate_recognition_map, palpate_recognition_shape,
};
pub use shape::{
    PalpateClass, PalpateEstimate, PalpateKind, PalpateMapPoint, PalpateShape, palpate_class_name, palpate_kind_name,
};
pub use stream::{
    PalpateStream, PalpateStreamOptions, PalpateStreamShape, palpate_stream_clear, palpate_stream_count,
    palpate_stream_defaults, palpate_stream_free, palpate_stream_new, palpate_stream_push,
    palpate_stream_push_with_normal, palpate_stream_shape,
};
