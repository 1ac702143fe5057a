//! Turns wgpu's asynchronous validation and out-of-memory errors into results.

use crate::error::DeviceError;
use std::pin::pin;
use std::task::{Context, Poll, Waker};
use wgpu::{Device, ErrorFilter};

/// Runs `make` in an error scope. Without one, errors of the device go to the host's handler of uncaptured
/// errors, which panics by default.
///
/// Not for every frame: it allocates.
pub fn with_error_scope<T, E: From<DeviceError>>(
    device: &Device,
    make: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    // In a browser the scope resolves later, after the caller has gone on: the host's handler is the right
    // place there.
    if cfg!(target_arch = "wasm32") {
        return make();
    }
    let scopes = [ErrorFilter::OutOfMemory, ErrorFilter::Validation, ErrorFilter::Internal]
        .map(|filter| device.push_error_scope(filter));
    let made = make();
    let mut first = None;
    for scope in scopes.into_iter().rev() {
        if let Poll::Ready(error) = pin!(scope.pop()).poll(&mut Context::from_waker(Waker::noop()))
        {
            first = first.or(error);
        }
    }
    let made = made?;
    match first {
        Some(error) => Err(DeviceError(error.to_string()).into()),
        None => Ok(made),
    }
}
