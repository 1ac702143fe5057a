//! The distance field, with the seed map and the jump flood that it comes from.

use super::jump_flood::JumpFlood;
use super::seed::Seed;
use crate::compiler::Compiler;
use crate::error::Result;
use crate::pass_list::PassList;
use crate::pipeline::ComputePipelines;
use crate::planner::{FramePlanner, whole};
use crate::programs;
use crate::stage::Stage;
use lamplight::internals::seed::NONE;
use wgpu::Buffer;

/// The distance in a grid without matter, where the CPU has +∞: shaders may assume that infinity does not
/// occur.
const FAR: f32 = f32::MAX;

/// The pipelines.
#[derive(Debug)]
pub struct DistancePipelines {
    seed: Seed,
    jump_flood: JumpFlood,
    distance: ComputePipelines,
}

/// The result of the stage.
#[derive(Debug)]
pub struct DistanceField {
    pub nearest: Buffer,
    pub distance: Buffer,
    pub passes: PassList,
}

impl DistancePipelines {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [("NO_SEED", f64::from(NONE)), ("FAR", f64::from(FAR))];
        Self {
            seed: Seed::new(compiler),
            jump_flood: JumpFlood::new(compiler),
            distance: compiler.program(&programs::DISTANCE, &constants),
        }
    }

    /// Plans the seed map, the jump flood and the distance field.
    pub fn plan(&self, planner: &FramePlanner) -> Result<DistanceField> {
        let (seeds, first) = self.seed.plan(planner)?;
        let (nearest, flood) = self.jump_flood.plan(planner, &seeds)?;
        let distance = planner.buffer::<f32>("distance", planner.cells())?;
        let bound = planner.bind(&self.distance, &[whole(&nearest), whole(&distance)]);
        let last = planner.over_cells(&self.distance, 0, &bound, None);
        let dispatches = [vec![first], flood, vec![last]].concat();
        let stages = vec![
            (Stage::Seeds, seeds),
            (Stage::Nearest, nearest.clone()),
            (Stage::Distance, distance.clone()),
        ];
        Ok(DistanceField { nearest, distance, passes: PassList::new(dispatches, stages) })
    }
}
