//! The settings of a solver.

use super::file::SettingsFile;
use super::range::{MAX_WALL_DEPTH, WALL_DEPTH, within};
use super::{Bounces, Method, MethodSettings, Quality, Raymarch};
use crate::{Result, elevation};
use serde::{Deserialize, Serialize};

/// The settings of a solver: one method with its own settings, and the settings that all methods
/// share.
///
/// ```
/// use lamplight::settings::{Bounces, Method, Raymarch, Settings};
///
/// let cascades = Settings::new(Method::Cascades);
/// let noisy = Settings {
///     bounces: Bounces::Count(2),
///     ..Settings::new(Raymarch { rays: 8, ..Raymarch::default() })
/// };
/// assert_eq!(noisy.method(), Method::Raymarch);
/// # assert_ne!(cascades, noisy);
/// ```
///
/// In files and flags, the same settings are a [`SettingsTable`](super::SettingsTable), which may have
/// tables of several methods. `serde` writes a `Settings` in that form, with the table of its method
/// only.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "SettingsFile", into = "SettingsFile")]
pub struct Settings {
    /// The method with its settings.
    pub method: MethodSettings,
    /// Maximum number of bounces of light off walls and fog, 0 to 256, by default 2; 0 is direct light
    /// only. Each bounce costs one more gather over the faces that reflect and the media that scatter. `polar`
    /// has no bounces, and `flood` has a setting of its own
    /// ([`Flood::bounce_rays`](super::Flood::bounce_rays)).
    pub bounces: Bounces,
    /// Depth in px, 0 to 64, over which light fades into solid walls, so that they are visible; by default
    /// 24. With 0, only solid cells that touch an open cell are lit. The cost is negligible.
    pub wall_depth: f32,
    /// Seed of all random numbers. The same seed gives the same bytes.
    pub seed: u64,
    /// True if the first moment of light is found beside the light itself ([`Light::moment`](crate::Light::moment)), for
    /// up to a quarter more time. Cells with normals have it found in any case.
    pub moment: bool,
    /// The elevation above the plane at which light arrives at tilted surfaces ([`Relief`](crate::Relief)), radians, 0.05
    /// to 1.5, by default π/4; lamps with a height and suns may have their own. Lower: stronger relief, with darker
    /// slopes.
    pub elevation: f32,
}

impl Settings {
    /// The largest `wall_depth`, px.
    pub const MAX_WALL_DEPTH: f32 = MAX_WALL_DEPTH;
    /// The default `elevation`, radians.
    pub const ELEVATION: f32 = elevation::DEFAULT;

    /// Returns settings with this method, and the defaults of what all methods share. A
    /// [`Method`] stands for the default settings of that method.
    pub fn new(method: impl Into<MethodSettings>) -> Self {
        Self {
            method: method.into(),
            bounces: Bounces::default(),
            wall_depth: WALL_DEPTH,
            seed: 0,
            moment: false,
            elevation: Self::ELEVATION,
        }
    }

    /// Returns settings for direct light alone, as the method finds it: no bounces, walls that are lit on
    /// their faces only, and no blur after `raymarch`.
    pub fn direct(method: impl Into<MethodSettings>) -> Self {
        let mut settings =
            Self { bounces: Bounces::Count(0), wall_depth: 0.0, ..Self::new(method) };
        if let Some(raymarch) = settings.method.as_raymarch_mut() {
            raymarch.denoise.passes = 0;
        }
        settings
    }

    /// The method.
    pub fn method(&self) -> Method {
        self.method.method()
    }

    /// Returns whether all frames of a static scene are identical: no noise, no history, no feedback.
    pub fn repeats(&self) -> bool {
        match self.method() {
            Method::Polar => true,
            Method::Cascades | Method::Holographic => {
                self.method.bounces(self.bounces) != Bounces::Feedback
            }
            Method::Raymarch | Method::Flood => false,
        }
    }

    /// Returns whether frames with other settings can continue what frames with these left. Of `holographic` and
    /// `cascades` that is the radiance that surfaces reflect, which their own settings hardly change; of the others it is
    /// light itself. What comes after the light has no part in it, nor has the moment.
    pub(crate) fn is_continued_by(&self, next: &Self) -> bool {
        let leaves_surfaces = match (&self.method, &next.method) {
            (MethodSettings::Holographic(before), MethodSettings::Holographic(next)) => {
                before.variant == next.variant
            }
            (MethodSettings::Cascades(_), MethodSettings::Cascades(_)) => true,
            _ => false,
        };
        let Self { wall_depth, seed, moment, elevation, .. } = *next;
        let same = Self { wall_depth, seed, moment, elevation, ..self.clone() };
        leaves_surfaces || same == *next
    }

    /// Returns the cheapest settings that produce the same seed map, Voronoi map and distance field.
    #[must_use]
    pub fn fields_only(&self) -> Self {
        // Of all settings they depend on this one; a ray is the least that a frame can have.
        let threshold = self.seed_threshold();
        Self::new(Raymarch { rays: 1, threshold, ..Raymarch::default() })
    }

    /// Opacity above which a cell is occupied in the seed map.
    pub(crate) fn seed_threshold(&self) -> f32 {
        let neutral = Raymarch::default();
        self.method.as_raymarch().unwrap_or(&neutral).threshold
    }

    /// Replaces the settings of the current method by one of its presets ([`Method::presets`]). The
    /// temporal accumulation of `raymarch` keeps its settings.
    ///
    /// # Errors
    /// Fails, and changes nothing, if the method has no preset of this name.
    pub fn set_preset(&mut self, name: &str) -> Result<()> {
        let mut preset = MethodSettings::preset(self.method(), name)?;
        if let (MethodSettings::Raymarch(new), MethodSettings::Raymarch(old)) =
            (&mut preset, &self.method)
        {
            new.temporal.clone_from(&old.temporal);
        }
        self.method = preset;
        Ok(())
    }

    /// Replaces the settings of the current method by its preset at a quality level, as
    /// [`Self::set_preset`] does.
    pub fn set_quality(&mut self, quality: Quality) -> Result<()> {
        self.set_preset(quality.preset(self.method()))
    }

    /// Rejects values out of their range.
    pub fn check(&self) -> Result<()> {
        within("bounces", self.bounces.limit(), 0..=Bounces::MAX)?;
        within("wall_depth", self.wall_depth, 0.0..=Self::MAX_WALL_DEPTH)?;
        within("elevation", self.elevation, elevation::OF_LIGHT)?;
        self.method.check()
    }

    /// Reads a file's settings; values out of their range are rejected in tables of other methods too.
    pub(super) fn from_file(file: SettingsFile) -> Result<Self> {
        for method in Method::ALL {
            Self::from(SettingsFile { method: *method, ..file.clone() }).check()?;
        }
        Ok(file.into())
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new(Method::default())
    }
}

impl From<SettingsFile> for Settings {
    fn from(file: SettingsFile) -> Self {
        let method = match file.method {
            Method::Raymarch => MethodSettings::Raymarch(Raymarch {
                temporal: file.temporal.unwrap_or_default(),
                denoise: file.denoise.unwrap_or_default(),
                ..file.raymarch.unwrap_or_default()
            }),
            Method::Flood => file.flood.unwrap_or_default().into(),
            Method::Polar => file.polar.unwrap_or_default().into(),
            Method::Cascades => file.cascades.unwrap_or_default().into(),
            Method::Holographic => file.holographic.unwrap_or_default().into(),
        };
        let SettingsFile { bounces, wall_depth, seed, moment, elevation, .. } = file;
        Self { method, bounces, wall_depth, seed, moment, elevation }
    }
}

impl From<Settings> for SettingsFile {
    fn from(settings: Settings) -> Self {
        let method = settings.method();
        let Settings { bounces, wall_depth, seed, moment, elevation, .. } = settings;
        let mut file =
            Self { method, bounces, wall_depth, seed, moment, elevation, ..Self::default() };
        match settings.method {
            MethodSettings::Raymarch(raymarch) => {
                file.temporal = Some(raymarch.temporal.clone());
                file.denoise = Some(raymarch.denoise.clone());
                file.raymarch = Some(raymarch);
            }
            MethodSettings::Flood(flood) => file.flood = Some(flood),
            MethodSettings::Polar(polar) => file.polar = Some(polar),
            MethodSettings::Cascades(cascades) => file.cascades = Some(cascades),
            MethodSettings::Holographic(holographic) => file.holographic = Some(holographic),
        }
        file
    }
}
