//! The border: a status for what went wrong, its words, and no panic beyond.

use std::cell::RefCell;
use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What became of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PalpateStatus {
    /// It was done.
    Ok = 0,
    /// A pointer is null that must not be.
    Null = 1,
    /// A number, an option or a contact is faulty.
    Input = 2,
    /// The contacts are too few, or leave a question open, so that there is no answer.
    NoAnswer = 3,
    /// A fault of the library, which the message describes.
    Internal = 4,
}

/// Why a call was refused.
pub(crate) type Refused = (PalpateStatus, String);

thread_local! {
    /// The words of the last call that was refused on this thread, with a zero at their end.
    static LAST: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Does the work of one function. Nothing is allocated where it succeeds.
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), Refused>) -> PalpateStatus {
    // what the work changes is the caller's own, who is told that it failed
    let outcome = catch_unwind(AssertUnwindSafe(work));
    let (status, message) = match outcome {
        Ok(Ok(())) => return PalpateStatus::Ok,
        Ok(Err(refused)) => refused,
        Err(_) => {
            (PalpateStatus::Internal, "a fault of palpate: please report it with the contacts that led to it".into())
        }
    };
    LAST.with_borrow_mut(|last| {
        last.clear();
        // a zero inside would end the words early
        last.extend(message.bytes().filter(|byte| *byte != 0));
        last.push(0);
    });
    status
}

/// A pointer that must not be null.
pub(crate) fn null(name: &str) -> Refused {
    (PalpateStatus::Null, format!("{name} is null"))
}

/// Something that is not as it should be.
pub(crate) fn faulty(what: impl std::fmt::Display) -> Refused {
    (PalpateStatus::Input, what.to_string())
}

/// Contacts that give no answer.
pub(crate) fn unanswered(what: impl std::fmt::Display) -> Refused {
    (PalpateStatus::NoAnswer, what.to_string())
}

/// The words of the last call on this thread that was refused, in UTF-8; empty where none was. They stay until the next call
/// that is refused.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_last_message() -> *const c_char {
    LAST.with_borrow_mut(|last| {
        if last.is_empty() {
            last.push(0);
        }
        last.as_ptr().cast()
    })
}

/// The library's version, as `0.2.0`.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Puts a new handle where the caller wants it.
///
/// # Safety
/// `place` is null or can be written to.
pub(crate) unsafe fn hand_over<T>(value: T, place: *mut *mut T) -> Result<(), Refused> {
    if place.is_null() {
        return Err(null("the place of the handle"));
    }
    // SAFETY: it is not null, and by the caller's word it can be written to
    unsafe { *place = Box::into_raw(Box::new(value)) };
    Ok(())
}

/// Puts a value where the caller wants it; it is not computed where there is no such place.
///
/// # Safety
/// `place` is null or can be written to.
pub(crate) unsafe fn fill<T>(
    place: *mut T,
    name: &str,
    value: impl FnOnce() -> Result<T, Refused>,
) -> Result<(), Refused> {
    if place.is_null() {
        return Err(null(name));
    }
    let value = value()?;
    // SAFETY: it is not null, and by the caller's word it can be written to
    unsafe { place.write(value) };
    Ok(())
}

/// Takes a handle back and frees it; null is nothing.
///
/// # Safety
/// `handle` is null or came from [`hand_over`] and was not freed before.
pub(crate) unsafe fn take_back<T>(handle: *mut T) {
    if handle.is_null() {
        return;
    }
    // SAFETY: by the caller's word it is a box that was handed over and is given back once
    let owned = unsafe { Box::from_raw(handle) };
    // freeing runs no code of ours that could panic, but of others below it might
    let _ = catch_unwind(AssertUnwindSafe(|| drop(owned)));
}

/// What a pointer names.
///
/// # Safety
/// `pointer` is null or names a living value that nobody changes meanwhile.
pub(crate) unsafe fn named<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Refused> {
    // SAFETY: by the caller's word
    unsafe { pointer.as_ref() }.ok_or_else(|| null(name))
}

/// The same of what is changed.
///
/// # Safety
/// `pointer` is null or names a living value that nobody else uses meanwhile.
pub(crate) unsafe fn named_mut<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T, Refused> {
    // SAFETY: by the caller's word
    unsafe { pointer.as_mut() }.ok_or_else(|| null(name))
}

/// Copies as many values as there is room for, and says how many there are.
///
/// # Safety
/// `values` is null or has room for `room` values; `count` is null or can be written to.
pub(crate) unsafe fn copy_out<T: Copy>(
    from: impl ExactSizeIterator<Item = T>,
    values: *mut T,
    room: usize,
    count: *mut usize,
) -> Result<(), Refused> {
    // SAFETY: by the caller's word
    *unsafe { named_mut(count, "count") }? = from.len();
    if values.is_null() {
        return Ok(());
    }
    for (k, value) in from.take(room).enumerate() {
        // SAFETY: k is below room, for which there is place
        unsafe { values.add(k).write(value) };
    }
    Ok(())
}
