//! Preferred light and display settings of a world or a picture.

use lamplight::{Bounces, Display, Settings, SettingsTable};

/// The settings that belong to a picture. The caller chooses the method.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// Number of bounces.
    pub bounces: u32,
    /// Depth to which light penetrates walls, px.
    pub wall_depth: f32,
    /// Tone map and exposure.
    pub display: Display,
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
            bounces: Bounces::Count(self.bounces),
            wall_depth: self.wall_depth,
            ..Settings::default()
        }
    }

    /// Converts to the table `[light]` of a scene file.
    pub fn table(&self) -> SettingsTable {
        let mut table = SettingsTable::default();
        table.set("bounces", self.bounces);
        table.set("wall_depth", self.wall_depth);
        table
    }

    /// The look of a scene.
    pub fn of(settings: &Settings, display: Display) -> Self {
        Self { bounces: settings.bounces.limit(), wall_depth: settings.wall_depth, display }
    }
}
