//! The choice of a vector unit when the program runs.
//!
//! SSE4.2 is left out, although [`fearless_simd`] supports it: every unit adds to the time of a build, and
//! processors without AVX2 run the SSE2 code instead. AVX-512 makes only `holographic` faster, and is left out of
//! builds with debug assertions, which take less long for that.

use fearless_simd::{f32x16, prelude::*};

/// Evaluates an expression with the token of `level`'s vector unit, compiled for that unit: SSE2 or
/// AVX2 on x86-64.
///
/// Functions in the expression must be `#[inline(always)]`, or they are compiled for the baseline.
/// Those with several callers are wrapped in [`fearless_simd::Simd::vectorize`], which compiles them
/// once per unit.
macro_rules! dispatch {
    ($level:expr, $simd:ident => $op:expr) => {{
        let level: fearless_simd::Level = $level;
        #[cfg(not(target_arch = "x86_64"))]
        let value = fearless_simd::dispatch!(level, $simd => $op);
        #[cfg(target_arch = "x86_64")]
        let value = if let Some($simd) = level.as_avx2() {
            fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op)
        } else {
            let $simd = level.as_sse2().expect("x86-64 includes SSE2");
            fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op)
        };
        value
    }};
}

/// Like [`dispatch`], with AVX-512 too in builds without debug assertions.
macro_rules! dispatch_wide {
    ($level:expr, $simd:ident => $op:expr) => {{
        let level: fearless_simd::Level = $level;
        #[cfg(any(debug_assertions, not(target_arch = "x86_64")))]
        let value = crate::simd::dispatch!(level, $simd => $op);
        #[cfg(all(not(debug_assertions), target_arch = "x86_64"))]
        let value = if let Some($simd) = level.as_avx512() {
            fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op)
        } else {
            crate::simd::dispatch!(level, $simd => $op)
        };
        value
    }};
}

pub(crate) use {dispatch, dispatch_wide};

/// Returns the floor of values that fit an `i32`. Like [`f32x16::floor`], which calls a function per
/// lane for SSE2.
#[inline(always)]
pub(crate) fn floor<S: Simd>(values: f32x16<S>) -> f32x16<S> {
    #[cfg(target_arch = "x86_64")]
    if let fearless_simd::Level::Sse2(_) = values.token().level() {
        let whole = values.to_int::<fearless_simd::i32x16<S>>().to_float::<f32x16<S>>();
        return whole.simd_gt(values).select(whole - 1.0, whole);
    }
    values.floor()
}
