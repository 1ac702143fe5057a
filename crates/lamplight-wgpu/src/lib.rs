//! Lamplight on the GPU: the stages and methods of [`lamplight`] as compute shaders, for any program
//! that has a wgpu device.
//!
//! It is middleware: [`Lighting`] is given the host's [`wgpu::Device`] and [`wgpu::Queue`], records
//! into the host's [`wgpu::CommandEncoder`], and never creates a device, submits or waits. The same
//! settings give the same light as on the CPU, but for rounding.
//!
//! Here so far: seed, jump flood, distance, clear squares, `raymarch` with everything that goes with it
//! (both its rules, bounces by count, feedback or until they converge, the mean over frames, denoising),
//! `polar`, `flood`, `cascades` and `holographic`; from uploaded cells, or the host's textures and lamps
//! ([`Lighting::set_lamps`]). Whatever else settings ask for is refused by name ([`Error::NotYet`]).
//!
//! ```no_run
//! # fn frame(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(), Box<dyn std::error::Error>> {
//! use lamplight::{Cells, Method, Settings};
//! use lamplight_wgpu::Lighting;
//!
//! let settings = Settings { method: Method::Raymarch, ..Settings::default() };
//! let mut lighting = Lighting::new(device, queue, settings)?;
//! // Every frame:
//! let cells = Cells::new(320, 180)?;
//! lighting.prepare(device, queue, &cells)?;
//! let mut encoder = device.create_command_encoder(&Default::default());
//! lighting.record(&mut encoder);
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```

mod cost;
pub mod error;
mod frame;
mod kernel;
mod lamps;
mod lighting;
mod matter;
mod methods;
mod options;
pub mod read_back;
mod shaders;
mod shared;
mod site;
mod stages;

pub use cost::{Cost, KernelCost, Traffic};
pub use error::{Error, Result};
pub use lighting::{Lighting, Stage, check};
pub use matter::Textures;
pub use options::Options;
/// The crate of the device that [`Lighting`] is given.
pub use wgpu;
