//! Settings of a camera's lighting.

use bevy::camera::Hdr;
use bevy::prelude::*;
use lamplight::{Bounces, Method, Quality, Settings, SettingsTable, ToneMap};

/// Lights everything that a 2D camera sees.
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # fn system(mut commands: Commands) {
/// commands.spawn((Camera2d, Lighting2d::default()));
/// # }
/// ```
///
/// All lengths are in world units, so that light does not change when the camera zooms. A `CompositingSpace` other than
/// `Linear` leaves the camera unlit, since light multiplies linear colours.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Hdr)]
pub struct Lighting2d {
    /// The method.
    pub method: LightMethod,
    /// Speed against accuracy: the method's preset at this level.
    pub quality: LightQuality,
    /// Further settings of the method, which override the quality, in the syntax of `lamplight`'s command
    /// line: `"raymarch.rays=64"` or `"polar.preset=gamemaker"`. Settings that have a field here or in
    /// [`Relief2d`](crate::Relief2d) are errors.
    pub set: Vec<String>,
    /// Bounces of light off walls and fog. Those within a frame cost a pass over them each.
    pub bounces: LightBounces,
    /// The size of the cells that light is computed on.
    pub cells: CellSize,
    /// World units beyond the screen in which matter still affects light. Higher values prevent changes
    /// of light at the edge of the screen, and cost as much as a larger screen.
    pub border: f32,
    /// The number of rings around the lit grid from which light enters it, 0 to 4; more count as 4. Each ring is twice as
    /// wide as the one before, and its matter is known half as finely. With 3, the default, lamps and glowing matter light the
    /// screen from three and a half screens away, past the walls that stand between, and do not pop in. With 0 only the
    /// sky enters.
    ///
    /// The CPU finds this light, from what has changed beyond the grid; where nothing is, it does nothing. With light from
    /// outside the default method takes about a fifth longer. Light that matter beyond the
    /// grid reflects or scatters is left out, and of more than 64 lamps the faintest. `polar`, `flood` and
    /// [`LightQuality::Paper`] of the default method know no such light. [`SunLight2d`](crate::SunLight2d) does not see what is
    /// beyond the grid, nor does a [`LightQuery`](crate::LightQuery) of an area of its own.
    ///
    /// The last cells of the [`border`](Self::border) should be off the screen: lamps fade over 14 cells on each side of the
    /// grid's edge.
    pub surroundings: u32,
    /// World units that light penetrates into solid walls, so that walls are visible. Its cost is
    /// negligible.
    pub wall_depth: f32,
    /// Exposure in stops; each doubles the light.
    pub exposure: f32,
    /// The tone map, which brings light above 1 into the range of a screen.
    pub tone_map: LightToneMap,
    /// Interpolation of light between cells.
    pub filter: LightFilter,
}

impl Default for Lighting2d {
    fn default() -> Self {
        Self {
            method: LightMethod::default(),
            quality: LightQuality::default(),
            set: Vec::new(),
            bounces: LightBounces::default(),
            cells: CellSize::default(),
            border: 64.0,
            surroundings: 3,
            wall_depth: 24.0,
            exposure: 0.0,
            tone_map: LightToneMap::default(),
            filter: LightFilter::default(),
        }
    }
}

impl Lighting2d {
    /// Replaces the quality.
    #[must_use]
    pub fn with_quality(mut self, quality: LightQuality) -> Self {
        self.quality = quality;
        self
    }

    /// Resolves the settings for cells that are `cell` world units wide.
    pub(crate) fn settings(&self, cell: f32) -> lamplight::Result<Settings> {
        let mut table = SettingsTable::default();
        let method: Method = self.method.into();
        table.set("method", method.name());
        table.set("quality", Quality::from(self.quality).name());
        table.set("bounces", Bounces::from(self.bounces));
        for text in &self.set {
            let key = text.split('=').next().unwrap_or_default().trim();
            if ["method", "quality", "bounces", "wall_depth", "elevation"].contains(&key) {
                let expected = "another setting: a component has a field for this one";
                return Err(lamplight::Error::value("set", format!("{text:?}"), expected));
            }
            table.set_from_text(text)?;
        }
        let mut settings = table.resolve()?;
        settings.wall_depth = (self.wall_depth / cell).clamp(0.0, Settings::MAX_WALL_DEPTH);
        settings.check()?;
        Ok(settings)
    }
}

/// The method that computes light ([`lamplight::Method`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LightMethod {
    /// Holographic radiance cascades: no noise, and a cost that does not depend on the scene.
    #[default]
    Holographic,
    /// Radiance cascades. Softer, and cheaper where much of the picture is empty.
    Cascades,
    /// Rays from every cell. Few rays are noisy.
    Raymarch,
    /// Shadow maps of lamps, with range and falloff. Emissive matter does not light anything.
    Polar,
    /// Light that spreads from cell to cell over several frames. A visual style, not physically based.
    Flood,
}

/// Speed against accuracy ([`lamplight::Quality`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LightQuality {
    /// `Default`, unless the light of a camera takes longer than 8 ms, half of a frame at 60 Hz: then `Fast`, and if that
    /// takes a GPU longer than a whole frame, `Coarse`, until another quality is set or the camera goes. Pictures differ a
    /// little from device to device.
    Auto,
    /// For large views on weak GPUs: under half of the memory traffic of `Fast`, and softer shadows, with
    /// [`LightMethod::Holographic`]. Other methods are as with `Fast`.
    Coarse,
    /// For weak GPUs: half the time, slightly softer shadows, and faint rays around small lights.
    Fast,
    /// For games.
    #[default]
    Default,
    /// Less error, several times the time.
    High,
    /// The method as its source published it, for comparison.
    Paper,
}

impl From<LightQuality> for Quality {
    fn from(quality: LightQuality) -> Self {
        match quality {
            LightQuality::Coarse => Self::Coarse,
            LightQuality::Fast => Self::Fast,
            // Cameras make it `Fast` or `Coarse` if they have to.
            LightQuality::Auto | LightQuality::Default => Self::Default,
            LightQuality::High => Self::High,
            LightQuality::Paper => Self::Paper,
        }
    }
}

impl LightMethod {
    /// Returns true if the method lights all lamps by rule. For others, lamps are discs that glow.
    pub(crate) fn lights_by_rule(self) -> bool {
        Method::from(self).lights_lamps()
    }
}

impl From<LightMethod> for Method {
    fn from(method: LightMethod) -> Self {
        match method {
            LightMethod::Holographic => Self::Holographic,
            LightMethod::Cascades => Self::Cascades,
            LightMethod::Raymarch => Self::Raymarch,
            LightMethod::Polar => Self::Polar,
            LightMethod::Flood => Self::Flood,
        }
    }
}

/// The bounces of light off walls and fog ([`lamplight::Bounces`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum LightBounces {
    /// At most this many, 0 to 256. 0 is direct light only.
    Count(u32),
    /// Until the largest change is under 0.1 % of the mean.
    Converged,
    /// One more each frame, from the light of the frame before. It costs hardly more than direct light, and while
    /// nothing moves it grows to the same light as `Converged`.
    #[default]
    Feedback,
}

impl From<LightBounces> for Bounces {
    fn from(bounces: LightBounces) -> Self {
        match bounces {
            LightBounces::Count(count) => Self::Count(count),
            LightBounces::Converged => Self::Converged,
            LightBounces::Feedback => Self::Feedback,
        }
    }
}

/// The size of the square cells that light is computed on. Half the size costs four times as much.
/// Light may leak through matter that is thinner than a cell.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum CellSize {
    /// Cells per logical pixel of the screen, 0.05 to 2. The size in the world is rounded to a power of
    /// two, so that light does not change while the camera zooms, except once per doubling.
    Screen(f32),
    /// World units per cell, at any zoom. 1 with [`LightFilter::Nearest`] aligns light with pixel art.
    World(f32),
}

impl Default for CellSize {
    fn default() -> Self {
        Self::Screen(0.5)
    }
}

/// The tone map. The light of several lamps may add up to more than a screen can show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LightToneMap {
    /// The camera's own `Tonemapping`, which Bevy applies after bloom, or `Vivid` if the camera has none.
    #[default]
    Camera,
    /// None. Light above 1 is clipped unless a later pass uses it.
    Off,
    /// `v / (1 + v)` per channel.
    Reinhard,
    /// Narkowicz's fit of the ACES curve (2015). [`Unlit2d`](crate::Unlit2d) entities keep their colours,
    /// as with every tone map except the camera's own.
    Aces,
    /// AgX, in which bright colours keep their hue longer than in `Aces`.
    Agx,
    /// AgX with more contrast and stronger colours.
    Vivid,
}

impl LightToneMap {
    /// Converts to the tone map of `lamplight`. `has_own`: whether the camera has a `Tonemapping`.
    pub(crate) fn for_camera(self, has_own: bool) -> ToneMap {
        match self {
            Self::Camera if has_own => ToneMap::None,
            Self::Off => ToneMap::None,
            Self::Reinhard => ToneMap::Reinhard,
            Self::Aces => ToneMap::Aces,
            Self::Agx => ToneMap::Agx,
            Self::Camera | Self::Vivid => ToneMap::Vivid,
        }
    }
}

/// Interpolation of light between cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LightFilter {
    /// Bilinear.
    #[default]
    Linear,
    /// None: each pixel has the light of its cell.
    Nearest,
}

/// Writes the light of a camera with [`Lighting2d`] to a texture for your own passes. In the render world
/// it is the component [`ViewLightTexture`](crate::render::ViewLightTexture) of the camera's entity.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct LightTexture2d;
