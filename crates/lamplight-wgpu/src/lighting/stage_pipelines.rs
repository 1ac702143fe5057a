//! The pipelines of stages that methods share.

use crate::compiler::Compiler;
use crate::error::{PrepareError, Result};
use crate::error_scope::with_error_scope;
use crate::stages::direct::Direct;
use crate::stages::distance::DistancePipelines;
use crate::stages::glow::Glow;
use crate::stages::output::Output;
use crate::stages::reproject::Reproject;
use crate::stages::sight::SightPipelines;
use crate::stages::walls::{MomentWalls, Walls};
use lamplight::Settings;

/// Each `None` is compiled when a frame first needs it.
#[derive(Debug)]
pub struct StagePipelines {
    pub glow: Glow,
    pub walls: Walls,
    pub reproject: Reproject,
    pub output: Output,
    pub distance: Option<DistancePipelines>,
    pub sight: Option<SightPipelines>,
    /// Suns and exact lamps.
    pub direct: Option<Direct>,
    /// The first moment.
    pub moment_walls: Option<MomentWalls>,
}

/// The stages that a frame needs beside those of every frame.
#[derive(Clone, Copy, Debug)]
pub struct NeededStages {
    pub distance: bool,
    pub sight: bool,
    pub direct: bool,
    /// The light that the GPU finds has its first moment.
    pub moment: bool,
}

impl StagePipelines {
    pub fn new(compiler: &Compiler) -> Self {
        Self {
            glow: Glow::new(compiler),
            walls: Walls::new(compiler),
            reproject: Reproject::new(compiler),
            output: Output::new(compiler),
            distance: None,
            sight: None,
            direct: None,
            moment_walls: None,
        }
    }

    /// Compiles the stages that a frame is the first to need.
    pub fn compile(
        &mut self,
        compiler: &Compiler,
        settings: &Settings,
        needed: NeededStages,
    ) -> Result<()> {
        let NeededStages { distance, sight, direct, moment } = needed;
        if distance {
            fill(&mut self.distance, compiler, DistancePipelines::new)?;
        }
        if sight {
            fill(&mut self.sight, compiler, SightPipelines::new)?;
        }
        if direct {
            self.direct.take_if(|direct| !direct.serves(settings));
            fill(&mut self.direct, compiler, |compiler| Direct::new(compiler, settings))?;
        }
        if moment {
            fill(&mut self.moment_walls, compiler, MomentWalls::new)?;
        }
        Ok(())
    }
}

fn fill<T>(
    pipelines: &mut Option<T>,
    compiler: &Compiler,
    compile: impl FnOnce(&Compiler) -> T,
) -> Result<()> {
    if pipelines.is_none() {
        let compile = || Ok::<_, PrepareError>(compile(compiler));
        *pipelines = Some(with_error_scope(&compiler.device, compile)?);
    }
    Ok(())
}
