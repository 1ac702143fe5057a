//! Tiles that pass into each other.

use crate::common::*;
use lamplight::world::{LitTile, Tiling};
use lamplight::{Cells, GridWindow, Light, Moment, Rgb};

fn light_of(size: [u32; 2], rgb: impl Fn(usize) -> Rgb, moment: Option<Moment>) -> Light {
    let cells = Cells::new(size[0], size[1]).unwrap();
    let light = Light::from_pixels(&cells, (0..cells.len()).map(rgb).collect()).unwrap();
    match moment {
        Some(moment) => light.with_moment(vec![moment; cells.len()], 0.5).unwrap(),
        None => light,
    }
}

/// The light of all tiles around one, by a value each; the tile itself may have a moment.
fn mixed(tiling: &Tiling, tile: GridWindow, value: impl Fn(GridWindow) -> f32) -> Light {
    let around = tiling.around(tile).unwrap();
    let lit = |&(one, part): &(GridWindow, GridWindow)| {
        let v = value(one);
        light_of(part.size, |_| [v, 2.0 * v, 0.0], Some([[v; 3], [0.0; 3]]))
    };
    let lights: Vec<_> = around.iter().map(lit).collect();
    let lights = around.iter().zip(&lights);
    let lights: Vec<_> =
        lights.map(|(&(tile, window), light)| LitTile { tile, window, light }).collect();
    tiling.mixed(tile, &lights).unwrap()
}

#[test]
fn tiles_that_agree_are_not_changed() {
    let random = &mut seeded(7);
    for _ in 0..60 {
        let size = [0; 2].map(|_| random.u32(1..200));
        let (side, halo) = (random.u32(1..90), random.u32(0..130));
        let tiling = Tiling::new(size, side, halo).unwrap();
        for tile in tiling.tiles() {
            let light = mixed(&tiling, tile, |_| 3.0);
            let (pixels, moments) = (light.pixels(), light.moment().unwrap());
            for (rgb, moment) in pixels.iter().zip(moments) {
                let off = (rgb[0] - 3.0).abs() + (rgb[1] - 6.0).abs() + (moment[0][2] - 3.0).abs();
                assert!(off < 1e-5, "{size:?}, side {side}, halo {halo}, {tile:?}: {rgb:?}");
            }
        }
    }
}

#[test]
fn light_passes_from_tile_to_tile_in_small_steps() {
    // By column and row.
    let value = |tile: GridWindow| (tile.first[0] / 64 + 10 * (tile.first[1] / 64)) as f32;
    let (size, rim) = ([150, 130], 16);
    let tiling = Tiling::new(size, 64, 2 * rim).unwrap();
    let mut whole = vec![f32::NAN; (size[0] * size[1]) as usize];
    for tile in tiling.tiles() {
        let light = mixed(&tiling, tile, value);
        for (i, rgb) in (0..).zip(light.pixels()) {
            let [x, y] = [tile.first[0] + i % tile.size[0], tile.first[1] + i / tile.size[0]];
            whole[(y * size[0] + x) as usize] = rgb[0];
        }
    }
    let at = |x: u32, y: u32| whole[(y * size[0] + x) as usize];
    let step = 1.0 / (2 * rim) as f32;
    for y in 1..size[1] {
        for x in 1..size[0] {
            let [across, down] = [at(x, y) - at(x - 1, y), (at(x, y) - at(x, y - 1)) / 10.0];
            for jump in [across, down] {
                assert!((-1e-5..step + 1e-5).contains(&jump), "{jump} at {x}, {y}");
            }
        }
    }
    // In the middle of a tile it is the tile's alone, at a border half of each.
    assert_eq!([at(32, 32), at(96, 32), at(32, 96)], [0.0, 1.0, 10.0]);
    assert!((at(63, 20) + at(64, 20) - 1.0).abs() < 1e-5 && at(63, 20) < at(64, 20));
}

#[test]
fn tiles_without_a_rim_are_not_mixed() {
    let tiling = Tiling::new([100, 40], 32, 0).unwrap();
    let tile = tiling.tiles()[1];
    assert_eq!(tiling.around(tile).unwrap(), [(tile, tile)]);
    let light = mixed(&tiling, tile, |_| 5.0);
    assert!(light.pixels().iter().all(|rgb| *rgb == [5.0, 10.0, 0.0]));
}

#[test]
fn what_is_missing_is_named() {
    assert!(Tiling::new([100, 100], 0, 64).is_err() && Tiling::new([0, 100], 64, 64).is_err());
    let tiling = Tiling::new([200, 64], 64, 32).unwrap();
    let [tile, next] = [0, 1].map(|i| tiling.tiles()[i]);
    let (own, narrow) =
        (light_of([80, 64], |_| [1.0; 3], None), light_of([80, 64], |_| [1.0; 3], None));
    let window = tiling.with_rim(tile).unwrap();
    let one = LitTile { tile, window, light: &own };
    let error = tiling.mixed(tile, &[one]).unwrap_err().to_string();
    assert!(error.contains("[64, 0]"), "{error}");
    // Known from where it begins, but not in its rim.
    let other = LitTile {
        tile: next,
        window: GridWindow { first: [64, 0], size: [80, 64] },
        light: &narrow,
    };
    let error = tiling.mixed(tile, &[one, other]).unwrap_err().to_string();
    assert!(error.contains("light"), "{error}");
    // A window of another size than the light.
    let other = LitTile { window: tiling.with_rim(next).unwrap(), ..other };
    assert!(tiling.mixed(tile, &[one, other]).is_err());
    // Windows that are no tiles.
    for (first, size) in
        [([1, 0], [64; 2]), ([64, 0], [65, 64]), ([256, 0], [64; 2]), ([u32::MAX; 2], [2; 2])]
    {
        let window = GridWindow { first, size };
        assert!(tiling.with_rim(window).is_err() && tiling.around(window).is_err(), "{window}");
        assert!(tiling.mixed(window, &[]).is_err());
    }
}

#[test]
fn a_moment_that_a_neighbour_lacks_is_not_mixed() {
    let tiling = Tiling::new([128, 64], 64, 32).unwrap();
    let [tile, next] = [0, 1].map(|i| tiling.tiles()[i]);
    let windows = [tile, next].map(|tile| tiling.with_rim(tile).unwrap());
    let moment = [[0.5; 3], [0.0; 3]];
    let own = light_of(windows[0].size, |_| [1.0; 3], Some(moment));
    let other = light_of(windows[1].size, |_| [1.0; 3], None);
    let lights = [
        LitTile { tile, window: windows[0], light: &own },
        LitTile { tile: next, window: windows[1], light: &other },
    ];
    let mixed = tiling.mixed(tile, &lights).unwrap();
    assert!(mixed.moment().unwrap().iter().all(|found| *found == moment));
}
