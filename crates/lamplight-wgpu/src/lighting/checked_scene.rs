//! The scene of an input, checked before anything is made of it.

use crate::error::{PrepareError, Result};
use crate::error_scope::with_error_scope;
use crate::frame_input::{FrameInput, Lights, SceneInput};
use crate::grid_size::GridSize;
use crate::hints::SceneHints;
use crate::matter::Upload;
use crate::planner::Grid;
use crate::shared::Shared;
use lamplight::Settings;
use wgpu::TextureView;

/// The scene of an input, checked.
pub struct CheckedScene<'a> {
    pub grid: Grid<'a>,
    pub shown: Option<&'a TextureView>,
    pub normals: Option<&'a TextureView>,
    pub lights: Lights<'a>,
}

impl<'a> CheckedScene<'a> {
    /// Checks the scene of an input, and uploads its cells.
    pub fn new(
        shared: &Shared,
        input: &FrameInput<'a>,
        upload: &'a mut Option<Upload>,
    ) -> Result<Self> {
        let Shared { device, queue, .. } = shared;
        match input.scene {
            SceneInput::Cells(cells) => {
                cells.check()?;
                let method = input.settings.method();
                method.suits(cells)?;
                let size = GridSize::new(device, [cells.width(), cells.height()])?;
                let (lamps, suns, sky) = (cells.lamps(), cells.suns(), cells.sky());
                let lights = Lights { lamps, suns, sky, inflow: cells.inflow() };
                check_inflow(lights, input.settings, size)?;
                let uploaded = match upload.take().filter(|upload| upload.size == size) {
                    Some(uploaded) => uploaded,
                    None => with_error_scope(device, || Upload::new(device, size))?,
                };
                let upload = upload.insert(uploaded);
                upload.write(device, queue, cells, &input.settings.method);
                let hints =
                    SceneHints::of(cells, input.settings.method.bounces(input.settings.bounces));
                let grid = Grid { size, textures: &upload.textures, hints };
                let (shown, normals) = (upload.shown.as_ref(), upload.normals.as_ref());
                Ok(Self { grid, shown, normals, lights })
            }
            SceneInput::Textures { textures, lights } => {
                let Lights { lamps, suns, sky, .. } = lights;
                sky.check()?;
                for (i, sun) in suns.iter().enumerate() {
                    sun.check(&format_args!("sun[{i}]"))?;
                }
                for (i, lamp) in lamps.iter().enumerate() {
                    lamp.check(&format_args!("lamp[{i}]"))?;
                }
                let size = GridSize::new(device, textures.size()?)?;
                check_inflow(lights, input.settings, size)?;
                let grid = Grid { size, textures, hints: SceneHints::UNKNOWN };
                Ok(Self { grid, shown: None, normals: None, lights })
            }
        }
    }
}

/// Rejects what a device without compute shaders cannot do.
pub fn check_without_compute(input: &FrameInput) -> Result<()> {
    let wanted =
        [(input.distance_field, "the distance field"), (!input.sights.is_empty(), "sight")];
    match wanted.into_iter().find(|(is_wanted, _)| *is_wanted) {
        Some((_, what)) => Err(PrepareError::NoCompute { what }),
        None => Ok(()),
    }
}

/// Rejects an inflow that the method does not read, or of a grid of another size.
fn check_inflow(lights: Lights, settings: &Settings, size: GridSize) -> lamplight::Result<()> {
    match lights.inflow {
        Some(inflow) => settings.method.takes_inflow().and_then(|()| inflow.check(size.into())),
        None => Ok(()),
    }
}
