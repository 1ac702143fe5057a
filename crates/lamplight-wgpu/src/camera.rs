//! A camera over a world of cells.

use lamplight::{Cells, Error};

/// A camera over a world of cells, for games whose world is larger than the screen.
///
/// The host draws the matter around the camera into textures, and [`Self::place`] returns which part: a grid
/// that begins at a whole cell of the world, [`Self::border`] cells larger on every side than the visible
/// part, so that light from beyond the screen reaches it. While the camera moves by fractions of a cell the grid
/// stays and only the [`VisibleRect`] moves. When it moves further, the grid jumps by whole cells, and with it
/// the matter. The light of a place in the world is the same either way: it neither swims nor flickers.
///
/// ```
/// # use lamplight_wgpu::Camera2dView;
/// let view = Camera2dView { position: [1000.25, 40.0], zoom: 4.0, border: 32, ..Camera2dView::default() };
/// let placed = view.place([1280, 720])?;
/// assert_eq!(placed.size, [320 + 1 + 64, 180 + 1 + 64]);
/// assert_eq!(placed.origin, [1000 - 160 - 32, 40 - 90 - 32]);
/// assert_eq!(placed.visible.corner, [32.25, 32.0]);
/// assert_eq!(placed.visible.right, [320.0, 0.0]);
/// # Ok::<_, lamplight_wgpu::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera2dView {
    /// The centre of the picture in the world, in cells.
    pub position: [f64; 2],
    /// Pixels of the target per cell; above 0.
    pub zoom: f64,
    /// Cells of matter beyond the visible part, on every side. Higher: light from further away is not cut off
    /// at the edge of the screen. Costs as much as that many more cells.
    pub border: u32,
    /// The grid begins at multiples of this many cells of the world; 1 or more. Methods that treat all cells
    /// alike (`raymarch`) need no more than 1. Methods that find light at some cells and interpolate between
    /// them, on planes or probes counted from the grid's left and top edge (`holographic`, `cascades`), have a
    /// small error that depends on where those lie. The error stays with the world if this is a multiple of
    /// their largest spacing that matters (16 for `holographic`). Costs up to that many more columns and rows.
    pub lattice: u32,
    /// Rotation of the camera, radians, clockwise on the screen (from +x towards +y). The grid stays with the
    /// world's axes, so that light does not rotate with the camera. Unless the rotation is by quarters, the grid covers
    /// the visible part at any angle, up to 4 times the cells of a 16:9 picture.
    pub rotation: f64,
    /// The sides of the grid are multiples of this many cells, 1 or more, so that a camera that zooms seldom
    /// reallocates buffers.
    pub step: u32,
}

impl Default for Camera2dView {
    /// The world's origin in the centre, one pixel per cell, 64 cells of border, not rotated.
    fn default() -> Self {
        Self { position: [0.0; 2], zoom: 1.0, border: 64, lattice: 1, rotation: 0.0, step: 1 }
    }
}

/// The visible part of a grid: a rectangle, rotated with the camera. In cells, x to the right and y down from
/// the grid's left and top edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleRect {
    /// The position of the picture's left and top.
    pub corner: [f32; 2],
    /// The edge from there to its right and top.
    pub right: [f32; 2],
    /// The edge from there to its left and bottom.
    pub down: [f32; 2],
}

impl VisibleRect {
    /// The rectangle of a camera that is not rotated: columns and rows, not always whole ones.
    pub fn upright(corner: [f32; 2], [columns, rows]: [f32; 2]) -> Self {
        Self { corner, right: [columns, 0.0], down: [0.0, rows] }
    }
}

/// The place of a grid in the world, and its visible part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPlacement {
    /// Columns and rows of the grid. They stay the same while only [`Camera2dView::position`] changes, so
    /// textures can be reused.
    pub size: [u32; 2],
    /// The cell of the world that is the grid's left and top one, for [`crate::FrameInput::origin`].
    pub origin: [i32; 2],
    /// The visible part, for [`crate::ComposeParams::visible`].
    pub visible: VisibleRect,
}

impl Camera2dView {
    /// Returns the grid for a target of a size in pixels.
    ///
    /// # Errors
    /// If the camera's position is NaN or more than 2³⁰ cells from the world's origin, and if the grid would be
    /// larger than [`Cells`] can be.
    pub fn place(&self, pixels: [u32; 2]) -> Result<GridPlacement, Error> {
        if !(self.zoom > 0.0 && self.zoom.is_finite()) {
            return bad("view.zoom", self.zoom, "above 0");
        }
        if let Some(&v) = pixels.iter().find(|v| **v == 0) {
            return bad("pixels", v.into(), "1 or more");
        }
        self.cover(pixels.map(|v| f64::from(v) / self.zoom))
    }

    /// Like [`Self::place`], for a picture that shows `extent` columns and rows, not always whole ones. Ignores
    /// [`Self::zoom`]: for pixels that are not square, or not known.
    pub fn cover(&self, extent: [f64; 2]) -> Result<GridPlacement, Error> {
        /// Cells by which the sides of a picture that counts as upright may deviate: what is left when rotations by
        /// quarters are added up in 32 bits.
        const STRAIGHT: f64 = 1.0 / 64.0;
        /// The farthest position from which the largest grid still fits into 32 bits.
        const FURTHEST: f64 = (1 << 30) as f64;
        let near = -FURTHEST..=FURTHEST;
        if let Some(&v) = self.position.iter().find(|v| !near.contains(v)) {
            return bad("view.position", v, "at most 2^30 cells from the origin");
        }
        if let Some(&v) = extent.iter().find(|v| !(**v > 0.0 && v.is_finite())) {
            return bad("extent", v, "above 0");
        }
        for (key, value) in [("view.lattice", self.lattice), ("view.step", self.step)] {
            if value == 0 || value > Cells::MAX_SIDE {
                return bad(key, value.into(), "from 1 to 16384");
            }
        }
        if !self.rotation.is_finite() {
            return bad("view.rotation", self.rotation, "finite");
        }
        let [width, height] = extent;
        let (sin, cos) = self.rotation.sin_cos();
        let (right, down) = ([width * cos, width * sin], [-height * sin, height * cos]);
        let is_along = |off: f64| off.abs() * width.max(height) < STRAIGHT;
        let covered = match [is_along(sin), is_along(cos)] {
            [true, _] => [width, height],
            [_, true] => [height, width],
            // The circle around the picture, so that the size stays while it rotates.
            _ => [width.hypot(height); 2],
        };
        // A fraction of a cell on either side, and what snapping may add on the left, or on top.
        let slack = 2.0 * f64::from(self.border) + f64::from(self.lattice);
        let step = f64::from(self.step);
        let size = covered.map(|v| ((v.ceil() + slack) / step).ceil() * step);
        Cells::check_size(size[0] as u64, size[1] as u64)?;
        let lattice = f64::from(self.lattice);
        let origin: [f64; 2] = std::array::from_fn(|a| {
            let low = self.position[a] - 0.5 * covered[a];
            ((low.floor() - f64::from(self.border)) / lattice).floor() * lattice
        });
        let corner = |a: usize| self.position[a] - 0.5 * (right[a] + down[a]) - origin[a];
        Ok(GridPlacement {
            size: size.map(|v| v as u32),
            origin: origin.map(|v| v as i32),
            visible: VisibleRect {
                corner: [corner(0) as f32, corner(1) as f32],
                right: right.map(|v| v as f32),
                down: down.map(|v| v as f32),
            },
        })
    }
}

fn bad<T>(key: &str, value: f64, expected: &str) -> Result<T, Error> {
    Err(Error::value(key, value, expected))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Cameras here and there, at rest and on the move.
    fn positions() -> impl Iterator<Item = f64> {
        (-400..400).flat_map(|i| [f64::from(i) * 0.37, f64::from(i) * 1e6 / 7.0])
    }

    #[test]
    fn the_visible_part_lies_inside_the_border_for_any_camera() {
        for x in positions() {
            for (zoom, lattice, rotation, step) in
                [(1.0, 1, 0.0, 1), (4.0, 1, 0.3, 1), (3.3, 16, 0.0, 64), (0.5, 16, -2.0, 32)]
            {
                let position = [x, -x];
                let view = Camera2dView { position, zoom, border: 10, lattice, rotation, step };
                let placed = view.place([321, 179]).unwrap();
                let GridPlacement { size, origin, visible } = placed;
                for a in 0..2 {
                    let ways = [
                        0.0,
                        visible.right[a],
                        visible.down[a],
                        visible.right[a] + visible.down[a],
                    ];
                    let places = ways.map(|way| visible.corner[a] + way);
                    let within = 10.0..=size[a] as f32 - 10.0;
                    assert!(places.iter().all(|p| within.contains(p)), "{view:?}: {placed:?}");
                    assert_eq!(origin[a].rem_euclid(lattice as i32), 0);
                    assert_eq!(size[a] % step, 0);
                    let middle = f64::from(origin[a]) + f64::from(0.5 * (places[0] + places[3]));
                    assert!((middle - view.position[a]).abs() < 1e-3, "{view:?}: {placed:?}");
                }
                let length = |[x, y]: [f32; 2]| f64::from(x.hypot(y)) * zoom;
                assert!((length(visible.right) - 321.0).abs() < 1e-2, "{placed:?}");
                assert!((length(visible.down) - 179.0).abs() < 1e-2, "{placed:?}");
            }
        }
    }

    #[test]
    fn a_rotating_camera_rotates_only_the_visible_part() {
        let place = |rotation| {
            let view = Camera2dView {
                position: [7.5, 3.0],
                zoom: 2.0,
                rotation,
                ..Camera2dView::default()
            };
            view.place([320, 180]).unwrap()
        };
        let first = place(0.1);
        for step in 2..60 {
            let placed = place(f64::from(step) * 0.1);
            assert_eq!((placed.size, placed.origin), (first.size, first.origin));
            assert_ne!(placed.visible, first.visible);
        }
        // Clockwise: what is to the right of the picture lies further down in the world.
        assert!(first.visible.right[1] > 0.0 && first.visible.down[0] < 0.0);
    }

    #[test]
    fn a_camera_turned_by_quarters_needs_no_more_cells() {
        let size = |rotation| {
            let view = Camera2dView { rotation, ..Camera2dView::default() };
            view.place([320, 180]).unwrap().size
        };
        let [wide, high] = [size(0.0), size(FRAC_PI_2)];
        assert_eq!(wide, [high[1], high[0]]);
        for quarters in -5..=5 {
            // As 32 bits leave it.
            let rounded = f64::from((f64::from(quarters) * FRAC_PI_2) as f32);
            for rotation in [rounded, rounded + 1e-6] {
                let expected = if quarters % 2 == 0 { wide } else { high };
                assert_eq!(size(rotation), expected, "{rotation}");
            }
            assert!(size(rounded + 1e-3)[0] > wide[0], "{quarters} quarters and a bit");
        }
    }

    #[test]
    fn the_grid_keeps_its_size_and_moves_by_whole_cells() {
        let place = |x| {
            let view = Camera2dView {
                position: [x, 0.0],
                zoom: 3.0,
                lattice: 16,
                ..Camera2dView::default()
            };
            view.place([320, 180]).unwrap()
        };
        let first = place(0.0);
        let mut jumps = 0;
        let mut before = first;
        for step in 1..=640 {
            let placed = place(f64::from(step) / 10.0);
            assert_eq!(placed.size, first.size);
            assert_eq!(placed.visible.right, first.visible.right);
            jumps += usize::from(placed.origin != before.origin);
            before = placed;
        }
        assert_eq!(jumps, 4);
    }

    #[test]
    fn a_camera_that_zooms_changes_the_size_in_steps() {
        let sizes: Vec<_> = (0..=100)
            .map(|i| {
                let view = Camera2dView {
                    zoom: 2.0 + f64::from(i) / 100.0,
                    step: 64,
                    ..Camera2dView::default()
                };
                view.place([1280, 720]).unwrap().size
            })
            .collect();
        let changes = sizes.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((1..=6).contains(&changes), "{changes} of {sizes:?}");
    }

    #[test]
    fn invalid_cameras_are_rejected() {
        let refused = |view: Camera2dView| view.place([320, 180]).unwrap_err().to_string();
        for (view, key) in [
            (
                Camera2dView { position: [0.0, f64::NAN], ..Camera2dView::default() },
                "view.position",
            ),
            (
                Camera2dView { position: [f64::INFINITY, 0.0], ..Camera2dView::default() },
                "view.position",
            ),
            (Camera2dView { zoom: 0.0, ..Camera2dView::default() }, "view.zoom"),
            (Camera2dView { zoom: f64::NAN, ..Camera2dView::default() }, "view.zoom"),
            (Camera2dView { lattice: 0, ..Camera2dView::default() }, "view.lattice"),
            (Camera2dView { step: 0, ..Camera2dView::default() }, "view.step"),
            (Camera2dView { rotation: f64::NAN, ..Camera2dView::default() }, "view.rotation"),
        ] {
            let error = refused(view);
            assert!(error.contains(key), "{error}");
        }
        let far_off = refused(Camera2dView { zoom: 1e-9, ..Camera2dView::default() });
        assert!(far_off.contains("16384"), "{far_off}");
        let wide = refused(Camera2dView { border: u32::MAX, ..Camera2dView::default() });
        assert!(wide.contains("16384"), "{wide}");
        let nothing = Camera2dView::default().place([0, 180]).unwrap_err().to_string();
        assert!(nothing.contains("pixels"), "{nothing}");
    }
}
