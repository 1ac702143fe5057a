//! The answer: the light at every cell, and questions about it.

use crate::Rgb;

/// Mean radiance arriving at each cell (fluence), linear RGB, in row order.
///
/// In a solid cell: what its faces receive, fading inwards over `wall_depth`, and its own emission
/// on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Light {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<Rgb>,
    pub(crate) solid: Vec<bool>,
}

impl Light {
    /// Light computed elsewhere (a reference, a file): one value a cell of `cells`, in row order.
    /// `None` when the number of values is not the number of cells.
    pub fn from_pixels(cells: &crate::Cells, rgb: Vec<Rgb>) -> Option<Self> {
        (rgb.len() == cells.len()).then(|| Self {
            width: cells.width(),
            height: cells.height(),
            rgb,
            solid: (0..cells.len()).map(|i| cells.is_solid(i)).collect(),
        })
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Every cell's light, in row order.
    pub fn pixels(&self) -> &[Rgb] {
        &self.rgb
    }

    /// Whether each cell is a solid wall, in row order.
    pub fn solid(&self) -> &[bool] {
        &self.solid
    }

    /// Light of cell (x, y); black outside the grid.
    pub fn at(&self, x: u32, y: u32) -> Rgb {
        if x < self.width && y < self.height {
            self.rgb[y as usize * self.width as usize + x as usize]
        } else {
            [0.0; 3]
        }
    }

    /// Light at a point in px, between the four nearest cell centres.
    ///
    /// In the open only open cells count, so that a point beside a wall is not darkened by it, and
    /// none from beyond where two walls touch; inside a wall only solid cells count. Outside the
    /// grid: the nearest cell at the border.
    pub fn sample(&self, position: [f32; 2]) -> Rgb {
        if self.rgb.is_empty() || !position.iter().all(|p| p.is_finite()) {
            return [0.0; 3];
        }
        // Beyond the border lies the border, however far.
        let x = position[0].clamp(0.0, self.width as f32);
        let y = position[1].clamp(0.0, self.height as f32);
        let (max_x, max_y) = (self.width as i64 - 1, self.height as i64 - 1);
        let index = |x: i64, y: i64| {
            y.clamp(0, max_y) as usize * self.width as usize + x.clamp(0, max_x) as usize
        };
        let home = index(x.floor() as i64, y.floor() as i64);
        let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
        let (fx, fy) = (x - 0.5 - left, y - 0.5 - top);
        let (left, top) = (left as i64, top as i64);
        let corners = [
            (index(left, top), (1.0 - fx) * (1.0 - fy)),
            (index(left + 1, top), fx * (1.0 - fy)),
            (index(left, top + 1), (1.0 - fx) * fy),
            (index(left + 1, top + 1), fx * fy),
        ];
        let alike = corners.map(|(i, _)| self.solid[i] == self.solid[home]);
        let counts = |corner: usize| {
            // Corners differ by a bit for each axis. Across, the way leads past one beside.
            let near = |other: usize| corners[other].0 == home;
            let beside = [corner ^ 1, corner ^ 2];
            alike[corner]
                && (near(corner) || beside.iter().any(|&other| near(other) || alike[other]))
        };
        self.mean((0..4).filter(|&corner| counts(corner)).map(|corner| corners[corner]))
    }

    /// Mean light over the open cells of a box from `min` to `max` in px, each by the share of it
    /// that lies inside; black where the box holds no open cell.
    pub fn over(&self, min: [f32; 2], max: [f32; 2]) -> Rgb {
        let overlap =
            |i: usize, axis: usize| ((i + 1) as f32).min(max[axis]) - (i as f32).max(min[axis]);
        let cells = |axis: usize, side: u32| {
            let from = min[axis].max(0.0) as usize;
            from..(max[axis].max(0.0).ceil() as usize).min(side as usize)
        };
        self.mean(cells(1, self.height).flat_map(|y| {
            cells(0, self.width).filter_map(move |x| {
                let i = y * self.width as usize + x;
                let share = overlap(x, 0).max(0.0) * overlap(y, 1).max(0.0);
                (!self.solid[i]).then_some((i, share))
            })
        }))
    }

    fn mean(&self, weighted: impl Iterator<Item = (usize, f32)>) -> Rgb {
        let (mut sum, mut weight) = ([0.0f32; 3], 0.0f32);
        for (i, w) in weighted {
            (0..3).for_each(|c| sum[c] += w * self.rgb[i][c]);
            weight += w;
        }
        if weight > 0.0 { sum.map(|v| v / weight) } else { [0.0; 3] }
    }
}
