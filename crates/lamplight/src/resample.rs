//! Light on a coarser grid: downsampled cells, and light upsampled again, for slow machines.
//!
//! `factor × factor` cells become one. It is solid if the solid cells in the block are at least half as
//! many as the block is wide, so that a wall of one px stays shut, or if a solid cell in it emits, so
//! that small lights are not lost; gaps narrower than a block close. Its emission is reduced by the
//! ratio of the emitter's width to the block's, so that it looks as bright from afar. Fog and glass keep
//! their transmittance over the block: `T = Π Tᵢ^(1/factor)` over its cells, the mean path. Glow, which is
//! per px, is `factor` times as strong in a cell that many px wide. Its normal is the mean of theirs; the first
//! moment of the light is upsampled too, so that the picture is lit by its own, finer normals.

use crate::mask::ALL_LAYERS;
use crate::math::transmittance::extinction;
use crate::relief::unit;
use crate::{Cells, Cookie, Error, Lamp, Light, Matter, Result, Rgb};

/// The largest downsampling factor of acceptable quality.
pub const MAX_FACTOR: u32 = 4;
/// The minimum number of columns of downsampled light.
const MIN_COLUMNS: u32 = 80;

/// Returns the largest useful downsampling factor of a picture with this number of columns.
pub fn max_factor(columns: u32) -> u32 {
    (columns / MIN_COLUMNS).clamp(1, MAX_FACTOR)
}

/// Draws cells into fewer, larger ones, without their inflow, which is that of a grid of another size. Buffers of the right
/// size are used again.
///
/// A factor above [`MAX_FACTOR`] counts as [`MAX_FACTOR`], and 0 as 1.
///
/// # Errors
/// Fails only if the smaller grid cannot be created.
pub fn downsample(from: &Cells, factor: u32, to: &mut Cells) -> Result<()> {
    let factor = factor.clamp(1, MAX_FACTOR);
    let size = [from.width(), from.height()].map(|side| side.div_ceil(factor));
    if [to.width(), to.height()] != size {
        *to = Cells::new(size[0], size[1])?;
    }
    to.set_sky(from.sky().clone());
    to.lamps_mut().clear();
    to.lamps_mut().extend(from.lamps().iter().cloned().map(|lamp| shrunk(lamp, factor)));
    to.suns_mut().clear();
    to.suns_mut().extend_from_slice(from.suns());
    to.set_inflow(None)?;
    for y in 0..size[1] {
        for x in 0..size[0] {
            let block = Block::of(from, factor, [x, y]);
            to.set(x, y, block.matter(factor));
        }
    }
    if from.masks().is_some() || to.masks().is_some() {
        unite_masks(from, factor, size, to.masks_mut());
    }
    match from.color() {
        Some(color) => shrink(color, from.width(), factor, size, to.color_mut()),
        None => to.clear_color(),
    }
    match from.normals() {
        Some(normals) => {
            shrink(normals, from.width(), factor, size, to.normals_mut());
            to.normals_mut().iter_mut().for_each(|normal| *normal = unit(*normal));
        }
        None => to.clear_normals(),
    }
    Ok(())
}

/// Returns the light of downsampled cells at each of the original cells (a joint bilateral
/// upsampling, Kopf et al. 2007): interpolated in open space, never across walls; on walls with the
/// emission of the original cell in place of the larger one's.
///
/// # Errors
/// Fails if the light is not that of the larger cells.
pub fn upsample(light: &Light, larger: &Cells, cells: &Cells) -> Result<Light> {
    if [light.width(), light.height()] != [larger.width(), larger.height()] {
        let found = format!("{}×{}", light.width(), light.height());
        let expected = format!("of the larger cells' size, {}×{}", larger.width(), larger.height());
        return Err(Error::value("light", found, expected));
    }
    // A short side leaves several factors possible, up to that of the longer one.
    let ratio = |of: fn(&Cells) -> u32| of(cells).div_ceil(of(larger));
    let factor = ratio(Cells::width).max(ratio(Cells::height));
    let source = |i: usize| {
        let [x, y] = [i as u32 % cells.width(), i as u32 / cells.width()];
        let home = (y / factor).min(larger.height() - 1) * larger.width()
            + (x / factor).min(larger.width() - 1);
        let home = home as usize;
        let place = [x, y].map(|v| (v as f32 + 0.5) / factor as f32);
        if cells.is_solid(i) {
            return SampleRegion::Cell(home);
        }
        if !larger.is_solid(home) {
            return SampleRegion::Point(place);
        }
        // Beside a wall that grew: the mean of the open cells around, or else the wall's irradiance.
        let [min, max] = [-1.0, 1.0].map(|by| place.map(|v| v + by));
        if light.over(min, max) == [0.0; 3] {
            SampleRegion::Cell(home)
        } else {
            SampleRegion::Box(min, max)
        }
    };
    let at = |i: usize| {
        let source = source(i);
        let found = source.of(light);
        let SampleRegion::Cell(home) = source else { return found };
        let given = if larger.is_solid(home) { larger.emission()[home] } else { [0.0; 3] };
        let own = if cells.is_solid(i) { cells.emission()[i] } else { [0.0; 3] };
        std::array::from_fn(|c| (found[c] - given[c]).max(0.0) + own[c])
    };
    let spread = Light::from_pixels(cells, (0..cells.len()).map(at).collect())?;
    let Some([x, y]) = light.components() else { return Ok(spread) };
    let moment = (0..cells.len()).map(|i| [source(i).of(&x), source(i).of(&y)]);
    spread.with_moment(moment.collect(), light.elevation())
}

/// The part of a larger light that a cell takes its value from.
enum SampleRegion {
    /// A cell, by its index.
    Cell(usize),
    /// A point, with interpolation in open space.
    Point([f32; 2]),
    /// The open cells of a box.
    Box([f32; 2], [f32; 2]),
}

impl SampleRegion {
    fn of(&self, light: &Light) -> Rgb {
        match *self {
            Self::Cell(index) => light.pixels()[index],
            Self::Point(place) => light.sample(place),
            Self::Box(min, max) => light.over(min, max),
        }
    }
}

/// Computes the means over all blocks, row by row.
fn shrink(values: &[Rgb], width: u32, factor: u32, [columns, _]: [u32; 2], to: &mut [Rgb]) {
    let (width, factor) = (width as usize, factor as usize);
    to.fill([0.0; 3]);
    for (rows, to) in values.chunks(factor * width).zip(to.chunks_exact_mut(columns as usize)) {
        for row in rows.chunks_exact(width) {
            for (values, to) in row.chunks(factor).zip(&mut *to) {
                let weight = 1.0 / (values.len() * (rows.len() / width)) as f32;
                for value in values {
                    (0..3).for_each(|c| to[c] += weight * value[c]);
                }
            }
        }
    }
}

/// Puts each larger cell into all layers of the cells that become it.
fn unite_masks(from: &Cells, factor: u32, [columns, _]: [u32; 2], to: &mut [u8]) {
    for (i, to) in (0..).zip(to) {
        let block = Block::of(from, factor, [i % columns, i / columns]);
        *to =
            from.masks().map_or(ALL_LAYERS, |masks| block.cells().fold(0, |all, i| all | masks[i]));
    }
}

/// Returns a lamp in larger cells, its lengths clamped to what a lamp may have.
fn shrunk(lamp: Lamp, factor: u32) -> Lamp {
    let f = factor as f32;
    Lamp {
        position: lamp.position.map(|v| v / f),
        range: (lamp.range / f).max(1.0),
        size: (lamp.size / f).max(0.05),
        height: lamp.height.map(|height| (height / f).max(0.05)),
        cookie: lamp.cookie.map(|cookie| Cookie { size: (cookie.size / f).max(0.1), ..cookie }),
        ..lamp
    }
}

/// The cells that become one.
struct Block<'a> {
    from: &'a Cells,
    x: [usize; 2],
    y: [usize; 2],
}

impl<'a> Block<'a> {
    /// The block of a larger cell, cut off at the edges of the grid.
    fn of(from: &'a Cells, factor: u32, [x, y]: [u32; 2]) -> Self {
        let span = |at: u32, side: u32| {
            [at * factor, ((at + 1) * factor).min(side)].map(|edge| edge as usize)
        };
        Self { from, x: span(x, from.width()), y: span(y, from.height()) }
    }

    fn cells(&self) -> impl Iterator<Item = usize> {
        let width = self.from.width() as usize;
        let [left, right] = self.x;
        (self.y[0]..self.y[1]).flat_map(move |y| (left..right).map(move |x| y * width + x))
    }

    /// Returns whether the block is empty. Row by row, because most blocks need no other test.
    fn is_clear(&self) -> bool {
        let (width, [left, right]) = (self.from.width() as usize, self.x);
        (self.y[0]..self.y[1]).all(|y| {
            let row = y * width + left..y * width + right;
            self.from.opacity()[row.clone()].iter().all(|&opacity| opacity == 0.0)
                && self.from.tint()[row.clone()].iter().all(|&tint| tint == [1.0; 3])
                && self
                    .from
                    .glow()
                    .is_none_or(|glow| glow[row].iter().all(|&glow| glow == [0.0; 3]))
        })
    }

    /// The longer side of the bounding box of some of the cells.
    fn extent(&self, cells: impl Iterator<Item = usize>) -> usize {
        let width = self.from.width() as usize;
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for at in cells.map(|i| [i % width, i / width]) {
            for a in 0..2 {
                (low[a], high[a]) = (low[a].min(at[a]), high[a].max(at[a] + 1));
            }
        }
        (0..2).map(|a| high[a].saturating_sub(low[a])).max().unwrap_or(0)
    }

    fn matter(&self, factor: u32) -> Matter {
        let from = self.from;
        if self.is_clear() {
            return Matter::EMPTY;
        }
        let walls = || self.cells().filter(|&i| from.is_solid(i));
        let count = walls().count();
        let glows = walls().any(|i| from.emission()[i] != [0.0; 3]);
        if glows || 2 * count >= factor as usize {
            let fraction = self.extent(walls()) as f32 / self.extent(self.cells()) as f32;
            let over = |values: &[Rgb]| mean(walls().map(|i| (values[i], 1.0)));
            let emission = over(from.emission()).map(|v| v * fraction);
            let albedo = over(from.albedo());
            return Matter { opacity: 1.0, emission, albedo, ..Matter::EMPTY };
        }
        // The mean optical depth of a path through the block, `factor` px long. Walls too few to shut
        // the block are ignored.
        let open = || self.cells().filter(|&i| !from.is_solid(i));
        let deep = factor as f32 / self.cells().count() as f32;
        let (mut depth, mut glow) = ([0.0f32; 3], [0.0f32; 3]);
        for i in open().filter(|&i| !is_clear(from, i)) {
            let cell = from.matter(i);
            let of_cell = extinction(cell.opacity, cell.tint);
            (0..3).for_each(|c| depth[c] += deep * of_cell[c]);
            (0..3).for_each(|c| glow[c] += deep * cell.glow[c]);
        }
        let through = depth.map(|depth| (-depth).exp());
        let most = through.into_iter().fold(0.0, f32::max);
        // Rounding must not make a wall of it.
        let opacity = (1.0 - most).clamp(0.0, 0.999_999);
        let tint = through.map(|t| if most > 0.0 { (t / most).clamp(0.0, 1.0) } else { 1.0 });
        let stops =
            |i: usize| 1.0 - (1.0 - from.opacity()[i]) * from.tint()[i].iter().sum::<f32>() / 3.0;
        let by_fog = |values: &[Rgb]| mean(open().map(|i| (values[i], stops(i))));
        let (emission, albedo) = (by_fog(from.emission()), by_fog(from.albedo()));
        Matter { emission, glow, opacity, tint, albedo }
    }
}

/// Returns whether a cell has no effect on light.
fn is_clear(cells: &Cells, i: usize) -> bool {
    let matter = cells.matter(i);
    matter.opacity == 0.0 && matter.tint == [1.0; 3] && matter.glow == [0.0; 3]
}

/// The weighted mean of values; black if all weights are 0.
fn mean(values: impl Iterator<Item = (Rgb, f32)>) -> Rgb {
    let (mut sum, mut weight) = ([0.0; 3], 0.0);
    for (value, w) in values {
        (0..3).for_each(|c| sum[c] += w * value[c]);
        weight += w;
    }
    if weight > 0.0 { sum.map(|v| v / weight) } else { [0.0; 3] }
}
