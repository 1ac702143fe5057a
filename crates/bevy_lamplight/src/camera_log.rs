//! Messages about cameras, in the log.

use bevy::log::{error, warn};
use bevy::platform::collections::HashSet;
use bevy::prelude::Entity;
use std::fmt::Display;

/// Logs each message once per camera.
#[derive(Default)]
pub struct CameraLog(HashSet<(Entity, String)>);

impl CameraLog {
    /// Logs why a camera is not lit.
    pub fn error(&mut self, camera: Entity, message: impl Display) {
        if self.is_new(camera, &message) {
            error!("the camera {camera} is not lit: {message}");
        }
    }

    /// Logs why no light enters the grid of a camera.
    pub fn no_inflow(&mut self, camera: Entity, message: impl Display) {
        if self.is_new(camera, &message) {
            error!("the camera {camera} has no light from around its grid: {message}");
        }
    }

    /// Logs a warning about a camera.
    pub fn warn(&mut self, camera: Entity, message: impl Display) {
        if self.is_new(camera, &message) {
            warn!("the camera {camera}: {message}");
        }
    }

    /// Remembers a message. Returns `false` if it was logged before, with whatever figures.
    fn is_new(&mut self, camera: Entity, message: impl Display) -> bool {
        self.0.insert((camera, without_figures(message)))
    }
}

/// Returns what a message says, whatever its figures.
pub fn without_figures(message: impl Display) -> String {
    message.to_string().replace(|c: char| c.is_ascii_digit() || c == '.', "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_logged_once_per_camera_whatever_its_figures() {
        let mut log = CameraLog::default();
        let [first, second] = [1, 2].map(|i| Entity::from_raw_u32(i).unwrap());
        assert!(log.is_new(first, "exposure is 33, not below 32"));
        assert!(!log.is_new(first, "exposure is 34.5, not below 32"));
        assert!(log.is_new(first, "wall_depth is 33, not below 32"));
        assert!(log.is_new(second, "exposure is 33, not below 32"));
    }
}
