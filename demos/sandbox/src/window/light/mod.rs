//! The light of a frame, computed and drawn by the GPU of the window or by the CPU.

mod cpu;
mod gpu;
mod shown;
mod still;

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
use still::Still;

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
pub struct Lit {
    on: Computes,
    still: Still,
}

/// The backend in use.
enum Computes {
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
                // The first frames show whether the CPU is faster.
                let options = LightingOptions::on(match backend {
                    Backend::Auto => lamplight_wgpu::Backend::Fastest,
                    _ => lamplight_wgpu::Backend::Gpu,
                });
                Ok(Self::on(Computes::Gpu(Box::new(OnGpu::new(gpu, options, settings)?))))
            }
            None => Self::on_cpu(context, settings),
        }
    }

    /// Uses the CPU.
    pub fn on_cpu(context: &Context, settings: &Settings) -> Result<Self> {
        Ok(Self::on(Computes::Cpu(Box::new(OnCpu::new(context, settings)?))))
    }

    fn on(on: Computes) -> Self {
        Self { on, still: Still::default() }
    }

    /// Another light with the same backend.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Ok(Self::on(match &self.on {
            Computes::Gpu(gpu) => Computes::Gpu(Box::new(gpu.beside(settings)?)),
            Computes::Cpu(cpu) => Computes::Cpu(Box::new(cpu.beside(settings)?)),
        }))
    }

    /// The name of the backend.
    pub fn place(&self) -> &str {
        match &self.on {
            Computes::Gpu(gpu) => gpu.name(),
            Computes::Cpu(_) => "CPU",
        }
    }

    /// Forces the next frame to be computed even if nothing changed, for benchmarks.
    pub fn forget(&mut self) {
        self.still.forget();
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
        let settled = self.still.has_settled(cells, settings);
        let mut found = if settled { Ok(()) } else { self.on.light(cells, settings) };
        if found.is_ok() && !self.still.is_drawn(picture, shown, settled) {
            found = self.on.prepare(cells, picture, shown);
        }
        if found.is_err() {
            self.still.forget();
        }
        found
    }

    /// Draws the lit picture into a rectangle.
    pub fn draw(&self, painter: &Painter, place: Rect) {
        match &self.on {
            Computes::Gpu(gpu) => gpu.draw(painter, place),
            Computes::Cpu(cpu) => cpu.draw(painter, place),
        }
    }

    /// Requests the light of the last frame, which was of these cells.
    pub fn ask(&self, cells: &Cells) -> Result<Asked> {
        Ok(match &self.on {
            Computes::Gpu(gpu) => Asked::Coming(Box::new(gpu.ask(cells)?)),
            Computes::Cpu(cpu) => Asked::Here(Box::new(cpu.found().clone())),
        })
    }

    /// Takes requested light that has arrived. Until then the request stays.
    pub fn take(&self, asked: &mut Option<Asked>) -> Result<Option<Light>> {
        let light = match (&self.on, asked.take()) {
            (_, None) => None,
            (_, Some(Asked::Here(light))) => Some(*light),
            (Computes::Gpu(gpu), Some(Asked::Coming(coming))) => {
                let come = gpu.take(&coming)?;
                if come.is_none() {
                    *asked = Some(Asked::Coming(coming));
                }
                come
            }
            // The GPU of the request is gone.
            (Computes::Cpu(_), Some(Asked::Coming(_))) => None,
        };
        Ok(light)
    }

    /// Times of the stages of a recent frame; empty if unknown.
    pub fn stages(&mut self) -> &[(&'static str, Duration)] {
        match &mut self.on {
            Computes::Gpu(gpu) => gpu.stages(),
            Computes::Cpu(cpu) => cpu.stages(),
        }
    }

    /// Returns true if the backend is the GPU.
    pub fn is_gpu(&self) -> bool {
        matches!(self.on, Computes::Gpu(_))
    }

    /// GPU memory in bytes, if known.
    pub fn memory(&self) -> Option<u64> {
        match &self.on {
            Computes::Gpu(gpu) => gpu.memory(),
            Computes::Cpu(_) => None,
        }
    }
}

impl Computes {
    /// Computes the light of a frame.
    fn light(&mut self, cells: &Cells, settings: &Settings) -> Result<()> {
        match self {
            Self::Gpu(gpu) => gpu.light(cells, settings),
            Self::Cpu(cpu) => cpu.light(cells, settings),
        }
    }

    /// Prepares a picture with that light.
    fn prepare(&mut self, cells: &Cells, picture: &Cells, shown: Shown) -> Result<()> {
        match self {
            Self::Gpu(gpu) => gpu.prepare(cells, picture, shown),
            Self::Cpu(cpu) => cpu.prepare(cells, picture, shown),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamplight::{Display, Method};

    #[test]
    fn what_has_not_changed_is_not_drawn_again() {
        let context = Context::default();
        let settings = Settings::direct(Method::Holographic);
        let mut lit = Lit::on_cpu(&context, &settings).unwrap();
        let cells = Cells::new(16, 8).unwrap();
        let coarse = Cells::new(8, 4).unwrap();
        let mut is_drawn = |cells: &Cells, picture: &Cells, exposure| {
            context.tex_manager().write().take_delta().clear();
            let shown =
                Shown { display: Display { exposure, ..Display::default() }, ..Shown::default() };
            lit.find(cells, picture, &settings, shown).unwrap();
            let mut delta = context.tex_manager().write().take_delta();
            let is_drawn = !delta.set.is_empty();
            delta.clear();
            is_drawn
        };
        let mut colored = cells.clone();
        colored.color_mut().fill([0.2; 3]);
        for (cells, picture) in [(&colored, &colored), (&coarse, &cells), (&coarse, &colored)] {
            // Light is drawn when it is found, and once more as what stays.
            is_drawn(cells, picture, 0.0);
            is_drawn(cells, picture, 0.0);
            assert!(!is_drawn(cells, picture, 0.0));
            assert!(is_drawn(cells, picture, 1.0));
            assert!(!is_drawn(cells, picture, 1.0));
        }
        colored.color_mut()[3] = [0.3; 3];
        assert!(is_drawn(&coarse, &colored, 1.0));
        let mut lamps = coarse.clone();
        lamps.lamps_mut().push(lamplight::Lamp::default());
        assert!(is_drawn(&lamps, &colored, 1.0));
    }
}
