//! The light of a frame, found on the GPU that draws the window or on the CPU, and shown.

mod cpu;
mod gpu;

use anyhow::Result;
use cpu::OnCpu;
use eframe::CreationContext;
use eframe::egui::{Context, Painter, Rect};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu::DeviceType;
use gpu::OnGpu;
use lamplight::{Cells, Display, Light, Settings};
use lamplight_wgpu::read_back::FetchLight;
use std::time::Duration;

/// What the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    pub display: Display,
    /// The light alone, on white.
    pub light_alone: bool,
    /// Between cells, instead of cell by cell.
    pub smooth: bool,
}

/// Where light is to be found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Backend {
    #[default]
    Auto,
    Cpu,
    Gpu,
}

/// Light that was asked for.
pub enum Asked {
    Here(Box<Light>),
    /// On its way from the GPU: nothing waits for it.
    Coming(Box<FetchLight>),
}

/// Finds light and shows it.
pub enum Lit {
    Gpu(Box<OnGpu>),
    Cpu(Box<OnCpu>),
}

/// The GPU that draws the window, where light is to be found on it.
pub fn gpu<'a>(context: &'a CreationContext, backend: Backend) -> Option<&'a RenderState> {
    context.wgpu_render_state.as_ref().filter(|state| match backend {
        Backend::Cpu => false,
        Backend::Gpu => true,
        // A GPU that is played by the CPU is slower than the CPU.
        Backend::Auto => state.adapter.get_info().device_type != DeviceType::Cpu,
    })
}

impl Lit {
    /// On the window's GPU, or on the CPU.
    pub fn new(context: &Context, gpu: Option<&RenderState>, settings: &Settings) -> Result<Self> {
        match gpu {
            Some(gpu) => Ok(Self::Gpu(Box::new(OnGpu::new(gpu, settings)?))),
            None => Self::on_cpu(context, settings),
        }
    }

    /// On the CPU.
    pub fn on_cpu(context: &Context, settings: &Settings) -> Result<Self> {
        Ok(Self::Cpu(Box::new(OnCpu::new(context, settings)?)))
    }

    /// Another light, found where this one is.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Ok(match self {
            Self::Gpu(gpu) => Self::Gpu(Box::new(gpu.beside(settings)?)),
            Self::Cpu(cpu) => Self::Cpu(Box::new(cpu.beside(settings)?)),
        })
    }

    /// Where it is found.
    pub fn place(&self) -> &str {
        match self {
            Self::Gpu(gpu) => gpu.name(),
            Self::Cpu(_) => "CPU",
        }
    }

    /// Finds the next frame's light even where nothing has changed: for who times it.
    pub fn forget(&mut self) {
        if let Self::Cpu(cpu) = self {
            cpu.forget();
        }
    }

    /// Finds the light of the next frame, on these cells, and shows the picture under it: the same cells, or
    /// those that they are coarser than.
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

    /// Draws it into a rectangle.
    pub fn draw(&self, painter: &Painter, place: Rect) {
        match self {
            Self::Gpu(gpu) => gpu.draw(painter, place),
            Self::Cpu(cpu) => cpu.draw(painter, place),
        }
    }

    /// Asks for the light of the last frame, which was of these cells.
    pub fn ask(&self, cells: &Cells) -> Result<Asked> {
        Ok(match self {
            Self::Gpu(gpu) => Asked::Coming(Box::new(gpu.ask(cells)?)),
            Self::Cpu(cpu) => Asked::Here(Box::new(cpu.light().clone())),
        })
    }

    /// The light that was asked for, once it has come; what was asked for stays as it is until then.
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
            // The GPU it was to come from is gone.
            (Self::Cpu(_), Some(Asked::Coming(_))) => None,
        };
        Ok(light)
    }

    /// What each stage of a recent frame took; empty where nobody can tell.
    pub fn stages(&mut self) -> &[(&'static str, Duration)] {
        match self {
            Self::Gpu(gpu) => gpu.stages(),
            Self::Cpu(cpu) => cpu.stages(),
        }
    }

    /// Whether it is found on the GPU.
    pub fn is_gpu(&self) -> bool {
        matches!(self, Self::Gpu(_))
    }

    /// Bytes that it holds; none where nobody counts.
    pub fn memory(&self) -> Option<u64> {
        match self {
            Self::Gpu(gpu) => gpu.memory(),
            Self::Cpu(_) => None,
        }
    }
}
