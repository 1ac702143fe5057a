//! A plan, and what a frame records of it.

use super::checked_scene::CheckedScene;
use crate::frame_input::FrameInput;
use crate::grid_size::GridSize;
use crate::hints::SceneHints;
use crate::lamps::Capacity;
use crate::matter::{self, Textures};
use crate::pass_list::PassList;
use crate::pipeline::Dispatch;
use crate::pipeline_cache::share_pipelines;
use crate::planner::{Grid, HistoryBuffer};
use crate::stages::direct::LightBuffers;
use crate::stages::sight::SightPass;
use lamplight::Settings;
use wgpu::{Buffer, Queue, TextureView};

/// A plan, and the resources that it was made for.
#[derive(Debug)]
pub struct PreparedFrame {
    pub settings: Settings,
    pub size: GridSize,
    pub textures: Textures,
    /// The emission of the displayed picture, if it is not that of the textures.
    pub shown: Option<TextureView>,
    pub normals: Option<TextureView>,
    /// The sky, if it is a panorama, or the inflow in its place.
    pub strips: Option<TextureView>,
    /// The cookies of lamps, if there are any.
    pub cookies: Option<TextureView>,
    pub hints: SceneHints,
    pub capacity: Capacity,
    /// True if its light comes from the CPU.
    pub by_cpu: bool,
    pub light: Buffer,
    /// Its values in rows as long as the grid's, on a device without storage buffers.
    pub light_texture: Option<TextureView>,
    pub passes: PassList,
    /// The buffers of suns and exact lamps, written before each frame.
    pub direct: Option<LightBuffers>,
    /// Bytes of all buffers.
    pub memory: u64,
    pub history: Vec<HistoryBuffer>,
    /// Moves history along with the grid; planned when the grid first moves.
    pub reproject: Option<Vec<Dispatch>>,
    /// True if the grid has moved since the frame before.
    pub moved: bool,
    /// Takes scattered radiance over from a grid of another size; recorded in the first frame only.
    pub resize: Option<Dispatch>,
    /// The distance field that the input asks for.
    pub fields: Option<PassList>,
    /// True if it is recorded in this frame.
    pub records_fields: bool,
    /// The sight of viewers.
    pub sight: Option<SightPass>,
    /// True if it is recorded in this frame.
    pub records_sight: bool,
    pub output: Option<OutputPass>,
}

/// Writing the light to a texture of the host's.
#[derive(Clone, Debug)]
pub struct OutputPass {
    pub picture: TextureView,
    /// None on a device without compute shaders, where the texture is written before each frame.
    pub dispatch: Option<Dispatch>,
}

/// The additions of a frame to its plan.
pub struct Extras {
    pub output: Option<OutputPass>,
    /// Planned now for the first time.
    pub fields: Option<PassList>,
    pub reproject: Option<Vec<Dispatch>>,
    /// Planned now for the first time, or for more viewers.
    pub sight: Option<SightPass>,
    /// Bytes of their buffers, without those of sight.
    pub memory: u64,
}

impl PreparedFrame {
    /// The dispatches of a frame, in order.
    pub fn dispatches(&self) -> impl Iterator<Item = &Dispatch> + Clone {
        let reproject = self.reproject.iter().flatten().filter(|_| self.moved);
        let fields = self.fields.iter().filter(|_| self.records_fields);
        let fields = fields.flat_map(|fields| &fields.dispatches);
        let sight = self.sight.iter().filter(|_| self.records_sight);
        let sight = sight.flat_map(|sight| &sight.dispatches);
        let output = self.output.iter().filter_map(|output| output.dispatch.as_ref());
        self.resize
            .iter()
            .chain(reproject)
            .chain(fields)
            .chain(sight)
            .chain(&self.passes.dispatches)
            .chain(output)
    }

    /// Returns whether the plan serves a grid under these settings.
    pub fn serves(&self, grid: &Grid, settings: &Settings, needed: Capacity) -> bool {
        self.textures == *grid.textures
            && self.hints.serves(grid.hints)
            && self.capacity.holds(needed)
            && share_pipelines(&self.settings, settings)
            && self.settings.wall_depth == settings.wall_depth
    }

    /// Takes over what a frame shows beside the light.
    pub fn show(&mut self, input: &FrameInput, scene: &CheckedScene) {
        self.settings.clone_from(input.settings);
        self.shown = scene.shown.cloned();
        self.normals = scene.normals.cloned();
        self.records_fields = input.distance_field;
        self.records_sight = !input.sights.is_empty();
    }

    /// Adds what was planned beside the light.
    pub fn add(&mut self, extras: Extras) {
        self.output = extras.output;
        self.fields = extras.fields.or(self.fields.take());
        self.sight = extras.sight.or(self.sight.take());
        self.reproject = extras.reproject.or(self.reproject.take());
        self.memory += extras.memory;
    }

    /// Writes light that the CPU found.
    pub fn write_light(&self, queue: &Queue, light: &[[f32; 4]]) {
        queue.write_buffer(&self.light, 0, bytemuck::cast_slice(light));
        if let Some(texture) = &self.light_texture {
            matter::write_texels(queue, texture, light);
            if let Some(output) = &self.output {
                let cells = self.size.cells() as usize;
                matter::write_halves(queue, &output.picture, &light[..cells]);
            }
        }
    }

    pub fn grid(&self) -> Grid<'_> {
        Grid { size: self.size, textures: &self.textures, hints: self.hints }
    }
}
