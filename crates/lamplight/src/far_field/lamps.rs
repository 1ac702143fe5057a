//! Lamps beyond a window, which may move while the world around it stands still: seen behind the blocks on the way.

use super::levels::BlockLevel;
use super::march::{BlockRay, RayDirection, Rings, march};
use super::read::SIDE;
use crate::{BorderPlace, GridWindow, Inflow, Lamp, Result, Rgb, lamp_inflow};

/// Returns the light that enters a window, which begins at a multiple of 4, with that of lamps, px of the world, added to
/// `inflow`.
///
/// # Errors
/// As [`Inflow::new`].
pub fn with_lamps(
    levels: &[BlockLevel],
    window: GridWindow,
    inflow: &Inflow,
    lamps: &[Lamp],
) -> Result<Inflow> {
    let rings = Rings::around(window, levels.len());
    let first = window.first.map(|v| v as f32);
    let relative = |lamp: &Lamp| {
        let position = [0, 1].map(|a| lamp.position[a] - first[a]);
        Lamp { position, ..lamp.clone() }
    };
    let lamps: Vec<Lamp> = lamps.iter().map(relative).collect();
    lamp_inflow::with_lamps(inflow, &lamps, SIDE as u32, |place, point| {
        through(levels, &rings, window, place, point)
    })
}

/// Returns the transmittance of the way from a place on the border of a window to a point, px of the window.
fn through(
    levels: &[BlockLevel],
    rings: &Rings,
    window: GridWindow,
    place: BorderPlace,
    point: [f64; 2],
) -> Rgb {
    let along = place.side() % 2;
    let across = 1 - along;
    let outward = f64::from(place.outward[across]);
    let mut block = window.first.map(|v| (v / SIDE as u32) as i32);
    block[along] += (place.at[along] / SIDE as f32) as i32;
    block[across] += match outward {
        o if o < 0.0 => -1,
        _ => window.size[across].div_ceil(SIDE as u32) as i32,
    };
    let mut from = block.map(|v| (f64::from(v) + 0.5) * SIDE as f64);
    from[across] -= outward * 0.5 * SIDE as f64;
    let way = [0, 1].map(|a| f64::from(window.first[a]) + point[a] - from[a]);
    let reach = way[0].hypot(way[1]);
    // What lies in the first block may lie behind the lamp.
    if way[across] * outward <= 0.0 || reach < SIDE as f64 {
        return [1.0; 3];
    }
    let direction = RayDirection::new(way[1].atan2(way[0]));
    let [_, through] = march(levels, rings, BlockRay { from, direction: &direction, block, reach });
    through
}
