//! The scene that `lamplight bench` times: the same at every size.

use crate::error::Result;
use lamplight::{Cells, Lamp, Matter, Rgb};

/// Cells per lamp in the scene of lamps: a thousand lamps at 1280×720.
const CELLS_TO_A_LAMP: f64 = 921.6;
/// The range of those lamps, px.
const RANGE: f32 = 64.0;
/// The number of walls.
const WALLS: u32 = 26;
/// The number of glowing discs.
const EMITTERS: u32 = 36;

/// Like [`bench_scene`], with lamps in place of emitters, for methods that evaluate only lamps. All
/// lamps have the same range; larger grids have more lamps.
pub fn bench_scene_of_lamps(width: u32, height: u32) -> Result<Cells> {
    let mut cells = walls(width, height)?;
    let (w, h) = (width as f32, height as f32);
    let lamps = (cells.len() as f64 / CELLS_TO_A_LAMP).ceil() as u32;
    cells.lamps_mut().extend((0..lamps).map(|k| {
        let [x, y] = spread(k, 0.81);
        let color = hue(k as f32 * 0.137, 0.7, 1.0);
        Lamp { position: [x * w, y * h], color, range: RANGE, ..Lamp::default() }
    }));
    Ok(cells)
}

/// Walls and a few dozen emitters, at the same fractions of the sides at every size, so larger grids
/// show the same scene in more cells.
pub fn bench_scene(width: u32, height: u32) -> Result<Cells> {
    let mut cells = walls(width, height)?;
    let (w, h) = (width as f32, height as f32);
    let unit = unit(w, h);
    for k in 0..EMITTERS {
        let [x, y] = spread(k, 0.81);
        let radius = ((1.5 + (k % 4) as f32) * unit).max(0.75);
        let glow =
            Matter { emission: hue(k as f32 * 0.137, 0.7, 4.0), opacity: 1.0, ..Matter::EMPTY };
        fill(&mut cells, [x * w, y * h], [radius; 2], glow, |[dx, dy]| {
            dx * dx + dy * dy <= radius * radius
        });
    }
    Ok(cells)
}

/// The unit of all lengths, px.
fn unit(w: f32, h: f32) -> f32 {
    w.min(h) / 180.0
}

/// The walls without lights.
fn walls(width: u32, height: u32) -> Result<Cells> {
    let mut cells = Cells::new(width, height)?;
    let (w, h) = (width as f32, height as f32);
    let unit = unit(w, h);
    for k in 0..WALLS {
        let [x, y] = spread(k, 0.37);
        let (long, thin) = ((14.0 + 3.0 * (k % 9) as f32) * unit, 2.0 * unit.max(0.5));
        let half = if k % 2 == 0 { [long, thin] } else { [thin, long] };
        let wall =
            Matter { opacity: 1.0, albedo: hue(k as f32 * 0.19, 0.35, 0.8), ..Matter::EMPTY };
        fill(&mut cells, [x * w, y * h], half, wall, |_| true);
    }
    Ok(cells)
}

/// Sets matter in the cells of a box whose centres are `inside`.
fn fill(
    cells: &mut Cells,
    centre: [f32; 2],
    half: [f32; 2],
    matter: Matter,
    inside: impl Fn([f32; 2]) -> bool,
) {
    let range = |axis: usize, side: u32| {
        let from = (centre[axis] - half[axis] - 0.5).ceil().max(0.0) as u32;
        let to = (centre[axis] + half[axis] - 0.5).floor().max(-1.0) + 1.0;
        from..(to as u32).min(side)
    };
    for y in range(1, cells.height()) {
        for x in range(0, cells.width()) {
            if inside([x as f32 + 0.5 - centre[0], y as f32 + 0.5 - centre[1]]) {
                cells.set(x, y, matter);
            }
        }
    }
}

/// The k-th place of a low-discrepancy sequence over the unit square (Roberts 2018, R₂).
fn spread(k: u32, start: f64) -> [f32; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053]
        .map(|step| (start + step * f64::from(k)).fract() as f32)
}

/// A colour by its hue, in turns.
fn hue(turns: f32, saturation: f32, scale: f32) -> Rgb {
    std::array::from_fn(|c| {
        let wave = 0.5 + 0.5 * ((turns + c as f32 / 3.0) * std::f32::consts::TAU).cos();
        scale * (1.0 - saturation + saturation * wave)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_size_is_a_scene() {
        for (w, h) in [(1, 1), (7, 3), (61, 53), (320, 180)] {
            let cells = bench_scene(w, h).unwrap();
            cells.check().unwrap();
            assert_eq!((cells.width(), cells.height()), (w, h));
        }
    }

    #[test]
    fn a_thousand_lamps_stand_in_the_large_scene_of_lamps() {
        let cells = bench_scene_of_lamps(1280, 720).unwrap();
        cells.check().unwrap();
        assert_eq!(cells.lamps().len(), 1000);
        assert_eq!(bench_scene_of_lamps(1, 1).unwrap().lamps().len(), 1);
    }

    #[test]
    fn it_has_walls_and_lights_and_open_cells() {
        let cells = bench_scene(320, 180).unwrap();
        let share = |count: usize| count as f64 / cells.len() as f64;
        let solid = share((0..cells.len()).filter(|&i| cells.is_solid(i)).count());
        let glowing = share(cells.emission().iter().filter(|e| e[0] > 0.0).count());
        assert!((0.05..0.3).contains(&solid), "{solid} of the cells are solid");
        assert!((0.005..0.1).contains(&glowing), "{glowing} of the cells glow");
    }
}
