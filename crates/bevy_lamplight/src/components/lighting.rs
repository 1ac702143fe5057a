//! How a camera's picture is lit.

use bevy::camera::Hdr;
use bevy::prelude::*;
use lamplight::{Method, Settings, SettingsTable, ToneMap};

/// Lights what a 2D camera sees.
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # fn system(mut commands: Commands) {
/// commands.spawn((Camera2d, Lighting2d::default()));
/// # }
/// ```
///
/// Every length is in world units, so that light does not change when the camera zooms.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Hdr)]
pub struct Lighting2d {
    /// How light is found.
    pub method: LightMethod,
    /// A preset of the method by its name, such as `"fast"` or `"quality"` of `holographic`
    /// ([`lamplight::Method::presets`]); empty: the method's default.
    pub preset: String,
    /// Other settings of the method as `lamplight`'s command line writes them, laid over the preset:
    /// `"raymarch.rays=64"`. Not those that have a field here.
    pub set: Vec<String>,
    /// How often walls and fog send light on. Each time costs one more pass over them.
    pub bounces: LightBounces,
    /// How large the cells are on which light is found.
    pub cells: CellSize,
    /// World units beyond the screen from which matter still lights it and throws shadows on it.
    /// Higher: nothing pops up at the edge; costs as much as so much more screen.
    pub border: f32,
    /// World units that light sinks into solid walls, so that they are seen and not black. Costs
    /// next to nothing.
    pub wall_depth: f32,
    /// Stops by which the picture is brightened; 1 doubles its light.
    pub exposure: f32,
    /// How light above 1 is brought back to what a screen shows.
    pub tone_map: LightToneMap,
    /// How light is shown between the cells it was found on.
    pub filter: LightFilter,
}

impl Default for Lighting2d {
    fn default() -> Self {
        Self {
            method: LightMethod::default(),
            preset: String::new(),
            set: Vec::new(),
            bounces: LightBounces::Count(1),
            cells: CellSize::default(),
            border: 64.0,
            wall_depth: 24.0,
            exposure: 0.0,
            tone_map: LightToneMap::default(),
            filter: LightFilter::default(),
        }
    }
}

impl Lighting2d {
    /// The same settings with another preset.
    #[must_use]
    pub fn with_preset(mut self, name: impl Into<String>) -> Self {
        self.preset = name.into();
        self
    }

    /// What the library is told, for cells of so many world units.
    pub(crate) fn settings(&self, cell: f32) -> lamplight::Result<Settings> {
        let mut table = SettingsTable::default();
        let method: Method = self.method.into();
        table.set("method", method.name());
        if !self.preset.is_empty() {
            table.set(&format!("{}.preset", method.name()), self.preset.as_str());
        }
        match self.bounces {
            LightBounces::Count(count) => table.set("bounces", count),
            LightBounces::Converged => table.set("bounces", "converged"),
        }
        for text in &self.set {
            let key = text.split('=').next().unwrap_or_default().trim();
            if ["method", "bounces", "wall_depth"].contains(&key) {
                let expected = "another setting: `Lighting2d` has a field for this one";
                return Err(lamplight::Error::value("set", format!("{text:?}"), expected));
            }
            table.set_from_text(text)?;
        }
        let mut settings = table.resolve()?;
        /// As deep as the library lets light sink, px.
        const DEEPEST: f32 = 64.0;
        settings.wall_depth = (self.wall_depth / cell).clamp(0.0, DEEPEST);
        settings.check()?;
        Ok(settings)
    }
}

/// How light is found ([`lamplight::Method`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum LightMethod {
    /// Rays made from shorter rays: no noise, the same cost however much light and matter there is.
    #[default]
    Holographic,
    /// Probes near with few rays, far with many. Cheaper, softer.
    Cascades,
    /// Rays from every cell; grain where there are few.
    Raymarch,
    /// Shadows of lamps alone, with range and falloff; nothing that glows lights anything.
    Polar,
    /// Energy that spreads from frame to frame. A look, not physics.
    Flood,
}

impl LightMethod {
    /// Whether it lights lamps by rule; for the others they are discs that glow.
    pub(crate) fn lights_lamps(self) -> bool {
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

/// How often light is sent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum LightBounces {
    /// At most this many times, 0 to 256; 0 is direct light only.
    Count(u32),
    /// Until the largest change is under 0.1 % of the mean.
    Converged,
}

/// How large the square cells are on which light is found. Half the size costs four times as much.
/// Matter thinner than a cell may fall between two.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum CellSize {
    /// So many cells to a logical pixel of the screen, 0.05 to 2. The size in the world is rounded
    /// to a power of two, so that light stays as it is while the camera zooms, but for one step
    /// each time it has zoomed to twice or half.
    Screen(f32),
    /// So many world units a cell, whatever the zoom. 1 with [`LightFilter::Nearest`] puts light on
    /// the grid of pixel art.
    World(f32),
}

impl Default for CellSize {
    fn default() -> Self {
        Self::Screen(0.5)
    }
}

/// How light above 1 is brought back to what a screen shows: lamps add up to more than that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum LightToneMap {
    /// By the camera's own `Tonemapping` where it has one, which comes after bloom, and `Aces` where
    /// it has none.
    #[default]
    Camera,
    /// Not at all: what is above 1 is cut off unless a later pass needs it.
    Off,
    /// `v / (1 + v)`, channel by channel.
    Reinhard,
    /// Narkowicz's fit of the ACES curve (2015). What is [`Unlit2d`](crate::Unlit2d) keeps its
    /// colours, as under all but the camera's own.
    Aces,
    /// AgX, which turns bright colours paler than `Aces` does.
    Agx,
}

impl LightToneMap {
    /// What the library is told, for a camera that has a tone map of its own or not.
    pub(crate) fn for_camera(self, has_own: bool) -> ToneMap {
        match self {
            Self::Camera if has_own => ToneMap::None,
            Self::Off => ToneMap::None,
            Self::Reinhard => ToneMap::Reinhard,
            Self::Camera | Self::Aces => ToneMap::Aces,
            Self::Agx => ToneMap::Agx,
        }
    }
}

/// How light is shown between cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum LightFilter {
    /// Smooth.
    #[default]
    Linear,
    /// Each pixel has the light of the cell it lies in.
    Nearest,
}

/// On a camera with [`Lighting2d`]: its light is written to a texture for passes of your own, which
/// find it in the render world as [`ViewLightTexture`](crate::render::ViewLightTexture) on the
/// camera's entity.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct LightTexture2d;
