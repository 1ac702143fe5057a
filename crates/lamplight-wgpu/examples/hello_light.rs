//! A window with walls, lamps and a light that follows the mouse:
//! `cargo run --release -p lamplight-wgpu --example hello_light`.

use lamplight::settings::Raymarch;
use lamplight::{Bounces, Cells, Lamp, Matter, Settings};
use lamplight_wgpu::wgpu::{
    CurrentSurfaceTexture, Device, DeviceDescriptor, Instance, InstanceDescriptor, Queue,
    RequestAdapterOptions, Surface, SurfaceConfiguration,
};
use lamplight_wgpu::{Compose, ComposeParams, Filter, FrameInput, Lighting, LightingOptions};
use pollster::block_on;
use std::{error::Error, process::ExitCode, sync::Arc};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};
use winit::{application::ApplicationHandler, event::WindowEvent};

const SIZE: [u32; 2] = [320, 180];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let mut app = App { game: None, end: Ok(()) };
    EventLoop::new()?.run_app(&mut app)?;
    app.end
}

struct App {
    game: Option<Game>,
    /// An error if one ended the game: events have no result to return it by.
    end: Result<(), Box<dyn Error>>,
}

impl App {
    fn fail(&mut self, events: &ActiveEventLoop, error: Box<dyn Error>) {
        self.end = Err(error);
        events.exit();
    }
}

struct Game {
    window: Arc<Window>,
    surface: Surface<'static>,
    config: SurfaceConfiguration,
    device: Device,
    queue: Queue,
    cells: Cells,
    settings: Settings,
    lighting: Lighting,
    compose: Compose,
}

impl Game {
    fn new(events: &ActiveEventLoop) -> Result<Self, Box<dyn Error>> {
        let window = Arc::new(events.create_window(Window::default_attributes())?);
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(window.clone())?;
        let options =
            RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
        let adapter = block_on(instance.request_adapter(&options))?;
        let (device, queue) = block_on(adapter.request_device(&DeviceDescriptor::default()))?;
        let [width, height]: [u32; 2] = window.inner_size().into();
        let config = surface.get_default_config(&adapter, width.max(1), height.max(1));
        let config = config.ok_or("the window cannot be drawn to")?;
        surface.configure(&device, &config);

        // The world: columns, and lamps in two corners. The last lamp is the mouse's.
        let mut cells = Cells::new(SIZE[0], SIZE[1])?;
        let stone = Matter { opacity: 1.0, albedo: [0.7, 0.6, 0.5], ..Matter::EMPTY };
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
            if x % 40 > 30 && y % 45 > 33 {
                cells.set(x, y, stone);
            }
        }
        let [red, blue, warm] = [[1.0, 0.3, 0.2], [0.2, 0.4, 1.0], [1.0, 0.8, 0.5]];
        for (x, y, color) in [(15.0, 15.0, red), (305.0, 165.0, blue), (160.0, 90.0, warm)] {
            let position = [x, y];
            let lamp = Lamp { position, color, intensity: 12.0, size: 4.0, ..Lamp::default() };
            cells.lamps_mut().push(lamp);
        }

        let raymarch = Raymarch { rays: 128, ..Raymarch::default() }; // fewer rays: more noise
        let bounces = Bounces::Count(1);
        let settings = Settings { bounces, wall_depth: 4.0, ..Settings::new(raymarch) };
        let lighting = Lighting::new(&device, &queue, &LightingOptions::default())?;
        let compose = Compose::new(&device, &queue)?;
        Ok(Self { window, surface, config, device, queue, cells, settings, lighting, compose })
    }

    fn draw(&mut self) -> Result<(), Box<dyn Error>> {
        use CurrentSurfaceTexture::{Suboptimal, Success};
        let Self { device, queue, surface, lighting, compose, .. } = self;
        self.window.request_redraw();
        let (Success(frame) | Suboptimal(frame)) = surface.get_current_texture() else {
            // Hidden, or of another size than the window: the next frame tries again.
            surface.configure(device, &self.config);
            return Ok(());
        };
        lighting.prepare(&FrameInput::of_cells(&self.settings, &self.cells))?;
        let params = ComposeParams { filter: Filter::Linear, ..ComposeParams::default() };
        compose.prepare(lighting, self.config.format, &params)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder)?;
        compose.record(&mut encoder, &frame.texture.create_view(&Default::default()))?;
        queue.submit([encoder.finish()]);
        queue.present(frame);
        Ok(())
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        match Game::new(events) {
            Ok(game) => self.game = Some(game),
            Err(error) => self.fail(events, error),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(game) = &mut self.game else { return };
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(size) => {
                [game.config.width, game.config.height] = [size.width.max(1), size.height.max(1)];
                game.surface.configure(&game.device, &game.config);
            }
            WindowEvent::CursorMoved { position, .. } => {
                let [x, y]: [f64; 2] = position.into();
                let over = [game.config.width, game.config.height].map(f64::from);
                let at = [x / over[0], y / over[1]].map(|v| v.clamp(0.0, 1.0) as f32);
                let lamps = game.cells.lamps_mut();
                lamps[2].position = [at[0] * SIZE[0] as f32, at[1] * SIZE[1] as f32];
            }
            WindowEvent::RedrawRequested => {
                if let Err(error) = game.draw() {
                    self.fail(events, error);
                }
            }
            _ => {}
        }
    }
}
