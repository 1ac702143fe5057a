//! The light of a frame, computed and drawn by the GPU of the window or by the CPU.

mod cpu;
mod gpu;
mod shown;

pub use shown::Shown;

use anyhow::Result;
use cpu::OnCpu;
use eframe::CreationContext;
use eframe::egui::{Context, Painter, Rect};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu::DeviceType;
use gpu::OnGpu;
use lamplight::{Cells, Light, Settings};
use lamplight_wgpu::LightingOptions;
use lamplight_wgpu::read_back::FetchLight;
use std::time::Duration;

/// The backend of lighting. `Auto` is the faster one, as the first frames show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Backend {
    #[default]
    Auto,
    Cpu,
    Gpu,
}

/// A request for light on the CPU.
pub enum Asked {
    Here(Box<Light>),
    /// A readback from the GPU, which nothing waits for.
    Coming(Box<FetchLight>),
}

/// Computes light and draws it.
pub enum Lit {
    Gpu(Box<OnGpu>),
    Cpu(Box<OnCpu>),
}

/// The GPU of the window, if the backend uses it.
pub fn gpu<'a>(context: &'a CreationContext, backend: Backend) -> Option<&'a RenderState> {
    context.wgpu_render_state.as_ref().filter(|state| match backend {
        Backend::Cpu => false,
        Backend::Gpu => true,
        // Software GPUs are slower than the CPU backend.
        Backend::Auto => state.adapter.get_info().device_type != DeviceType::Cpu,
    })
}

impl Lit {
    /// Uses the GPU of the window, or the CPU.
    pub fn new(
        context: &Context,
        gpu: Option<&RenderState>,
        backend: Backend,
        settings: &Settings,
    ) -> Result<Self> {
        match gpu {
            Some(gpu) => {
                // The CPU as a backend of the window's own is for devices that are slower for certain.
                let options = LightingOptions::on(match backend {
                    Backend::Auto => lamplight_wgpu::Backend::Fastest,
                    _ => lamplight_wgpu::Backend::Gpu,
                });
                Ok(Self::Gpu(Box::new(OnGpu::new(gpu, options, settings)?)))
            }
            None => Self::on_cpu(context, settings),
        }
    }

    /// Uses the CPU.
    pub fn on_cpu(context: &Context, settings: &Settings) -> Result<Self> {
        Ok(Self::Cpu(Box::new(OnCpu::new(context, settings)?)))
    }

    /// Another light with the same backend.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Ok(match self {
            Self::Gpu(gpu) => Self::Gpu(Box::new(gpu.beside(settings)?)),
            Self::Cpu(cpu) => Self::Cpu(Box::new(cpu.beside(settings)?)),
        })
    }

    /// The name of the backend.
    pub fn place(&self) -> &str {
        match self {
            Self::Gpu(gpu) => gpu.name(),
            Self::Cpu(_) => "CPU",
        }
    }

    /// Forces the next frame to be computed even if nothing changed, for benchmarks.
    pub fn forget(&mut self) {
        if let Self::Cpu(cpu) = self {
            cpu.forget();
        }
    }

    /// Computes the light of the next frame on `cells`, and draws `picture` with it. `picture` is the same
    /// cells, or finer ones.
    pub fn find(
        &mut self,
        cells: &Cells,
        picture: &Cells,
        settings: &Settings,
        shown: Shown,
    ) -> Result<()> {
        match self {
            Self::Gpu(gpu) => gpu.find(cells, picture, settings, shown),
            Self::Cpu(cpu) => cpu.find(cells, picture, settings, shown),
        }
    }

    /// Draws the lit picture into a rectangle.
    pub fn draw(&self, painter: &Painter, place: Rect) {
        match self {
            Self::Gpu(gpu) => gpu.draw(painter, place),
            Self::Cpu(cpu) => cpu.draw(painter, place),
        }
    }

    /// Requests the light of the last frame, which was of these cells.
    pub fn ask(&self, cells: &Cells) -> Result<Asked> {
        Ok(match self {
            Self::Gpu(gpu) => Asked::Coming(Box::new(gpu.ask(cells)?)),
            Self::Cpu(cpu) => Asked::Here(Box::new(cpu.light().clone())),
        })
    }

    /// Takes requested light that has arrived. Until then the request stays.
    pub fn take(&self, asked: &mut Option<Asked>) -> Result<Option<Light>> {
        let light = match (self, asked.take()) {
            (_, None) => None,
            (_, Some(Asked::Here(light))) => Some(*light),
            (Self::Gpu(gpu), Some(Asked::Coming(coming))) => {
                let come = gpu.take(&coming)?;
                if come.is_none() {
                    *asked = Some(Asked::Coming(coming));
                }
                come
            }
            // The GPU of the request is gone.
            (Self::Cpu(_), Some(Asked::Coming(_))) => None,
        };
        Ok(light)
    }

    /// Times of the stages of a recent frame; empty if unknown.
    pub fn stages(&mut self) -> &[(&'static str, Duration)] {
        match self {
            Self::Gpu(gpu) => gpu.stages(),
            Self::Cpu(cpu) => cpu.stages(),
        }
    }

    /// Returns true if the backend is the GPU.
    pub fn is_gpu(&self) -> bool {
        matches!(self, Self::Gpu(_))
    }

    /// GPU memory in bytes, if known.
    pub fn memory(&self) -> Option<u64> {
        match self {
            Self::Gpu(gpu) => gpu.memory(),
            Self::Cpu(_) => None,
        }
    }
}
