//! Jump flood and distance field against an exact transform.

use crate::common::*;
use fastrand::Rng;
use lamplight::internals::distance::distance;
use lamplight::internals::jump_flood::{SETTLED_ERROR, jump_flood, passes, settle};
use lamplight::internals::seed::{NONE, pack, unpack};
use lamplight::{Matter, Settings, Solver};

const SIZES: [[u32; 2]; 10] = [
    [1, 1],
    [1, 37],
    [53, 1],
    [2, 3],
    [31, 17],
    [64, 64],
    [127, 5],
    [97, 61],
    [23, 101],
    [113, 109],
];

/// The largest fraction of cells that may be wrong after JFA+1.
const WRONG_AFTER_EXTRA: f64 = 1e-3;
/// That fraction for the plain flood: Rong and Tan found 0.2 % at worst; small grids vary.
const WRONG_WHEN_PLAIN: f64 = 1e-2;

#[derive(Clone, Copy, Debug)]
enum Flood {
    Plain,
    Extra,
    Settled,
}

fn flood(flood: Flood, [w, h]: [u32; 2], seeds: &[u32]) -> Vec<u32> {
    let (mut map, mut scratch) = (seeds.to_vec(), Vec::new());
    jump_flood(w, h, u32::from(matches!(flood, Flood::Extra)), &mut map, &mut scratch);
    if let Flood::Settled = flood {
        settle(w, h, &mut map, &mut scratch);
    }
    map
}

/// Each cell is a seed with this probability, or there is a fixed number of seeds.
#[derive(Clone, Copy, Debug)]
enum Density {
    Count(usize),
    Share(f32),
}

const DENSITIES: [Density; 6] = [
    Density::Count(1),
    Density::Count(2),
    Density::Count(7),
    Density::Share(0.01),
    Density::Share(0.1),
    Density::Share(0.5),
];

fn scatter(random: &mut Rng, [w, h]: [u32; 2], density: Density) -> Vec<u32> {
    let mut seeds = vec![NONE; (w * h) as usize];
    let own = |i: usize| pack(i as u32 % w, i as u32 / w);
    match density {
        Density::Count(n) => (0..n).for_each(|_| {
            let i = random.usize(..seeds.len());
            seeds[i] = own(i);
        }),
        Density::Share(share) => {
            for (i, seed) in seeds.iter_mut().enumerate() {
                if random.f32() < share {
                    *seed = own(i);
                }
            }
        }
    }
    seeds
}

fn squared(x: u32, y: u32, seed: u32) -> u64 {
    let [sx, sy] = unpack(seed);
    u64::from(x.abs_diff(sx)).pow(2) + u64::from(y.abs_diff(sy)).pow(2)
}

/// Squared distance to the nearest seed, by looking at every one.
fn exact([w, h]: [u32; 2], seeds: &[u32]) -> Vec<Option<u64>> {
    let all: Vec<u32> = seeds.iter().copied().filter(|&s| s != NONE).collect();
    (0..w * h).map(|i| all.iter().map(|&s| squared(i % w, i / w, s)).min()).collect()
}

/// Cells whose seed is not the nearest, and by how many px at most.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    cells: usize,
    wrong: usize,
    largest: f64,
}

impl Errors {
    fn add(&mut self, [w, _]: [u32; 2], map: &[u32], exact: &[Option<u64>]) {
        self.cells += map.len();
        for (i, (&seed, &best)) in map.iter().zip(exact).enumerate() {
            let Some(best) = best else {
                assert_eq!(seed, NONE, "a seed from nowhere");
                continue;
            };
            assert_ne!(seed, NONE, "cell {i} found nothing");
            let found = squared(i as u32 % w, i as u32 / w, seed);
            self.wrong += usize::from(found != best);
            self.largest = self.largest.max((found as f64).sqrt() - (best as f64).sqrt());
        }
    }

    fn share(self) -> f64 {
        self.wrong as f64 / self.cells as f64
    }
}

#[test]
fn few_cells_are_wrong_and_by_little() {
    let mut random = fresh();
    let mut errors = [Errors::default(); 3];
    for size in SIZES {
        for density in DENSITIES {
            for _ in 0..3 {
                let seeds = scatter(&mut random, size, density);
                let exact = exact(size, &seeds);
                for kind in [Flood::Plain, Flood::Extra, Flood::Settled] {
                    errors[kind as usize].add(size, &flood(kind, size, &seeds), &exact);
                }
            }
        }
    }
    for kind in [Flood::Plain, Flood::Extra, Flood::Settled] {
        let e = errors[kind as usize];
        let percent = 100.0 * e.share();
        println!("{kind:?}: {percent:.4} % of cells wrong, by {:.4} px at most", e.largest);
    }
    let [plain, extra, settled] = errors;
    assert!(plain.share() < WRONG_WHEN_PLAIN, "{plain:?}");
    assert!(extra.share() < WRONG_AFTER_EXTRA, "{extra:?}");
    assert!(settled.share() <= extra.share(), "{settled:?} against {extra:?}");
    assert!(settled.largest < f64::from(SETTLED_ERROR), "{settled:?}");
}

#[test]
fn the_measure_rejects_one_wrong_cell() {
    let size = [31, 17];
    let seeds = scatter(&mut seeded(1), size, Density::Count(7));
    let exact = exact(size, &seeds);
    let mut map = flood(Flood::Settled, size, &seeds);
    let before = {
        let mut errors = Errors::default();
        errors.add(size, &map, &exact);
        errors.wrong
    };
    let other = map.iter().copied().find(|&s| squared(0, 0, s) > exact[0].unwrap()).unwrap();
    map[0] = other;
    let mut errors = Errors::default();
    errors.add(size, &map, &exact);
    assert_eq!(errors.wrong, before + 1);
    assert!(errors.largest > f64::from(SETTLED_ERROR));
}

/// The flood as documented, one cell at a time, with its taps in reverse order.
fn by_the_book([w, h]: [u32; 2], offsets: impl Iterator<Item = i64>, seeds: &[u32]) -> Vec<u32> {
    let mut map = seeds.to_vec();
    for offset in offsets {
        let before = map.clone();
        for (i, held) in map.iter_mut().enumerate() {
            let (x, y) = (i as u32 % w, i as u32 / w);
            for (kx, ky) in (-1..=1).rev().flat_map(|kx| (-1..=1).rev().map(move |ky| (kx, ky))) {
                let (tx, ty) = (i64::from(x) + kx * offset, i64::from(y) + ky * offset);
                if !(0..i64::from(w)).contains(&tx) || !(0..i64::from(h)).contains(&ty) {
                    continue;
                }
                let offered = before[(ty * i64::from(w) + tx) as usize];
                let key = |s: u32| if s == NONE { (u64::MAX, s) } else { (squared(x, y, s), s) };
                if key(offered) < key(*held) {
                    *held = offered;
                }
            }
        }
    }
    map
}

#[test]
fn ties_go_to_the_smaller_position_in_any_order_of_taps() {
    let mut random = fresh();
    for size in SIZES {
        for density in DENSITIES {
            let seeds = scatter(&mut random, size, density);
            let jumps = || (0..passes(size[0], size[1])).rev().map(|pass| 1i64 << pass);
            let plain = flood(Flood::Plain, size, &seeds);
            assert_eq!(plain, by_the_book(size, jumps(), &seeds), "{size:?} {density:?}");
            let extra = flood(Flood::Extra, size, &seeds);
            assert_eq!(extra, by_the_book(size, jumps().chain([1]), &seeds));
            // Settled: one more pass changes nothing.
            let settled = flood(Flood::Settled, size, &seeds);
            assert_eq!(settled, by_the_book(size, [1].into_iter(), &settled));
        }
    }
}

#[test]
fn equal_distances_are_ties() {
    // Half way between two seeds, in x and in y.
    let mut seeds = vec![NONE; 5];
    (seeds[0], seeds[4]) = (pack(0, 0), pack(4, 0));
    assert_eq!(flood(Flood::Plain, [5, 1], &seeds)[2], pack(0, 0));
    (seeds[0], seeds[4]) = (pack(0, 0), pack(0, 4));
    assert_eq!(flood(Flood::Plain, [1, 5], &seeds)[2], pack(0, 0));
}

#[test]
fn seeds_at_coordinate_0_are_kept_and_distances_are_in_px() {
    for size @ [w, h] in SIZES {
        for [sx, sy] in [[0, 0], [w - 1, 0], [0, h - 1], [w / 2, h / 3]] {
            let mut seeds = vec![NONE; (w * h) as usize];
            seeds[(sy * w + sx) as usize] = pack(sx, sy);
            let map = flood(Flood::Plain, size, &seeds);
            assert!(map.iter().all(|&s| s == pack(sx, sy)), "{size:?} {sx} {sy}");
            let mut field = Vec::new();
            distance(w, &map, &mut field);
            for (i, &d) in field.iter().enumerate() {
                let (x, y) = (i as u32 % w, i as u32 / w);
                let right = f64::from(x.abs_diff(sx)).hypot(f64::from(y.abs_diff(sy))) as f32;
                // Rounded once in f32: within one unit in the last place.
                assert!((d - right).abs() <= f32::EPSILON * right, "{size:?} {i}: {d}, {right}");
            }
        }
    }
}

#[test]
fn without_seeds_every_distance_is_infinite() {
    for size @ [w, h] in SIZES {
        let map = flood(Flood::Settled, size, &vec![NONE; (w * h) as usize]);
        assert!(map.iter().all(|&s| s == NONE));
        let mut field = Vec::new();
        distance(w, &map, &mut field);
        assert!(field.iter().all(|&d| d == f32::INFINITY));
    }
}

#[test]
fn the_solver_shows_the_fields_of_its_grid() {
    let mut random = fresh();
    for size @ [w, h] in SIZES {
        let seeds = scatter(&mut random, size, Density::Share(0.05));
        let fog = Matter { opacity: 0.1, ..Matter::EMPTY };
        let glass = Matter { tint: [1.0, 0.5, 1.0], ..Matter::EMPTY };
        let kinds = [WALL, fog, glass];
        let cells = grid(w, h, |x, y| {
            let i = (y * w + x) as usize;
            if seeds[i] == NONE { Matter::EMPTY } else { kinds[i % 3] }
        });
        let exact = exact(size, &seeds);
        let mut solver = Solver::new(Settings::default()).unwrap();
        solver.solve(&cells).unwrap();
        let stages = solver.stages();
        assert_eq!(stages.seeds, seeds);
        for i in 0..cells.len() {
            let (d, right) =
                (stages.distance[i], exact[i].map_or(f64::INFINITY, |d| (d as f64).sqrt()));
            assert_eq!(d == 0.0, seeds[i] != NONE, "0 in occupied cells and nowhere else");
            assert!(d == right as f32 || (f64::from(d) - right).abs() < f64::from(SETTLED_ERROR));
        }
    }
}
