//! Preferred light and display settings of a world or a picture.

use lamplight::{Bounces, Display, Settings, SettingsTable};

/// The settings that belong to a picture. The caller chooses the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Bounces of light. Those of a world grow from frame to frame.
    pub bounces: Bounces,
    /// Depth to which light penetrates walls, px.
    pub wall_depth: f32,
    /// The elevation of light at surfaces with normals, radians.
    pub elevation: f32,
    /// Tone map and exposure.
    pub display: Display,
}

impl Default for Look {
    fn default() -> Self {
        let (elevation, display) = (Settings::ELEVATION, Display::default());
        Self { bounces: Bounces::Feedback, wall_depth: 0.0, elevation, display }
    }
}

impl Look {
    /// Scales to a layout that is drawn with `unit` cells per px.
    #[must_use]
    pub fn at_scale(self, unit: f32) -> Self {
        Self { wall_depth: (self.wall_depth * unit).clamp(0.0, Settings::MAX_WALL_DEPTH), ..self }
    }

    /// Converts to settings of a solver; the others are defaults.
    pub fn settings(&self) -> Settings {
        Settings {
            bounces: self.bounces,
            wall_depth: self.wall_depth,
            elevation: self.elevation,
            ..Settings::default()
        }
    }

    /// Converts to the table `[light]` of a scene file, which is for a single picture: light that grows over frames is
    /// written as all of it.
    pub fn table(&self) -> SettingsTable {
        let mut table = SettingsTable::default();
        table.set("bounces", self.bounces.within_a_frame());
        table.set("wall_depth", self.wall_depth);
        if self.elevation != Settings::ELEVATION {
            table.set("elevation", self.elevation);
        }
        table
    }

    /// The look of a scene. All of its bounces, if it asks for them, come over frames here.
    pub fn of(settings: &Settings, display: Display) -> Self {
        let Settings { bounces, wall_depth, elevation, .. } = *settings;
        let bounces = match bounces {
            Bounces::Converged => Bounces::Feedback,
            bounces => bounces,
        };
        Self { bounces, wall_depth, elevation, display }
    }
}
