//! The methods, and the settings of one of them.

use super::preset::no_preset;
use super::raymarch::Hit;
use super::{Bounces, Cascades, Flood, Holographic, Polar, Raymarch, Variant};
use crate::{Cells, Error, Lamp, Result, Sun};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A method of computing light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Method {
    /// Rays from every pixel, by jump flood and distance field or from cell to cell (Bigos 2020).
    Raymarch,
    /// Rays drawn into a grid of energy, a bounce, and many blurs; the energy persists between frames
    /// (tmpvar 2019). A look, not physics.
    Flood,
    /// A polar shadow map per lamp, in which every pixel looks up its ray (Griffis). Lamps only.
    Polar,
    /// Radiance cascades: near probes with few rays, far ones with many (Sannikov 2023).
    Cascades,
    /// Holographic radiance cascades: long rays composed of shorter ones (Freeman, Sannikov and
    /// Margel 2025).
    #[default]
    Holographic,
}

impl Method {
    /// All methods, in the order of lists and tables.
    pub const ALL: &'static [Self] =
        &[Self::Raymarch, Self::Flood, Self::Polar, Self::Cascades, Self::Holographic];

    /// The name in files, flags and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Raymarch => "raymarch",
            Self::Flood => "flood",
            Self::Polar => "polar",
            Self::Cascades => "cascades",
            Self::Holographic => "holographic",
        }
    }

    /// Names of the method's presets, for its key `preset`; the first is the default.
    pub fn presets(self) -> &'static [&'static str] {
        match self {
            Self::Raymarch => Raymarch::PRESETS,
            Self::Flood => Flood::PRESETS,
            Self::Polar => Polar::PRESETS,
            Self::Cascades => Cascades::PRESETS,
            Self::Holographic => Holographic::PRESETS,
        }
    }

    /// Returns whether the method lights lamps by rule: with their range, falloff and cone. The other
    /// methods draw lamps as glowing discs.
    pub fn lights_lamps(self) -> bool {
        matches!(self, Self::Flood | Self::Polar)
    }

    /// Returns whether the direct light of a lamp is found exactly, beside the light of the method.
    pub fn lights_exactly(self, lamp: &Lamp) -> bool {
        match self {
            Self::Polar => false,
            // Its rays only brighten, and light flows from layer to layer.
            Self::Flood => !lamp.shines_as_matter(),
            Self::Raymarch | Self::Cascades | Self::Holographic => lamp.is_exact(),
        }
    }

    /// Returns whether the direct light of a sun is found exactly, not as part of the sky.
    pub fn shines_exactly(self, sun: &Sun) -> bool {
        self.lights_lamps() || sun.is_exact()
    }

    /// Rejects a scene that the method cannot light: `polar` needs a lamp or a sun.
    pub fn suits(self, cells: &Cells) -> Result<()> {
        if self != Self::Polar || !(cells.lamps().is_empty() && cells.suns().is_empty()) {
            return Ok(());
        }
        let problem = "lights lamps only, and this scene has none; add a [[lamp]], or choose another \
                       method";
        Err(Error::Unsuited { method: self.name(), problem })
    }
}

/// One method with its own settings.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MethodSettings {
    /// [`Method::Raymarch`].
    Raymarch(Raymarch),
    /// [`Method::Flood`].
    Flood(Flood),
    /// [`Method::Polar`].
    Polar(Polar),
    /// [`Method::Cascades`].
    Cascades(Cascades),
    /// [`Method::Holographic`].
    Holographic(Holographic),
}

impl MethodSettings {
    /// Returns a preset of a method ([`Method::presets`]).
    ///
    /// # Errors
    /// Fails if the method has no preset of this name.
    pub fn preset(method: Method, name: &str) -> Result<Self> {
        let found = match method {
            Method::Raymarch => Raymarch::preset(name).map(Self::Raymarch),
            Method::Flood => Flood::preset(name).map(Self::Flood),
            Method::Polar => Polar::preset(name).map(Self::Polar),
            Method::Cascades => Cascades::preset(name).map(Self::Cascades),
            Method::Holographic => Holographic::preset(name).map(Self::Holographic),
        };
        found.ok_or_else(|| no_preset(method.name(), name, method.presets()))
    }

    /// Returns whether the method reads the glow of cells. Where it does not, lamps that are drawn are solid
    /// discs: `raymarch` with `hit = "distance"`, as in its sources.
    pub fn reads_glow(&self) -> bool {
        match self {
            Self::Raymarch(raymarch) => raymarch.hit == Hit::Edge,
            Self::Polar(_) => false,
            Self::Flood(_) | Self::Cascades(_) | Self::Holographic(_) => true,
        }
    }

    /// Rejects a method that does not read [`Inflow`](crate::Inflow): a part of a world would be lit alone.
    ///
    /// # Errors
    /// Fails if it is one.
    pub fn takes_inflow(&self) -> Result<()> {
        let problem = match self {
            Self::Raymarch(_) | Self::Cascades(_) => return Ok(()),
            Self::Holographic(settings) if settings.variant != Variant::Paper => return Ok(()),
            Self::Holographic(_) => {
                "as its paper has it knows no light from beyond a grid; choose another quality than paper, or \
                 raymarch or cascades"
            }
            Self::Polar(_) | Self::Flood(_) => {
                "knows no light from beyond a grid; choose raymarch, cascades or holographic"
            }
        };
        Err(Error::Unsuited { method: self.method().name(), problem })
    }

    /// Returns the bounces that the method makes where some are `wanted`: the published variant of `holographic` has
    /// no feedback, and makes all bounces in each frame instead.
    pub fn bounces(&self, wanted: Bounces) -> Bounces {
        match self {
            Self::Holographic(settings) if settings.variant == Variant::Paper => {
                wanted.within_a_frame()
            }
            _ => wanted,
        }
    }

    /// Draws lamps into cells as the method reads them, unless it lights them by rule.
    pub fn draw_lamps(&self, cells: &mut Cells) {
        if self.method().lights_lamps() {
            return;
        }
        if !self.reads_glow() {
            cells.lamps_mut().iter_mut().for_each(|lamp| lamp.solid = true);
        }
        cells.draw_lamps();
    }

    /// The method.
    pub fn method(&self) -> Method {
        match self {
            Self::Raymarch(_) => Method::Raymarch,
            Self::Flood(_) => Method::Flood,
            Self::Polar(_) => Method::Polar,
            Self::Cascades(_) => Method::Cascades,
            Self::Holographic(_) => Method::Holographic,
        }
    }

    /// Rejects values out of their range.
    pub(super) fn check(&self) -> Result<()> {
        match self {
            Self::Raymarch(settings) => settings.check(),
            Self::Flood(settings) => settings.check(),
            Self::Polar(settings) => settings.check(),
            Self::Cascades(settings) => settings.check(),
            Self::Holographic(settings) => settings.check(),
        }
    }
}

impl Default for MethodSettings {
    fn default() -> Self {
        Method::default().into()
    }
}

/// The default settings of a method.
impl From<Method> for MethodSettings {
    fn from(method: Method) -> Self {
        match method {
            Method::Raymarch => Raymarch::default().into(),
            Method::Flood => Flood::default().into(),
            Method::Polar => Polar::default().into(),
            Method::Cascades => Cascades::default().into(),
            Method::Holographic => Holographic::default().into(),
        }
    }
}

/// Conversions between [`MethodSettings`] and the settings of each method.
macro_rules! variants {
    ($($method:ident: $get:ident, $get_mut:ident;)*) => {
        impl MethodSettings {
            $(
                #[doc = concat!("The settings of [`Method::", stringify!($method), "`], if that is the method.")]
                pub fn $get(&self) -> Option<&$method> {
                    match self {
                        Self::$method(settings) => Some(settings),
                        _ => None,
                    }
                }

                #[doc = concat!("Like [`Self::", stringify!($get), "`], as a mutable reference.")]
                pub fn $get_mut(&mut self) -> Option<&mut $method> {
                    match self {
                        Self::$method(settings) => Some(settings),
                        _ => None,
                    }
                }
            )*
        }

        $(
            impl From<$method> for MethodSettings {
                fn from(settings: $method) -> Self {
                    Self::$method(settings)
                }
            }
        )*
    };
}

variants! {
    Raymarch: as_raymarch, as_raymarch_mut;
    Flood: as_flood, as_flood_mut;
    Polar: as_polar, as_polar_mut;
    Cascades: as_cascades, as_cascades_mut;
    Holographic: as_holographic, as_holographic_mut;
}
