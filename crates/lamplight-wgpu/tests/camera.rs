//! A camera over a world: light stays where it is while the camera moves.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{device, lighting, raymarch_of, recorded, seeded};
use lamplight::settings::{MethodSettings, Noise, Temporal};
use lamplight::{Bounces, Cells, Display, Matter, Method, Settings, ToneMap};
use lamplight_wgpu::{
    Backend, Camera2dView, Compose, ComposeParams, Filter, FrameInput, GridPlacement, Lighting,
    LightingOptions,
};
use textures::{fetch, texture, view};
use wgpu::{Device, Queue, TextureFormat, TextureUsages};

/// Blocks of a world that end 40 cells from its origin, well inside every grid of these tests.
struct World(Vec<([i32; 2], [i32; 2], Matter)>);

impl World {
    fn new() -> Self {
        let mut random = seeded(5);
        let block = |_| {
            let [x, y] = [0; 2].map(|_| random.i32(0..74) - 40);
            let [w, h] = [0; 2].map(|_| 1 + random.i32(0..6));
            let colour = [0; 3].map(|_| random.f32());
            let matter = match random.u32(..4) {
                0 => Matter { emission: colour.map(|v| 9.0 * v), opacity: 1.0, ..Matter::EMPTY },
                1 => Matter { opacity: 0.1, tint: colour, ..Matter::EMPTY },
                _ => Matter { opacity: 1.0, albedo: colour, ..Matter::EMPTY },
            };
            ([x, y], [x + w, y + h], matter)
        };
        Self((0..60).map(block).collect())
    }

    /// The cells that a host draws for a camera.
    fn cells(&self, placed: &GridPlacement) -> Cells {
        let GridPlacement { size: [width, height], origin, .. } = *placed;
        let mut cells = Cells::new(width, height).unwrap();
        for &(low, high, matter) in &self.0 {
            for (x, y) in (low[1]..high[1]).flat_map(|y| (low[0]..high[0]).map(move |x| (x, y))) {
                let [column, row] = [x - origin[0], y - origin[1]];
                assert!(column >= 0 && row >= 0 && column < width as i32 && row < height as i32);
                cells.set(column as u32, row as u32, matter);
            }
        }
        cells
    }
}

fn settings(noise: Noise) -> Settings {
    let mut settings = Settings::direct(Method::Raymarch);
    settings.bounces = Bounces::Count(1);
    raymarch_of(&mut settings).noise = noise;
    raymarch_of(&mut settings).rays = 16;
    settings
}

fn camera(position: [f64; 2]) -> Camera2dView {
    Camera2dView { position, zoom: 4.0, border: 30, ..Camera2dView::default() }
}

/// Lights the world for a camera, with the grid at `origin`.
fn frame(
    (device, queue): &(Device, Queue),
    lighting: &mut Lighting,
    settings: &Settings,
    placed: &GridPlacement,
    origin: [i32; 2],
) -> Vec<[f32; 4]> {
    let cells = World::new().cells(placed);
    let input = FrameInput::of_cells(settings, &cells);
    lighting.prepare(&FrameInput { origin, ..input }).unwrap();
    recorded(device, queue, lighting)
}

/// The light of the first frame, with the right or a wrong origin.
fn light(
    gpu: &(Device, Queue),
    settings: &Settings,
    placed: &GridPlacement,
    right: bool,
) -> Vec<[f32; 4]> {
    let origin = if right { placed.origin } else { [0; 2] };
    frame(gpu, &mut lighting(&gpu.0, &gpu.1), settings, placed, origin)
}

/// The number of places in the world that both grids hold and whose light differs by more than rounding, 1e-4
/// of it or of 1; and the number of all that both hold.
fn moved([a, b]: [(&GridPlacement, &[[f32; 4]]); 2]) -> [usize; 2] {
    let shift: [i32; 2] = std::array::from_fn(|i| b.0.origin[i] - a.0.origin[i]);
    let [width, height] = a.0.size.map(|v| v as i32);
    let mut counts = [0; 2];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (u, v) = (x - shift[0], y - shift[1]);
        if u < 0 || v < 0 || u >= width || v >= height {
            continue;
        }
        let (one, other) = (a.1[(y * width + x) as usize], b.1[(v * width + u) as usize]);
        let off = (0..3).any(|c| (one[c] - other[c]).abs() > 1e-4 * one[c].max(1.0));
        counts[0] += usize::from(off);
        counts[1] += 1;
    }
    counts
}

/// The fraction of cells one of whose rays may pass a corner on the other side: the origin of the grid decides
/// how places along a ray are rounded. Measured at up to 1e-4.
const CORNERS: f64 = 1e-3;

#[test]
fn light_stays_in_the_world_when_the_camera_moves_by_whole_cells() {
    let gpu = device();
    let here = camera([0.0, 0.0]).place([320, 240]).unwrap();
    for noise in [Noise::White, Noise::Blue, Noise::Golden] {
        let settings = settings(noise);
        let first = light(&gpu, &settings, &here, true);
        for step in [[1.0, 0.0], [-7.0, 5.0], [16.0, -16.0]] {
            let there = camera(step).place([320, 240]).unwrap();
            let next = light(&gpu, &settings, &there, true);
            let [off, all] = moved([(&here, &first), (&there, &next)]);
            println!("{noise:?}, {step:?}: {off} of {all} cells differ");
            assert!(all > 10_000 && off as f64 <= CORNERS * all as f64, "{noise:?}, {step:?}");

            // Noise that stays on the screen is seen.
            let astray = light(&gpu, &settings, &there, false);
            let [off, all] = moved([(&here, &first), (&there, &astray)]);
            assert!(off > all / 3, "{noise:?}, {step:?}: {off} of {all}");
        }
    }
}

/// The light of the last of some frames, one after the other. `resets`: history is dropped before each.
fn last_frame(
    gpu: &(Device, Queue),
    mut lighting: Lighting,
    settings: &Settings,
    places: impl Iterator<Item = GridPlacement>,
    resets: bool,
) -> Vec<[f32; 4]> {
    let mut light = Vec::new();
    for placed in places {
        if resets {
            lighting.reset();
        }
        light = frame(gpu, &mut lighting, settings, &placed, placed.origin);
    }
    light
}

/// A camera that runs on for some frames, each a step further, and one that stays where it ends.
#[test]
fn the_mean_over_frames_stays_in_the_world_when_the_camera_moves() {
    const FRAMES: u32 = 6;
    let gpu = device();
    for feedback in [false, true] {
        let mut settings = settings(Noise::Blue);
        raymarch_of(&mut settings).temporal = Temporal { history_length: 32, reject: true };
        if feedback {
            settings.bounces = Bounces::Feedback;
        }
        let place = |x: f64| camera([x, -x]).place([320, 240]).unwrap();
        let end = place(f64::from(FRAMES - 1));
        let run = |place: &dyn Fn(u32) -> GridPlacement, resets: bool| {
            let places = (0..FRAMES).map(place);
            last_frame(&gpu, lighting(&gpu.0, &gpu.1), &settings, places, resets)
        };
        let still = run(&|_| end, false);
        let moving = run(&|number| place(f64::from(number)), false);
        let forgetful = run(&|number| place(f64::from(number)), true);
        // Cells that came into the grid on the way have less history.
        let edge = FRAMES as usize;
        let width = end.size[0] as usize;
        let inner = |light: &[[f32; 4]]| -> Vec<[f32; 4]> {
            let rows = light.chunks(width).skip(edge);
            let rows: Vec<_> = rows.map(|row| row[edge..width - edge].to_vec()).collect();
            rows[..rows.len() - edge].concat()
        };
        let off = |light: &[[f32; 4]]| {
            let pairs = inner(light).into_iter().zip(inner(&still));
            pairs
                .filter(|(a, b)| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-4 * b[c].max(1.0)))
                .count()
        };
        let (off, lost, all) = (off(&moving), off(&forgetful), inner(&still).len());
        println!("feedback {feedback}: {off} of {all} cells differ, {lost} of those that forget");
        assert!(
            off as f64 <= f64::from(FRAMES) * CORNERS * all as f64,
            "feedback {feedback}: {off}"
        );
        assert!(lost > all / 3, "feedback {feedback}: {lost} of {all}");
    }
}

/// Bounces over frames go on while the camera moves, and while its picture grows, in the methods without noise.
#[test]
fn feedback_stays_in_the_world_when_the_grid_moves_and_grows() {
    const FRAMES: u32 = 12;
    let gpu = device();
    let moving = |x: u32| camera([f64::from(x), -f64::from(x)]).place([320, 240]).unwrap();
    let growing = |x: u32| {
        camera([0.0; 2]).place([320, 240].map(|side| side - 4 * (FRAMES - 1 - x))).unwrap()
    };
    let methods = [(Method::Cascades, "default"), (Method::Holographic, "fast")];
    let both =
        methods.into_iter().flat_map(|method| [(method, Backend::Gpu), (method, Backend::Cpu)]);
    for ((method, preset), backend) in both {
        let preset = MethodSettings::preset(method, preset).unwrap();
        let settings = Settings { bounces: Bounces::Feedback, ..Settings::direct(preset) };
        for (name, place) in
            [("moving", &moving as &dyn Fn(u32) -> GridPlacement), ("growing", &growing)]
        {
            let run = |place: &dyn Fn(u32) -> GridPlacement, resets: bool| {
                let options = LightingOptions::on(backend);
                let lighting = Lighting::new(&gpu.0, &gpu.1, &options).unwrap();
                last_frame(&gpu, lighting, &settings, (0..FRAMES).map(place), resets)
            };
            let still = run(&|_| place(FRAMES - 1), false);
            let sum: f64 = still.iter().map(|light| f64::from(light[1])).sum();
            let off = |resets: bool| {
                let light = run(place, resets);
                let pairs = light.iter().zip(&still);
                pairs.map(|(a, b)| f64::from((a[1] - b[1]).abs())).sum::<f64>() / sum
            };
            let [kept, forgotten] = [false, true].map(off);
            println!(
                "{method:?} on {backend:?}, {name}: {kept:.4} off, {forgotten:.4} if it forgets"
            );
            assert_ne!(place(0), place(1), "{name}: the grid stays the same");
            assert!(kept < 0.01, "{method:?} on {backend:?}, {name}: {kept}");
            assert!(forgotten > 0.05, "{method:?}, {name}: {forgotten}");
        }
    }
}

#[test]
fn the_picture_follows_a_camera_that_moves_by_fractions() {
    let gpu = device();
    let (device, queue) = &gpu;
    let pixels = [320, 240];
    let settings = settings(Noise::Blue);
    let picture = |x: f64| {
        let placed = camera([x, 0.0]).place(pixels).unwrap();
        let mut lighting = lighting(device, queue);
        frame(&gpu, &mut lighting, &settings, &placed, placed.origin);
        let format = TextureFormat::Rgba8Unorm;
        let target = texture(device, pixels, format, TextureUsages::RENDER_ATTACHMENT);
        let params = ComposeParams {
            display: Display { tonemap: ToneMap::Reinhard, ..Display::PLAIN },
            filter: Filter::Linear,
            visible: Some(placed.visible),
            ..ComposeParams::default()
        };
        let mut compose = Compose::new(device, queue).unwrap();
        compose.prepare(&lighting, format, &params).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        compose.record(&mut encoder, &view(&target)).unwrap();
        queue.submit([encoder.finish()]);
        (placed.origin, fetch(device, queue, &target))
    };
    let (origin, first) = picture(0.0);
    let width = pixels[0] as usize;
    let mut origins = Vec::new();
    // A quarter of a cell is a pixel; after four of them the grid jumps.
    for step in 1..=5 {
        let (there, seen) = picture(f64::from(step) / 4.0);
        origins.push(there[0] - origin[0]);
        let step = step as usize;
        let mut off = 0;
        for (row, before) in seen.chunks(4 * width).zip(first.chunks(4 * width)) {
            let (row, before) = (&row[..4 * (width - step)], &before[4 * step..]);
            off += row.iter().zip(before).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        }
        // A corner is seen in the up to 64 pixels round its cell.
        let all = first.len();
        assert!(off as f64 <= 64.0 * CORNERS * all as f64, "{step}: {off} of {all} bytes differ");
        assert!(origins[step - 1] > 0 || off == 0, "{step}: {off} bytes of the same light differ");
    }
    assert_eq!(origins, [0, 0, 0, 1, 1]);
}
