//! Components that users add to entities.

mod cookie;
mod lamps;
mod lighting;
mod mask;
mod matter;
mod normals;
mod sun;
mod viewer;

pub use cookie::LightCookie2d;
pub use lamps::{AmbientLight2d, Falloff2d, Panorama2d, PointLight2d, Sky2d, SpotLight2d};
pub(crate) use lamps::{BRIGHTEST, WorldLamp};
pub use lighting::{
    CellSize, LightBounces, LightFilter, LightMethod, LightQuality, LightTexture2d, LightToneMap,
    Lighting2d,
};
pub use mask::LightMask2d;
pub use matter::{LightOccluder2d, Matter2d, OccluderShape, Unlit2d};
pub use normals::{NormalMap2d, NormalY, Relief2d};
pub use sun::SunLight2d;
pub use viewer::Viewer2d;
