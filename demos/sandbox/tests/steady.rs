//! Drawing a world does not allocate after the first time.

// A global allocator that counts can only be written with `unsafe`.
#![allow(unsafe_code)]

use lamplight::Cells;
use lamplight_sandbox::worlds::{Input, WorldKind};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system allocator, which counts the allocations of this thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator as it came; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn drawing_allocates_nothing() {
    for &kind in WorldKind::ALL {
        let mut world = kind.make([160, 90], 1).unwrap();
        let mut cells = Cells::new(160, 90).unwrap();
        let start = ALLOCATIONS.get();
        world.draw(&mut cells);
        assert!(ALLOCATIONS.get() > start, "{kind:?}: the count sees the first drawing");
        for _ in 0..60 {
            world.step(&Input::default());
            let before = ALLOCATIONS.get();
            world.draw(&mut cells);
            assert_eq!(ALLOCATIONS.get(), before, "{kind:?}");
        }
    }
}
