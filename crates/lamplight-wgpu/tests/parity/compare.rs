//! Light of the GPU compared with that of the CPU, pixel by pixel.

use crate::common::{adapter, cells, device, frame, lighting};
use lamplight::settings::{Hit, MethodSettings};
use lamplight::{Cells, GridWindow, Method, Rgb, Scene, Settings, Solver};
use lamplight_wgpu::Lighting;
use std::sync::LazyLock;
use wgpu::{Device, DeviceType, Queue};

/// One cell, lines, primes, a power of two, not square, larger than a word of columns.
pub const SIZES: [[u32; 2]; 8] =
    [[1, 1], [1, 37], [41, 1], [31, 17], [64, 64], [97, 61], [127, 131], [320, 180]];

/// The example scenes with their names.
pub fn scenes() -> Vec<(String, Scene)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| (path.file_stem().unwrap().display().to_string(), Scene::load(&path).unwrap()))
        .collect();
    assert!(scenes.len() >= 9);
    scenes
}

/// The middle of a scene, half as wide and half as high, under all of its lamps: a software GPU lights whole scenes for
/// minutes, and finds nothing more in them.
pub fn middle(scene: &Scene) -> Cells {
    let cells = scene.cells().unwrap();
    let size = [cells.width(), cells.height()];
    let first = size.map(|side| side / 4);
    cells.window(GridWindow { first, size: size.map(|side| side / 2) }).unwrap()
}

/// The tolerance, relative to a pixel's light or to the mean, whichever is larger: rounding, and occasionally a
/// ray that passes a corner on the other side. Measured at up to 9e-5.
pub const TOLERANCE: f64 = 1e-3;
/// The fraction of pixels that may be off where rounding decides. Rays that end by the distance field:
/// whether it is below `hit_distance` if both are equal; measured at up to 5e-5. `polar`: whether a line to a
/// lamp in the middle of a cell, or on a corner, is stopped by a wall whose corner it passes exactly; none in
/// the scenes here, and 2 in 700 000 pixels lit by one of 600 such lamps each.
pub const TIES: f64 = 1e-4;

/// The fraction of pixels that may be off on a GPU of silicon, where rays are traced through the cells one by one: it fuses
/// multiplications with additions and knows sines to 20 bits, so a few rays pass corners on the other side. On an NVIDIA
/// H100 up to 8 in 1000 pixels were off for one ray of a shadow map, 74 of a frame of 57600 after a blur. `holographic`
/// has its rays from a table, and no ties there either.
const TIES_OF_HARDWARE: f64 = 1e-2;
/// The mean of the differences of all pixels in that case.
const MEAN_OF_HARDWARE: f64 = 3e-4;

static IS_HARDWARE: LazyLock<bool> =
    LazyLock::new(|| adapter().get_info().device_type != DeviceType::Cpu);

/// The fraction of pixels that may be off, and the mean difference, on this GPU.
pub fn allowed(ties: f64, method: Method) -> [f64; 2] {
    if *IS_HARDWARE && method != Method::Holographic {
        [ties.max(TIES_OF_HARDWARE), MEAN_OF_HARDWARE]
    } else {
        [ties, f64::INFINITY]
    }
}

/// The relative difference of each pixel.
pub fn differences(seen: &[Rgb], right: &[Rgb]) -> Vec<f64> {
    assert_eq!(seen.len(), right.len());
    let sum: f64 = right.as_flattened().iter().map(|&v| f64::from(v)).sum();
    let mean = sum / (3 * right.len()) as f64;
    let of = |seen: f32, right: f32| {
        f64::from((seen - right).abs()) / f64::from(right).max(mean).max(f64::MIN_POSITIVE)
    };
    let pixel = |(seen, right): (&Rgb, &Rgb)| {
        (0..3)
            .map(|c| of(seen[c], right[c]))
            .fold(0.0, |worst: f64, one| if worst.is_nan() || one <= worst { worst } else { one })
    };
    seen.iter().zip(right).map(pixel).collect()
}

/// The number of pixels that differ by more than the tolerance, or are not numbers.
pub fn wrong(seen: &[Rgb], right: &[Rgb]) -> usize {
    differences(seen, right).into_iter().filter(|d| d.is_nan() || *d > TOLERANCE).count()
}

#[track_caller]
pub fn agree(gpu: &(Device, Queue), name: &str, cells: &Cells, settings: Settings) {
    Both::new(gpu, settings).agree(gpu, name, cells);
}

/// Lets a fraction of the pixels be off: ties that rounding decides.
#[track_caller]
pub fn agree_but_for(
    ties: f64,
    gpu: &(Device, Queue),
    name: &str,
    cells: &Cells,
    settings: Settings,
) {
    Both::new(gpu, settings).agree_but_for(ties, gpu, name, cells);
}

/// CPU and GPU with the same settings, frame by frame.
pub struct Both {
    pub solver: Solver,
    pub lighting: Lighting,
}

impl Both {
    pub fn new((device, queue): &(Device, Queue), settings: Settings) -> Self {
        let solver = Solver::new(settings).unwrap();
        Self { solver, lighting: lighting(device, queue) }
    }

    /// Lights a frame on both.
    pub fn light(&mut self, (device, queue): &(Device, Queue), cells: &Cells) -> [Vec<Rgb>; 2] {
        let settings = self.solver.settings().clone();
        let right = self.solver.solve(cells).unwrap().pixels().to_vec();
        let seen = frame(device, queue, &mut self.lighting, &settings, cells);
        [seen.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(), right]
    }

    #[track_caller]
    pub fn agree(&mut self, gpu: &(Device, Queue), name: &str, cells: &Cells) {
        let settings = self.solver.settings();
        let tied = match &settings.method {
            MethodSettings::Raymarch(raymarch) => raymarch.hit == Hit::Distance,
            method => method.method() == Method::Polar,
        };
        let ties = if tied { TIES } else { 0.0 };
        self.agree_but_for(ties, gpu, name, cells);
    }

    #[track_caller]
    pub fn agree_but_for(&mut self, ties: f64, gpu: &(Device, Queue), name: &str, cells: &Cells) {
        let allowed = allowed(ties, self.solver.settings().method());
        let [seen, right] = self.light(gpu, cells);
        agrees(name, &seen, &right, allowed);
    }
}

#[track_caller]
pub fn agrees(name: &str, seen: &[Rgb], right: &[Rgb], [ties, mean]: [f64; 2]) {
    let differences = differences(seen, right);
    let worst = differences.iter().copied().fold(0.0, f64::max);
    let wrong = wrong(seen, right);
    println!("{name}: {worst:.1e}, {wrong} of {} pixels wrong", right.len());
    assert!(wrong as f64 <= ties * right.len() as f64, "{name}: {wrong} pixels, {worst:e}");
    let of_all = differences.iter().sum::<f64>() / right.len() as f64;
    assert!(of_all <= mean, "{name}: {of_all:e} on the mean");
}

#[test]
fn one_wrong_pixel_is_rejected() {
    let settings = Settings::direct(Method::Raymarch);
    let gpu = device();
    let [seen, right] = Both::new(&gpu, settings).light(&gpu, &cells(97, 61, 3));
    assert_eq!(wrong(&seen, &right), 0);
    let mean = right.as_flattened().iter().sum::<f32>() / (3 * right.len()) as f32;
    for change in [0.01 * mean, f32::NAN, f32::INFINITY] {
        let mut changed = seen.clone();
        changed[2000][1] += change;
        assert_eq!(wrong(&changed, &right), 1, "{change} passes");
    }
}
