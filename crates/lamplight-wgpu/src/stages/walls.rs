//! The light that solid cells show.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{BoundResources, ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::traffic::Traffic;
use crate::{programs, shaders};
use lamplight::Settings;
use lamplight::internals::walls::{ALONG, KERNEL, OCTAVE, SOFTENING, STRAIGHT, octaves};
use wgpu::Buffer;

/// The pipelines.
#[derive(Debug)]
pub struct Walls(ComputePipelines);

/// The pipelines for the components of the first moment.
#[derive(Debug)]
pub struct MomentWalls([Walls; 2]);

impl MomentWalls {
    pub fn new(compiler: &Compiler) -> Self {
        Self([1, 2].map(|component| Walls::of(compiler, component)))
    }

    /// Plans the first moment of solid cells from that before their faces, and from their light before that has
    /// sunk in.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<Vec<Dispatch>> {
        let Self([x, y]) = self;
        let bound = x.bind(planner, light)?;
        let turn = Dispatch::over(planner.size.into(), x.0.entry(TURN_FACES), &bound, Some(0));
        let turn = turn.with_traffic(traffic(planner, TURN_FACES, 0));
        let x = x.sink(planner, &bound);
        Ok([turn].into_iter().chain(x).chain(y.plan(planner, light)?).collect())
    }
}

impl Walls {
    pub fn new(compiler: &Compiler) -> Self {
        Self::of(compiler, 0)
    }

    /// The pipelines for light, or for a component of its first moment.
    fn of(compiler: &Compiler, component: u32) -> Self {
        let constants = [
            ("OCTAVE", f64::from(OCTAVE)),
            ("STRAIGHT", f64::from(STRAIGHT)),
            ("SOFTENING", f64::from(SOFTENING)),
            ("KERNEL_0", f64::from(KERNEL[0])),
            ("KERNEL_1", f64::from(KERNEL[1])),
            ("KERNEL_2", f64::from(KERNEL[2])),
            ("ALONG_0", f64::from(ALONG[0])),
            ("ALONG_1", f64::from(ALONG[1])),
            ("ALONG_2", f64::from(ALONG[2])),
            ("COMPONENT", f64::from(component)),
            ("MAX_WALL_DEPTH", f64::from(Settings::MAX_WALL_DEPTH)),
            ("CELLS_PER_WORD", CELLS_PER_WORD.into()),
        ];
        let constants = [&constants[..], &shaders::LUMINANCE].concat();
        Self(compiler.program(&programs::WALLS, &constants))
    }

    /// Plans the light of solid cells from that of their faces: a dispatch for every two octaves, in which they are
    /// blurred, and one in which their sum sinks in, and the last octave if it has no other.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<Vec<Dispatch>> {
        Ok(self.sink(planner, &self.bind(planner, light)?))
    }

    /// Binds the light, and buffers for what sinks in. Where nothing does, they are bound, but not used.
    fn bind(&self, planner: &FramePlanner, light: &Buffer) -> Result<BoundResources> {
        let octaves = octaves(planner.settings.wall_depth);
        let level_cells = |level: u32| product(level_size(planner, level));
        let [cells, words] =
            if octaves == 0 { [1; 2] } else { [planner.cells(), product(flag_words(planner))] };
        let sums = (1..=octaves / 2 * 2).map(level_cells).sum::<u64>().max(1);
        let surface = planner.buffer::<[f32; 4]>("walls: surface", cells)?;
        let irradiance = planner.buffer::<[f32; 4]>("walls: irradiance", sums)?;
        let emission = planner.buffer::<[f32; 4]>("walls: emission", sums)?;
        let flags = planner.buffer::<u32>("walls: flags", words)?;
        let resources = [
            view(&planner.textures.tint_opacity),
            planner.shared.step(),
            view(&planner.textures.emission),
            whole(&surface),
            whole(&irradiance),
            whole(&emission),
            whole(light),
            whole(&flags),
        ];
        Ok(planner.bind(&self.0, &resources))
    }

    /// The dispatches by which light sinks in.
    fn sink(&self, planner: &FramePlanner, bound: &BoundResources) -> Vec<Dispatch> {
        let octaves = octaves(planner.settings.wall_depth);
        if octaves == 0 {
            let show = self.0.entry(SHOW_FACES);
            let show = Dispatch::over(planner.size.into(), show, bound, Some(0));
            return vec![show.with_traffic(traffic(planner, SHOW_FACES, 0))];
        }
        // A dispatch over the tiles of a level. `step` is what the shader is told.
        let tiled = |entry: usize, step: u32, level: u32, tile: u32| {
            let [columns, rows] = level_size(planner, level).map(|side| side.div_ceil(tile));
            Dispatch::new(self.0.entry(entry), bound, Some(step), [columns, rows, 1])
                .with_traffic(traffic(planner, entry, step))
        };
        let blur = |level: u32| {
            let entry = if level == 1 { BLUR_SURFACE } else { BLUR };
            tiled(entry, level, level + 1, TILE)
        };
        (1..octaves).step_by(2).map(blur).chain([tiled(SINK, 0, 0, SUNK)]).collect()
    }
}

/// The traffic of a dispatch over a level: of all cells, without what only solid ones have.
fn traffic(planner: &FramePlanner, entry: usize, level: u32) -> Traffic {
    const VEC4: u64 = size_of::<[f32; 4]>() as u64;
    let cells = planner.cells() * VEC4;
    let flags = product(flag_words(planner)) * size_of::<u32>() as u64;
    // Irradiance and emission.
    let sums = |level| 2 * VEC4 * product(level_size(planner, level));
    match entry {
        BLUR_SURFACE => Traffic { read: cells, written: flags + sums(level) + sums(level + 1) },
        BLUR => Traffic { read: sums(level - 1), written: sums(level) + sums(level + 1) },
        SINK => Traffic { read: flags, written: 0 },
        _ => Traffic { read: cells, written: 0 },
    }
}

/// Words of flags in a row of cells, and rows.
fn flag_words(planner: &FramePlanner) -> [u32; 2] {
    let [width, height] = <[u32; 2]>::from(planner.size);
    [width.div_ceil(CELLS_PER_WORD), height]
}

/// The number of cells, or words, of a rectangle.
fn product(sides: [u32; 2]) -> u64 {
    sides.map(u64::from).iter().product()
}

/// Columns and rows of a level of the pyramid; the cells are level 0.
fn level_size(planner: &FramePlanner, level: u32) -> [u32; 2] {
    <[u32; 2]>::from(planner.size).map(|side| side.div_ceil(1 << level))
}

/// Cells of a row whose flags share a word.
const CELLS_PER_WORD: u32 = 4;

/// `TILE` of shaders/stages/walls.wgsl: cells along an axis of the coarser level that a workgroup makes.
const TILE: u32 = 6;
/// `SUNK` there: cells along an axis of a workgroup in which light sinks in.
const SUNK: u32 = 16;

/// Entries of [`programs::WALLS`].
const SHOW_FACES: usize = 0;
const BLUR_SURFACE: usize = 1;
const BLUR: usize = 2;
const SINK: usize = 3;
const TURN_FACES: usize = 4;
