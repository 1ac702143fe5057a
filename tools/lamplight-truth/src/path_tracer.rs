//! The reference: brute-force path tracing through the cells, straight from the definitions.

use crate::lamps::{Vertex, direct};
use crate::random::Random;
use crate::sky;
use crate::traverse::{Event, Grid, Stretch, Traversal};
use lamplight::internals::direct::clamp;
use lamplight::{ALL_LAYERS, Bounces, Cells, Error, Lamp, Light, Result, Rgb, Sun};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The number of independent estimates of every cell, whose spread gives its standard error.
pub(crate) const BATCHES: u32 = 16;
/// The transmittance below which a medium ends a ray, far below f32's resolution.
const OPAQUE: f64 = 1e-10;
/// The number of bounces after which Russian roulette may end a path.
const ROULETTE_AFTER: u32 = 3;
/// The steps of a sequence that fills a cube evenly with any number of points: g⁻¹, g⁻², g⁻³ with
/// g⁴ = g + 1 (the R₃ sequence of Roberts 2018). First directions are even already; it
/// spreads the next three.
const SPREAD: [f64; 3] =
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];

/// 1/φ, which spreads points across lamps evenly over the paths of a batch.
const ACROSS: f64 = 0.618_033_988_749_894_8;

/// An unbiased path tracer: no distance field, no interpolation, no filter, and no light sampling but for lamps that
/// are not drawn, which no path would meet.
///
/// - **Open cell**: the mean radiance arriving at its centre over all directions, J.
/// - **Solid cell** with a face towards an open cell: the mean of the normalised irradiance
///   `E/2 = ½∫ L cosθ dθ` over those faces and their length. Faces on the grid's border touch no cell and do not count.
///   [`PathTracer::render`] then lets the light sink into solid cells.
/// - A path that crosses `s` px of a cell with opacity α < 1 gains `(1 − T)·L_e + ∫ j·T(t) dt`,
///   `T(s) = ((1 − α)·tint)^s`; it then either continues, or is scattered from the cell's *centre* into
///   a random direction. The choice is random, with weights that keep every channel unbiased.
/// - A path that reaches a wall gains its `L_e` and is reflected at the point it hit,
///   cosine-distributed.
/// - The light of a cell is never below 0, however much lamps of negative intensity take away. On the way a path does not
///   know the sum of light: where such lamps take more than a surface receives, it reflects less than nothing.
/// - Two solid cells that touch by a corner are opaque there; past a single solid corner a ray grazes.
///
/// In each of 16 independent batches first directions are evenly spaced from a random start, and the
/// directions of the next bounces are evenly spread over them. Random numbers depend only on the seed,
/// the cell and the path: the same seed gives the same bytes on any number of threads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTracer {
    /// The number of paths per cell, rounded up to a multiple of 16. The error falls as about
    /// 1/√samples with bounces, faster for direct light; the time is proportional to it.
    pub samples: u32,
    /// The number of bounces. `Converged` and `Feedback` have no limit except [`Bounces::MAX`].
    pub bounces: Bounces,
    /// The depth to which light sinks into solid cells, px ([`PathTracer::render`] only).
    pub wall_depth: f32,
    /// The elevation above the plane of light that has none of its own, radians. It weighs the first moment of the light
    /// of lamps with a height and of suns with an elevation, as [`lamplight::Light::moment`] defines, and nothing else.
    pub elevation: f32,
    /// The seed for all random numbers.
    pub seed: u64,
}

/// Light with its standard error.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The light of every cell, with its first moment.
    pub light: Light,
    /// The standard error of every cell and channel, from 16 independent batches. In solid cells that
    /// of the irradiance of their faces, 0 if no face is exposed.
    pub standard_error: Vec<Rgb>,
}

impl PathTracer {
    /// Computes the light of every cell. `progress` is called with the finished fraction, 0 to 1, from
    /// any thread and not always in order.
    ///
    /// # Errors
    /// Returns an error if the cells are invalid ([`Cells::check`]) or `samples` is 0.
    pub fn render(&self, cells: &Cells, progress: &(dyn Fn(f32) + Sync)) -> Result<Estimate> {
        let tracing = self.prepare(cells)?;
        tracing.finish(tracing.trace(0..cells.len(), progress))
    }

    /// Computes the mean and the standard error of a few cells, `[x, y]`. In solid cells it is the
    /// irradiance of the exposed faces, without emission; 0 if there are none.
    ///
    /// # Errors
    /// Like [`PathTracer::render`], and if a cell is outside the grid.
    pub fn at(&self, cells: &Cells, at: &[[u32; 2]]) -> Result<Vec<(Rgb, Rgb)>> {
        self.receive(cells, at, |_| 1.0)
    }

    fn receive(
        &self,
        cells: &Cells,
        at: &[[u32; 2]],
        response: impl Fn([f64; 2]) -> f64 + Sync,
    ) -> Result<Vec<(Rgb, Rgb)>> {
        self.check(cells)?;
        let (width, height) = (cells.width(), cells.height());
        if let Some([x, y]) = at.iter().find(|[x, y]| *x >= width || *y >= height) {
            let inside = format!("a cell of the {width}×{height} grid");
            return Err(Error::value("at", format!("[{x}, {y}]"), inside));
        }
        let cells = cells.drawn();
        let grid = Grid::new(&cells);
        let tracer = Tracer::new(self, &cells, &grid);
        let receive = |at: &[u32; 2]| {
            let [(mut light, error)] = tracer.receive(at.map(|v| v as i32), |way| [response(way)]);
            clamp(std::slice::from_mut(&mut light), None, 1.0);
            (light, error)
        };
        Ok(at.par_iter().map(receive).collect())
    }

    /// Computes what a surface receives in a few cells, `[x, y]`, that is tilted out of the plane: the mean over all
    /// directions ω of `L·max(0, n·(ω cos ε, sin ε))/sin ε`, for its normal n, with z towards the viewer, and light that
    /// arrives at an elevation ε above the plane: its own, or that of all light. A surface that is not tilted receives J.
    ///
    /// # Errors
    /// Like [`PathTracer::at`].
    pub fn tilted(
        &self,
        cells: &Cells,
        at: &[[u32; 2]],
        normal: [f32; 3],
    ) -> Result<Vec<(Rgb, Rgb)>> {
        let [nx, ny, nz] = normal.map(f64::from);
        let cotangent = 1.0 / f64::from(self.elevation).tan();
        self.receive(cells, at, |[x, y]| (nz + cotangent * (nx * x + ny * y)).max(0.0))
    }

    pub(crate) fn check(&self, cells: &Cells) -> Result<()> {
        if self.samples == 0 {
            return Err(Error::value("samples", 0, "1 or more"));
        }
        cells.check()
    }
}

/// The data that all paths of a picture share.
pub(crate) struct Tracer<'c> {
    cells: &'c Cells,
    /// The lamps that are not drawn.
    lamps: &'c [Lamp],
    suns: &'c [Sun],
    /// The tangent of the elevation of all light.
    tangent: f64,
    grid: &'c Grid,
    limit: u32,
    batches: u32,
    /// The number of paths in a batch.
    paths: u32,
    seed: u64,
}

impl<'c> Tracer<'c> {
    pub fn new(settings: &PathTracer, cells: &'c Cells, grid: &'c Grid) -> Self {
        Self {
            cells,
            lamps: cells.lamps(),
            suns: cells.suns(),
            tangent: f64::from(settings.elevation).tan(),
            grid,
            limit: settings.bounces.limit(),
            batches: BATCHES,
            paths: settings.samples.div_ceil(BATCHES),
            seed: settings.seed,
        }
    }

    /// Merges all batches into one: evenly spread paths have less noise, but no standard error.
    pub fn in_one_batch(self) -> Self {
        Self { paths: self.paths * self.batches, batches: 1, ..self }
    }

    /// The mean and the standard error of the light of one cell, of which each of N sums takes a share that depends on
    /// the direction it arrives from: the `response`.
    pub fn receive<const N: usize>(
        &self,
        [x, y]: [i32; 2],
        response: impl Fn([f64; 2]) -> [f64; N],
    ) -> [(Rgb, Rgb); N] {
        let solid = self.grid.is_solid(x, y);
        let faces = if solid { self.exposed(x, y) } else { Vec::new() };
        if solid && faces.is_empty() {
            return [([0.0; 3], [0.0; 3]); N];
        }
        let id = u64::from(self.cells.width()) * y as u64 + x as u64;
        let (mut sum, mut squares) = ([[0.0; 3]; N], [[0.0; 3]; N]);
        let mut first = [[0.0; 3]; N];
        for batch in 0..self.batches {
            // Keys that no path has, for the random numbers of the batch itself.
            let mut shift = Random::new(self.seed, id, u64::MAX - u64::from(batch));
            let start = shift.unit();
            let shift = SPREAD.map(|_| shift.unit());
            let mut total = [[0.0; 3]; N];
            let mut add = |light: [f64; 3], from: [f64; 2]| {
                for (total, share) in total.iter_mut().zip(response(from)) {
                    (0..3).for_each(|c| total[c] += share * light[c]);
                }
            };
            for path in 0..self.paths {
                let key = u64::from(batch) * u64::from(self.paths) + u64::from(path);
                let mut sampler = Sampler {
                    spread: [0, 1, 2].map(|d| (f64::from(path) * SPREAD[d] + shift[d]).fract()),
                    spent: 0,
                    random: Random::new(self.seed, id, key),
                };
                let even = (f64::from(path) + start) / f64::from(self.paths);
                let vertex = if solid {
                    on_face(&faces, even, self.mask([x, y]))
                } else {
                    Vertex::centre([x, y], self.mask([x, y]))
                };
                let start = match vertex.normal {
                    Some(normal) => {
                        self.leave_wall(vertex.cell, vertex.point, normal, sampler.direction())
                    }
                    None => self.leave_centre([x, y], even),
                };
                let point = (f64::from(path) * ACROSS + shift[0]).fract();
                direct(self.lamps, self.suns, self.grid, &vertex, point, |light, to, own| {
                    let weight = own.map_or(1.0, |cotangent| cotangent * self.tangent);
                    add(light, to.map(|v| weight * v));
                });
                let from = start.direction();
                add(self.radiance(start, &mut sampler), from);
            }
            let mean = total.map(|sum| sum.map(|v| v / f64::from(self.paths)));
            if batch == 0 {
                first = mean;
            }
            for k in 0..N {
                for c in 0..3 {
                    // Shifted by the first batch, so that equal batches have an error of exactly 0.
                    let d = mean[k][c] - first[k][c];
                    sum[k][c] += d;
                    squares[k][c] += d * d;
                }
            }
        }
        let n = f64::from(self.batches);
        std::array::from_fn(|k| {
            let mean = std::array::from_fn(|c| (first[k][c] + sum[k][c] / n) as f32);
            let error = std::array::from_fn(|c| {
                let spread = (squares[k][c] - sum[k][c] * sum[k][c] / n).max(0.0);
                (spread / (n * (n - 1.0)).max(1.0)).sqrt() as f32
            });
            (mean, error)
        })
    }

    /// The faces of a solid cell that touch a cell that is not solid.
    fn exposed(&self, x: i32, y: i32) -> Vec<Face> {
        [[1, 0], [-1, 0], [0, 1], [0, -1]]
            .into_iter()
            .map(|normal| Face { cell: [x, y], normal })
            .filter(|face| {
                let [x, y] = face.outside();
                self.grid.is_open(x, y)
            })
            .collect()
    }

    /// A ray from the centre of a cell in the direction `turn` × 2π.
    #[inline]
    fn leave_centre(&self, cell: [i32; 2], turn: f64) -> Traversal<'_> {
        let (sin, cos) = (turn * TAU).sin_cos();
        Traversal::new(self.grid, cell, cell.map(|c| f64::from(c) + 0.5), [cos, sin])
    }

    /// A ray from a point of a wall, cosine-distributed: in 2D the sine of its angle is uniform.
    #[inline]
    fn leave_wall(
        &self,
        cell: [i32; 2],
        point: [f64; 2],
        normal: [f64; 2],
        u: f64,
    ) -> Traversal<'_> {
        let sin = 2.0 * u - 1.0;
        // Never 0, which would run along the wall.
        let cos = (1.0 - sin * sin).sqrt().max(1e-12);
        let [nx, ny] = normal;
        Traversal::new(self.grid, cell, point, [nx * cos - ny * sin, ny * cos + nx * sin])
    }

    /// The layers of a cell.
    fn mask(&self, [x, y]: [i32; 2]) -> u8 {
        let cell = self.cells.index(x as u32, y as u32);
        self.cells.masks().map_or(ALL_LAYERS, |masks| masks[cell])
    }

    /// The direct light of a random point of each lamp that is not drawn, and of each sun.
    fn direct(&self, at: &Vertex, random: &mut Random) -> [f64; 3] {
        // No random number is spent where there is none, so that other scenes keep theirs.
        if self.lamps.is_empty() && self.suns.is_empty() {
            [0.0; 3]
        } else {
            let mut light = [0.0; 3];
            direct(self.lamps, self.suns, self.grid, at, random.unit(), |direct, _, _| {
                (0..3).for_each(|c| light[c] += direct[c]);
            });
            light
        }
    }

    /// The radiance that arrives along one path.
    #[inline]
    fn radiance(&self, start: Traversal, sampler: &mut Sampler) -> [f64; 3] {
        let (emission, albedo) = (self.cells.emission(), self.cells.albedo());
        let glow = self.cells.glow();
        let mut walk = start;
        let mut light = [0.0; 3];
        let mut weight = [1.0; 3];
        let mut bounces = 0;
        loop {
            match walk.next() {
                Event::Sky => {
                    let sky = sky::entering(self.cells, walk.origin(), walk.direction());
                    (0..3).for_each(|c| light[c] += weight[c] * sky[c]);
                    return light;
                }
                Event::Wall { cell, point, normal, outside } => {
                    (0..3).for_each(|c| light[c] += weight[c] * f64::from(emission[cell][c]));
                    if bounces == self.limit || albedo[cell] == [0.0; 3] {
                        return light;
                    }
                    (0..3).for_each(|c| weight[c] *= f64::from(albedo[cell][c]));
                    bounces += 1;
                    if !russian_roulette(bounces, &mut weight, &mut sampler.random) {
                        return light;
                    }
                    let mask = self.cells.masks().map_or(ALL_LAYERS, |masks| masks[cell]);
                    let vertex = Vertex { cell: outside, point, normal: Some(normal), mask };
                    let direct = self.direct(&vertex, &mut sampler.random);
                    (0..3).for_each(|c| light[c] += weight[c] * direct[c]);
                    walk = self.leave_wall(outside, point, normal, sampler.direction());
                }
                Event::Medium(stretch) => {
                    let Stretch { cell, length, .. } = stretch;
                    if length == 0.0 {
                        continue;
                    }
                    let extinction = self.grid.extinction[stretch.extinction];
                    let absorbed = absorbed(extinction, length);
                    let glow = glow.map_or([0.0; 3], |glow| glow[cell].map(f64::from));
                    let mut go_on = [0.0; 3];
                    for c in 0..3 {
                        // The length over which the glow of the stretch reaches its near end.
                        let e = extinction[c];
                        let reaches = if e == 0.0 { length } else { absorbed[c] / e };
                        let emitted =
                            absorbed[c] * f64::from(emission[cell][c]) + reaches * glow[c];
                        light[c] += weight[c] * emitted;
                        go_on[c] = weight[c] * (1.0 - absorbed[c]);
                    }
                    if bounces < self.limit && albedo[cell] != [0.0; 3] {
                        let mut scatter = std::array::from_fn(|c| {
                            weight[c] * absorbed[c] * f64::from(albedo[cell][c])
                        });
                        let (a, b) = (scatter.iter().sum::<f64>(), go_on.iter().sum::<f64>());
                        let p = if a > 0.0 { a / (a + b) } else { 0.0 };
                        if sampler.random.unit() < p {
                            let px = if stretch.side > 1 {
                                scatter_at(extinction, absorbed, &mut scatter, &mut sampler.random)
                            } else {
                                0.0
                            };
                            weight = scatter.map(|w| w / p);
                            bounces += 1;
                            if !russian_roulette(bounces, &mut weight, &mut sampler.random) {
                                return light;
                            }
                            let at = walk.cell_after(&stretch, px);
                            let vertex = Vertex::centre(at, self.mask(at));
                            let direct = self.direct(&vertex, &mut sampler.random);
                            (0..3).for_each(|c| light[c] += weight[c] * direct[c]);
                            walk = self.leave_centre(at, sampler.direction());
                            continue;
                        }
                        go_on = go_on.map(|w| w / (1.0 - p));
                    }
                    weight = go_on;
                    if weight.iter().all(|&w| w < OPAQUE) {
                        return light;
                    }
                }
            }
        }
    }
}

/// The source of the random choices of a path.
struct Sampler {
    /// The first choices of direction, evenly spread over the paths of a batch.
    spread: [f64; 3],
    spent: usize,
    random: Random,
}

impl Sampler {
    /// The next choice of direction, uniform in [0, 1).
    #[inline]
    fn direction(&mut self) -> f64 {
        match self.spread.get(self.spent) {
            Some(&u) => {
                self.spent += 1;
                u
            }
            None => self.random.unit(),
        }
    }
}

/// A face of a solid cell.
struct Face {
    cell: [i32; 2],
    normal: [i32; 2],
}

impl Face {
    /// The cell in front of it.
    fn outside(&self) -> [i32; 2] {
        [0, 1].map(|a| self.cell[a] + self.normal[a])
    }
}

/// The point of one of the faces that `along` (0 to 1) picks.
fn on_face(faces: &[Face], along: f64, mask: u8) -> Vertex {
    let along = along * faces.len() as f64;
    let face = &faces[(along as usize).min(faces.len() - 1)];
    let normal = face.normal.map(f64::from);
    let centre = face.cell.map(|c| f64::from(c) + 0.5);
    let offset = along.fract() - 0.5;
    let point =
        [0, 1].map(|a| centre[a] + 0.5 * normal[a] + offset * f64::from(face.normal[1 - a].abs()));
    Vertex { cell: face.outside(), point, normal: Some(normal), mask }
}

/// 1 − T over a length, per channel.
#[inline]
fn absorbed(extinction: [f64; 3], length: f64) -> [f64; 3] {
    let of = |e: f64| -(-e * length).exp_m1();
    let [r, g, b] = extinction;
    if r == g && g == b { [of(r); 3] } else { [of(r), of(g), of(b)] }
}

/// Samples the distance into a stretch of cells at which light is scattered, px.
///
/// A channel is chosen in proportion to its scattered light, and a distance by its density
/// `σe^(−σs)/(1 − T)`. The scattered light of each channel is then weighted by its own density over that
/// of the mixture, whose mean is 1.
fn scatter_at(
    extinction: [f64; 3],
    absorbed: [f64; 3],
    scatter: &mut [f64; 3],
    random: &mut Random,
) -> f64 {
    let sum: f64 = scatter.iter().sum();
    let mut pick = random.unit() * sum;
    // The last channel that scatters, if rounding leaves a remainder.
    let mut channel = 0;
    for c in (0..3).filter(|&c| scatter[c] > 0.0) {
        channel = c;
        pick -= scatter[c];
        if pick < 0.0 {
            break;
        }
    }
    let px = -(-random.unit() * absorbed[channel]).ln_1p() / extinction[channel];
    let density: [f64; 3] = std::array::from_fn(|c| {
        let e = extinction[c];
        if scatter[c] > 0.0 { e * (-e * px).exp() / absorbed[c] } else { 0.0 }
    });
    let mixture: f64 = (0..3).map(|c| scatter[c] * density[c]).sum::<f64>() / sum;
    (0..3).for_each(|c| scatter[c] *= density[c] / mixture);
    px
}

/// Ends paths of little weight at random and adds their weight to those that continue.
#[inline]
fn russian_roulette(bounces: u32, weight: &mut [f64; 3], random: &mut Random) -> bool {
    let most = weight.iter().copied().fold(0.0, f64::max);
    if bounces < ROULETTE_AFTER || most >= 1.0 {
        return most > 0.0;
    }
    if random.unit() >= most {
        return false;
    }
    weight.iter_mut().for_each(|w| *w /= most);
    true
}
