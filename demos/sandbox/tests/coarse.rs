//! Larger cells show about the same light, and slow frames select them.

use lamplight::resample::{MAX_FACTOR, downsample, max_factor, upsample};
use lamplight::{Cells, Lamp, Light, Matter, Method, Rgb, Settings, Solver, normal_of_slope};
use lamplight_sandbox::pace::{FRAME, Pace};

const WALL: Matter = Matter { opacity: 1.0, ..Matter::EMPTY };

fn coarse(cells: &Cells, factor: u32) -> Cells {
    let mut to = Cells::new(1, 1).unwrap();
    downsample(cells, factor, &mut to).unwrap();
    to
}

fn lit(cells: &Cells) -> Light {
    let settings = Settings::direct(Method::default());
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

/// The light of larger cells where the smaller ones are.
fn coarsely_lit(cells: &Cells, factor: u32) -> Light {
    let larger = coarse(cells, factor);
    upsample(&lit(&larger), &larger.drawn(), &cells.drawn()).unwrap()
}

fn brightness(rgb: Rgb) -> f32 {
    rgb.iter().sum()
}

#[test]
fn a_factor_of_one_is_the_same() {
    let mut cells = Cells::new(13, 7).unwrap();
    cells.set(3, 3, WALL);
    cells.set(5, 2, Matter { opacity: 0.3, tint: [0.9, 0.5, 0.2], ..Matter::default() });
    let same = coarse(&cells, 1);
    assert_eq!((same.opacity()[3 * 13 + 3], same.is_solid(3 * 13 + 3)), (1.0, true));
    for (a, b) in same.opacity().iter().zip(cells.opacity()) {
        // Opacity and tint may be divided differently; the transmittance is the same.
        assert!((a - b).abs() < 0.08, "{a} {b}");
    }
    let through = |cells: &Cells, i: usize| cells.tint()[i].map(|t| t * (1.0 - cells.opacity()[i]));
    for i in (0..cells.len()).filter(|&i| !cells.is_solid(i)) {
        let (a, b) = (through(&same, i), through(&cells, i));
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-5), "{a:?} {b:?}");
    }
}

#[test]
fn walls_of_one_px_stay_shut() {
    for factor in 2..=MAX_FACTOR {
        for offset in 0..factor {
            let mut cells = Cells::new(48, 48).unwrap();
            // A box of one px, at every place relative to the blocks, round a lamp.
            for k in 12 + offset..=36 {
                for [x, y] in [[k, 12 + offset], [k, 36], [12 + offset, k], [36, k]] {
                    cells.set(x, y, WALL);
                }
            }
            cells.lamps_mut().push(Lamp { position: [25.0, 25.0], ..Lamp::default() });
            let light = coarsely_lit(&cells, factor);
            assert!(brightness(light.at(22, 22)) > 0.01);
            let outside = |x: u32, y: u32| !(8..=40).contains(&x) || !(8..=40).contains(&y);
            let leaks = (0..48 * 48)
                .map(|i| (i % 48, i / 48))
                .filter(|&(x, y)| outside(x, y) && brightness(light.at(x, y)) != 0.0);
            assert_eq!(leaks.count(), 0, "factor {factor}, offset {offset}");
        }
    }
}

#[test]
fn light_stays_about_as_bright() {
    for side in [1, 2, 3, 9] {
        let mut cells = Cells::new(96, 96).unwrap();
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            cells.set(48 + x, 48 + y, Matter { emission: [3.0, 2.0, 1.0], ..WALL });
        }
        let fine = lit(&cells);
        for factor in 2..=MAX_FACTOR {
            let light = coarsely_lit(&cells, factor);
            let sum = |light: &Light| light.over([10.0, 10.0], [30.0, 86.0]).iter().sum::<f32>();
            let ratio = sum(&light) / sum(&fine);
            println!("{side} px, factor {factor}: {ratio:.2}");
            assert!((0.7..1.4).contains(&ratio), "{side} px, {factor}: {ratio}");
        }
    }
}

#[test]
fn fog_lets_as_much_through() {
    let mut cells = Cells::new(60, 24).unwrap();
    for (x, y) in (0..24).flat_map(|y| (0..60).map(move |x| (x, y))) {
        if (12..36).contains(&x) {
            cells.set(x, y, Matter { opacity: 0.05, tint: [1.0, 0.95, 0.9], ..Matter::default() });
        }
        if x < 4 {
            cells.set(x, y, Matter { emission: [5.0; 3], ..WALL });
        }
    }
    let fine = lit(&cells).at(50, 12);
    for factor in 2..=MAX_FACTOR {
        let light = coarsely_lit(&cells, factor).at(50, 12);
        println!("factor {factor}: {light:?} of {fine:?}");
        assert!((0..3).all(|c| (light[c] / fine[c] - 1.0).abs() < 0.2), "{light:?} {fine:?}");
    }
}

#[test]
fn sizes_that_do_not_divide_keep_their_edges() {
    let mut cells = Cells::new(31, 17).unwrap();
    cells.set(30, 16, WALL);
    let to = coarse(&cells, 4);
    assert_eq!([to.width(), to.height()], [8, 5]);
    assert!(upsample(&lit(&to), &to, &cells).is_ok());
    // The light of other cells is none.
    assert!(upsample(&lit(&cells), &to, &cells).is_err());
}

/// The factor after some seconds, if light takes `light` seconds on the finest cells.
fn settled(mut factor: u32, light: f64, known: bool, seconds: f64) -> (u32, u32) {
    let (mut pace, mut time, mut changes) = (Pace::default(), 0.0, 0);
    while time < seconds {
        let takes = light / f64::from(factor * factor);
        let frame = (takes + 0.004).max(FRAME);
        let next = pace.advise(frame, known.then_some(takes), factor, MAX_FACTOR);
        changes += u32::from(next != factor);
        (factor, time) = (next, time + frame);
    }
    (factor, changes)
}

#[test]
fn frames_that_come_late_make_light_coarser_until_they_do_not() {
    for known in [true, false] {
        assert_eq!(settled(1, 0.010, known, 10.0), (1, 0));
        assert_eq!(settled(1, 0.040, known, 10.0), (2, 1));
        assert_eq!(settled(1, 1.0, known, 10.0), (MAX_FACTOR, 3));
    }
}

#[test]
fn small_pictures_stay_worth_looking_at() {
    assert_eq!([64, 160, 240, 320, 1920].map(max_factor), [1, 2, 3, 4, MAX_FACTOR]);
    let mut pace = Pace::default();
    let factor = (0..300).fold(1, |factor, _| pace.advise(0.1, None, factor, max_factor(160)));
    assert_eq!(factor, 2);
    // Frames in time, of a picture that has become smaller.
    assert_eq!(pace.advise(FRAME, None, MAX_FACTOR, max_factor(160)), 2);
}

#[test]
fn walls_show_their_own_glow_over_larger_cells() {
    let mut cells = Cells::new(40, 40).unwrap();
    for (x, y) in (0..40).flat_map(|y| (0..40).map(move |x| (x, y))) {
        if (9..30).contains(&x) && (9..12).contains(&y) {
            cells.set(x, y, Matter { emission: [x as f32, 0.0, 0.0], ..WALL });
        }
    }
    for factor in 2..=MAX_FACTOR {
        let (fine, light) = (lit(&cells), coarsely_lit(&cells, factor));
        for x in 9..30 {
            let (a, b) = (fine.at(x, 10)[0], light.at(x, 10)[0]);
            assert!((a - b).abs() < 0.1 * a, "factor {factor}, {x}: {a} and {b}");
        }
    }
}

#[test]
fn light_gets_finer_again_and_then_stays() {
    assert_eq!(settled(4, 0.003, true, 30.0), (1, 3));
    // A step finer would be in time, but not by much: it stays where it is.
    let (factor, changes) = settled(3, 0.040, true, 60.0);
    assert!(factor == 2 || factor == 3 && changes <= 1, "{factor} after {changes}");
    // Without times of light, no other factor is tried.
    assert_eq!(settled(3, 0.001, false, 30.0), (3, 0));
}

#[test]
fn late_frames_that_light_is_not_to_blame_for_change_nothing() {
    let mut pace = Pace::default();
    let factor = (0..200).fold(1, |factor, _| pace.advise(0.05, Some(0.001), factor, MAX_FACTOR));
    assert_eq!(factor, 1);
}

#[test]
fn normals_get_their_mean_and_the_moment_of_light_is_that_of_the_smaller_cells() {
    /// Error of the moment of light on larger cells, relative to the light; measured: 0.045.
    const COARSE: f32 = 0.1;
    let mut cells = Cells::new(64, 48).unwrap();
    cells.lamps_mut().push(Lamp { position: [20.0, 24.0], ..Lamp::default() });
    let tilt = |x: usize| normal_of_slope([if x.is_multiple_of(2) { 0.5 } else { -0.5 }, 0.3]);
    cells.normals_mut().iter_mut().enumerate().for_each(|(i, normal)| *normal = tilt(i % 64));
    let mut larger = coarse(&cells, 2);
    for &[x, y, z] in larger.normals().unwrap() {
        // Slopes to the right and to the left are flat together.
        assert!(x.abs() < 1e-6 && y < -0.2 && (y * y + z * z - 1.0).abs() < 1e-5, "{x} {y} {z}");
    }
    let fine = lit(&cells);
    let spread = upsample(&lit(&larger), &larger, &cells).unwrap();
    let off = |i: usize, axis: usize| {
        let [a, b] = [&fine, &spread].map(|light| light.moment().unwrap()[i][axis][1]);
        (a - b).abs() / fine.pixels()[i][1]
    };
    let far = (0..cells.len()).filter(|i| (i % 64) as f32 > 30.0);
    let worst = far.flat_map(|i| [off(i, 0), off(i, 1)]).fold(0.0, f32::max);
    println!("the moment is {worst:.3} off");
    assert!(worst < COARSE, "{worst}");
    // Light from the left, and not from above.
    assert!(fine.moment().unwrap()[24 * 64 + 50][0][1] < -0.5 * fine.at(50, 24)[1]);
    // Normals that are gone leave larger cells too.
    cells.clear_normals();
    downsample(&cells, 2, &mut larger).unwrap();
    assert_eq!(larger.normals(), None);
    assert_eq!(upsample(&lit(&larger), &larger, &cells).unwrap().moment(), None);
}
