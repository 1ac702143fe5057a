//! The input of a frame.

use crate::matter::Textures;
use lamplight::{Cells, Inflow, Lamp, Settings, Sight, Sky, Sun};
use wgpu::TextureView;

/// The input of a frame, for [`crate::Lighting::prepare`].
///
/// ```no_run
/// # use lamplight::{Lamp, Settings};
/// # use lamplight_wgpu::{FrameInput, Lighting, Lights, Textures};
/// # fn frame(lighting: &mut Lighting, settings: &Settings, textures: &Textures, lamps: &[Lamp],
/// #     camera: [i32; 2]) -> Result<(), lamplight_wgpu::Error> {
/// let lights = Lights { lamps, ..Lights::default() };
/// let input = FrameInput::of_textures(settings, textures, lights);
/// lighting.prepare(&FrameInput { origin: camera, ..input })?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FrameInput<'a> {
    /// The settings of the solver.
    pub settings: &'a Settings,
    /// The scene to be lit.
    pub scene: SceneInput<'a>,
    /// The cell of the host's world that is the grid's left and top one
    /// ([`crate::GridPlacement::origin`]). Noise, and with it light, stays with the world when the grid moves
    /// over it. What remains is rounding: one cell in ten thousand has a ray that passes a corner within a
    /// millionth of a px, on the other side. History moves along; cells that come into the grid have none.
    pub origin: [i32; 2],
    /// A texture that the light is written to, linear RGB and 1: of the format `Rgba16Float`, with the usage
    /// `STORAGE_BINDING`, as large as the grid.
    pub output: Option<&'a TextureView>,
    /// True to record the seed map, the jump flood and the distance field too
    /// ([`crate::Stage::Distance`]). A method that needs them makes its own.
    pub distance_field: bool,
    /// Viewers, whose sight is recorded too ([`crate::Stage::Sight`]), as by [`lamplight::SightSolver`]: the largest
    /// visibility of all of them per cell. Positions are px of the grid, as those of lamps. Walls and media are those
    /// of the matter that the method reads, in which solid lamps are matter if the method draws lamps. Without
    /// viewers nothing is recorded.
    pub sights: &'a [Sight],
}

/// The scene of a frame.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum SceneInput<'a> {
    /// Cells, which are uploaded, with their lamps, their suns, and their sky or inflow.
    Cells(&'a Cells),
    /// The host's textures.
    Textures {
        /// The matter.
        textures: &'a Textures,
        /// The light that is not in the textures.
        lights: Lights<'a>,
    },
}

/// The light of a frame that is not in its textures; by default there is none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lights<'a> {
    /// Lamps. Those without exact light ([`Lamp::is_exact`]) are for the methods that light them by rule
    /// (`flood` and `polar`); for the other methods such a lamp is emission in the textures.
    pub lamps: &'a [Lamp],
    /// Suns.
    pub suns: &'a [Sun],
    /// The radiance beyond the grid.
    pub sky: &'a Sky,
    /// Light that enters the grid from the world around it, in place of the sky's.
    pub inflow: Option<&'a Inflow>,
}

impl<'a> FrameInput<'a> {
    /// The input that lights cells, at the origin of the world.
    pub fn of_cells(settings: &'a Settings, cells: &'a Cells) -> Self {
        Self::new(settings, SceneInput::Cells(cells))
    }

    /// The input that lights the host's textures, at the origin of the world.
    pub fn of_textures(settings: &'a Settings, textures: &'a Textures, lights: Lights<'a>) -> Self {
        Self::new(settings, SceneInput::Textures { textures, lights })
    }

    fn new(settings: &'a Settings, scene: SceneInput<'a>) -> Self {
        Self { settings, scene, origin: [0; 2], output: None, distance_field: false, sights: &[] }
    }
}
