//! Frames after the first do not allocate memory that grows with the grid.

// A global allocator that counts can only be written with `unsafe`.
#![allow(unsafe_code)]

mod common;

use common::{cells, device, lighting, raymarch_of};
use lamplight::{Cells, Lamp, Method, Settings};
use lamplight_wgpu::FrameInput;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator; counts bytes.
struct Counting;

static BYTES: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator as it came; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        BYTES.fetch_add(layout.size(), Relaxed);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        BYTES.fetch_add(size, Relaxed);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// One test, since what other tests allocate would be counted too.
#[test]
fn preparing_again_allocates_nothing_that_grows_with_the_grid() {
    let (device, queue) = device();
    let mut settings = Settings::direct(Method::Raymarch);
    raymarch_of(&mut settings).rays = 1;
    let mut lighting = lighting(&device, &queue);
    let mut cells: Cells = cells(512, 288, 3);
    cells.lamps_mut().push(Lamp { position: [200.0, 100.0], ..Lamp::default() });
    let mut bytes = Vec::new();
    for frame in 0..8 {
        cells.lamps_mut()[0].position[0] += 0.7 * frame as f32;
        let before = BYTES.load(Relaxed);
        lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder).unwrap();
        let commands = encoder.finish();
        bytes.push(BYTES.load(Relaxed) - before);
        queue.submit([commands]);
    }
    println!("bytes a frame: {bytes:?}");
    // What wgpu itself needs to take commands over: kilobytes. A copy of the cells would be 5 MB, of
    // their smallest field 0.6 MB.
    assert!(bytes[3..].iter().all(|&bytes| bytes < cells.len() / 2), "{bytes:?}");
    // The counter counts.
    assert!(bytes[0] > 16 * cells.len());
}
