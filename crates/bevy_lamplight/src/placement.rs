//! Where the lit grid of a camera lies in the world.

use crate::components::{CellSize, LightMethod, Lighting2d};
use crate::pieces::Map;
use bevy::camera::{Camera, Projection};
use bevy::math::{Rect, Vec2, Vec3};
use bevy::prelude::GlobalTransform;
use lamplight_wgpu::{Placed, View};

/// A grid over the world: cells of some world units, that stay where they are while the camera
/// moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World units a cell.
    pub cell: f32,
    /// Which cells, and what of them is seen.
    pub placed: Placed,
}

/// Most cells that are lit for a camera. Larger grids get larger cells.
const MOST_CELLS: u64 = 1 << 22;
/// Steps in which grids grow, so that a camera that zooms seldom makes buffers anew.
const STEP: u32 = 32;
/// Cells after which methods that find light on planes or probes do the same again.
pub const LATTICE: u32 = 16;

/// Ever larger cells to choose from where a grid of a size would have too many.
pub fn doubled(cell: f32) -> impl Iterator<Item = f32> {
    /// Beyond, nothing of a world is left.
    const MOST_DOUBLINGS: i32 = 32;
    (0..MOST_DOUBLINGS).map(move |doublings| cell * 2f32.powi(doublings))
}

impl Placement {
    /// Where what a camera sees lies, with the border round it.
    ///
    /// None where it sees nothing: a window of no size, a transform that is no number, a camera that
    /// is not orthographic.
    pub fn of(
        camera: &Camera,
        projection: &Projection,
        transform: &GlobalTransform,
        lighting: &Lighting2d,
    ) -> Option<Self> {
        let Projection::Orthographic(orthographic) = projection else { return None };
        let pixels = camera.logical_viewport_size()?;
        let world = transform.affine();
        let right = world.transform_vector3(Vec3::X).truncate();
        let up = world.transform_vector3(Vec3::Y).truncate();
        let area = orthographic.area;
        let middle = transform.transform_point(area.center().extend(0.0)).truncate();
        let extent = area.size() * Vec2::new(right.length(), up.length());
        if !(middle.is_finite() && pixels.min_element() >= 1.0 && extent.min_element() > 0.0) {
            return None;
        }
        // Neither cells nor lattice nor step change what is found at a place of the world.
        let cell = match lighting.cells {
            CellSize::World(size) => size,
            CellSize::Screen(share) => {
                (extent.y / pixels.y / share.clamp(0.05, 2.0)).log2().round().exp2()
            }
        };
        if !(cell > 0.0 && cell.is_finite()) {
            return None;
        }
        for cell in doubled(cell) {
            let [x, y] = (middle / cell).to_array().map(f64::from);
            let view = View {
                position: [x, -y],
                border: (lighting.border / cell).ceil().max(0.0) as u32,
                lattice: match lighting.method {
                    LightMethod::Holographic | LightMethod::Cascades => LATTICE,
                    LightMethod::Raymarch | LightMethod::Polar | LightMethod::Flood => 1,
                },
                // The grid's y points down.
                rotation: -f64::from(right.to_angle()),
                step: STEP,
                ..View::default()
            };
            let columns_rows = (extent / cell).to_array().map(f64::from);
            if let Ok(placed) = view.cover(columns_rows) {
                let [width, height] = placed.size.map(u64::from);
                if width * height <= MOST_CELLS {
                    return Some(Self { cell, placed });
                }
            } else if middle.abs().max_element() / cell > 1e9 {
                return None;
            }
        }
        None
    }

    /// The place in the world of the grid's left and top.
    pub fn corner(&self) -> Vec2 {
        let [x, y] = self.placed.origin.map(|v| v as f32 * self.cell);
        Vec2::new(x, -y)
    }

    /// Where something of the world lies on the grid, in cells and y down.
    pub fn on_grid(&self, map: &Map) -> Map {
        let corner = self.corner();
        let cells = |[x, y]: [f32; 2]| [x / self.cell, -y / self.cell];
        let Map { x_axis, y_axis, origin: [x, y] } = *map;
        let origin = cells([x - corner.x, y - corner.y]);
        Map { x_axis: cells(x_axis), y_axis: cells(y_axis), origin }
    }

    /// What the grid covers.
    pub fn area(&self) -> Rect {
        let [width, height] = self.placed.size.map(|v| v as f32 * self.cell);
        let corner = self.corner();
        Rect { min: corner - Vec2::new(0.0, height), max: corner + Vec2::new(width, 0.0) }
    }
}
