//! A camera over a world of cells.

use crate::Result;
use lamplight::{Cells, Error};

/// A camera over a world of cells, for games whose world is larger than what is seen.
///
/// The host draws the matter round the camera into textures, and [`Self::place`] says which: a grid
/// that begins at a whole cell of the world, [`Self::border`] cells larger on every side than what is
/// seen, so that what lies beyond the screen still lights it. As the camera moves by fractions of a
/// cell the grid stays and only the [`Window`] through which it is seen moves; as it moves further the
/// grid jumps by whole cells, and with it the matter. The light of a place in the world is the same
/// either way: it neither swims nor flickers.
///
/// ```
/// # use lamplight_wgpu::View;
/// let view = View { position: [1000.25, 40.0], zoom: 4.0, border: 32, ..View::default() };
/// let placed = view.place([1280, 720])?;
/// assert_eq!(placed.size, [320 + 1 + 64, 180 + 1 + 64]);
/// assert_eq!(placed.origin, [1000 - 160 - 32, 40 - 90 - 32]);
/// assert_eq!(placed.window.corner, [32.25, 32.0]);
/// assert_eq!(placed.window.right, [320.0, 0.0]);
/// # Ok::<_, lamplight_wgpu::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The place in the world, in cells, that is seen in the middle.
    pub position: [f64; 2],
    /// Pixels of the target to a cell; above 0.
    pub zoom: f64,
    /// Cells of matter beyond what is seen, on every side. Higher: light from further away is not cut
    /// off at the edge of the screen; costs as much as so many more cells do.
    pub border: u32,
    /// The grid begins at multiples of so many cells of the world; 1 or more. Methods that see all
    /// cells alike (`raymarch`) need no more than 1. Methods that find light at some cells and spread
    /// it to those between, on planes or probes counted from the grid's left and top edge
    /// (`holographic`, `cascades`), are a little off in ways that depend on where those lie: that
    /// pattern stays with the world where this is a multiple of their largest spacing that matters
    /// (16 for `holographic`). Costs up to so many columns and rows more.
    pub lattice: u32,
    /// How far the camera is turned, radians, clockwise as it is seen (from +x towards +y). The grid stays
    /// with the world's axes, so that light does not turn with the camera; it covers what is seen at any
    /// angle as soon as there is one, up to 4 times the cells of a 16:9 picture.
    pub rotation: f64,
    /// The sides of the grid are multiples of so many cells, 1 or more, so that a camera that zooms makes
    /// buffers anew only now and then.
    pub step: u32,
}

impl Default for View {
    /// The world's origin in the middle, a pixel a cell, 64 cells of border, not turned.
    fn default() -> Self {
        Self { position: [0.0; 2], zoom: 1.0, border: 64, lattice: 1, rotation: 0.0, step: 1 }
    }
}

/// The part of a grid that is seen: a rectangle, turned where the camera is. Cells, x to the right and y
/// down from the grid's left and top edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The place at the picture's left and top.
    pub corner: [f32; 2],
    /// From there to its right and top.
    pub right: [f32; 2],
    /// From there to its left and bottom.
    pub down: [f32; 2],
}

impl Window {
    /// What is seen by a camera that is not turned: so many columns and rows, not always whole ones.
    pub fn upright(corner: [f32; 2], [columns, rows]: [f32; 2]) -> Self {
        Self { corner, right: [columns, 0.0], down: [0.0, rows] }
    }
}

/// Where the host draws its matter, and what of it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Columns and rows of the grid. They stay the same while only [`View::position`] changes, so
    /// textures are not made anew.
    pub size: [u32; 2],
    /// The cell of the world that is the grid's left and top one, for [`crate::Lighting::set_origin`].
    pub origin: [i32; 2],
    /// For [`crate::Shown::window`].
    pub window: Window,
}

impl View {
    /// The grid for a target of so many pixels.
    ///
    /// An error where the camera is nowhere (NaN, or beyond 2³⁰ cells of the world's origin), and
    /// where the grid would be larger than [`Cells`] can be.
    pub fn place(&self, pixels: [u32; 2]) -> Result<Placed> {
        if !(self.zoom > 0.0 && self.zoom.is_finite()) {
            return bad("view.zoom", self.zoom, "above 0");
        }
        if let Some(&v) = pixels.iter().find(|v| **v == 0) {
            return bad("pixels", v.into(), "1 or more");
        }
        self.cover(pixels.map(|v| f64::from(v) / self.zoom))
    }

    /// The same for a picture that shows so many columns and rows, not always whole ones, whatever
    /// [`Self::zoom`] says: where pixels are not square, or are not known.
    pub fn cover(&self, extent: [f64; 2]) -> Result<Placed> {
        /// Leaves room for the largest grid in 32 bits.
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
        // Turned, the circle round the picture, so that the size stays while it turns.
        let covered = match self.rotation {
            0.0 => [width, height],
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
        Ok(Placed {
            size: size.map(|v| v as u32),
            origin: origin.map(|v| v as i32),
            window: Window {
                corner: [corner(0) as f32, corner(1) as f32],
                right: right.map(|v| v as f32),
                down: down.map(|v| v as f32),
            },
        })
    }
}

fn bad<T>(key: &str, value: f64, expected: &str) -> Result<T> {
    Err(Error::value(key, value, expected).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cameras here and there, at rest and on the move.
    fn positions() -> impl Iterator<Item = f64> {
        (-400..400).flat_map(|i| [f64::from(i) * 0.37, f64::from(i) * 1e6 / 7.0])
    }

    #[test]
    fn what_is_seen_lies_inside_the_border_wherever_the_camera_is() {
        for x in positions() {
            for (zoom, lattice, rotation, step) in
                [(1.0, 1, 0.0, 1), (4.0, 1, 0.3, 1), (3.3, 16, 0.0, 64), (0.5, 16, -2.0, 32)]
            {
                let position = [x, -x];
                let view = View { position, zoom, border: 10, lattice, rotation, step };
                let placed = view.place([321, 179]).unwrap();
                let Placed { size, origin, window } = placed;
                for a in 0..2 {
                    let ways =
                        [0.0, window.right[a], window.down[a], window.right[a] + window.down[a]];
                    let places = ways.map(|way| window.corner[a] + way);
                    let within = 10.0..=size[a] as f32 - 10.0;
                    assert!(places.iter().all(|p| within.contains(p)), "{view:?}: {placed:?}");
                    assert_eq!(origin[a].rem_euclid(lattice as i32), 0);
                    assert_eq!(size[a] % step, 0);
                    let middle = f64::from(origin[a]) + f64::from(0.5 * (places[0] + places[3]));
                    assert!((middle - view.position[a]).abs() < 1e-3, "{view:?}: {placed:?}");
                }
                let length = |[x, y]: [f32; 2]| f64::from(x.hypot(y)) * zoom;
                assert!((length(window.right) - 321.0).abs() < 1e-2, "{placed:?}");
                assert!((length(window.down) - 179.0).abs() < 1e-2, "{placed:?}");
            }
        }
    }

    #[test]
    fn a_camera_that_turns_turns_the_window_alone() {
        let place = |rotation| {
            let view = View { position: [7.5, 3.0], zoom: 2.0, rotation, ..View::default() };
            view.place([320, 180]).unwrap()
        };
        let first = place(0.1);
        for step in 2..60 {
            let placed = place(f64::from(step) * 0.1);
            assert_eq!((placed.size, placed.origin), (first.size, first.origin));
            assert_ne!(placed.window, first.window);
        }
        // Clockwise: what is to the right of the picture lies further down in the world.
        assert!(first.window.right[1] > 0.0 && first.window.down[0] < 0.0);
    }

    #[test]
    fn the_grid_keeps_its_size_and_moves_by_whole_cells() {
        let place = |x| {
            let view = View { position: [x, 0.0], zoom: 3.0, lattice: 16, ..View::default() };
            view.place([320, 180]).unwrap()
        };
        let first = place(0.0);
        let mut jumps = 0;
        let mut before = first;
        for step in 1..=640 {
            let placed = place(f64::from(step) / 10.0);
            assert_eq!(placed.size, first.size);
            assert_eq!(placed.window.right, first.window.right);
            jumps += usize::from(placed.origin != before.origin);
            before = placed;
        }
        assert_eq!(jumps, 4);
    }

    #[test]
    fn a_camera_that_zooms_changes_the_size_in_steps() {
        let sizes: Vec<_> = (0..=100)
            .map(|i| {
                let view = View { zoom: 2.0 + f64::from(i) / 100.0, step: 64, ..View::default() };
                view.place([1280, 720]).unwrap().size
            })
            .collect();
        let changes = sizes.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((1..=6).contains(&changes), "{changes} of {sizes:?}");
    }

    #[test]
    fn cameras_that_see_nothing_are_refused() {
        let refused = |view: View| view.place([320, 180]).unwrap_err().to_string();
        for (view, key) in [
            (View { position: [0.0, f64::NAN], ..View::default() }, "view.position"),
            (View { position: [f64::INFINITY, 0.0], ..View::default() }, "view.position"),
            (View { zoom: 0.0, ..View::default() }, "view.zoom"),
            (View { zoom: f64::NAN, ..View::default() }, "view.zoom"),
            (View { lattice: 0, ..View::default() }, "view.lattice"),
            (View { step: 0, ..View::default() }, "view.step"),
            (View { rotation: f64::NAN, ..View::default() }, "view.rotation"),
        ] {
            let error = refused(view);
            assert!(error.contains(key), "{error}");
        }
        let far_off = refused(View { zoom: 1e-9, ..View::default() });
        assert!(far_off.contains("16384"), "{far_off}");
        let wide = refused(View { border: u32::MAX, ..View::default() });
        assert!(wide.contains("16384"), "{wide}");
        let nothing = View::default().place([0, 180]).unwrap_err().to_string();
        assert!(nothing.contains("pixels"), "{nothing}");
    }
}
