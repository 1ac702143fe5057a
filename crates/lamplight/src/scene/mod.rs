//! What an author writes: layers, shapes, lamps and a sky, in a file or in code.

/// A scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {}
