//! The four faces of a cell.

use crate::Rgb;

/// Unit normals of a cell's faces: left, right, top, bottom.
pub const NORMALS: [[i32; 2]; 4] = [[-1, 0], [1, 0], [0, -1], [0, 1]];

/// Irradiance or outgoing radiance of the four faces of a cell.
pub type Faces = [Rgb; 4];
