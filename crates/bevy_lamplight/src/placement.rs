//! The placement of a camera's lit grid in the world.

use crate::components::{CellSize, LightMethod, Lighting2d};
use crate::quads::QuadMap;
use bevy::camera::{Camera, Projection, SubCameraView};
use bevy::math::{Rect, Vec2, Vec3};
use bevy::prelude::GlobalTransform;
use lamplight_wgpu::{Camera2dView, GridPlacement, VisibleRect};

/// A grid over the world. Its cells stay in place while the camera moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World units per cell.
    pub cell: f32,
    /// World units per cell as configured. Smaller than `cell` if the grid would have had too many cells.
    pub requested: f32,
    /// The cells, and the part of them that the camera sees.
    pub placed: GridPlacement,
}

/// The largest number of cells of a camera's grid. Larger grids get larger cells.
pub const MAX_CELLS: u64 = 1 << 22;
/// Grid sizes are multiples of this, so that a camera that zooms rarely reallocates its buffers.
const STEP: u32 = 32;
/// The period, in cells, of methods that place planes or probes on a lattice.
pub const LATTICE: u32 = 16;

/// Sizes of cells to try in turn: `cell` and its doublings.
pub fn doubled(cell: f32) -> impl Iterator<Item = f32> {
    /// By then a cell is larger than any world.
    const MAX_DOUBLINGS: i32 = 32;
    (0..MAX_DOUBLINGS).map(move |doublings| cell * 2f32.powi(doublings))
}

/// The reason why a camera cannot be lit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlacementError {
    #[error("`Lighting2d` wants an orthographic projection")]
    Projection,
    #[error("its transform is not a number")]
    Transform,
    #[error("its `CellSize` comes to {0} world units; it has to be above 0")]
    Cell(f32),
    #[error("its `border` is {0}; it has to be 0 or more, and finite")]
    Border(f32),
    #[error(
        "what it sees is too large, or too far from the world's origin, for cells of {0} world units"
    )]
    TooFar(f32),
}

impl Placement {
    /// The placement of what a camera sees, with the border around it. `None` if it sees nothing, as in
    /// a window of size 0.
    pub fn new(
        camera: &Camera,
        projection: &Projection,
        transform: &GlobalTransform,
        lighting: &Lighting2d,
    ) -> Result<Option<Self>, PlacementError> {
        let Projection::Orthographic(orthographic) = projection else {
            return Err(PlacementError::Projection);
        };
        let border = lighting.border;
        if !(border >= 0.0 && border.is_finite()) {
            return Err(PlacementError::Border(border));
        }
        let Some(pixels) = camera.logical_viewport_size() else { return Ok(None) };
        let area = visible_area(orthographic.area, camera.sub_camera_view.as_ref());
        let world = transform.affine();
        let middle = world.transform_point3(area.center().extend(0.0)).truncate();
        // From left to right, and from bottom to top.
        let across = world.transform_vector3(Vec3::X * area.width()).truncate();
        let up = world.transform_vector3(Vec3::Y * area.height()).truncate();
        let extent = Vec2::new(across.length(), up.length());
        if !(middle.is_finite() && extent.is_finite()) {
            return Err(PlacementError::Transform);
        }
        if !(pixels.min_element() >= 1.0 && extent.min_element() > 0.0) {
            return Ok(None);
        }
        // Cells, lattice and step do not change the light at a place of the world.
        let requested = match lighting.cells {
            CellSize::World(size) => size,
            CellSize::Screen(density) => {
                (extent.y / pixels.y / density.clamp(0.05, 2.0)).log2().round().exp2()
            }
        };
        if !(requested > 0.0 && requested.is_finite()) {
            return Err(PlacementError::Cell(requested));
        }
        // A mirrored camera has the same grid.
        let level = across * across.x.signum();
        for cell in doubled(requested) {
            let position = (middle / cell).to_array().map(f64::from);
            let view = Camera2dView {
                position: [position[0], -position[1]],
                border: (border / cell).ceil() as u32,
                lattice: match lighting.method {
                    LightMethod::Holographic | LightMethod::Cascades => LATTICE,
                    LightMethod::Raymarch | LightMethod::Polar | LightMethod::Flood => 1,
                },
                // The grid's y points down.
                rotation: -f64::from(level.to_angle()),
                step: STEP,
                ..Camera2dView::default()
            };
            let columns_rows = (extent / cell).to_array().map(f64::from);
            let Ok(mut placed) = view.cover(columns_rows) else { continue };
            let [width, height] = placed.size.map(u64::from);
            if width * height <= MAX_CELLS {
                let on_grid = |v: Vec2| Vec2::new(v.x, -v.y) / cell;
                let (right, down) = (on_grid(across), on_grid(-up));
                let middle: [f64; 2] =
                    std::array::from_fn(|a| view.position[a] - f64::from(placed.origin[a]));
                let corner = Vec2::from(middle.map(|v| v as f32)) - 0.5 * (right + down);
                let (corner, right, down) = (corner.into(), right.into(), down.into());
                placed.visible = VisibleRect { corner, right, down };
                return Ok(Some(Self { cell, requested, placed }));
            }
        }
        Err(PlacementError::TooFar(requested))
    }

    /// The place in the world of the grid's top left corner.
    pub fn corner(&self) -> Vec2 {
        let [x, y] = self.placed.origin.map(|v| v as f32 * self.cell);
        Vec2::new(x, -y)
    }

    /// Converts a map from world units to cells, y down.
    pub fn on_grid(&self, map: &QuadMap) -> QuadMap {
        let corner = self.corner();
        let cells = |[x, y]: [f32; 2]| [x / self.cell, -y / self.cell];
        let QuadMap { x_axis, y_axis, origin: [x, y] } = *map;
        let origin = cells([x - corner.x, y - corner.y]);
        QuadMap { x_axis: cells(x_axis), y_axis: cells(y_axis), origin }
    }

    /// The area of the world that the grid covers.
    pub fn area(&self) -> Rect {
        let [width, height] = self.placed.size.map(|v| v as f32 * self.cell);
        let corner = self.corner();
        Rect { min: corner - Vec2::new(0.0, height), max: corner + Vec2::new(width, 0.0) }
    }
}

/// The part of a projection's area that a camera shows. As in Bevy, the width of the full view follows
/// from its height.
fn visible_area(area: Rect, part: Option<&SubCameraView>) -> Rect {
    let Some(SubCameraView { full_size, offset, size }) = part else { return area };
    let unit = area.height() / full_size.y as f32;
    let left = area.center().x - 0.5 * unit * full_size.x as f32;
    let left_top = Vec2::new(left, area.max.y) + unit * Vec2::new(offset.x, -offset.y);
    let size = unit * size.as_vec2();
    Rect::from_corners(left_top, left_top + Vec2::new(size.x, -size.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::camera::{OrthographicProjection, PerspectiveProjection, RenderTargetInfo};
    use bevy::math::UVec2;

    fn place(lighting: Lighting2d, at: Vec3) -> Result<Option<Placement>, PlacementError> {
        let mut camera = Camera::default();
        let physical_size = UVec2::new(320, 180);
        camera.computed.target_info = Some(RenderTargetInfo { physical_size, scale_factor: 1.0 });
        let mut projection = OrthographicProjection::default_2d();
        projection.area = Rect::from_center_size(Vec2::ZERO, Vec2::new(320.0, 180.0));
        let projection = Projection::Orthographic(projection);
        Placement::new(&camera, &projection, &GlobalTransform::from_translation(at), &lighting)
    }

    #[test]
    fn a_camera_that_cannot_be_lit_is_an_error_with_a_reason() {
        let default = Lighting2d::default;
        let placed = place(default(), Vec3::ZERO).unwrap().unwrap();
        assert_eq!((placed.cell, placed.requested), (2.0, 2.0));
        let cells = |cells| place(Lighting2d { cells, ..default() }, Vec3::ZERO);
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let why = cells(CellSize::World(bad)).unwrap_err().to_string();
            assert!(why.contains(&format!("{bad} world units")), "{why}");
        }
        assert!(matches!(cells(CellSize::Screen(f32::NAN)), Err(PlacementError::Cell(_))));
        assert_eq!(cells(CellSize::World(1e-30)), Err(PlacementError::TooFar(1e-30)));
        for border in [-1.0, f32::NAN, f32::INFINITY] {
            let refused = place(Lighting2d { border, ..default() }, Vec3::ZERO);
            assert!(matches!(refused, Err(PlacementError::Border(_))), "{border}");
        }
        assert_eq!(place(default(), Vec3::NAN), Err(PlacementError::Transform));
        let perspective = Projection::Perspective(PerspectiveProjection::default());
        let at = GlobalTransform::IDENTITY;
        let refused = Placement::new(&Camera::default(), &perspective, &at, &default());
        assert_eq!(refused, Err(PlacementError::Projection));
    }

    #[test]
    fn a_grid_with_too_many_cells_gets_larger_ones() {
        let small = Lighting2d { cells: CellSize::World(0.01), ..Lighting2d::default() };
        let placed = place(small, Vec3::ZERO).unwrap().unwrap();
        assert!(placed.cell > placed.requested, "{placed:?}");
        let [width, height] = placed.placed.size.map(u64::from);
        assert!((MAX_CELLS / 5..=MAX_CELLS).contains(&(width * height)), "{width}×{height}");
    }
}
