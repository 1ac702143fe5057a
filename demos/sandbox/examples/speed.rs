//! Prints the times of a step, of drawing and of downsampling for every world at 640×360, on one core.

use anyhow::Result;
use lamplight::Cells;
use lamplight::resample::downsample;
use lamplight_sandbox::worlds::{Input, WorldKind};
use std::time::Instant;

const SIZE: [u32; 2] = [640, 360];
const STEPS: u32 = 300;

fn main() -> Result<()> {
    for &kind in WorldKind::ALL {
        let mut world = kind.make(SIZE, 1)?;
        let mut cells = Cells::new(SIZE[0], SIZE[1])?;
        world.draw(&mut cells);
        let (mut coarse, mut millis) = (Cells::new(1, 1)?, [Vec::new(), Vec::new(), Vec::new()]);
        for _ in 0..STEPS {
            let start = Instant::now();
            world.step(&Input::default());
            millis[0].push(start.elapsed().as_secs_f64() * 1e3);
            let start = Instant::now();
            world.draw(&mut cells);
            millis[1].push(start.elapsed().as_secs_f64() * 1e3);
            let start = Instant::now();
            downsample(&cells, 2, &mut coarse)?;
            millis[2].push(start.elapsed().as_secs_f64() * 1e3);
        }
        for (name, mut millis) in ["step", "draw", "coarsen"].into_iter().zip(millis) {
            millis.sort_unstable_by(f64::total_cmp);
            let at = |share: f64| millis[(share * (millis.len() - 1) as f64) as usize];
            println!("{} {name}: median {:.2} ms, 95 % {:.2} ms", kind.name(), at(0.5), at(0.95));
        }
    }
    Ok(())
}
