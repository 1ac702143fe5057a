//! What a device says only on the side, as errors.

use crate::{Error, Result};
use std::pin::pin;
use std::task::{Context, Poll, Waker};
use wgpu::{Device, ErrorFilter};

/// Makes something; what the device holds against it is an error. Without this it goes to the host's
/// handler of uncaptured errors, which by default panics.
///
/// Not for every frame: it allocates.
pub fn guarded<T>(device: &Device, make: impl FnOnce() -> Result<T>) -> Result<T> {
    // A browser answers later, when nobody waits any more: there the host's handler is the right place.
    if cfg!(target_arch = "wasm32") {
        return make();
    }
    let scopes = [ErrorFilter::OutOfMemory, ErrorFilter::Validation, ErrorFilter::Internal]
        .map(|filter| device.push_error_scope(filter));
    let made = make();
    let mut refused = None;
    for scope in scopes.into_iter().rev() {
        if let Poll::Ready(told) = pin!(scope.pop()).poll(&mut Context::from_waker(Waker::noop())) {
            refused = refused.or(told);
        }
    }
    let made = made?;
    match refused {
        Some(told) => Err(Error::Device(told.to_string())),
        None => Ok(made),
    }
}
