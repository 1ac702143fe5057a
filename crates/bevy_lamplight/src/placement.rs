//! Where the lit grid of a camera lies in the world.

use crate::components::{CellSize, LightMethod, Lighting2d};
use crate::pieces::Map;
use bevy::camera::{Camera, Projection, SubCameraView};
use bevy::math::{Rect, Vec2, Vec3};
use bevy::prelude::GlobalTransform;
use lamplight_wgpu::{Placed, View, Window};

/// A grid over the world: cells of some world units, that stay where they are while the camera
/// moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World units a cell.
    pub cell: f32,
    /// What was asked for; less where the grid would have too many cells.
    pub asked: f32,
    /// Which cells, and what of them is seen.
    pub placed: Placed,
}

/// Most cells that are lit for a camera. Larger grids get larger cells.
pub const MOST_CELLS: u64 = 1 << 22;
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

/// Why a camera cannot be lit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Misplaced {
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
    /// Where what a camera sees lies, with the border round it; none where it sees nothing, such as
    /// a window of no size.
    pub fn of(
        camera: &Camera,
        projection: &Projection,
        transform: &GlobalTransform,
        lighting: &Lighting2d,
    ) -> Result<Option<Self>, Misplaced> {
        let Projection::Orthographic(orthographic) = projection else {
            return Err(Misplaced::Projection);
        };
        let border = lighting.border;
        if !(border >= 0.0 && border.is_finite()) {
            return Err(Misplaced::Border(border));
        }
        let Some(pixels) = camera.logical_viewport_size() else { return Ok(None) };
        let area = seen(orthographic.area, camera.sub_camera_view.as_ref());
        let world = transform.affine();
        let middle = world.transform_point3(area.center().extend(0.0)).truncate();
        // From left to right, and from below to above.
        let across = world.transform_vector3(Vec3::X * area.width()).truncate();
        let up = world.transform_vector3(Vec3::Y * area.height()).truncate();
        let extent = Vec2::new(across.length(), up.length());
        if !(middle.is_finite() && extent.is_finite()) {
            return Err(Misplaced::Transform);
        }
        if !(pixels.min_element() >= 1.0 && extent.min_element() > 0.0) {
            return Ok(None);
        }
        // Neither cells nor lattice nor step change what is found at a place of the world.
        let asked = match lighting.cells {
            CellSize::World(size) => size,
            CellSize::Screen(share) => {
                (extent.y / pixels.y / share.clamp(0.05, 2.0)).log2().round().exp2()
            }
        };
        if !(asked > 0.0 && asked.is_finite()) {
            return Err(Misplaced::Cell(asked));
        }
        // The same line for cameras that are mirrored: the grid covers both.
        let level = across * across.x.signum();
        for cell in doubled(asked) {
            let position = (middle / cell).to_array().map(f64::from);
            let view = View {
                position: [position[0], -position[1]],
                border: (border / cell).ceil() as u32,
                lattice: match lighting.method {
                    LightMethod::Holographic | LightMethod::Cascades => LATTICE,
                    LightMethod::Raymarch | LightMethod::Polar | LightMethod::Flood => 1,
                },
                // The grid's y points down.
                rotation: -f64::from(level.to_angle()),
                step: STEP,
                ..View::default()
            };
            let columns_rows = (extent / cell).to_array().map(f64::from);
            let Ok(mut placed) = view.cover(columns_rows) else { continue };
            let [width, height] = placed.size.map(u64::from);
            if width * height <= MOST_CELLS {
                let on_grid = |v: Vec2| Vec2::new(v.x, -v.y) / cell;
                let (right, down) = (on_grid(across), on_grid(-up));
                let middle: [f64; 2] =
                    std::array::from_fn(|a| view.position[a] - f64::from(placed.origin[a]));
                let corner = Vec2::from(middle.map(|v| v as f32)) - 0.5 * (right + down);
                placed.window =
                    Window { corner: corner.into(), right: right.into(), down: down.into() };
                return Ok(Some(Self { cell, asked, placed }));
            }
        }
        Err(Misplaced::TooFar(asked))
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

/// What of a projection's area a camera shows, as Bevy cuts it: the whole's width follows from its height.
fn seen(area: Rect, part: Option<&SubCameraView>) -> Rect {
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

    fn place(lighting: Lighting2d, at: Vec3) -> Result<Option<Placement>, Misplaced> {
        let mut camera = Camera::default();
        let physical_size = UVec2::new(320, 180);
        camera.computed.target_info = Some(RenderTargetInfo { physical_size, scale_factor: 1.0 });
        let mut projection = OrthographicProjection::default_2d();
        projection.area = Rect::from_center_size(Vec2::ZERO, Vec2::new(320.0, 180.0));
        let projection = Projection::Orthographic(projection);
        Placement::of(&camera, &projection, &GlobalTransform::from_translation(at), &lighting)
    }

    #[test]
    fn cameras_that_cannot_be_lit_are_refused_with_a_reason() {
        let default = Lighting2d::default;
        let placed = place(default(), Vec3::ZERO).unwrap().unwrap();
        assert_eq!((placed.cell, placed.asked), (2.0, 2.0));
        let cells = |cells| place(Lighting2d { cells, ..default() }, Vec3::ZERO);
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let why = cells(CellSize::World(bad)).unwrap_err().to_string();
            assert!(why.contains(&format!("{bad} world units")), "{why}");
        }
        assert!(matches!(cells(CellSize::Screen(f32::NAN)), Err(Misplaced::Cell(_))));
        assert_eq!(cells(CellSize::World(1e-30)), Err(Misplaced::TooFar(1e-30)));
        for border in [-1.0, f32::NAN, f32::INFINITY] {
            let refused = place(Lighting2d { border, ..default() }, Vec3::ZERO);
            assert!(matches!(refused, Err(Misplaced::Border(_))), "{border}");
        }
        assert_eq!(place(default(), Vec3::NAN), Err(Misplaced::Transform));
        let perspective = Projection::Perspective(PerspectiveProjection::default());
        let at = GlobalTransform::IDENTITY;
        let refused = Placement::of(&Camera::default(), &perspective, &at, &default());
        assert_eq!(refused, Err(Misplaced::Projection));
    }

    #[test]
    fn too_many_cells_are_made_larger() {
        let small = Lighting2d { cells: CellSize::World(0.01), ..Lighting2d::default() };
        let placed = place(small, Vec3::ZERO).unwrap().unwrap();
        assert!(placed.cell > placed.asked, "{placed:?}");
        let [width, height] = placed.placed.size.map(u64::from);
        assert!((MOST_CELLS / 5..=MOST_CELLS).contains(&(width * height)), "{width}×{height}");
    }
}
