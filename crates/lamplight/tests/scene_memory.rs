//! Nothing that grows with a size is allocated before the size is found good.

// Counting allocations means being the allocator, which is unsafe by signature.
#![allow(unsafe_code)]

use lamplight::{Cells, Scene};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator, with the largest single request since the last reset.
struct Counting;

static LARGEST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Relaxed);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LARGEST.fetch_max(size, Relaxed);
        unsafe { System.realloc(at, layout, size) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// More than a message or a buffer for reading needs, less than any picture.
const LITTLE: usize = 256 << 10;

fn largest(act: impl FnOnce()) -> usize {
    LARGEST.store(0, Relaxed);
    act();
    LARGEST.load(Relaxed)
}

// One test, since what other tests allocate would be counted too.
#[test]
fn input_rejected_for_its_size_is_never_allocated() {
    let too_large = [[40_000, 40_000], [u32::MAX, u32::MAX], [16_385, 1], [0, 7], [16_384, 2049]];
    for [width, height] in too_large {
        assert!(largest(|| assert!(Cells::new(width, height).is_err())) < LITTLE);
        assert!(largest(|| assert!(Scene::new(width, height).cells().is_err())) < LITTLE);
        let text = format!("size = [{width}, {height}]");
        assert!(largest(|| assert!(Scene::from_toml(&text).is_err())) < LITTLE);
    }

    // An image of another size than the scene is rejected by its header.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let image = folder.path().join("image.png");
    image::GrayImage::new(2000, 2000).save(&image).unwrap();
    std::fs::write(&path, "size = [20, 20]\nlayers = { opacity = \"image.png\" }").unwrap();
    let scene = Scene::load(&path).unwrap();
    assert!(largest(|| assert!(scene.cells().is_err())) < LITTLE);

    // The measure sees what is allocated.
    assert!(largest(|| assert!(Cells::new(512, 512).is_ok())) > LITTLE);
}
