//! Lamplight on the GPU: the stages and methods of [`lamplight`] as compute shaders, for any program
//! that has a wgpu device.
//!
//! It is middleware: [`Lighting`] uses the host's [`wgpu::Device`] and [`wgpu::Queue`], records into the host's
//! [`wgpu::CommandEncoder`], and never creates a device, submits or waits. (On a software device, where the CPU is
//! faster, and on one without compute shaders, [`lamplight::Solver`] takes its place: [`Backend`].) All stages, methods and settings of the
//! library are supported. The same settings give the same light as on the CPU, to within 0.1 %. Matter comes from
//! cells, which are uploaded, or from the host's textures and lamps ([`SceneInput`]).
//!
//! [`Compose`] draws the light on the host's target, [`Camera2dView`] moves a camera over a larger world, and
//! [`Timer`] measures the time of each stage. Engines that own their device run the same shaders by [`frame_plan`].
//!
//! ```no_run
//! # fn frame(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(), Box<dyn std::error::Error>> {
//! use lamplight::{Cells, Method, Settings};
//! use lamplight_wgpu::{FrameInput, Lighting, LightingOptions};
//!
//! let mut lighting = Lighting::new(device, queue, &LightingOptions::default())?;
//! let settings = Settings::new(Method::Raymarch);
//! // Every frame:
//! let cells = Cells::new(320, 180)?;
//! lighting.prepare(&FrameInput::of_cells(&settings, &cells))?;
//! let mut encoder = device.create_command_encoder(&Default::default());
//! lighting.record(&mut encoder)?;
//! // Then `Compose` draws the light, or `FrameInput::output` receives it.
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```

#[cfg(not(target_arch = "wasm32"))]
mod ahead;
mod camera;
mod compiler;
mod compose;
mod cookies;
mod cost;
mod cpu_backend;
mod draw_program;
pub mod error;
mod error_scope;
mod fetch;
mod found_light;
mod frame_input;
pub mod frame_plan;
mod gpu_struct;
mod grid_size;
mod hints;
mod inflow;
mod lamps;
mod lighting;
mod matter;
mod methods;
mod options;
mod panorama;
mod pass_list;
mod pipeline;
mod pipeline_cache;
mod planner;
#[cfg(test)]
mod poison;
mod programs;
pub mod read_back;
mod shader_module;
mod shaders;
mod shared;
#[cfg(not(target_arch = "wasm32"))]
mod spirv;
mod stage;
mod stages;
mod tier;
mod timing;
mod traffic;
mod trial;
mod uniforms;

pub use camera::{Camera2dView, GridPlacement, VisibleRect};
pub use compose::{Color, Compose, ComposeParams, Filter};
pub use cost::{Cost, PipelineCost};
pub use draw_program::Target;
pub use error::Error;
pub use frame_input::{FrameInput, Lights, SceneInput};
pub use frame_plan::FramePlan;
pub use grid_size::check_grid;
pub use lighting::Lighting;
pub use matter::Textures;
pub use options::{Backend, LightingOptions};
pub use shaders::shaders;
#[cfg(not(target_arch = "wasm32"))]
pub use spirv::SpirvError;
pub use stage::Stage;
pub use tier::{Tier, required_features, required_limits};
pub use timing::Timer;
pub use traffic::Traffic;
/// The crate of the device that [`Lighting`] uses.
pub use wgpu;
