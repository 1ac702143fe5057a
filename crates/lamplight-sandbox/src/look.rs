//! How a world or a picture asks to be lit and shown.

use lamplight::{Bounces, Display, Settings, SettingsTable};

/// The few settings that belong to a picture; the method is the choice of whoever lights it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// How often light is sent on.
    pub bounces: u32,
    /// px that light sinks into walls.
    pub wall_depth: f32,
    /// Tone map and exposure.
    pub display: Display,
}

impl Look {
    /// The deepest that light may sink into walls.
    const DEEPEST: f32 = 64.0;

    /// The same for a layout drawn `unit` cells to its px.
    #[must_use]
    pub fn at_scale(self, unit: f32) -> Self {
        Self { wall_depth: (self.wall_depth * unit).clamp(0.0, Self::DEEPEST), ..self }
    }

    /// As settings for a solver, the rest at their defaults.
    pub fn settings(&self) -> Settings {
        Settings {
            bounces: Bounces::Count(self.bounces),
            wall_depth: self.wall_depth,
            ..Settings::default()
        }
    }

    /// As a scene file has them under `[light]`.
    pub fn table(&self) -> SettingsTable {
        let mut table = SettingsTable::default();
        table.set("bounces", self.bounces);
        table.set("wall_depth", self.wall_depth);
        table
    }

    /// What a scene's settings and display come to.
    pub fn of(settings: &Settings, display: Display) -> Self {
        Self { bounces: settings.bounces.limit(), wall_depth: settings.wall_depth, display }
    }
}
