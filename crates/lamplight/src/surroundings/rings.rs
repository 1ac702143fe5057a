//! Matter around a grid, drawn coarser the farther away it is.

use crate::inflow::{check_columns, place_on_side};
use crate::lamp_discs::LEAST_RADIUS;
use crate::limits::MAX_SIDE;
use crate::math::transmittance::{OPAQUE_TRANSMITTANCE, attenuation, extinction};
use crate::stages::glow::medium;
use crate::sun_glow::SunGlow;
use crate::{
    BorderPlace, Cells, Error, Inflow, Lamp, Method, Panorama, Result, Rgb, Sky, Sun, lamp_inflow,
};
use rayon::prelude::*;
use std::f64::consts::{GOLDEN_RATIO, TAU};

/// px of the border between places that light is traced from: fewer are sharper near the border, and take time.
const SPACING: u32 = 8;
/// Cells a side of the blocks that rays skip.
const BLOCK: i32 = 8;
/// Lamps that are seen one by one, the brightest: so many bound the time they take.
const MOST_LAMPS: usize = 64;
/// The farthest origin of a grid: the places of all rings are numbers too.
const FARTHEST_ORIGIN: u32 = 1 << 30;

/// The surroundings of a grid whose matter is known all around and changes: rings, each twice as wide as the one before
/// and drawn half as fine.
///
/// Whenever something has changed, the host draws the matter of each [`window`](Self::window) with cells as large as it
/// says, and gives them ([`set`](Self::set)). Then [`inflow`](Self::inflow) is the light of sky and matter at the border of
/// the grid, and [`with_lamps`](Self::with_lamps) adds lamps, which are seen as the discs that they are, in the shadow of
/// that matter. Lamps that glide over the border should be [parted](super::part_lamp) there.
///
/// Cost: each ring has a quarter as many cells as the grid. Some hundred rays from every eighth cell of the border cross
/// all rings, and some from the lamps. It is bounded, whatever there is around the grid.
///
/// Known failures: what is thinner than a cell of its ring may be missed, if the host does not draw it wider. Light that
/// surroundings reflect or scatter is not found. Of more than 64 lamps the faintest fade.
#[derive(Debug)]
pub struct RingSurroundings {
    size: [u32; 2],
    origin: [i32; 2],
    rings: Vec<Ring>,
}

/// The cells of a ring; those in the middle belong to rings nearer by, or to the grid itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RingWindow {
    /// The place of the first cell's corner, px of the grid.
    pub first: [i32; 2],
    /// The side of a cell, px of the grid.
    pub cell: u32,
    /// Columns and rows.
    pub size: [u32; 2],
}

/// The matter of a ring.
#[derive(Debug, Default)]
struct Ring {
    window: RingWindow,
    kinds: Vec<MatterKind>,
    /// True for blocks of cells with matter in them; rays skip the others.
    occupied: Vec<bool>,
    /// The radiance that solid cells send, or the source function of media.
    sources: Vec<Rgb>,
    /// Extinction per px of the grid.
    extinctions: Vec<Rgb>,
}

/// Effect of a cell on rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MatterKind {
    Empty,
    Solid,
    Medium,
}

impl RingSurroundings {
    /// The default number of directions of inflow.
    pub const COLUMNS: usize = 256;
    /// The largest number of rings.
    pub const MOST_RINGS: usize = 4;

    /// Creates empty surroundings of a grid of so many cells, whose first one lies at `origin`, with this number of rings.
    /// Grids with other origins have the same cells in the same places of the world.
    ///
    /// # Errors
    /// Fails if the grid has no valid size or lies beyond 2³⁰ cells, or there are more than [`Self::MOST_RINGS`].
    pub fn new(size: [u32; 2], origin: [i32; 2], rings: usize) -> Result<Self> {
        let mut surroundings = Self { size, origin, rings: Vec::new() };
        surroundings.place(size, origin, rings)?;
        Ok(surroundings)
    }

    /// Becomes that of another grid, as by [`Self::new`], and uses the same memory. A ring that has the same cells of the
    /// world as before keeps its matter, the others are empty: as a grid glides, a ring stays for twice the side of its
    /// cells.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn place(&mut self, size: [u32; 2], origin: [i32; 2], rings: usize) -> Result<()> {
        if !size.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
            let [width, height] = size.map(u64::from);
            return Err(Error::Size { width, height });
        }
        if rings > Self::MOST_RINGS {
            let expected = format!("0 to {}", Self::MOST_RINGS);
            return Err(Error::value("rings", rings, expected));
        }
        if origin.iter().any(|v| v.unsigned_abs() > FARTHEST_ORIGIN) {
            let found = format!("{origin:?}");
            return Err(Error::value("origin", found, format!("within ±{FARTHEST_ORIGIN}")));
        }
        let before = std::mem::replace(&mut self.origin, origin);
        self.size = size;
        self.rings.resize_with(rings, Ring::default);
        for (number, ring) in (1..).zip(&mut self.rings) {
            let window = RingWindow::new(size, origin, number);
            let stays = window.in_world(origin) == ring.window.in_world(before);
            ring.window = window;
            if stays {
                continue;
            }
            let count = ring.window.size.map(|side| side as usize).iter().product();
            ring.kinds.resize(count, MatterKind::Empty);
            ring.sources.resize(count, [0.0; 3]);
            ring.extinctions.resize(count, [0.0; 3]);
            let blocks = ring.window.size.map(|side| side.div_ceil(BLOCK as u32) as usize);
            ring.occupied.resize(blocks.iter().product(), false);
            ring.clear();
        }
        Ok(())
    }

    /// Forgets all matter.
    pub fn clear(&mut self) {
        self.rings.iter_mut().for_each(Ring::clear);
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The number of rings.
    pub fn rings(&self) -> usize {
        self.rings.len()
    }

    /// The window of a ring, the innermost first.
    ///
    /// # Panics
    /// If there is no such ring.
    pub fn window(&self, ring: usize) -> RingWindow {
        self.rings[ring].window
    }

    /// Sets the matter of a ring. The cells should be drawn for their own size, with opacity, tint and glow per cell; their
    /// lamps are not read.
    ///
    /// # Errors
    /// Fails if they are not as many as those of the ring, or a value is not valid.
    ///
    /// # Panics
    /// If there is no such ring.
    pub fn set(&mut self, ring: usize, cells: &Cells) -> Result<()> {
        let ring = &mut self.rings[ring];
        let window = ring.window;
        let found = [cells.width(), cells.height()];
        if found != window.size {
            let [found, expected] = [found, window.size].map(|[w, h]| format!("{w}×{h} cells"));
            return Err(Error::value("cells", found, expected));
        }
        cells.check()?;
        ring.clear();
        let Ring { kinds, occupied, sources, extinctions, .. } = ring;
        let width = window.size[0] as usize;
        let per_px = 1.0 / window.cell as f32;
        let (opacity, tint, glow) = (cells.opacity(), cells.tint(), cells.glow());
        for i in 0..cells.len() {
            let glows = glow.is_some_and(|glow| glow[i] != [0.0; 3]);
            if opacity[i] == 0.0 && tint[i] == [1.0; 3] && !glows {
                continue;
            }
            let own = cells.matter(i);
            let matter = if glows { medium(own) } else { own };
            let [x, y] = [i % width, i / width].map(|v| v / BLOCK as usize);
            occupied[y * width.div_ceil(BLOCK as usize) + x] = true;
            kinds[i] = if matter.opacity == 1.0 { MatterKind::Solid } else { MatterKind::Medium };
            sources[i] = matter.emission;
            extinctions[i] = extinction(matter.opacity, matter.tint).map(|v| v * per_px);
        }
        Ok(())
    }

    /// Returns the light that enters the grid from the sky, with suns in it, and from the matter of all rings, in `columns`
    /// directions. Suns that are lit exactly ([`Sun::is_exact`]) are not part of it.
    ///
    /// # Errors
    /// As [`Inflow::new`].
    pub fn inflow(&self, sky: &Sky, suns: &[Sun], columns: usize) -> Result<Inflow> {
        check_columns(columns)?;
        let sky = SunGlow::default().draw(Method::Holographic, sky, suns);
        let width = TAU / columns as f64;
        let seen = (0..columns).map(|column| {
            let middle = Panorama::angle(columns, column);
            sky.mean(middle - 0.5 * width, middle + 0.5 * width)
        });
        let seen: Vec<Rgb> = seen.collect();
        let strips = [0, 1, 2, 3].map(|side| {
            let sources = sources(columns, place_on_side(self.size, side, 0.0).outward);
            let length = self.size[side % 2];
            let strips = (0..length.div_ceil(SPACING)).into_par_iter();
            strips.map(|number| self.strip(side, number, &seen, &sources)).collect()
        });
        Inflow::of_sparse_strips(self.size, columns, SPACING, &strips)
    }

    /// Returns the radiance that comes in at a place along a side, by column.
    fn strip(&self, side: usize, number: u32, sky: &[Rgb], sources: &[usize]) -> Vec<Rgb> {
        let columns = sky.len();
        let length = self.size[side % 2] as f32;
        let own = (0..columns).map(|column| {
            if sources[column] != column {
                return [0.0; 3];
            }
            // Multiples of the golden ratio, without the whole, are spread evenly over any number of them.
            let past = (GOLDEN_RATIO * column as f64).fract() as f32;
            let along = ((number as f32 + past) * SPACING as f32).min(length);
            let place = place_on_side(self.size, side, along);
            let (sin, cos) = Panorama::angle(columns, column).sin_cos();
            let [light, through] = self.trace(place, [cos as f32, sin as f32], f32::INFINITY, None);
            [0, 1, 2].map(|c| light[c] + through[c] * sky[column][c])
        });
        let mut strip: Vec<Rgb> = own.collect();
        for column in 0..columns {
            strip[column] = strip[sources[column]];
        }
        strip
    }

    /// Returns an inflow with the light of lamps beyond the border added, positions px of the grid. The 64 brightest are
    /// seen; beyond half of the outermost ring they fade. Lamps that are lit by a shadow map, which shine from
    /// beyond a grid, are left out. A lamp in matter shines out of the cell of the ring that it is in.
    ///
    /// # Errors
    /// As [`Inflow::new`].
    pub fn with_lamps(&self, inflow: &Inflow, lamps: &[Lamp]) -> Result<Inflow> {
        let mut seen: Vec<(f32, &Lamp)> = lamps
            .iter()
            .filter(|lamp| !lamp.is_exact() && !lamp.is_off())
            .map(|lamp| (self.brightness(lamp), lamp))
            .filter(|(brightness, _)| *brightness > 0.0)
            .collect();
        seen.sort_by(|a, b| b.0.total_cmp(&a.0));
        let least = seen.get(MOST_LAMPS).map_or(0.0, |(brightness, _)| *brightness);
        let faded = seen.iter().take(MOST_LAMPS).map(|&(brightness, lamp)| {
            // A lamp that takes the place of another begins in the dark.
            let share = (2.0 - 2.0 * least / brightness).min(1.0) * self.fade(lamp.position);
            Lamp { intensity: lamp.intensity * share, ..lamp.clone() }
        });
        let faded: Vec<Lamp> = faded.collect();
        lamp_inflow::with_lamps(inflow, &faded, SPACING, |place, point| {
            let to = [0, 1].map(|a| point[a] as f32 - place.at[a]);
            let distance = to[0].hypot(to[1]);
            let way = to.map(|v| v / distance.max(1e-6));
            let [_, through] = self.trace(place, way, distance, Some(point.map(|v| v as f32)));
            through
        })
    }

    /// The light of a lamp at the border where that is nearest, about; 0 if it lights nothing there.
    fn brightness(&self, lamp: &Lamp) -> f32 {
        let radius = lamp.size.max(LEAST_RADIUS as f32);
        let beyond = [0, 1].map(|a| {
            let size = self.size[a] as f32;
            (-lamp.position[a]).max(lamp.position[a] - size)
        });
        if beyond.iter().all(|beyond| *beyond <= -radius) {
            return 0.0;
        }
        let [x, y] = beyond.map(|beyond| beyond.max(0.0));
        let radiance = lamp.radiance().into_iter().fold(0.0, f32::max);
        radiance * lamp.size / x.hypot(y).max(radius) * self.fade(lamp.position)
    }

    /// The share of a lamp's light, which fades in the outer half of the outermost ring.
    fn fade(&self, position: [f32; 2]) -> f32 {
        let Some(Ring { window, .. }) = self.rings.last() else { return 0.0 };
        let share = |a: usize| {
            let [first, side] = [window.first[a] as f32, (window.size[a] * window.cell) as f32];
            let within = (position[a] - first).min(first + side - position[a]);
            // The outermost ring takes a quarter of its window on each side.
            within / (side / 8.0)
        };
        share(0).min(share(1)).clamp(0.0, 1.0)
    }

    /// Returns the radiance that matter sends to a place on the border along a way, a unit vector, and the transmittance
    /// of the way over `reach` px, or up to the cell that holds the point `to`.
    fn trace(
        &self,
        place: BorderPlace,
        way: [f32; 2],
        reach: f32,
        to: Option<[f32; 2]>,
    ) -> [Rgb; 2] {
        let from = place.at;
        let ahead = way.map(|v| if v > 0.0 { 1 } else { -1 });
        let inverse = way.map(|v| 1.0 / v.abs().max(1e-9));
        let mut light = [0.0; 3];
        let mut through = [1.0; 3];
        // The axis that was crossed last, and where.
        let mut axis = 1 - place.side() % 2;
        let mut edge = from[axis] as i32;
        let mut t = 0.0;
        for ring in &self.rings {
            let RingWindow { first, cell: side, size } = ring.window;
            let size = size.map(|v| v as i32);
            let side_length = side as f32;
            let mut cell = [0, 1].map(|a| {
                let at = if a == axis {
                    (edge - first[a] - i32::from(ahead[a] < 0)).div_euclid(side as i32)
                } else {
                    ((from[a] + way[a] * t - first[a] as f32) / side_length).floor() as i32
                };
                at.clamp(0, size[a] - 1)
            });
            let mut next = [0, 1].map(|a| {
                let edge = first[a] + (cell[a] + i32::from(ahead[a] > 0)) * side as i32;
                (edge as f32 - from[a]) * ahead[a] as f32 * inverse[a]
            });
            let step = inverse.map(|v| v * side_length);
            let last = to
                .map(|to| [0, 1].map(|a| ((to[a] - first[a] as f32) / side_length).floor() as i32));
            let blocks = (size[0] + BLOCK - 1) / BLOCK;
            let mut crosses;
            loop {
                if last == Some(cell) {
                    return [light, through];
                }
                let block = cell.map(|v| v / BLOCK);
                if !ring.occupied[(block[1] * blocks + block[0]) as usize] {
                    // To its edge, or that of the ring.
                    let rest = [0, 1].map(|a| {
                        let past = cell[a] % BLOCK;
                        if ahead[a] > 0 {
                            (BLOCK - 1 - past).min(size[a] - 1 - cell[a])
                        } else {
                            past
                        }
                    });
                    let exit = [0, 1].map(|a| next[a] + rest[a] as f32 * step[a]);
                    crosses = usize::from(exit[1] < exit[0]);
                    t = exit[crosses];
                    let other = 1 - crosses;
                    let crossed = ((t - next[other]) / step[other] + 1.0).max(0.0) as i32;
                    let crossed = crossed.min(rest[other]);
                    cell[other] += ahead[other] * crossed;
                    next[other] += step[other] * crossed as f32;
                    cell[crosses] += ahead[crosses] * rest[crosses];
                    next[crosses] = t;
                } else {
                    crosses = usize::from(next[1] < next[0]);
                    let at = (cell[1] * size[0] + cell[0]) as usize;
                    match ring.kinds[at] {
                        MatterKind::Empty => {}
                        MatterKind::Solid => {
                            let source = ring.sources[at];
                            return [
                                [0, 1, 2].map(|c| light[c] + through[c] * source[c]),
                                [0.0; 3],
                            ];
                        }
                        MatterKind::Medium => {
                            let length = (next[crosses].min(reach) - t).max(0.0);
                            for c in 0..3 {
                                let (passed, stopped) =
                                    attenuation(ring.extinctions[at][c] * length);
                                light[c] += through[c] * stopped * ring.sources[at][c];
                                through[c] *= passed;
                            }
                            if through.iter().all(|v| *v < OPAQUE_TRANSMITTANCE) {
                                return [light, [0.0; 3]];
                            }
                        }
                    }
                    t = next[crosses];
                }
                if t >= reach {
                    return [light, through];
                }
                cell[crosses] += ahead[crosses];
                next[crosses] += step[crosses];
                if !(0..size[crosses]).contains(&cell[crosses]) {
                    axis = crosses;
                    edge = first[axis] + (cell[axis] + i32::from(ahead[axis] < 0)) * side as i32;
                    break;
                }
            }
        }
        [light, through]
    }
}

/// Returns for each column the one whose light it has: its own if its middle leads outward, otherwise the nearest such
/// column, whose light grazes the border.
fn sources(columns: usize, outward: [f32; 2]) -> Vec<usize> {
    let [x, y] = outward.map(f64::from);
    let leads_out = (0..columns).map(|column| {
        let (sin, cos) = Panorama::angle(columns, column).sin_cos();
        cos * x + sin * y > 0.0
    });
    let leads_out: Vec<bool> = leads_out.collect();
    let nearest = |column: usize| {
        let mut near =
            (0..columns).flat_map(|d| [(column + d) % columns, (column + columns - d) % columns]);
        near.find(|&other| leads_out[other]).unwrap_or(column)
    };
    (0..columns).map(nearest).collect()
}

impl Ring {
    /// Forgets all matter.
    fn clear(&mut self) {
        self.kinds.fill(MatterKind::Empty);
        self.occupied.fill(false);
    }
}

impl RingWindow {
    /// Returns it with its place in a world whose cells are those of a grid at `origin`.
    fn in_world(self, origin: [i32; 2]) -> Self {
        Self { first: [0, 1].map(|a| origin[a] + self.first[a]), ..self }
    }

    /// Returns that of a ring, numbered from 1, around a grid.
    fn new(size: [u32; 2], origin: [i32; 2], number: u32) -> Self {
        let cell = 2 << number;
        // Rings end where cells of the next one do. All places of the grid have as many cells, so that rings stay.
        let step = 2 * cell as i32;
        let margin = size.map(|side| ((side as i32) << (number - 1)) - side as i32 / 2);
        let low = [0, 1].map(|a| (origin[a] - margin[a]).div_euclid(step) * step);
        let steps = [0, 1].map(|a| (size[a] + 2 * margin[a] as u32).div_ceil(step as u32) + 1);
        Self { first: [0, 1].map(|a| low[a] - origin[a]), cell, size: steps.map(|steps| 2 * steps) }
    }
}
