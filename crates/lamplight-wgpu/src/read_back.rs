//! Results of the GPU on the CPU: [`read_back`] and [`light`] wait, for tests and files. [`Fetch`] and
//! [`FetchLight`] do not, for a game's frame and for the web, where waiting is impossible.

pub use crate::fetch::{Fetch, read_back};

use crate::error::ReadBackError;
use crate::{Lighting, Stage};
use lamplight::{Cells, Light};

/// Copies the light of the last frame of these cells, for queries as on the CPU: solid lamps count as solid
/// cells.
///
/// # Errors
/// If nothing was lit, if the cells are a grid of another size than those lit, and as [`read_back`].
pub fn light(lighting: &Lighting, cells: &Cells) -> Result<Light, ReadBackError> {
    let fetch = FetchLight::new(lighting, cells)?;
    fetch.cells.light(fetch.numbers.wait()?)
}

/// A transfer of the light of a frame from the GPU.
#[derive(Debug)]
pub struct FetchLight {
    numbers: Fetch<[f32; 4]>,
    cells: LitCells,
}

impl FetchLight {
    /// Starts the transfer of the light of the last frame of these cells, as [`light`] does.
    pub fn new(lighting: &Lighting, cells: &Cells) -> Result<Self, ReadBackError> {
        let buffer = lighting.stage(Stage::Light).ok_or(ReadBackError::NothingLit)?;
        let lit = lighting.compose_inputs().ok_or(ReadBackError::NothingLit)?.size;
        let asked = [cells.width(), cells.height()];
        if asked != lit {
            return Err(ReadBackError::OtherCells { lit, asked });
        }
        let mut cells = cells.clone();
        if let Some(settings) = lighting.settings() {
            settings.method.draw_lamps(&mut cells);
        }
        let elevation = lighting.settings().filter(|s| s.moment).map(|s| s.elevation);
        let (device, queue) = lighting.device();
        let cells = LitCells { cells, elevation };
        Ok(Self { numbers: Fetch::new(device, queue, buffer)?, cells })
    }

    /// Returns the light if it has arrived; `None` while the transfer is in progress. Does not wait.
    pub fn take(&self) -> Result<Option<Light>, ReadBackError> {
        self.numbers.take()?.map(|numbers| self.cells.light(numbers)).transpose()
    }
}

/// The cells that were lit.
#[derive(Debug)]
struct LitCells {
    cells: Cells,
    /// The elevation of light, if its first moment was found.
    elevation: Option<f32>,
}

impl LitCells {
    fn light(&self, numbers: Vec<[f32; 4]>) -> Result<Light, ReadBackError> {
        let failed = |error: lamplight::Error| ReadBackError::Failed(error.to_string());
        let (light, moment) = numbers.split_at(self.cells.len().min(numbers.len()));
        let rgb = |[r, g, b, _]: &[f32; 4]| [*r, *g, *b];
        let light = Light::from_pixels(&self.cells, light.iter().map(rgb).collect());
        let light = light.map_err(failed)?;
        let Some(elevation) = self.elevation else { return Ok(light) };
        let (x, y) = moment.split_at(moment.len() / 2);
        let moment = x.iter().zip(y).map(|(x, y)| [rgb(x), rgb(y)]).collect();
        light.with_moment(moment, elevation).map_err(failed)
    }
}
