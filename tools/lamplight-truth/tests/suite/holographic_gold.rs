//! The plain holographic cascades, stage by stage: they judge others, so they are judged first.

use crate::common::{GLOW, WALL, grid, seeded};
use fastrand::Rng;
use lamplight::internals::glow::Glow;
use lamplight::internals::holographic::paper::{Interval, Paper, Quadrant};
use lamplight::{Bounces, Cells, Gradient, Matter, Rgb, Settings, Sky};
use lamplight_truth::closed_forms::{gradient_sky_mean_radiance, medium_square_mean_radiance};
use lamplight_truth::{Measures, PathTracer, scenes};

/// f32 sums and products over ten levels, relative to a radiance of about 1: measured 1e-6.
const SUMS: f64 = 1e-5;

fn variants() -> [Paper; 4] {
    [Paper::yardstick(), Paper::new(1, false), Paper::new(2, false), Paper::published()]
}

fn solve(cells: &Cells) -> Vec<Rgb> {
    Paper::published().solve(cells).to_vec()
}

/// Walls, lights, fog, and glass where `tint`, from nearly empty to crowded.
fn chaos(random: &mut Rng, [width, height]: [u32; 2], tint: bool) -> Cells {
    let crowd = 0.5 * random.f64();
    let mut rgb = || -> Rgb { std::array::from_fn(|_| random.f32()) };
    let palette: Vec<Matter> = (0..4)
        .map(|i| Matter {
            emission: if i == 3 { [0.0; 3] } else { rgb() },
            opacity: if i < 2 { 1.0 } else { rgb()[0] * 0.5 },
            tint: if tint && i >= 2 { rgb() } else { [1.0; 3] },
            ..Matter::EMPTY
        })
        .collect();
    grid(width, height, |_, _| {
        let lot = random.f64() / crowd.max(1e-9);
        palette.get((lot * 4.0) as usize).copied().unwrap_or(Matter::EMPTY)
    })
}

/// A size from 1 to `most`, small ones often.
fn side(random: &mut Rng, most: u32) -> u32 {
    1 + (random.f64() * random.f64() * f64::from(most)) as u32
}

// --- intervals -------------------------------------------------------------------------------

/// A straight part of a path, from the centre of one cell to that of another.
type Leg = [[i64; 2]; 2];

/// The paths that `T_n(p, k)` is the mean over, each with its weight. A part that starts outside the
/// grid is left out.
fn paths(size: [i64; 2], level: u32, traced: u32, from: [i64; 2], k: i64) -> Vec<(f64, Vec<Leg>)> {
    if !(0..2).all(|a| (0..size[a]).contains(&from[a])) {
        return vec![(1.0, Vec::new())];
    }
    let step = |level: u32, from: [i64; 2], k: i64| {
        [from[0] + (1 << level), from[1] + 2 * k - (1 << level)]
    };
    if level <= traced {
        return vec![(1.0, vec![[from, step(level, from, k)]])];
    }
    let half = level - 1;
    let turns =
        if k % 2 == 0 { vec![[k / 2; 2]] } else { vec![[k / 2, k / 2 + 1], [k / 2 + 1, k / 2]] };
    let mut all = Vec::new();
    for [first, second] in &turns {
        let near = paths(size, half, traced, from, *first);
        let far = paths(size, half, traced, step(half, from, *first), *second);
        for (a, near) in &near {
            for (b, far) in &far {
                all.push((a * b / turns.len() as f64, [&near[..], &far[..]].concat()));
            }
        }
    }
    all
}

/// The interval along a path in f64: cut at every grid line, each piece looked up at its middle.
fn meet(at: impl Fn(i64, i64) -> Option<Matter>, way: &[Leg]) -> ([f64; 3], [f64; 3]) {
    let (mut light, mut through) = ([0.0; 3], [1.0; 3]);
    for leg in way {
        let [from, to] = leg.map(|p| p.map(|v| v as f64 + 0.5));
        let by = [to[0] - from[0], to[1] - from[1]];
        let mut cuts = vec![0.0, 1.0];
        for axis in 0..2 {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let lines = (low.ceil() as i64)..=(high.floor() as i64);
            cuts.extend(lines.map(|line| (line as f64 - from[axis]) / by[axis]));
        }
        cuts.retain(|t| t.is_finite());
        cuts.sort_by(f64::total_cmp);
        let mut before: Option<[i64; 2]> = None;
        for cut in cuts.windows(2).filter(|cut| cut[1] - cut[0] > 1e-9) {
            let middle = (cut[0] + cut[1]) / 2.0;
            let cell = [0, 1].map(|a| (from[a] + middle * by[a]).floor() as i64);
            // Two cells that touch only by a corner: which cells lie beside it?
            if let Some(last) = before.filter(|last| last[0] != cell[0] && last[1] != cell[1]) {
                let beside = [at(cell[0], last[1]), at(last[0], cell[1])];
                if let [Some(a), Some(b)] = beside
                    && a.opacity >= 1.0
                    && b.opacity >= 1.0
                {
                    for c in 0..3 {
                        light[c] += through[c] * f64::from(a.emission[c] + b.emission[c]) / 2.0;
                    }
                    return (light, [0.0; 3]);
                }
            }
            before = Some(cell);
            let Some(matter) = at(cell[0], cell[1]) else { continue };
            let px = (cut[1] - cut[0]) * by[0].hypot(by[1]);
            for c in 0..3 {
                let open = (1.0 - f64::from(matter.opacity)) * f64::from(matter.tint[c]);
                let t = open.powf(px);
                light[c] += through[c] * (1.0 - t) * f64::from(matter.emission[c]);
                through[c] *= t;
            }
            if matter.opacity >= 1.0 {
                return (light, [0.0; 3]);
            }
        }
    }
    (light, through)
}

/// Returns true if an interval is as expected.
fn agree(got: Interval<Rgb>, (light, through): ([f64; 3], [f64; 3])) -> bool {
    (0..3).all(|c| {
        (f64::from(got.light[c]) - light[c]).abs() < SUMS
            && (f64::from(got.transmittance[c]) - through[c]).abs() < SUMS
    })
}

/// Compares every interval of a few levels with the mean over all its paths; names those that differ.
fn check_intervals(made_of: &Cells, judged_by: &Cells, traced: u32) -> Result<usize, String> {
    let mut quadrant = Quadrant::<Rgb>::default();
    let mut count = 0;
    for turn in 0..4 {
        quadrant.prepare(made_of, turn, traced);
        let (w, h) = (made_of.width() as i64, made_of.height() as i64);
        let size = if turn % 2 == 0 { [w, h] } else { [h, w] };
        let at = |x: i64, y: i64| {
            let inside = (0..size[0]).contains(&x) && (0..size[1]).contains(&y);
            inside.then(|| judged_by.matter(quadrant.cell(x as usize, y as usize)))
        };
        // Beyond four levels there are too many paths.
        for level in 0..=quadrant.top().min(4) {
            for plane in 0..quadrant.planes(level) {
                for y in 0..size[1] {
                    for k in 0..=1 << level {
                        let paths = paths(size, level, traced, [(plane as i64) << level, y], k);
                        let mut sum = ([0.0; 3], [0.0; 3]);
                        for (weight, way) in &paths {
                            let (light, through) = meet(at, way);
                            for c in 0..3 {
                                sum.0[c] += weight * light[c];
                                sum.1[c] += weight * through[c];
                            }
                        }
                        let got = quadrant.interval(level, plane, y as isize, k as usize);
                        if !agree(got, sum) {
                            return Err(format!(
                                "turn {turn}, T_{level}(plane {plane}, row {y}, {k}): {got:?} is not \
                                 {sum:?}, the mean over {} paths",
                                paths.len()
                            ));
                        }
                        count += 1;
                    }
                }
            }
        }
    }
    Ok(count)
}

#[test]
fn intervals_are_means_over_bent_paths() {
    let seed = 11;
    let mut random = seeded(seed);
    let mut count = 0;
    for scene in 0..24 {
        let size = [side(&mut random, 20), side(&mut random, 20)];
        let cells = chaos(&mut random, size, scene % 2 == 0);
        for traced in 0..=2 {
            count += check_intervals(&cells, &cells, traced)
                .unwrap_or_else(|e| panic!("seed {seed}, scene {scene}, traced {traced}: {e}"));
        }
    }
    assert!(count > 20_000, "only {count} intervals were looked at");
}

#[test]
fn an_interval_through_another_cell_is_rejected() {
    let cells = chaos(&mut seeded(12), [13, 9], true);
    let mut other = cells.clone();
    let fog = Matter { opacity: 0.01, ..Matter::EMPTY };
    other.set(6, 4, if cells.get(6, 4) == Some(Matter::EMPTY) { fog } else { Matter::EMPTY });
    assert!(check_intervals(&cells, &cells, 2).is_ok());
    assert!(check_intervals(&cells, &other, 2).is_err());
    assert!(check_intervals(&other, &cells, 0).is_err());
}

#[test]
fn without_tint_one_transmittance_serves_all_channels() {
    let mut random = seeded(13);
    let cells = chaos(&mut random, [23, 17], false);
    let (mut grey, mut rgb) = (Quadrant::<f32>::default(), Quadrant::<Rgb>::default());
    for turn in 0..4 {
        grey.prepare(&cells, turn, 2);
        rgb.prepare(&cells, turn, 2);
        for level in 0..=grey.top() {
            assert_eq!(grey.cones(level), rgb.cones(level), "turn {turn}, level {level}");
        }
    }
}

// --- cones and mean radiance -------------------------------------------------------------------------

/// The largest difference from a grey value over the open cells.
fn off_by(cells: &Cells, light: &[Rgb], expected: f64) -> f64 {
    let open = (0..cells.len()).filter(|&i| !cells.is_solid(i));
    let errors = open.flat_map(|i| light[i]).map(|v| (f64::from(v) - expected).abs());
    errors.fold(0.0, f64::max)
}

/// Odd, prime, one-row and one-cell grids.
const SIZES: [[u32; 2]; 8] = [[1, 1], [1, 7], [7, 1], [2, 2], [3, 5], [16, 16], [17, 64], [97, 61]];

#[test]
fn the_light_in_a_furnace_is_that_of_its_walls() {
    for [w, h] in SIZES {
        // In an inner room, too, and round a pillar.
        let cells = grid(w + 2, h + 2, |x, y| {
            let wall = x == 0 || y == 0 || x == w + 1 || y == h + 1 || (x, y) == (w / 2, h / 3);
            if wall { GLOW } else { Matter::EMPTY }
        });
        for mut variant in variants() {
            let off = off_by(&cells, variant.solve(&cells), 1.0);
            assert!(off < SUMS, "{w}×{h}, traced {}: off by {off}", variant.traced);
        }
    }
}

#[test]
fn an_empty_grid_shows_the_sky() {
    let gradient = Gradient { zenith: [0.9; 3], horizon: [0.4; 3], ground: [0.1; 3] };
    let skies = [
        (Sky::Uniform([0.7; 3]), f64::from(0.7f32)),
        (Sky::Gradient(gradient), gradient_sky_mean_radiance(0.9, 0.4, 0.1)),
    ];
    for [w, h] in SIZES {
        for (sky, expected) in &skies {
            let mut cells = Cells::new(w, h).unwrap();
            cells.set_sky(sky.clone());
            for mut variant in variants() {
                let off = off_by(&cells, variant.solve(&cells), *expected);
                assert!(off < SUMS, "{w}×{h}, {sky:?}: off by {off}");
            }
        }
    }
}

#[test]
fn fog_as_bright_as_the_sky_is_invisible() {
    // Of every interval ⟨r, t⟩ then r = (1 − t)·L, and J = L whatever the fog: only if near is
    // joined with far before means are taken.
    let seed = 14;
    let mut random = seeded(seed);
    for [w, h] in SIZES {
        let mut cells = grid(w, h, |_, _| Matter {
            emission: [0.7; 3],
            opacity: 0.9 * random.f32().powi(2),
            tint: [1.0, random.f32(), 0.5],
            ..Matter::EMPTY
        });
        cells.set_sky(Sky::Uniform([0.7; 3]));
        for mut variant in variants() {
            let off = off_by(&cells, variant.solve(&cells), f64::from(0.7f32));
            assert!(off < SUMS, "seed {seed}, {w}×{h}: off by {off}");
        }
        cells.set(0, 0, Matter { emission: [0.71; 3], ..cells.get(0, 0).unwrap() });
        let off = off_by(&cells, &solve(&cells), f64::from(0.7f32));
        assert!(off > SUMS, "one brighter cell passes in {w}×{h}");
    }
}

/// Bent rays are longer than straight ones and meet more fog, (8, 2) as (4, 0) and (4, 2) by 2.7 %:
/// relative error where fog is thin, measured +2.1 %.
const FOG: f64 = 0.03;

#[test]
fn fog_of_a_square_has_its_closed_form() {
    let (half, sigma) = (20u32, 0.02f64);
    let side = 2 * half + 1;
    let fog =
        Matter { emission: [1.0; 3], opacity: (1.0 - (-sigma).exp()) as f32, ..Matter::EMPTY };
    let cells = grid(side, side, |_, _| fog);
    let expected = medium_square_mean_radiance(1.0, sigma, f64::from(side) / 2.0);
    let relative = |mut variant: Paper| {
        let middle = variant.solve(&cells)[cells.index(half, half)];
        let relative = f64::from(middle[1]) / expected - 1.0;
        println!("traced {}: {:+.2} %", variant.traced, 100.0 * relative);
        relative.abs()
    };
    assert!(relative(Paper::published()) < FOG);
    // Rays that only ever zigzag meet more fog, and the bound is sharp enough to see it.
    assert!(relative(Paper::yardstick()) > FOG);
}

#[test]
fn a_sealed_room_is_black() {
    let seed = 15;
    let mut random = seeded(seed);
    let mut rooms = 0;
    for scene in 0..60 {
        let (w, h) = (side(&mut random, 60), side(&mut random, 60));
        // A room of any shape round its middle, and a wall round it whose cells may touch by
        // corners only; everything else glows, and so does the sky, but where the border is part of
        // the wall: there a ray with `traced = 0` may go round.
        let centre = [random.f64() * f64::from(w), random.f64() * f64::from(h)];
        let shape: Vec<f64> = (0..7).map(|_| 1.0 + 12.0 * random.f64()).collect();
        let in_room = |x: i64, y: i64| {
            let (dx, dy) = (x as f64 + 0.5 - centre[0], y as f64 + 0.5 - centre[1]);
            let angle = (dy.atan2(dx) + std::f64::consts::PI) / std::f64::consts::TAU;
            dx.hypot(dy) < shape[(angle * 6.99) as usize]
        };
        let cells = grid(w, h, |x, y| {
            let (x, y) = (i64::from(x), i64::from(y));
            let beside = [(-1, 0), (1, 0), (0, -1), (0, 1)];
            match () {
                () if in_room(x, y) => Matter::EMPTY,
                () if beside.iter().any(|(dx, dy)| in_room(x + dx, y + dy)) => WALL,
                () => Matter { emission: [random.f32(); 3], opacity: 0.3, ..GLOW },
            }
        });
        let at_border = (0..cells.len()).any(|i| {
            let (x, y) = ((i as u32 % w), (i as u32 / w));
            let border = x == 0 || y == 0 || x + 1 == w || y + 1 == h;
            border && in_room(x.into(), y.into())
        });
        for mut variant in variants().into_iter().filter(|v| v.traced > 0 || !at_border) {
            let (traced, blur) = (variant.traced, variant.blur);
            let light = variant.solve(&cells);
            for (i, light) in light.iter().enumerate() {
                let (x, y) = (i as u32 % w, i as u32 / w);
                if in_room(x.into(), y.into()) {
                    // A blur takes the mean of cells of the same opacity: all in the room.
                    let case =
                        format!("seed {seed}, scene {scene}, {w}×{h}, traced {traced}, {blur}");
                    assert_eq!(*light, [0.0; 3], "{case}: light at ({x}, {y})");
                    rooms += 1;
                }
            }
        }
    }
    assert!(rooms > 10_000, "{rooms} cells were in rooms");
}

#[test]
fn a_room_with_a_hole_is_lit() {
    let cells = grid(21, 21, |x, y| {
        let d = x.abs_diff(10).max(y.abs_diff(10));
        match d {
            0..4 => Matter::EMPTY,
            4 if (x, y) == (14, 10) => Matter::EMPTY,
            4 => WALL,
            _ => GLOW,
        }
    });
    for mut variant in variants() {
        assert!(variant.solve(&cells)[cells.index(10, 10)][0] > 0.0);
    }
}

// --- symmetry ------------------------------------------------------------------------------------

/// A grid moved cell by cell, and its light with it.
fn moved(cells: &Cells, size: [u32; 2], from: impl Fn(u32, u32) -> (u32, u32)) -> Cells {
    let mut moved = grid(size[0], size[1], |x, y| {
        let (x, y) = from(x, y);
        cells.get(x, y).unwrap()
    });
    moved.set_sky(cells.sky().clone());
    moved
}

/// Returns true if the light of a moved grid is the moved light, to the bit.
fn moves_along(
    cells: &Cells,
    moved: &Cells,
    from: impl Fn(u32, u32) -> (u32, u32),
    variant: &mut Paper,
) -> bool {
    let light = variant.solve(cells).to_vec();
    let moved_light = variant.solve(moved);
    (0..moved.len()).all(|i| {
        let (x, y) = from(i as u32 % moved.width(), i as u32 / moved.width());
        light[cells.index(x, y)] == moved_light[i]
    })
}

#[test]
fn turned_and_mirrored_scenes_have_turned_and_mirrored_light() {
    let seed = 16;
    let mut random = seeded(seed);
    for scene in 0..12 {
        let (w, h) = (side(&mut random, 70), side(&mut random, 70));
        let mut cells = chaos(&mut random, [w, h], scene % 2 == 0);
        cells.set_sky(Sky::Uniform([0.2, 0.3, 0.1]));
        for mut variant in variants() {
            let case = format!("seed {seed}, scene {scene}, {w}×{h}, traced {}", variant.traced);
            let turn = |x, y| (y, h - 1 - x);
            let mirror_x = |x, y| (w - 1 - x, y);
            let mirror_y = |x, y| (x, h - 1 - y);
            let turned = moved(&cells, [h, w], turn);
            assert!(moves_along(&cells, &turned, turn, &mut variant), "{case}: turned");
            let mirrored = moved(&cells, [w, h], mirror_x);
            assert!(moves_along(&cells, &mirrored, mirror_x, &mut variant), "{case}: mirrored");
            let mirrored = moved(&cells, [w, h], mirror_y);
            assert!(moves_along(&cells, &mirrored, mirror_y, &mut variant), "{case}: upside down");
        }
    }
}

#[test]
fn a_changed_scene_is_rejected() {
    let cells = scenes::ring(4.0, 20);
    let mut other = cells.clone();
    other.set(3, 5, Matter { opacity: 1e-3, ..Matter::EMPTY });
    let stay = |x, y| (x, y);
    let mut variant = Paper::published();
    assert!(moves_along(&cells, &cells, stay, &mut variant));
    assert!(!moves_along(&cells, &other, stay, &mut variant));
}

#[test]
fn light_is_linear_in_emission() {
    let seed = 17;
    let mut random = seeded(seed);
    let cells = chaos(&mut random, [61, 43], true);
    let (mut one, mut two, mut double) = (cells.clone(), cells.clone(), cells.clone());
    for i in 0..cells.len() {
        let e = cells.emission()[i];
        let share = random.f32();
        one.emission_mut()[i] = e.map(|v| v * share);
        two.emission_mut()[i] = std::array::from_fn(|c| e[c] - one.emission()[i][c]);
        double.emission_mut()[i] = e.map(|v| 2.0 * v);
    }
    let [whole, one, two, double] = [&cells, &one, &two, &double].map(solve);
    for i in 0..cells.len() {
        for c in 0..3 {
            assert_eq!(double[i][c], 2.0 * whole[i][c], "seed {seed}, cell {i}");
            let off = f64::from(one[i][c] + two[i][c] - whole[i][c]).abs();
            assert!(off < SUMS, "seed {seed}, cell {i}: the parts are off by {off}");
        }
    }
}

// --- how good it is --------------------------------------------------------------------------

/// Scenes of each kind, by seed.
const SEEDS: [u64; 3] = [1, 2, 3];
/// Open cells looked at in each.
const LOOKS: usize = 2000;

/// Relative RMSE of the paper variant over the scenes of a kind, with `samples` paths of the reference per cell.
fn measure(kind: &str, make: impl Fn(u64) -> Cells, samples: u32) -> f64 {
    let mut squares = 0.0;
    for seed in SEEDS {
        let cells = make(seed).drawn().into_owned();
        let at = scenes::open_cells(&cells, LOOKS, seed);
        let tracer = PathTracer {
            samples,
            bounces: Bounces::Count(0),
            wall_depth: 0.0,
            elevation: Settings::ELEVATION,
            seed,
        };
        let (truth, error): (Vec<Rgb>, Vec<Rgb>) =
            tracer.at(&cells, &at).unwrap().into_iter().unzip();
        let mut media = cells.clone();
        Glow::default().to_media(&mut media);
        let judge = |mut variant: Paper| {
            let light = variant.solve(&media);
            let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light[cells.index(x, y)]).collect();
            Measures::of(&seen, &truth, &vec![false; at.len()])
        };
        let (paper, plain) = (judge(Paper::published()), judge(Paper::yardstick()));
        let own = error.as_flattened().iter().map(|&e| f64::from(e).powi(2)).sum::<f64>();
        let own = (own / (3 * at.len()) as f64).sqrt() / paper.mean;
        println!(
            "{kind}, seed {seed}: paper {:.1} % (bias {:+.1} %, p99 {:.1} %), yardstick {:.1} %, \
             the truth's own {:.2} %",
            100.0 * paper.relative_rmse,
            100.0 * paper.bias,
            100.0 * paper.p99,
            100.0 * plain.relative_rmse,
            100.0 * own
        );
        assert!(own < 0.2 * paper.relative_rmse, "the truth is too vague");
        squares += paper.relative_rmse.powi(2) / SEEDS.len() as f64;
    }
    squares.sqrt()
}

/// Relative RMSE of the paper variant, measured: 4.6 % with large emitters (2 to 4 % is said of others), …
const LARGE: std::ops::Range<f64> = 0.035..0.055;
/// … 14.4 % in groves (another prototype: 15.7 %), …
const GROVE: std::ops::Range<f64> = 0.12..0.17;
/// … 33 % in dungeons, 42 % without the blur (another prototype, other lamps: 52 %).
const DUNGEON: std::ops::Range<f64> = 0.28..0.40;

/// Documents what methods are measured by, and rejects a yardstick that is better or worse than what
/// it stands for.
#[test]
fn the_paper_variant_has_its_known_error() {
    let large = measure("large emitters", scenes::large_emitters, 4096);
    let grove = measure("grove", scenes::grove, 2048);
    let dungeon = measure("dungeon", scenes::dungeon, 2048);
    println!("paper variant: large {large:.4}, grove {grove:.4}, dungeon {dungeon:.4}");
    for (kind, error, known) in
        [("large emitters", large, LARGE), ("grove", grove, GROVE), ("dungeon", dungeon, DUNGEON)]
    {
        assert!(known.contains(&error), "{kind}: {error} is not in {known:?}");
    }
}
