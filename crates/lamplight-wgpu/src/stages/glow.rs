//! Cells that glow, as the media that every method reads.

use crate::compiler::Compiler;
use crate::matter::{Textures, texture};
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view};
use crate::programs;
use lamplight::internals::glow::THINNEST;
use wgpu::{TextureUsages, TextureView};

/// The pipeline.
#[derive(Debug)]
pub struct Glow(ComputePipelines);

impl Glow {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [
            ("MAX_OPTICAL_DEPTH", f64::from(lamplight::internals::MAX_OPTICAL_DEPTH)),
            ("THINNEST", f64::from(THINNEST)),
        ];
        Self(compiler.program(&programs::GLOW, &constants))
    }

    /// Plans turning the cells of the planner's textures, which glow by `glow`, into media. Returns their
    /// textures.
    pub fn plan(&self, planner: &FramePlanner, glow: &TextureView) -> (Textures, Dispatch) {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
        let made =
            |label| planner.counted_texture(texture(planner.device, label, planner.size, usage));
        let media = Textures {
            emission: made("emission of media"),
            tint_opacity: made("tint and opacity of media"),
            albedo: made("albedo of media"),
            glow: None,
            masks: planner.textures.masks.clone(),
        };
        let Textures { emission, tint_opacity, albedo, .. } = planner.textures;
        let read = [emission, tint_opacity, albedo, glow];
        let written = [&media.emission, &media.tint_opacity, &media.albedo];
        let resources: Vec<_> = read.into_iter().chain(written).map(view).collect();
        let bound = planner.bind(&self.0, &resources);
        let dispatch = planner.over_cells(&self.0, 0, &bound, None);
        (media, dispatch)
    }
}
