//! Frames after the first do not allocate, and are equal on any number of threads.

// A global allocator that counts can only be written with `unsafe`.
#![allow(unsafe_code)]

mod common;

use common::*;
use lamplight::settings::{Cascades, Flood, Hit, Holographic, Merge, Noise, Temporal};
use lamplight::{
    Bounces, Cells, Cookie, CookiePixels, Lamp, Matter, Method, Panorama, Settings, Sight,
    SightSolver, Solver,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator; counts the allocations of marked threads.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    static MARKED: Cell<bool> = const { Cell::new(false) };
}

impl Counting {
    fn count() {
        if MARKED.try_with(Cell::get).unwrap_or(false) {
            ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        }
    }
}

// SAFETY: every call goes to the system's allocator as it came; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        Self::count();
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        Self::count();
        // SAFETY: the caller's promises are passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Frames until every buffer has its size.
const WARM_UP: u32 = 6;
/// Frames until the lamps stand where they stood.
const PERIOD: u32 = 4;
/// Periods after the warm-up. The threads' own queues of work grow whenever they are longer than ever before,
/// which a busy machine makes rare and not impossible: one period without an allocation is enough.
const PERIODS: u32 = 3;

/// Walls, fog, glass, lights and lamps; the lamps move from frame to frame.
fn scene(fog: bool, frame: u32) -> Cells {
    let random = &mut seeded(7);
    let mut cells = grid(61, 37, |_, _| {
        let (kind, albedo) = (random.f32(), rgb(random));
        match kind {
            k if k < 0.03 => Matter { emission: rgb(random), albedo, ..WALL },
            k if k < 0.1 => Matter { albedo, ..WALL },
            k if k < 0.3 && fog => Matter { opacity: 0.2, albedo, ..Matter::EMPTY },
            k if k < 0.4 && fog => Matter { tint: albedo, ..Matter::EMPTY },
            _ => Matter::EMPTY,
        }
    });
    for lamp in 0..3 {
        let position = [10.0 + 17.0 * lamp as f32, 18.0 + 0.7 * frame as f32];
        cells.lamps_mut().push(Lamp { position, size: 2.2, ..Lamp::default() });
    }
    let pixels = CookiePixels::new([2, 1], &[[0.5, 1.0, 0.2], [1.0; 3]]).unwrap();
    cells.lamps_mut()[1].cookie = Some(Cookie::new(pixels, 20.0));
    // Clones share its columns.
    cells.set_sky(Panorama::new(&[[0.1, 0.2, 0.3], [0.3, 0.2, 0.1]]).unwrap().into());
    cells
}

/// Everything that has buffers of its own, alone and together.
fn variants() -> Vec<(&'static str, bool, Settings)> {
    let few = |s: &mut Settings| raymarch_of(s).rays = 8;
    let way = |change: fn(&mut Settings)| {
        settings(|s| {
            few(s);
            change(s);
        })
    };
    let bounces = |s: &mut Settings| s.bounces = Bounces::Count(2);
    vec![
        ("direct", false, way(|_| ())),
        ("bounces", false, way(bounces)),
        ("fog", true, way(bounces)),
        ("converged", true, way(|s| s.bounces = Bounces::Converged)),
        ("feedback", true, way(|s| s.bounces = Bounces::Feedback)),
        ("hit by distance", true, way(|s| raymarch_of(s).hit = Hit::Distance)),
        ("polar", false, way(|s| s.method = Method::Polar.into())),
        ("polar through fog", true, way(|s| s.method = Method::Polar.into())),
        ("flood", true, way(|s| s.method = Method::Flood.into())),
        (
            "flood in order",
            true,
            way(|s| {
                s.method = Flood::preset("seed").unwrap().into();
            }),
        ),
        (
            "cascades",
            true,
            way(|s| (s.method, s.bounces) = (Method::Cascades.into(), Bounces::Count(2))),
        ),
        (
            "plain cascades",
            false,
            way(|s| s.method = Cascades { merge: Merge::Plain, ..Cascades::default() }.into()),
        ),
        (
            "cascades with feedback",
            true,
            way(|s| (s.method, s.bounces) = (Method::Cascades.into(), Bounces::Feedback)),
        ),
        (
            "holographic with feedback",
            true,
            way(|s| (s.method, s.bounces) = (Method::Holographic.into(), Bounces::Feedback)),
        ),
        ("holographic", false, way(|s| s.method = Method::Holographic.into())),
        (
            "holographic through fog",
            true,
            way(|s| (s.method, s.bounces) = (Method::Holographic.into(), Bounces::Count(2))),
        ),
        (
            "fast holographic",
            true,
            way(|s| {
                s.method = Holographic::preset("fast").unwrap().into();
            }),
        ),
        (
            "holographic of the best quality",
            true,
            way(|s| {
                s.bounces = Bounces::Count(1);
                s.method = Holographic::preset("high").unwrap().into();
            }),
        ),
        ("wall depth", false, way(|s| s.wall_depth = 6.0)),
        (
            "temporal and denoise",
            true,
            way(|s| {
                s.bounces = Bounces::Count(1);
                raymarch_of(s).temporal = Temporal { history_length: 32, reject: true };
                raymarch_of(s).denoise.passes = 3;
            }),
        ),
    ]
}

fn pool(threads: usize, marked: bool) -> ThreadPool {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(move |_| MARKED.set(marked))
        .build()
        .unwrap()
}

/// The least allocations of a period after the warm-up.
fn allocations(pool: &ThreadPool, fog: bool, mut solve: impl FnMut(&Cells) + Send) -> usize {
    let frames: Vec<Cells> = (0..PERIOD).map(|frame| scene(fog, frame)).collect();
    pool.install(|| {
        frames.iter().cycle().take(WARM_UP as usize).for_each(&mut solve);
        let periods = (0..PERIODS).map(|_| {
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            frames.iter().for_each(&mut solve);
            ALLOCATIONS.load(Ordering::Relaxed) - before
        });
        periods.min().unwrap()
    })
}

#[test]
fn solving_again_does_not_allocate() {
    let pool = pool(2, true);
    for (name, fog, settings) in variants() {
        let mut solver = Solver::new(settings).unwrap();
        let mut frame = 0;
        let least = allocations(&pool, fog, |cells| {
            if frame % PERIOD == 0 {
                solver.reset();
            }
            frame += 1;
            solver.solve(cells).unwrap();
        });
        assert_eq!(least, 0, "{name}");
    }
    let viewer = |x: f32| Sight { position: [x, 18.2], range: 40.0, ..Sight::default() };
    let mut solver = SightSolver::default();
    let least = allocations(&pool, true, |cells| {
        solver.read(cells).unwrap();
        let sights = [viewer(20.3), viewer(41.4)];
        assert!(solver.field(&sights).unwrap().iter().any(|&seen| seen > 0.0));
        assert!(solver.visibility(&sights[0], [21.0, 18.0]).unwrap() > 0.0);
    });
    assert_eq!(least, 0, "sight");
    // The counter counts.
    let least = allocations(&pool, false, |_| {
        std::hint::black_box(vec![1u8; 100]);
    });
    assert_eq!(least, PERIOD as usize);
}

/// Every bit of three frames.
fn three_frames(settings: &Settings, fog: bool, threads: usize) -> Vec<Vec<u32>> {
    let mut solver = Solver::new(settings.clone()).unwrap();
    pool(threads, false)
        .install(|| (0..3).map(|frame| bits(solver.solve(&scene(fog, frame)).unwrap())).collect())
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    for (name, fog, settings) in variants() {
        let one = three_frames(&settings, fog, 1);
        for threads in [2, 3] {
            assert!(one == three_frames(&settings, fog, threads), "{name}, {threads} threads");
        }
    }
}

#[test]
fn other_seeds_and_other_frames_differ() {
    for noise in [Noise::White, Noise::Blue, Noise::Golden] {
        let with = |seed| {
            let settings = settings(|s| {
                (raymarch_of(s).noise, raymarch_of(s).rays, s.seed) = (noise, 8, seed)
            });
            let mut solver = Solver::new(settings).unwrap();
            let cells = scene(false, 0);
            (0..3).map(|_| bits(solver.solve(&cells).unwrap())).collect::<Vec<_>>()
        };
        let (here, there) = (with(0), with(1));
        assert_eq!(here, with(0), "{noise:?}");
        assert!(here.iter().zip(&there).all(|(a, b)| a != b), "{noise:?}: seeds");
        assert!(here[0] != here[1] && here[1] != here[2], "{noise:?}: frames");
    }
}
