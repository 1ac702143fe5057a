//! Visibility from viewers, as `lamplight::SightSolver` finds it.
//!
//! One dispatch finds the visibility of every cell, without a shadow map: a cell goes through the blocks of cells in the
//! triangle between itself and each eye in whose range it is. Cost: about `d/4 · (1 + s/4)` words of classes per cell and
//! viewer at distance d and of size s, and rays through media where there are some.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::gpu_struct::gpu_struct;
use crate::lamps::cone_of;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::stages::class::ClassPipeline;
use crate::{programs, shaders};
use lamplight::internals::MAX_OPTICAL_DEPTH;
use wgpu::{Buffer, Queue};

/// Bytes before the viewers: their number.
const HEAD: u64 = size_of::<[u32; 4]>() as u64;

gpu_struct! {
    /// `Sight` of shaders/stages/sight.wgsl, where the fields are explained.
    pub struct Sight {
        position: [f32; 2],
        range: f32,
        soft: f32,
        cone: [f32; 3],
        size: f32,
    }
}

/// The viewers of a frame before they are written to the GPU.
#[derive(Debug, Default)]
pub struct SightList(Vec<Sight>);

impl SightList {
    /// Replaces the viewers.
    ///
    /// # Errors
    /// If one of them is invalid. Those before then stay.
    pub fn set(&mut self, sights: &[lamplight::Sight]) -> lamplight::Result<()> {
        for (i, sight) in sights.iter().enumerate() {
            sight.check(&format_args!("sight[{i}]"))?;
        }
        self.0.clear();
        self.0.extend(sights.iter().map(|sight| Sight {
            position: sight.position,
            range: sight.range,
            soft: sight.fade * sight.range,
            cone: cone_of(sight.cone),
            size: sight.size,
        }));
        Ok(())
    }

    /// Returns whether there are no viewers.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Writes the viewers to the buffer of a plan.
    pub fn write(&self, queue: &Queue, pass: &SightPass) {
        let head = [self.0.len() as u32, 0, 0, 0];
        queue.write_buffer(&pass.sights, 0, bytemuck::bytes_of(&head));
        queue.write_buffer(&pass.sights, HEAD, bytemuck::cast_slice(&self.0));
    }

    fn bytes(&self) -> u64 {
        HEAD + size_of_val(self.0.as_slice()) as u64
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct SightPipelines {
    class: ClassPipeline,
    see: ComputePipelines,
}

/// The plan of the stage.
#[derive(Debug)]
pub struct SightPass {
    pub dispatches: [Dispatch; 2],
    /// The visibility of each cell.
    pub visibility: Buffer,
    /// Bytes of its buffers.
    pub memory: u64,
    sights: Buffer,
}

impl SightPass {
    /// Returns whether there is room for viewers.
    pub fn holds(&self, list: &SightList) -> bool {
        self.sights.size() >= list.bytes()
    }
}

impl SightPipelines {
    pub fn new(compiler: &Compiler) -> Self {
        let medium = ("MAX_OPTICAL_DEPTH", f64::from(MAX_OPTICAL_DEPTH));
        let mut constants = vec![("TRANSLUCENT", 1.0), medium];
        constants.extend(shaders::LUMINANCE);
        Self {
            class: ClassPipeline::new(compiler),
            see: compiler.program(&programs::SIGHT, &constants),
        }
    }

    /// Plans finding the visibility from viewers. The result stays in the buffer of a plan `before` of the same size.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        list: &SightList,
        before: Option<&SightPass>,
    ) -> Result<SightPass> {
        let class = self.class.plan(planner)?;
        let visibility = match before {
            Some(before) => planner.counted(before.visibility.clone()),
            None => planner.buffer::<f32>("sight", planner.cells())?,
        };
        // Room for more, so that viewers who join one by one do not have buffers made one by one.
        let room = before.map_or(0, |before| before.sights.size() / 2 * 3);
        let room = room.min(planner.max_buffer_bytes()).max(list.bytes());
        let sights = planner.buffer_of_bytes("sights", room)?;
        let resources = [
            whole(&sights),
            view(&planner.textures.tint_opacity),
            whole(&class.classes),
            whole(&visibility),
        ];
        let bound = planner.bind(&self.see, &resources);
        let see = planner.over_cells(&self.see, 0, &bound, None);
        let dispatches = [class.dispatch, see];
        Ok(SightPass { dispatches, visibility, memory: planner.memory(), sights })
    }
}
