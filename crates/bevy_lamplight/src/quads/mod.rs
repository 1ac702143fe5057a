//! The scene around a camera: quads of matter, and lamps.
//!
//! Sprites, glyphs, slices, tiles, triangles of meshes and occluders all become [`Quad`]s. The render
//! world draws matter and normals from them ([`crate::render`]), and the CPU answers queries from them
//! ([`crate::query`]), so that both light the same scene.

mod gather;
mod masks;
mod material;
mod meshes;
mod occluders;
mod place;
mod quad;
mod scene;
mod source;
mod sprite_layout;
mod sprites;
mod surfaces;
mod texts;
mod tiles;

pub use gather::Gather;
pub use masks::GatherMasks;
pub use material::QuadMaterial;
pub use place::{SceneAssets, VisibilityPropagates};
pub use quad::{Quad, QuadMap, QuadShape};
pub use scene::{ExtractedScene, QuadGroup, is_within, overlaps};
pub use surfaces::GatherSurfaces;
