//! The cost of frames, as counted by the code.

use crate::common::{device, on_gpu};
use lamplight::settings::Holographic;
use lamplight::{Cells, Settings};
use lamplight_wgpu::{Cost, FrameInput, Lighting, LightingOptions};
use wgpu::{Device, DeviceType, Queue};

fn direct(preset: &str) -> Settings {
    Settings::direct(Holographic::preset(preset).unwrap())
}

fn cost(
    (device, queue): &(Device, Queue),
    settings: &Settings,
    [width, height]: [u32; 2],
    fused_levels: u32,
) -> Cost {
    let options = LightingOptions { fused_levels: Some(fused_levels), ..on_gpu() };
    let mut lighting = Lighting::new(device, queue, &options).unwrap();
    let cells = Cells::new(width, height).unwrap();
    lighting.prepare(&FrameInput::of_cells(settings, &cells)).unwrap();
    lighting.cost().unwrap()
}

/// Megabytes that a frame may take on a card with memory of its own, which sweeps more quadrants together.
const ON_A_CARD: u64 = 1100;

/// The most megabytes on this GPU.
fn most_held((device, _): &(Device, Queue), most: u64) -> u64 {
    let is_card = device.adapter_info().device_type == DeviceType::DiscreteGpu;
    if is_card { ON_A_CARD } else { most }
}

/// Megabytes that a frame may take at 512² and 1024², by preset. At 512² all quadrants go together.
const MEMORY: [(&str, [u64; 2]); 2] = [("default", [102, 155]), ("fast", [40, 160])];
/// Megabytes that a frame may move.
const MOVED: [(&str, [f64; 2]); 2] = [("default", [300.0, 1290.0]), ("fast", [102.0, 430.0])];

#[test]
fn holographic_fuses_levels_and_takes_little_memory() {
    let gpu = device();
    for ((preset, most), (_, most_moved)) in MEMORY.into_iter().zip(MOVED) {
        for ((side, most), most_moved) in [512, 1024].into_iter().zip(most).zip(most_moved) {
            let [one, fused] = [1, LightingOptions::MAX_FUSED_LEVELS]
                .map(|levels| cost(&gpu, &direct(preset), [side; 2], levels));
            let moved = |cost: &Cost, all: bool| {
                let levels = ["holographic/extend", "holographic/merge"];
                let counted = cost.pipelines.iter().filter(|p| all || levels.contains(&p.shader));
                counted.map(|k| k.traffic.read + k.traffic.written).sum::<u64>() as f64 / 1e6
            };
            println!(
                "{preset} {side}²: one level a dispatch {} dispatches, {:.0} MB moved, {:.0} MB by levels; \
                 fused {}, {:.0} and {:.0} MB; {:.0} MB held",
                one.dispatches(),
                moved(&one, true),
                moved(&one, false),
                fused.dispatches(),
                moved(&fused, true),
                moved(&fused, false),
                fused.memory as f64 / 1e6
            );
            let most = most_held(&gpu, most);
            assert!(fused.memory <= most * 1_000_000, "{} of {most} MB", fused.memory);
            assert!(moved(&fused, true) <= most_moved, "more than {most_moved} MB moved");
            assert!(
                moved(&fused, false) <= 0.62 * moved(&one, false),
                "fused levels move too much"
            );
        }
    }
}

#[test]
fn the_first_moment_costs_what_it_moves() {
    let gpu = device();
    let moved = |moment| {
        let settings = Settings { moment, ..direct("fast") };
        let cost = cost(&gpu, &settings, [128; 2], LightingOptions::MAX_FUSED_LEVELS);
        let gather = cost.pipelines.iter().find(|p| p.shader == "holographic/gather").unwrap();
        gather.traffic
    };
    let [without, with] = [false, true].map(moved);
    // Two components of 16 bytes per pixel: four quadrants write them, and all but the first read them.
    let bytes = 2 * 16 * 128 * 128;
    assert_eq!(with.written, without.written + 4 * bytes);
    assert_eq!(with.read, without.read + 3 * bytes);
}

/// Dispatches and megabytes at 1920×1080, with light that sinks into walls: each quadrant is one chunk.
const LARGE: (usize, u64) = (50, 400);
/// Megabytes that presets may move there. Memory of 40 GB/s moves 667 in a frame at 60 Hz.
const MOVED_THERE: [(&str, f64); 4] =
    [("default", 3150.0), ("fast", 1010.0), ("coarse", 430.0), ("high", 2500.0)];

#[test]
fn a_large_grid_takes_few_dispatches() {
    let gpu = device();
    for (preset, most_moved) in MOVED_THERE {
        let settings = Settings { wall_depth: Settings::default().wall_depth, ..direct(preset) };
        let cost = cost(&gpu, &settings, [1920, 1080], LightingOptions::MAX_FUSED_LEVELS);
        let (dispatches, held) = (cost.dispatches(), cost.memory / 1_000_000);
        let traffic = cost.traffic();
        let moved = (traffic.read + traffic.written) as f64 / 1e6;
        println!(
            "{preset} at 1920×1080: {dispatches} dispatches, {held} MB held, {moved:.0} MB moved"
        );
        let most = most_held(&gpu, LARGE.1);
        assert!(dispatches <= LARGE.0 && held <= most, "{preset}: {dispatches}, {held} MB");
        assert!(moved <= most_moved, "{preset}: {moved} MB");
    }
}

/// Megabytes that the published cascades may take at 512² and 1024².
const PUBLISHED: [(u32, u64); 2] = [(512, 75), (1024, 310)];

#[test]
fn the_published_cascades_fit_within_the_limits_of_the_web() {
    let gpu = device();
    for (side, most) in PUBLISHED {
        let cost = cost(&gpu, &direct("paper"), [side; 2], 1);
        let moved = cost.traffic();
        println!(
            "paper {side}²: {} dispatches, {:.0} MB moved, {:.0} MB held",
            cost.dispatches(),
            (moved.read + moved.written) as f64 / 1e6,
            cost.memory as f64 / 1e6
        );
        assert!(cost.memory <= most * 1_000_000, "{} of {most} MB", cost.memory);
    }
}
