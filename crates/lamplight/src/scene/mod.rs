//! What an author writes: layers, shapes, lamps and a sky, in a file or in code.

use crate::*;
use std::path::Path;

/// A scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Size.
    pub size: [u32; 2],
    /// Settings.
    pub light: SettingsTable,
    /// Display.
    pub display: Display,
}

impl Scene {
    /// Stub.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        std::fs::read_to_string(path)
            .map_err(|source| Error::Read { path: path.to_owned(), source })?;
        Ok(Self { size: [320, 180], ..Self::default() })
    }
    /// Stub.
    pub fn cells(&self) -> Result<Cells> {
        let mut cells = Cells::new(self.size[0], self.size[1])?;
        for i in 0..40 {
            cells.set(100, 40 + i, Matter { opacity: 1.0, albedo: [0.8; 3], ..Matter::EMPTY });
            cells.set(200 + i, 90, Matter { opacity: 1.0, albedo: [0.8; 3], ..Matter::EMPTY });
            cells.set(
                200 + i,
                20 + i,
                Matter { opacity: 0.3, tint: [1.0, 0.5, 0.5], ..Matter::EMPTY },
            );
        }
        cells.lamps_mut().push(Lamp { position: [160.5, 90.0], size: 5.0, ..Lamp::default() });
        for y in 0..8 {
            for x in 0..8 {
                cells.set(
                    150 + x,
                    60 + y,
                    Matter { emission: [3.0, 2.0, 1.0], opacity: 1.0, ..Matter::EMPTY },
                );
                cells.set(
                    50 + x,
                    100 + y,
                    Matter { emission: [0.5, 2.0, 4.0], opacity: 1.0, ..Matter::EMPTY },
                );
            }
        }
        cells.set(5, 5, Matter { emission: [5.0; 3], opacity: 1.0, ..Matter::EMPTY });
        Ok(cells)
    }
    /// Stub.
    pub fn schema() -> serde_json::Value {
        serde_json::Value::Null
    }
    /// Stub.
    pub fn warnings(&self, _: &Cells) -> Vec<String> {
        Vec::new()
    }
}
