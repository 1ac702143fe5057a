//! Lamplight on the GPU: the stages and methods of [`lamplight`] as compute shaders, for any program
//! that has a wgpu device.
//!
//! It is middleware: [`Lighting`] is given the host's [`wgpu::Device`] and [`wgpu::Queue`], records
//! into the host's [`wgpu::CommandEncoder`], and never creates a device, submits or waits. The same
//! settings give the same light as on the CPU, but for rounding.
//!
//! [`Compose`] draws the light on the host's target, [`View`] moves a camera over a larger world, [`Timer`]
//! says what each stage takes.
//!
//! All stages and methods of the library are here, with all their settings. Matter comes from uploaded
//! cells, or the host's textures and lamps ([`Lighting::set_lamps`]).
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
//! // and `Compose` to draw it, or `Lighting::write_to` to have it in a texture
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```

mod compiled;
mod compose;
mod cost;
pub mod error;
mod frame;
mod guarded;
mod kernel;
mod known;
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
mod tier;
mod timing;
mod view;

pub use compose::{Color, Compose, Filter, Shown};
pub use cost::{Cost, KernelCost, Traffic};
pub use error::{Error, Result};
pub use lighting::{Lighting, Stage};
pub use matter::Textures;
pub use options::Options;
pub use shaders::shaders;
pub use stages::display::Target;
pub use tier::{Tier, required_features, required_limits};
pub use timing::Timer;
pub use view::{Placed, View, Window};
/// The crate of the device that [`Lighting`] is given.
pub use wgpu;
